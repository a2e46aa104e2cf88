"""Kernel of gift wrapping: a queue of half-faces, for each of which an apex is found (2D and 3D).

A half-face is a number h = cell * (d + 1) + k. It is the facet opposite corner k, seen from the cell; beyond
it lies its free side. Open half-faces are in a hash table by their vertices (``heads``, ``following``), where
the next cell with the same vertices finds them. A face of a prescribed front is the half-face k = d of a
*base*, which is a row of ``cells`` without apex. Bases come first and are removed at the end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, ROOM
from ...base.jit import inline, kernel
from .apex import NO_APEX, SEEN, find_apex

__all__ = ["STUCK", "open_face", "wrap"]

STUCK = 8  # a result of `wrap`; the others are DONE and ROOM
# What `neighbors` contains beyond a half-face without a neighboring cell. TO_COME: the face is still in the
# queue. HULL: no cell follows, because the face is on the hull. TAKEN: a cell behind the face has taken its
# place.
TO_COME, HULL, TAKEN = -2, -1, -3
# The places of `counters`: the number of cells, the first and the end of the queue, the number of open faces.
CELL_COUNT, QUEUE_FIRST, QUEUE_LAST, OPEN_FACES = range(4)


@inline
def bucket_of(cells, c, k, heads):
    """The number of the bucket, which is the same for the same vertices in any order."""
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
    """Insert the half-face into the table and the list."""
    w = cells.shape[1]
    bucket = bucket_of(cells, h // w, h % w, heads)
    following[h] = heads[bucket]
    heads[bucket] = h
    opened[counters[OPEN_FACES]] = h
    position[h] = counters[OPEN_FACES]
    counters[OPEN_FACES] += 1


@kernel
def close_face(cells, h, heads, following, opened, position, counters):
    """Remove the half-face from the table and the list."""
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
    """Whether two positive cells with a common facet, (c, k) and (other, i), lie on opposite sides of it.

    They do exactly when an odd permutation brings the corners of one into the order of the other, where the
    two corners opposite the facet are identified.
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


class Open(NamedTuple):
    """The open half-faces: a hash table, a list with the place of each in it, and the queue."""

    heads: NDArray[np.int64]
    following: NDArray[np.int64]
    opened: NDArray[np.int64]
    position: NDArray[np.int64]
    queue: NDArray[np.int64]
    counters: NDArray[np.int64]


@kernel
def join(cells, neighbors, c, k, bases, waiting):
    """Join facet k of the new cell c to the open half-faces with its vertices, or put it into the queue.

    A base on this facet is done if c lies on its free side; a cell may still come from behind, so the facet
    stays open, but it is not queued. If c lies behind the base, the facet takes the place of the base.
    """
    heads, following, opened, position, queue, counters = waiting
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
def wrap(sites, cells, neighbors, front, waiting, steps):
    """Process up to ``steps`` half-faces of the queue; return why it stopped, and for STUCK the half-face.

    ``front`` has the faces of the bases, or is None.
    """
    heads, following, opened, position, queue, counters = waiting
    d = sites.points.shape[1]
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
        if front is None:  # decided at compilation: without a front there are no obstacles
            q = find_apex(sites, row, k, cells, None, work)
        else:
            obstacles = opened[: counters[OPEN_FACES]]
            q = find_apex(sites, row, k, cells, obstacles, work)
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
                join(cells, neighbors, new, j, bases, waiting)
    return DONE, -1
