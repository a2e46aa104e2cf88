"""Directions of prismatic layers told plainly: the three stages, the most normal one, and visibility.

Unit vectors are rounded; whether a direction sees the triangles is decided with fractions. Book: 5.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from math import acos, cos, pi, radians

from unstruct.plain.prisms import (
    Points,
    Triangle,
    Vector,
    cross,
    exact,
    minus,
    normal_of,
    scalar,
    summed,
    unit,
)

__all__ = ["most_normal", "sees", "staged_normals"]


def staged_normals(points: Points, triangles: Sequence[Triangle], ridge: float) -> list[Vector]:
    """Unit directions: on an edge of the shape the mean of its two sides, elsewhere weighted by angles.

    An edge of the shape is one whose triangles' normals differ by more than `ridge` degrees. Where two meet
    at a vertex (an edge runs through), they divide its triangles into two sides.
    """
    normals = [unit(normal_of(points, t)) for t in triangles]
    found = []
    for v in range(len(points)):
        around = [i for i, t in enumerate(triangles) if v in t]
        smooth = [pair for pair in combinations(around, 2) if _share_edge(triangles, *pair)]
        sharp = [p for p in smooth if scalar(normals[p[0]], normals[p[1]]) < cos(radians(ridge))]
        sides = _grouped(around, [pair for pair in smooth if pair not in sharp])
        by_angle = [_weighted(points, triangles, normals, v, side) for side in sides]
        if len(sharp) == 2 and len(sides) == 2:
            found.append(unit(summed(unit(side) for side in by_angle)))
        else:
            found.append(unit(summed(by_angle)))
    return found


def _share_edge(triangles: Sequence[Triangle], i: int, j: int) -> bool:
    return len(set(triangles[i]) & set(triangles[j])) == 2


def _grouped(rows: Sequence[int], pairs: Sequence[tuple[int, int]]) -> list[set[int]]:
    groups = [{i} for i in rows]
    for i, j in pairs:
        one, other = (next(g for g in groups if k in g) for k in (i, j))
        if one is not other:
            groups.remove(other)
            one |= other
    return groups


def _weighted(
    points: Points, triangles: Sequence[Triangle], normals: Points, v: int, rows: Iterable[int]
) -> Vector:
    """The sum of normals, each times the angle of its triangle at v."""
    total = []
    for i in sorted(rows):
        a, b = (unit(minus(points[w], points[v])) for w in triangles[i] if w != v)
        angle = acos(max(-1.0, min(1.0, scalar(a, b)))) / pi
        total.append((angle * normals[i][0], angle * normals[i][1], angle * normals[i][2]))
    return summed(total)


def most_normal(normals: Sequence[Vector]) -> Vector | None:
    """The unit direction whose largest angle with unit normals is least; None if no direction sees them all.

    It is the center of the smallest cap: two or three normals, at the same angle from it, decide.
    """
    best, least = None, 0.0
    for size in (1, 2, 3):
        for some in combinations(normals, size):
            center = _middle(some)
            if center is not None and min(scalar(center, n) for n in normals) > least + 1e-12:
                best, least = center, min(scalar(center, n) for n in normals)
    return best


def _middle(some: Sequence[Vector]) -> Vector | None:
    """The direction that has the same angle, less than 90 degrees, with one, two or three unit vectors."""
    if len(some) < 3:
        total = summed(some)
    else:
        a, b, c = some
        total = cross(minus(b, a), minus(c, a))
        if scalar(total, a) < 0:
            total = minus((0, 0, 0), total)
    return unit(total) if scalar(total, total) > 1e-24 else None


def sees(points: Points, triangles: Iterable[Triangle], v: int, direction: Vector) -> bool:
    """Whether a direction is on the positive side of all triangles at a vertex: exact for fractions."""
    rows = [t for t in triangles if v in t]
    corners = [exact(p) for p in points]
    return all(scalar(normal_of(corners, t), exact(direction)) > 0 for t in rows)
