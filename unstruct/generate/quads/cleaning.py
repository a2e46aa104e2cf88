"""Vertices of quadrilaterals get nearer to four cells each: cells are joined and collapsed, edges turned.

See the book, chapter 6c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, kernel
from .linked import (
    CELLS_IN_CROWD,
    Linked,
    across,
    are_neighbors,
    new_cell,
    place_of,
    room_at,
    sides_of,
    without_cell,
)
from .relaxing import relax, ring_of, sines
from .walking import enough_room, keep, no_worse, put_back

__all__ = ["clean"]

CHANGE_ROUNDS = 6  # of moves around a change
CHANGES_A_CALL = 5_000  # cells and vertices: Ctrl-C works between calls
FEWEST_INSIDE = 3  # cells at an inner vertex


@inline
def _excess(m, v, more):
    """The square of how far vertex v would be from its number of cells with so many more."""
    off = m.degree[v] + more - m.ideal[v]
    return off * off


@inline
def _may_lose(m, v):
    return m.degree[v] > (FEWEST_INSIDE if m.free[v] else 1)


@apart
def _join_doublet(m, v, least):
    """Two quadrilaterals alone at an inner vertex become one; whether they did."""
    if not m.free[v] or m.degree[v] != 2:
        return False
    t, o = m.at[m.place[v]], m.at[m.place[v] + 1]
    if m.cells[t, 3] < 0 or m.cells[o, 3] < 0:
        return False
    j, i = place_of(m.cells, t, v), place_of(m.cells, o, v)
    a, x, b = m.cells[t, (j + 1) % 4], m.cells[t, (j + 2) % 4], m.cells[t, (j + 3) % 4]
    y = m.cells[o, (i + 2) % 4]
    if x == y:
        return False
    m.ring[0], m.ring[1], m.ring[2], m.ring[3], m.ring[4] = a, x, b, y, v
    if not enough_room(m, 5, 1):
        return False
    keep(m, 5)
    lowest, bad = sines(m, 5, least)
    without_cell(m, t)
    without_cell(m, o)
    new_cell(m, t, (a, x, b, y))
    relax(m, 4, CHANGE_ROUNDS)
    if no_worse(m, 4, least, lowest, bad):
        return True
    put_back(m, 5)
    without_cell(m, t)
    new_cell(m, t, (v, a, x, b))
    new_cell(m, o, (v, b, y, a))
    return False


@kernel
def _collapse(m, t, least, members, rows):
    """Two opposite corners of a quadrilateral become one vertex, if fewer vertices are irregular then."""
    for k in range(2):
        u, w = m.cells[t, k], m.cells[t, k + 2]
        a, b = m.cells[t, (k + 1) % 4], m.cells[t, (k + 3) % 4]
        if not m.free[u]:
            u, w = w, u
        if not m.free[u] or not _may_lose(m, a) or not _may_lose(m, b):
            continue
        more = m.degree[u] - 2
        if max(m.degree[u], m.degree[w]) > CELLS_IN_CROWD:  # a crowd stays one when it has lost some cells
            continue
        if room_at(m, u) < 1 or room_at(m, w) < max(1, more):
            continue
        old = _excess(m, u, 0) + _excess(m, w, 0) + _excess(m, a, 0) + _excess(m, b, 0)
        if _excess(m, w, more) + _excess(m, a, -1) + _excess(m, b, -1) >= old:
            continue
        meeting = False
        count = ring_of(m, ring_of(m, 0, w), u)
        for i in range(m.place[u], m.place[u] + m.degree[u]):
            meeting = meeting or (m.at[i] != t and place_of(m.cells, m.at[i], w) >= 0)
        if meeting or _common(m, u, w) > 2:
            continue
        lowest, bad = sines(m, count, least)
        keep(m, count)
        many = m.degree[u]
        for i in range(many):
            members[i] = m.at[m.place[u] + i]
            for j in range(4):
                rows[i, j] = m.cells[members[i], j]
        for i in range(many):
            o = members[i]
            without_cell(m, o)
            if o != t:
                new_cell(m, o, _with(rows, i, u, w))
        if m.free[w]:
            m.xy[w, 0], m.xy[w, 1] = 0.5 * (m.xy[w, 0] + m.xy[u, 0]), 0.5 * (m.xy[w, 1] + m.xy[u, 1])
        relax(m, count, CHANGE_ROUNDS)
        if no_worse(m, count, least, lowest, bad):
            return True
        put_back(m, count)
        for i in range(many):
            without_cell(m, members[i])
        for i in range(many):
            new_cell(m, members[i], (rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3]))
    return False


@inline
def _with(rows, i, u, w):
    """The corners in a row, with w in the place of u."""
    return (
        w if rows[i, 0] == u else rows[i, 0],
        w if rows[i, 1] == u else rows[i, 1],
        w if rows[i, 2] == u else rows[i, 2],
        w if rows[i, 3] == u else rows[i, 3],
    )


@inline
def _common(m, u, w):
    """How many neighbors of u, which is inside, are neighbors of w."""
    count = 0
    for i in range(m.place[u], m.place[u] + m.degree[u]):
        t = m.at[i]
        v = m.cells[t, (place_of(m.cells, t, u) + 1) % sides_of(m.cells, t)]
        if are_neighbors(m, v, w):
            count += 1
    return count


@kernel
def _turn(m, t, least):
    """The edge between two quadrilaterals turns in their hexagon, if fewer vertices are irregular then."""
    for k in range(4):
        a, b = m.cells[t, k], m.cells[t, (k + 1) % 4]
        o = across(m, t, a, b)
        if o < t or m.cells[o, 3] < 0 or not _may_lose(m, a) or not _may_lose(m, b):
            continue
        c, d = m.cells[t, (k + 2) % 4], m.cells[t, (k + 3) % 4]
        j = place_of(m.cells, o, a)
        e, f = m.cells[o, (j + 1) % 4], m.cells[o, (j + 2) % 4]
        for turn in range(2):
            x, y = (e, c) if turn == 0 else (f, d)
            if x == y or are_neighbors(m, x, y):
                continue
            old = _excess(m, a, 0) + _excess(m, b, 0) + _excess(m, x, 0) + _excess(m, y, 0)
            if _excess(m, a, -1) + _excess(m, b, -1) + _excess(m, x, 1) + _excess(m, y, 1) >= old:
                continue
            m.ring[0], m.ring[1], m.ring[2], m.ring[3], m.ring[4], m.ring[5] = a, e, f, b, c, d
            if not enough_room(m, 6, 2):
                continue
            keep(m, 6)
            lowest, bad = sines(m, 6, least)
            without_cell(m, t)
            without_cell(m, o)
            if turn == 0:
                new_cell(m, t, (e, f, b, c))
                new_cell(m, o, (e, c, d, a))
            else:
                new_cell(m, t, (f, b, c, d))
                new_cell(m, o, (f, d, a, e))
            relax(m, 6, CHANGE_ROUNDS)
            if no_worse(m, 6, least, lowest, bad):
                return True
            put_back(m, 6)
            without_cell(m, t)
            without_cell(m, o)
            new_cell(m, t, (a, b, c, d))
            new_cell(m, o, (b, a, e, f))
    return False


@kernel
def _clean_some(m, least, start, stop, counts):
    members = np.empty(CELLS_IN_CROWD, dtype=np.int64)
    rows = np.empty((CELLS_IN_CROWD, 4), dtype=np.int64)
    for v in range(start, min(stop, len(m.xy))):
        if _join_doublet(m, v, least):
            counts[0] += 1
    for t in range(start, min(stop, len(m.cells))):
        if m.cells[t, 3] < 0:
            continue
        if _collapse(m, t, least, members, rows):
            counts[1] += 1
        elif _turn(m, t, least):
            counts[2] += 1


def clean(m: Linked, least: float, rounds: int, counts: NDArray[np.int64]) -> None:
    """Changes that bring vertices nearer to their numbers of cells, until there are none.

    Parameters
    ----------
    m : Linked
    least : float
        No more sines of angles are less afterwards than before.
    rounds : int
        The largest number of rounds.
    counts : (3,) int64
        Gets the numbers of doublets joined, quadrilaterals collapsed and edges turned.
    """
    for _ in range(rounds):
        before = counts.sum()
        for start in range(0, max(len(m.xy), len(m.cells)), CHANGES_A_CALL):
            _clean_some(m, least, start, start + CHANGES_A_CALL, counts)
        if counts.sum() == before:
            break
