"""Improvement of a triangulation in a metric, compiled: swaps, moves of vertices, and a survey.

The *metric quality* of a triangle is 4 sqrt(3) area / (sum of its squared edges), both in the metric at its
centroid: 1 if it is equilateral there. A swap is made if the worse of the two triangles is poor and becomes
better, a move if the worst triangle around the vertex does, or, if none of them is poor, if their mean
becomes better. Every swap and every move keeps all triangles counterclockwise, by exact signs. A swap
increases the sorted list of qualities in the order of dictionaries, so swaps end. Book: 3.3.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ...base.jit import inline, lean
from ...connect.insertion.halfedges import end_of, start_of
from ...connect.planar.stars import FAIR, GIVE, TWICE_ROOT3, flip_edge, star_of, touched
from ...predicates.kernels import orient2
from ...sizing.metric_table import root_at
from .metric_cavity import mapped, square_of, unmapped, within

SIX_SIDES = (
    (1.0, 0.0), (0.5, 0.8660254037844386), (-0.5, 0.8660254037844386), (-1.0, 0.0),
    (-0.5, -0.8660254037844386), (0.5, -0.8660254037844386),
)  # fmt: skip


@inline
def fairness_at(table, ax, ay, bx, by, cx, cy):
    """The metric quality of a counterclockwise triangle; 0 where it is flat up to rounding."""
    m = root_at(table, (ax + bx + cx) / 3.0, (ay + by + cy) / 3.0)
    ux, uy = mapped(m, bx - ax, by - ay)
    vx, vy = mapped(m, cx - ax, cy - ay)
    wx, wy = vx - ux, vy - uy
    around = ux * ux + uy * uy + vx * vx + vy * vy + wx * wx + wy * wy
    double = ux * vy - uy * vx
    return TWICE_ROOT3 * double / around if double > 0.0 else 0.0


@inline
def quality_of(xy, table, a, b, c):
    """The metric quality of the triangle of three vertices."""
    return fairness_at(table, xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])


@inline
def may_swap(xy, vertex, twin, mark, e):
    """Whether the diagonal under half-edge e may be swapped: both new triangles are counterclockwise."""
    if mark[e] >= 0 or twin[e] < 0:
        return False
    p, a, b, q = vertex[e], start_of(vertex, e), end_of(vertex, e), vertex[twin[e]]
    return (
        min(min(p, q), min(a, b)) >= 0
        and orient2(xy[p, 0], xy[p, 1], xy[a, 0], xy[a, 1], xy[q, 0], xy[q, 1]) > 0
        and orient2(xy[q, 0], xy[q, 1], xy[b, 0], xy[b, 1], xy[p, 0], xy[p, 1]) > 0
    )


@lean
def swap_for_circles(stars, region, count, table):
    """One pass of swaps where the far corner lies in the metric circle; return how many.

    The metric is that at the middle of the edge. Nothing says that this ends: make few passes.
    """
    xy, vertex, twin, mark = stars.xy, stars.vertex, stars.twin, stars.mark
    swaps = 0
    for t in range(count):
        if region[t] < 0:
            continue
        for j in range(3):
            e = np.int64(3 * t + j)
            if mark[e] >= 0:
                continue
            p, a, b, q = vertex[e], start_of(vertex, e), end_of(vertex, e), vertex[twin[e]]
            m = root_at(table, 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1]))
            if within(m, xy, p, a, b, xy[q, 0], xy[q, 1]) and may_swap(xy, vertex, twin, mark, e):
                flip_edge(vertex, twin, mark, stars.where, stars.at, e)
                swaps += 1
                break
    return swaps


@inline
def swap_if_better(stars, table, e):
    """Swap the diagonal under half-edge e if the worse of its two triangles becomes better."""
    xy, vertex, twin = stars.xy, stars.vertex, stars.twin
    if stars.mark[e] >= 0:
        return False
    p, a, b, q = vertex[e], start_of(vertex, e), end_of(vertex, e), vertex[twin[e]]
    if min(min(p, q), min(a, b)) < 0:
        return False
    old = min(quality_of(xy, table, p, a, b), quality_of(xy, table, q, b, a))
    if old > FAIR:
        return False
    if quality_of(xy, table, p, a, q) <= old + GIVE or quality_of(xy, table, q, b, p) <= old + GIVE:
        return False
    if not may_swap(xy, vertex, twin, stars.mark, e):
        return False
    flip_edge(vertex, twin, stars.mark, stars.where, stars.at, e)
    return True


@lean
def swap_in_metric(stars, region, count, table, todo):
    """One pass of swaps at the triangles that have a corner on the list ``todo``; return how many.

    The corners of swapped triangles are put on the list.
    """
    vertex = stars.vertex
    swaps = 0
    for t in range(count):
        if region[t] < 0 or not touched(vertex, t, todo):
            continue
        for j in range(3):
            e = np.int64(3 * t + j)
            o = np.int64(stars.twin[e])
            if o < e and region[o // 3] >= 0 and touched(vertex, o // 3, todo):
                continue  # seen from the other side
            if swap_if_better(stars, table, e):
                swaps += 1
                for g in range(3 * t, 3 * t + 3):
                    todo[vertex[g]] = True
                todo[vertex[o]] = todo[vertex[e]] = True
                break
    return swaps


@inline
def star_quality(places, k, table, x, y, floor):
    """The smallest metric quality and the sum of all, in a star with its vertex at (x, y).

    Both are -1 if a triangle is not counterclockwise or its quality is not above ``floor``.
    """
    least, total = 2.0, 0.0
    for i in range(k):
        ax, ay, bx, by = places[i, 0], places[i, 1], places[i + 1, 0], places[i + 1, 1]
        quality = fairness_at(table, x, y, ax, ay, bx, by)
        if quality <= floor or orient2(ax, ay, bx, by, x, y) <= 0:
            return -1.0, -1.0
        least, total = min(least, quality), total + quality
    return least, total


@inline
def gains(new, old):
    """Whether a star is better than before: its worst triangle, or, if none is poor, the mean."""
    if new[0] < 0.0:
        return False
    return new[0] > old[0] + GIVE if old[0] < FAIR else new[1] > old[1] + GIVE


@inline
def balanced(places, k, table, x, y):
    """The mean of the places at which the vertex at (x, y) would have the length 1 from each neighbor."""
    sx = sy = 0.0
    for i in range(k):
        dx, dy = x - places[i, 0], y - places[i, 1]
        m = root_at(table, places[i, 0] + 0.5 * dx, places[i, 1] + 0.5 * dy)
        length = sqrt(square_of(m, dx, dy))
        share = 1.0 / length if length > 0.0 else 1.0
        sx, sy = sx + places[i, 0] + share * dx, sy + places[i, 1] + share * dy
    return sx / k, sy / k


@lean
def improve_in_metric(stars, todo, again, table, threshold, start, stop):
    """Look at the vertices ``start <= v < stop`` on the list ``todo``, and move those that gain by it.

    A star without a quality below ``threshold`` is left alone. A vertex is moved to its `balanced` place, or
    half of the way; if neither is better and a triangle is poor, to one of six places around it. The vertex
    and its neighbors are put on the list ``again``. Returns the number of moves.
    """
    xy, places, ring = stars.xy, stars.places, stars.ring
    moves = 0
    for v in range(start, stop):
        if not todo[v]:
            continue
        todo[v] = False
        if stars.still[v]:
            continue
        k = star_of(xy, stars.vertex, stars.twin, stars.at[v], ring, places)
        x, y = xy[v, 0], xy[v, 1]
        old = star_quality(places, k, table, x, y, -1.0)
        if old[0] >= threshold:
            continue
        floor = min(old[0], FAIR)
        bx, by = balanced(places, k, table, x, y)
        found, share = False, 1.0
        nx, ny = x, y
        while not found and share > 0.2:
            nx, ny = x + share * (bx - x), y + share * (by - y)
            found = gains(star_quality(places, k, table, nx, ny, floor), old)
            share *= 0.5
        if not found and old[0] < FAIR:
            m = root_at(table, x, y)
            step = 0.2
            while not found and step > 0.02:
                for ux, uy in SIX_SIDES:
                    dx, dy = unmapped(m, step * ux, step * uy)
                    nx, ny = x + dx, y + dy
                    if gains(star_quality(places, k, table, nx, ny, floor), old):
                        found = True
                        break
                step *= 0.5
        if not found:
            continue
        xy[v, 0], xy[v, 1] = nx, ny
        moves += 1
        again[v] = True
        for i in range(k):
            again[start_of(stars.vertex, ring[i])] = True
    return moves


@lean
def survey_in_metric(xy, vertex, twin, region, count, table, found):
    """Look at all triangles of the domain, and at the metric lengths of their edges.

    ``found`` receives: triangles, the sum and the minimum of the qualities, edges, edges between sqrt(1/2)
    and sqrt(2), the shortest and the longest.
    """
    cells = total = edges = close = longest = 0.0
    worst, shortest = 1.0, np.inf
    for t in range(count):
        if region[t] < 0:
            continue
        q = quality_of(xy, table, vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2])
        cells, total, worst = cells + 1.0, total + q, min(worst, q)
        for e in range(3 * t, 3 * t + 3):
            o = twin[e]
            if o > e or region[o // 3] < 0:
                a, b = start_of(vertex, e), end_of(vertex, e)
                dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
                m = root_at(table, xy[a, 0] + 0.5 * dx, xy[a, 1] + 0.5 * dy)
                square = square_of(m, dx, dy)
                edges += 1.0
                if 0.5 <= square <= 2.0:
                    close += 1.0
                shortest, longest = min(shortest, square), max(longest, square)
    found[0], found[1], found[2], found[3], found[4] = cells, total, worst, edges, close
    found[5], found[6] = sqrt(shortest) if cells > 0.0 else 0.0, sqrt(longest)


@lean
def find_long(xy, vertex, region, count, table, bound, long):
    """Set ``long[t]`` for the triangles of the domain with an edge above this metric length."""
    for t in range(count):
        for e in range(3 * t, 3 * t + 3):
            if region[t] >= 0:
                a, b = start_of(vertex, e), end_of(vertex, e)
                dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
                m = root_at(table, xy[a, 0] + 0.5 * dx, xy[a, 1] + 0.5 * dy)
                long[t] = long[t] or square_of(m, dx, dy) > bound * bound
