"""Prismatic layers told plainly: the exact criterion for wedges, limits of columns, heights, places.

Points are tuples of three numbers, triangles triples of rows of points whose normals point to the side of the
layers. Directions are in `unstruct.plain.prism_normals`. The oracle for `unstruct.generate.prisms`. Book: 5.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import combinations
from math import sqrt
from typing import Any

__all__ = [
    "Points", "Triangle", "Vector", "column_limit", "cross", "exact", "graded_heights", "is_positive",
    "layer_places", "minus", "normal_of", "quadratics", "scalar", "summed", "unit", "wedge_is_positive",
]  # fmt: skip

Vector = tuple[Any, Any, Any]
Points = Sequence[Vector]
Triangle = tuple[int, int, int]


def exact(p: Vector) -> Vector:
    """The same numbers as fractions."""
    return Fraction(p[0]), Fraction(p[1]), Fraction(p[2])


def minus(p: Vector, q: Vector) -> Vector:
    """The difference p - q."""
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def cross(u: Vector, v: Vector) -> Vector:
    """The vector product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def scalar(u: Vector, v: Vector) -> Any:
    """The scalar product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def unit(u: Vector) -> Vector:
    """The vector at length 1, rounded."""
    length = sqrt(scalar(u, u))
    return float(u[0]) / length, float(u[1]) / length, float(u[2]) / length


def summed(vectors: Iterable[Vector]) -> Vector:
    """The sum."""
    rows = list(vectors)
    return sum(v[0] for v in rows), sum(v[1] for v in rows), sum(v[2] for v in rows)


def normal_of(points: Points, triangle: Triangle) -> Vector:
    """The normal of a triangle, twice as long as its area."""
    a, b, c = (points[v] for v in triangle)
    return cross(minus(b, a), minus(c, a))


# ---------------------------------------------------------------------- wedges


def quadratics(base: Points, rays: Points) -> list[tuple[Any, Any, Any]]:
    """The coefficients (c0, c1, c2) of A(t) . v, of three corners p and vectors v.

    A(t) is the normal of the triangle p + t v.
    """
    e, f = minus(base[1], base[0]), minus(base[2], base[0])
    other_e, other_f = minus(rays[1], rays[0]), minus(rays[2], rays[0])
    mixed = summed([cross(e, other_f), cross(other_e, f)])
    terms = cross(e, f), mixed, cross(other_e, other_f)
    return [tuple(scalar(term, v) for term in terms) for v in rays]


def wedge_is_positive(base: Points, cap: Points) -> bool:
    """Whether the Jacobian of a wedge is positive: its quadratics are, on [0, 1]."""
    below, above = [exact(p) for p in base], [exact(p) for p in cap]
    rays = [minus(q, p) for p, q in zip(below, above)]
    return all(is_positive(*q) for q in quadratics(below, rays))


def is_positive(c0: Fraction, c1: Fraction, c2: Fraction) -> bool:
    """Whether c0 + c1 t + c2 t^2 is positive on [0, 1], by its Bernstein coefficients."""
    b0, b1, b2 = c0, c0 + c1 / 2, c0 + c1 + c2
    return b0 > 0 and b2 > 0 and (b1 >= 0 or b1 * b1 < b0 * b2)


def column_limit(base: Points, rays: Points) -> float:
    """The least positive root of the three quadratics; infinite if there is none.

    Below it columns of equal height are positive, if each ray sees the triangle.
    """
    roots = []
    for c0, c1, c2 in ([float(c) for c in q] for q in quadratics(base, rays)):
        square = c1 * c1 - 4 * c0 * c2
        if c2 == 0:
            roots += [-c0 / c1] if c1 else []
        elif square >= 0:
            q = -(c1 + (sqrt(square) if c1 >= 0 else -sqrt(square))) / 2
            roots += [q / c2] + ([c0 / q] if q else [])
    return min((t for t in roots if t > 0), default=float("inf"))


# ---------------------------------------------------------------------- heights and places


def graded_heights(
    points: Points, triangles: Iterable[Triangle], heights: Sequence[float], slope: float
) -> list[float]:
    """The largest heights not above the given ones, nor a neighbor's plus slope times distance."""
    edges = {pair for t in triangles for pair in combinations(sorted(t), 2)}
    found, changed = list(heights), True
    while changed:
        changed = False
        for a, b in sorted(edges):
            away = minus(points[a], points[b])
            rise = slope * sqrt(scalar(away, away))
            for one, other in ((a, b), (b, a)):
                if found[one] > found[other] + rise:
                    found[one], changed = found[other] + rise, True
    return found


def layer_places(
    points: Points, directions: Points, heights: Sequence[float], shares: Sequence[float]
) -> list[list[Vector]]:
    """The places of all layers: each ray's height is divided by the same shares, 0 first and 1 last."""
    rows = []
    for share in shares:
        steps = [(share * h * u[0], share * h * u[1], share * h * u[2]) for u, h in zip(directions, heights)]
        rows.append([summed([p, step]) for p, step in zip(points, steps)])
    return rows
