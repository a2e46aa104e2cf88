"""Points turned away that would break a boundary, and a row of points that guards it (book, section 2.4b).

A triangulation is a set of counterclockwise triangles; its boundary and inner pieces are ``segments``, pairs
of vertices, all of them edges. A point breaks a segment if that is missing once the point is there (see
`unstruct.plain.conforming`). What a point would replace are the triangles around it, up to segments, whose
circles hold it: they *starve* if it is turned away.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from math import sqrt
from typing import Any

from unstruct.plain.conforming import encroached, missing
from unstruct.plain.predicates import in_sphere, orient

__all__ = ["broken", "holders", "parts", "replaced", "skeleton", "tip", "turn_away"]

Point = tuple[Any, Any]
Edge = tuple[int, int]
Triangle = tuple[int, int, int]
HEIGHT = sqrt(0.75)  # of an equilateral triangle on a side of length 1


# --- points turned away ---------------------------------------------------------------------------


def broken(points: Sequence[Point], segments: Iterable[Edge], p: Point) -> list[Edge]:
    """The segments that p would break."""
    return [(u, v) for u, v in segments if missing([*points, p], points[u], points[v])]


def turn_away(
    points: Sequence[Point],
    segments: Sequence[Edge],
    cells: Iterable[Triangle],
    candidates: Iterable[Point],
) -> Iterator[tuple[str, list[Edge]]]:
    """One point after the other: does it go in, or why not?

    Yields
    ------
    verdict : str
        "in", "outside" of all cells, "equal" to a point, or "breaks".
    edges : list of pairs
        What it would break.
    """
    points, cells, start = list(points), list(cells), list(points)
    for p in candidates:
        if p in points:
            yield "equal", []
        elif not holders(start, cells, p):
            yield "outside", []
        elif bad := broken(points, segments, p):
            yield "breaks", bad
        else:
            points.append(p)
            yield "in", []


def holders(points: Sequence[Point], cells: Iterable[Triangle], p: Point) -> list[Triangle]:
    """The triangles with p inside or on their sides."""
    found = []
    for cell in cells:
        a, b, c = (points[v] for v in cell)
        if min(orient([a, b, p]), orient([b, c, p]), orient([c, a, p])) >= 0:
            found.append(cell)
    return found


def replaced(
    points: Sequence[Point], segments: Iterable[Edge], cells: Iterable[Triangle], p: Point
) -> set[Triangle]:
    """The triangles that p would replace."""
    walls = {frozenset(s) for s in segments}
    beside: dict[frozenset[int], list[Triangle]] = {}
    for cell in cells:
        for side in sides(cell):
            beside.setdefault(side, []).append(cell)
    found = set(pile := holders(points, cells, p))
    while pile:
        for side in set(sides(pile.pop())) - walls:
            for cell in set(beside[side]) - found:
                if in_sphere([points[v] for v in cell], p) > 0:
                    found.add(cell)
                    pile.append(cell)
    return found


# --- a row of points ------------------------------------------------------------------------------


def skeleton(
    points: Sequence[Point], segments: Sequence[Edge], cells: Iterable[Triangle], gap: float
) -> dict[tuple[int, int], Point]:
    """A tip on each inner side of each segment, where there is room; short segments come first.

    Parameters
    ----------
    points, segments, cells
        The open disk on each segment as diameter must hold no point.
    gap : float
        A tip goes in if no vertex is nearer than this many times the length of its segment.

    Returns
    -------
    dict of (int, int) to point
        Number of the segment, and 1 for the left side of it or -1 for the right one -> tip.
    """
    points, start, cells = list(points), list(points), list(cells)
    part, taken = parts(segments, cells), {}
    inner = {(cell[k - 1], cell[k]): cell for cell in cells for k in range(3)}
    sites = [
        (length(points[u], points[v]), i, side, inner[edge])
        for i, (u, v) in enumerate(segments)
        for side, edge in ((-1, (v, u)), (1, (u, v)))
        if edge in inner
    ]
    for l, i, side, cell in sorted(sites):
        u, v = segments[i]
        p = tip(points[u], points[v], side)
        within = {part[holder] for holder in holders(start, cells, p)}
        far = all(square(p, q) >= (Fraction(gap) * Fraction(l)) ** 2 for q in points)
        if part[cell] in within and p not in points and far:
            if not any(encroached([p], start[a], start[b]) for a, b in segments):
                points.append(p)
                taken[i, side] = p
    return taken


def tip(a: Point, b: Point, side: int) -> Point:
    """The tip of an equilateral triangle on ab, on its left (1) or right (-1), in floating point."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    return (a[0] + b[0]) / 2 - side * HEIGHT * dy, (a[1] + b[1]) / 2 + side * HEIGHT * dx


def parts(segments: Iterable[Edge], cells: Iterable[Triangle]) -> dict[Triangle, int]:
    """For each triangle the number of its part: parts hang together over sides that are no segments."""
    walls = {frozenset(s) for s in segments}
    number = {cell: i for i, cell in enumerate(cells)}
    beside: dict[frozenset[int], Triangle] = {}
    for cell in number:
        for side in set(sides(cell)) - walls:
            old, new = number[cell], number[beside.setdefault(side, cell)]
            number = {c: new if k == old else k for c, k in number.items()}
    return number


def sides(cell: Triangle) -> list[frozenset[int]]:
    """The three sides of a triangle."""
    return [frozenset((cell[k - 1], cell[k])) for k in range(3)]


def length(a: Point, b: Point) -> float:
    """The distance of two points, rounded."""
    return sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2)


def square(a: Point, b: Point) -> Fraction:
    """The squared distance of two points, exactly."""
    return sum((Fraction(x) - Fraction(y)) ** 2 for x, y in zip(a, b)) + Fraction(0)
