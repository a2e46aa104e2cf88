"""Local improvement of a planar triangulation, compiled: smart Laplace steps and pattern search, with swaps.

The arrays are those of `PlanarComplex` and `smoothing2`: ``at[v]`` is a half-edge opposite vertex v.
``still[v]`` tells which vertices may not move: those on constrained edges, given points, and all outside.
``todo[v]`` tells which are to be looked at, so that the cost follows the number of poor triangles and not
that of all. A move is made only if every triangle of the star stays positively oriented, by exact signs, and
if the worst of them gets better; diagonals are swapped at once where the move asks for it, so that a
constrained Delaunay triangulation remains one.

Quality is 2 r / R (r inradius, R circumradius), 1 for the equilateral triangle; moves are judged by a cheaper
measure, `fairness`. Beside it the sine of the least angle is watched, which may not fall while it is below
that of 30 degrees: a triangle may become rounder and have a smaller least angle. Book: 2.6c.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ..jit import inline, lean
from ..predicates import orient2
from .cavity2 import end_of, start_of
from .insertion2 import next_edge
from .smoothing2 import legalize, turned

TWICE_ROOT3 = 2.0 * sqrt(3.0)
EASY = 0.77
SAFE = 0.25  # the squared sine of 30 degrees: a least angle beyond it may become smaller
OVER = 0.2  # steps go that much farther than to the mean: three rounds then do what five do
GIVE = 1e-6  # the least gain for which a vertex is moved
FAIR = 0.85  # a triangle beyond it may become less fair if the others of its star gain more


@inline
def measures(ax, ay, bx, by, cx, cy):
    """2 r / R of a counterclockwise triangle, and the squared sine of its least angle."""
    ux, uy, vx, vy, wx, wy = bx - ax, by - ay, cx - bx, cy - by, ax - cx, ay - cy
    double = ux * (cy - ay) - uy * (cx - ax)
    u, v, w = ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy
    if double <= 0.0 or u == 0.0 or v == 0.0 or w == 0.0:
        return 0.0, 0.0
    a, b, c = sqrt(u), sqrt(v), sqrt(w)
    square = double * double
    # the sine opposite the shortest side is twice the area by the product of the other two
    return 4.0 * square / ((a + b + c) * a * b * c), square * min(u, v, w) / (u * v * w)


@inline
def fairness(ax, ay, bx, by, cx, cy):
    """4 sqrt(3) area / (a^2 + b^2 + c^2), 1 for the equilateral triangle; the squared sine where it matters.

    Near 1 it falls as 2 r / R does, and takes no roots. Beyond `EASY` every angle is above 30 degrees (the
    extreme triangle has angles of 30, 75 and 75), and 1 is returned for the sine.
    """
    ux, uy, vx, vy, wx, wy = bx - ax, by - ay, cx - bx, cy - by, ax - cx, ay - cy
    double = ux * (cy - ay) - uy * (cx - ax)
    u, v, w = ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy
    if double <= 0.0 or u == 0.0 or v == 0.0 or w == 0.0:
        return 0.0, 0.0
    fair = TWICE_ROOT3 * double / (u + v + w)
    return fair, 1.0 if fair > EASY else double * double * min(u, v, w) / (u * v * w)


@lean
def star_measures(xy, vertex, twin, e, x, y):
    """The least fairness and squared sine and the sum of fairness in the star of ``vertex[e]`` put at (x, y).

    -1 where a triangle would not be positively oriented, by exact signs.
    """
    first = e
    least, sine, total = 2.0, 2.0, 0.0
    while True:
        a, b = start_of(vertex, e), end_of(vertex, e)
        ax, ay, bx, by = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1]
        if orient2(ax, ay, bx, by, x, y) <= 0:
            return -1.0, -1.0, -1.0
        q, s = fairness(ax, ay, bx, by, x, y)
        least, sine, total = min(least, q), min(sine, s), total + q
        e = turned(twin, e)
        if e == first:
            return least, sine, total


@inline
def better(q, s, u, least, sine, total):
    """Whether a star with these measures is to be preferred to one of ``least``, ``sine``, ``total``.

    Where the worst triangle is poor, it must become better; where all are fair, their sum.
    """
    if s < sine and s < SAFE:
        return False
    if least < FAIR:
        return q > least + GIVE
    return q >= FAIR and u > total + GIVE


@lean
def swap_around(xy, vertex, twin, mark, where, at, v, stack):
    """Swap the diagonals that a move of vertex v asks for; how many."""
    first = e = np.int64(at[v])
    depth = 0
    while True:
        stack[depth], stack[depth + 1] = e, next_edge(e)
        depth += 2
        e = turned(twin, e)
        if e == first:
            return legalize(xy, vertex, twin, mark, where, at, stack, depth)


@inline
def middle_of_neighbors(xy, vertex, twin, e):
    """The mean of the neighbors of ``vertex[e]``."""
    first = e
    x = y = 0.0
    count = 0
    while True:
        a = start_of(vertex, e)
        x += xy[a, 0]
        y += xy[a, 1]
        count += 1
        e = turned(twin, e)
        if e == first:
            return x / count, y / count


@inline
def search(xy, vertex, twin, e, least, sine, total):
    """A better place for ``vertex[e]`` by pattern search: eight directions, steps that are halved."""
    v = vertex[e]
    x, y = xy[v, 0], xy[v, 1]
    a = start_of(vertex, e)
    step = 0.25 * sqrt((xy[a, 0] - x) ** 2 + (xy[a, 1] - y) ** 2)
    smallest = step / 64.0
    while step > smallest:
        found = False
        for k in range(8):
            dx, dy = (1.0, 0.0) if k % 4 == 0 else ((0.0, 1.0) if k % 4 == 2 else (0.707, 0.707))
            if k % 4 == 3:
                dx = -dx
            if k >= 4:
                dx, dy = -dx, -dy
            q, s, u = star_measures(xy, vertex, twin, e, x + step * dx, y + step * dy)
            if better(q, s, u, least, sine, total):
                x, y, least, sine, total, found = x + step * dx, y + step * dy, q, s, u, True
                break
        if not found:
            step /= 2.0
    return x, y


@inline
def mark_star(vertex, twin, e, todo):
    """Put ``vertex[e]`` and its neighbors on the list of those to be looked at next."""
    todo[vertex[e]] = True
    first = e
    while True:
        todo[start_of(vertex, e)] = True
        e = turned(twin, e)
        if e == first:
            return


@lean
def improve(xy, vertex, twin, mark, where, at, still, todo, threshold, patterns, start, stop, stack, counts):
    """Look at the vertices ``start <= v < stop`` that are to be looked at, and move those that gain.

    Each goes to the mean of its neighbors, and a little farther, if its star is `better` then (a *smart*
    Laplace step), or else, with ``patterns``, to the best place that a pattern search finds. A star whose
    triangles are all beyond ``threshold`` is left alone. Vertices around a move are looked at again.
    ``counts``: moves, swaps.
    """
    moves = 0
    for v in range(start, stop):
        if still[v] or not todo[v]:
            continue
        todo[v] = False
        e = np.int64(at[v])
        least, sine, total = star_measures(xy, vertex, twin, e, xy[v, 0], xy[v, 1])
        if least >= threshold:
            continue
        x, y = middle_of_neighbors(xy, vertex, twin, e)
        x += OVER * (x - xy[v, 0])
        y += OVER * (y - xy[v, 1])
        q, s, u = star_measures(xy, vertex, twin, e, x, y)
        if not better(q, s, u, least, sine, total):
            x, y = xy[v, 0], xy[v, 1]
            if patterns:
                x, y = search(xy, vertex, twin, e, least, sine, total)
            if x == xy[v, 0] and y == xy[v, 1]:
                todo[v] = least < FAIR and not patterns  # for the search to come
                continue
        xy[v, 0], xy[v, 1] = x, y
        moves += 1
        counts[1] += swap_around(xy, vertex, twin, mark, where, at, v, stack)
        mark_star(vertex, twin, np.int64(at[v]), todo)
    counts[0] += moves
    return moves


@lean
def survey(xy, vertex, region, count, threshold, todo, found):
    """Look at all triangles, and put the corners of those with 2 r / R below the threshold on the list.

    ``found`` gets the number of triangles, the sum and the least of 2 r / R, the least squared sine of an
    angle, and how many are below the threshold.
    """
    total = poor = cells = 0.0
    least = sine = 1.0
    for t in range(count):
        if region[t] >= 0:
            a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
            q, s = measures(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])
            cells += 1.0
            total += q
            least, sine = min(least, q), min(sine, s)
            if q < threshold:
                todo[a] = todo[b] = todo[c] = True
                poor += 1.0
    found[0], found[1], found[2], found[3], found[4] = cells, total, least, sine, poor


@lean
def fill_at(vertex, region, count, at):
    """For each vertex of the domain a half-edge opposite to it."""
    for t in range(count):
        if region[t] >= 0:
            for e in range(3 * t, 3 * t + 3):
                at[vertex[e]] = e
