"""Edges that are too long or too short in a metric, compiled: points on the former, fewer at the latter.

A long edge gets a point in its middle, whose cavity is that of `metric_cavity`. A vertex v with a short edge
vw is drawn onto w: the polygon around v becomes the fan of w, if all triangles of the fan are
counterclockwise, exactly. Then the fan covers the polygon once, and the triangulation stays valid. Book: 3.3.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ...base.codes import INSERTED
from ...base.jit import inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import VERTICES, end_of, free_slot, next_edge, prev_edge, start_of
from ...connect.planar.cavity import commit_here
from ...connect.planar.stars import star_of
from ...predicates.kernels import orient2
from ...sizing.metric_table import root_at
from .metric_cavity import attempt_in_metric, square_of
from .metric_improve import fairness_at

LONG_EDGE, SHORT_EDGE = sqrt(2.0), 0.62  # edges beyond these get a point, or lose one
HALF_CLEAR = 0.6  # no point in the middle of an edge nearer than this to a vertex
ENOUGH_QUALITY = 0.5  # a vertex is removed if all new triangles are so good, or better than the worst before


@inline
def square_between(table, ax, ay, bx, by):
    """The squared length of an edge in the metric at its middle."""
    dx, dy = bx - ax, by - ay
    return square_of(root_at(table, ax + 0.5 * dx, ay + 0.5 * dy), dx, dy)


@inline
def longest_inner(plane, table, t):
    """The longest edge of triangle t that is not marked, if it is too long, or -1."""
    xy, vertex = plane.xy, plane.vertex
    best, most = np.int64(-1), LONG_EDGE * LONG_EDGE
    for e in range(3 * t, 3 * t + 3):
        a, b = start_of(vertex, e), end_of(vertex, e)
        square = square_between(table, xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1])
        if square > most and plane.mark[e] < 0:
            best, most = np.int64(e), square
    return best


@inline
def is_listed(vertex, t, todo):
    """Whether a corner of triangle t is in ``todo`` or new."""
    for e in range(3 * t, 3 * t + 3):
        if vertex[e] >= len(todo) or todo[vertex[e]]:
            return True
    return False


@lean
def split_long(plane, scratch, table, todo, t, most):
    """Give long edges a point, triangle by triangle from t on; those without a corner in ``todo`` are left.

    Returns the triangle where it stopped, since there is no room, or since there are ``most`` vertices; the
    number of triangles at the end.
    """
    xy, state = plane.xy, plane.state
    while t < state[COUNT]:
        if state[VERTICES] >= min(len(xy), most) or state[COUNT] + 4 > len(plane.region):
            return t
        e = np.int64(-1)
        if plane.region[t] >= 0 and is_listed(plane.vertex, t, todo):
            e = longest_inner(plane, table, t)
        if e >= 0:
            a, b = start_of(plane.vertex, e), end_of(plane.vertex, e)
            x, y = xy[a, 0] + 0.5 * (xy[b, 0] - xy[a, 0]), xy[a, 1] + 0.5 * (xy[b, 1] - xy[a, 1])
            m = root_at(table, x, y)
            outcome, cells, k, _ = attempt_in_metric(
                plane, scratch, np.int64(t), np.int64(-1), m, (x, y), HALF_CLEAR
            )
            if outcome == INSERTED:
                v = state[VERTICES]
                xy[v, 0], xy[v, 1] = x, y
                commit_here(plane, scratch, cells, k, v)
        t += 1
    return t


@inline
def may_draw(places, k, table, j, old):
    """Whether the polygon of a star may become the fan of its corner j."""
    x, y = places[j, 0], places[j, 1]
    before = j - 1 if j > 0 else k - 1
    for i in range(k):
        ax, ay, bx, by = places[i, 0], places[i, 1], places[i + 1, 0], places[i + 1, 1]
        if i != j and square_between(table, x, y, ax, ay) > LONG_EDGE * LONG_EDGE:
            return False
        if i == j or i == before:
            continue
        if fairness_at(table, x, y, ax, ay, bx, by) <= min(old, ENOUGH_QUALITY):
            return False
        if orient2(ax, ay, bx, by, x, y) <= 0:
            return False
    return True


@inline
def draw_onto(plane, stars, k, v, j):
    """Replace the star of vertex v by the fan of its corner j: two triangles fewer."""
    vertex, twin, mark, where, at, ring = (
        stars.vertex, stars.twin, stars.mark, stars.where, stars.at, stars.ring,
    )  # fmt: skip
    before = j - 1 if j > 0 else k - 1
    w = start_of(vertex, np.int64(ring[j]))
    for i in (j, before):
        e = np.int64(ring[i])
        g = twin[next_edge(e)] if i == j else twin[prev_edge(e)]
        o, s = twin[e], mark[e]
        twin[g], mark[g] = o, s
        if o >= 0:
            twin[o] = g
        if s >= 0:
            where[s] = g
    for i in range(k):
        if i != j and i != before:
            e = np.int64(ring[i])
            vertex[e] = w
            at[w], at[start_of(vertex, e)], at[end_of(vertex, e)] = e, next_edge(e), prev_edge(e)
    for i in (j, before):
        free_slot(vertex, twin, plane.region, plane.state, np.int64(ring[i]) // 3)
    at[v], stars.still[v] = -1, True


@lean
def remove_short(plane, stars, table, todo):
    """Draw vertices of ``todo`` that have a short edge onto its other end; return how many."""
    xy, places = stars.xy, stars.places
    removed = 0
    for v in range(len(stars.at)):
        if stars.still[v] or not todo[v]:
            continue
        k = star_of(xy, stars.vertex, stars.twin, stars.at[v], stars.ring, places)
        x, y = xy[v, 0], xy[v, 1]
        short = False
        least = 2.0
        for i in range(k):
            short = short or square_between(table, x, y, places[i, 0], places[i, 1]) < SHORT_EDGE * SHORT_EDGE
        if not short or k < 4:
            continue
        for i in range(k):
            least = min(
                least,
                fairness_at(table, x, y, places[i, 0], places[i, 1], places[i + 1, 0], places[i + 1, 1]),
            )
        for j in range(k):
            if square_between(table, x, y, places[j, 0], places[j, 1]) < SHORT_EDGE * SHORT_EDGE and may_draw(
                places, k, table, j, least
            ):
                draw_onto(plane, stars, k, v, j)
                removed += 1
                break
    return removed
