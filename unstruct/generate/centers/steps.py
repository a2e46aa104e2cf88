"""Circumcenter insertion among constrained edges, compiled: the worst triangle, its center, the insertion.

The value of each bad triangle of the domain is in the tournament ``tree``. If its circumcenter cannot be
used, the value is taken out and ``why`` keeps the reason until the slot contains another triangle. Insertion
is that of `connect.planar.cavity`: the cavity is found and judged before anything is changed.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import DONE, HIDDEN, MORE, ROUNDED, SPLIT
from ...base.jit import inline, lean
from ...connect.insertion.halfedges import VERTICES, end_of, next_edge, prev_edge, start_of
from ...connect.planar.cavity import GHOST, blocked_by, commit, find_cavity
from ...predicates.kernels import incircle, orient2
from .worst import NONE, enter, is_large, is_small, measures, put, record, top, unwatch

UNSPLIT, TOO_THIN, TOO_SMALL = 8, 9, 10  # reasons why a triangle is left as it is, besides HIDDEN and ROUNDED
REASONS = {
    HIDDEN: "its circumcenter lies beyond or on a boundary or inner edge",
    ROUNDED: "rounding to doubles leaves no valid place for its circumcenter",
    UNSPLIT: "the edge between it and its circumcenter cannot be halved: it is too short for doubles, "
    "or a vertex lies between chord and curve",
    TOO_THIN: "narrow: a gap or wedge this long and thin would take very many vertices on its sides; a "
    "budget allows them",
    TOO_SMALL: "it is so small that doubles cannot halve the edges near it: its circumradius is below "
    "about 2**-44 of the largest coordinate",
    0: "budget",
}
# Of the largest coordinate: rounding would bend the halves of a shorter subsegment. The shapes of triangles
# below it are not improved, either: beside edges that stay as they are, a chain of ever smaller centers would
# go through all exponents of doubles, in fans of needles that are all judged again after each insertion.
SHORTEST_SPLIT = 2.0**-44
FAR_CENTER = 4.0  # of a center farther away only the direction is used (the domain lies within 1)


@inline
def _enter(plane, contest, t, why):
    xy, vertex = plane.xy, plane.vertex
    why[t] = 0
    if plane.region[t] < 0:
        put(contest.tree, t, NONE)
        unwatch(contest.watch, t)
        return
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    enter(contest, t, xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])


@lean
def enter_slots(plane, contest, slots, why):
    """Judge the triangles in these slots, and put them into the tournaments."""
    for i in range(len(slots)):
        _enter(plane, contest, slots[i], why)


@lean
def first_marked(xy, vertex, twin, mark, t, px, py):
    """The first marked half-edge on the way from the centroid of triangle t to p; -1 if there is none.

    Exact signs lead from edge to edge; p may lie on the edge that is found.
    """
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    gx, gy = (xy[a, 0] + xy[b, 0] + xy[c, 0]) / 3.0, (xy[a, 1] + xy[b, 1] + xy[c, 1]) / 3.0
    e = np.int64(-1)
    for k in range(3):
        u, v = start_of(vertex, 3 * t + k), end_of(vertex, 3 * t + k)
        if orient2(xy[u, 0], xy[u, 1], xy[v, 0], xy[v, 1], gx, gy) <= 0:
            return np.int64(-1)  # the triangle is so thin that its rounded centroid is not inside
        if (
            orient2(gx, gy, px, py, xy[u, 0], xy[u, 1]) <= 0 <= orient2(gx, gy, px, py, xy[v, 0], xy[v, 1])
            and orient2(xy[u, 0], xy[u, 1], xy[v, 0], xy[v, 1], px, py) <= 0
        ):
            e = np.int64(3 * t + k)
    while e >= 0 and mark[e] < 0:
        o = np.int64(twin[e])
        w = vertex[o]
        if w == GHOST:
            return np.int64(-1)
        e = next_edge(o) if orient2(gx, gy, px, py, xy[w, 0], xy[w, 1]) >= 0 else prev_edge(o)
        u, v = start_of(vertex, e), end_of(vertex, e)
        if orient2(xy[u, 0], xy[u, 1], xy[v, 0], xy[v, 1], px, py) > 0:
            return np.int64(-1)
    return e


@lean
def judge_center(plane, scratch, t, px, py):
    """The cavity of the center p of triangle t: (m, k, e); k = 0 if p cannot be inserted.

    In this case e is the marked half-edge that hides p from t, or -1 if rounding is the reason.
    """
    xy, vertex = plane.xy, plane.vertex
    nothing = np.int64(0)
    far = max(abs(px), abs(py))
    if not far < np.inf:
        return nothing, nothing, np.int64(-1)
    if far <= FAR_CENTER:
        a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
        if incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], px, py) > 0:
            m, k = find_cavity(plane, scratch, t, px, py)
            if k > 0 and blocked_by(xy, vertex, scratch.rim, k, px, py) < 0:
                return np.int64(m), np.int64(k), np.int64(-1)
    else:
        px, py = px * (FAR_CENTER / far), py * (FAR_CENTER / far)
    return nothing, nothing, first_marked(xy, vertex, plane.twin, plane.mark, t, px, py)


@lean
def encroached(plane, kept, rim, k, px, py):
    """Examine the marked half-edges on the boundary of the cavity with p in their open diametral disks.

    Return the longest of those that may be split, or -1, and whether there are any such half-edges at all.
    """
    xy, vertex, mark = plane.xy, plane.vertex, plane.mark
    found, longest, close = np.int64(-1), 0.0, False
    for i in range(k):
        e = rim[i]
        if mark[e] >= 0:
            a, b = start_of(vertex, e), end_of(vertex, e)
            ux, uy, vx, vy = xy[a, 0] - px, xy[a, 1] - py, xy[b, 0] - px, xy[b, 1] - py
            length = (vx - ux) ** 2 + (vy - uy) ** 2
            if ux * vx + uy * vy < 0.0:
                close = True
                if length > longest and not kept[plane.piece[mark[e]]]:
                    found, longest = np.int64(e), length
    return found, close


@lean
def note(contest, vertex, t, i, radius, kind, close):
    """Record step i: the state before it, its triangle t, and what is done."""
    record(contest, vertex, t, i, radius)
    contest.events[i, 5], contest.events[i, 6] = kind, close


@lean
def insert_centers(plane, scratch, contest, why, kept, stop, first, ask):
    """Insert circumcenters of worst triangles until there are ``stop`` vertices: DONE, MORE or SPLIT.

    SPLIT: the marked half-edge ``ask[0]``, on a piece that is not ``kept``, hides the center of triangle
    ``ask[1]``, or its open diametral disk contains it; ``ask[2]`` is 1 if it is shorter than the size or
    limit asks for (`is_small`). Vertices from ``first`` on are recorded.
    """
    xy, vertex, state, tree = plane.xy, plane.vertex, plane.state, contest.tree
    while state[VERTICES] < stop:
        if tree[1] == NONE:
            return DONE
        t = top(tree)
        a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
        radius, _, _, _, _, px, py = measures(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])
        if radius < SHORTEST_SPLIT and not is_large(contest.rule, radius, px, py):
            why[t] = TOO_SMALL
            put(tree, t, NONE)
            continue
        m, k, e = judge_center(plane, scratch, t, px, py)
        longest, close = encroached(plane, kept, scratch.rim, k, px, py)
        if e >= 0 and not kept[plane.piece[plane.mark[e]]]:
            longest = e
        if longest >= 0:
            a, b = start_of(vertex, longest), end_of(vertex, longest)
            square = (xy[b, 0] - xy[a, 0]) ** 2 + (xy[b, 1] - xy[a, 1]) ** 2
            x, y = 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1])
            ask[0], ask[1], ask[2] = longest, t, is_small(contest.rule, square, x, y)
            return SPLIT
        if k == 0:
            why[t] = HIDDEN if e >= 0 else ROUNDED
            put(tree, t, NONE)
            continue
        p = state[VERTICES]
        if len(contest.watch) > 0:
            note(contest, vertex, t, p - first, radius, 0.0, 1.0 if close else 0.0)
        xy[p, 0], xy[p, 1] = px, py
        commit(plane, scratch, m, k, p)
        for i in range(k):
            _enter(plane, contest, np.int64(scratch.fresh[i]), why)
    return MORE if tree[1] > NONE else DONE
