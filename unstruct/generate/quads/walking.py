"""Triangles walk through quadrilaterals until two of them meet and are one.

A triangle and a quadrilateral with a common side fill a pentagon. One of its five ears may be the triangle
instead, and the rest the quadrilateral: so the triangle comes out at the side where it is wanted.

::

        d-------e              d-------e
       /|       |             /      _/|
      c |   o   |    becomes c   o _/  |
       t\\|       |             \\  _/  t |
        a-------b              a-------b

See the book, chapter 6c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, kernel
from .linked import Linked, across, are_neighbors, new_cell, place_of, room_at, sides_of, without_cell
from .relaxing import relax, sines

__all__ = [
    "FARTHEST_GOAL", "SEARCHES_A_CALL", "enough_room", "in_vain", "keep", "merged", "no_worse", "put_back",
    "searching", "step_on", "stepped", "walk",
]  # fmt: skip

STEP_ROUNDS = 4  # of moves around a step
MERGE_ROUNDS = 6
FARTHEST_GOAL = 4000  # quadrilaterals that a triangle looks through for another one
FAILED_STEPS = 30  # of a triangle, until it rests
SEARCHES_A_CALL = 100  # Ctrl-C works between calls


@apart
def keep(m, count):
    for i in range(count):
        m.kept[i, 0], m.kept[i, 1] = m.xy[m.ring[i], 0], m.xy[m.ring[i], 1]


@apart
def put_back(m, count):
    for i in range(count):
        m.xy[m.ring[i], 0], m.xy[m.ring[i], 1] = m.kept[i, 0], m.kept[i, 1]


@apart
def _cut_pentagon(m, t, o, i):
    """The ear at corner i of the pentagon in ``ring`` becomes triangle t, the rest quadrilateral o."""
    p, q, r = m.ring[(i + 4) % 5], m.ring[i], m.ring[(i + 1) % 5]
    without_cell(m, t)
    without_cell(m, o)
    new_cell(m, t, (p, q, r, np.int64(-1)))
    new_cell(m, o, (p, r, m.ring[(i + 2) % 5], m.ring[(i + 3) % 5]))


@apart
def enough_room(m, count, more):
    """Whether each of the first ``count`` vertices in ``ring`` may have so many cells more."""
    for i in range(count):
        if room_at(m, m.ring[i]) < more:
            return False
    return True


@apart
def no_worse(m, count, least, lowest, many):
    """Whether the cells at the vertices in ``ring`` may be as they are now.

    They may if no more sines are below ``least`` than ``many``, and none is below those that were there:
    `sines` as it was before. A positive sine has the sign of the exact area, which is far above its rounding.
    """
    now, bad = sines(m, count, least)
    return now > 0.0 and now >= min(least, lowest) and bad <= many


@kernel
def stepped(m, t, o, before, behind, least):
    """Triangle t walks through its neighbor o to the side of o from ``before`` to ``behind``.

    Whether it did: the sines of all angles around are then at least ``least``.
    """
    n = sides_of(m.cells, t)
    for k in range(n):
        a, b = m.cells[t, k], m.cells[t, (k + 1) % n]
        if across(m, t, a, b) != o:
            continue
        j = place_of(m.cells, o, a)
        m.ring[0] = m.cells[t, (k + 2) % n]
        for i in range(4):  # c, a, d, e, b
            m.ring[1 + i] = m.cells[o, (j + i) % 4]
        if not enough_room(m, 5, 2):
            return False
        keep(m, 5)
        lowest, many = sines(m, 5, least)
        best, chosen = -1.0, -1
        for i in range(5):
            p, q, r = m.ring[(i + 4) % 5], m.ring[i], m.ring[(i + 1) % 5]
            if not ((p == before and q == behind) or (q == before and r == behind)):
                continue
            if i > 0 and are_neighbors(m, p, r):
                continue
            _cut_pentagon(m, t, o, i)
            relax(m, 5, STEP_ROUNDS)
            sine, _ = sines(m, 5, least)
            if sine > best and no_worse(m, 5, least, lowest, many):
                best, chosen = sine, i
            put_back(m, 5)
        _cut_pentagon(m, t, o, chosen if chosen >= 0 else 0)
        if chosen < 0:
            return False
        relax(m, 5, STEP_ROUNDS)
        return True
    return False


@kernel
def merged(m, t, o, least):
    """Two triangles with a common side become one quadrilateral, t, if all sines around are ``least``."""
    for k in range(3):
        a, b = m.cells[t, k], m.cells[t, (k + 1) % 3]
        if across(m, t, a, b) != o:
            continue
        c, d = m.cells[t, (k + 2) % 3], m.cells[o, (place_of(m.cells, o, a) + 1) % 3]
        m.ring[0], m.ring[1], m.ring[2], m.ring[3] = a, d, b, c
        if c == d or not enough_room(m, 4, 1):
            return False
        keep(m, 4)
        lowest, many = sines(m, 4, least)
        without_cell(m, t)
        without_cell(m, o)
        new_cell(m, t, (a, d, b, c))
        relax(m, 4, MERGE_ROUNDS)
        if no_worse(m, 4, least, lowest, many):
            return True
        put_back(m, 4)
        without_cell(m, t)
        new_cell(m, t, (a, b, c, np.int64(-1)))
        new_cell(m, o, (b, a, d, np.int64(-1)))
        return False
    return False


class Search(NamedTuple):
    """Scratch of searches: the way back, those to go on from, when each cell was seen last, and the steps
    that were in vain: from a cell into another one."""

    before: NDArray[np.int64]
    queue: NDArray[np.int64]
    seen: NDArray[np.int64]
    vain: NDArray[np.int64]


def searching(m: Linked) -> Search:
    """Scratch for searches in this mesh."""
    size = len(m.cells)
    return Search(
        np.empty(size, dtype=np.int64), np.empty(size + 4, dtype=np.int64), np.full(size, -1, dtype=np.int64),
        np.empty((FAILED_STEPS, 2), dtype=np.int64),
    )  # fmt: skip


@inline
def in_vain(q, many, s, o):
    for i in range(many):
        if q.vain[i, 0] == s and q.vain[i, 1] == o:
            return True
    return False


@apart
def _nearest(m, q, t, number, many, far):
    """The triangle that fewest quadrilaterals are in between, by a search in breadth; -1 if none is near.

    The first ``many`` steps in ``vain`` are not taken. ``before`` has the way back.
    """
    q.seen[t], q.before[t], q.queue[0] = number, -1, t
    head, tail = 0, 1
    while head < tail and tail < far:
        s = q.queue[head]
        head += 1
        n = sides_of(m.cells, s)
        for k in range(n):
            o = across(m, s, m.cells[s, k], m.cells[s, (k + 1) % n])
            if o < 0 or q.seen[o] == number or in_vain(q, many, s, o):
                continue
            q.seen[o], q.before[o] = number, s
            if m.cells[o, 3] < 0:
                return o
            q.queue[tail] = o
            tail += 1
    return np.int64(-1)


@apart
def step_on(m, t, o, then, least):
    """Triangle t walks through o to the side towards ``then``; whether it did."""
    for k in range(4):
        a, b = m.cells[o, k], m.cells[o, (k + 1) % 4]
        if across(m, o, a, b) == then:
            return stepped(m, t, o, a, b, least)
    return False


@apart
def _walk_from(m, q, t, number, far, least):
    """Triangle t walks to the nearest triangle, another way round where a step fails, until they are one.

    Whether they are, and the number of the last search.
    """
    many = 0
    while many < len(q.vain):
        goal = _nearest(m, q, t, number, many, far)
        if goal < 0:
            break
        length, o = 0, goal
        while o != t:  # the way is in the queue now
            q.queue[length] = o
            length += 1
            o = q.before[o]
        for i in range(length - 1, 0, -1):
            if not step_on(m, t, q.queue[i], q.queue[i - 1], least):
                q.vain[many, 0], q.vain[many, 1] = q.queue[i], q.queue[i - 1]
                break
        else:
            if merged(m, t, goal, least):
                return True, number + 1
            q.vain[many, 0], q.vain[many, 1] = t, goal
        many += 1
        number += 1
    return False, number


@kernel
def _walk_some(m, q, start, number, far, least):
    """Triangles from ``start`` on walk, until there were many searches.

    Returns how many pairs have met, the cell to go on from, and the number of the last search.
    """
    met, first = 0, number
    for t in range(start, len(m.cells)):
        if number - first > SEARCHES_A_CALL:
            return met, t, number
        if m.cells[t, 0] >= 0 and m.cells[t, 3] < 0:
            found, number = _walk_from(m, q, np.int64(t), number + 1, far, least)
            if found:
                met += 1
    return met, len(m.cells), number


def walk(m: Linked, least: float) -> int:
    """Each triangle in turn walks to the nearest other one.

    Parameters
    ----------
    m : Linked
    least : float
        No more sines of angles are less after a step or a merger than before.

    Returns
    -------
    int
        How many pairs have met. After 30 failed steps a triangle stays where it has come to, and it sees
        others through at most 4000 quadrilaterals.
    """
    q, t, number, total = searching(m), 0, 0, 0
    while t < len(m.cells):
        met, t, number = _walk_some(m, q, t, number, min(FARTHEST_GOAL, len(m.cells)), least)
        total += int(met)
    return total
