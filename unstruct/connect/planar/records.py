"""What kernels on a planar triangulation are handed: its arrays, and scratch for cavities, as two records.

A record is a tuple of arrays with names, which numba takes apart when it compiles: under `lean` and `inline`
handing one on costs no more than handing on its arrays. Where an array is replaced because it has to grow,
the record is made anew (`PlanarComplex.plane` and `.scratch` do).
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
    """What a search for a cavity and the star in its place are written into."""

    stack: NDArray[np.int32]  # half-edges to be crossed
    cells: NDArray[np.int32]  # the triangles of the cavity
    rim: NDArray[np.int32]  # the half-edges around it, from within, counterclockwise
    hold: NDArray[np.int64]  # (., 4) of each rim edge its start, its end, its twin and its mark
    fresh: NDArray[np.int32]  # the triangles of the star
