"""Two records for kernels on a planar triangulation: its arrays, and scratch for cavities.

A record is a tuple of named arrays, which numba takes apart when it compiles: under `lean` and `inline`,
passing one on costs no more than passing on its arrays. When an array is replaced because it has to grow,
the record is made again (by `PlanarComplex.plane` and `.scratch`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Plane", "Scratch"]


class Plane(NamedTuple):
    """The arrays of a `PlanarComplex`, as they are described there."""

    xy: NDArray[np.float64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    mark: NDArray[np.int32]
    region: NDArray[np.int32]
    where: NDArray[np.int32]
    ends: NDArray[np.int32]
    piece: NDArray[np.int32]
    span: NDArray[np.float64]
    state: NDArray[np.int64]


class Scratch(NamedTuple):
    """Arrays for the result of a search for a cavity, and for the star that replaces it."""

    stack: NDArray[np.int32]  # half-edges that remain to be crossed
    cells: NDArray[np.int32]  # the triangles of the cavity
    rim: NDArray[np.int32]  # the half-edges of its boundary, from within, counterclockwise
    hold: NDArray[np.int64]  # (., 4) start, end, twin and mark of each boundary edge
    fresh: NDArray[np.int32]  # the triangles of the star
