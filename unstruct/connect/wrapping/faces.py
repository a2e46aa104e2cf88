"""Kernel of gift wrapping: a queue of half-faces, each of which finds its apex (2D and 3D).

A half-face is a number h = cell (d + 1) + k, the facet opposite corner k seen from the cell; beyond it lies
its free side. Open half-faces hang in a hash table by their vertices (``heads``, ``following``), where the
next cell on the same vertices finds them. A face of a prescribed front is the half-face k = d of a *base*,
a row of ``cells`` without apex: bases come first and are cut off in the end.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import DONE, ROOM
from ...base.jit import inline, kernel
from .apex import NO_APEX, SEEN, find_apex

__all__ = ["STUCK", "open_face", "wrap"]

STUCK = 8  # how `wrap` ends, or DONE, ROOM
# neighbors beyond a half-face, before there is a cell: still to come; none (the hull); taken over
TO_COME, HULL, TAKEN = -2, -1, -3
# counters
CELL_COUNT, QUEUE_FIRST, QUEUE_LAST, OPEN_FACES = range(4)


@inline
def bucket_of(cells, c, k, heads):
    """The same number for the same vertices in any order."""
    key = 0
    for j in range(cells.shape[1]):
        if j != k:
            key += (np.int64(cells[c, j]) * 1000003) % 2147483647
    return key & (len(heads) - 1)


@kernel
def find_open(cells, c, k, heads, following):
    """The open half-face on the vertices of facet (c, k), or -1."""
    w = cells.shape[1]
    h = heads[bucket_of(cells, c, k, heads)]
    while h >= 0:
        same = True
        for j in range(w):
            if j != k:
                found = False
                for i in range(w):
                    found = found or (i != h % w and cells[h // w, i] == cells[c, j])
                same = same and found
        if same:
            return h
        h = following[h]
    return -1


@kernel
def open_face(cells, h, heads, following, opened, position, counters):
    """Hang the half-face into the table and the list."""
    w = cells.shape[1]
    bucket = bucket_of(cells, h // w, h % w, heads)
    following[h] = heads[bucket]
    heads[bucket] = h
    opened[counters[OPEN_FACES]] = h
    position[h] = counters[OPEN_FACES]
    counters[OPEN_FACES] += 1


@kernel
def close_face(cells, h, heads, following, opened, position, counters):
    """Take the half-face out of the table and the list."""
    w = cells.shape[1]
    bucket = bucket_of(cells, h // w, h % w, heads)
    if heads[bucket] == h:
        heads[bucket] = following[h]
    else:
        g = heads[bucket]
        while following[g] != h:
            g = following[g]
        following[g] = following[h]
    counters[OPEN_FACES] -= 1
    last = opened[counters[OPEN_FACES]]
    opened[position[h]] = last
    position[last] = position[h]


@kernel
def opposite(cells, c, k, other, i):
    """Do two cells on one facet, (c, k) and (other, i), lie on opposite sides of it, both positive?

    They do where it takes an odd permutation to bring the corners of one in the order of the other, the
    corners off the facet identified.
    """
    w = cells.shape[1]
    place = np.empty(w, dtype=np.int64)
    inversions = 0
    for j in range(w):
        place[j] = k
        for m in range(w):
            if m != k and j != i and cells[c, m] == cells[other, j]:
                place[j] = m
        for m in range(j):
            inversions += 1 if place[m] > place[j] else 0
    return inversions % 2 == 1


@kernel
def join(cells, neighbors, c, k, bases, heads, following, opened, position, queue, counters):
    """Facet k of the new cell c meets the open half-faces on its vertices, or waits itself.

    A base on this facet is served where c lies on its free side (a cell may still come from behind: the
    facet stays open, without waiting), and taken over where c lies behind.
    """
    w = cells.shape[1]
    linked, served, taken = False, False, False
    h = find_open(cells, c, k, heads, following)
    while h >= 0:
        close_face(cells, h, heads, following, opened, position, counters)
        other, i = h // w, h % w
        if other >= bases:
            neighbors[c, k], neighbors[other, i] = other, c
            linked = True
        elif opposite(cells, c, k, other, i):
            neighbors[other, i] = c
            served = True
        else:
            neighbors[other, i] = TAKEN
            taken = True
        h = find_open(cells, c, k, heads, following)
    if not linked:
        open_face(cells, c * w + k, heads, following, opened, position, counters)
        neighbors[c, k] = HULL
        if taken or not served:
            neighbors[c, k] = TO_COME
            queue[counters[QUEUE_LAST]] = c * w + k
            counters[QUEUE_LAST] += 1


@kernel
def wrap(
    points, rank, start, size, low, high, cells, neighbors, front,
    heads, following, opened, position, queue, counters, steps,
):  # fmt: skip
    """Serve up to ``steps`` half-faces of the queue; return why it stopped, and for STUCK the half-face.

    ``front``: the faces of the bases, or None.
    """
    d = points.shape[1]
    bases = 0 if front is None else len(front)
    work = (np.empty(256, np.int64), np.empty(d), np.empty(d), np.empty(d))
    row = np.empty(d + 1, np.int64)
    for _ in range(steps):
        if counters[QUEUE_FIRST] == counters[QUEUE_LAST]:
            break
        if counters[CELL_COUNT] == len(cells):
            return ROOM, -1
        h = queue[counters[QUEUE_FIRST]]
        counters[QUEUE_FIRST] += 1
        c, k = h // (d + 1), h % (d + 1)
        if neighbors[c, k] != TO_COME:
            continue
        for j in range(d + 1):
            row[j] = cells[c, j]
        i, j = (k + 1) % (d + 1), (k + 2) % (d + 1)
        row[i], row[j] = row[j], row[i]  # seen from the free side
        if front is None:  # decided when compiled: without a front there is nothing to be in the way
            q = find_apex(points, rank, start, size, low, high, row, k, cells, None, work)
        else:
            obstacles = opened[: counters[OPEN_FACES]]
            q = find_apex(points, rank, start, size, low, high, row, k, cells, obstacles, work)
        if q == NO_APEX:
            neighbors[c, k] = HULL
            close_face(cells, h, heads, following, opened, position, counters)
        elif q == SEEN:
            return STUCK, h
        else:
            new = counters[CELL_COUNT]
            counters[CELL_COUNT] += 1
            for j in range(d + 1):
                cells[new, j] = row[j]
            cells[new, k] = q
            for j in range(d + 1):
                join(cells, neighbors, new, j, bases, heads, following, opened, position, queue, counters)
    return DONE, -1
