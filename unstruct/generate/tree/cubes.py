"""Conforming tetrahedra of the leaves of a balanced octree: each leaf is a fan about its center.

The triangles of a face depend on the face alone, so that the leaves on its two sides agree. A face without
hanging vertices has a diagonal, the one through the center of the parent's face. If the leaves beyond are
smaller, its middle is a vertex, and the face consists of eight triangles around it, two for each of the
smaller faces. If only its edges have hanging vertices, it is a fan about the first of them. Balance across
edges excludes all else. See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from .keys import compacted, interleaved
from .lookup import Grid, entries, leaf_of
from .vertices import Vertices

__all__ = ["cubes_as_tetrahedra"]


@inline
def _smaller_at(grid, shift, level, vertex, q, beside):
    """The vertex at q, if the leaf beside it is deeper than `level`; otherwise -1.

    Bit a of `beside` tells that the leaf lies below q along axis a.
    """
    side = np.int64(1) << np.int64(grid.depth)
    x = q[0] - (beside & 1)
    y = q[1] - ((beside >> 1) & 1)
    z = q[2] - ((beside >> 2) & 1)
    if x < 0 or y < 0 or z < 0 or x >= side or y >= side or z >= side:
        return np.int64(-1)
    leaf = leaf_of(grid.first, grid.entry, shift, interleaved(x, y, z, 3))
    if grid.levels[leaf] <= level:
        return np.int64(-1)
    return np.int64(vertex[leaf, beside])  # q is the corner of the leaf on the other side of where it lies


@kernel
def _ring(grid, shift, vertex, leaf, low, face, ring):
    """The outline of a face, counterclockwise seen from its upper side, with -1 for middles that do not hang.

    Faces 2 a and 2 a + 1 are the lower and the upper one across axis a. ``ring[8]`` is the face's middle.
    """
    level = grid.levels[leaf]
    width = np.int64(1) << np.int64(grid.depth - level)
    half = width >> 1
    a, upper = face >> 1, face & 1
    b, c = (a + 1) % 3, (a + 2) % 3
    q = np.empty(3, dtype=np.int64)
    for k in range(8):
        ring[k] = -1
    ring[8] = -1
    for k in range(4):
        u, v = (k ^ (k >> 1)) & 1, k >> 1
        ring[2 * k] = vertex[leaf, (upper << a) | (u << b) | (v << c)]
    if half == 0:
        return
    q[a] = low[a] + upper * width
    q[b], q[c] = low[b] + half, low[c] + half
    out = np.int64(0) if upper else np.int64(1) << a
    ring[8] = _smaller_at(grid, shift, level, vertex, q, out)
    for k in range(4):  # the edges below, to the right, above, to the left
        along, across = (b, c) if k % 2 == 0 else (c, b)
        far = np.int64(1 if k == 1 or k == 2 else 0)
        q[along] = low[along] + half
        q[across] = low[across] + far * width
        off = np.int64(0) if far else np.int64(1) << across
        within = (np.int64(1) << across) - off  # the side of q on which the leaf itself lies
        found = _smaller_at(grid, shift, level, vertex, q, out | within)
        if found < 0:
            found = _smaller_at(grid, shift, level, vertex, q, out | off)
        if found < 0:
            inner = (np.int64(1) << a) - out
            found = _smaller_at(grid, shift, level, vertex, q, inner | off)
        ring[2 * k + 1] = found


@kernel
def _tetrahedra(grid, shift, vertex, rows, center, cells, owner):
    """The tetrahedra of the leaves `rows`; their centers are vertices from `center` on. Returns how many."""
    low, ring = np.empty(3, dtype=np.int64), np.empty(9, dtype=np.int64)
    outline = np.empty(8, dtype=np.int64)
    count = 0
    for row in range(len(rows)):
        leaf = rows[row]
        for a in range(3):
            low[a] = np.int64(compacted(grid.first[leaf] >> np.uint64(a), 3))
        up = np.int64(grid.depth - grid.levels[leaf])
        for face in range(6):
            _ring(grid, shift, vertex, leaf, low, face, ring)
            n, start = 0, 0
            for k in range(8):
                if ring[k] >= 0:
                    outline[n] = ring[k]
                    if k & 1 and start == 0:
                        start = n
                    n += 1
            a = face >> 1
            if n == 4:
                start = ((low[(a + 1) % 3] >> up) ^ (low[(a + 2) % 3] >> up)) & 1
            for t in range(n if ring[8] >= 0 else n - 2):
                first = ring[8] if ring[8] >= 0 else outline[start]
                at = t if ring[8] >= 0 else start + 1 + t
                second, third = outline[at % n], outline[(at + 1) % n]
                if face & 1 == 0:
                    second, third = third, second
                cells[count, 0], cells[count, 1] = center + row, first
                cells[count, 2], cells[count, 3] = second, third
                owner[count] = leaf
                count += 1
    return count


def cubes_as_tetrahedra(
    grid: Grid, vertices: Vertices, chosen: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int64]]:
    """Tetrahedra of the chosen leaves of an octree that is balanced across edges.

    Returns
    -------
    points : (v, 3) float64
        The vertices, and then the centers of the chosen leaves.
    cells : (t, 4) int32
    leaf : (t,) int64
        The leaf of each tetrahedron.
    """
    rows = np.flatnonzero(chosen)
    corner = vertices.points[vertices.corners[rows]]
    centers = corner[:, 0] + 0.5 * (corner[:, 7] - corner[:, 0])
    cells, owner = np.empty((48 * len(rows), 4), dtype=np.int32), np.empty(48 * len(rows), dtype=np.int64)
    count = _tetrahedra(
        grid, entries(grid.depth, 3), vertices.corners, rows, len(vertices.points), cells, owner
    )
    return np.concatenate([vertices.points, centers]), cells[:count].copy(), owner[:count].copy()
