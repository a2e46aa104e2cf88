"""When a surface triangulation is Delaunay, by fractions (section 2.7 of the book).

The chapter's sphere through the corners of a triangle has its center in the triangle's plane; other meanings
use angles, or spheres with their centers on the surface. All vertices and all triangles are looked at.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

__all__ = [
    "circumcenter",
    "empty_interval",
    "extrinsic",
    "inside",
    "intrinsic",
    "is_surface_delaunay",
    "restricted",
]

Point = Sequence[Any]
Points = Sequence[Point]


def minus(p: Point, q: Point) -> list[Fraction]:
    """The vector from q to p."""
    return [Fraction(x) - Fraction(y) for x, y in zip(p, q)]


def dot(u: Point, v: Point) -> Fraction:
    """The scalar product."""
    return sum((x * y for x, y in zip(u, v)), Fraction(0))


def cross(u: Point, v: Point) -> list[Fraction]:
    """The vector product."""
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def circumcenter(a: Point, b: Point, c: Point) -> list[Fraction]:
    """The point of the plane at equal distances from the corners: weights a^2 (b^2 + c^2 - a^2)."""
    sides = [dot(minus(p, q), minus(p, q)) for p, q in ((b, c), (c, a), (a, b))]
    weights = [s * (sum(sides) - 2 * s) for s in sides]
    total = sum(weights, Fraction(0))
    return [dot(weights, [Fraction(x) for x in row]) / total for row in zip(a, b, c)]


def inside(corners: Points, p: Point, center: Point) -> bool:
    """Whether p is strictly inside the sphere around the center through the first corner."""
    return dot(minus(p, center), minus(p, center)) < dot(minus(corners[0], center), minus(corners[0], center))


def is_surface_delaunay(points: Points, triangles: Sequence[Sequence[int]]) -> list[list[int]]:
    """The chapter's criterion: for each triangle the vertices strictly inside its plane-centered sphere."""
    used = sorted({v for row in triangles for v in row})
    found = []
    for row in triangles:
        corners = [points[v] for v in row]
        center = circumcenter(*corners)
        found.append([v for v in used if inside(corners, points[v], center)])
    return found


def edges_of(triangles: Sequence[Sequence[int]]) -> dict[tuple[int, int], list[tuple[int, int]]]:
    """Each edge of two triangles: (triangle, opposite corner) twice."""
    found: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for t, row in enumerate(triangles):
        for k in range(3):
            u, v = sorted((row[k], row[k - 2]))
            found.setdefault((u, v), []).append((t, row[k - 1]))
    return {edge: sides for edge, sides in found.items() if len(sides) == 2}


def intrinsic(points: Points, triangles: Sequence[Sequence[int]]) -> dict[tuple[int, int], bool]:
    """For each edge of two triangles, whether its opposite angles add up to at most pi.

    The cosine of one must be at least that of pi less the other: signed squares of cosines are compared.
    """
    found = {}
    for (u, v), sides in edges_of(triangles).items():
        squares = []
        for _, w in sides:
            left, right = minus(points[u], points[w]), minus(points[v], points[w])
            value = dot(left, right)
            squares.append(value * abs(value) / (dot(left, left) * dot(right, right)))
        found[u, v] = squares[0] >= -squares[1]
    return found


def extrinsic(points: Points, triangles: Sequence[Sequence[int]]) -> dict[tuple[int, int], bool]:
    """For each edge, whether no opposite corner is strictly inside the other triangle's sphere."""
    found = {}
    for edge, ((s, p), (t, q)) in edges_of(triangles).items():
        good = True
        for row, far in ((triangles[s], q), (triangles[t], p)):
            corners = [points[v] for v in row]
            good = good and not inside(corners, points[far], circumcenter(*corners))
        found[edge] = good
    return found


def empty_interval(points: Points, row: Sequence[int], used: Sequence[int]) -> tuple[Any, Any] | None:
    """All s for which the sphere around center + s normal is empty: (low, high), None in it for infinite."""
    corners = [points[v] for v in row]
    center = circumcenter(*corners)
    normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
    square = dot(minus(corners[0], center), minus(corners[0], center))
    low = high = None
    for v in used:
        away = minus(points[v], center)
        room, slope = dot(away, away) - square, 2 * dot(away, normal)  # room - s slope must be >= 0
        if slope == 0 and room < 0:
            return None
        if slope > 0:
            high = room / slope if high is None else min(high, room / slope)
        elif slope < 0:
            low = room / slope if low is None else max(low, room / slope)
    return None if low is not None and high is not None and low > high else (low, high)


def restricted(points: Points, triangles: Sequence[Sequence[int]]) -> list[bool]:
    """For each triangle, whether a sphere through its corners with center on the surface is empty."""
    used, found = sorted({v for row in triangles for v in row}), []
    for row in triangles:
        limits = empty_interval(points, row, used)
        corners = [points[v] for v in row]
        normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
        line = circumcenter(*corners), normal
        others = [[points[v] for v in other] for other in triangles]
        found.append(limits is not None and any(meets(*line, *limits, other) for other in others))
    return found


def meets(start: Point, step: Point, low: Any, high: Any, triangle: Points) -> bool:
    """Whether start + s step is in the closed triangle for some s between the limits."""
    a, b, c = triangle
    normal = cross(minus(b, a), minus(c, a))
    walls = [(cross(normal, minus(q, p)), p) for p, q in ((a, b), (b, c), (c, a))]
    walls += [(normal, a), ([-x for x in normal], a)]  # on the plane: neither below nor above
    for inward, p in walls:
        now, change = dot(inward, minus(start, p)), dot(inward, step)
        if change == 0 and now < 0:
            return False
        if change > 0:
            low = -now / change if low is None else max(low, -now / change)
        elif change < 0:
            high = -now / change if high is None else min(high, -now / change)
    return low is None or high is None or low <= high
