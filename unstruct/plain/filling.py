"""Filling a body: points of a lattice, inside by parity, rounder cells by refills (section 2.8c of the book).

Points are tuples of fractions, cells tuples of four vertices with positive orientation, faces triples of
vertices. Nothing is rounded.

Sources: D. J. Naylor, Int. J. Numer. Methods Eng. 44 (1999) 1383-1395, for the lattice; L. A. Freitag,
C. Ollivier-Gooch, Int. J. Numer. Methods Eng. 40 (1997) 3979-4002, for making the worst cell better.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import combinations, product
from typing import Any

from unstruct.plain.predicates import orient
from unstruct.plain.refilling import refills, walls_of

__all__ = ["flood", "improve_once", "inside", "lattice", "shape", "worst_of"]

Point = Sequence[Any]
Points = Sequence[Point]
Face = tuple[int, int, int]
Cell = tuple[int, int, int, int]
Cells = frozenset[Cell]
FAR = ((1009, 643, 397), (-811, 1013, 509), (601, -733, 1019), (-419, -877, 997))


def lattice(low: Point, high: Point, side: Any) -> list[tuple[Fraction, ...]]:
    """The corners of cubes that fill a box, and then their centers."""
    steps = [range(int((b - a) / Fraction(side)) + 1) for a, b in zip(low, high)]
    whole, half = Fraction(side), Fraction(side) / 2
    corners = [tuple(a + whole * k for a, k in zip(low, at)) for at in product(*steps)]
    centers = [tuple(x + half for x in corner) for corner in corners]
    return corners + [c for c in centers if all(x <= b for x, b in zip(c, high))]


def inside(points: Points, facets: Iterable[Face], place: Point) -> bool:
    """Whether a path from far away to this place, on no facet, goes through an odd number of facets."""
    corners = [[points[v] for v in face] for face in facets]
    reach = 1 + max(abs(x) for face in corners for p in face for x in p)
    for far in FAR:
        end = tuple(x * reach for x in far)
        signs = [_met(face, place, end) for face in corners]
        if None not in signs:
            return signs.count(True) % 2 == 1
    raise ValueError("each path meets an edge of a facet")


def _met(face: Sequence[Point], place: Point, end: Point) -> bool | None:
    """Whether the path goes through the triangle; None if it meets its boundary, or runs in its plane.

    Neither end is on the triangle: with one end in its plane, the path does not meet it.
    """
    a, b, c = face
    ends = orient([a, b, c, place]), orient([a, b, c, end])
    sides = {orient([place, end, *edge]) for edge in ((a, b), (b, c), (c, a))}
    if ends == (0, 0):
        return None
    if ends[0] * ends[1] >= 0 or {-1, 1} <= sides:
        return False
    return None if 0 in sides else True


def flood(cells: Iterable[Cell], facets: Iterable[Face]) -> dict[Cell, int]:
    """How many facets, modulo 2, lie between each cell and the outside.

    Facets must be faces of cells.
    """
    cells, walls = list(cells), {frozenset(face) for face in facets}
    owners: dict[frozenset[int], list[Cell]] = {}
    for cell in cells:
        for face in combinations(cell, 3):
            owners.setdefault(frozenset(face), []).append(cell)
    hull = [(face, own[0]) for face, own in owners.items() if len(own) == 1]
    parity: dict[Cell, int] = {}
    for side, cell in hull:
        known = parity.setdefault(cell, int(side in walls))
        assert known == (side in walls), "the facets are not closed"
    waiting = list(parity)
    while waiting:
        cell = waiting.pop()
        for side in map(frozenset, combinations(cell, 3)):
            for other in owners[side]:
                crossed = parity[cell] ^ (side in walls)
                if other != cell and other not in parity:
                    parity[other] = crossed
                    waiting.append(other)
                right = other == cell or parity[other] == crossed
                assert right, "the facets are not closed"
    return parity


def shape(points: Points, cell: Cell) -> Fraction:
    """The square of 6 sqrt(2) V / L^3: 1 for a regular cell, 0 for a flat one.

    Here L^2 is the mean square of the edges.
    """
    rows = [[Fraction(x) for x in points[v]] for v in cell]
    pairs = combinations(rows, 2)
    squares = [sum((x - y) ** 2 for x, y in zip(p, q)) for p, q in pairs]
    u, v, w = ([x - y for x, y in zip(row, rows[0])] for row in rows[1:])
    six = sum(u[i] * (v[i - 2] * w[i - 1] - v[i - 1] * w[i - 2]) for i in range(3))
    mean = Fraction(sum(squares)) / 6
    return 2 * six**2 / (mean * mean * mean)


def worst_of(points: Points, cells: Iterable[Cell]) -> Fraction:
    """The least shape of some cells."""
    return min(shape(points, cell) for cell in cells)


def improve_once(points: Points, cells: Cells, most: int = 7) -> Cells | None:
    """Refill one cavity so that its worst cell is better.

    It is around the worst cell for which there is one; None if there is none.
    """
    for cell in sorted(cells, key=lambda cell: (shape(points, cell), cell)):
        for cavity in _around(cells, cell, most):
            found = refills(points, walls_of(cavity))
            whole = [new for new in found if _corners(new) == _corners(cavity)]
            best = max(whole, key=lambda new: worst_of(points, new), default=cavity)
            if worst_of(points, best) > worst_of(points, cavity):
                return cells - cavity | best
    return None


def _corners(cells: Iterable[Cell]) -> set[int]:
    return {v for cell in cells for v in cell}


def _around(cells: Cells, cell: Cell, most: int) -> list[Cells]:
    """Cavities: the cell with one neighbor, or with all cells at one of its edges."""
    near = [other for other in sorted(cells) if len(set(other) & set(cell)) == 3]
    found = [frozenset({cell, other}) for other in near]
    for edge in combinations(sorted(cell), 2):
        found.append(frozenset(other for other in cells if set(edge) <= set(other)))
    return [cavity for cavity in found if len(_corners(cavity)) <= most]
