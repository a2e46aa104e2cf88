"""What every advancing front does, whatever it measures by, compiled: its edges, its queue, and the record.

The queue itself is that of `generate.advancing.queue`. Book: 3.1, 3.3.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import VERTICES, end_of, start_of
from ...connect.planar.cavity import commit_here
from ..advancing.queue import crosses_front, leaves_queue, sent_last
from ..rebay.queue import ACCEPTED, STATUS, WAITING, unlink
from ..rebay.steps import clear

# Orders of the queue.
WIDEST, SMALLEST, SHORTEST, OLDEST = range(4)
# Why a triangle was accepted; each is also the place of its count.
NEW, FITS, EMPTY, SNAPPED, CONNECTED, CLOSED, CENTERED, FORCED = range(8)
PUT_ASIDE, WAS_BEYOND, WAS_FLAT_ANGLE, WAS_NEAR = range(8, 12)
MADE, FRONT_COUNTS = 12, 13  # further places: how many triangles are accepted

FRONT_ACCEPT = 1.2  # a triangle ahead with R < FRONT_ACCEPT f is accepted as it is
CLEARANCE = 0.8  # times the wanted length: no point nearer than that to a vertex


class FrontRule(NamedTuple):
    """What the caller chooses."""

    order: int  # of the queue: WIDEST, ...
    placement: int  # of the ideal point: EQUAL_SIDES, ...
    scale: float  # the squared measure is divided by this before it is sorted into buckets
    number: int  # the number that marks edges of the front
    constant: float  # f, if it is the same everywhere; otherwise 0
    last_first: bool = False


class Diary(NamedTuple):
    """The record: one row for each accepted triangle, in order."""

    slots: NDArray[np.int32]
    log: NDArray[np.int32]  # (., 5) A, B, apex, reason, the vertex that was too near; (0, 5) if not wanted
    numbers: NDArray[np.float64]  # (., 4) the ideal point, h / sqrt(3), R of the triangle ahead


@inline
def is_marked(mark, t):
    """How many edges of triangle t belong to the front (or to the boundary), if it is unfinished."""
    return (mark[3 * t] >= 0) + (mark[3 * t + 1] >= 0) + (mark[3 * t + 2] >= 0)


@inline
def is_to_be_graded(march, t):
    """Whether unfinished triangle t, which has just got an edge at the front, is to be graded and queued."""
    return leaves_queue(march, t, march.rule.order == SHORTEST)


@inline
def accept(plane, march, diary, counts, t, e, reason):
    """Accept triangle t, on whose edge e the front is, and write it into the record."""
    vertex, links = plane.vertex, march.links
    if links[t, STATUS] >= 0:
        unlink(links, march.gates, t, ACCEPTED)
    links[t, STATUS] = ACCEPTED
    row = counts[MADE]
    diary.slots[row] = t
    if len(diary.log) > 0:
        diary.log[row, 0], diary.log[row, 1] = start_of(vertex, e), end_of(vertex, e)
        diary.log[row, 2], diary.log[row, 3] = vertex[e], reason
    counts[MADE] += 1
    counts[reason] += 1


@inline
def enters_front(plane, march, j):
    """Let half-edge j of an accepted triangle enter the front, or leave it; whether it enters."""
    return crosses_front(plane.mark, j, plane.twin[j], march.rule.number)


@inline
def put_neighbors(twin, t, stack, depth):
    """Put the triangles beyond the edges of triangle t on the stack, as far as there is room; its depth."""
    for j in range(3 * t, 3 * t + 3):
        if depth < len(stack):
            stack[depth] = twin[j] // 3
            depth += 1
    return depth


@inline
def next_nook(plane, march, stack, depth):
    """The next unfinished triangle on the stack with two edges or more at the front (or -1); the depth."""
    while depth > 0:
        depth -= 1
        o = np.int64(stack[depth])
        if march.links[o, STATUS] != ACCEPTED and is_marked(plane.mark, o) >= 2:
            return o, depth
    return np.int64(-1), depth


@inline
def set_unfinished(plane, march):
    """Let all triangles of the domain be unfinished, and those outside be accepted."""
    for t in range(plane.state[COUNT]):
        march.links[t, STATUS] = ACCEPTED if plane.region[t] < 0 else WAITING


@inline
def put_star(plane, march, scratch, m, k, x, y):
    """Replace the cavity by the star of (x, y); its triangles, ``scratch.fresh[:k]``, are unfinished."""
    clear(march.links, march.gates, scratch.cells, m)
    v = plane.state[VERTICES]
    plane.xy[v, 0], plane.xy[v, 1] = x, y
    commit_here(plane, scratch, m, k, v)
    for i in range(k):
        march.links[scratch.fresh[i], STATUS] = WAITING


@inline
def put_aside(march, counts, t):
    """Whether triangle t, for none of whose edges an ideal point was possible, is now set aside."""
    aside = sent_last(march, t, march.rule.last_first)
    counts[PUT_ASIDE] += aside
    return aside
