"""Compiled insertion of points; those that would break a marked edge, or that come too near, are rejected.

A point breaks an edge between two triangles if it lies in both their circles. Take a Delaunay triangulation
in which all marked edges are edges, and search the cavity of a point without crossing a marked edge. This is
the whole cavity unless the point lies in the circle of a triangle beyond a marked edge at its boundary.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import HIDDEN, INSERTED, OUTSIDE
from ...base.jit import lean
from ...connect.insertion.engine import LAST
from ...connect.insertion.halfedges import (
    GHOST,
    VERTICES,
    conflict_across,
    end_of,
    next_edge,
    prev_edge,
    start_of,
)
from ...connect.planar.cavity import blocked_by, commit, find_cavity, walk
from ...predicates.diametral import in_disc
from ...predicates.kernels import orient2

__all__ = ["BREAKS", "CROWDED", "REPEATED", "guard_all", "hit_all"]

REPEATED, BREAKS, CROWDED = 8, 9, 10  # verdicts on a point, besides INSERTED, OUTSIDE and HIDDEN


@lean
def judge_in(xy, vertex, mark, region, part, t, px, py):
    """(verdict, culprit) of p in triangle t: it may be a vertex, on a marked edge, or outside of ``part``.

    ``part`` is -1 if p may be in any part of the domain.
    """
    for k in range(3):
        v = vertex[3 * t + k]
        if v == GHOST:
            return OUTSIDE, np.int64(-1)
        if xy[v, 0] == px and xy[v, 1] == py:
            return REPEATED, np.int64(v)
    for k in range(3):
        e = 3 * t + k
        a, b = start_of(vertex, e), end_of(vertex, e)
        if mark[e] >= 0 and orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) == 0:
            return BREAKS, np.int64(mark[e])
    if region[t] < 0 or (part >= 0 and region[t] != part):
        return OUTSIDE, np.int64(-1)
    return INSERTED, np.int64(-1)


@lean
def judge_rim(plane, rim, k, discs, gap, px, py):
    """(verdict, culprit) of p by the boundary of its cavity, the half-edges ``rim[:k]``.

    p breaks a marked edge if it lies in the circle beyond it or, with ``discs``, in its diametral circle. p
    is crowded if a vertex is nearer than ``gap``; the nearest vertex is a corner of this boundary.
    """
    xy, vertex, twin, mark = plane.xy, plane.vertex, plane.twin, plane.mark
    for i in range(k):
        e = np.int64(rim[i])
        if mark[e] < 0:
            continue
        a, b = start_of(vertex, e), end_of(vertex, e)
        if discs:
            hit = in_disc(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) > 0
        else:
            o = np.int64(twin[e])
            hit = conflict_across(xy, vertex[prev_edge(o)], vertex[next_edge(o)], vertex[o], px, py)
        if hit:
            return BREAKS, np.int64(mark[e])
    nearest, smallest = np.int64(-1), gap * gap
    for i in range(k):
        a = start_of(vertex, np.int64(rim[i]))
        if a != GHOST:
            d = (xy[a, 0] - px) ** 2 + (xy[a, 1] - py) ** 2
            if d < smallest:
                nearest, smallest = np.int64(a), d
    if nearest >= 0:
        return CROWDED, nearest
    return INSERTED, np.int64(-1)


@lean
def guard_all(plane, scratch, points, parts, gaps, discs, verdict, culprit):
    """Insert the points in this order, each with the next free vertex, unless they are rejected.

    ``verdict`` and ``culprit`` (a subsegment or a vertex, -1 for none) say what happened to each point. The
    culprit of an inserted point is its vertex.
    """
    xy, vertex, mark, state, rim = plane.xy, plane.vertex, plane.mark, plane.state, scratch.rim
    for i in range(len(points)):
        px, py = points[i, 0], points[i, 1]
        t = walk(xy, vertex, plane.twin, state[LAST], px, py)
        verdict[i], culprit[i] = judge_in(xy, vertex, mark, plane.region, parts[i], t, px, py)
        if verdict[i] != INSERTED:
            continue
        m, k = find_cavity(plane, scratch, t, px, py)
        if k < 0 or blocked_by(xy, vertex, rim, k, px, py) >= 0:
            verdict[i] = HIDDEN
            continue
        verdict[i], culprit[i] = judge_rim(plane, rim, k, discs, gaps[i], px, py)
        if verdict[i] != INSERTED:
            continue
        p = state[VERTICES]
        xy[p, 0], xy[p, 1] = px, py
        commit(plane, scratch, m, k, p)
        culprit[i] = p


@lean
def hit_from(plane, scratch, t, px, py, hit):
    """Set ``hit`` for the triangles of the cavity of p that begins with triangle t, if t is inside."""
    if plane.region[t] >= 0:
        m, _ = find_cavity(plane, scratch, t, px, py)
        for j in range(m):
            hit[scratch.cells[j]] = True


@lean
def hit_all(plane, scratch, start, points, hit):
    """Set ``hit[t]`` for each triangle in the cavity of one of the points, which the point would replace.

    A point on a marked edge has two cavities, one on each side.
    """
    xy, vertex, twin = plane.xy, plane.vertex, plane.twin
    t = start
    for i in range(len(points)):
        px, py = points[i, 0], points[i, 1]
        t = walk(xy, vertex, twin, t, px, py)
        hit_from(plane, scratch, t, px, py, hit)
        for e in range(3 * t, 3 * t + 3):
            if plane.mark[e] >= 0:
                a, b = start_of(vertex, e), end_of(vertex, e)
                if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) == 0:
                    hit_from(plane, scratch, np.int64(twin[e]) // 3, px, py, hit)
