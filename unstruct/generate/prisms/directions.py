"""The directions of rays: quasinormals in the chapter's three stages, and those that are most normal.

At a vertex of a wall stand triangles with unit normals n_i. A direction v *sees* them if n_i . v > 0 for all,
and only then cells of small height over them can all be positive. The sum of the normals, weighted or not,
need not see all. The direction for which the least n_i . v is greatest does so whenever there is any that
does: it is the center of the smallest cap of the sphere that has all normals in it, and two or three of them
determine it. It is found as the smallest ball of points is (E. Welzl, *Smallest enclosing disks (balls and
ellipsoids)*, 1991), one normal after the other. Rays that have to stay in a plane take the normals projected
to it; those in two planes follow the line that these have in common.

All this is rounded. That a direction, as it is stored, sees the triangles is then decided exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import angle_of, cosine
from ...base.jit import inline, kernel
from ...predicates.batch import power_of_two
from .records import Walls
from .stars import Stars, stars_of, unit_normals
from .visibility import visible

__all__ = ["NORMALS", "directed", "most_normal", "smoothed", "staged", "weighted"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NORMALS = ("visible", "staged", "angle", "area")
CAP_SLACK = 1e-13  # a normal may lie so far outside of a cap that it does not determine
NO_WEIGHT, ANGLE_WEIGHT, AREA_WEIGHT = range(3)
SEEN_WELL = 0.5  # smoothing need not keep a least cosine above this
MOST_LOST = 0.9  # ... nor below it more than this share of the best one


# ---------------------------------------------------------------------- vectors


@inline
def _normalized(v, out):
    """Write v over its length to ``out``; whether it has one."""
    most = max(abs(v[0]), abs(v[1]), abs(v[2]))
    if not most > 0.0:
        out[0] = out[1] = out[2] = 0.0
        return False
    x, y, z = v[0] / most, v[1] / most, v[2] / most
    length = math.sqrt(x * x + y * y + z * z)
    out[0], out[1], out[2] = x / length, y / length, z / length
    return True


@inline
def _product(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inline
def _confined(v, planes, normals):
    """Project v into the planes of its ray, in place; twice, so that what is left of a normal is rounding."""
    if planes[1] >= 0:
        m, n = normals[planes[0]], normals[planes[1]]
        x, y, z = m[1] * n[2] - m[2] * n[1], m[2] * n[0] - m[0] * n[2], m[0] * n[1] - m[1] * n[0]
        share = (x * v[0] + y * v[1] + z * v[2]) / (x * x + y * y + z * z)
        v[0], v[1], v[2] = share * x, share * y, share * z
    elif planes[0] >= 0:
        m = normals[planes[0]]
        for _ in range(2):
            off = m[0] * v[0] + m[1] * v[1] + m[2] * v[2]
            for k in range(3):
                v[k] -= off * m[k]


# ---------------------------------------------------------------------- weighted sums


@inline
def _angle_at(walls, double_area, t, k):
    """The angle of a triangle at one of its corners."""
    p = walls.points[walls.triangles[t, k]]
    a = walls.points[walls.triangles[t, (k + 1) % 3]]
    b = walls.points[walls.triangles[t, (k + 2) % 3]]
    along = (a[0] - p[0]) * (b[0] - p[0]) + (a[1] - p[1]) * (b[1] - p[1])
    along += (a[2] - p[2]) * (b[2] - p[2])
    return angle_of(double_area[t], along)


@kernel
def _sums(walls, stars, normals, double_area, how, out):
    """Write the sums of the normals around each vertex, by angle, by area or plain, in the planes of rays."""
    for v in range(len(out)):
        out[v, 0] = out[v, 1] = out[v, 2] = 0.0
        for i in range(stars.start[v], stars.start[v + 1]):
            t, k = stars.around[i] // 3, stars.around[i] % 3
            weight = 1.0
            if how == AREA_WEIGHT:
                weight = double_area[t]
            elif how == ANGLE_WEIGHT:
                weight = _angle_at(walls, double_area, t, k)
            for j in range(3):
                out[v, j] += weight * normals[t, j]
        _confined(out[v], walls.planes[v], walls.normals)
        _normalized(out[v], out[v])


def weighted(walls: Walls, how: str, stars: Stars | None = None) -> Array:
    """Unit vectors along the sums of the normals at vertices, weighted by "angle" or "area": (n, 3)."""
    stars = stars_of(walls.triangles, len(walls.points)) if stars is None else stars
    out = np.empty((len(walls.points), 3))
    _sums(walls, stars, *unit_normals(walls.points, walls.triangles), 1 + (how == "area"), out)
    return out


@kernel
def _ridges(walls, stars, normals, double_area, cosine, out):
    """At vertices of exactly two geometric edges, write the mean of the normals of both sides.

    That of a side is weighted by angles, so that it does not depend on how a flat side is triangulated.
    """
    side = np.empty((2, 3))
    for v in range(len(out)):
        count, part = 0, 0
        first, last = stars.start[v], stars.start[v + 1]
        closed = stars.mates[3 * (stars.around[first] // 3) + (stars.around[first] % 3 + 2) % 3] >= 0
        for i in range(first, last):
            t, k = stars.around[i] // 3, stars.around[i] % 3
            mate = stars.mates[3 * t + (k + 2) % 3]
            count += mate >= 0 and _product(normals[t], normals[mate // 3]) < cosine
        if not closed or count != 2:
            continue
        side[:] = 0.0
        for i in range(first, last):
            t, k = stars.around[i] // 3, stars.around[i] % 3
            mate = stars.mates[3 * t + (k + 2) % 3]
            if _product(normals[t], normals[mate // 3]) < cosine:
                part = 1 - part
            weight = _angle_at(walls, double_area, t, k)
            for j in range(3):
                side[part, j] += weight * normals[t, j]
        if _normalized(side[0], side[0]) and _normalized(side[1], side[1]):
            for j in range(3):
                side[0, j] += side[1, j]
            _normalized(side[0], out[v])


def staged(walls: Walls, ridge: float, stars: Stars | None = None) -> Array:
    """Directions in three stages: weighted by angles, but on geometric edges the mean of the two sides.

    Parameters
    ----------
    walls : Walls
    ridge : float
        The angle between two normals, in degrees, from which on their edge is a geometric one.
    """
    from_cosine = float(cosine(math.radians(ridge)))
    stars = stars_of(walls.triangles, len(walls.points)) if stars is None else stars
    out = weighted(walls, "angle", stars)
    _ridges(walls, stars, *unit_normals(walls.points, walls.triangles), from_cosine, out)
    return out


# ---------------------------------------------------------------------- most normal


@inline
def _of_two(a, b, v):
    """Write the direction in which two vectors have equal shares, and the greatest."""
    square, along = 0.0, 0.0
    for k in range(3):
        square += (b[k] - a[k]) * (b[k] - a[k])
        along += (b[k] - a[k]) * a[k]
    t = -along / square if square > 0.0 else 0.0
    for k in range(3):
        v[k] = a[k] + t * (b[k] - a[k])
    return _normalized(v, v)


@inline
def _of_three(a, b, c, v):
    """The same for three: the normal of the plane through their tips."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    wx, wy, wz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    v[0], v[1], v[2] = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
    if _product(v, a) < 0.0:
        v[0], v[1], v[2] = -v[0], -v[1], -v[2]
    return _normalized(v, v)


@inline
def _least(rows, count, v):
    least = math.inf
    for i in range(count):
        least = min(least, _product(rows[i], v))
    return least


@kernel
def _center(rows, count, v):
    """Write the direction whose least share in the rows is greatest; return that share."""
    trial = np.empty(3)
    if not _normalized(rows[0], v):
        return 0.0
    least = _product(rows[0], v)  # of the rows that determine the direction
    for i in range(1, count):
        if _product(rows[i], v) >= least - CAP_SLACK:
            continue
        if not _normalized(rows[i], v):
            return 0.0
        least = _product(rows[i], v)
        for j in range(i):
            if _product(rows[j], v) >= least - CAP_SLACK:
                continue
            if not _of_two(rows[i], rows[j], v):
                return 0.0
            least = _product(rows[i], v)
            for m in range(j):
                if _product(rows[m], v) < least - CAP_SLACK and _of_three(rows[i], rows[j], rows[m], trial):
                    v[0], v[1], v[2] = trial[0], trial[1], trial[2]
                    least = _product(rows[i], v)
    return _least(rows, count, v)


@kernel
def _most_normal(walls, stars, normals, directions, least):
    """Improve the directions to the most normal ones; write the least cosines."""
    most = 1
    for v in range(len(directions)):
        most = max(most, stars.start[v + 1] - stars.start[v])
    rows, best = np.empty((most, 3)), np.empty(3)
    for v in range(len(directions)):
        first, count = stars.start[v], stars.start[v + 1] - stars.start[v]
        step = 1 if count < 8 else (count * 5) // 8  # mixed, so that not all in order are new
        while _gcd(step, count) != 1:
            step += 1
        for i in range(count):
            n = normals[stars.around[first + (i * step) % count] // 3]
            rows[i, 0], rows[i, 1], rows[i, 2] = n[0], n[1], n[2]
        least[v] = _least(rows, count, directions[v])
        if walls.planes[v, 1] >= 0:
            if least[v] < 0.0:
                for k in range(3):
                    best[k] = -directions[v, k]
                if _least(rows, count, best) > least[v]:
                    directions[v, 0], directions[v, 1], directions[v, 2] = best[0], best[1], best[2]
                    least[v] = _least(rows, count, best)
            continue
        for i in range(count):
            _confined(rows[i], walls.planes[v], walls.normals)
        _center(rows, count, best)
        _confined(best, walls.planes[v], walls.normals)
        found = _least(rows, count, best) if _normalized(best, best) else -1.0
        if found > _least(rows, count, directions[v]):
            directions[v, 0], directions[v, 1], directions[v, 2] = best[0], best[1], best[2]
            least[v] = found


@inline
def _gcd(a, b):
    while b:
        a, b = b, a % b
    return a


def most_normal(walls: Walls, stars: Stars | None = None) -> tuple[Array, Array]:
    """The directions whose least cosine with the normals at a vertex is greatest, and these cosines."""
    stars = stars_of(walls.triangles, len(walls.points)) if stars is None else stars
    directions, least = weighted(walls, "angle", stars), np.empty(len(walls.points))
    _most_normal(walls, stars, unit_normals(walls.points, walls.triangles)[0], directions, least)
    return directions, least


# ---------------------------------------------------------------------- smoothing


@kernel
def _smooth(walls, stars, normals, floor, directions, moved):
    """One round: each direction moves to the mean of its neighbors', if the least cosine stays above."""
    v_new = np.empty(3)
    for v in range(len(directions)):
        v_new[0] = v_new[1] = v_new[2] = 0.0
        for i in range(stars.start[v], stars.start[v + 1]):
            t, k = stars.around[i] // 3, stars.around[i] % 3
            for c in range(1, 3):
                d = directions[walls.triangles[t, (k + c) % 3]]
                v_new[0] += d[0]
                v_new[1] += d[1]
                v_new[2] += d[2]
        share = 1.0
        _confined(v_new, walls.planes[v], walls.normals)
        good = _normalized(v_new, v_new)
        moved[v] = directions[v]
        for _ in range(3):  # the whole way, half of it, a quarter
            if not good:
                break
            for j in range(3):
                moved[v, j] = directions[v, j] + share * (v_new[j] - directions[v, j])
            if _normalized(moved[v], moved[v]):
                least = math.inf
                for i in range(stars.start[v], stars.start[v + 1]):
                    least = min(least, _product(normals[stars.around[i] // 3], moved[v]))
                if least >= floor[v]:
                    break
            share *= 0.5
            moved[v] = directions[v]


def smoothed(walls: Walls, directions: Array, rounds: int, stars: Stars | None = None) -> Array:
    """Directions smoothed along the wall; each keeps its triangles in sight.

    The least cosine of each stays above half, or above nine tenths of what it was.
    """
    stars = stars_of(walls.triangles, len(walls.points)) if stars is None else stars
    normals, _ = unit_normals(walls.points, walls.triangles)
    least = np.empty(len(directions))
    _cosines(stars, normals, directions, least)
    floor = np.minimum(MOST_LOST * least, SEEN_WELL)
    floor[least <= 0.0] = np.inf
    one, two = directions.copy(), np.empty_like(directions)
    for _ in range(rounds):
        _smooth(walls, stars, normals, floor, one, two)
        one, two = two, one
    return one


@kernel
def _cosines(stars, normals, directions, least):
    for v in range(len(directions)):
        least[v] = math.inf
        for i in range(stars.start[v], stars.start[v + 1]):
            least[v] = min(least[v], _product(normals[stars.around[i] // 3], directions[v]))


def directed(walls: Walls, how: str, ridge: float, rounds: int, stars: Stars) -> tuple[Array, Flags]:
    """The directions of rays, one at each vertex, and whether they see their triangles, exactly.

    Where another rule, or smoothing, sees less than the most normal direction and not all, that one is taken.
    Where none is found that sees all, the direction is of no use.
    """
    walls = walls._replace(points=walls.points * power_of_two(walls.points))
    best, _ = most_normal(walls, stars)
    found = best
    if how == "staged":
        found = staged(walls, ridge, stars)
    elif how in ("angle", "area"):
        found = weighted(walls, how, stars)
    found = np.where(visible(walls, found)[:, None], found, best)
    if rounds:
        found = smoothed(walls, found, rounds, stars)
    seen = visible(walls, found)
    if not seen.all():
        found = np.where(seen[:, None], found, best)
        seen = visible(walls, found)
    return found, seen
