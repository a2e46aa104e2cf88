"""A mesh as two flat arrays, told plainly: who is next to whom, what can be removed, a walk.

``cells`` is a list of rows of vertex numbers, of any dimension. Section 1 of the book.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from unstruct.base.errors import MeshError
from unstruct.plain.predicates import orient

__all__ = ["face_counts", "neighbors", "removable", "walk"]

Rows = Sequence[Sequence[int]]


def neighbors(cells: Rows) -> list[list[int]]:
    """For each cell and vertex: the cell across the opposite facet, -1 for none."""
    result = [[-1] * len(cell) for cell in cells]
    waiting: dict[frozenset, tuple[int, int]] = {}  # shown by one cell so far
    done: set[frozenset] = set()
    for t, cell in enumerate(cells):
        for i, v in enumerate(cell):
            facet = frozenset(cell) - {v}
            if facet in done:
                raise MeshError(f"facet {sorted(facet)} has a third cell, {t}")
            if facet in waiting:
                s, j = waiting.pop(facet)
                result[t][i], result[s][j] = s, t
                done.add(facet)
            else:
                waiting[facet] = t, i
    return result


def face_counts(cells: Rows) -> tuple[int, ...]:
    """(f_0, f_1, ...): the numbers of vertices, edges, ..., cells."""
    sizes = range(1, len(cells[0]) + 1)
    return tuple(len({frozenset(f) for cell in cells for f in combinations(cell, size)}) for size in sizes)


def removable(cells: Rows) -> list[int]:
    """The cells whose removal leaves a disk a disk (in space: a ball a ball)."""
    adjacent = neighbors(cells)
    boundary = set()  # all vertices, edges, ... of facets that one cell alone has
    for cell, beyond in zip(cells, adjacent):
        for v, s in zip(cell, beyond):
            rest = [u for u in cell if s < 0 and u != v]
            for k in range(len(rest)):
                boundary |= {frozenset(face) for face in combinations(rest, k + 1)}
    result = []
    for t, cell in enumerate(cells):
        opposite = frozenset(v for v, s in zip(cell, adjacent[t]) if s < 0)
        if 0 < len(opposite) < len(cell) and opposite not in boundary:
            result.append(t)
    return result


def walk(points: Any, cells: Rows, adjacent: Rows, start: int, q: Any) -> list[int]:
    """The cells on the way from ``start`` to one that contains q.

    It ends with -1 where the mesh ends, and with a cell that it has visited before
    where it goes in circles. In a planar Delaunay mesh it never does.
    """
    path = [start]
    while path[-1] >= 0 and path.count(path[-1]) == 1:
        t = path[-1]
        corners = [points[v] for v in cells[t]]
        for i in range(len(corners)):
            if orient([*corners[:i], q, *corners[i + 1 :]]) < 0:  # q is beyond facet i
                path.append(adjacent[t][i])
                break
        else:
            return path
    return path
