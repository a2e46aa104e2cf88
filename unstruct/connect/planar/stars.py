"""Stars of vertices, compiled: their quality, better places for a vertex, and the swaps after a move.

The arrays are those of `PlanarComplex`: ``vertex``, ``twin``, ``mark`` and, for each vertex, ``at``, a
half-edge opposite it. A marked edge is never crossed, so ``twin`` may be -1 there, and the same kernels serve
a mesh without ghosts. A vertex may move if no marked edge ends at it. The half-edges opposite it then close
around its star. A list of the places around the vertex is all that is needed to judge where it should go.

A triangle is measured by 2 r / R (r inradius, R circumradius), which is 1 if it is equilateral, or, where a
vertex must be judged in a fraction of a microsecond, by its *fairness*, 4 sqrt(3) area / (a^2 + b^2 + c^2).
Near 1 this decreases as 2 r / R does, and it needs no roots. In addition, the sine of the minimum angle must
not decrease while it is below that of 30 degrees, because a triangle may become rounder although its minimum
angle becomes smaller. Every place is judged by exact signs: it is refused unless all triangles of the star
stay counterclockwise. Book: 2.6c, 2.6d.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...predicates.kernels import incircle, orient2
from ..insertion.halfedges import end_of, next_edge, prev_edge, start_of

FAIRNESS = 0  # stars are judged by fairness and sine
ROUNDNESS = 1  # stars are judged by the smallest 2 r / R alone
TWICE_ROOT3 = 2.0 * sqrt(3.0)
EASY = 0.77  # beyond it every angle is above 30 degrees: the extreme triangle has angles of 30, 75 and 75
SAFE = 0.25  # the squared sine of 30 degrees: a minimum angle above it may become smaller
GIVE = 1e-6  # the smallest gain of fairness for which a vertex is moved
FAIR = 0.85  # a triangle above it may become less fair if the others of its star gain more
# Twice an area is certainly positive if it exceeds CERTAIN times the sum of the squared edges plus TINY_AREA:
# this is far above the error of the filter.
CERTAIN = 1e-9
TINY_AREA = 1e-280
MOST_STEPS = 256  # of a pattern search: far more than usual
COMPASS = (
    (1.0, 0.0),
    (0.7, 0.7),
    (0.0, 1.0),
    (-0.7, 0.7),
    (-1.0, 0.0),
    (-0.7, -0.7),
    (0.0, -1.0),
    (0.7, -0.7),
)


class Stars(NamedTuple):
    """The arrays of a triangulation whose vertices are moved, and scratch for one star."""

    xy: NDArray[np.float64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    mark: NDArray[np.int32]
    where: NDArray[np.int32]
    at: NDArray[np.int32]
    still: NDArray[np.bool_]  # whether each vertex must not move
    ring: NDArray[np.int32]  # half-edges opposite the vertex
    places: NDArray[np.float64]  # (., 2) the points where these half-edges begin
    stack: NDArray[np.int32]  # half-edges to be tested after a move
    counts: NDArray[np.int64]  # how often each kind of event happened


# --- swaps ----------------------------------------------------------------------------------------


@lean
def opposite_half_edges(vertex, region, count, at):
    """For each vertex of a triangle that has a region a half-edge opposite it; -1 for the others."""
    for v in range(at.shape[0]):
        at[v] = -1
    for t in range(count):
        if region[t] >= 0:
            for e in range(3 * t, 3 * t + 3):
                at[vertex[e]] = e


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
    """Swap half-edges on the stack, and those affected, until all are locally Delaunay; return how many.

    Returns -1 if the stack is full; the work must then be repeated.
    """
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
            else:  # begin again rather than leave an edge untested
                return -1
    return flips


@inline
def touched(vertex, t, moved):
    """Whether a corner of triangle t has moved."""
    return moved[vertex[3 * t]] or moved[vertex[3 * t + 1]] or moved[vertex[3 * t + 2]]


@lean
def legalize_moved(stars, region, count, moved):
    """Swap the diagonals that the moves of all these vertices require; return how many."""
    xy, vertex, twin, mark, stack = stars.xy, stars.vertex, stars.twin, stars.mark, stars.stack
    flips, full = 0, True
    while full:  # repeated if the stack was too short, which is rare
        full = False
        for t in range(count):
            if region[t] < 0 or not touched(vertex, t, moved):
                continue
            for e in range(3 * t, 3 * t + 3):
                o = twin[e]
                if mark[e] < 0 and (o > e or not touched(vertex, o // 3, moved)):
                    # most edges stay: this test, here, takes a third of the time of a call for each of them
                    p, a, b, q = vertex[e], start_of(vertex, e), end_of(vertex, e), vertex[o]
                    ax, ay, bx, by = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1]
                    if q >= 0 and incircle(xy[p, 0], xy[p, 1], ax, ay, bx, by, xy[q, 0], xy[q, 1]) > 0:
                        stack[0] = e
                        more = legalize(xy, vertex, twin, mark, stars.where, stars.at, stack, np.int64(1))
                        flips, full = flips + max(more, 0), full or more < 0
    return flips


@lean
def legalize_all(stars, region, count):
    """Make all triangles of the domain constrained Delaunay by swaps; return how many."""
    xy, vertex, twin, mark, stack = stars.xy, stars.vertex, stars.twin, stars.mark, stars.stack
    flips, full = 0, True
    while full:
        full = False
        for t in range(count):
            if region[t] < 0:
                continue
            p, a, b = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
            px, py, ax, ay, bx, by = xy[p, 0], xy[p, 1], xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1]
            for e in range(3 * t, 3 * t + 3):
                o = twin[e]
                if mark[e] < 0 and o > e:
                    q = vertex[o]
                    if incircle(px, py, ax, ay, bx, by, xy[q, 0], xy[q, 1]) > 0:
                        stack[0] = e
                        more = legalize(xy, vertex, twin, mark, stars.where, stars.at, stack, np.int64(1))
                        flips, full = flips + max(more, 0), full or more < 0
                        break  # the triangle has changed; the swap has seen its other edges
    return flips


# --- stars ----------------------------------------------------------------------------------------


@inline
def star_of(xy, vertex, twin, first, ring, places):
    """Write the half-edges opposite a vertex, counterclockwise from ``first``; return their number k.

    ``places[:k + 1]`` gets the points where they begin, the first one once more at the end.
    """
    e, k = np.int64(first), 0
    n = next_edge(e)
    while True:
        a = vertex[n]
        ring[k], places[k, 0], places[k, 1] = e, xy[a, 0], xy[a, 1]
        beyond, k = np.int64(twin[n]), k + 1
        e, n = next_edge(beyond), prev_edge(beyond)  # opposite the same vertex, and the one after
        if e == first:
            places[k, 0], places[k, 1] = places[0, 0], places[0, 1]
            return k


@inline
def measures(ax, ay, bx, by, cx, cy):
    """2 r / R of a counterclockwise triangle, and the squared sine of its minimum angle."""
    ux, uy, vx, vy, wx, wy = bx - ax, by - ay, cx - bx, cy - by, ax - cx, ay - cy
    double = ux * (cy - ay) - uy * (cx - ax)
    u, v, w = ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy
    below = u * v * w
    if double <= 0.0 or below == 0.0:  # also where the squares of the edges are below all doubles
        return 0.0, 0.0
    a, b, c = sqrt(u), sqrt(v), sqrt(w)
    square = double * double
    return 4.0 * square / ((a + b + c) * a * b * c), square * min(u, v, w) / below


@inline
def _rated(places, i, x, y, ux, uy, u, judge):
    """The quality of triangle i of a star, the squared sine, and the vector to its second place, squared.

    ``ux, uy, u`` are the vector from (x, y) to its first place and the square. The sine is 1 if it does not
    matter; the quality is -1 if the triangle is not counterclockwise.
    """
    vx, vy = places[i + 1, 0] - x, places[i + 1, 1] - y
    wx, wy = vx - ux, vy - uy
    v, w, double = vx * vx + vy * vy, wx * wx + wy * wy, ux * vy - uy * vx
    around, below = u + v + w, u * v * w
    quality = angle = 0.0
    if (
        double <= CERTAIN * around + TINY_AREA  # otherwise the sign is certain
        and orient2(places[i, 0], places[i, 1], places[i + 1, 0], places[i + 1, 1], x, y) <= 0
    ):
        quality = -1.0
    elif below > 0.0 and double > 0.0:
        if judge == ROUNDNESS:
            a, b, c = sqrt(u), sqrt(v), sqrt(w)
            quality = 4.0 * double * double / ((a + b + c) * a * b * c)
        else:
            quality = TWICE_ROOT3 * double / around
            # the sine opposite the shortest side is twice the area over the product of the other two
            angle = double * double * min(u, min(v, w)) / below if quality < EASY else 1.0
    return quality, angle, vx, vy, v


@inline
def _judged(places, k, x, y, floor, judge):
    """`star_measures`, and a triangle whose quality is not above ``floor``, or 0 if there is none."""
    least, sine, total = 2.0, 1.0, 0.0
    ux, uy = places[0, 0] - x, places[0, 1] - y
    u = ux * ux + uy * uy
    for i in range(k):
        quality, angle, ux, uy, u = _rated(places, i, x, y, ux, uy, u, judge)
        if quality < 0.0 or quality <= floor:
            return -1.0, -1.0, -1.0, i
        sine = min(sine, angle)
        least, total = min(least, quality), total + quality
    return least, sine, total, 0


@inline
def star_measures(places, k, x, y, floor, judge):
    """The smallest quality and squared sine, and the sum of the qualities, in a star with its vertex at x, y.

    All three are -1 if a triangle is not counterclockwise or its quality is not above ``floor``. The sine is
    1 if it does not matter.
    """
    least, sine, total, _ = _judged(places, k, x, y, floor, judge)
    return least, sine, total


@inline
def floor_for(least, judge):
    """The bound above which all triangles of a star must be, to replace a star of this smallest quality."""
    if judge == ROUNDNESS:
        return least
    return least + GIVE if least < FAIR else FAIR


@inline
def better(new, old, judge):
    """Whether a star with the measures ``new``, computed with `floor_for` the old ones, is to be preferred.

    If the worst triangle is poor, it must become better; if all are fair, the sum of fairness must increase.
    """
    if new[0] < 0.0:
        return False
    if judge == ROUNDNESS:
        return True
    return (new[1] >= old[1] or new[1] >= SAFE) and (old[0] < FAIR or new[2] > old[2] + GIVE)


@lean
def search(places, k, x, y, old, judge):
    """A better place for the vertex of a star, by pattern search in eight directions with halved steps.

    It ends after `MOST_STEPS`: beside a very short edge a step is very short, and every one of them may help.
    """
    step = 0.25 * sqrt((places[0, 0] - x) ** 2 + (places[0, 1] - y) ** 2)
    smallest = step / 64.0
    left, poor = MOST_STEPS, 0
    while step > smallest and left > 0:
        found = False
        left -= 1
        floor = floor_for(old[0], judge)
        for dx, dy in COMPASS:
            to_x, to_y = x + step * dx, y + step * dy
            # The triangle by which another place was refused is looked at first: it mostly refuses this one.
            ux, uy = places[poor, 0] - to_x, places[poor, 1] - to_y
            if _rated(places, poor, to_x, to_y, ux, uy, ux * ux + uy * uy, judge)[0] <= floor:
                continue
            least, sine, total, at = _judged(places, k, to_x, to_y, floor, judge)
            new = least, sine, total
            if better(new, old, judge):
                x, y, old, found = to_x, to_y, new, True
                break
            poor = at if least < 0.0 else poor
        if not found:
            step /= 2.0
    return x, y


@lean
def swap_around(stars, k):
    """Swap the diagonals that a move of the vertex inside the ring requires; return how many."""
    ring, stack = stars.ring, stars.stack
    depth = 0
    for i in range(k):
        stack[depth], stack[depth + 1] = ring[i], next_edge(np.int64(ring[i]))
        depth += 2
    return legalize(stars.xy, stars.vertex, stars.twin, stars.mark, stars.where, stars.at, stack, depth)
