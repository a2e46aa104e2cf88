"""Coordinates in which stretched edges are about as long in all directions, for searches by boxes.

The axis-parallel box of a long edge at an angle to the axes is large, and meets those of most others: all
pairs of needles in a plane take time like their square. Things that meet do so under any linear map, too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .stretched import LEAST_PIVOT

__all__ = ["evened"]

Array = NDArray[np.float64]
WORTH_EVENING = (
    8.0  # the quotient of the mean lengths of edges across two axes from which on a map is worth it
)
IMAGE_ERROR = 2.0**-48  # the error of an image, relative to the terms that it is the sum of


def evened(xyz: Array, edges: NDArray) -> tuple[Array, Array]:
    """Images of points under a linear map, and how much they may be off in each coordinate, (3,).

    Parameters
    ----------
    xyz : (n, 3) float64
        At most 1 in magnitude.
    edges : (e, 2) int

    Returns
    -------
    image : (n, 3) float64
        The points themselves where edges are not stretched at an angle to the axes.
    slack : (3,) float64
        An upper bound of the error by rounding, for two points together.
    """
    plain = xyz, np.zeros(3)
    if len(edges) == 0:
        return plain
    along = xyz[edges[:, 1]] - xyz[edges[:, 0]]
    size = float(np.abs(along).max())
    if not size > 0.0:
        return plain
    along = along / size
    b1, b2, b3, b4, b5, b6 = (
        float((along[:, i] * along[:, j]).mean()) for i, j in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))
    )
    # Of the matrix B of mean squares the factor L, and what L^-1 makes of the squares on the axes.
    if not min(b1, b3, b6) > 0.0:
        return plain
    a = np.sqrt(b1)
    b, d = b2 / a, b4 / a
    c = np.sqrt(max(b3 - b * b, LEAST_PIVOT * b3))
    e = (b5 - b * d) / c
    f = np.sqrt(max(b6 - d * d - e * e, LEAST_PIVOT * b6))
    if np.sqrt(b3) < WORTH_EVENING * c and np.sqrt(b6) < WORTH_EVENING * f:
        return plain
    one = xyz[:, 0] / a
    two = (xyz[:, 1] - b * one) / c
    three = (xyz[:, 2] - d * one - e * two) / f
    terms = np.array([1.0 / a, (1.0 + abs(b) / a) / c, 0.0])
    terms[2] = (1.0 + abs(d) * terms[0] + abs(e) * terms[1]) / f
    return np.stack([one, two, three], axis=1), IMAGE_ERROR * terms
