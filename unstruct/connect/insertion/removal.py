"""Removing a vertex from a Delaunay triangulation of the plane, compiled.

The triangles around the vertex v leave a hole, whose polygon c_0, c_1, ... runs counterclockwise about v.
All triangles outside stay: their disks were empty with v, so they are empty without it. The hole is filled
from an edge inward: the triangle on an edge gets the vertex of the polygon whose circle contains no other,
and the parts on its two sides are filled in the same way. On the hull, the ghost is one of the vertices of
the polygon; the new hull is the part of the polygon that Graham's scan about v finds.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import inline, kernel
from ...predicates.kernels import incircle, orientation
from .engine import COUNT, LAST
from .halfedges import GHOST, locate2, next_edge


@kernel
def star_of(xy, vertex, twin, state, v, ring, outer, slots):
    """Write the polygon around v (from the ghost on, if present), the half-edges outside and the slots."""
    t = locate2(xy, vertex, twin, state[LAST], xy[v, 0], xy[v, 1])
    e = 3 * t
    while vertex[e] != v:
        e += 1
    first = e
    while vertex[next_edge(e)] != GHOST:
        e = next_edge(np.int64(twin[next_edge(e)]))
        if e == first:
            break
    first = e
    degree = 0
    while degree == 0 or e != first:
        ring[degree] = vertex[next_edge(e)]
        outer[degree] = twin[e]
        slots[degree] = e // 3
        degree += 1
        e = next_edge(np.int64(twin[next_edge(e)]))
    return degree


@inline
def _put(vertex, twin, slot, a, b, c, beyond):
    """A triangle a, b, c in a slot; the edge opposite a is the twin of ``beyond``."""
    e = 3 * slot
    vertex[e], vertex[e + 1], vertex[e + 2] = a, b, c
    twin[e], twin[beyond] = beyond, e
    return e


@kernel
def fill(xy, vertex, twin, ring, outer, slots, used, polygon):
    """Fill ring[low], ..., ring[high], whose last edge has the half-edge ``beyond`` outside."""
    low, high, beyond = polygon
    waiting = np.empty((high - low + 1, 3), dtype=np.int64)
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = low, high, beyond
    size = 1
    while size > 0:
        size -= 1
        low, high, beyond = waiting[size, 0], waiting[size, 1], waiting[size, 2]
        a, b = ring[high], ring[low]
        best = -1
        for m in range(low + 1, high):
            c = ring[m]
            if orientation(xy, a, b, c) > 0:
                r = ring[best]
                if best < 0 or (
                    incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[r, 0], xy[r, 1], xy[c, 0], xy[c, 1])
                    > 0
                ):
                    best = m
        e = _put(vertex, twin, slots[used], ring[best], a, b, beyond)
        used += 1
        for side, i, j in ((e + 1, low, best), (e + 2, best, high)):
            if j == i + 1:
                twin[side], twin[outer[i]] = outer[i], side
            else:
                waiting[size, 0], waiting[size, 1], waiting[size, 2] = i, j, side
                size += 1
    return used


@kernel
def new_hull(xy, ring, degree, hull):
    """Graham's scan over ring[1:], the polygon between the hull neighbors of a hull vertex."""
    size = 0
    for i in range(1, degree):
        while size >= 2 and orientation(xy, ring[hull[size - 2]], ring[hull[size - 1]], ring[i]) > 0:
            size -= 1
        hull[size] = i
        size += 1
    return size


@kernel
def fill_on_hull(xy, vertex, twin, ring, outer, slots, degree, hull):
    """As `fill` if ring[0] is the ghost; False, without any change, if all other vertices are collinear."""
    size = new_hull(xy, ring, degree, hull)
    flat = size == degree - 1
    for i in range(1, degree - 1):
        f = 3 * (outer[i] // 3)
        if vertex[f] != GHOST and vertex[f + 1] != GHOST and vertex[f + 2] != GHOST:
            flat = False
    if flat:
        return False
    used = 0
    before = outer[0]  # the half-edge on the other side of ghost -> c_0
    for i in range(size - 1):
        p, q = hull[i], hull[i + 1]
        ghost = 3 * slots[used]
        vertex[ghost], vertex[ghost + 1], vertex[ghost + 2] = GHOST, ring[p], ring[q]
        twin[ghost + 2], twin[before] = before, ghost + 2
        before = ghost + 1
        used += 1
        if q == p + 1:
            twin[ghost], twin[outer[p]] = outer[p], ghost
        else:
            used = fill(xy, vertex, twin, ring, outer, slots, used, (p, q, ghost))
    last = outer[degree - 1]
    twin[before], twin[last] = last, before
    return True


@kernel
def remove2(xy, vertex, twin, state, v, scratch):
    """Remove vertex v; False, without any change, if no triangle would be left."""
    ring, outer, slots, hull = scratch[0], scratch[1], scratch[2], scratch[3]
    degree = star_of(xy, vertex, twin, state, v, ring, outer, slots)
    if ring[0] == GHOST:
        if not fill_on_hull(xy, vertex, twin, ring, outer, slots, degree, hull):
            return False
    else:
        fill(xy, vertex, twin, ring, outer, slots, 0, (0, degree - 1, outer[degree - 1]))
    # two slots are left over; the last triangles move into them, so that no gaps remain
    x, y = slots[degree - 2], slots[degree - 1]
    for slot in (max(x, y), min(x, y)):
        last = state[COUNT] - 1
        if slot != last:
            for k in range(3):
                f = twin[3 * last + k]
                vertex[3 * slot + k], twin[3 * slot + k], twin[f] = vertex[3 * last + k], f, 3 * slot + k
        state[COUNT] = last
    state[LAST] = 0
    return True
