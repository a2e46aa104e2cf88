"""Rebay's Voronoi-segment insertion, told plainly (section 2.6c of the book).

A triangulation is a set of counterclockwise triangles inside the region, each with its least vertex first;
the parts of the boundary are ``fixed`` edges. A triangle is accepted if its circumradius is below ``accept``
times the wanted one, f; what lies beyond the boundary counts as accepted, too. The front is where waiting
triangles have accepted neighbors. Where the new point goes is told in `rebay_step`.

Source: S. Rebay, Journal of Computational Physics 106 (1993) 125-138.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import atan2, dist, pi
from typing import Any

from unstruct.plain.constrained import constrained_delaunay, corners, inside
from unstruct.plain.lawson import triangle
from unstruct.plain.predicates import in_sphere, orient
from unstruct.plain.rebay_step import Step, step

__all__ = [
    "Insertion", "active_edges", "cavity", "circumradius", "is_accepted", "next_point", "start",
    "voronoi_segment",
]  # fmt: skip

Point = tuple[float, float]
Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]
Edge = tuple[int, int]
Size = Callable[[Point], float]
Found = tuple[Edge, Triangle | None, Step, frozenset[Triangle], list[Edge]]


@dataclass(frozen=True)
class Insertion:
    """One new point and what it changed."""

    edge: Edge  # AB, with the waiting triangle on its left
    waiting: Triangle
    accepted: Triangle | None  # ABC; None where AB is on the boundary
    step: Step
    vertex: int  # the number of X
    cavity: frozenset[Triangle]
    star: frozenset[Triangle]
    points: list[Point]  # afterwards
    cells: frozenset[Triangle]  # afterwards


def voronoi_segment(
    points: Points,
    segments: Iterable[Edge],
    f: Size,
    accept: float = 1.35,
    limit: int = 10_000,
) -> Iterator[Insertion]:
    """Insert points on Voronoi segments until no triangle at the front has one.

    A triangle that has had none is not tried again, even if its neighbors have changed.

    Parameters
    ----------
    points : n points of two numbers
    segments : the boundary, pairs of indices, not crossing; even-odd
    f : function of a point
        The wanted circumradius (the wanted edge length over sqrt(3)).
    accept : float
        The factor delta of the acceptance.
    limit : int
        At most so many new points.
    """
    have = [(float(x), float(y)) for x, y in points]
    cells, fixed = start(points, segments)
    refused: set[Triangle] = set()
    while len(have) < len(points) + limit:
        accepted = {cell for cell in cells if is_accepted(have, cell, f, accept)}
        left = cells - accepted - refused
        front = [c for c in left if active_edges(have, cells, fixed, accepted, c)]
        if not front:
            return
        worst = max(front, key=lambda cell: (badness(have, cell, f), cell))
        found = next_point(have, cells, fixed, accepted, worst, f)
        if found is None:
            refused.add(worst)
            continue
        edge, beyond, got, gone, rim = found
        have = [*have, got.point]  # type: ignore[list-item]  # it has a point
        star = frozenset(triangle(u, v, len(have) - 1) for u, v in rim)
        cells = cells - gone | star
        number = len(have) - 1
        yield Insertion(edge, worst, beyond, got, number, gone, star, have, cells)


def start(
    points: Points,
    segments: Iterable[Edge],
) -> tuple[frozenset[Triangle], set[frozenset[int]]]:
    """The constrained Delaunay triangles inside the region, and the fixed edges."""
    segments = [(int(a), int(b)) for a, b in segments]
    cells, parts = constrained_delaunay(points, segments)
    kept = frozenset(cell for cell in cells if inside(points, segments, cell))
    return kept, {frozenset(part) for part in parts}


def is_accepted(points: Points, cell: Triangle, f: Size, accept: float) -> bool:
    """Whether a triangle is small enough, f taken at its centroid."""
    return circumradius(points, cell) < accept * f(centroid(points, cell))


def active_edges(
    points: Points,
    cells: Iterable[Triangle],
    fixed: set[frozenset[int]],
    accepted: set[Triangle],
    cell: Triangle,
) -> list[tuple[Edge, Triangle | None]]:
    """The active edges of a triangle with their neighbors, shortest first."""
    neighbor = {edge: c for c in cells for edge, _ in corners(c)}
    found = []
    for (u, v), _ in corners(cell):
        beyond = None if frozenset((u, v)) in fixed else neighbor[v, u]
        if beyond is None or beyond in accepted:
            found.append(((u, v), beyond))
    return sorted(found, key=lambda one: dist(points[one[0][0]], points[one[0][1]]))


def next_point(
    points: Points,
    cells: frozenset[Triangle],
    fixed: set[frozenset[int]],
    accepted: set[Triangle],
    cell: Triangle,
    f: Size,
) -> Found | None:
    """The first active edge whose point can be inserted, with its cavity."""
    for (a, b), beyond in active_edges(points, cells, fixed, accepted, cell):
        d = next(iter(set(cell) - {a, b}))
        c = None if beyond is None else points[next(iter(set(beyond) - {a, b}))]
        (ax, ay), (bx, by) = points[a], points[b]
        wanted = f(((ax + bx) / 2, (ay + by) / 2))
        got = step(points[a], points[b], points[d], wanted, c)
        circle = [points[v] for v in cell]
        if got.point is None or in_sphere(circle, got.point) <= 0:
            continue
        gone, rim = cavity(points, cells, fixed, cell, got.point)
        if all(allowed(points, fixed, edge, got.point) for edge in rim):
            return (a, b), beyond, got, gone, rim
    return None


def cavity(
    points: Points,
    cells: Iterable[Triangle],
    fixed: set[frozenset[int]],
    seed: Triangle,
    x: Point,
) -> tuple[frozenset[Triangle], list[Edge]]:
    """The triangles whose circles contain x, up to fixed edges, and their rim."""
    neighbor = {edge: c for c in cells for edge, _ in corners(c)}
    gone, rim, fresh = {seed}, [], [seed]
    while fresh:
        cell = fresh.pop()
        for (u, v), _ in corners(cell):
            other = None if frozenset((u, v)) in fixed else neighbor[v, u]
            if other is None:
                rim.append((u, v))
            elif other not in gone:
                if in_sphere([points[w] for w in other], x) > 0:
                    gone.add(other)
                    fresh.append(other)
                else:
                    rim.append((u, v))
    return frozenset(gone), rim


def allowed(
    points: Points,
    fixed: set[frozenset[int]],
    edge: Edge,
    x: Point,
) -> bool:
    """Whether x sees an edge from inside, a fixed one under less than 120°."""
    a, b = (points[v] for v in edge)
    if orient([a, b, x]) <= 0:
        return False
    return frozenset(edge) not in fixed or angle_at(a, b, x) < 2 * pi / 3


def angle_at(a: Sequence[Any], b: Sequence[Any], x: Point) -> float:
    """The angle under which ab is seen from x, in radians."""
    ux, uy, vx, vy = a[0] - x[0], a[1] - x[1], b[0] - x[0], b[1] - x[1]
    return abs(atan2(ux * vy - uy * vx, ux * vx + uy * vy))


def badness(points: Points, cell: Triangle, f: Size) -> float:
    """The circumradius over the wanted one at the centroid."""
    return circumradius(points, cell) / f(centroid(points, cell))


def circumradius(points: Points, cell: Triangle) -> float:
    """The product of the three sides over four times the area."""
    a, b, c = (points[v] for v in cell)
    twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return dist(a, b) * dist(b, c) * dist(c, a) / (2 * abs(twice))


def centroid(points: Points, cell: Triangle) -> Point:
    """The mean of the corners."""
    return (sum(points[v][0] for v in cell) / 3, sum(points[v][1] for v in cell) / 3)
