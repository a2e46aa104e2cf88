"""The Dirichlet tessellation of the plane by its definition (section 2.1 of the book).

The cell of a site is what remains of the plane when, for every other site, the half-plane that lies
nearer to that one is cut away. An unbounded cell would need corners at infinity; instead a *window* is
laid round all corners that the diagram can have, and a cell is unbounded where it keeps a side of it.

A cell is a tuple of sides, counterclockwise; a side is (start, beyond): the vertex where it starts, and
the number of the site beyond it, or None for a side of the window.

Source: G. L. Dirichlet, J. reine angew. Math. 40 (1850) 209-227; G. Voronoi, ibid. 134 (1908) 198-287.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

from unstruct.base.errors import InputError

__all__ = [
    "area",
    "circumcenter",
    "corners",
    "cut",
    "dirichlet",
    "dirichlet_cell",
    "exact_sites",
    "neighbors",
    "window_around",
]

Point = tuple[Fraction, Fraction]
Side = tuple[Point, int | None]
Cell = tuple[Side, ...]


def dirichlet(sites: Sequence[Sequence[Any]], window: Sequence[Sequence[Any]] | None = None) -> list[Cell]:
    """The cells of all sites, in their order.

    Parameters
    ----------
    sites : n pairs of finite numbers
        Equal sites have equal cells.
    window : vertices of a convex polygon, counterclockwise, optional
        Where to cut unbounded cells; by default a square round all corners of the diagram.

    Returns
    -------
    list of cells
        An empty tuple where a cell misses the window.

    Notes
    -----
    n - 1 cuts a cell, O(n^2) in all (the default window O(n^3)), in rational arithmetic: made to be read.
    """
    exact = exact_sites(sites)
    frame = window_around(exact) if window is None else exact_sites(window)
    return [dirichlet_cell(exact, i, frame) for i in range(len(exact))]


def dirichlet_cell(sites: Sequence[Point], i: int, window: Iterable[Point]) -> Cell:
    """The part of the window that is as near to site i as to any other."""
    cell: Cell = tuple((vertex, None) for vertex in window)
    for j in range(len(sites)):
        if j != i:
            cell = cut(cell, sites[i], sites[j], j)
    return cell


def cut(cell: Cell, p: Point, q: Point, beyond: int) -> Cell:
    """What is as near to p as to q, of a convex cell; a new side has q ``beyond``."""
    kept: list[Side] = []
    for k, (start, side) in enumerate(cell):
        end = cell[(k + 1) % len(cell)][0]
        f, g = _excess(start, p, q), _excess(end, p, q)
        if f > 0 or (f == 0 and g >= 0):
            kept.append((start, side))
        elif f == 0:  # the cell is left through a vertex, where the new side starts
            kept.append((start, beyond))
        if f * g < 0:
            t = f / (f - g)
            x = start[0] + t * (end[0] - start[0])
            crossing = (x, start[1] + t * (end[1] - start[1]))
            kept.append((crossing, beyond if f > 0 else side))
    return tuple(kept) if len(kept) > 2 else ()


def _excess(x: Point, p: Point, q: Point) -> Fraction:
    """|x - q|^2 - |x - p|^2, linear in x: positive where x is nearer to p."""
    dx, dy = p[0] - q[0], p[1] - q[1]
    return dx * (2 * x[0] - p[0] - q[0]) + dy * (2 * x[1] - p[1] - q[1])


def window_around(sites: Sequence[Point]) -> list[Point]:
    """A square with all sites, and all points equidistant from three of them, strictly inside."""
    reach = max(abs(x) for site in sites for x in site)
    for triple in combinations(sites, 3):
        center = circumcenter(*triple)
        if center is not None:
            reach = max(reach, abs(center[0]), abs(center[1]))
    r = 2 * reach + 1
    return [(-r, -r), (r, -r), (r, r), (-r, r)]


def circumcenter(a: Point, b: Point, c: Point) -> Point | None:
    """The point equidistant from three points; None where they are collinear."""
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    twice = 2 * (ux * vy - uy * vx)
    if twice == 0:
        return None
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    return a[0] + (u * vy - v * uy) / twice, a[1] + (v * ux - u * vx) / twice


def neighbors(cells: Sequence[Cell]) -> set[frozenset[int]]:
    """The contiguous pairs: sites whose cells have a side in common."""
    return {frozenset((i, j)) for i, cell in enumerate(cells) for _, j in cell if j is not None}


def corners(cells: Sequence[Cell]) -> set[Point]:
    """The corners of the diagram: those vertices of the cells that are not made by the window."""
    return {
        start
        for cell in cells
        for k, (start, beyond) in enumerate(cell)
        if beyond is not None and cell[k - 1][1] is not None
    }


def area(cell: Cell) -> Fraction:
    """The area inside a cell, by the shoelace formula."""
    ring = [start for start, _ in cell]
    twice = sum(
        (a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:] + ring[:1], strict=True)), start=Fraction(0)
    )
    return twice / 2


def exact_sites(sites: Sequence[Sequence[Any]]) -> list[Point]:
    """The sites as pairs of rational numbers.

    Raises
    ------
    InputError
        Where there is no site, or one is not a pair of finite numbers.
    """
    found: list[Point] = []
    for k, site in enumerate(sites):
        try:
            x, y = (Fraction(c.item() if hasattr(c, "item") else c) for c in site)
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"site {k} is {site!r}, not a pair of finite numbers; mend or drop it") from None
        found.append((x, y))
    if not found:
        raise InputError("no sites: give at least one pair of numbers")
    return found
