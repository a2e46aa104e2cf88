"""Moving vertices and swapping diagonals on half-edges, compiled: what smoothing is made of.

The arrays are those of `planar`: ``vertex``, ``twin``, ``mark`` and, for each vertex, ``at``: a half-edge
that is opposite to it. A marked edge is never crossed, so ``twin`` may be -1 there and the same kernels serve
a mesh without ghosts. A vertex is *free* when no marked edge ends at it. Every move is judged by exact signs:
all triangles around the vertex stay counterclockwise, or it stays where it is.

Sources: D. A. Field, Laplacian smoothing and Delaunay triangulations (1988); L. Chen and M. Holst, Efficient
mesh optimization schemes based on optimal Delaunay triangulations (2011). Book: 2.6c, 2.6d.
"""

from __future__ import annotations

import numpy as np

from ..jit import inline, lean
from ..predicates import incircle, orient2
from .cavity2 import end_of, start_of
from .insertion2 import next_edge, prev_edge

LAPLACE, OPTIMAL, CENTROID = 0, 1, 2  # where to: mean of the neighbors, of circumcenters, of centroids
MOVED, INVALID, WORSE, FLIPS, LOOKED = 0, 1, 2, 3, 4  # what is counted


@lean
def opposite_half_edges(vertex, count, at):
    """For each vertex of the first ``count`` triangles a half-edge opposite to it; -1 for the others."""
    at[:] = -1
    for e in range(3 * count):
        v = vertex[e]
        if v >= 0:
            at[v] = e


@inline
def flip_edge(vertex, twin, mark, where, at, e):
    """Swap the diagonal under half-edge e, which is not marked, in place.

    ::

               b                     b            e and its twin o keep their triangles' apexes p and q,
             / | \\                 /   \\          and lie afterwards on a-q and on b-p; the half-edges
            p e|o q      ->       p --- q         after them, n and on, lie on the new diagonal.
             \\ | /                 \\   /
               a                     a
    """
    o = np.int64(twin[e])
    n, r, on, back = next_edge(e), prev_edge(e), next_edge(o), prev_edge(o)
    p, a, q, b = vertex[e], vertex[n], vertex[o], vertex[on]
    beyond_q, beyond_p = twin[on], twin[n]
    mark_q, mark_p = mark[on], mark[n]
    vertex[r], vertex[back] = q, p
    twin[e], twin[o] = beyond_q, beyond_p
    if beyond_q >= 0:
        twin[beyond_q] = e
    if beyond_p >= 0:
        twin[beyond_p] = o
    mark[e], mark[o] = mark_q, mark_p
    if mark_q >= 0:
        where[mark_q] = e
    if mark_p >= 0:
        where[mark_p] = o
    twin[n], twin[on] = on, n
    mark[n], mark[on] = -1, -1
    at[p], at[a], at[q], at[b] = e, n, o, on


@lean
def legalize(xy, vertex, twin, mark, where, at, stack, depth):
    """Swap the half-edges on the stack, and what follows, until all are locally Delaunay; how many."""
    flips = 0
    while depth > 0:
        depth -= 1
        e = np.int64(stack[depth])
        if mark[e] >= 0:
            continue
        p, a, b, q = vertex[e], start_of(vertex, e), end_of(vertex, e), vertex[twin[e]]
        if min(min(p, q), min(a, b)) < 0:
            continue
        if incircle(xy[p, 0], xy[p, 1], xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[q, 0], xy[q, 1]) > 0:
            o = np.int64(twin[e])
            flip_edge(vertex, twin, mark, where, at, e)
            flips += 1
            if depth + 4 <= len(stack):
                stack[depth], stack[depth + 1] = e, prev_edge(e)
                stack[depth + 2], stack[depth + 3] = o, prev_edge(o)
                depth += 4
            else:  # rather begin anew than leave an edge unseen
                return -1
    return flips


@inline
def turned(twin, e):
    """The half-edge opposite the same vertex in the next triangle, counterclockwise."""
    return next_edge(np.int64(twin[next_edge(e)]))


@lean
def ring_of(twin, mark, first, ring):
    """The half-edges opposite a vertex, counterclockwise from ``first``; how many, 0 if it is not free."""
    e = np.int64(first)
    degree = 0
    while True:
        if mark[next_edge(e)] >= 0:
            return 0
        ring[degree] = e
        degree += 1
        e = turned(twin, e)
        if e == first:
            return degree


@inline
def roundness(ax, ay, bx, by, cx, cy):
    """2 r / R of a triangle: 1 where it is equilateral, 0 where it is flat; the sign is its orientation."""
    area2 = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    a = np.sqrt((cx - bx) ** 2 + (cy - by) ** 2)
    b = np.sqrt((ax - cx) ** 2 + (ay - cy) ** 2)
    c = np.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
    below = (a + b + c) * a * b * c
    return 4.0 * area2 * abs(area2) / below if below > 0.0 else 0.0


@lean
def star_quality(xy, vertex, ring, degree, x, y):
    """The least 2 r / R around a vertex put at (x, y); -1 where a triangle would not be counterclockwise."""
    least = 1.0
    for i in range(degree):
        a, b = start_of(vertex, ring[i]), end_of(vertex, ring[i])
        if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], x, y) <= 0:
            return -1.0
        least = min(least, roundness(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], x, y))
    return least


@lean
def target(xy, vertex, ring, degree, v, method):
    """Where the method would have vertex v: relative to it, so that nothing is lost far from the origin."""
    x0, y0 = xy[v, 0], xy[v, 1]
    sx, sy, weight = 0.0, 0.0, 0.0
    for i in range(degree):
        a, b = start_of(vertex, ring[i]), end_of(vertex, ring[i])
        ax, ay, bx, by = xy[a, 0] - x0, xy[a, 1] - y0, xy[b, 0] - x0, xy[b, 1] - y0
        if method == LAPLACE:
            sx, sy, weight = sx + ax, sy + ay, weight + 1.0
            continue
        area2 = ax * by - ay * bx
        if area2 <= 0.0:
            continue
        if method == OPTIMAL:  # area times circumcenter: the area cancels
            aa, bb = ax * ax + ay * ay, bx * bx + by * by
            sx += 0.5 * (by * aa - ay * bb)
            sy += 0.5 * (ax * bb - bx * aa)
        else:
            sx += area2 * (ax + bx) / 3.0
            sy += area2 * (ay + by) / 3.0
        weight += area2
    if weight <= 0.0:
        return x0, y0
    return x0 + sx / weight, y0 + sy / weight


@lean
def move(xy, vertex, twin, mark, where, at, ring, degree, v, x, y, swap, stack, counts):
    """Put vertex v there, and swap what is no longer locally Delaunay around it."""
    xy[v, 0], xy[v, 1] = x, y
    counts[MOVED] += 1
    if swap:
        depth = 0
        for i in range(degree):
            stack[depth], stack[depth + 1] = ring[i], next_edge(ring[i])
            depth += 2
        flips = legalize(xy, vertex, twin, mark, where, at, stack, depth)
        counts[FLIPS] += max(flips, 0)


@lean
def smooth_round(
    xy, vertex, twin, mark, where, at, fixed, method, smart, swap, threshold, start, stop, ring, stack, counts
):
    """Move each free vertex of ``start <= v < stop`` whose worst triangle is below the threshold, in turn.

    ``smart``: only where the least 2 r / R around it grows. ``fixed`` vertices stay. ``counts`` are added to.
    """
    for v in range(start, stop):
        if fixed[v] or at[v] < 0:
            continue
        degree = ring_of(twin, mark, at[v], ring)
        if degree == 0:
            continue
        before = star_quality(xy, vertex, ring, degree, xy[v, 0], xy[v, 1])
        if before >= threshold:
            continue
        counts[LOOKED] += 1
        x, y = target(xy, vertex, ring, degree, v, method)
        after = star_quality(xy, vertex, ring, degree, x, y)
        if after < 0.0:
            counts[INVALID] += 1
        elif smart and after <= before:
            counts[WORSE] += 1
        elif x != xy[v, 0] or y != xy[v, 1]:
            move(xy, vertex, twin, mark, where, at, ring, degree, v, x, y, swap, stack, counts)


@lean
def search_round(xy, vertex, twin, mark, where, at, fixed, swap, threshold, start, stop, ring, stack, counts):
    """As `smooth_round`, smart, by trial: eight directions, a step that halves where none helps."""
    for v in range(start, stop):
        if fixed[v] or at[v] < 0:
            continue
        degree = ring_of(twin, mark, at[v], ring)
        if degree == 0:
            continue
        x, y = xy[v, 0], xy[v, 1]
        best = star_quality(xy, vertex, ring, degree, x, y)
        if best >= threshold or best < 0.0:
            continue
        counts[LOOKED] += 1
        step = 0.0
        for i in range(degree):
            a = start_of(vertex, ring[i])
            step = max(step, abs(xy[a, 0] - x) + abs(xy[a, 1] - y))
        step *= 0.25
        better = False
        for _ in range(12):
            found = False
            for k in range(8):
                angle = k * (np.pi / 4)
                tx, ty = x + step * np.cos(angle), y + step * np.sin(angle)
                value = star_quality(xy, vertex, ring, degree, tx, ty)
                if value > best:
                    best, nx, ny, found = value, tx, ty, True
            if found:
                x, y, better = nx, ny, True
            else:
                step *= 0.5
        if better:
            move(xy, vertex, twin, mark, where, at, ring, degree, v, x, y, swap, stack, counts)
        else:
            counts[WORSE] += 1
