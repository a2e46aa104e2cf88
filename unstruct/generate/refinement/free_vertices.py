"""Removal of free vertices from the disc of a subsegment that is to be split, compiled.

This belongs to Chew's second algorithm.

If a vertex and the triangles around it are removed, a polygon is left. It is filled as in
`connect.insertion.removal`: the triangle on an edge takes the corner whose circle contains no other corner;
then the same is done with the polygons on its other two sides. Among constrained edges a corner may be hidden
from the edge. Then some triangle of the filling is turned over; this is found before anything is changed, and
the vertex stays.

Source: L. P. Chew, Guaranteed-quality mesh generation for curved surfaces, Symposium on Computational
Geometry (1993) 274-280.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import inline, lean
from ...connect.insertion.halfedges import free_slot, next_edge, start_of
from ...predicates.kernels import incircle, orientation
from .encroachment import FREE_VERTEX, REMOVED_VERTEX, encroaches
from .limits import misses
from .state import REMOVED, record, settle

# A vertex stays if its polygon has more corners than this, and no more vertices are removed for one split.
MOST_CORNERS = 64
# Columns of the array ``polygon``. Row i has first the vertex of corner i, the half-edge outside, and the
# slot; then the corners of triangle (or edge) i of the filling, and the half-edge outside of its edge.
RING, OUTER, SLOT, LOW, BEST, HIGH, HALF = range(7)


@lean
def _ring(vertex, twin, e, polygon):
    """Write the polygon around the vertex opposite half-edge e; return its size, 0 if that is too large."""
    first, degree = e, 0
    while degree < MOST_CORNERS:
        polygon[degree, RING] = vertex[next_edge(e)]
        polygon[degree, OUTER] = twin[e]
        polygon[degree, SLOT] = e // 3
        degree += 1
        e = next_edge(np.int64(twin[next_edge(e)]))
        if e == first:
            return degree
    return 0


@lean
def _best(xy, polygon, low, high):
    """The corner between low and high for the triangle on the edge from high to low; or -1."""
    a, b, best = polygon[high, RING], polygon[low, RING], -1
    for i in range(low + 1, high):
        c = polygon[i, RING]
        if orientation(xy, a, b, c) > 0:
            if best < 0:
                best = i
                continue
            r = polygon[best, RING]
            if incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[r, 0], xy[r, 1], xy[c, 0], xy[c, 1]) > 0:
                best = i
    return best


@lean
def _filling(xy, polygon, degree):
    """Write the triangles (low, best, high) that fill the polygon; return how many.

    The result is 0 if a triangle would be turned over.
    """
    polygon[0, LOW], polygon[0, HIGH] = 0, degree - 1
    size = 1
    i = 0
    while i < size:  # a row is an edge low-high until its corner is chosen; then it is a triangle
        low, high = polygon[i, LOW], polygon[i, HIGH]
        best = _best(xy, polygon, low, high)
        if best < 0:
            return 0
        polygon[i, BEST] = best
        if best > low + 1:
            polygon[size, LOW], polygon[size, HIGH] = low, best
            size += 1
        if high > best + 1:
            polygon[size, LOW], polygon[size, HIGH] = best, high
            size += 1
        i += 1
    return size


@lean
def _put(vertex, twin, mark, polygon, degree, count):
    """Write the triangles; column HALF is the half-edge outside of the edge of each row."""
    polygon[0, HALF] = polygon[degree - 1, OUTER]
    size = 1
    for i in range(count):
        low, best, high = polygon[i, LOW], polygon[i, BEST], polygon[i, HIGH]
        e, outside = 3 * polygon[i, SLOT], polygon[i, HALF]
        vertex[e], vertex[e + 1], vertex[e + 2] = polygon[best, RING], polygon[high, RING], polygon[low, RING]
        twin[e], twin[outside] = outside, e
        mark[e] = mark[outside]
        for k in range(2):
            p, q = (low, best) if k == 0 else (best, high)
            side = e + 1 + k
            if q == p + 1:
                o = polygon[p, OUTER]
                twin[side], twin[o] = o, side
                mark[side] = mark[o]
            else:
                mark[side] = -1
                polygon[size, HALF] = side
                size += 1


@inline
def remove_free(w, tally, limits, e):
    """Remove the free vertex opposite half-edge e if possible; return whether it was."""
    v = w.vertex[e]
    degree = _ring(w.vertex, w.twin, e, w.polygon)
    count = _filling(w.xy, w.polygon, degree) if degree > 0 else 0
    if count == 0:
        return False
    for i in range(degree):
        o = w.polygon[i, OUTER]
        s = w.mark[o]
        if s >= 0:
            w.where[s] = o
    record(w, tally, REMOVED, v, (-1, -1, -1), w.xy[v, 0], w.xy[v, 1])
    _put(w.vertex, w.twin, w.mark, w.polygon, degree, count)
    for i in range(count):
        t = w.polygon[i, SLOT]
        bits = misses(w.xy, w.vertex[3 * t], w.vertex[3 * t + 1], w.vertex[3 * t + 2], w.region[t], limits)
        settle(w, tally, t, bits)
    for i in range(count, degree):
        settle(w, tally, w.polygon[i, SLOT], 0)
        free_slot(w.vertex, w.twin, w.region, w.state, w.polygon[i, SLOT])
    w.kind[v] = REMOVED_VERTEX
    tally[REMOVED] += 1
    return True


@lean
def clear_disc(w, tally, limits, s):
    """Remove free vertices from the diametral disc of subsegment s, on both sides; return how many."""
    a, b = w.ends[s, 0], w.ends[s, 1]
    removed = 0
    for side in range(2):
        while removed < MOST_CORNERS:
            e = np.int64(w.where[s])
            if (start_of(w.vertex, e) == a) != (side == 0):
                e = np.int64(w.twin[e])
            p = w.vertex[e]
            if w.region[e // 3] < 0 or w.kind[p] != FREE_VERTEX:
                break
            if not encroaches(w.xy[a, 0], w.xy[a, 1], w.xy[b, 0], w.xy[b, 1], w.xy[p, 0], w.xy[p, 1], 0.0):
                break
            if not remove_free(w, tally, limits, e):
                break
            removed += 1
    return removed
