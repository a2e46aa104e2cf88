"""The classical advancing front, triangle by triangle, compiled.

A step takes the first edge AB of the queue, places the ideal point X ahead of it, and collects the vertices
of the front around it. They are tried in the order of their distances; the first one whose triangle is valid
and round enough is taken.

          . - - - .           M  the middle of AB
        .     X     .         X  the ideal point: XA = XB = the wanted length
       . C         .          C  a candidate: it is nearer than X, and will be tried before it
        .         . D         D  another one
       A --- M --- B

Two searches are built in. *Barycenter*, as the source chapter tells it: the circle is about M, its radius
some times the height of the equilateral triangle, and X is one of the candidates, at its distance from M.
*Ideal*: the circle is about X, candidates come by their distance from X, and X after all of them. If all
fail, the vertices of the front in wider and wider squares about M are tried by the circumradius of their
triangles.

**Why one of them succeeds.** What is not meshed is at all times a polygonal region, perhaps with holes and
with loose vertices, and it has a triangulation with no other vertices (the theorem on triangulations of
polygons). This one has a triangle on AB; its third corner passes all tests. So the front never sticks, and
since only finitely many points have room, no two being nearer than `KEPT_CLEAR` times the wanted length, the
last triangle empties the front. In space neither holds. Source: the source chapter, 12.3.1; R. Löhner, P.
Parikh, International Journal for Numerical Methods in Fluids 8 (1988) 1135-1149. Book: 3.1.
"""

from __future__ import annotations

from math import frexp, inf, sqrt
from typing import NamedTuple

import numpy as np

from ...base.candidate_heap import put, take
from ...base.codes import DONE, MORE, ROOM
from ...base.jit import inline, lean
from ...sizing.table import ROOT3, Nodes, size_at
from ..advancing.digital_tree import gather
from ..advancing.journal import note_tried
from ..advancing.rows import CELLS_MADE, VERTEX_COUNT, in_turn, next_in_turn
from .open_front import (
    CROSSED,
    HOLDS,
    NO_FAULT,
    advance_over,
    blocking_edge,
    enter_vertex,
    first_fault,
    has_room,
    holds_vertex,
    meets_inside,
    turn,
)
from .placing import LONGEST_SIDE, SHORTEST_SIDE

__all__ = [
    "CLASSICAL_COUNTS",
    "KEPT_CLEAR",
    "NONE_FITS",
    "TRIED",
    "Choices",
    "march",
    "start_waiting",
]  # fmt: skip

NONE_FITS = 8  # no vertex is valid, which cannot happen if the boundary is valid
NOT_ROUND, NO_CLEARANCE = 4, 5  # verdicts, besides those of `first_fault`
ORDER_SHORTEST, ORDER_OLDEST = 1, 2  # 0: the smallest wanted length first
ABOUT_MIDDLE, ABOUT_IDEAL = range(2)
KEPT_CLEAR = 0.45  # times the sides: no new point is nearer to an edge of the front
# Places in the counts; the first four are also the reasons for a choice.
BY_IDEAL, BY_NEAR, BY_WIDER, BY_ALL, TRIED, CLASSICAL_COUNTS = range(6)
OCTAVE = 64  # sizes and lengths in the same one of so many parts of an octave are equal for the order
LATER = 2.0**35  # more than there are edges


class Choices(NamedTuple):
    """What the caller chooses."""

    order: int
    search: int
    circle: bool  # the ideal point makes the wanted circumradius, not the wanted sides
    reach: float  # the radius of the search: times the height of the ideal triangle, or times its sides
    roundness: float  # the least 2 r / R of a triangle with a candidate from this circle
    constant: float  # the wanted length if it is the same everywhere, otherwise 0
    most: int  # no new point is made when there are so many vertices
    size: Nodes


@inline
def length_wanted(choices, x, y):
    """The wanted length at a point."""
    size = choices.size
    return choices.constant if choices.constant > 0.0 else size_at(size.child, size.values, size.box, x, y)


@inline
def level_of(measure):
    """The part of an octave that a positive number is in; it grows with the number."""
    part, exponent = frexp(measure)
    return OCTAVE * exponent + int(2 * OCTAVE * part)


@inline
def rank(front, choices, row):
    """The key of an edge in the queue: what the order measures, in steps of about a percent, then its age."""
    if choices.order == ORDER_OLDEST:
        return float(front.stamp[row])
    a, b = front.ends[row, 0], front.ends[row, 1]
    ax, ay, bx, by = front.xy[a, 0], front.xy[a, 1], front.xy[b, 0], front.xy[b, 1]
    if choices.order == ORDER_SHORTEST:
        measure = sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    else:
        measure = length_wanted(choices, 0.5 * (ax + bx), 0.5 * (ay + by))
    return (level_of(measure) + 2048.0 * OCTAVE) * LATER + front.stamp[row]


@inline
def wait(front, choices, waiting, row):
    """Put an edge of the front into the queue."""
    in_turn(waiting, front.stamp, row, rank(front, choices, row))


@lean
def start_waiting(front, choices, waiting):
    """Put all edges of the front into the queue."""
    for row in range(len(front.ends)):
        if front.ends[row, 0] >= 0:
            wait(front, choices, waiting, np.int64(row))


@inline
def ideal_point(front, choices, a, b):
    """The ideal point X of the edge ab, the sides of its triangle, and the wanted length: (x, y, side, h).

    The length is taken at the center of the equilateral triangle on ab. Side 0 means that there is no such
    point, since lengths so small are lost to rounding.
    """
    xy = front.xy
    ax, ay, bx, by = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1]
    mx, my, ux, uy = 0.5 * (ax + bx), 0.5 * (ay + by), bx - ax, by - ay
    length = sqrt(ux * ux + uy * uy)
    if length < 1e-140:
        return mx, my, 0.0, 0.0
    nx, ny = -uy / length, ux / length
    h = length_wanted(choices, mx + nx * length / (2.0 * ROOT3), my + ny * length / (2.0 * ROOT3))
    side = min(max(h, SHORTEST_SIDE * length), LONGEST_SIDE * length)
    d = sqrt(side * side - 0.25 * length * length)
    if choices.circle:
        r = max(side / ROOT3, 0.5 * length)
        d = r + sqrt(r * r - 0.25 * length * length)
    return mx + nx * d, my + ny * d, side, h


@inline
def between(xy, u, v):
    """The distance of two vertices."""
    dx, dy = xy[v, 0] - xy[u, 0], xy[v, 1] - xy[u, 1]
    return sqrt(dx * dx + dy * dy)


@inline
def roundness(xy, a, b, c):
    """2 r / R of a triangle: 1 if it is equilateral, near 0 if it is flat."""
    p, q, r = between(xy, a, b), between(xy, b, c), between(xy, c, a)
    product = p * q * r
    return (q + r - p) * (r + p - q) * (p + q - r) / product if product > 0.0 else 0.0


@inline
def is_near(xy, x, s, t, least):
    """Whether vertex x is nearer to the segment st than ``least``."""
    ux, uy, vx, vy = xy[t, 0] - xy[s, 0], xy[t, 1] - xy[s, 1], xy[x, 0] - xy[s, 0], xy[x, 1] - xy[s, 1]
    along, square = ux * vx + uy * vy, ux * ux + uy * uy
    part = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    dx, dy = vx - part * ux, vy - part * uy
    return dx * dx + dy * dy < least * least


@lean
def fault_of_new(front, row, x, least):
    """The verdict on the new point x, an unused vertex, ahead of an edge; ``least`` is its clearance."""
    xy, ends, found = front.xy, front.ends, front.edges.found
    px, py = xy[x, 0], xy[x, 1]
    if not (abs(px) <= 1.0 and abs(py) <= 1.0):
        return CROSSED
    window = (px - least, py - least, px + least, py + least)
    for i in range(gather(front.edges, window)):
        other = np.int64(found[i])
        if other != row and is_near(xy, x, np.int64(ends[other, 0]), np.int64(ends[other, 1]), least):
            return NO_CLEARANCE
    found = front.vertices.found
    for i in range(gather(front.vertices, window)):
        v = np.int64(found[i])
        if front.loose[v] and between(xy, v, x) < least:
            return NO_CLEARANCE
    return first_fault(front, np.int64(ends[row, 0]), np.int64(ends[row, 1]), x)


@lean
def search_near(front, choices, waiting, journal, counts, row, side):
    """The vertex that is taken among those within the radius of the search, -1 for none.

    The ideal point is the first unused vertex.
    """
    xy, found, heap, what = front.xy, front.vertices.found, waiting.measures, waiting.candidates
    a, b, n = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1]), front.state[VERTEX_COUNT]
    x, y, count = xy[n, 0], xy[n, 1], 0
    may = n < choices.most
    if choices.search == ABOUT_MIDDLE:
        radius = choices.reach * (0.5 * ROOT3) * side
        cx, cy = 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1])
        if may:
            count = put(heap, what, count, sqrt((x - cx) * (x - cx) + (y - cy) * (y - cy)), n)
    else:
        radius, cx, cy = choices.reach * side, x, y
    for i in range(gather(front.vertices, (cx - radius, cy - radius, cx + radius, cy + radius))):
        v = np.int64(found[i])
        dx, dy = xy[v, 0] - cx, xy[v, 1] - cy
        distance = sqrt(dx * dx + dy * dy)
        if v != a and v != b and distance <= radius:
            count = put(heap, what, count, distance, v)
    while count > 0:
        v = what[0]
        count = take(heap, what, count)
        if v == n:
            verdict = fault_of_new(front, row, n, KEPT_CLEAR * side)
        else:
            verdict = first_fault(front, a, b, v)
            if verdict == NO_FAULT and roundness(xy, a, b, v) < choices.roundness:
                verdict = NOT_ROUND
        note_tried(journal, counts[TRIED], v if v != n else np.int64(-1), verdict)
        counts[TRIED] += 1
        if verdict == NO_FAULT:
            return v
    if choices.search == ABOUT_IDEAL and may:
        verdict = fault_of_new(front, row, n, KEPT_CLEAR * side)
        note_tried(journal, counts[TRIED], np.int64(-1), verdict)
        counts[TRIED] += 1
        if verdict == NO_FAULT:
            return n
    return np.int64(-1)


@lean
def search_wide(front, waiting, journal, counts, row, radius):
    """The first valid vertex by circumradius in wider and wider squares, and whether all were tried.

    The vertex is -1 if there is none.
    """
    xy, found, heap, what = front.xy, front.vertices.found, waiting.measures, waiting.candidates
    a, b = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1])
    cx, cy = 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1])
    before = -1.0
    s = t = p = q = np.int64(-1)
    while True:
        radius = 2.0 * radius if radius > 0.0 else 4.0
        count = 0
        for i in range(gather(front.vertices, (cx - radius, cy - radius, cx + radius, cy + radius))):
            v = np.int64(found[i])
            away = max(abs(xy[v, 0] - cx), abs(xy[v, 1] - cy))
            if v == a or v == b or away <= before or away > radius or turn(xy, a, b, v) <= 0:
                continue
            ux, uy, vx, vy = (
                xy[b, 0] - xy[a, 0],
                xy[b, 1] - xy[a, 1],
                xy[v, 0] - xy[a, 0],
                xy[v, 1] - xy[a, 1],
            )
            twice = ux * vy - uy * vx
            measure = between(xy, a, v) * between(xy, v, b)
            count = put(heap, what, count, measure / twice if twice > 0.0 else inf, v)
        while count > 0:
            v = what[0]
            count = take(heap, what, count)
            verdict = CROSSED  # most likely by an edge that has been in the way of the candidates before
            if not (s >= 0 and meets_inside(xy, a, b, v, s, t)):
                if not (p >= 0 and meets_inside(xy, a, b, v, p, q)):
                    blocker = blocking_edge(front, a, b, v)
                    if blocker >= 0:
                        p, q = s, t
                        s, t = np.int64(front.ends[blocker, 0]), np.int64(front.ends[blocker, 1])
                    else:
                        verdict = HOLDS if holds_vertex(front, a, b, v) else NO_FAULT
            note_tried(journal, counts[TRIED], v, verdict)
            counts[TRIED] += 1
            if verdict == NO_FAULT:
                return v, radius > 2.0
        if radius > 2.0:
            return np.int64(-1), True
        before = radius


@lean
def march(front, choices, waiting, journal, counts, limit):
    """Make up to ``limit`` triangles; return how it ended: DONE, MORE, ROOM or NONE_FITS."""
    state, wanted = front.state, len(journal.tried) > 0
    for _ in range(limit):
        room = state[VERTEX_COUNT] + 4 < len(waiting.candidates) and waiting.many[0] + 4 < len(waiting.keys)
        if wanted:  # a step tries each vertex at most twice
            room = room and counts[TRIED] + 2 * state[VERTEX_COUNT] + 8 < len(journal.tried)
            room = room and state[CELLS_MADE] + 2 < len(journal.log)
        if not (room and has_room(front)):
            return ROOM
        row, _ = next_in_turn(waiting, front.stamp)
        if row < 0:
            return DONE
        before, k = counts[TRIED], state[CELLS_MADE]
        a, b, n = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1]), state[VERTEX_COUNT]
        x, y, side, h = ideal_point(front, choices, a, b)
        front.xy[n, 0], front.xy[n, 1] = x, y
        radius = choices.reach * (0.5 * ROOT3 if choices.search == ABOUT_MIDDLE else 1.0) * side
        c, reason = np.int64(-1), BY_NEAR
        if side > 0.0:
            c = search_near(front, choices, waiting, journal, counts, row, side)
        if c == n:
            reason = BY_IDEAL
            state[VERTEX_COUNT] += 1
            enter_vertex(front, n)
        elif c < 0:
            c, whole = search_wide(front, waiting, journal, counts, row, radius)
            reason = BY_ALL if whole else BY_WIDER
            if c < 0:
                return NONE_FITS
        counts[reason] += 1
        if wanted:
            journal.log[k, 0], journal.log[k, 1] = reason, before
            journal.numbers[k, 0], journal.numbers[k, 1] = x, y
            journal.numbers[k, 2], journal.numbers[k, 3] = h, radius
        one, two = advance_over(front, row, c)
        if one >= 0:
            wait(front, choices, waiting, one)
        if two >= 0:
            wait(front, choices, waiting, two)
    return MORE
