"""Ruppert's Delaunay refinement: split encroached segments, else insert a circumcenter (book, 2.6).

The Delaunay triangulation of all points is kept, as cells with ghosts (`unstruct.plain.bowyer_watson`).
A *subsegment* is a part of an input segment between two vertices. It is *encroached* where a vertex lies
strictly inside its diametral disc; a subsegment that is no edge of the triangulation always is. While one
is encroached it is split in the middle; else the circumcenter of a bad triangle inside the region is
inserted, unless it would encroach on subsegments: then those are split instead.

Every point is rounded to doubles, so that the points stored are the points judged.

Source: J. Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, Journal of
Algorithms 18 (1995) 548-585.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import pi, sin
from typing import Any

from unstruct.base.errors import InputError
from unstruct.plain.bowyer_watson import GHOST, Cell, exact_points, first_simplex, insert, with_ghosts

__all__ = ["Step", "angle_is_small", "circumcenter", "encroaches", "inside", "refine", "ruppert"]

Point = tuple[Fraction, ...]
Segment = frozenset[int]


@dataclass(frozen=True)
class Step:
    """The state after one more point: ``points[:vertex + 1]`` and their Delaunay cells."""

    vertex: int
    kind: str  # "input", "segment" (the middle of a subsegment), "circumcenter"
    cause: frozenset[int]  # the subsegment that was split, or the triangle that was bad
    cells: frozenset[Cell]  # ghosts among them
    segments: frozenset[Segment]  # the subsegments now


def refine(points: Sequence[Sequence[Any]], segments: Iterable[Sequence[int]], **options: Any) -> tuple:
    """Points, triangles of the region, and subsegments after the last step of `ruppert`."""
    known = list(exact_points(points))
    *_, last = ruppert(known, segments, **options)
    return known, inside(last.cells, last.segments), last.segments


def ruppert(
    points: list[Point], segments: Iterable[Sequence[int]], *, min_angle: float = 20.0, max_area: Any = None,
    budget: int = 1000,
) -> Iterator[Step]:  # fmt: skip
    """Refine the region that closed chains of segments bound; new points are appended to ``points``.

    Parameters
    ----------
    points : list of exact points, as `unstruct.plain.bowyer_watson.exact_points` gives them
    segments : pairs of vertex numbers; even-odd: crossing one leads in or out of the region
    min_angle : degrees; Ruppert proves an end for up to 20.7 where input angles are at least 60
    max_area : number, optional
    budget : the number of points at which an `InputError` says that no end is in sight
    """
    bound = Fraction(sin(min_angle * pi / 180)) ** 2
    parts = frozenset(frozenset(s) for s in segments)
    cells = with_ghosts({first_simplex(points)})
    for vertex in range(len(points)):
        cells = insert(points, cells, vertex).cells
        yield Step(vertex, "input", frozenset(), cells, parts)
    while (found := _next_point(points, cells, parts, bound, max_area)) is not None:
        kind, cause, x = found
        if len(points) >= budget or x in points:
            raise InputError(f"no end after {len(points)} points: lower min_angle, or widen the input angles")
        vertex = len(points)
        points.append(x)
        if kind == "segment":
            parts = (parts - {cause}) | {frozenset({v, vertex}) for v in cause}
        cells = insert(points, cells, vertex).cells
        yield Step(vertex, kind, cause, cells, parts)


def _next_point(
    points: list[Point], cells: frozenset[Cell], parts: frozenset[Segment], bound: Fraction, max_area: Any
) -> tuple[str, frozenset[int], Point] | None:
    """What Ruppert does next: an encroached subsegment first, then the worst triangle; None at the end."""
    for part in sorted(parts, key=sorted):
        if any(encroaches(points, part, points[v]) for v in range(len(points)) if v not in part):
            return "segment", part, middle(points, part)
    bad = [
        t
        for t in inside(cells, parts)
        if angle_is_small(points, t, bound) or (max_area is not None and area(points, t) > max_area)
    ]
    if not bad:
        return None
    worst = max(bad, key=lambda t: (_radius2(points, t), sorted(t)))
    center = circumcenter([points[v] for v in worst])
    for part in sorted(parts, key=sorted):
        if encroaches(points, part, center):
            return "segment", part, middle(points, part)
    return "circumcenter", frozenset(worst), center


def encroaches(points: Sequence[Point], part: Segment, x: Point) -> bool:
    """Whether x lies strictly inside the disc whose diameter is the subsegment: an obtuse angle at x."""
    a, b = (points[v] for v in part)
    return sum((p - z) * (q - z) for p, q, z in zip(a, b, x)) < 0


def middle(points: Sequence[Point], part: Segment) -> Point:
    """The middle of a subsegment, rounded to doubles."""
    a, b = (points[v] for v in part)
    return tuple(_rounded((p + q) / 2) for p, q in zip(a, b))


def circumcenter(triangle: Sequence[Point]) -> Point:
    """The center of the circle through three points, rounded to doubles."""
    (ax, ay), (bx, by), (cx, cy) = triangle
    bx, by, cx, cy = bx - ax, by - ay, cx - ax, cy - ay
    twice = 2 * (bx * cy - by * cx)
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    return _rounded(ax + (cy * b2 - by * c2) / twice), _rounded(ay + (bx * c2 - cx * b2) / twice)


def area(points: Sequence[Point], t: Iterable[int]) -> Fraction:
    """The area of a counterclockwise triangle."""
    (ax, ay), (bx, by), (cx, cy) = (points[v] for v in t)
    return ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2


def angle_is_small(points: Sequence[Point], t: Cell, bound: Fraction) -> bool:
    """Whether the least angle has a squared sine below the bound: sin = 2 area / (two longer sides)."""
    _, b2, c2 = _sides2(points, t)
    return 4 * area(points, t) ** 2 < bound * b2 * c2


def inside(cells: Iterable[Cell], parts: frozenset[Segment]) -> set[Cell]:
    """The triangles of the region, reached from outside over an odd number of subsegments."""
    across: dict[Segment, list[Cell]] = {}
    for cell in cells:
        for v in cell:
            across.setdefault(frozenset(cell) - {v}, []).append(cell)
    depth = {cell: 0 for cell in cells if GHOST in cell}
    waiting = list(depth)
    while waiting:
        cell = waiting.pop()
        for edge in (frozenset(cell) - {v} for v in cell):
            for other in across[edge]:
                if other not in depth:
                    depth[other] = depth[cell] + (edge in parts)
                    waiting.append(other)
    return {cell for cell, d in depth.items() if d % 2}


def _sides2(points: Sequence[Point], t: Cell) -> list[Fraction]:
    """Squared lengths of the three sides, the shortest first."""
    corners = [points[v] for v in t]
    sides = [[p - q for p, q in zip(corners[k], corners[k - 1])] for k in range(3)]
    return sorted(x * x + y * y for x, y in sides)


def _radius2(points: Sequence[Point], t: Cell) -> Fraction:
    a2, b2, c2 = _sides2(points, t)
    return a2 * b2 * c2 / (16 * area(points, t) ** 2)


def _rounded(x: Fraction) -> Fraction:
    return Fraction(float(x))
