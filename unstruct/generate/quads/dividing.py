"""Triangles walk to the boundary and are gone there, since a side of it is divided.

A triangle at the boundary and a quadrilateral beside it fill a pentagon. With a point on the side that lies
on the boundary it is a hexagon, which falls into two quadrilaterals.

::

        c-------e              c-------e
       / \\\\       \\           /       / \\
      /   \\\\   o   \\  becomes /   t   /   \\
     /  t  \\\\       \\        /       / o   \\
    a-------b-------d      a---m---b-------d

See the book, chapter 6c.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline, kernel
from .linked import Linked, across, middle_of, new_cell, place_of, sides_of, without_cell
from .relaxing import relax, sines
from .walking import (
    FARTHEST_GOAL,
    SEARCHES_A_CALL,
    enough_room,
    in_vain,
    keep,
    no_worse,
    put_back,
    searching,
    step_on,
    stepped,
)

__all__ = ["divide"]

DIVISION_ROUNDS = 6  # of moves around a division
CELLS_AT_SIDE = 2  # cells at a vertex on a straight side


@inline
def _side_to_divide(m, q, many, t):
    """The first corner of a side of cell t that may be divided, and was not tried in vain; -1 if none is."""
    n = sides_of(m.cells, t)
    for k in range(n):
        a, b = m.cells[t, k], m.cells[t, (k + 1) % n]
        if middle_of(m, a, b) >= 0 and not in_vain(q, many, -2 - a, b):
            return k
    return -1


@apart
def _nearest_side(m, q, t, number, many, far):
    """The nearest cell to t, or t, with a side that may be divided; ``before`` has the way back."""
    q.seen[t], q.before[t], q.queue[0] = number, -1, t
    head, tail = 0, 1
    while head < tail and tail < far:
        s = q.queue[head]
        head += 1
        if _side_to_divide(m, q, many, s) >= 0:
            return s
        n = sides_of(m.cells, s)
        for k in range(n):
            o = across(m, s, m.cells[s, k], m.cells[s, (k + 1) % n])
            if o < 0 or q.seen[o] == number or m.cells[o, 3] < 0 or in_vain(q, many, s, o):
                continue
            q.seen[o], q.before[o] = number, s
            q.queue[tail] = o
            tail += 1
    return np.int64(-1)


@kernel
def divided(m, t, k, least):
    """Side k of triangle t is divided, so that it becomes a quadrilateral, as its neighbor does again.

    Whether it was: the sines of the angles around are then no worse than `no_worse` says.
    """
    a, b, c = m.cells[t, k], m.cells[t, (k + 1) % 3], m.cells[t, (k + 2) % 3]
    w = middle_of(m, a, b)
    for turn in range(2):
        o = across(m, t, b, c) if turn == 0 else across(m, t, c, a)
        if o < 0 or m.cells[o, 3] < 0:
            continue
        j = place_of(m.cells, o, c if turn == 0 else a)  # o is c, b, d, e or a, c, d, e
        d, e = m.cells[o, (j + 2) % 4], m.cells[o, (j + 3) % 4]
        m.ring[0], m.ring[1], m.ring[2], m.ring[3], m.ring[4], m.ring[5] = a, b, c, d, e, w
        if not enough_room(m, 6, 2):
            continue
        keep(m, 6)
        lowest, bad = sines(m, 5, least)
        without_cell(m, t)
        without_cell(m, o)
        if turn == 0:
            new_cell(m, t, (a, w, e, c))
            new_cell(m, o, (w, b, d, e))
        else:
            new_cell(m, t, (w, b, c, d))
            new_cell(m, o, (a, w, d, e))
        relax(m, 6, DIVISION_ROUNDS)
        if no_worse(m, 6, least, lowest, bad):
            m.ideal[w] = CELLS_AT_SIDE
            return True
        put_back(m, 6)
        without_cell(m, t)
        without_cell(m, o)
        new_cell(m, t, (a, b, c, np.int64(-1)))
        if turn == 0:
            new_cell(m, o, (c, b, d, e))
        else:
            new_cell(m, o, (a, c, d, e))
    return False


@apart
def _walk_to_side(m, q, t, number, far, least):
    """Triangle t walks to the nearest side that may be divided; another way, or to another, where this fails.

    Whether the triangle is gone, and the number of the last search.
    """
    many = 0
    while many < len(q.vain):
        goal = _nearest_side(m, q, t, number, many, far)
        if goal < 0:
            break
        k = _side_to_divide(m, q, many, goal)
        n = sides_of(m.cells, goal)
        a, b = m.cells[goal, k], m.cells[goal, (k + 1) % n]
        length, o = 0, goal
        while o != t:
            q.queue[length] = o
            length += 1
            o = q.before[o]
        for i in range(length - 1, 0, -1):
            if not step_on(m, t, q.queue[i], q.queue[i - 1], least):
                q.vain[many, 0], q.vain[many, 1] = q.queue[i], q.queue[i - 1]
                break
        else:
            if length == 0 or stepped(m, t, goal, a, b, least):
                for k in range(3):
                    if m.cells[t, k] == a and divided(m, t, k, least):
                        return True, number + 1
            q.vain[many, 0], q.vain[many, 1] = -2 - a, b
        many += 1
        number += 1
    return False, number


@kernel
def _divide_some(m, q, start, number, far, least):
    gone, first = 0, number
    for t in range(start, len(m.cells)):
        if number - first > SEARCHES_A_CALL:
            return gone, t, number
        if m.cells[t, 0] >= 0 and m.cells[t, 3] < 0:
            found, number = _walk_to_side(m, q, np.int64(t), number + 1, far, least)
            if found:
                gone += 1
    return gone, len(m.cells), number


def divide(m: Linked, least: float) -> int:
    """Each triangle in turn walks to a side that may be divided, and is gone there.

    Parameters
    ----------
    m : Linked
    least : float
        No more sines of angles are less after a step or a division than before.

    Returns
    -------
    int
        How many are gone.
    """
    q, t, number, total = searching(m), 0, 0, 0
    while t < len(m.cells):
        gone, t, number = _divide_some(m, q, t, number, min(FARTHEST_GOAL, len(m.cells)), least)
        total += int(gone)
    return total
