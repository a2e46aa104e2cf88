"""Local improvement of a planar triangulation, compiled: smart Laplace steps, pattern search, and a survey.

The arrays are those of `PlanarComplex` and of `Stars`. ``still[v]`` says that vertex v must not move: it lies
on a constrained edge, is a given point, or is outside. ``todo[v]`` says that v is to be looked at, so that
the cost depends on the number of poor triangles and not on the number of all. ``moved[v]`` says that v has
been moved. Book: 2.6c.
"""

from __future__ import annotations

from ...base.jit import lean
from ...connect.insertion.halfedges import start_of
from ...connect.planar.stars import (
    FAIRNESS,
    ROUNDNESS,
    better,
    floor_for,
    measures,
    search,
    star_measures,
    star_of,
    swap_around,
    touched,
)

BY_MEANS, FAIRER, ROUNDER = range(3)  # ways: Laplace steps; a pattern search as well; the same by 2 r / R
OVER = 0.2  # a step goes beyond the mean by this share of its length: three rounds then do the work of five


@lean
def improve(stars, todo, moved, threshold, way, start, stop, rounds):
    """Look at the vertices ``start <= v < stop`` on the list ``todo``, and move those that gain by it.

    A vertex is moved to the mean of its neighbors, and a little farther, if its star is `better` there (a
    *smart* Laplace step). Otherwise, unless the ``way`` is `BY_MEANS`, it is moved to the best place that a
    pattern search finds. A star whose triangles all have at least the quality ``threshold`` (fairness, or
    2 r / R if the way is `ROUNDER`) is left alone. The vertex that was moved and those around it are put on
    the list again. In a pattern search diagonals are swapped at once; otherwise the caller does this with
    `legalize_moved`, as of 10^5 Laplace steps in a good mesh only about a hundred need it. This is repeated
    until nothing moves, for at most ``rounds`` rounds. Returns the number of moves. ``counts``: moves, swaps.
    """
    xy, places, ring = stars.xy, stars.places, stars.ring
    judge, patterns = ROUNDNESS if way == ROUNDER else FAIRNESS, way != BY_MEANS
    moves = 0
    for _ in range(rounds):
        before = moves
        for v in range(start, stop):
            if not todo[v] or stars.still[v]:
                continue
            todo[v] = False
            k = star_of(xy, stars.vertex, stars.twin, stars.at[v], ring, places)
            x0, y0 = xy[v, 0], xy[v, 1]
            old = star_measures(places, k, x0, y0, -1.0, judge)
            if old[0] >= threshold:
                continue
            sx = sy = 0.0
            for i in range(k):
                sx, sy = sx + places[i, 0], sy + places[i, 1]
            x, y = sx / k + OVER * (sx / k - x0), sy / k + OVER * (sy / k - y0)
            new = star_measures(places, k, x, y, floor_for(old[0], judge), judge)
            if not better(new, old, judge):
                x, y = x0, y0
                if patterns:
                    x, y = search(places, k, x, y, old, judge)
                if x == x0 and y == y0:
                    continue
            xy[v, 0], xy[v, 1] = x, y
            moves += 1
            todo[v] = moved[v] = True
            for i in range(k):
                todo[start_of(stars.vertex, ring[i])] = True
            if patterns:
                stars.counts[1] += swap_around(stars, k)
        if moves == before:
            break
    stars.counts[0] += moves
    return moves


@lean
def look_for(xy, vertex, region, count, threshold, among, todo):
    """Put the corners of triangles with 2 r / R below the threshold on the list ``todo``.

    Only triangles that have at least one corner ``among`` these vertices are looked at.
    """
    for t in range(count):
        if region[t] >= 0 and touched(vertex, t, among):
            a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
            quality, _ = measures(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])
            if quality < threshold:
                todo[a] = todo[b] = todo[c] = True


@lean
def changed(before, vertex, moved):
    """Note as moved the corners that triangles had ``before``, where one of them is another one now."""
    for t in range(len(before) // 3):
        e = 3 * t
        if before[e] != vertex[e] or before[e + 1] != vertex[e + 1] or before[e + 2] != vertex[e + 2]:
            moved[before[e]] = moved[before[e + 1]] = moved[before[e + 2]] = True


@lean
def survey(xy, vertex, region, count, threshold, todo, found):
    """Look at all triangles, and put the corners of those with 2 r / R below the threshold on the list.

    ``found`` receives the number of triangles, the sum and the minimum of 2 r / R, the squared sine of the
    minimum angle, and the number of triangles below the threshold.
    """
    total = poor = cells = 0.0
    smallest = sine = 1.0
    for t in range(count):
        if region[t] >= 0:
            a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
            q, s = measures(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])
            cells += 1.0
            total += q
            smallest, sine = min(smallest, q), min(sine, s)
            if q < threshold:
                todo[a] = todo[b] = todo[c] = True
                poor += 1.0
    found[0], found[1], found[2], found[3], found[4] = cells, total, smallest, sine, poor
