"""The Bowyer-Watson algorithm in any dimension: locate, cavity, star (section 2.4a of the book).

A triangulation is a set of cells, a cell a tuple of d + 1 vertex numbers in positive orientation.
Beyond each facet of the hull lies a *ghost cell*, whose one vertex at infinity is ``GHOST``; its circle
is the open half-space beyond the facet. So every facet has a cell on both sides, a point outside the
hull lies in some cell like any other, and no enclosing square has to be large enough.

Sources: A. Bowyer, The Computer Journal 24 (1981) 162-166; D. F. Watson, ibid. 167-172; the ghost
vertex: L. Guibas and J. Stolfi, ACM Transactions on Graphics 4 (1985) 74-123.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from unstruct.base.errors import DegenerateInputError, InputError
from unstruct.plain.predicates import in_sphere, orient

__all__ = [
    "GHOST",
    "Step",
    "boundary",
    "bowyer_watson",
    "conflicts",
    "exact_points",
    "first_simplex",
    "insert",
    "locate",
    "star",
    "triangulate",
    "with_ghosts",
]

GHOST = -1  # the vertex at infinity

Cell = tuple[int, ...]
Facet = frozenset[int]
Points = Sequence[Sequence[Any]]


@dataclass(frozen=True)
class Step:
    """One insertion. A copy of an earlier vertex has an empty cavity and an empty star."""

    vertex: int
    located: Cell  # a cell that holds the point
    cavity: frozenset[Cell]  # the cells that go
    boundary: frozenset[Facet]  # the facets of the cavity, which stay
    star: frozenset[Cell]  # the cells that come: the facets joined to the point
    cells: frozenset[Cell]  # all cells afterwards, ghosts among them

    @property
    def before(self) -> frozenset[Cell]:
        """All cells before the insertion."""
        return (self.cells - self.star) | self.cavity


def triangulate(points: Points) -> set[Cell]:
    """The cells of a Delaunay triangulation (without the ghosts), each positively oriented.

    Parameters
    ----------
    points : n points of d numbers, of any finite numeric type

    Raises
    ------
    InputError
        Where there are no points, or a coordinate is not finite.
    DegenerateInputError
        Where the points lie in a hyperplane.

    Notes
    -----
    O(n) sign tests a point, O(n^2) in all: made to be read.
    """
    cells: frozenset[Cell] = frozenset()
    for step in bowyer_watson(points):
        cells = step.cells
    return {cell for cell in cells if GHOST not in cell}


def bowyer_watson(points: Points) -> Iterator[Step]:
    """Insert one point after another; yield a `Step` for each, the first for the starting simplex."""
    exact = exact_points(points)
    simplex = first_simplex(exact)
    cells = with_ghosts({simplex})
    yield Step(simplex[-1], simplex, frozenset(), frozenset(), cells, cells)
    for vertex in range(len(exact)):
        if vertex not in simplex:
            step = insert(exact, cells, vertex)
            cells = step.cells
            yield step


def insert(points: Points, cells: Iterable[Cell], vertex: int) -> Step:
    """Insert one vertex into a Delaunay triangulation, given with its ghosts.

    Where the cells are not Delaunay the star may overlap other cells: see
    ``unstruct.plain.modernized``.
    """
    cells = frozenset(cells)
    located = locate(points, cells, vertex)
    corners = {tuple(points[v]) for v in located if v != GHOST}
    if tuple(points[vertex]) in corners:
        return Step(vertex, located, frozenset(), frozenset(), frozenset(), cells)
    cavity = frozenset(c for c in cells if conflicts(points, cells, c, vertex))
    new, kept = star(cavity, vertex), cells - cavity
    return Step(vertex, located, cavity, boundary(cavity), new, kept | new)


def locate(points: Points, cells: Iterable[Cell], vertex: int) -> Cell:
    """A cell that holds the vertex: a closed simplex, or the open half-space of a ghost."""
    for cell in sorted(cells):
        signs = [orient([points[v] for v in side]) for side in _replaced(cell, vertex) if GHOST not in side]
        if min(signs) > 0 or (GHOST not in cell and min(signs) == 0):
            return cell
    raise InputError(
        f"no cell holds vertex {vertex}: the cells do not fill the plane; add their ghosts first"
    )


def conflicts(points: Points, cells: Iterable[Cell], cell: Cell, vertex: int) -> bool:
    """Does the open circumsphere of the cell contain the vertex?

    The sphere of a ghost is the half-space beyond its facet. Its border, the plane
    of the facet, belongs to it as far as the sphere of the cell within: else a point
    on the hull would give a flat cell.
    """
    if GHOST not in cell:
        return in_sphere([points[v] for v in cell], points[vertex]) > 0
    beyond = orient([points[vertex if v == GHOST else v] for v in cell])
    if beyond == 0:
        facet = set(cell) - {GHOST}
        within = next(c for c in cells if facet < set(c) and GHOST not in c)
        return conflicts(points, cells, within, vertex)
    return beyond > 0


def boundary(cavity: Iterable[Cell]) -> frozenset[Facet]:
    """The facets that belong to one cell only."""
    count = Counter(frozenset(cell) - {v} for cell in cavity for v in cell)
    return frozenset(facet for facet, times in count.items() if times == 1)


def star(cavity: Iterable[Cell], vertex: int) -> frozenset[Cell]:
    """Every facet of the cavity joined to the vertex, on the removed cell's side."""
    rim = boundary(cavity)
    return frozenset(
        _canonical(new)
        for cell in cavity
        for v, new in zip(cell, _replaced(cell, vertex))
        if frozenset(cell) - {v} in rim
    )


def with_ghosts(cells: Iterable[Cell]) -> frozenset[Cell]:
    """The cells and, beyond each facet of their boundary, a ghost."""
    cells = {_canonical(cell) for cell in cells}
    rim = boundary(cells)
    ghosts = {
        _canonical(_turned(new))
        for cell in cells
        for v, new in zip(cell, _replaced(cell, GHOST))
        if frozenset(cell) - {v} in rim
    }
    return frozenset(cells | ghosts)


def first_simplex(points: Points) -> Cell:
    """The first point, and each next one that is independent of those taken, positively oriented."""
    exact = exact_points(points)
    dimension = len(exact[0])
    chosen = [0]
    basis: dict[int, list[Fraction]] = {}  # pivot column -> row, as in Gaussian elimination
    for v, p in enumerate(exact):
        row = [x - y for x, y in zip(p, exact[0])]
        for k, other in basis.items():
            row = [x - row[k] / other[k] * y for x, y in zip(row, other)]
        if any(row):
            basis[next(k for k, x in enumerate(row) if x)] = row
            chosen.append(v)
        if len(chosen) == dimension + 1:
            cell = tuple(chosen)
            return _canonical(cell if orient([exact[u] for u in cell]) > 0 else _turned(cell))
    raise DegenerateInputError(
        f"all {len(exact)} points lie in a flat of dimension {len(basis)}, not {dimension}: add points",
        len(basis),
    )


def exact_points(points: Points) -> list[tuple[Fraction, ...]]:
    """The points as tuples of rationals: every finite double is one."""
    try:
        exact = [tuple(Fraction(x.item() if hasattr(x, "item") else x) for x in p) for p in points]
    except (ValueError, OverflowError) as error:
        raise InputError(f"a coordinate is not a finite number ({error}); drop such points") from error
    if not exact or any(len(p) != len(exact[0]) for p in exact) or not exact[0]:
        raise InputError("points must be given as n >= 1 rows of the same d >= 1 numbers")
    return exact


def planar_sites(points: Points) -> list[tuple[Fraction, ...]]:
    """The exact points of the plane, all different: what planar methods take."""
    sites = exact_points(points)
    if len(sites[0]) != 2:
        raise InputError("this method is for the plane: give points of two numbers")
    if len(set(sites)) < len(sites):
        raise InputError("two points are equal: remove the copies first")
    return sites


def _replaced(cell: Cell, vertex: int) -> list[Cell]:
    """The cell with each of its vertices in turn replaced by ``vertex``."""
    return [(*cell[:k], vertex, *cell[k + 1 :]) for k in range(len(cell))]


def _turned(cell: Cell) -> Cell:
    """The cell in the other orientation."""
    return (cell[1], cell[0], *cell[2:])


def _canonical(cell: Cell) -> Cell:
    """The one name of an oriented cell: ascending, but for the last two where the orientation asks for it."""
    odd = sum(a > b for k, a in enumerate(cell) for b in cell[k + 1 :]) % 2
    *head, a, b = sorted(cell)
    return (*head, b, a) if odd else (*head, a, b)
