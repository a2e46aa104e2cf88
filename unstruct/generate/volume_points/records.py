"""The record that the kernels of an insertion in space work on, and the entries of its counters."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...connect.spatial.numbered import Numbered
from ...connect.spatial.opening import Star
from ...connect.spatial.records import Solid
from .limits import BodyLimits

__all__ = ["BodyWork"]

# Entries of ``tally``.
VERTICES_NOW = 0  # vertices so far
SUBSEGMENTS_NOW = 1  # subsegments so far
IN_HEAP, IN_SEGMENTS, IN_FACES = 2, 3, 4  # lengths of the queues
CENTER_POINTS, SEGMENT_POINTS, FACET_POINTS = 5, 6, 7  # how many were put where
REFUSED_POINTS = 8  # how many were looked at and not put
VORONOI_POINTS = 9  # how many were put on Voronoi segments
NEAREST = 10  # the vertex that was nearest to the last point
MAY_BY = 12  # why that was near enough
CELLS_WAIT = 11  # 1 while only segments and facets are divided
# Bits of ``asked`` and ``flag``: BY_MEASURE, BY_QUALITY, and these, shifted, for what is given up, and why.
NO_MORE, WHY_NO_MORE = 2, 4  # by how many bits to shift
# Features of vertices: a subsegment's segment s is s, a facet with mark m is -3 - m.
OF_DOMAIN, FREE_POINT = -1, -2


class BodyWork(NamedTuple):
    """A complex of cells, its segments and facets, what waits to be divided, and why cells were given up."""

    solid: Solid
    star: Star
    edges: Numbered
    limits: BodyLimits
    sharp: Any  # a `Sharp`
    touch: Any  # another one: for each part its vertices
    extent: NDArray[np.float64]  # of the parts: how wide they are
    sharp_vertex: NDArray[np.bool_]  # (vertices of the domain,)
    ends: NDArray[np.int32]  # (subsegments, 2)
    parent: NDArray[np.int32]  # the segment that each is a part of
    span: NDArray[np.float64]  # (subsegments, 2) parameters of its ends there
    asked: NDArray[np.int8]  # why it waits, and below, shifted, for what it was given up
    plane: NDArray[np.float64]  # (marks, 6) a point of each facet and its unit normal
    kept: NDArray[np.int8]  # (marks,) whether a facet must stay as it is
    feature: NDArray[np.int32]  # of vertices: where they are
    floor: NDArray[np.float64]  # of vertices: lengths of edges nearby in the beginning
    left: NDArray[np.int32]  # (segments,) how many points for the shape's sake each may still get
    left_facet: NDArray[np.int32]  # (marks,)
    flag: NDArray[np.int8]  # of faces: as ``asked``
    why: NDArray[np.int8]  # of cells: why they were given up
    heap: NDArray[np.float64]
    bad: NDArray[np.int32]  # the cell of each entry of the heap
    segments: NDArray[np.int32]  # the queue of subsegments
    faces: NDArray[np.int32]  # the queue of faces
    tally: NDArray[np.int64]
