"""The background of tetrahedra over an octree: pieces of body-centered cubic lattices.

Vertices are the corners and the centers of leaves. Two leaves of one size share four tetrahedra, one over
each edge of their common face: with the two centers and the ends of the edge. Where all leaves have one size
these fill a body-centered cubic lattice: each has two edges of the length of a side, opposite and
perpendicular, and four shorter ones; its dihedral angles are 60 and 90 degrees. An edge with a hanging vertex
halves its tetrahedron. Where a leaf meets a larger one, its face is two triangles, and the middle of the
larger one's face is a vertex. All dihedral angles lie between 45 and 120 degrees. See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ..tree.cubes import outline_of_face
from ..tree.keys import compacted, interleaved
from ..tree.lookup import Grid, entries, leaf_of

__all__ = ["background_tetrahedra"]

MOST_AT_A_FACE = 8  # tetrahedra of one leaf


@inline
def _emit(cells, count, a, b, c, d, sign):
    """Write a tetrahedron if one of its vertices is inside; returns the new count."""
    if sign[a] > 0 or sign[b] > 0 or sign[c] > 0 or sign[d] > 0:
        if count < len(cells):
            cells[count, 0], cells[count, 1], cells[count, 2], cells[count, 3] = a, b, c, d
        return count + 1
    return count


@inline
def _beyond(grid, shift, low, width, face):
    """The leaf that contains the cell of the same size beyond a face; -1 outside of the root."""
    side = np.int64(1) << np.int64(grid.depth)
    x, y, z = low[0], low[1], low[2]
    step = width if face & 1 else -width
    a = face >> 1
    if a == 0:
        x += step
    elif a == 1:
        y += step
    else:
        z += step
    if x < 0 or y < 0 or z < 0 or x >= side or y >= side or z >= side:
        return np.int64(-1)
    return np.int64(leaf_of(grid.first, grid.entry, shift, interleaved(x, y, z, 3)))


@kernel
def _inside_between(grid, shift, vertex, sign, found):
    """Flag leaves with a vertex inside in the middle of an edge or a face whose corners are not inside.

    It is a corner of a smaller leaf, and so is one of those corners: it belongs to the parent of that leaf.
    """
    low = np.empty(3, dtype=np.int64)
    for leaf in range(len(grid.first)):
        level = grid.levels[leaf]
        if level == 0:
            continue
        up = np.int64(grid.depth - level)
        child = np.int64(0)
        for a in range(3):
            low[a] = np.int64(compacted(grid.first[leaf] >> np.uint64(a), 3)) >> up
            child |= (low[a] & 1) << a
        if sign[vertex[leaf, child]] > 0:
            continue
        for along in range(1, 7):
            if sign[vertex[leaf, child ^ along]] <= 0:
                continue
            for out in range(1, 7):  # the cells of the parent's size around, beyond its sides
                if out & along:
                    continue
                other = _beside_parent(grid, shift, low, up, child, out)
                if other >= 0 and grid.levels[other] < level:
                    found[other] = True


@inline
def _beside_parent(grid, shift, low, up, child, out):
    """The leaf in a neighbor of the parent, across the axes whose bits `out` has; -1 outside of the root."""
    side = np.int64(1) << np.int64(grid.depth)
    x, y, z = low[0] & ~1, low[1] & ~1, low[2] & ~1
    if out & 1:
        x += 2 if child & 1 else -1
    if out & 2:
        y += 2 if child & 2 else -1
    if out & 4:
        z += 2 if child & 4 else -1
    x, y, z = x << up, y << up, z << up
    if x < 0 or y < 0 or z < 0 or x >= side or y >= side or z >= side:
        return np.int64(-1)
    return np.int64(leaf_of(grid.first, grid.entry, shift, interleaved(x, y, z, 3)))


@kernel
def _background(grid, shift, vertex, leaves, sign, between, cells):
    """The tetrahedra with a vertex inside; returns how many there are, also beyond the room in `cells`.

    Such vertices are corners of leaves, their centers, or in the middle of edges or faces of those which are
    flagged in `between`.
    """
    low, ring = np.empty(3, dtype=np.int64), np.empty(9, dtype=np.int64)
    count, centers = 0, len(sign) - len(grid.first)
    for leaf in leaves:
        inside = between[leaf] or sign[centers + leaf] > 0
        for k in range(8):
            inside |= sign[vertex[leaf, k]] > 0
        level = grid.levels[leaf]
        width = np.int64(1) << np.int64(grid.depth - level)
        for a in range(3):
            low[a] = np.int64(compacted(grid.first[leaf] >> np.uint64(a), 3))
        for face in range(6):
            other = _beyond(grid, shift, low, width, face)
            same = other >= 0 and grid.levels[other] == level
            if same and face & 1 == 0:
                continue  # done from the other side
            if not inside and not (same and sign[centers + other] > 0):
                continue
            outline_of_face(grid, shift, vertex, leaf, low, face, ring)
            apex, upper = centers + leaf, face & 1
            if same or ring[8] >= 0:
                top = centers + other if same else ring[8]
                before = ring[7] if ring[7] >= 0 else ring[6]
                for k in range(8):
                    if ring[k] >= 0:
                        p, q = (before, ring[k]) if upper else (ring[k], before)
                        count = _emit(cells, count, apex, top, p, q, sign)
                        before = ring[k]
                continue
            # a larger leaf beyond: the diagonal ends in the middle of its face; or nothing, beyond the root
            a, up = face >> 1, np.int64(grid.depth - level)
            u = 1 - ((low[(a + 1) % 3] >> up) & 1)
            v = 1 - ((low[(a + 2) % 3] >> up) & 1)
            start = 2 * (3 - u if v else u)
            for k in range(1, 8, 2):
                if ring[k] >= 0:
                    start = k
            before = np.int64(-1)
            for k in range(start + 1, start + 8):
                after = ring[k & 7]
                if after >= 0 and before >= 0:
                    p, q = (before, after) if upper else (after, before)
                    count = _emit(cells, count, apex, ring[start], p, q, sign)
                before = after if after >= 0 else before
    return count


def _near(
    corners: NDArray[np.int32], sign: NDArray[np.int8], between: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """The leaves with a vertex inside, and those beside leaves with a center inside."""
    centers = len(sign) - len(corners)
    near = sign > 0
    near[corners[near[centers:]].ravel()] = True
    return np.flatnonzero(near[corners].any(axis=1) | near[centers:] | between)


def background_tetrahedra(
    grid: Grid, corners: NDArray[np.int32], sign: NDArray[np.int8], few: bool = False
) -> NDArray[np.int32]:
    """The tetrahedra over an octree that have a vertex inside.

    Parameters
    ----------
    grid : Grid
        Of a tree that is balanced across edges; no vertex on the sides of the root may be inside.
    corners : (n, 8) int32
        The corners of the leaves; see `Vertices`.
    sign : (v + n,) int8
        Of the v corners and then of the centers of the n leaves: 1 inside, 0 on the surface, -1 outside.
    few : bool
        Whether so few are inside that most leaves are better passed over at once.

    Returns
    -------
    (m, 4) int32
        Positively oriented. If the first two vertices are centers of leaves of one size, the first edge is
        long, and so is the last one.
    """
    centers = len(sign) - len(grid.first)
    shift = entries(grid.depth, 3)
    between = np.zeros(len(grid.first), dtype=np.bool_)
    _inside_between(grid, shift, corners, sign, between)
    leaves = np.arange(len(grid.first)) if not few else _near(corners, sign, between)
    room = 13 * int(np.count_nonzero(sign[centers:] > 0)) + 1000
    while True:
        cells = np.empty((room, 4), dtype=np.int32)
        count = int(_background(grid, shift, corners, leaves, sign, between, cells))
        if count <= room:
            return cells[:count]
        room = count
