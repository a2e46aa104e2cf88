"""The advancing-front Delaunay triangulation, told plainly (section 3.4 of the book).

Points and a boundary are given. The oldest edge AB of the front gets the triangle ABC whose circle has no
other vertex inside, of those that are *visible* from AB. A vertex is visible if it is strictly on the left of
AB and no edge of the front meets the open triangle. The front changes as in `advancing_front`.

Without the word visible there may be no such triangle: from (-5, 0) to (5, 0) with (0, 1) and (0, 8) on the
left and (0, -1), already behind the front, on the right, each circle has another point inside. `apex` with
``visible=False`` shows it.

Of several vertices on one circle the leftmost, lowest one is taken; any would do. What is left is then a
smaller region of the same kind, with a constrained Delaunay triangulation of its own.

Sources: the source chapter, 12.3.4; D. T. Lee, A. K. Lin, Discrete & Computational Geometry 1 (1986) 201-217.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from unstruct.base.errors import MeshError
from unstruct.plain.advancing_front import Edge, Front, boundary_front, turn
from unstruct.plain.predicates import in_sphere

__all__ = ["Cell", "apex", "candidates", "front_delaunay", "is_hidden", "is_inside", "meets"]


@dataclass(frozen=True)
class Cell:
    """One step: edge, apex, other visible vertices on the circle, hidden ones inside, the front."""

    edge: Edge
    apex: int
    cocircular: tuple[int, ...]
    hidden: tuple[int, ...]
    front: tuple[Edge, ...]  # afterwards


def front_delaunay(
    points: Sequence[Sequence[Any]], facets: Iterable[Edge], *, inner: Iterable[Edge] = ()
) -> Iterator[Cell]:
    """Cell by cell from the boundary inward until the front is empty.

    Parameters
    ----------
    points : n points of two numbers
        The vertices of the boundary and those inside; others are left out.
    facets : pairs of indices
        The boundary, even-odd.
    inner : pairs of indices
        Segments inside.

    Raises
    ------
    MeshError
        For an edge without an apex, which happens only if the boundary crosses itself.
    """
    front = boundary_front(points, facets, inner)
    while front.edges:
        edge = next(iter(front.edges))  # the oldest
        c = apex(front, edge)
        if c is None:
            raise MeshError(f"the edge {edge} has no apex: is the boundary valid?")
        left = [v for v in candidates(front, edge) if v != c and is_inside(front, edge, c, v) >= 0]
        ties = tuple(v for v in left if is_inside(front, edge, c, v) == 0 and not is_hidden(front, edge, v))
        hidden = tuple(v for v in left if is_inside(front, edge, c, v) > 0)
        close(front, edge, c)
        yield Cell(edge, c, ties, hidden, tuple(front.edges))


def apex(
    front: Front,
    edge: Edge,
    visible: bool = True,
    behind: Iterable[int] = (),
) -> int | None:
    """The vertex whose circle with the edge has no other vertex inside, or None.

    With ``visible`` only the visible ones count, as apexes and as others. Without
    it, all vertices of the front on the left are tried, and all vertices count as
    others, those given as ``behind`` too.
    """
    left = candidates(front, edge)
    others = sorted((front.vertices() | set(behind)) - set(edge))
    if visible:
        left = others = [v for v in left if not is_hidden(front, edge, v)]
    for c in left:
        if all(v == c or is_inside(front, edge, c, v) <= 0 for v in others):
            return c
    return None


def candidates(front: Front, edge: Edge) -> list[int]:
    """The vertices of the front strictly on the left of the edge, from left to right, from below upward."""
    return [
        v
        for v in sorted(front.vertices() - set(edge), key=front.points.__getitem__)
        if turn(front, *edge, v) > 0
    ]


def is_inside(front: Front, edge: Edge, c: int, v: int) -> int:
    """Whether v is inside the circle of the edge and c (1), on it (0), or outside (-1)."""
    return in_sphere([front.points[w] for w in (*edge, c)], front.points[v])


def is_hidden(front: Front, edge: Edge, c: int) -> bool:
    """Whether an edge of the front meets the open triangle of the edge and c."""
    return any(meets(front, (*edge, c), other) for other in front.edges)


def meets(front: Front, cell: tuple[int, int, int], segment: Edge) -> bool:
    """Whether a segment meets an open counterclockwise triangle.

    Two such convex sets are disjoint if and only if the line through a side of the
    triangle, or through the segment, has them on its two closed sides.
    """
    a, b, c = cell
    for side in ((a, b), (b, c), (c, a)):
        if all(turn(front, *side, v) <= 0 for v in segment):
            return False
    signs = {turn(front, *segment, v) for v in cell}
    return {-1, 1} <= signs


def close(front: Front, edge: Edge, c: int) -> None:
    """Change the front by the symmetric difference with the sides of the triangle."""
    a, b = edge
    for u, v in [(a, c), (c, b)]:
        if (v, u) in front.edges:
            del front.edges[v, u]
        else:
            front.edges[u, v] = None
    del front.edges[edge]
    front.loose.discard(c)
