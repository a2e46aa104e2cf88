"""Refilling a cavity of tetrahedra, and the recovery of an edge by it (section 2.8b of the book).

A tetrahedron is a tuple of four vertices with positive orientation. Its faces are triples, seen from within
and written with their least vertex first; a face and its reverse are the two sides of one triangle.

**Theorem.** Positively oriented tetrahedra whose faces cancel to the walls of a cavity triangulate it. So
`refills` only has to see to it that faces cancel: it never asks whether two tetrahedra overlap.

Source: P.-L. George, H. Borouchaki, Back to edge flips in 3 dimensions, Proc. 12th International Meshing
Roundtable (2003), for flips that a refill contains as special cases.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import islice
from typing import Any, NamedTuple

from unstruct.plain.predicates import orient

__all__ = [
    "RecoveryStep",
    "cavities",
    "faces_of",
    "fewest_in_the_way",
    "in_the_way",
    "meets",
    "recover_edge",
    "recovery_steps",
    "refills",
    "walls_of",
]

Points = Sequence[Sequence[Any]]
Face = tuple[int, int, int]
Cell = tuple[int, int, int, int]
Cells = frozenset[Cell]


class RecoveryStep(NamedTuple):
    """One step of a recovery: the cells that go, those that come, and all cells after it."""

    cavity: Cells
    refill: Cells
    cells: Cells


def faces_of(cell: Cell) -> frozenset[Face]:
    """The four faces of a tetrahedron: each, followed by the fourth vertex, is positively oriented."""
    a, b, c, d = cell
    return frozenset(map(_turned, [(b, d, c), (a, c, d), (a, d, b), (a, b, c)]))


def walls_of(cells: Iterable[Cell]) -> frozenset[Face]:
    """The faces of cells that do not cancel."""
    faces = {face for cell in cells for face in faces_of(cell)}
    return frozenset(face for face in faces if _reverse(face) not in faces)


def refills(
    points: Points,
    open_faces: frozenset[Face],
    closed: frozenset[Face] | None = None,
    inner: Iterable[int] = (),
) -> Iterator[Cells]:
    """Each triangulation, once, of what the open faces bound.

    Its vertices are theirs and any of ``inner``. A face that must be there is open in
    both orientations. A face is closed when its inner side is occupied.
    """
    if closed is None:
        closed = frozenset(map(_reverse, open_faces)) - open_faces
    if not open_faces:
        yield frozenset()
        return
    face = min(open_faces)
    vertices = {v for other in open_faces | closed for v in other} | set(inner)
    for apex in sorted(vertices - set(face)):
        cell = (*face, apex)
        served = faces_of(cell)
        if orient([points[v] for v in cell]) <= 0 or served & closed:
            continue
        opened = frozenset(map(_reverse, served - open_faces))
        still_open = open_faces - served | opened
        for rest in refills(points, still_open, closed | served, inner):
            yield rest | {cell}


def recover_edge(points: Points, cells: Iterable[Cell], a: int, b: int, most: int = 8) -> Cells | None:
    """Make ab an edge by refills that lower the number of faces in its way.

    None where these get stuck, or where ab leaves the cells.
    """
    cells = frozenset(cells)
    for step in recovery_steps(points, cells, a, b, most):
        cells = step.cells
    return cells if any({a, b} <= set(cell) for cell in cells) else None


def recovery_steps(
    points: Points, cells: Iterable[Cell], a: int, b: int, most: int = 8
) -> Iterator[RecoveryStep]:
    """Refills that lower the number of faces in the way of ab, while there are any.

    Only cavities of at most ``most`` vertices are tried, and only some of them.
    """
    cells = frozenset(cells)
    while way := in_the_way(points, cells, a, b):
        for cavity in cavities(cells, way, most):
            best = fewest_in_the_way(points, cavity, a, b)
            changed = cells - cavity | best
            if len(in_the_way(points, changed, a, b)) < len(way):
                cells = changed
                yield RecoveryStep(cavity, best, cells)
                break
        else:
            return


def fewest_in_the_way(points: Points, cavity: Cells, a: int, b: int) -> Cells:
    """The refill of a cavity with the fewest faces in the way of ab, on all vertices.

    Of the first 200 refills; the cavity itself if none of these uses all vertices.
    """

    def cost(new: Cells) -> int:
        return len(in_the_way(points, new, a, b))

    used = {v for cell in cavity for v in cell}
    found = islice(refills(points, walls_of(cavity), inner=used), 200)
    whole = [new for new in found if {v for cell in new for v in cell} == used]
    return min(whole, key=cost, default=cavity)


def in_the_way(points: Points, cells: Iterable[Cell], a: int, b: int) -> set[Face]:
    """The faces that the open segment ab meets, from one side or from both."""
    return {face for cell in cells for face in faces_of(cell) if meets(points, a, b, face)}


def meets(points: Points, a: int, b: int, face: Face) -> bool:
    """Whether the open segment ab meets the triangle, without being an edge of it."""
    if {a, b} <= set(face):
        return False
    above, below = _side(points, *face, a), _side(points, *face, b)
    if above == below == 0:
        return _meets_in_plane(points, a, b, face)
    if above * below >= 0:
        return False
    u, v, w = face
    signs = {_side(points, a, b, u, v), _side(points, a, b, v, w), _side(points, a, b, w, u)}
    return not {-1, 1} <= signs


def _meets_in_plane(points: Points, a: int, b: int, face: Face) -> bool:
    """The same in the plane of the face, in a projection in which it is a triangle.

    The part of the segment from p to q that is on the inner side of all edges: from p + low (q - p) to
    p + high (q - p).
    """
    rows = [[Fraction(x) for x in points[v]] for v in (*face, a, b)]
    flat = next(f for f in ([row[:k] + row[k + 1 :] for row in rows] for k in range(3)) if _area(*f[:3]) != 0)
    p, q, turn = flat[3], flat[4], _area(*flat[:3])
    low, high = Fraction(0), Fraction(1)
    for i in range(3):
        start, end = (_area(flat[i], flat[(i + 1) % 3], x) * turn for x in (p, q))
        if start < 0 and end < 0:
            return False
        if start < 0 <= end:
            low = max(low, start / (start - end))
        if end < 0 <= start:
            high = min(high, start / (start - end))
    return low <= high and low < 1 and high > 0


def _area(p: Sequence[Fraction], q: Sequence[Fraction], r: Sequence[Fraction]) -> Fraction:
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def cavities(cells: Cells, way: set[Face], most: int) -> Iterator[Cells]:
    """Sets of cells that hang together, with the two cells at a face in the way; small ones first."""
    owner = {face: cell for cell in cells for face in faces_of(cell)}
    waiting = [frozenset({owner[f], owner[_reverse(f)]}) for f in sorted(way) if _reverse(f) in owner]
    seen = set(waiting)
    while waiting and len(seen) < 3000:
        cavity = waiting.pop(0)
        yield cavity
        for face in sorted(walls_of(cavity)):
            wider = cavity | {owner[_reverse(face)]} if _reverse(face) in owner else cavity
            if wider not in seen and len({v for cell in wider for v in cell}) <= most:
                seen.add(wider)
                waiting.append(wider)


def _side(points: Points, *vertices: int) -> int:
    return 0 if len(set(vertices)) < 4 else orient([points[v] for v in vertices])


def _reverse(face: Face) -> Face:
    return face[0], face[2], face[1]


def _turned(face: Face) -> Face:
    k = face.index(min(face))
    return face[k], face[(k + 1) % 3], face[(k + 2) % 3]
