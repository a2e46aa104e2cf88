"""Chains of facets that an open boundary needs closed, or made inner: a part of ``resolve=True``.

An open boundary bounds nothing, and what was meant is unknown. Two cases are repaired. If a chain that is a
single path has a gap no longer than its longest piece, a facet closes the gap. Otherwise short chains of
facets between odd vertices (ends of an odd number of facets) become inner pieces. So a slit, an inner wall,
or a loose end that was given as a facet appears in the mesh and bounds nothing.
"""

from __future__ import annotations

import heapq
from collections import Counter
from math import hypot
from typing import NamedTuple

import numpy as np

__all__ = ["Chain", "open_chains"]

Around = dict[int, list[int]]  # the facets (rows) at each vertex


class Chain(NamedTuple):
    """Facets to be mended together.

    Attributes
    ----------
    rows : list of int
    ends : list of int
        Its odd vertices.
    closing : bool
        Whether a facet between the two ends closes it; otherwise its facets become inner.
    """

    rows: list[int]
    ends: list[int]
    closing: bool


def open_chains(points: np.ndarray, ends: np.ndarray, facet: np.ndarray) -> list[Chain]:
    """The chains to be mended so that an even number of facets meets at every vertex.

    Parameters
    ----------
    points : (n, 2) float64
    ends : (m, 2) int64
        The vertices of all pieces.
    facet : (m,) bool
        Which of them are facets.

    Notes
    -----
    O(m log m) for few odd vertices; each pair of odd vertices costs a search for the shortest path.
    """
    rows = np.nonzero(facet)[0]
    degree = np.bincount(ends[rows].ravel(), minlength=len(points))
    odd = np.nonzero(degree % 2)[0].tolist()
    if not odd:
        return []
    at: Around = {}
    for row, pair in zip(rows.tolist(), ends[rows].tolist()):
        for v in pair:
            at.setdefault(v, []).append(row)
    join: dict[int, None] = {}
    waiting = set(odd)
    for v in odd:
        if v in waiting:
            end, path = _nearest_odd(points, ends, at, v, waiting)
            waiting -= {v, end}
            for row in path:
                if row in join:
                    del join[row]
                else:
                    join[row] = None
    forest = _without_cycles(ends, list(join), set(odd))
    return [_chain(points, ends, chain, at, set(forest)) for chain in _connected(ends, forest)]


def _chain(points: np.ndarray, ends: np.ndarray, rows: list[int], at: Around, join: set[int]) -> Chain:
    degrees = Counter(ends[rows].ravel().tolist())
    odd = [v for v, k in degrees.items() if k % 2]
    whole = all(row in join for v in degrees for row in at[v])
    if not (whole and len(odd) == 2 and max(degrees.values()) == 2 and len(rows) > 1):
        return Chain(rows, odd, False)
    gap = hypot(*(points[odd[0]] - points[odd[1]]))
    longest = max(hypot(*(points[a] - points[b])) for a, b in ends[rows])
    return Chain(rows, odd, gap <= longest)


def _connected(ends: np.ndarray, rows: list[int]) -> list[list[int]]:
    parent: dict[int, int] = {}

    def root(v: int) -> int:
        while parent.setdefault(v, v) != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for a, b in ends[rows].tolist():
        parent[root(a)] = root(b)
    groups: dict[int, list[int]] = {}
    for row in rows:
        groups.setdefault(root(int(ends[row, 0])), []).append(row)
    return list(groups.values())


def _without_cycles(ends: np.ndarray, rows: list[int], odd: set[int]) -> list[int]:
    """Those pieces of a spanning forest that have an odd number of odd vertices on either side."""
    at: Around = {}
    for row in rows:
        for v in ends[row].tolist():
            at.setdefault(v, []).append(row)
    order: list[tuple[int, int, int]] = []  # vertex, its parent, the piece between, parents first
    seen: set[int] = set()
    for root in at:
        if root in seen:
            continue
        seen.add(root)
        stack = [root]
        while stack:
            v = stack.pop()
            for row in at[v]:
                other = _other(ends, row, v)
                if other not in seen:
                    seen.add(other)
                    order.append((other, v, row))
                    stack.append(other)
    below = {v: v in odd for v in at}
    kept = []
    for v, parent, row in reversed(order):
        if below[v]:
            kept.append(row)
            below[parent] = not below[parent]
    return kept


def _other(ends: np.ndarray, row: int, v: int) -> int:
    a, b = ends[row].tolist()
    return b if a == v else a


def _nearest_odd(
    points: np.ndarray, ends: np.ndarray, at: Around, start: int, waiting: set[int]
) -> tuple[int, list[int]]:
    """The nearest odd vertex along facets, and the path to it (Dijkstra).

    There is one, because each connected part has an even number of odd vertices.
    """
    done: dict[int, tuple[int, int]] = {}
    queue: list[tuple[float, int, int, int]] = [(0.0, start, start, -1)]
    while queue:
        length, v, before, row = heapq.heappop(queue)
        if v in done:
            continue
        done[v] = before, row
        if v != start and v in waiting:
            path, end = [], v
            while done[v][1] >= 0:
                path.append(done[v][1])
                v = done[v][0]
            return end, path
        for side in at[v]:
            other = _other(ends, side, v)
            if other not in done:
                step = hypot(*(points[v] - points[other]))
                heapq.heappush(queue, (length + step, other, v, side))
    raise AssertionError("a graph with a single odd vertex")
