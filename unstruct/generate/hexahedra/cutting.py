"""Tetrahedra of the leaves of an octree, cut where the surface of a body crosses their edges.

A leaf that the surface meets is divided into the tetrahedra of `generate.tree.cubes`. Of each, what lies on
the inner side of its cut edges is kept: a tetrahedron, a pyramid or a wedge, of which tetrahedra are made so
that neighbors agree. See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.boxes import BoxTree, bounding_boxes
from ...mesh.grouping import group_rows
from ...mesh.split import simplices_of_cells
from ...predicates.batch import orient_rows, power_of_two
from ...predicates.kernels import orient3

__all__ = ["crossings", "cut_cells", "positive_places"]

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
NEAREST_CUT = 1.0 / 32  # how near to an end an edge is cut; unit: its length
EDGES_CUT_AT_ONCE = 1 << 16  # to bound the memory
VERTEX_IN, VERTEX_ON, VERTEX_OUT = 1, 0, -1

# For numbers of corners (inside, on the surface): the kind of cell, and its corners as corners of the
# tetrahedron (k, k) or as cuts of its edges (i, j). The corners inside come first, then those on the surface.
PATTERNS: dict[tuple[int, int], tuple[str, list[tuple[int, int]]]] = {
    (1, 0): ("tetra", [(0, 0), (0, 1), (0, 2), (0, 3)]),
    (1, 1): ("tetra", [(0, 0), (1, 1), (0, 2), (0, 3)]),
    (1, 2): ("tetra", [(0, 0), (1, 1), (2, 2), (0, 3)]),
    (2, 0): ("wedge", [(0, 0), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3)]),
    (2, 1): ("pyramid", [(0, 0), (0, 3), (1, 3), (1, 1), (2, 2)]),
    (3, 0): ("wedge", [(0, 0), (1, 1), (2, 2), (0, 3), (1, 3), (2, 3)]),
}


def cut_cells(cells: NDArray[np.int32], side: NDArray[np.int8], n: int) -> tuple[NDArray[np.int32], Rows]:
    """What is left of tetrahedra on the inner side.

    Parameters
    ----------
    cells : (t, 4) int32
        Positive tetrahedra with corners inside and outside.
    side : (n,) int8
        `VERTEX_IN`, `VERTEX_ON` or `VERTEX_OUT` for each vertex.
    n : int
        The number of vertices; cuts of edges are numbered from there on.

    Returns
    -------
    simplices : (s, 4) int32
    edges : (e, 2) int64
        The edges that are cut, from the end inside to the one outside.
    """
    rank = -side[cells].astype(np.int64)
    order = np.argsort(rank, axis=1, kind="stable")
    rows = np.take_along_axis(cells, order, axis=1).astype(np.int64)
    _make_even(rows, order, np.take_along_axis(rank, order, axis=1))
    inside, on = (side[cells] == VERTEX_IN).sum(axis=1), (side[cells] == VERTEX_ON).sum(axis=1)
    ends, corners = [np.empty((0, 2), dtype=np.int64)], []
    for (k, m), (kind, pattern) in PATTERNS.items():
        which = np.flatnonzero((inside == k) & (on == m))
        corners.append((kind, pattern, which))
        ends += [rows[which][:, [i, j]] for i, j in pattern if i != j]
    every = np.concatenate(ends)
    number, first = group_rows(every)
    blocks: dict[str, list[NDArray[np.int64]]] = {"tetra": [], "pyramid": [], "wedge": []}
    begin = 0
    for kind, pattern, which in corners:
        columns = []
        for i, j in pattern:
            if i == j:
                columns.append(rows[which, i])
            else:
                columns.append(n + number[begin : begin + len(which)])
                begin += len(which)
        blocks[kind].append(np.stack(columns, axis=1))
    simplices, _ = simplices_of_cells({kind: np.concatenate(parts) for kind, parts in blocks.items()})
    return simplices, every[first]


def _make_even(rows: Rows, order: Rows, rank: Rows) -> None:
    """Exchange two corners of the same side where sorting has turned a cell around."""
    i, j = np.triu_indices(4, 1)
    odd = np.flatnonzero((order[:, i] > order[:, j]).sum(axis=1) % 2 == 1)
    at = (rank[odd, 1:] == rank[odd, :-1]).argmax(axis=1)
    first, second = rows[odd, at], rows[odd, at + 1]
    rows[odd, at], rows[odd, at + 1] = second, first


# ---------------------------------------------------------------------- where edges are cut


@kernel
def _cross(xyz, ends, triangles, query, hit, place):
    """For each edge the least share at which it meets one of its triangles: whether it does is exact."""
    for k in range(len(query)):
        p, q, t = ends[query[k], 0], ends[query[k], 1], triangles[hit[k]]
        one = _side(xyz, t[0], t[1], t[2], p)
        two = _side(xyz, t[0], t[1], t[2], q)
        if one * two > 0 or (one == 0 and two == 0):
            continue
        a, b, c = _side(xyz, p, q, t[0], t[1]), _side(xyz, p, q, t[1], t[2]), _side(xyz, p, q, t[2], t[0])
        if max(a, b, c) > 0 and min(a, b, c) < 0:
            continue
        near, far = _six(xyz, t[0], t[1], t[2], p), _six(xyz, t[0], t[1], t[2], q)
        share = 0.5 if near == far else near / (near - far)
        place[query[k]] = min(place[query[k]], min(max(share, 0.0), 1.0))


@kernel
def _side(xyz, a, b, c, d):
    return orient3(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2],
        xyz[c, 0], xyz[c, 1], xyz[c, 2], xyz[d, 0], xyz[d, 1], xyz[d, 2],
    )  # fmt: skip


@kernel
def _six(xyz, a, b, c, d):
    """Six times the volume of a tetrahedron, rounded."""
    total = 0.0
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        total += (xyz[d, k] - xyz[a, k]) * (
            (xyz[b, i] - xyz[a, i]) * (xyz[c, j] - xyz[a, j])
            - (xyz[b, j] - xyz[a, j]) * (xyz[c, i] - xyz[a, i])
        )
    return total


def crossings(points: Array, ends: Rows, corners: Array, triangles: NDArray[np.integer]) -> Array:
    """Where edges first cross a surface, as shares of their lengths from the first end: (e,).

    Parameters
    ----------
    points : (n, 3) float64
    ends : (e, 2) int64
        The first end inside, the second outside.
    corners : (m, 3) float64
        The points of the surface.
    triangles : (t, 3) int
    """
    factor = power_of_two(np.concatenate([points, corners]))
    xyz = np.concatenate([points, corners]) * factor
    rows = triangles.astype(np.int64) + len(points)
    tree = BoxTree(*bounding_boxes(xyz[rows]))
    place = np.full(len(ends), np.inf)
    for i in range(0, len(ends), EDGES_CUT_AT_ONCE):
        part = ends[i : i + EDGES_CUT_AT_ONCE]
        query, hit = tree.pairs(*bounding_boxes(xyz[part]))
        _cross(xyz, part, rows, query, hit, place[i : i + EDGES_CUT_AT_ONCE])
    return np.where(np.isfinite(place), place, 0.5).clip(NEAREST_CUT, 1.0 - NEAREST_CUT)


def positive_places(
    points: Array, edges: Rows, place: Array, simplices: NDArray[np.int32]
) -> tuple[Array, int]:
    """All points, with the cuts of edges at places for which all cells are positive, and how many were moved.

    Cells that are not positive by rounding, which takes leaves of few units of rounding, have their edges cut
    in the middle.
    """
    n, moved = len(points), np.zeros(len(place), dtype=bool)
    place = place.copy()
    while True:
        first, second = points[edges].transpose(1, 0, 2)
        every = np.concatenate([points, first + place[:, None] * (second - first)])
        wrong = simplices[orient_rows(every, simplices) <= 0]
        cuts = np.unique(wrong[wrong >= n]) - n
        cuts = cuts[~moved[cuts]]
        if len(cuts) == 0:
            return every, int(moved.sum())
        place[cuts], moved[cuts] = 0.5, True
