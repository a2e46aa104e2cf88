"""Constrained Delaunay triangulation, told plainly: one segment after the other (section 2.5 of the book).

A triangulation is a set of counterclockwise triangles (u, v, w), each written with its least vertex
first; a segment is a pair of vertices. ``apex[u, v]`` is the corner of the triangle on the left of u -> v.

Sources: D. T. Lee, A. K. Lin, Generalized Delaunay triangulation for planar graphs, Discrete &
Computational Geometry 1 (1986) 201-217; M. V. Anglada, An improved incremental algorithm for
constructing restricted Delaunay triangulations, Computers & Graphics 21 (1997) 215-223.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from unstruct.base.errors import MeshError
from unstruct.plain.bowyer_watson import triangulate
from unstruct.plain.lawson import triangle
from unstruct.plain.predicates import in_sphere, orient

__all__ = [
    "Passage", "constrained_delaunay", "fill", "insert_segment", "inside", "is_constrained_delaunay",
    "march", "on_segment", "sees",
]  # fmt: skip

Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]
Edge = tuple[int, int]
Apex = dict[Edge, int]
Walls = Iterable[frozenset[int]]
March = tuple[list[Triangle], list[int], list[int]]


@dataclass(frozen=True)
class Passage:
    """One segment between vertices with no vertex on it: which triangles went, and which came."""

    ends: Edge
    crossed: tuple[Triangle, ...]  # in the order in which the segment meets them
    above: tuple[int, ...]  # from one end to the other along the left side; empty where the edge was there
    below: tuple[int, ...]  # the same along the right side
    came: tuple[Triangle, ...]
    cells: frozenset[Triangle]  # all triangles afterwards


def constrained_delaunay(points: Points, segments: Iterable[Edge]) -> tuple[frozenset[Triangle], set[Edge]]:
    """The constrained Delaunay triangulation of the convex hull, and the parts of the segments in it.

    Raises
    ------
    MeshError
        For segments that cross.
    """
    cells = frozenset(triangle(*cell) for cell in triangulate(points))
    parts: set[Edge] = set()
    for a, b in segments:
        for passage in insert_segment(points, cells, parts, a, b):
            cells = passage.cells
            parts.add(passage.ends)
    return cells, parts


def insert_segment(
    points: Points, cells: Iterable[Triangle], fixed: Iterable[Edge], a: int, b: int
) -> list[Passage]:
    """Make ab an edge, or a chain of edges where vertices lie on it; one passage for each of them.

    Raises
    ------
    MeshError
        Where ab crosses one of the ``fixed`` edges.
    """
    passages = []
    closed = {frozenset(edge) for edge in fixed}
    cells = frozenset(cells)
    for u, v in pairwise(on_segment(points, cells, a, b)):
        apex = {edge: w for cell in cells for edge, w in corners(cell)}
        if (u, v) in apex or (v, u) in apex:
            passages.append(Passage((u, v), (), (), (), (), cells))
            continue
        crossed, above, below = march(points, apex, closed, u, v)
        came = [triangle(*cell) for cell in fill(points, above) + fill(points, below[::-1])]
        cells = cells - set(crossed) | set(came)
        passages.append(Passage((u, v), tuple(crossed), tuple(above), tuple(below), tuple(came), cells))
    return passages


def on_segment(points: Points, cells: Iterable[Triangle], a: int, b: int) -> list[int]:
    """The vertices on the closed segment ab, from a to b."""
    low, high = sorted([tuple(points[a]), tuple(points[b])])
    vertices = {v for cell in cells for v in cell}
    line = [
        v
        for v in vertices - {a, b}
        if low < tuple(points[v]) < high and orient([points[a], points[b], points[v]]) == 0
    ]
    line.sort(key=lambda v: tuple(points[v]), reverse=tuple(points[a]) > tuple(points[b]))
    return [a, *line, b]


def march(points: Points, apex: Apex, closed: Walls, a: int, b: int) -> March:
    """The triangles that ab crosses, and the vertices above and below it."""

    def side(v: int) -> int:
        return 0 if v == b else orient([points[a], points[b], points[v]])

    around = (edge for edge, corner in apex.items() if corner == a)
    right, left = next(edge for edge in around if side(edge[0]) < 0 < side(edge[1]))
    above, below, crossed = [a, left], [a, right], [triangle(a, right, left)]
    while True:
        if frozenset((left, right)) in closed:
            other = tuple(sorted((left, right)))
            raise MeshError(f"segment {(a, b)} crosses segment {other}")
        corner = apex[left, right]
        crossed.append(triangle(left, right, corner))
        if side(corner) >= 0:
            above.append(corner)
        if side(corner) <= 0:
            below.append(corner)
        if corner == b:
            return crossed, above, below
        left, right = (corner, right) if side(corner) > 0 else (left, corner)


def fill(points: Points, chain: Sequence[int]) -> list[Triangle]:
    """The triangles of the polygon on the left of chain[0] -> chain[-1]."""
    if len(chain) == 2:
        return []
    a, b, k = chain[0], chain[-1], 1
    for i in range(2, len(chain) - 1):
        if in_sphere([points[a], points[b], points[chain[k]]], points[chain[i]]) > 0:
            k = i
    first, last = fill(points, chain[: k + 1]), fill(points, chain[k:])
    return [(a, b, chain[k]), *first, *last]


def corners(t: Sequence[int]) -> list[tuple[Edge, int]]:
    """Each directed edge of a triangle with the corner on its left."""
    u, v, w = t
    return [((u, v), w), ((v, w), u), ((w, u), v)]


# --- the definitions ------------------------------------------------------------------------------


def inside(points: Points, facets: Iterable[Edge], cell: Triangle) -> bool:
    """Whether an odd number of facets separates the centroid of a triangle from infinity."""
    x, y = (sum(Fraction(points[v][k]) for v in cell) / 3 for k in (0, 1))
    odd = False
    for a, b in facets:
        low, high = sorted([points[a], points[b]], key=lambda p: p[1])
        if low[1] <= y < high[1] and orient([low, high, (x, y)]) > 0:
            odd = not odd
    return odd


def is_constrained_delaunay(points: Points, cells: Iterable[Triangle], segments: Iterable[Edge]) -> bool:
    """The definition: no circle of a triangle holds a vertex that sees some of the triangle's inside."""
    cells, segments = set(cells), list(segments)
    vertices = {v for cell in cells for v in cell}
    return not any(
        in_sphere([points[v] for v in cell], points[q]) > 0 and sees(points, segments, q, cell)
        for cell in cells
        for q in vertices - set(cell)
    )


def sees(points: Points, segments: Sequence[Edge], q: int, cell: Triangle) -> bool:
    """Whether vertex q, outside the triangle, sees some inner point of it past the opaque segments.

    From q the triangle fills an angle. Between two neighboring directions in it towards ends of segments or
    corners nothing changes: one ray in each gap tells.
    """
    right, left = view(points, q, cell)
    stops = {Fraction(0), Fraction(1)}
    for v in {v for edge in segments for v in edge} | set(cell):
        d = minus(points[v], points[q])
        to_right, to_left = cross(right, d), cross(d, left)
        if to_right > 0 and to_left > 0:
            stops.add(to_right / (to_right + to_left))  # of the way from right to left
    for s, t in pairwise(sorted(stops)):
        m = (s + t) / 2
        ray = tuple((1 - m) * x + m * y for x, y in zip(right, left))
        entry = min(hits(points, q, ray, [(cell[k - 1], cell[k]) for k in range(3)]))
        if all(wall > entry for wall in hits(points, q, ray, segments)):
            return True
    return False


def view(points: Points, q: int, cell: Triangle) -> tuple[Any, Any]:
    """The directions from q to the rightmost and to the leftmost corner of a triangle without q."""
    rays = [minus(points[v], points[q]) for v in cell]
    right = next(r for r in rays if all(cross(r, other) >= 0 for other in rays))
    left = next(r for r in rays if all(cross(r, other) <= 0 for other in rays))
    return right, left


def hits(points: Points, q: int, ray: Any, segments: Iterable[Edge]) -> list[Fraction]:
    """How far along a ray from q it meets the segments that it meets."""
    found = []
    for u, v in segments:
        start, along = minus(points[u], points[q]), minus(points[v], points[u])
        if (turn := cross(ray, along)) != 0:
            far, part = cross(start, along) / turn, cross(start, ray) / turn
            if far > 0 and 0 <= part <= 1:
                found.append(far)
    return found


def minus(p: Sequence[Any], q: Sequence[Any]) -> tuple[Fraction, Fraction]:
    """The vector from q to p, exactly."""
    return Fraction(p[0]) - Fraction(q[0]), Fraction(p[1]) - Fraction(q[1])


def cross(p: Sequence[Fraction], q: Sequence[Fraction]) -> Fraction:
    """Twice the signed area between two vectors."""
    return p[0] * q[1] - p[1] * q[0]
