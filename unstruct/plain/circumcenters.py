"""Points at circumcenters of maximal triangles, exactly as the chapter tells it (section 2.6a of the book).

The triangle of the largest circumradius is found by looking at all of them; its circumcenter, rounded to
doubles, is inserted by the plain Bowyer-Watson algorithm. On the torus nine copies of each point stand for
the infinitely many.

Sources: the chapter, section 12.2.6; W. H. Frey, International Journal for Numerical Methods in Engineering
24 (1987) 2183-2200.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import floor
from typing import Any

from unstruct.plain.bowyer_watson import GHOST, Cell, Points, bowyer_watson, conflicts, exact_points, insert
from unstruct.plain.voronoi import circumcenter

__all__ = [
    "Step",
    "center",
    "circumcenter_insertion",
    "circumcenter_insertion_on_torus",
    "edge2",
    "radius2",
    "real",
]

Point = tuple[Fraction, ...]
Measure = Callable[[list[Point], Cell], Any]
MOVES = [(0, 0), *((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0))]


@dataclass(frozen=True)
class Step:
    """One insertion: the triangle that was the worst, the point put at its circumcenter, and what became."""

    triangle: Cell
    point: Point
    skipped: tuple[Cell, ...]  # worse triangles whose circumcenters are outside of the hull, or on it
    points: list[Point]  # afterwards
    cells: frozenset[Cell]  # afterwards, ghosts among them


def circumcenter_insertion(
    points: Points, count: int, worst: Measure | None = None
) -> Iterator[Step]:  # fmt: skip
    """Insert up to ``count`` circumcenters; end where none is inside of the hull.

    Parameters
    ----------
    points : the first points
    count : how many to insert
    worst : measure of a triangle, from points and cell; by default `radius2`
    """
    worst, have = worst or radius2, exact_points(points)
    cells = list(bowyer_watson(have))[-1].cells
    for _ in range(count):
        skipped: list[Cell] = []
        for cell in sorted(real(cells), key=partial(worst, have), reverse=True):
            point = rounded(center(have, cell))
            now, ghosts = [*have, point], [c for c in cells if GHOST in c]
            if not any(conflicts(now, cells, ghost, len(have)) for ghost in ghosts):
                break
            skipped.append(cell)
        else:
            return
        have = [*have, point]
        cells = insert(have, cells, len(have) - 1).cells
        yield Step(cell, point, tuple(skipped), have, cells)


def circumcenter_insertion_on_torus(points: Points, count: int) -> Iterator[Step]:
    """The same on the unit torus: all copies of a point are inserted, and nothing is ever outside.

    Point v has the copies 9 v, ..., 9 v + 8 in ``points``, the first of them in [0, 1) x [0, 1). Triangles
    stand for themselves where their circumcenter is in that square; no radius may reach 1/2.
    """
    have = [copy for p in exact_points(points) for copy in _copies(p)]
    cells = list(bowyer_watson(have))[-1].cells
    for _ in range(count):
        cell = max(in_square(have, cells), key=partial(radius2, have))
        point = rounded(center(have, cell))
        for copy in _copies(point):
            have = [*have, copy]
            cells = insert(have, cells, len(have) - 1).cells
        yield Step(cell, point, (), have, cells)


def in_square(points: list[Point], cells: Iterable[Cell]) -> list[Cell]:
    """The triangles whose circumcenters lie in [0, 1) x [0, 1): one copy of each triangle of the torus."""
    return [cell for cell in real(cells) if all(0 <= x < 1 for x in center(points, cell))]


def real(cells: Iterable[Cell]) -> list[Cell]:
    """The cells without the ghosts, sorted."""
    return sorted(cell for cell in cells if GHOST not in cell)


def center(points: list[Point], cell: Cell) -> Point:
    """The circumcenter."""
    a, b, c = ((points[v][0], points[v][1]) for v in cell)
    found = circumcenter(a, b, c)
    assert found is not None, "Delaunay cells are never flat"
    return found


def radius2(points: list[Point], cell: Cell) -> Fraction:
    """Square of the circumradius."""
    return edge2(points[cell[0]], center(points, cell))


def edge2(a: Point, b: Point) -> Fraction:
    """Square of the distance."""
    return sum(((x - y) ** 2 for x, y in zip(a, b)), Fraction(0))


def rounded(point: Point) -> Point:
    """The point with its coordinates rounded to doubles."""
    return tuple(Fraction(float(x)) for x in point)


def _copies(point: Point) -> list[Point]:
    """The point in [0, 1) x [0, 1) and its eight nearest copies."""
    base = [x - floor(x) for x in point]
    return [tuple(x + s for x, s in zip(base, move)) for move in MOVES]
