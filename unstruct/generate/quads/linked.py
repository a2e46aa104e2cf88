"""Cells of three and of four corners that change: the cells of each vertex, and what is beyond a side.

A cell is a row of four vertices, counterclockwise; the last one is -1 in triangles, and all are in cells that
are gone. See the book, chapter 6c.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import angle_of
from ...base.jit import inline, kernel

__all__ = [
    "CELLS_IN_CROWD", "Linked", "across", "are_neighbors", "linked", "middle_of",
    "new_cell", "place_of", "room_at", "sides_of", "without_cell",
]  # fmt: skip

QUARTER_CIRCLE = math.pi / 2
ROOM_FOR_CELLS = 8  # cells that a vertex may have beyond those at first
# A vertex with more cells gets no others: what is done at a vertex takes time like their square.
CELLS_IN_CROWD = 64


class Linked(NamedTuple):
    """A mesh of triangles and quadrilaterals that is being changed.

    The cells at vertex v are the first ``degree[v]`` from ``at[place[v]]`` on; there is room for them up to
    ``place[v + 1]``. Vertices that are not ``free`` never move, and stay.
    ``ideal`` is how many cells a vertex should have. Between fixed vertices there may be closed sides, which
    no change crosses: those of v are to the vertices in the rows from ``start[v]`` to ``start[v + 1]`` of
    ``ends``. In ``middle`` are vertices without cells by which these sides may be divided, or -1.
    ``ring`` and ``kept`` hold the vertices around a change, and where they were, ``slopes`` is scratch, too.
    """

    xy: NDArray[np.float64]
    cells: NDArray[np.int64]
    at: NDArray[np.int64]
    place: NDArray[np.int64]
    degree: NDArray[np.int64]
    free: NDArray[np.bool_]
    ideal: NDArray[np.int64]
    start: NDArray[np.int64]
    ends: NDArray[np.int64]
    middle: NDArray[np.int64]
    ring: NDArray[np.int64]
    kept: NDArray[np.float64]
    slopes: NDArray[np.float64]


@inline
def sides_of(cells, t):
    """How many corners cell t has."""
    return 4 if cells[t, 3] >= 0 else 3


@inline
def place_of(cells, t, v):
    """At which corner of cell t vertex v is, or -1."""
    for k in range(4):
        if cells[t, k] == v:
            return k
    return -1


@inline
def across(m, t, a, b):
    """The cell beyond side ab of cell t, in which it is ba; -1 if there is none, or the side is closed."""
    if not m.free[a] and not m.free[b]:
        for k in range(m.start[a], m.start[a + 1]):
            if m.ends[k] == b:
                return -1
    v = b if m.degree[b] <= m.degree[a] else a  # that of fewer cells
    for k in range(m.place[v], m.place[v] + m.degree[v]):
        o = m.at[k]
        if o != t:
            i = place_of(m.cells, o, b)
            if i >= 0 and m.cells[o, (i + 1) % sides_of(m.cells, o)] == a:
                return o
    return np.int64(-1)


@inline
def middle_of(m, a, b):
    """The vertex by which the closed side ab may be divided; -1 if there is none."""
    if not m.free[a] and not m.free[b]:
        for k in range(m.start[a], m.start[a + 1]):
            if m.ends[k] == b:
                w = m.middle[k]
                return w if w >= 0 and m.degree[w] == 0 else np.int64(-1)
    return np.int64(-1)


@inline
def are_neighbors(m, v, w):
    """Whether an edge joins two vertices."""
    if m.degree[w] < m.degree[v]:
        v, w = w, v
    for i in range(m.place[v], m.place[v] + m.degree[v]):
        t = m.at[i]
        n = sides_of(m.cells, t)
        k = place_of(m.cells, t, v)
        if m.cells[t, (k + 1) % n] == w or m.cells[t, (k + n - 1) % n] == w:
            return True
    return False


@inline
def room_at(m, v):
    """How many more cells vertex v may get."""
    return m.place[v + 1] - m.place[v] - m.degree[v]


@kernel
def _ideals(m):
    """How many cells a vertex should have: four, beside closed sides as many right angles as fit best."""
    for v in range(len(m.xy)):
        if m.free[v]:
            continue
        total, sectors = 0, 0
        for i in range(m.place[v], m.place[v] + m.degree[v]):
            t = m.at[i]
            if across(m, t, v, m.cells[t, (place_of(m.cells, t, v) + 1) % sides_of(m.cells, t)]) >= 0:
                continue
            angle = 0.0  # of the sector that begins at this side, counterclockwise
            while t >= 0:
                n = sides_of(m.cells, t)
                k = place_of(m.cells, t, v)
                a, b = m.cells[t, (k + n - 1) % n], m.cells[t, (k + 1) % n]
                ux, uy = m.xy[b, 0] - m.xy[v, 0], m.xy[b, 1] - m.xy[v, 1]
                wx, wy = m.xy[a, 0] - m.xy[v, 0], m.xy[a, 1] - m.xy[v, 1]
                angle += angle_of(ux * wy - uy * wx, ux * wx + uy * wy)
                t = across(m, t, a, v)
            total += max(1, int(angle / QUARTER_CIRCLE + 0.5))
            sectors += 1
        if sectors > 0:
            m.ideal[v] = total


@inline
def without_cell(m, t):
    """Take cell t away."""
    for k in range(4):
        v = m.cells[t, k]
        if v >= 0:
            i = m.place[v]
            while m.at[i] != t:
                i += 1
            m.degree[v] -= 1
            m.at[i] = m.at[m.place[v] + m.degree[v]]
            m.cells[t, k] = -1


@inline
def new_cell(m, t, corners):
    """Put the cell with these corners at place t, which is empty."""
    for k in range(4):
        v = corners[k]
        m.cells[t, k] = v
        if v >= 0:
            m.at[m.place[v] + m.degree[v]] = t
            m.degree[v] += 1


@kernel
def _fill(cells, at, place, degree):
    for t in range(len(cells)):
        for k in range(4):
            v = cells[t, k]
            if v >= 0:
                at[place[v] + degree[v]] = t
                degree[v] += 1


def linked(
    xy: NDArray[np.float64],
    cells: NDArray[np.int64],
    fixed: NDArray[np.bool_],
    closed: NDArray[np.int64],
    middle: NDArray[np.int64],
) -> Linked:
    """The record of a mesh.

    Parameters
    ----------
    xy : (n, 2) float64
        Scaled; changed in place later, as ``cells`` is.
    cells : (m, 4) int64
    fixed : (n,) bool
    closed : (s, 2) int64
        Sides between fixed vertices that stay.
    middle : (s,) int64
        Vertices without cells by which they may be divided; -1 where they must not.

    Returns
    -------
    Linked
    """
    n = len(xy)
    many = np.bincount(cells[cells >= 0], minlength=n)
    place = np.concatenate([[0], np.cumsum(many + np.where(many <= CELLS_IN_CROWD, ROOM_FOR_CELLS, 0))])
    at, degree = np.full(place[-1], -1, dtype=np.int64), np.zeros(n, dtype=np.int64)
    _fill(cells, at, place, degree)
    may = middle >= 0
    parts = [
        closed,
        np.column_stack([closed[may, 0], middle[may]]),
        np.column_stack([middle[may], closed[may, 1]]),
    ]
    ends = np.concatenate(parts)
    ends = np.concatenate([ends, ends[:, ::-1]])
    halves = np.full(len(ends) // 2, -1)
    halves[: len(closed)] = middle
    halves = np.concatenate([halves, halves])
    order = np.argsort(ends[:, 0], kind="stable")
    start = np.searchsorted(ends[order, 0], np.arange(n + 1))
    scratch = 8 * (CELLS_IN_CROWD + ROOM_FOR_CELLS)  # the vertices of the cells at two vertices
    m = Linked(
        xy, cells, at, place, degree, ~fixed, np.full(n, 4), start, ends[order, 1], halves[order],
        np.empty(scratch, dtype=np.int64), np.empty((scratch, 2)), np.empty(5),
    )  # fmt: skip
    _ideals(m)
    return m
