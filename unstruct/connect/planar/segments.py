"""Insertion of segments into a Delaunay triangulation in the plane, compiled.

The half-edges are those of `insertion.plane`. ``mark[e]`` is the number of the segment on which half-edge e
lies, -1 for none; ``corner[v]`` is one half-edge e with ``vertex[e] == v``, from which the star of v can be
traversed. A segment a b is inserted in three steps:

1. *Aim*: turn through the star of a to the triangle that the ray to b enters, or to an edge along it.
2. *March* through the triangles that the segment crosses, up to the first vertex on it. This is b, or a
   vertex that happens to lie on the segment, which then consists of several parts. The sides of these
   triangles that are not crossed form one chain above the segment and one below.
3. *Fill* both polygons with their constrained Delaunay triangles (`filling`): the apex over the base V_i V_j
   is the vertex of the chain between them whose circle contains no other; then the two new bases are treated.

Why the third step is correct: every vertex of a chain was joined to the other side by an edge across the
segment. This straight edge runs within the polygon, so it crosses every base between its vertex and the
segment. Each vertex stays strictly on the left of the base below it, and among the circles through the two
ends of a base there is a smallest one. A chain may pass a vertex, or both sides of an edge, twice (a dangling
edge). Its tip then lies in the triangle of that vertex and the segment, so the vertex is never chosen before
the tip. Outside the two polygons nothing changes, and edges that were constrained Delaunay remain so, because
a new segment can only hide vertices.

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

# How `insert_segments` ends, if not with DONE.
CROSSES = 8  # a segment crosses another one
OVERLAPS = 9  # a segment overlaps another one
LOST = 10  # the star of an end has no triangle in the direction of the other end
LEAVES = 11  # a segment leaves the mesh


@lean
def fill_corners(vertex, slots, corner):
    """For each vertex one half-edge opposite it."""
    for e in range(slots):
        if vertex[e] >= 0:
            corner[vertex[e]] = e


@lean
def carriers(vertex, mark, slots, ends, where):
    """For each segment that is one edge the half-edge that runs along it; return how many are marked."""
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
    """The half-edge opposite ``vertex[e]`` in the next triangle counterclockwise about that vertex."""
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
    """Mark the segments that are edges; return DONE and how many are left, or the code and two equal ones.

    Of two equal segments the second comes first. ``missing`` says which segments are not edges, ``where`` has
    the half-edges along the others.
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
    """How the ray from a to b leaves a: (e, 0) within the triangle of half-edge e, (e, 1) along half-edge e.

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
    """Cross triangles from half-edge e, opposite a, towards b, up to the first vertex on the line.

    Returns the lengths of both chains, and -1 or the half-edge that is in the way: that of an earlier
    segment, or one with a ghost beyond it. The chains are recorded as their half-edges within the crossed
    triangles, from a on.
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
    """Fill both polygons of segment i after a march, and mark it; return its half-edge, which starts at a."""
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
    """Insert the segments ``order``; return (DONE, -1, -1), or the reason, the segment, and the other one.

    ``crossed[i]`` gets the number of triangles that segment i crossed; after ``patience``
    circle tests per corner, `fill` cuts ears.
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
