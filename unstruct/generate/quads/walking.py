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

import numpy as np

from ...base.jit import apart, kernel
from .linked import across, are_neighbors, new_cell, place_of, sides_of, without_cell
from .relaxing import least_sine, relax

__all__ = ["enough_room", "keep", "merged", "put_back", "stepped", "walk"]

STEP_ROUNDS = 4  # of moves around a step
MERGE_ROUNDS = 6


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
        if m.degree[m.ring[i]] + more > m.at.shape[1]:
            return False
    return True


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
        best, chosen = least, -1
        for i in range(5):
            p, q, r = m.ring[(i + 4) % 5], m.ring[i], m.ring[(i + 1) % 5]
            if not ((p == before and q == behind) or (q == before and r == behind)):
                continue
            if i > 0 and are_neighbors(m, p, r):
                continue
            _cut_pentagon(m, t, o, i)
            relax(m, 5, STEP_ROUNDS)
            sine = least_sine(m, 5)
            if sine >= best:
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
        if c == d:
            return False
        m.ring[0], m.ring[1], m.ring[2], m.ring[3] = a, d, b, c
        keep(m, 4)
        without_cell(m, t)
        without_cell(m, o)
        new_cell(m, t, (a, d, b, c))
        relax(m, 4, MERGE_ROUNDS)
        if least_sine(m, 4) >= least:
            return True
        put_back(m, 4)
        without_cell(m, t)
        new_cell(m, t, (a, b, c, np.int64(-1)))
        new_cell(m, o, (b, a, d, np.int64(-1)))
        return False
    return False


@apart
def _nearest(m, t, far, before, seen, queue):
    """The triangle that fewest quadrilaterals are in between, by a search in breadth; -1 if none is near.

    ``before`` has the way back.
    """
    seen[t], before[t], queue[0] = t, -1, t
    head, tail = 0, 1
    while head < tail and tail < far:
        s = queue[head]
        head += 1
        n = sides_of(m.cells, s)
        for k in range(n):
            o = across(m, s, m.cells[s, k], m.cells[s, (k + 1) % n])
            if o < 0 or seen[o] == t:
                continue
            seen[o], before[o] = t, s
            if m.cells[o, 3] < 0:
                return o
            queue[tail] = o
            tail += 1
    return -1


@apart
def _walk_to(m, t, way, length, least):
    """Triangle t walks along ``way[1:length]`` and merges with the last one; whether it did."""
    for i in range(1, length):
        o, then = way[i], way[i + 1]
        found = False
        for k in range(4):
            a, b = m.cells[o, k], m.cells[o, (k + 1) % 4]
            if across(m, o, a, b) == then:
                found = True
                if not stepped(m, t, o, a, b, least):
                    return False
                break
        if not found:
            return False
    return merged(m, t, way[length], least)


@kernel
def walk(m, least, far):
    """Each triangle in turn walks to the nearest other one.

    Returns how many pairs have met; a triangle that cannot go on stays where it has come to.
    """
    size = len(m.cells)
    before, way = np.empty(size + 4, dtype=np.int64), np.empty(size + 4, dtype=np.int64)
    queue = np.empty(size + 4, dtype=np.int64)
    seen = np.full(size, -1, dtype=np.int64)
    met = 0
    for t in range(size):
        if m.cells[t, 0] < 0 or m.cells[t, 3] >= 0:
            continue
        goal = _nearest(m, t, min(far, size), before, seen, queue)
        if goal < 0:
            continue
        length, o = 0, goal
        while o != t:
            o = before[o]
            length += 1
        o = goal
        for i in range(length, -1, -1):
            way[i] = o
            o = before[o]
        if _walk_to(m, t, way, length, least):
            met += 1
    return met
