"""Lawson's diagonal swapping with exact arithmetic, and the six-angle rule (section 2.0 of the book).

A triangulation is a set of counterclockwise triangles (u, v, w), each written with its least vertex
first. ``apex[u, v]`` is the third corner of the triangle to the left of the directed edge u -> v.

Sources: C. L. Lawson, Software for C1 surface interpolation, in Mathematical Software III (1977);
R. Sibson, Locally equiangular triangulations, The Computer Journal 21 (1978) 243-245.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from fractions import Fraction
from typing import Any

from unstruct.base.errors import InputError
from unstruct.plain.predicates import in_sphere, orient

__all__ = ["angle_cotangents", "flip", "lawson", "least_angle_choice", "six_angles", "triangle"]

Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]
Edge = tuple[int, int]


def lawson(
    points: Points,
    triangles: Iterable[Sequence[int]],
    constrained: Collection[Edge] = (),
) -> tuple[set[Triangle], list[tuple[Edge, Edge]]]:
    """Swap diagonals until no edge is illegal: the circle of uvp contains q beyond uv.

    Parameters
    ----------
    points : n points of 2 numbers
    triangles : a triangulation, each triangle counterclockwise
    constrained : edges (u, v), in either direction, that must stay

    Returns
    -------
    triangles : set of tuples
    flips : list of (removed edge, new edge), in order; at most n (n - 1) / 2 of them
    """
    apex = {edge: w for t in triangles for edge, w in _corners(t)}
    fixed = {frozenset(edge) for edge in constrained}
    stack = [(u, v) for u, v in apex if u < v or (v, u) not in apex]
    flips = []
    while stack:
        u, v = stack.pop()
        if (u, v) not in apex or (v, u) not in apex or frozenset((u, v)) in fixed:
            continue  # swapped away, on the boundary, or kept by request
        p, q = apex[u, v], apex[v, u]
        if in_sphere([points[u], points[v], points[p]], points[q]) > 0:
            flip(apex, u, v)
            flips.append(((u, v), (p, q)))
            stack += [(u, q), (q, v), (v, p), (p, u)]
    return {triangle(u, v, w) for (u, v), w in apex.items()}, flips


def flip(apex: dict[Edge, int], u: int, v: int) -> None:
    """Replace the diagonal uv of u, q, v, p by pq, where p is left of uv."""
    p, q = apex.pop((u, v)), apex.pop((v, u))
    for t in [(p, u, q), (q, v, p)]:
        apex.update(_corners(t))


def triangle(u: int, v: int, w: int) -> Triangle:
    """The same triangle in the same orientation, written with its least vertex first."""
    least = min(u, v, w)
    return (u, v, w) if u == least else (v, w, u) if v == least else (w, u, v)


def _corners(t: Sequence[int]) -> list[tuple[Edge, int]]:
    u, v, w = t
    return [((u, v), w), ((v, w), u), ((w, u), v)]


def angle_cotangents(a: Sequence[Any], b: Sequence[Any], c: Sequence[Any]) -> list[Fraction]:
    """Cotangents of the angles at a, b, c of a triangle that is not flat: rational, unlike the angles.

    The cotangent decreases from infinity to minus infinity on (0, pi): a larger angle has a smaller one.
    """
    corners = [[Fraction(x) for x in p] for p in (a, b, c)]
    result = []
    for k in range(3):
        p, q, r = corners[k], corners[k - 2], corners[k - 1]
        (x1, y1), (x2, y2) = (q[0] - p[0], q[1] - p[1]), (r[0] - p[0], r[1] - p[1])
        result.append((x1 * x2 + y1 * y2) / abs(x1 * y2 - y1 * x2))
    return result


def six_angles(a: Any, b: Any, c: Any, d: Any) -> list[Fraction]:
    """Cotangents of the six angles of triangles abc and acd: quadrilateral abcd with the diagonal ac."""
    return angle_cotangents(a, b, c) + angle_cotangents(a, c, d)


def least_angle_choice(a: Any, b: Any, c: Any, d: Any) -> int:
    """The six-angle rule for a strictly convex quadrilateral abcd, counterclockwise.

    Returns
    -------
    int
        1 where the diagonal bd has the larger least angle (swap), -1 where ac has (keep), 0 for a tie.

    Raises
    ------
    InputError
        Where the quadrilateral is not strictly convex and counterclockwise: it has one diagonal only.
    """
    ring = [a, b, c, d]
    if any(orient([ring[k - 2], ring[k - 1], ring[k]]) <= 0 for k in range(4)):
        raise InputError(f"{ring} is not a strictly convex counterclockwise quadrilateral")
    with_ac, with_bd = max(six_angles(a, b, c, d)), max(six_angles(b, c, d, a))
    return (with_ac > with_bd) - (with_ac < with_bd)
