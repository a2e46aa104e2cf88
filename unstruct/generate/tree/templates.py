"""Conforming meshes of the leaves of a balanced tree, from templates.

In the plane a square without hanging vertices becomes two right triangles; another is a fan about its center,
whose triangles are right and isosceles, too, so that all angles are 45 or 90 degrees. In space each leaf is
a fan of tetrahedra about its center; the triangles of its faces depend on the vertices of the face alone, so
that both sides of a face agree. See the book, chapters 4b and 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from .keys import compacted, interleaved
from .lookup import Grid, entries, leaf_of
from .vertices import Vertices

__all__ = ["squares_as_triangles"]

MOST_TRIANGLES = 8  # of a square: two for each side with a hanging vertex


@inline
def _middle(grid, shift, x, y, level, vertex, which):
    """The vertex in the middle of one side of a square; -1 if there is none.

    `which` is 0 for the side below, 1 for that to the right, 2 above, 3 to the left. The square beyond has
    smaller leaves if and only if that in its middle, beside the side, is one level deeper: one of its corners
    is the middle.
    """
    width = np.int64(1) << np.int64(grid.depth - level)
    half = width >> 1
    side = np.int64(1) << np.int64(grid.depth)
    if half == 0:
        return np.int64(-1)
    if which == 0:
        px, py, c = x + half, y - half, 2
    elif which == 1:
        px, py, c = x + width, y + half, 0
    elif which == 2:
        px, py, c = x + half, y + width, 0
    else:
        px, py, c = x - half, y + half, 1
    if px < 0 or py < 0 or px >= side or py >= side:
        return np.int64(-1)
    leaf = leaf_of(grid.first, grid.entry, shift, interleaved(px, py, np.int64(0), 2))
    if grid.levels[leaf] <= level:
        return np.int64(-1)
    return np.int64(vertex[leaf, c])


@kernel
def _middles(grid, shift, vertex, middles):
    """The hanging vertices of the four sides of each square, in the order of its outline."""
    for leaf in range(len(grid.first)):
        x = np.int64(compacted(grid.first[leaf], 2))
        y = np.int64(compacted(grid.first[leaf] >> np.uint64(1), 2))
        for k in range(4):
            middles[leaf, k] = _middle(grid, shift, x, y, grid.levels[leaf], vertex, k)


@kernel
def _squares(vertex, middles, center, odd, cells, owner):
    """The triangles of all squares; ``center[i]`` is the vertex in the middle of square i, or -1."""
    ring = np.empty(8, dtype=np.int32)
    count = 0
    for leaf in range(len(vertex)):
        around = 0
        for k in range(4):
            ring[around] = vertex[leaf, k ^ (k >> 1)]  # 0, 1, 3, 2: counterclockwise
            around += 1
            if middles[leaf, k] >= 0:
                ring[around] = middles[leaf, k]
                around += 1
        triangles = around if center[leaf] >= 0 else 2
        for t in range(triangles):
            if center[leaf] >= 0:
                cells[count, 0], cells[count, 1] = center[leaf], ring[t]
                cells[count, 2] = ring[(t + 1) % around]
            else:
                cells[count, 0] = ring[odd[leaf]]
                cells[count, 1] = ring[(odd[leaf] + 1 + t) & 3]
                cells[count, 2] = ring[(odd[leaf] + 2 + t) & 3]
            owner[count] = leaf
            count += 1
    return count


def squares_as_triangles(
    grid: Grid, vertices: Vertices, chosen: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int64]]:
    """Triangles of the chosen leaves of a quadtree that is balanced across faces.

    Returns
    -------
    points : (v, 2) float64
        The vertices, and then the centers of the squares with hanging vertices.
    cells : (t, 3) int32
    leaf : (t,) int64
        The leaf of each triangle.
    """
    middles = np.empty((len(grid.first), 4), dtype=np.int32)
    _middles(grid, entries(grid.depth, 2), vertices.corners, middles)
    fan: NDArray[np.bool_] = (middles >= 0).any(axis=1)
    center = np.full(len(fan), -1, dtype=np.int32)
    center[fan] = len(vertices.points) + np.arange(int(fan.sum()))
    corner = vertices.points[vertices.corners[fan]]
    middle = corner[:, 0] + 0.5 * (corner[:, 3] - corner[:, 0])
    # diagonals alternate, as on the board of a game, so that no direction is preferred
    width = np.int64(1) << (grid.depth - grid.levels.astype(np.int64))
    odd = (vertices.coordinates[: len(fan)] // width[:, None]).sum(axis=1) & 1
    room = int(np.where(fan, MOST_TRIANGLES, 2)[chosen].sum())
    cells, owner = np.empty((room, 3), dtype=np.int32), np.empty(room, dtype=np.int64)
    rows = np.flatnonzero(chosen)
    count = _squares(vertices.corners[rows], middles[rows], center[rows], odd[rows], cells, owner)
    return np.concatenate([vertices.points, middle]), cells[:count], rows[owner[:count]]
