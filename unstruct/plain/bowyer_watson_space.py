"""Bowyer and Watson's insertion in space, from a large tetrahedron or cube (section 2.8a of the book).

All points lie inside of an artificial start, so every point lies in some cell. Afterwards all cells with an
artificial vertex are removed. What remains can lack a part of the convex hull: a cell whose sphere contains
an artificial vertex was never made. ``unstruct.plain.bowyer_watson`` has vertices at infinity instead.

Sources: A. Bowyer, The Computer Journal 24 (1981) 162-166; D. F. Watson, ibid. 167-172; the cube of five
tetrahedra: N. P. Weatherill and O. Hassan, Int. J. Numer. Methods Eng. 37 (1994) 2005-2039.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from unstruct.base.errors import InputError
from unstruct.plain.predicates import in_sphere, orient

__all__ = [
    "FIVE",
    "Insertion",
    "around",
    "big_cube",
    "big_tetrahedron",
    "by_insertion",
    "cavity_of",
    "faces_of",
    "insert_in_space",
    "joined",
    "triangulate_space",
    "without_start",
]

Point = tuple[Fraction, ...]
Cell = tuple[int, ...]
Points = Sequence[tuple[Fraction, ...]]
Cells = frozenset[tuple[int, ...]]
# Corner k of a cube is (k & 1, k >> 1 & 1, k >> 2 & 1). The first cell has the four even corners, each
# other one cuts off an odd corner.
FIVE = ((0, 3, 5, 6), (1, 0, 3, 5), (2, 0, 6, 3), (4, 0, 5, 6), (7, 3, 6, 5))


class Insertion(NamedTuple):
    """One insertion: the new vertex, the cells that go, those that come, and all cells afterwards."""

    vertex: int
    cavity: Cells
    star: Cells
    cells: Cells


def triangulate_space(points: Sequence[Any], start: str = "cube", size: Any = 10) -> set[Cell]:
    """The cells of the points after insertion into an artificial start, and after its removal.

    Parameters
    ----------
    points : n points of three numbers
    start : "cube" or "tetrahedron"
    size : how many times larger than the points the start is, at least 2

    Notes
    -----
    Each cell has an empty open sphere, but cells of the convex hull can be missing. O(n^2) signs.
    """
    rows, cells = around(points, start, size)
    for step in by_insertion(rows, cells, range(len(points))):
        cells = step.cells
    return without_start(cells, len(points))


def around(points: Sequence[Any], start: str, size: Any) -> tuple[list[Point], Cells]:
    """The points as rationals, followed by the corners of the start, and the cells of the start."""
    rows = [tuple(map(Fraction, p)) for p in points]
    if not rows or any(len(p) != 3 for p in rows):
        raise InputError("points must be given as n >= 1 rows of three numbers")
    if start not in ("cube", "tetrahedron") or size < 2:
        raise InputError(
            f"start must be cube or tetrahedron with a size of at least 2, not {start!r}, {size!r}"
        )
    corners, cells = (big_cube if start == "cube" else big_tetrahedron)(rows, size)
    n = len(rows)
    named = (tuple(n + v for v in cell) for cell in cells)
    rows = [*rows, *corners]
    return rows, frozenset(positive(rows, cell) for cell in named)


def big_cube(points: Points, size: Any) -> tuple[list[Point], tuple[Cell, ...]]:
    """A cube around the points, ``size`` times as large as they are, of five tetrahedra."""
    middle, reach = ball_of(points)
    half = reach * Fraction(size)
    corners = [tuple(m + half * (2 * (k >> i & 1) - 1) for i, m in enumerate(middle)) for k in range(8)]
    return corners, FIVE


def big_tetrahedron(points: Points, size: Any) -> tuple[list[Point], tuple[Cell, ...]]:
    """The tetrahedron of four corners of a cube; it contains the middle third of the cube each way."""
    corners, _ = big_cube(points, 3 * Fraction(size))
    return [corners[v] for v in FIVE[0]], ((0, 1, 2, 3),)


def by_insertion(points: Points, cells: Cells, vertices: Iterable[int]) -> Iterator[Insertion]:
    """Insert one vertex after another, and yield each step; a copy of an earlier vertex is left out."""
    known = {points[v] for cell in cells for v in cell}
    for vertex in vertices:
        if points[vertex] not in known:
            known.add(points[vertex])
            step = insert_in_space(points, cells, vertex)
            cells = step.cells
            yield step


def insert_in_space(points: Points, cells: Cells, vertex: int) -> Insertion:
    """Remove the cells whose spheres contain the vertex, join their faces to it."""
    cavity = cavity_of(points, cells, vertex)
    star = frozenset(joined(points, face, vertex) for face in faces_of(cavity))
    return Insertion(vertex, cavity, star, (cells - cavity) | star)


def cavity_of(points: Points, cells: Iterable[Cell], vertex: int) -> Cells:
    """The cells whose open circumspheres contain the vertex."""
    p = points[vertex]
    return frozenset(c for c in cells if in_sphere([points[v] for v in c], p) > 0)


def faces_of(cells: Iterable[Cell]) -> list[Cell]:
    """The triangles that belong to one of the cells only."""
    faces = (tuple(sorted({*cell} - {v})) for cell in cells for v in cell)
    count = Counter(faces)
    return [face for face, times in count.items() if times == 1]


def joined(points: Points, face: Cell, vertex: int) -> Cell:
    """A face and a vertex as a cell of positive orientation."""
    return positive(points, (*face, vertex))


def positive(points: Points, cell: Cell) -> Cell:
    """The cell with ascending vertices, the last two exchanged where the orientation asks for it."""
    a, b, c, d = sorted(cell)
    sign = orient([points[v] for v in (a, b, c, d)])
    if sign == 0:
        raise InputError(f"the points {a}, {b}, {c}, {d} of a cell lie in a plane: no Delaunay start?")
    return (a, b, c, d) if sign > 0 else (a, b, d, c)


def without_start(cells: Iterable[Cell], n: int) -> set[Cell]:
    """The cells that have none of the artificial vertices n, n + 1, ..."""
    return {cell for cell in cells if max(cell) < n}


def ball_of(points: Points) -> tuple[Point, Fraction]:
    """The middle of the box around the points, and half of its longest side."""
    low, high = (tuple(map(end, zip(*points))) for end in (min, max))
    middle = tuple((a + b) / 2 for a, b in zip(low, high))
    return middle, max(*(b - a for a, b in zip(low, high)), Fraction(1, 10**9)) / 2
