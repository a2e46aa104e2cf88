"""Insertion of segments into a Delaunay triangulation in the plane, compiled (half-edges of `insertion2`).

``mark[e]`` is the number of the segment that half-edge e lies on, -1 for none; ``corner[v]`` is one slot e
with ``vertex[e] == v``, so that the star of v can be turned through. A segment a b is put in like this:

1. *Aim*: turn through the star of a to the triangle that the ray to b enters, or to an edge along it.
2. *March* through the triangles that the segment crosses, up to the first vertex on it (b, or a vertex
   that happens to lie there: the segment is then in parts). The sides of these triangles that are not
   crossed form one chain above and one below.
3. *Fill* both pseudo-polygons with their constrained Delaunay triangles (`filling2`): on the base V_i V_j
   stands the vertex of the chain between whose circle holds no other; so on, on the two new bases.

Why the third step is right: every vertex of a chain was joined to the other side by an edge across
the segment. This straight edge runs within the polygon, so it crosses every base that is set between
its vertex and the segment: each vertex stays strictly on the left of the base below it, and among
the circles through the two ends of a base there is a least one. A chain may pass a vertex, or both sides
of an edge, twice (a dangling edge): its tip then lies in the triangle of that vertex and the segment,
so the vertex is never chosen before the tip. Outside the two polygons nothing changes, and edges that
were constrained Delaunay stay so, as a new segment can only hide vertices.

Book: 2.5.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import DONE
from ...base.jit import inline, lean
from ...predicates.kernels import orientation
from ..insertion.halfedges import GHOST, next_edge, prev_edge
from .filling import Chain, fill, load, swap_all

__all__ = [
    "CROSSES", "LEAVES", "LOST", "OVERLAPS", "absent", "carriers", "fill_corners",
    "find_edge", "insert_segments", "mark_present",
]  # fmt: skip

CROSSES, OVERLAPS, LOST, LEAVES = 8, 9, 10, 11  # how `insert_segments` ends, besides DONE


@lean
def fill_corners(vertex, slots, corner):
    """For each vertex one slot that shows it."""
    for e in range(slots):
        if vertex[e] >= 0:
            corner[vertex[e]] = e


@lean
def carriers(vertex, mark, slots, ends, where):
    """For each segment that is one edge the half-edge that runs along it; how many half-edges are marked."""
    marked = 0
    for t in range(slots // 3):
        for k in range(3):
            i = mark[3 * t + k]
            if i >= 0:
                marked += 1
                if vertex[3 * t + (k + 1) % 3] == ends[i, 0]:
                    where[i] = 3 * t + k
    return marked


@inline
def turn(twin, e):
    """The next triangle counterclockwise about ``vertex[e]``: its slot of that vertex."""
    return next_edge(np.int64(twin[next_edge(e)]))


@lean
def find_edge(vertex, twin, corner, a, b):
    """The half-edge from a to b, or -1."""
    first = e = np.int64(corner[a])
    while True:
        if vertex[next_edge(e)] == b:
            return prev_edge(e)
        e = turn(twin, e)
        if e == first:
            return np.int64(-1)


@lean
def absent(vertex, twin, corner, ends, missing):
    """Which segments are not edges."""
    for i in range(len(ends)):
        missing[i] = find_edge(vertex, twin, corner, ends[i, 0], ends[i, 1]) < 0


@lean
def mark_present(vertex, twin, mark, corner, ends, where, missing):
    """Mark the segments that are edges; DONE and how many are left, or two equal ones, the second first.

    ``missing`` tells which are left, ``where`` has the half-edges along the others.
    """
    left = 0
    for i in range(len(ends)):
        e = find_edge(vertex, twin, corner, ends[i, 0], ends[i, 1])
        missing[i] = e < 0
        left += e < 0
        if e >= 0:
            if mark[e] >= 0:
                return OVERLAPS, np.int64(i), np.int64(mark[e])
            mark[e] = i
            mark[twin[e]] = i
            where[i] = e
    return DONE, np.int64(left), np.int64(-1)


@lean
def aim(xy, vertex, twin, corner, a, b):
    """Where the ray from a to b leaves a: (e, 0) within the triangle of slot e, (e, 1) along half-edge e.

    If b is next to a, that is the edge between them, found without signs.

      w
     / \\      With u and w left or right of the ray, strictly, the ray crosses u w. Its line
    a---u      through u and w strictly on its left: the ray passes u, for b cannot be behind a.
    """
    first = e = np.int64(corner[a])
    u = vertex[next_edge(e)]
    if u == b:
        return prev_edge(e), 1
    left = 0 if u == GHOST else orientation(xy, a, b, u)
    while True:
        w = vertex[prev_edge(e)]
        if w == b:
            return np.int64(twin[next_edge(e)]), 1
        right, left = left, 0 if w == GHOST else orientation(xy, a, b, w)
        if u != GHOST and w != GHOST:
            if right < 0 and left > 0:
                return e, 0
            if right == 0 and left > 0:
                return prev_edge(e), 1
            if right < 0 and left == 0:
                return np.int64(twin[next_edge(e)]), 1
        e, u = turn(twin, e), w
        if e == first:
            return np.int64(-1), 1


@inline
def march(w, e, a, b):
    """Cross triangles from slot e at a towards b, up to the first vertex on the line.

    Returns the lengths of both chains, and -1; or, as the last value, the half-edge that is in the way: that
    of an earlier segment, or one with a ghost behind it. Of a chain the half-edges within the crossed
    triangles are noted, from a on.
    """
    vertex, left, right, cells = w.vertex, w.left, w.right, w.cells
    cells[0] = e // 3
    left[0], right[0] = next_edge(e), prev_edge(e)
    m = above = below = 1
    while True:
        o = np.int64(w.twin[e])
        c = vertex[o]
        if w.mark[e] >= 0 or c == GHOST:
            return above, below, e
        cells[m] = o // 3
        m += 1
        side = 0 if c == b else orientation(w.xy, a, b, c)
        if side >= 0:
            left[above] = prev_edge(o)
            above += 1
        if side <= 0:
            right[below] = next_edge(o)
            below += 1
        if side == 0:
            return above, below, np.int64(-1)
        e = next_edge(o) if side > 0 else prev_edge(o)


@inline
def replace(w, above, below, i, patience):
    """Fill what is above and below segment i after a march, and mark it; its half-edge, from a on."""
    vertex, twin, mark, cells, right = w.vertex, w.twin, w.mark, w.cells, w.right
    for k in range(below // 2):  # the lower polygon is on the left of b a
        right[k], right[below - 1 - k] = right[below - 1 - k], right[k]
    one = Chain(w.chains[0], w.chains[1], w.chains[2], w.chains[3])
    two = Chain(w.chains[4], w.chains[5], w.chains[6], w.chains[7])
    load(w, w.left, above, one)
    load(w, right, below, two)
    upper, first = fill(w, cells, one, above, patience)
    rest = cells[above - 1 :]
    lower, second = fill(w, rest, two, below, patience)
    twin[upper], twin[lower] = lower, upper
    mark[upper], mark[lower] = i, i
    if first >= above - 1 and second >= below - 1:
        return upper
    a, b = vertex[next_edge(upper)], vertex[prev_edge(upper)]
    swap_all(w, cells, first, above - 1)
    swap_all(w, rest, second, below - 1)
    return find_edge(vertex, twin, w.corner, a, b)


@lean
def insert_segments(w, ends, order, crossed, patience):
    """Insert the segments ``order``; (DONE, -1, -1), or why not, the segment, and the other one.

    ``crossed[i]`` gets the number of triangles that segment i crossed; ``patience``: tests of a corner, per
    corner, after which `fill` cuts ears.
    """
    vertex, twin, mark = w.vertex, w.twin, w.mark
    for i in order:
        a, b = ends[i, 0], ends[i, 1]
        crossed[i] = 0
        on = True
        while on:
            e, kind = aim(w.xy, vertex, twin, w.corner, a, b)
            if e < 0:
                return LOST, i, np.int64(-1)
            if kind == 0:
                above, below, wall = march(w, e, a, b)
                if wall >= 0:
                    return CROSSES if mark[wall] >= 0 else LEAVES, i, np.int64(mark[wall])
                crossed[i] += above + below - 2
                e = replace(w, above, below, i, patience)
            elif mark[e] >= 0:
                return OVERLAPS, i, np.int64(mark[e])
            else:
                mark[e] = i
                mark[twin[e]] = i
            a = vertex[prev_edge(e)]
            on = a != b
    return DONE, np.int64(-1), np.int64(-1)
