"""Triangles of a quadtree brought to a boundary, told plainly (section 4b of the book).

The region is where a function of the points, its *level*, is negative. A triangle is a tuple of three points,
counterclockwise, and a point a pair of Fractions (floats do as well). `cut` keeps of each triangle what lies
inside; `warp` first moves vertices that are near the boundary onto it, so that less of the cuts are thin.

An angle is compared by its cotangent, which is a fraction when the coordinates are: 0 for 90 degrees, 1 for
45 degrees, 2 for the angle arctan(1/2). The smallest angle of a triangle has the largest cotangent.

Source: M. A. Yerry, M. S. Shephard, IEEE Computer Graphics and Applications 3 (1983) 39-46.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from unstruct.base.errors import InputError

__all__ = ["best_diagonal", "cotangents", "crossed", "crossing", "cut", "cut_all", "sharpest", "warp"]

Point = tuple[Any, ...]
Triangle = tuple[Point, Point, Point]
Values = Mapping[Point, Any]


def cotangents(triangle: Sequence[Point]) -> list[Any]:
    """The cotangents of the three angles: a scalar product over twice the area."""
    found = []
    for k in range(3):
        a, b, c = (triangle[(k + turn) % 3] for turn in range(3))
        (ux, uy), (vx, vy) = ((p[0] - a[0], p[1] - a[1]) for p in (b, c))
        if ux * vy <= uy * vx:
            raise InputError(f"the corners {a}, {b}, {c} are not counterclockwise")
        found.append((ux * vx + uy * vy) / (ux * vy - uy * vx))
    return found


def sharpest(triangles: Iterable[Sequence[Point]]) -> Any:
    """The cotangent of the smallest angle of several triangles."""
    return max(max(cotangents(triangle)) for triangle in triangles)


def best_diagonal(a: Point, b: Point, c: Point, d: Point) -> list[Triangle]:
    """Two triangles of a quadrilateral, by the diagonal that leaves the larger smallest angle."""

    def turns(p: Point, q: Point, r: Point) -> Any:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    pairs = [[(a, b, c), (a, c, d)], [(a, b, d), (b, c, d)]]
    valid = [pair for pair in pairs if all(turns(*triangle) > 0 for triangle in pair)]
    if not valid:
        raise InputError(f"{a}, {b}, {c}, {d} is no counterclockwise quadrilateral")
    return min(valid, key=sharpest)


def crossing(p: Point, q: Point, value: Values) -> Point:
    """Where the level is zero on an edge, if it is linear along it."""
    t = value[p] / (value[p] - value[q])
    return (p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]))


def crossed(triangles: Iterable[Triangle], value: Values) -> list[tuple[Point, Point]]:
    """Edges with ends on different sides of the boundary, each in both directions."""
    found: set[tuple[Point, Point]] = set()
    for triangle in triangles:
        inside = [p for p in triangle if value[p] < 0]
        outside = [q for q in triangle if value[q] > 0]
        found |= {pair for p in inside for q in outside for pair in ((p, q), (q, p))}
    return sorted(found)


def cut(triangle: Triangle, value: Values) -> list[Triangle]:
    """What of a triangle is inside: nothing, the whole, or one or two triangles."""
    if all(value[p] >= 0 for p in triangle):
        return []
    ring = []
    for p, q in zip(triangle, triangle[1:] + triangle[:1], strict=True):
        if value[p] <= 0:
            ring.append(p)
        if value[p] * value[q] < 0:
            # both triangles at an edge begin at the same end: one point for both
            ring.append(crossing(min(p, q), max(p, q), value))
    return [(ring[0], ring[1], ring[2])] if len(ring) == 3 else best_diagonal(*ring)


def warp(
    triangles: Iterable[Triangle], level: Callable[[Point], Any], threshold: Any
) -> tuple[list[Triangle], dict[Point, Any]]:
    """Move vertices onto the boundary along edges, by less than a share of each.

    Of several crossings the one with the smallest share is taken. Returned are the
    triangles with moved vertices, and the values there: zero if a vertex was moved.
    """
    rows = list(triangles)
    value = {p: level(p) for triangle in rows for p in triangle}
    moves: dict[Point, tuple[Any, Point]] = {}
    for p, q in crossed(rows, value):
        share = value[p] / (value[p] - value[q])
        if share < threshold and (p not in moves or share < moves[p][0]):
            moves[p] = (share, crossing(p, q, value))
    place = {p: moves[p][1] if p in moves else p for p in value}
    moved = [(place[a], place[b], place[c]) for a, b, c in rows]
    return moved, {place[p]: 0 if p in moves else value[p] for p in value}


def cut_all(triangles: Iterable[Triangle], value: Values, level: Callable[[Point], Any]) -> list[Triangle]:
    """All triangles, cut; if all corners of one lie on the boundary, the level in its middle decides."""
    parts: list[Triangle] = []
    for triangle in triangles:
        if any(value[p] != 0 for p in triangle):
            parts += cut(triangle, value)
        elif level((sum(p[0] for p in triangle) / 3, sum(p[1] for p in triangle) / 3)) < 0:
            parts.append(triangle)
    return parts
