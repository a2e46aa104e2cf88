"""Places, oriented triangles and tetrahedra, for the plain front in space."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from math import sqrt
from typing import Any

__all__ = [
    "Cell", "Face", "Place", "away", "clipped", "determinant3", "distance_to", "exact", "faces_of", "lowest",
    "minus", "smallest_circle",
]  # fmt: skip

Place = tuple[Any, Any, Any]
Face = tuple[int, int, int]
Cell = tuple[int, int, int, int]


def smallest_circle(a: Place, b: Place, c: Place) -> tuple[Place, float]:
    """The center and the radius of the smallest circle around a triangle, by barycentric weights."""
    p, q, r = away(b, c), away(c, a), away(a, b)
    weights = [
        p * p * (q * q + r * r - p * p),
        q * q * (r * r + p * p - q * q),
        r * r * (p * p + q * q - r * r),
    ]
    u, v = minus(b, a), minus(c, a)
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    radius = p * q * r / (2.0 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]))
    whole = weights[0] + weights[1] + weights[2]
    for k, length in enumerate((p, q, r)):
        if weights[k] <= 0.0:
            weights, whole, radius = [0.5] * 3, 1.0, 0.5 * length
            weights[k] = 0.0
            break
    one, two, three = (w / whole for w in weights)
    return tuple(one * x + two * y + three * z for x, y, z in zip(a, b, c)), radius


def faces_of(cell: Cell) -> list[Face]:
    """The faces of a positive cell, seen from within: the cell is ahead of each."""
    a, b, c, d = cell
    return [lowest(*face) for face in ((a, b, c), (b, a, d), (c, b, d), (a, c, d))]


def lowest(a: int, b: int, c: int) -> Face:
    """The same oriented triangle with its lowest vertex first."""
    return min((a, b, c), (b, c, a), (c, a, b))


def clipped(polygon: Sequence[Place], plane: Sequence[Place]) -> list[Place]:
    """The part of a convex polygon, or a segment, that is not behind a plane of three points; exact."""
    heights = [determinant3(*(minus(q, plane[0]) for q in (plane[1], plane[2], p))) for p in polygon]
    result = []
    for i, (p, h) in enumerate(zip(polygon, heights)):
        q, g = polygon[(i + 1) % len(polygon)], heights[(i + 1) % len(polygon)]
        if h >= 0:
            result.append(p)
        if h * g < 0:
            t = h / (h - g)
            result.append(tuple(x + t * (y - x) for x, y in zip(p, q)))
    return result


def determinant3(u: Place, v: Place, w: Place) -> Any:
    """The determinant of three rows."""
    return (
        u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
    )


def exact(p: Place) -> Place:
    """A point with rational coordinates."""
    return Fraction(p[0]), Fraction(p[1]), Fraction(p[2])


def minus(p: Place, q: Place) -> Place:
    """The vector from q to p."""
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def away(p: Place, q: Place) -> float:
    """The distance of two points."""
    x, y, z = minus(q, p)
    return sqrt(x * x + y * y + z * z)


def distance_to(x: Place, corners: Sequence[Place]) -> float:
    """The distance of a point from a segment or a triangle."""
    least = min(distance_to_segment(x, p, q) for p, q in combinations(corners, 2))
    if len(corners) == 2:
        return least
    a, b, c = corners
    u, v = minus(b, a), minus(c, a)
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    above = all(determinant3(n, minus(q, p), minus(x, p)) > 0 for p, q in ((a, b), (b, c), (c, a)))
    if not above:
        return least
    w, square = minus(x, a), n[0] * n[0] + n[1] * n[1] + n[2] * n[2]
    return abs(n[0] * w[0] + n[1] * w[1] + n[2] * w[2]) / sqrt(square)


def distance_to_segment(x: Place, p: Place, q: Place) -> float:
    """The distance of a point from a segment."""
    u, v = minus(q, p), minus(x, p)
    square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
    part = min(max((u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / square, 0.0), 1.0)
    return away(x, (p[0] + part * u[0], p[1] + part * u[1], p[2] + part * u[2]))
