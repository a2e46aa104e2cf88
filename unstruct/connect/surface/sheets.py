"""The arrays of a surface in half-edges; `halfedges` has what is done with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ALONG_CURVE",
    "CORNER",
    "FIRST_FREE",
    "FREE_SLOT",
    "LAST_MARK",
    "SEAM_CURVES",
    "SHARED",
    "SMOOTH",
    "SURFACE_SLOTS",
    "SURFACE_VERTICES",
    "Sheets",
]

SMOOTH, ALONG_CURVE, CORNER = 0, 1, 2  # kinds of vertices
SHARED = -2  # minus the first copy, in place of a curve: corners of which there are copies in other sheets
SEAM_CURVES = 1 << 24  # what is added to the number of a curve for edges that are never split

# Entries of the state: how many vertices and slots of triangles have been used, the first free ones (-1 for
# none), and the last mark.
SURFACE_VERTICES, SURFACE_SLOTS, FIRST_FREE, FREE_SLOT, LAST_MARK = 0, 1, 2, 3, 4


class Sheets(NamedTuple):
    """The arrays of a `SurfaceComplex`; those of vertices and of triangles are longer than needed.

    Attributes
    ----------
    xyz : (n, 3) float64
    at : (n,) int32
        A corner of each vertex; of free ones -2 minus the next free one plus 1.
    kind : (n,) int8
        `SMOOTH`, `ALONG_CURVE` (inside a feature curve, or on a closed one) or `CORNER` (never moved).
    on : (n,) int32
        The curve of a vertex of the kind `ALONG_CURVE`; `SHARED` minus the number of the first copy for
        corners that have copies; else -1.
    near : (n,) int64
        A triangle of the given surface near each vertex.
    size : (n,) float64
        The wanted length of edges at each vertex.
    cap : (n,) float64
        An upper bound of it.
    allowed : (n,) float64
        How far the surface may be from the given one near each vertex.
    mark : (n,) int64
        Scratch.
    vertex, twin : (3 m,) int32
        ``vertex[3 t]`` is `UNUSED` for slots without a triangle.
    curve : (3 m,) int32
        The number of the feature curve along each half-edge, or -1.
    name : (m,) int32
        A number that triangles keep.
    state : (5,) int64
    """

    xyz: NDArray[np.float64]
    at: NDArray[np.int32]
    kind: NDArray[np.int8]
    on: NDArray[np.int32]
    near: NDArray[np.int64]
    size: NDArray[np.float64]
    cap: NDArray[np.float64]
    allowed: NDArray[np.float64]
    mark: NDArray[np.int64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    curve: NDArray[np.int32]
    name: NDArray[np.int32]
    state: NDArray[np.int64]
