"""Delaunay refinement of a box with vertices inside: pieces are divided until no cell is bad (book, 2.8d).

A box is convex, so each Delaunay cell of its vertices is in it, and in the plane of a facet one coordinate is
constant. All else is as for any body: subsegments first, then subfacets, then cells; and a center that
encroaches on a smaller piece is rejected, and this piece is divided in its place.

Source: J. R. Shewchuk, Symposium on Computational Geometry (1998) 86-95.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations, pairwise, product
from typing import Any, NamedTuple

from unstruct.base.errors import InputError
from unstruct.plain.bowyer_watson import GHOST, exact_points, first_simplex, insert, triangulate, with_ghosts
from unstruct.plain.predicates import orient

__all__ = [
    "Division",
    "bad_cells",
    "encroaches",
    "next_division",
    "refine_box",
    "smallest_sphere",
    "subfacets",
    "subsegments",
]

Point = tuple[Fraction, ...]
Points = Sequence[tuple[Fraction, ...]]
Piece = tuple[int, ...]  # the corners of a subsegment (two), a subfacet (three) or a cell (four)


class Division(NamedTuple):
    """The piece that is divided at its center, and those whose centers were rejected for it."""

    piece: Piece
    center: Point
    rejected: tuple[Piece, ...]


def refine_box(points: list[Point], ratio: Any = 2, budget: int = 100) -> Iterator[Division]:
    """Divide pieces until no cell has R / l > ``ratio``; new vertices are appended to ``points``.

    The points are the corners of a box with sides along the axes, and any others inside of it.
    """
    points[:] = exact_points(points)
    cells = with_ghosts({first_simplex(points)})
    for vertex in range(len(points)):
        cells = insert(points, cells, vertex).cells
    while (found := next_division(points, cells, ratio)) is not None:
        if len(points) >= budget:
            raise InputError(f"no end after {budget} vertices: give a larger ratio, or a larger budget")
        points.append(found.center)
        cells = insert(points, cells, len(points) - 1).cells
        yield found


def next_division(points: Points, cells: Iterable[Piece], ratio: Any) -> Division | None:
    """What the first rule that applies divides, after all rejections; None at the end."""
    smaller = [*subsegments(points), *subfacets(points)]
    waiting = [one for one in smaller if any(encroaches(points, one, p) for p in points)]
    waiting = waiting or bad_cells(points, cells, ratio)
    if not waiting:
        return None
    piece = waiting[0]
    rejected: list[Piece] = []
    while True:
        center, _ = smallest_sphere([points[v] for v in piece])
        hit = [one for one in smaller if len(one) < len(piece)]
        hit = [one for one in hit if encroaches(points, one, center)]
        if not hit or len(hit[0]) == 3:  # no subsegment: the subfacet below the center
            hit = [one for one in hit if is_over(points, one, center)]
        if not hit:
            return Division(piece, center, tuple(rejected))
        rejected.append(piece)
        piece = hit[0]


def encroaches(points: Points, piece: Piece, place: Point) -> bool:
    """Whether a place is strictly inside of the smallest sphere of the piece."""
    center, square = smallest_sphere([points[v] for v in piece])
    return sum((x - c) ** 2 for x, c in zip(place, center)) < square


def smallest_sphere(corners: Points) -> tuple[Point, Fraction]:
    """The smallest sphere through two, three or four points: center, squared radius.

    With u, v, ... from the first corner to the others, the center is at a u + b v + ...
    for which its product with each of u, v, ... is half the square of that vector.
    """
    first, *others = corners
    ways = [[Fraction(x) - Fraction(y) for x, y in zip(p, first)] for p in others]
    matrix = [[_product(u, v) for v in ways] + [_product(u, u) / 2] for u in ways]
    for k, row in enumerate(matrix):  # the pivots are positive: no rows are exchanged
        row[:] = [x / row[k] for x in row]
        for other in matrix:
            if other is not row:
                other[:] = [x - other[k] * y for x, y in zip(other, row)]
    shares = [row[-1] for row in matrix]
    offset = [_product(shares, column) for column in zip(*ways)]
    return tuple(x + y for x, y in zip(first, offset)), _product(offset, offset)


def bad_cells(points: Points, cells: Iterable[Piece], ratio: Any) -> list[Piece]:
    """The cells with R / l above ``ratio``, the worst first."""
    quotient = {}
    for cell in cells:
        if GHOST not in cell:
            rows = [points[v] for v in sorted(cell)]
            shortest = min(_product(w, w) for w in (_minus(p, q) for p, q in combinations(rows, 2)))
            quotient[tuple(sorted(cell))] = smallest_sphere(rows)[1] / shortest
    bad = [cell for cell, square in quotient.items() if square > Fraction(ratio) ** 2]
    return sorted(bad, key=lambda cell: (-quotient[cell], cell))


def subsegments(points: Points) -> list[Piece]:
    """The parts of the twelve edges of the box between vertices that follow each other."""
    found: list[Piece] = []
    for i, j in combinations(range(3), 2):
        (k,) = {0, 1, 2} - {i, j}
        for a, b in product(_ends(points, i), _ends(points, j)):
            on = [v for v, p in enumerate(points) if (p[i], p[j]) == (a, b)]
            found += pairwise(sorted(on, key=lambda v: points[v][k]))
    return found


def subfacets(points: Points) -> list[Piece]:
    """The triangles of the planar Delaunay triangulations of the six sides of the box."""
    found: list[Piece] = []
    for k in range(3):
        for side in _ends(points, k):
            on = [v for v, p in enumerate(points) if p[k] == side]
            flat = [points[v][:k] + points[v][k + 1 :] for v in on]
            found += sorted(tuple(sorted(on[v] for v in cell)) for cell in triangulate(flat))
    return found


def is_over(points: Points, subfacet: Piece, place: Point) -> bool:
    """Whether the place projects orthogonally into the triangle."""
    rows = [points[v] for v in subfacet]
    k = next(k for k in range(3) if len({p[k] for p in rows}) == 1)
    a, b, c, x = (p[:k] + p[k + 1 :] for p in (*rows, place))
    signs = {orient((a, b, x)), orient((b, c, x)), orient((c, a, x))}
    return not {1, -1} <= signs


def _ends(points: Points, axis: int) -> tuple[Fraction, Fraction]:
    values = [p[axis] for p in points]
    return min(values), max(values)


def _minus(p: Sequence[Any], q: Sequence[Any]) -> list[Any]:
    return [x - y for x, y in zip(p, q)]


def _product(u: Sequence[Any], v: Sequence[Any]) -> Any:
    return sum(x * y for x, y in zip(u, v))
