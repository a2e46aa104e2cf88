"""The cells from which the front in a metric starts: the surface is recovered where it is not stretched.

The Delaunay tetrahedra of the vertices of a surface with long, thin triangles lack nearly all of its edges,
and to recover them takes minutes for a few thousand. In the coordinates in which the mean metric of the
surface is the identity these triangles are round, and there they are recovered at once. The map is linear but
for rounding, so the cells are valid in space, too, and that is checked exactly. Book: 3.5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...connect.spatial.complex import Recovered, SpatialComplex
from ...domain.domain import Domain
from ...predicates.batch import orient
from ...sizing.space_metric import SpaceMetric
from ...sizing.space_metric_table import cholesky_rows
from ...sizing.space_spectrum import IN_ROW, logarithms_in_space, means_in_space, spectrum_in_space
from ..volume_points.run import recovered

__all__ = ["recovered_in_metric"]

Array = NDArray[np.float64]
ON_DIAGONAL = [0, 2, 5]  # of the rows l11, l21, l22, l31, l32, l33 of a factor
WORTH_A_MAP = 3.0  # the ratio of two lengths from which on coordinates are changed


def recovered_in_metric(
    domain: Domain, metric: SpaceMetric, progress: bool = False
) -> tuple[SpatialComplex, Recovered]:
    """As `volume_points.run.recovered`, by the mean metric of the surface where it is stretched."""
    for factor in _factors_to_try(domain, metric):
        image = _image(factor, domain.points)
        if np.isfinite(image).all() and len(np.unique(image, axis=0)) == len(image):
            cells, found = recovered(domain, progress, image)
            if found.complete and _taken_back(cells, factor, domain.points):
                return cells, found
    return recovered(domain, progress)


def _factors_to_try(domain: Domain, metric: SpaceMetric) -> list[Array]:
    """The mean factor, and its diagonal made powers of two.

    Four points of a surface may be on one circle of the image, and rounded to a flat cell that is turned over
    in space. Powers of two do not round: along the axes no cell is, then.
    """
    factor = _mean_factor(domain, metric)
    if factor is None:
        return []
    even = factor.copy()
    mantissa, power = np.frexp(factor[ON_DIAGONAL])
    even[ON_DIAGONAL] = np.ldexp(1.0, power - (mantissa < np.sqrt(0.5)))
    return [factor, even]


def _mean_factor(domain: Domain, metric: SpaceMetric) -> Array | None:
    """The factor L of the inverse of the mean metric at the centers of triangles; None if that is round."""
    shell = domain.triangulated
    rows = metric.at(shell.points[shell.triangles].mean(axis=1))[:, IN_ROW[0], IN_ROW[1]]
    logarithms, mean = np.empty(rows.shape), np.empty((1, 6))
    logarithms_in_space(rows, logarithms)
    every, share = np.arange(len(rows))[None], np.full((1, len(rows)), 1.0 / len(rows))
    means_in_space(logarithms, every, share, mean)
    squares = spectrum_in_space(mean)[0][0]
    return cholesky_rows(mean)[0] if squares[0] > WORTH_A_MAP**2 * squares[2] else None


def _image(factor: Array, x: Array) -> Array:
    """L^-1 x for points x."""
    a, b, c, d, e, f = factor
    one = x[:, 0] / a
    two = (x[:, 1] - b * one) / c
    return np.stack([one, two, (x[:, 2] - d * one - e * two) / f], axis=1)


def _taken_back(cells: SpatialComplex, factor: Array, given: Array) -> bool:
    """Give the vertices of a complex their places in space; whether all cells inside are positive there."""
    a, b, c, d, e, f = factor
    one, two, three = cells.points().T
    x = np.stack([a * one, b * one + c * two, d * one + e * two + f * three], axis=1)
    x[: len(given)] = given
    cells.place(x)
    corners = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[cells.inside_slots()]
    return bool(np.all(orient(x[corners]) > 0))
