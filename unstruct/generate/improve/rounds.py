"""Rounds of smoothing, compiled: each vertex is moved to a mean, or to a place where its star is better.

The arrays are those of `Stars`. Every move is judged by exact signs: if a triangle around the vertex would
not be counterclockwise, the vertex stays where it is.

Sources: D. A. Field, Laplacian smoothing and Delaunay triangulations (1988); L. Chen and M. Holst, Efficient
mesh optimization schemes based on optimal Delaunay triangulations (2011). Book: 2.6c, 2.6d.
"""

from __future__ import annotations

from ...base.jit import lean
from ...connect.planar.stars import ROUNDNESS, search, star_measures, star_of, swap_around

# Where a vertex is moved: to the mean of its neighbors, of the circumcenters or of the centroids of its
# triangles, or to the place where a pattern search ends.
LAPLACE, OPTIMAL, CENTROID, SEARCH = 0, 1, 2, 3
MOVED, INVALID, WORSE, FLIPS, LOOKED = 0, 1, 2, 3, 4  # places in the counts


@lean
def target(places, k, x0, y0, method):
    """The place of a vertex by the method; computed relative to it, so that no digits are lost far from 0."""
    sx, sy, weight = 0.0, 0.0, 0.0
    for i in range(k):
        ax, ay, bx, by = places[i, 0] - x0, places[i, 1] - y0, places[i + 1, 0] - x0, places[i + 1, 1] - y0
        if method == LAPLACE:
            sx, sy, weight = sx + ax, sy + ay, weight + 1.0
            continue
        area2 = ax * by - ay * bx
        if area2 <= 0.0:
            continue
        if method == OPTIMAL:  # the area cancels in the product of area and circumcenter
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
def smooth_round(stars, method, smart, swap, threshold, start, stop):
    """Move each vertex ``start <= v < stop`` that has a triangle with 2 r / R below the threshold, in turn.

    With ``smart`` a vertex is moved only if the minimum 2 r / R around it grows, as it always does in a
    search. Vertices that are ``still`` stay. With ``swap`` diagonals are swapped after each move. What
    happened is added to ``stars.counts``.
    """
    xy, places, counts = stars.xy, stars.places, stars.counts
    for v in range(start, stop):
        if stars.still[v]:
            continue
        k = star_of(xy, stars.vertex, stars.twin, stars.at[v], stars.ring, places)
        x0, y0 = xy[v, 0], xy[v, 1]
        old = star_measures(places, k, x0, y0, -1.0, ROUNDNESS)
        if old[0] >= threshold:
            continue
        counts[LOOKED] += 1
        if method == SEARCH:
            x, y = search(places, k, x0, y0, old, ROUNDNESS)
            counts[WORSE] += int(x == x0 and y == y0)
        else:
            x, y = target(places, k, x0, y0, method)
            new = star_measures(places, k, x, y, -1.0, ROUNDNESS)
            if new[0] < 0.0 or (smart and new[0] <= old[0]):
                counts[INVALID if new[0] < 0.0 else WORSE] += 1
                continue
        if x != x0 or y != y0:
            xy[v, 0], xy[v, 1] = x, y
            counts[MOVED] += 1
            if swap:
                counts[FLIPS] += swap_around(stars, k)
