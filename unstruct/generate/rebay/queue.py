"""The queue of waiting triangles, ordered by their measure and compiled.

The queue consists of buckets, each a doubly linked list of slots. The measure is the square of R / f (or of
another quotient alpha). Two buckets an octave do as well as an exact order. They need no heap, and they have
no stale entries: a triangle that is removed is unlinked at once.

Within a bucket the triangle that came first leaves first, so that the front advances evenly to all sides.
For a constant size this holds only among a *batch*: some triangles that follow each other in the queue and
advance together for some generations. Then those that are left go back to the beginning of the queue. In this
way the data stay in the processor's cache. A plain queue takes nearly twice the time for a million triangles;
a plain stack lets thin fingers grow and leaves three to five times as many imperfections. Where the size
varies, a front that advances as a whole is worth the extra time, and there are no batches.

``links[t]`` has the columns that are named below. ``gates[b]`` contains the first and the last slot of bucket
b, -1 where it is empty. The second half of the buckets belongs to the batch. ``turn[0]`` is the number of
steps that the batch has left, plus one, and 0 without a batch; ``turn[1]`` is the size of a batch.
"""

from __future__ import annotations

from math import frexp

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel, lean
from ...connect.insertion.engine import grown
from ..refinement.state import HALF_OCTAVE

STATUS, LEVEL, PREVIOUS, NEXT = 0, 1, 2, 3  # the columns of ``links``
# The status of a slot. A status >= 0 is the bucket in which the triangle waits at the front.
WAITING = -1  # the triangle is too large, but not in the queue
ASIDE = -2  # the triangle is too large, and was given up
ACCEPTED = -3  # the triangle is small enough, or lies outside
BATCH = 64  # triangles in a batch
GENERATIONS = 12  # a batch takes this many times its size of steps


def empty_queue(
    slots: int, buckets: int, batch: int = 0
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
    """``links``, ``gates`` and ``turn`` of an empty queue, in which all slots are accepted.

    ``batch`` is the number of slots that advance together; 0 means that there are no batches.
    """
    links = grown_links(np.empty((0, 4), dtype=np.int32), slots)
    return links, np.full((2 * buckets, 2), -1, dtype=np.int32), np.array([0, batch], dtype=np.int64)


def grown_links(links: NDArray[np.int32], slots: int) -> NDArray[np.int32]:
    """The same queue with room for so many slots; the new ones are accepted."""
    old = len(links)
    links = grown(links, slots)
    _accept_from(links, old)
    return links


@kernel
def _accept_from(links, first):
    for i in range(first, len(links)):
        links[i, STATUS], links[i, LEVEL], links[i, PREVIOUS], links[i, NEXT] = ACCEPTED, 0, -1, -1


@inline
def bucket_of(square, buckets):
    """The bucket of a squared measure: two an octave, from 1 upwards; the last one has no upper end."""
    m, e = frexp(square)
    b = 2 * (e - 1)
    if m >= HALF_OCTAVE:
        b += 1
    return min(max(b, 0), buckets - 1)


@inline
def push(links, gates, turn, slot, last_first):
    """Put a slot at the end of its bucket, or at the beginning; a batch has buckets of its own."""
    bucket = links[slot, LEVEL]
    if turn[0] > 0:
        bucket += len(gates) // 2
    append(links, gates, slot, bucket, last_first)


@inline
def append(links, gates, slot, bucket, last_first):
    """Put a slot at the end of this bucket, or at the beginning."""
    links[slot, STATUS] = bucket
    if last_first:
        first = gates[bucket, 0]
        links[slot, PREVIOUS], links[slot, NEXT] = -1, first
        if first >= 0:
            links[first, PREVIOUS] = slot
        else:
            gates[bucket, 1] = slot
        gates[bucket, 0] = slot
    else:
        last = gates[bucket, 1]
        links[slot, PREVIOUS], links[slot, NEXT] = last, -1
        if last >= 0:
            links[last, NEXT] = slot
        else:
            gates[bucket, 0] = slot
        gates[bucket, 1] = slot


@inline
def unlink(links, gates, slot, status):
    """Take a slot out of its bucket and set its status."""
    bucket, before, after = links[slot, STATUS], links[slot, PREVIOUS], links[slot, NEXT]
    if before >= 0:
        links[before, NEXT] = after
    else:
        gates[bucket, 0] = after
    if after >= 0:
        links[after, PREVIOUS] = before
    else:
        gates[bucket, 1] = before
    links[slot, STATUS] = status


@lean
def end_batch(links, gates, turn):
    """Move the slots that are left of a batch back to the beginning of their buckets, in the same order."""
    half = len(gates) // 2
    for b in range(half):
        while gates[half + b, 1] >= 0:
            slot = np.int64(gates[half + b, 1])
            unlink(links, gates, slot, WAITING)
            append(links, gates, slot, b, True)
    turn[0] = 0


@lean
def next_slot(links, gates, turn):
    """The slot whose turn it is: the first of the highest bucket that is not empty; -1 if all are empty."""
    half = len(gates) // 2
    if turn[0] == 1:
        end_batch(links, gates, turn)
    for b in range(half - 1, -1, -1):
        if turn[1] > 0 and gates[half + b, 0] >= 0:
            turn[0] -= 1
            return gates[half + b, 0]
        if gates[b, 0] >= 0:
            if turn[1] > 0:
                for _ in range(turn[1]):
                    slot = np.int64(gates[b, 0])
                    if slot >= 0:
                        unlink(links, gates, slot, WAITING)
                        append(links, gates, slot, half + b, False)
                turn[0] = turn[1] * GENERATIONS
                return gates[half + b, 0]
            return gates[b, 0]
    return -1
