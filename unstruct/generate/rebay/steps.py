"""Rebay's insertion of points along Voronoi segments, compiled.

Triangles of the domain are *accepted* (circumradius below delta f) or *waiting*; what lies beyond a
constrained edge counts as accepted. An edge between the two kinds is *active*: the front. A step takes the
first waiting triangle of the queue and one of its active edges, AB, and puts X on the bisector of AB:

           C                    M  middle of AB, p = |AM|
          / \\     accepted      F  circumcenter of the waiting triangle, q = |MF|, negative behind AB
         A-M-B                  R = min(max(f, p), (p^2 + q^2) / 2 q)     (12.4)
          \\X/    waiting       d = |MX| = R + sqrt(R^2 - p^2)            (12.5)
           F
           D                    both in one: d = min((12.5) for R = max(f, p), q), which is q where q < p

The search for the cavity begins at the waiting triangle, whose circle contains X, so that no point location
is needed. The cavity is judged before anything is changed. Source: S. Rebay, Journal of Computational Physics
106 (1993) 125-138. Book: 2.6c.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, INSERTED, MORE, OUTSIDE, ROOM, ROUNDED, SPLIT
from ...base.jit import inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import SEGMENTS, VERTICES, end_of, start_of
from ...connect.planar.cavity import commit_here, find_cavity_here
from ...connect.planar.stars import touched
from ...predicates.kernels import incircle, orient2
from ...sizing.table import ROOT3, Nodes, size_at
from .queue import ACCEPTED, ASIDE, LEVEL, STATUS, WAITING, bucket_of, next_slot, push, unlink

ENCROACHES, TOO_NEAR = 8, 9  # outcomes of an attempt, besides INSERTED, OUTSIDE and ROUNDED
# Places in the counts. The first eight are also the bits of the case that a step records.
POINTS, CAPPED, CLAMPED, BEHIND, DELETED, COCIRCULAR, AT_CENTER, BY_SPLIT = range(8)
SIZE_MOVED, WIDE_ANGLE, WAS_OUTSIDE, WAS_FLAT, COLLISIONS, WAS_ROUNDED = range(8, 14)
GIVEN_UP, SPLIT_REFUSED, COUNTS = range(14, 17)


class Rule(NamedTuple):
    """What the caller chooses."""

    accept: float  # delta: a triangle is accepted where R < delta f
    general: bool  # sort by R / g(Q) instead of R / f
    scale: float  # the squared measure is divided by this before it is sorted into buckets
    at_center: bool  # f is taken at the center of the new triangle, not at M
    last_first: bool  # within a bucket the newest triangle comes first
    split: bool  # long boundary edges that reject a point are split
    constant: float  # f, if it is the same everywhere; otherwise 0


class Front(NamedTuple):
    """The queue of waiting triangles, and what decides which triangles wait, and in which bucket."""

    links: NDArray[np.int32]
    gates: NDArray[np.int32]
    turn: NDArray[np.int64]
    size: Nodes
    order: Nodes  # the table of the field that R is compared with in the queue
    rule: Rule


@inline
def wanted(front, x, y):
    """The wanted circumradius f at a point: that of an equilateral triangle with edges of the wanted size."""
    constant, size = front.rule.constant, front.size
    return constant if constant > 0.0 else size_at(size.child, size.values, size.box, x, y) / ROOT3


@inline
def far_point(r, p):
    """(12.5): the distance from M to the farther point in which the bisector meets the circle of radius r."""
    return r + sqrt(max(r * r - p * p, 0.0))


@inline
def circle(xy, vertex, t):
    """The squared circumradius of triangle t (inf if it is flat), its circumcenter, and its centroid."""
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    ax, ay = xy[a, 0], xy[a, 1]
    ux, uy, vx, vy = xy[b, 0] - ax, xy[b, 1] - ay, xy[c, 0] - ax, xy[c, 1] - ay
    twice = 2.0 * (ux * vy - uy * vx)
    gx, gy = ax + (ux + vx) / 3.0, ay + (uy + vy) / 3.0
    if twice <= 0.0:
        return inf, gx, gy, gx, gy
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    x, y = (u * vy - v * uy) / twice, (ux * v - vx * u) / twice
    return x * x + y * y, ax + x, ay + y, gx, gy


@inline
def classify(plane, front, t):
    """Classify triangle t as accepted or waiting; if it waits, find its bucket."""
    xy, vertex, links, rule = plane.xy, plane.vertex, front.links, front.rule
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    ux, uy, vx, vy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1], xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
    wx, wy, double = vx - ux, vy - uy, ux * vy - uy * vx
    product = (ux * ux + uy * uy) * (vx * vx + vy * vy) * (wx * wx + wy * wy)
    below = 4.0 * double * double  # R^2 = product / below
    f = wanted(front, xy[a, 0] + (ux + vx) / 3.0, xy[a, 1] + (uy + vy) / 3.0)
    if double > 0.0 and product < below * rule.accept * rule.accept * f * f:
        links[t, STATUS] = ACCEPTED
        return
    links[t, STATUS] = WAITING
    if rule.general:
        _, x, y, _, _ = circle(xy, vertex, t)
        f = size_at(front.order.child, front.order.values, front.order.box, x, y) / ROOT3
    scale, buckets = below * f * f * rule.scale, len(front.gates) // 2
    links[t, LEVEL] = bucket_of(product / scale, buckets) if scale > 0.0 else buckets - 1


@inline
def is_active(twin, mark, links, e):
    """Whether e is active, if its own triangle waits: it is constrained, or the one beyond is accepted."""
    return mark[e] >= 0 or links[twin[e] // 3, STATUS] == ACCEPTED


@inline
def join_queue(plane, front, t):
    """Put triangle t into the queue if it waits at the front."""
    twin, mark, links = plane.twin, plane.mark, front.links
    if links[t, STATUS] == WAITING:
        e = 3 * t
        if (
            is_active(twin, mark, links, e)
            or is_active(twin, mark, links, e + 1)
            or is_active(twin, mark, links, e + 2)
        ):
            push(links, front.gates, front.turn, t, front.rule.last_first)


@inline  # handing over the arrays of both records, once a point, took a fifth of the time of `advance`
def settle(plane, front, fresh, k):
    """Classify new triangles; queue those at the front, and the neighbors that the front reaches now."""
    twin, mark, links = plane.twin, plane.mark, front.links
    for i in range(k):
        classify(plane, front, np.int64(fresh[i]))
    for i in range(k):
        t = np.int64(fresh[i])
        join_queue(plane, front, t)
        if mark[3 * t] < 0:
            o = np.int64(twin[3 * t] // 3)
            status = links[o, STATUS]
            if status == ASIDE or (status == WAITING and links[t, STATUS] == ACCEPTED):
                push(links, front.gates, front.turn, o, front.rule.last_first)


@lean
def start(plane, front, moved):
    """Classify all triangles; queue those along the boundary, in its order, then those beside accepted ones.

    A triangle of which no corner has ``moved`` keeps its class. The queue must be empty.
    """
    for t in range(plane.state[COUNT]):
        if plane.region[t] < 0:
            front.links[t, STATUS] = ACCEPTED
        elif touched(plane.vertex, t, moved):
            classify(plane, front, t)
    for s in range(plane.state[SEGMENTS]):
        e = np.int64(plane.where[s])
        join_queue(plane, front, e // 3)
        join_queue(plane, front, np.int64(plane.twin[e] // 3))
    for t in range(plane.state[COUNT]):
        join_queue(plane, front, np.int64(t))


@lean
def classify_rest(plane, front, seen):
    """Classify the triangles that have no corner among those ``seen``."""
    for t in range(plane.state[COUNT]):
        if plane.region[t] >= 0 and not touched(plane.vertex, t, seen):
            classify(plane, front, t)


@inline
def point_for(plane, front, e, counts):
    """X for the active edge on half-edge e: (x, y, f, p, q, d)."""
    xy, vertex, rule = plane.xy, plane.vertex, front.rule
    a, b, c = start_of(vertex, e), end_of(vertex, e), vertex[e]
    ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    mx, my = xy[a, 0] + ux / 2.0, xy[a, 1] + uy / 2.0
    length = sqrt(ux * ux + uy * uy)
    if length == 0.0:  # the square is below all doubles: a point here is too near
        return mx, my, wanted(front, mx, my), 0.0, 0.0, 0.0
    nx, ny, p = -uy / length, ux / length, length / 2.0
    wx, wy = xy[c, 0] - mx, xy[c, 1] - my
    high = wx * nx + wy * ny
    q = (wx * wx + wy * wy - p * p) / (2.0 * high) if high > 0.0 else inf
    f = wanted(front, mx, my)
    d = min(far_point(max(f, p), p), q)
    if rule.at_center and rule.constant == 0.0:
        g = wanted(front, mx + nx * d / 3.0, my + ny * d / 3.0)
        if abs(g - f) > 0.1 * f:
            counts[SIZE_MOVED] += 1
        f = g
        d = min(far_point(max(f, p), p), q)
    return mx + d * nx, my + d * ny, f, p, q, d


@inline
def judge(plane, rim, k, x, y, f, counts):
    """Whether (x, y) may be joined to the boundary of the cavity, the half-edges ``rim[:k]``.

    Returns INSERTED and -1, or the reason against it and the place in ``rim`` of the edge that gives it. Only
    constrained edges need an exact test: for the others a theorem says that the cavity is star-shaped (see
    `connect.planar.cavity`).
    """
    xy, vertex, mark = plane.xy, plane.vertex, plane.mark
    wide = False
    for i in range(k):
        e = np.int64(rim[i])
        a = start_of(vertex, e)
        ax, ay = xy[a, 0] - x, xy[a, 1] - y
        square = ax * ax + ay * ay
        if mark[e] >= 0:
            b = end_of(vertex, e)
            if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], x, y) <= 0:
                return OUTSIDE, i
            bx, by = xy[b, 0] - x, xy[b, 1] - y
            dot = ax * bx + ay * by
            if dot < 0.0:  # (x, y) sees the edge under more than 90 degrees
                if 4.0 * dot * dot >= square * (bx * bx + by * by):  # and under 120 degrees or more
                    return ENCROACHES, i
                wide = True
        if square < 0.49 * f * f:
            return TOO_NEAR, i
    if wide:
        counts[WIDE_ANGLE] += 1
    return INSERTED, -1


@inline
def attempt(plane, scratch, t, x, y, f, counts):
    """Find and judge the cavity of (x, y), from triangle t: (outcome, m, k, place in ``rim``)."""
    xy, vertex = plane.xy, plane.vertex
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    if incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], x, y) <= 0:
        return ROUNDED, 0, 0, -1
    m, k = find_cavity_here(plane, scratch, t, x, y)
    if k < 0:
        return ROUNDED, 0, 0, -1
    outcome, i = judge(plane, scratch.rim, k, x, y, f, counts)
    return outcome, m, k, i


@inline
def clear(links, gates, cells, m):
    """Take the triangles of a cavity out of the queue."""
    for i in range(m):
        t = np.int64(cells[i])
        if links[t, STATUS] >= 0:
            unlink(links, gates, t, WAITING)


@inline
def next_active(xy, vertex, twin, mark, links, t, tried):
    """The shortest active edge of triangle t that has not been tried (bits of ``tried``), or -1."""
    best, shortest = np.int64(-1), inf
    for j in range(3):
        e = 3 * t + j
        if (tried >> j) & 1 == 0 and is_active(twin, mark, links, e):
            a, b = start_of(vertex, e), end_of(vertex, e)
            ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
            if ux * ux + uy * uy < shortest:
                best, shortest = np.int64(e), ux * ux + uy * uy
    return best


@inline
def blame(xy, vertex, rim, outcome, i, f, counts):
    """Count a rejected point; return the half-edge of the boundary that rejected it, if it is long, or -1."""
    if outcome == TOO_NEAR or outcome == ROUNDED:
        counts[COLLISIONS if outcome == TOO_NEAR else WAS_ROUNDED] += 1
        return np.int64(-1)
    counts[WAS_OUTSIDE if outcome == OUTSIDE else WAS_FLAT] += 1
    e = np.int64(rim[i])
    a, b = start_of(vertex, e), end_of(vertex, e)
    ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    # half of the edge is longer than f; half of a boundary edge is usually about sqrt(3) / 2 f long
    return e if ux * ux + uy * uy > 4.0 * f * f else np.int64(-1)


@inline
def case_of(plane, e, rim, k, point, counts):
    """The case of a step that uses the `point_for` edge e, as bits; each bit is counted."""
    xy, vertex, twin, mark = plane.xy, plane.vertex, plane.twin, plane.mark
    x, y, _, p, q, d = point
    case = 1 << POINTS
    if q < p:
        case |= 1 << (CLAMPED if q > 0.0 else BEHIND)
    elif d == q:
        case |= 1 << CAPPED
    stays = False
    for j in range(k):
        stays = stays or rim[j] == e
    if not stays:
        case |= 1 << DELETED
    elif mark[e] < 0:
        a, b, c = start_of(vertex, e), end_of(vertex, e), vertex[twin[e]]
        if incircle(xy[b, 0], xy[b, 1], xy[a, 0], xy[a, 1], xy[c, 0], xy[c, 1], x, y) == 0:
            case |= 1 << COCIRCULAR
    for j in range(POINTS, COCIRCULAR + 1):
        counts[j] += (case >> j) & 1
    return case


@inline
def last_resort(plane, front, scratch, t, counts):
    """Try the circumcenter of triangle t: (outcome, m, k, place in ``rim``, x, y, f)."""
    square, x, y, gx, gy = circle(plane.xy, plane.vertex, t)
    f = wanted(front, gx, gy)
    if square == inf:
        return ROUNDED, 0, 0, -1, x, y, f
    outcome, m, k, i = attempt(plane, scratch, t, x, y, f, counts)
    if outcome == INSERTED:
        counts[AT_CENTER] += 1
    return outcome, m, k, i, x, y, f


@lean
def advance(plane, front, scratch, counts, log, numbers, ask, limit):
    """Take up to ``limit`` steps; return how it ended. SPLIT asks for a split of half-edge ``ask[0]``."""
    xy, vertex, twin, mark, state = plane.xy, plane.vertex, plane.twin, plane.mark, plane.state
    links, gates, rim = front.links, front.gates, scratch.rim
    for _ in range(limit):
        if state[VERTICES] >= len(xy) or state[COUNT] + 4 > len(links):
            return ROOM
        t = np.int64(next_slot(links, gates, front.turn))
        if t < 0:
            return DONE
        tried, to_split = 0, np.int64(-1)
        outcome = -1
        a = b = c = w = np.int64(-1)
        case = 0
        p = q = d = 0.0
        while outcome != INSERTED:
            e = next_active(xy, vertex, twin, mark, links, t, tried)
            if e >= 0:
                tried |= 1 << (e - 3 * t)
                point = point_for(plane, front, e, counts)
                x, y, f, p, q, d = point
                outcome, m, k, i = attempt(plane, scratch, t, x, y, f, counts)
                if outcome == INSERTED:
                    case = case_of(plane, e, rim, k, point, counts)
                    a, b, w = start_of(vertex, e), end_of(vertex, e), vertex[e]
                    c = -1 if mark[e] >= 0 else vertex[twin[e]]
            else:
                outcome, m, k, i, x, y, f = last_resort(plane, front, scratch, t, counts)
                case = 1 << AT_CENTER
            if outcome != INSERTED:
                blamed = blame(xy, vertex, rim, outcome, i, f, counts)
                to_split = blamed if to_split < 0 else to_split
                if e < 0:
                    break
        if outcome == INSERTED:
            clear(links, gates, scratch.cells, m)
            v = state[VERTICES]
            xy[v, 0], xy[v, 1] = x, y
            commit_here(plane, scratch, m, k, v)
            settle(plane, front, scratch.fresh, k)
            if len(log) > 0:
                log[v, 0], log[v, 1], log[v, 2], log[v, 3], log[v, 4] = a, b, c, w, case
                numbers[v, 0], numbers[v, 1], numbers[v, 2], numbers[v, 3] = x, y, f, p
                numbers[v, 4], numbers[v, 5] = q, d
            continue
        unlink(links, gates, t, ASIDE)
        if to_split >= 0 and front.rule.split:
            ask[0] = to_split
            return SPLIT
        counts[GIVEN_UP] += 1
    return MORE
