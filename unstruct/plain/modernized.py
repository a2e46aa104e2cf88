"""Insertion into an arbitrary triangulation: Baker's form of Bowyer-Watson (section 2.2b of the book).

A triangulation is a set of cells, a cell a tuple of d + 1 vertex numbers in positive orientation. It
covers the convex hull of its vertices, but need not be Delaunay: so the cells whose spheres hold the new
point may fall into several pieces, and the piece around the point need not be star-shaped.

Source: T. J. Baker, Automatic mesh generation for complex three-dimensional regions using a constrained
Delaunay triangulation, Engineering with Computers 5 (1989) 161-175.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from unstruct.base.errors import InputError, MeshError
from unstruct.plain.bowyer_watson import Cell, Facet, Points, boundary, exact_points
from unstruct.plain.predicates import in_sphere, orient

__all__ = ["Step", "generalized_cavity", "hidden", "insert", "principal_component", "star"]


@dataclass(frozen=True)
class Step:
    """One insertion. At an earlier vertex everything but ``cells`` is empty."""

    vertex: int
    holders: frozenset[Cell]  # the closed cells that hold the point
    cavity: frozenset[Cell]  # B(P): all cells whose open ball holds the point
    component: frozenset[Cell]  # its piece around the point, joined through facets
    spared: tuple[tuple[Cell, Facet], ...]  # the reductions, in order: a cell that stays, its hidden facet
    deleted: frozenset[Cell]  # the component after the reductions: the cells that go
    star: frozenset[Cell]  # the cells that come
    cells: frozenset[Cell]  # all cells afterwards


def insert(
    points: Points,
    cells: Iterable[Cell],
    vertex: int,
    *,
    reduce: bool = True,
) -> Step:
    """Insert one vertex into any triangulation of the convex hull of other vertices.

    Raises
    ------
    InputError
        Where no cell holds the vertex.
    MeshError
        With ``reduce=False``, where a facet of the component is hidden from the vertex.
    """
    exact = exact_points(points)
    nothing: frozenset[Cell] = frozenset()
    cells = frozenset(tuple(cell) for cell in cells)
    holders = frozenset(cell for cell in cells if holds(exact, cell, vertex))
    if not holders:
        raise InputError(f"vertex {vertex} is outside: choose a point of the hull")
    if any(exact[v] == exact[vertex] for cell in holders for v in cell):
        return Step(vertex, nothing, nothing, nothing, (), nothing, nothing, cells)
    cavity = generalized_cavity(exact, cells, vertex)
    component = deleted = principal_component(cavity, holders)
    spared: tuple[tuple[Cell, Facet], ...] = ()
    while behind := hidden(exact, cells, deleted, vertex):
        if not reduce:
            what = f"facet {sorted(behind[0][1])} is hidden from vertex {vertex}"
            raise MeshError(f"{what}: allow reduction")
        spared += (behind[0],)
        deleted = principal_component(deleted - {behind[0][0]}, holders)
    new = star(exact, deleted, vertex)
    done = (cells - deleted) | new
    return Step(vertex, holders, cavity, component, spared, deleted, new, done)


def holds(points: Points, cell: Cell, vertex: int) -> bool:
    """Is the vertex in the closed cell?"""
    return all(orient([points[v] for v in side]) >= 0 for side, _ in joined(cell, vertex))


def generalized_cavity(points: Points, cells: Iterable[Cell], vertex: int) -> frozenset[Cell]:
    """B(P): the cells whose open circumsphere holds the vertex."""
    return frozenset(c for c in cells if in_sphere([points[v] for v in c], points[vertex]) > 0)


def principal_component(
    cavity: Iterable[Cell],
    holders: Iterable[Cell],
) -> frozenset[Cell]:
    """The cells of the cavity that are reached from the holders through facets."""
    cavity, reached = set(cavity), set(holders)
    while True:
        facets = {frozenset(cell) - {v} for cell in reached for v in cell}
        rest = cavity - reached
        more = {c for c in rest if any(frozenset(c) - {v} in facets for v in c)}
        if not more:
            return frozenset(reached)
        reached |= more


def hidden(
    points: Points, cells: Iterable[Cell], component: frozenset[Cell], vertex: int
) -> list[tuple[Cell, Facet]]:
    """The facets of the component that the vertex does not see from within, each with its cell.

    A facet whose plane contains the vertex is hidden, too, unless it lies on the hull: then it is left out.
    """
    rim, hull = boundary(component), boundary(cells)
    found = []
    for cell in sorted(component):
        for side, facet in joined(cell, vertex):
            sign = orient([points[v] for v in side])
            if facet in rim and (sign < 0 or (sign == 0 and facet not in hull)):
                found.append((cell, facet))
    return found


def star(points: Points, component: frozenset[Cell], vertex: int) -> frozenset[Cell]:
    """The facets of the component joined to the vertex, but for flat cells (the vertex on the hull)."""
    rim = boundary(component)
    pairs = [pair for cell in component for pair in joined(cell, vertex)]
    return frozenset(new for new, facet in pairs if facet in rim and orient([points[v] for v in new]) > 0)


def joined(cell: Cell, vertex: int) -> list[tuple[Cell, Facet]]:
    """Each facet of the cell: the cell with the opposite corner moved to the vertex, and the facet."""
    return [((*cell[:k], vertex, *cell[k + 1 :]), frozenset(cell) - {cell[k]}) for k in range(len(cell))]
