"""When an opposing front is near: by the nearest point, or by the forces of springs (12.3.3).

S. Pirzadeh (AIAA Journal 34 (1996) 43-49) imagines springs from the ends of a front edge to the candidates
for its next point. The candidate with the least force is taken. If that is a point that exists, another
front is near, and the edge stops.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel

__all__ = ["is_ahead", "meet", "nearest_stops", "spring_force", "spring_stops"]

Array = NDArray[np.float64]
NEAR_STEPS = 2.0  # by the nearest point: so many steps and ...
NEAR_SPACINGS = 1.0  # ... so many spacings away an opposing point is near
PLAINLY = 1.0 + 1e-9  # far beyond rounding
AHEAD = 0.1  # the sine of the angle above a wall from which on a place is ahead


@inline
def _force(x, a, b, rest):
    return abs(math.hypot(x[0] - a[0], x[1] - a[1]) - rest) + abs(math.hypot(x[0] - b[0], x[1] - b[1]) - rest)


@inline
def _by_springs(a, b, new_a, new_b, x):
    """`spring_stops` for one edge."""
    rest = math.hypot(b[0] - a[0], b[1] - a[1])
    if max(math.hypot(x[0] - a[0], x[1] - a[1]), math.hypot(x[0] - b[0], x[1] - b[1])) <= rest:
        return True
    return _force(x, a, b, rest) < min(_force(new_a, a, b, rest), _force(new_b, a, b, rest))


@inline
def _by_distance(new, step, apart, x):
    """`nearest_stops` for one point. Most are told without a root."""
    u, v, reach = abs(x[0] - new[0]), abs(x[1] - new[1]), NEAR_STEPS * step + NEAR_SPACINGS * apart
    if max(u, v) > PLAINLY * reach:
        return False
    return math.hypot(u, v) < reach


@inline
def is_ahead(x, y, direction, r):
    """Whether a place (x, y) away is more ahead of ray r than beside it. Most are told without a root."""
    ahead = x * direction[r, 0] + y * direction[r, 1]
    if not ahead > 0.0 or ahead > PLAINLY * AHEAD * (abs(x) + abs(y)):
        return ahead > 0.0
    return ahead > AHEAD * math.hypot(x, y)


def spring_force(x: Array, a: Array, b: Array, rest: Array) -> Array:
    """The sum of the forces, of stretched and of compressed springs, from points x to a and b.

    Each force is the difference of the spring's length and its rest length, for springs of unit stiffness.
    """
    return np.abs(np.hypot(*(x - a).T) - rest) + np.abs(np.hypot(*(x - b).T) - rest)


def spring_stops(edge: tuple[Array, Array], new: tuple[Array, Array], existing: Array) -> NDArray[np.bool_]:
    """Whether an existing point takes less force than both new points of an edge.

    Parameters
    ----------
    edge : two arrays, shape (k, 2)
        The ends of front edges.
    new : two arrays, shape (k, 2)
        The points that the rays of both ends make next.
    existing : (k, 2) float64
        A point of another front for each edge.

    Notes
    -----
    The rest length is that of the edge: springs are relaxed at the apex of the equilateral triangle. A new
    point one step d above an end of an edge of length s takes the force sqrt(s^2 + d^2) - d. An existing
    point at the height g above the middle takes less if it is nearer than about 1.4 s, for small d: that is
    the "local cell size" within which fronts are to stop. With a rest length of 0 it would be within
    sqrt(d s / 2), so near that the rest between two fronts could not be filled well.

    The least force alone fails in a gap much narrower than the edge: springs to a point nearer than about
    sqrt(d s / 2) are compressed to half their length and take more force than the new points do. So a point
    that stretches neither spring is near in any case.
    """
    found = np.empty(len(existing), dtype=bool)
    _spring_stops(*edge, *new, existing, found)
    return found


@kernel
def _spring_stops(a, b, new_a, new_b, existing, found):
    for i in range(len(found)):
        found[i] = _by_springs(a[i], b[i], new_a[i], new_b[i], existing[i])


def nearest_stops(new: Array, step: Array, apart: Array, existing: Array) -> NDArray[np.bool_]:
    """Whether an existing point is within two steps and one spacing of a new point."""
    found = np.empty(len(existing), dtype=bool)
    _nearest_stops(new, step, apart, existing, found)
    return found


@kernel
def _nearest_stops(new, step, apart, existing, found):
    for i in range(len(found)):
        found[i] = _by_distance(new[i], step[i], apart[i], existing[i])


@kernel
def meet(tables, rays, pairs, others, spring, level, stopped):
    """Let rays stop, layer by layer, where a point of another front or of the rest is near.

    Parameters
    ----------
    tables : tuple
        ``places``, ``steps`` and ``apart`` of `Fronts`; the last with the distance after a step for fans.
    rays : tuple
        The directions, and the rays before and after each.
    pairs : tuple
        Rays p, and for each a ray q < r, or r + the row of one of ``others``. Both arrays are used up.
    others : (j, 2) float64
    spring : bool
    level : (r,) int64
        The levels so far; lowered.
    stopped : (r,) bool
        Receives which rays have been stopped.
    """
    places, steps, apart = tables
    direction, before, after = rays
    p, q = pairs
    n, live = len(level), len(p)
    stop = np.empty(2 * live, dtype=np.int64)
    k = 0
    while live > 0:
        kept = many = 0
        for i in range(live):
            r, o = p[i], q[i]
            if level[r] <= k:
                continue
            p[kept], q[kept] = r, o
            kept += 1
            x = places[o, min(k, level[o])] if o < n else others[o - n]
            here, new = places[r, k], places[r, k + 1]
            if not is_ahead(x[0] - here[0], x[1] - here[1], direction, r):
                continue
            hit = False
            if spring:
                for j in (before[r], after[r]):
                    if j >= 0 and not hit:
                        there, next_ = places[j, min(k, level[j])], places[j, min(k + 1, level[j])]
                        hit = _by_springs(here, there, new, next_, x)
            else:
                hit = _by_distance(new, steps[r, k], apart[r, k], x)
            if hit:  # both fronts stop
                stop[many] = r
                many += 1
                if o < n and level[o] > k:
                    stop[many] = o
                    many += 1
        for i in range(many):
            level[stop[i]], stopped[stop[i]] = k, True
        live, k = kept, k + 1
