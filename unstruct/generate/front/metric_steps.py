"""The advancing front in a metric, compiled: `steps`, with everything that is measured going through it.

The wanted length of every edge is 1, so f = 1 / sqrt(3). The queue, the rules of acceptance and the record
are those of `steps`. A triangle is measured in the metric at its centroid, an ideal point in that at the
center of the triangle it makes. For cavities see `metric_cavity`. Source: Book, 3.3.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, INSERTED, MORE, OUTSIDE, ROOM
from ...base.jit import inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import SEGMENTS, VERTICES, end_of, start_of
from ...sizing.metric_table import MetricNodes, root_at
from ...sizing.table import ROOT3
from ..advancing.queue import LAST_LEVEL
from ..rebay.queue import ACCEPTED, LEVEL, STATUS, bucket_of, next_slot, push
from . import bookkeeping as book
from .metric_cavity import attempt_in_metric, mapped, scale_of, square_of, unmapped
from .placing import LONGEST_SIDE, ON_CIRCLE, SHORTEST_SIDE

UNIT_RADIUS = 1.0 / ROOT3  # f: the circumradius of an equilateral triangle with edges of length 1
ACCEPTED_SQUARE = (book.FRONT_ACCEPT * UNIT_RADIUS) ** 2


class MetricMarching(NamedTuple):
    """The queue of unfinished triangles at the front, the metric, and the choices."""

    links: NDArray[np.int32]
    gates: NDArray[np.int32]
    turn: NDArray[np.int64]
    table: MetricNodes
    rule: book.FrontRule


@inline
def circle_of(m, xy, a, b, c):
    """The squared metric circumradius of triangle abc (inf if it is flat), and its metric circumcenter."""
    ux, uy = mapped(m, xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1])
    vx, vy = mapped(m, xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1])
    twice = 2.0 * (ux * vy - uy * vx)
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    if twice <= 1e-14 * (u + v):
        return inf, xy[a, 0], xy[a, 1]
    x, y = (u * vy - v * uy) / twice, (ux * v - vx * u) / twice
    dx, dy = unmapped(m, x, y)
    return x * x + y * y, xy[a, 0] + dx, xy[a, 1] + dy


@inline
def metric_of(plane, table, t):
    """The metric at the centroid of triangle t."""
    xy, vertex = plane.xy, plane.vertex
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    x, y = xy[a, 0] + xy[b, 0] + xy[c, 0], xy[a, 1] + xy[b, 1] + xy[c, 1]
    return root_at(table, x / 3.0, y / 3.0)


@inline
def circle_in_metric(plane, table, t):
    """The squared circumradius and the circumcenter of triangle t, in the metric at its centroid."""
    vertex = plane.vertex
    m = metric_of(plane, table, t)
    return circle_of(m, plane.xy, vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2])


@inline
def shortest_edge(plane, march, t, tried):
    """The metrically shortest edge of triangle t at the front that is not tried, or -1; its square."""
    xy, vertex, mark = plane.xy, plane.vertex, plane.mark
    best, shortest = np.int64(-1), inf
    m = metric_of(plane, march.table, t)
    for j in range(3):
        e = 3 * t + j
        if (tried >> j) & 1 == 0 and mark[e] >= 0:
            a, b = start_of(vertex, e), end_of(vertex, e)
            square = square_of(m, xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1])
            if square < shortest or best < 0:
                best, shortest = np.int64(e), square
    return best, shortest


@lean
def grade_metric(plane, march, t):
    """Set the bucket of triangle t."""
    links, rule = march.links, march.rule
    buckets = len(march.gates) // 2
    if rule.order == book.OLDEST:
        links[t, LEVEL] = LAST_LEVEL + 1
        return
    if rule.order == book.SMALLEST:
        m = metric_of(plane, march.table, t)
        measure = rule.scale * scale_of(m)
    elif rule.order == book.SHORTEST:
        _, square = shortest_edge(plane, march, t, 0)
        measure = rule.scale / square if square > 0.0 else inf
    else:
        square, _, _ = circle_in_metric(plane, march.table, t)
        measure = square / ACCEPTED_SQUARE
    level = bucket_of(measure, buckets - 1) if measure < 1e300 else buckets - 2
    links[t, LEVEL] = LAST_LEVEL + 1 + level


@inline
def enqueue_metric(plane, march, t):
    """Put an unfinished triangle that has just got an edge at the front in the queue."""
    if book.is_to_be_graded(march, t):
        grade_metric(plane, march, t)
        push(march.links, march.gates, march.turn, t, march.rule.last_first)


@lean
def accept_triangle(plane, march, diary, counts, t, e, reason):
    """Accept triangle t, on whose edge e the front is: its other edges enter the front, or leave it."""
    book.accept(plane, march, diary, counts, t, e, reason)
    for j in range(3 * t, 3 * t + 3):
        if book.enters_front(plane, march, j):
            enqueue_metric(plane, march, np.int64(plane.twin[j] // 3))


@inline
def finish_metric_step(plane, march, diary, counts, t, e, reason, stack):
    """Accept triangle t, then all triangles that are small enough and have two edges or more at the front."""
    accept_triangle(plane, march, diary, counts, t, e, reason)
    depth = book.put_neighbors(plane.twin, t, stack, 0)
    while depth > 0:
        o, depth = book.next_nook(plane, march, stack, depth)
        if o < 0:
            break
        square, _, _ = circle_in_metric(plane, march.table, o)
        if square < ACCEPTED_SQUARE:
            g, _ = shortest_edge(plane, march, o, 0)
            accept_triangle(plane, march, diary, counts, o, g, book.CLOSED)
            depth = book.put_neighbors(plane.twin, o, stack, depth)


@lean
def start_metric_front(plane, march):
    """Put the triangles along all subsegments into the queue, in the order of the boundary."""
    book.set_unfinished(plane, march)
    for s in range(plane.state[SEGMENTS]):
        e = np.int64(plane.where[s])
        for t in (e // 3, np.int64(plane.twin[e] // 3)):
            if march.links[t, STATUS] != ACCEPTED:
                enqueue_metric(plane, march, t)


# --- a step ---------------------------------------------------------------------------------------


@inline
def center_of(m, ux, uy, side):
    """From the middle of an edge to the center of the triangle with two sides of this length on it."""
    wx, wy = mapped(m, ux, uy)
    length = sqrt(wx * wx + wy * wy)
    high = sqrt(max(side * side - 0.25 * length * length, 0.0)) / 3.0
    return unmapped(m, -wy / length * high, wx / length * high)


@inline
def kept_side(m, ux, uy):
    """The length of the sides of the ideal triangle: 1, if it suits the length of the edge."""
    length = sqrt(square_of(m, ux, uy))
    return min(max(1.0, SHORTEST_SIDE * length), LONGEST_SIDE * length)


@inline
def ideal_in_metric(plane, march, e):
    """The ideal point for the front edge e: (x, y, side, ahead, m).

    ``ahead``: whether it is in the circle of the triangle ahead; m: the metric in which this was measured.
    """
    xy, vertex, table = plane.xy, plane.vertex, march.table
    a, b, c = start_of(vertex, e), end_of(vertex, e), vertex[e]
    ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    x, y = xy[a, 0] + ux / 2.0, xy[a, 1] + uy / 2.0
    m = root_at(table, x, y)
    if square_of(m, ux, uy) == 0.0:  # the square is below all doubles
        return x, y, 0.0, False, m
    for _ in range(2):
        gx, gy = center_of(m, ux, uy, kept_side(m, ux, uy))
        m = root_at(table, x + gx, y + gy)
    side = kept_side(m, ux, uy)
    wx, wy = mapped(m, ux, uy)
    length = sqrt(wx * wx + wy * wy)
    nx, ny, p = -wy / length, wx / length, length / 2.0
    vx, vy = mapped(m, xy[c, 0] - x, xy[c, 1] - y)
    high = vx * nx + vy * ny
    q = (vx * vx + vy * vy - p * p) / (2.0 * high) if high > 0.0 else inf
    if march.rule.placement == ON_CIRCLE:
        radius = max(UNIT_RADIUS, p)
        d = radius + sqrt(max(radius * radius - p * p, 0.0))
    else:
        d = sqrt(side * side - p * p)
    d = min(d, max(q, p / 2.0))
    ahead = q == inf or d < q + sqrt(q * q + p * p)
    dx, dy = unmapped(m, d * nx, d * ny)
    return x + dx, y + dy, side, ahead, m


@inline
def place_point(plane, march, scratch, m, k, x, y):
    """Replace the cavity by the star of (x, y), and put the new triangles at the front into the queue."""
    book.put_star(plane, march, scratch, m, k, x, y)
    for i in range(k):
        t = np.int64(scratch.fresh[i])
        if plane.mark[3 * t] >= 0:
            enqueue_metric(plane, march, t)


@lean
def without_metric_ideal(plane, march, scratch, counts, t):
    """Whether a triangle for none of whose edges an ideal point was possible must be accepted as it is.

    At first it is set aside. At the end its circumcenter is inserted if it can be.
    """
    if book.put_aside(march, counts, t):
        return False
    square, x, y = circle_in_metric(plane, march.table, t)
    if not square < inf:
        return True
    m = root_at(march.table, x, y)
    outcome, cells, k, _ = attempt_in_metric(plane, scratch, t, np.int64(-1), m, (x, y), book.CLEARANCE)
    if outcome != INSERTED:
        return True
    gone = False  # the triangle itself must be replaced; otherwise this could go on for ever
    for i in range(cells):
        gone = gone or scratch.cells[i] == t
    if gone:
        place_point(plane, march, scratch, cells, k, x, y)
        counts[book.CENTERED] += 1
    return not gone


@inline
def choose_in_metric(plane, march, scratch, counts, e, point, square):
    """Choose what to accept for the front edge e; insert the ideal point, if it is that.

    As `steps.choose`; ``point`` is what `ideal_in_metric` returns.
    """
    x, y, side, ahead, _ = point
    t, apex = e // 3, np.int64(plane.vertex[e])
    if square < ACCEPTED_SQUARE:
        return t, e, book.FITS, np.int64(-1)
    if not ahead:
        return t, e, book.EMPTY, np.int64(-1)
    m = root_at(march.table, x, y)
    clearance = book.CLEARANCE * min(1.0, side)
    outcome, cells, k, near = attempt_in_metric(plane, scratch, t, e, m, (x, y), clearance)
    if outcome == INSERTED:
        i = 0
        while scratch.rim[i] != e:
            i += 1
        place_point(plane, march, scratch, cells, k, x, y)
        t = np.int64(scratch.fresh[i])
        return t, 3 * t, book.NEW, near
    if near == apex:
        return t, e, book.SNAPPED, near
    counts[
        book.WAS_BEYOND if outcome == OUTSIDE else book.WAS_NEAR if near >= 0 else book.WAS_FLAT_ANGLE
    ] += 1
    return t, e, -1, near


@lean
def advance_in_metric(plane, march, scratch, diary, counts, limit):
    """Take up to ``limit`` steps; return how it ended: DONE, MORE, or ROOM."""
    xy, links = plane.xy, march.links
    for _ in range(limit):
        if plane.state[VERTICES] >= len(xy) or plane.state[COUNT] + 4 > len(links):
            return ROOM
        t = np.int64(next_slot(links, march.gates, march.turn))
        if t < 0:
            return DONE
        square, _, _ = circle_in_metric(plane, march.table, t)
        tried = 0
        reason, e, near = -1, np.int64(-1), np.int64(-1)
        point = 0.0, 0.0, 0.0, False, (1.0, 0.0, 1.0)
        while reason < 0:
            e, _ = shortest_edge(plane, march, t, tried)
            if e < 0:
                break
            point = ideal_in_metric(plane, march, e)
            tried |= 1 << (e - 3 * t)
            t, e, reason, near = choose_in_metric(plane, march, scratch, counts, e, point, square)
        if reason < 0 and without_metric_ideal(plane, march, scratch, counts, t):
            e, _ = shortest_edge(plane, march, t, 0)
            reason, near = book.FORCED, np.int64(-1)
        if reason >= 0:
            row = counts[book.MADE]
            if len(diary.log) > 0:
                m = point[4]
                diary.numbers[row, 0], diary.numbers[row, 1] = point[0], point[1]
                diary.numbers[row, 2], diary.numbers[row, 3] = 1.0 / sqrt(scale_of(m)), sqrt(square)
                diary.log[row, 4] = near
            finish_metric_step(plane, march, diary, counts, t, e, reason, scratch.stack)
    return MORE
