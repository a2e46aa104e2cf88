"""The advancing front over the constrained Delaunay triangulation of what is not meshed yet, compiled.

Triangles of the domain are *accepted*, that is, finished, or not. The *front* consists of all edges between
the two kinds and of all subsegments that still have an unfinished side. Edges of the front are marked as
subsegments are, all with the same number, so that no cavity crosses them: what has been accepted stays.

          . . X . .        M    middle of the front edge AB, whose unfinished side is on its left
         .   /.\\   .       t    the triangle ABC ahead of it, R its circumradius
        C   / . \\   .      X    the ideal point: XA and XB have the wanted length h
       /   /  .  \\
      ----A---M---B---     A step accepts ABC, or inserts X and accepts ABX.
      ///////////////

What is not meshed is a valid triangulation at all times. So there is always a valid triangle ahead of each
edge of the front, and in the plane the front cannot get stuck. Source: Book, 3.1.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, INSERTED, MORE, OUTSIDE, ROOM, ROUNDED
from ...base.jit import inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import SEGMENTS, VERTICES, end_of, start_of
from ...connect.planar.cavity import find_cavity_here
from ...predicates.kernels import incircle, orient2
from ...sizing.table import ROOT3, Nodes
from ..advancing.queue import LAST_LEVEL
from ..rebay.queue import ACCEPTED, LEVEL, STATUS, bucket_of, next_slot, push
from ..rebay.steps import circle, wanted
from . import bookkeeping as book
from .placing import AS_ASKED, ideal

ASK = 8  # how a call ended: a point is wanted from a function of the caller
TOO_FLAT, NO_SPACE = 9, 10  # outcomes of a judgment, besides INSERTED, OUTSIDE and ROUNDED
AFTER_STEP = -4  # the status of a triangle that will be queued when the step is finished


class Marching(NamedTuple):
    """The queue of unfinished triangles at the front, the size, and the choices."""

    links: NDArray[np.int32]
    gates: NDArray[np.int32]
    turn: NDArray[np.int64]
    size: Nodes
    rule: book.FrontRule


@inline
def front_edge(xy, vertex, mark, t, tried):
    """The shortest edge of triangle t at the front that has not been tried (bits of ``tried``), or -1."""
    best, shortest = np.int64(-1), inf
    for j in range(3):
        e = 3 * t + j
        if (tried >> j) & 1 == 0 and mark[e] >= 0:
            a, b = start_of(vertex, e), end_of(vertex, e)
            ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
            if ux * ux + uy * uy < shortest:
                best, shortest = np.int64(e), ux * ux + uy * uy
    return best


@inline
def radius(plane, march, t):
    """The squared circumradius of triangle t as a quotient, above / below, and f at its centroid."""
    xy, vertex = plane.xy, plane.vertex
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    ux, uy, vx, vy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1], xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
    wx, wy, double = vx - ux, vy - uy, ux * vy - uy * vx
    above = (ux * ux + uy * uy) * (vx * vx + vy * vy) * (wx * wx + wy * wy)
    f = wanted(march, xy[a, 0] + (ux + vx) / 3.0, xy[a, 1] + (uy + vy) / 3.0)
    return above, 4.0 * double * double if double > 0.0 else 0.0, f


@lean
def length_at(march, x, y):
    """The wanted length at a point."""
    return ROOT3 * wanted(march, x, y)


@inline
def grade(plane, march, t):
    """Set the bucket of triangle t."""
    links, rule = march.links, march.rule
    buckets = len(march.gates) // 2
    if rule.order == book.OLDEST:
        links[t, LEVEL] = LAST_LEVEL + 1
        return
    above, below, f = radius(plane, march, t)
    if rule.order == book.SMALLEST:
        above, below = rule.scale, f * f
    elif rule.order == book.SHORTEST:
        e = front_edge(plane.xy, plane.vertex, plane.mark, t, 0)
        above, below = 1.0, inf
        if e >= 0:
            a, b = start_of(plane.vertex, e), end_of(plane.vertex, e)
            ux, uy = plane.xy[b, 0] - plane.xy[a, 0], plane.xy[b, 1] - plane.xy[a, 1]
            above, below = rule.scale, ux * ux + uy * uy
    else:
        below *= f * f * rule.scale
    level = bucket_of(above / below, buckets - 1) if below > 0.0 else buckets - 2
    links[t, LEVEL] = LAST_LEVEL + 1 + level


@inline
def enqueue(plane, march, t):
    """Put an unfinished triangle that has just got an edge at the front in the queue."""
    if book.is_to_be_graded(march, t):
        grade(plane, march, t)
        push(march.links, march.gates, march.turn, t, march.rule.last_first)


@inline
def note_neighbors(plane, march, t, later, many):
    """Let the edges of triangle t, just accepted, enter the front or leave it; note who gets one.

    ``later[:many]`` are the triangles that are queued after the step; they are `AFTER_STEP` until then. For
    the order by edges, which changes with each new one at the front, they are queued at once.
    """
    for j in range(3 * t, 3 * t + 3):
        if book.enters_front(plane, march, j):
            o = np.int64(plane.twin[j] // 3)
            if march.rule.order == book.SHORTEST:
                enqueue(plane, march, o)
            elif march.links[o, STATUS] != AFTER_STEP and book.is_to_be_graded(march, o):
                march.links[o, STATUS], later[many] = AFTER_STEP, o
                many += 1
    return many


@inline
def finish_step(plane, march, diary, counts, t, e, reason, scratch):
    """Accept triangle t, then all triangles that are small enough and have two edges or more at the front.

    The others beside them are queued at the end, in the order in which the front has reached them: to grade
    those that are accepted, too, took a tenth of the time.
    """
    stack, later = scratch.stack, scratch.fresh
    depth = many = 0
    while t >= 0:
        book.accept(plane, march, diary, counts, t, e, reason)
        many = note_neighbors(plane, march, t, later, many)
        depth = book.put_neighbors(plane.twin, t, stack, depth)
        t = np.int64(-1)
        while depth > 0 and t < 0:
            t, depth = book.next_nook(plane, march, stack, depth)
            if t >= 0:
                above, below, f = radius(plane, march, t)
                if above < below * book.FRONT_ACCEPT * book.FRONT_ACCEPT * f * f:
                    e, reason = front_edge(plane.xy, plane.vertex, plane.mark, t, 0), book.CLOSED
                else:
                    t = np.int64(-1)
    for i in range(many):
        t = np.int64(later[i])
        if march.links[t, STATUS] == AFTER_STEP:
            grade(plane, march, t)
            push(march.links, march.gates, march.turn, t, march.rule.last_first)


@lean
def start_front(plane, march):
    """Put the triangles along all subsegments into the queue, in the order of the boundary."""
    book.set_unfinished(plane, march)
    for s in range(plane.state[SEGMENTS]):
        e = np.int64(plane.where[s])
        for t in (e // 3, np.int64(plane.twin[e] // 3)):
            if march.links[t, STATUS] != ACCEPTED:
                enqueue(plane, march, t)


# --- a step ---------------------------------------------------------------------------------------


@inline
def judge_front(plane, rim, k, e, x, y, clearance):
    """Whether (x, y) may be joined to the boundary of its cavity, ``rim[:k]``: an outcome and a vertex.

    The vertex is the nearest one, apart from the ends of e, that is too near; -1 if there is none.
    """
    xy, vertex, mark = plane.xy, plane.vertex, plane.mark
    a, b = (start_of(vertex, e), end_of(vertex, e)) if e >= 0 else (np.int64(-1), np.int64(-1))
    nearest, near = np.int64(-1), clearance * clearance
    outcome = INSERTED
    for i in range(k):
        g = np.int64(rim[i])
        s, v = start_of(vertex, g), end_of(vertex, g)
        sx, sy = xy[s, 0] - x, xy[s, 1] - y
        square = sx * sx + sy * sy
        if square < near and s != a and s != b:
            nearest, near = np.int64(s), square
        if mark[g] >= 0 and outcome == INSERTED:
            if orient2(xy[s, 0], xy[s, 1], xy[v, 0], xy[v, 1], x, y) <= 0:
                outcome = OUTSIDE
            elif g != e:
                vx, vy = xy[v, 0] - x, xy[v, 1] - y
                dot = sx * vx + sy * vy
                if dot < 0.0 and 4.0 * dot * dot >= square * (vx * vx + vy * vy):
                    outcome = TOO_FLAT  # (x, y) sees an edge of the front under 120 degrees or more
    if nearest >= 0:
        return NO_SPACE, nearest
    return outcome, nearest


@inline
def attempt_front(plane, scratch, t, e, x, y, clearance):
    """Find and judge the cavity of (x, y), from triangle t: (outcome, m, k, the vertex that is too near)."""
    m, k = find_cavity_here(plane, scratch, t, x, y)
    if k < 0:
        return ROUNDED, np.int64(0), np.int64(0), np.int64(-1)
    outcome, near = judge_front(plane, scratch.rim, k, e, x, y, clearance)
    return outcome, m, k, near


@inline
def in_circle_of(plane, t, x, y):
    """Whether (x, y) lies inside the circle of triangle t, exactly."""
    xy, vertex = plane.xy, plane.vertex
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    return incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], x, y) > 0


@inline
def insert_here(plane, march, scratch, m, k, x, y, taken):
    """Replace the cavity by the star of (x, y), and put the new triangles at the front into the queue.

    Not that in the place ``taken`` of the star, which is accepted next.
    """
    book.put_star(plane, march, scratch, m, k, x, y)
    for i in range(k):
        t = np.int64(scratch.fresh[i])
        if plane.mark[3 * t] >= 0 and i != taken:
            enqueue(plane, march, t)


@inline
def note(diary, row, point, square, near):
    """Write what was looked at into a row of the record."""
    if len(diary.log) > 0:
        diary.numbers[row, 0], diary.numbers[row, 1] = point[0], point[1]
        diary.numbers[row, 2], diary.numbers[row, 3] = point[2], sqrt(square)
        diary.log[row, 4] = near


@lean
def without_ideal(plane, march, scratch, counts, t):
    """Whether a triangle for none of whose edges an ideal point was possible must be accepted as it is.

    At first it is set aside. At the end its circumcenter is inserted if it can be.
    """
    if book.put_aside(march, counts, t):
        return False
    square, x, y, _, _ = circle(plane.xy, plane.vertex, t)
    if square == inf or not in_circle_of(plane, t, x, y):
        return True
    f = wanted(march, x, y)
    outcome, m, k, _ = attempt_front(plane, scratch, t, np.int64(-1), x, y, book.CLEARANCE * ROOT3 * f)
    if outcome == INSERTED:
        insert_here(plane, march, scratch, m, k, x, y, -1)
        counts[book.CENTERED] += 1
    return outcome != INSERTED


@inline
def choose(plane, march, scratch, counts, e, point, square):
    """Choose what to accept for the front edge e; insert the ideal point, if it is that.

    ``point`` is what `ideal` returns, ``square`` the squared circumradius of the triangle ahead. Returns the
    triangle to accept, its edge at the front, the reason (-1: nothing was possible) and the vertex that was
    too near.
    """
    x, y, f, side, close = point
    t, apex = e // 3, np.int64(plane.vertex[e])
    if square < book.FRONT_ACCEPT * book.FRONT_ACCEPT * f * f:
        return t, e, book.FITS, np.int64(-1)
    if close:
        return t, e, book.CONNECTED, np.int64(-1)
    if not in_circle_of(plane, t, x, y):
        return t, e, book.EMPTY, np.int64(-1)
    clearance = book.CLEARANCE * min(ROOT3 * f, side)
    outcome, m, k, near = attempt_front(plane, scratch, t, e, x, y, clearance)
    if outcome == INSERTED:
        i = 0
        while scratch.rim[i] != e:
            i += 1
        insert_here(plane, march, scratch, m, k, x, y, i)
        t = np.int64(scratch.fresh[i])
        return t, 3 * t, book.NEW, near
    if near == apex:
        return t, e, book.SNAPPED, near
    counts[
        book.WAS_NEAR
        if outcome == NO_SPACE
        else book.WAS_FLAT_ANGLE
        if outcome == TOO_FLAT
        else book.WAS_BEYOND
    ] += 1
    return t, e, -1, near


@lean
def advance_front(plane, march, scratch, diary, counts, ask, answer, limit):
    """Take up to ``limit`` steps; return how it ended: DONE, MORE, ROOM, or ASK.

    ASK wants the ideal point for half-edge ``ask[0]`` in ``answer`` (x, y; NaN for the triangle ahead).
    """
    xy, vertex, mark, links = plane.xy, plane.vertex, plane.mark, march.links
    for _ in range(limit):
        if plane.state[VERTICES] >= len(xy) or plane.state[COUNT] + 4 > len(links):
            return ROOM
        t = np.int64(next_slot(links, march.gates, march.turn))
        if t < 0:
            return DONE
        square, _, _, _, _ = circle(xy, vertex, t)
        tried = ask[1] if ask[0] >= 0 else 0
        reason, e, near = -1, np.int64(-1), np.int64(-1)
        point = 0.0, 0.0, 0.0, 0.0, False
        while reason < 0:
            answered = ask[0] >= 0
            e = np.int64(ask[0]) if answered else front_edge(xy, vertex, mark, t, tried)
            if e < 0:
                break
            point = ideal(plane, march, e)
            if march.rule.placement == AS_ASKED:
                if not answered:
                    ask[0], ask[1] = e, tried
                    return ASK
                ask[0] = -1
                point = answer[0], answer[1], point[2], point[3], not answer[0] == answer[0]
            tried |= 1 << (e - 3 * t)
            t, e, reason, near = choose(plane, march, scratch, counts, e, point, square)
        if reason < 0 and without_ideal(plane, march, scratch, counts, t):
            e, reason, near = front_edge(xy, vertex, mark, t, 0), book.FORCED, np.int64(-1)
        if reason >= 0:
            note(diary, counts[book.MADE], point, square, near)
            finish_step(plane, march, diary, counts, t, e, reason, scratch)
    return MORE
