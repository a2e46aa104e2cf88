"""The advancing-front Delaunay method in space, told plainly (section 3.5 of the book).

Points and the triangles of a boundary are given. The oldest face abc of the front gets the tetrahedron abcd
whose sphere has no other vertex inside, of those that are *visible* from abc. A vertex is visible if the
solid tetrahedron passes all tests of the classical front. The front changes as there.

Of several vertices on one sphere the first one in an order is taken that is the same for all faces: that of
heights |x|^2 which are a little larger, much less for each vertex than for the next one. If any would do, as
in the plane, the cells of two faces could claim both diagonals of a square.

A face may have no visible vertex at all, as those of Schönhardt's prism: it stays at the front. And a cell
may have a vertex in its sphere that only other faces see: then there is no constrained Delaunay
tetrahedralization. If there is one, it is found; for the proof see the book.

Source: the source chapter, 12.3.4; J. R. Shewchuk, Symposium on Computational Geometry (1998) 76-85.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from unstruct.plain.advancing_front_space import (
    SPACE_TESTS,
    FrontInSpace,
    front_of,
    is_behind_face,
    without_cell,
)
from unstruct.plain.predicates import in_sphere, orient
from unstruct.plain.space_places import Face

__all__ = ["CellInSpace", "apex_in_space", "front_delaunay_in_space", "is_first", "is_visible", "sphere_sign"]


@dataclass(frozen=True)
class CellInSpace:
    """One step: face, apex, other visible vertices on the sphere, hidden ones inside, the front."""

    face: Face
    apex: int
    cospherical: tuple[int, ...]
    hidden: tuple[int, ...]
    front: tuple[Face, ...]  # afterwards


def front_delaunay_in_space(
    points: Sequence[Sequence[Any]],
    faces: Iterable[Sequence[int]],
    *,
    loose: Iterable[int] = (),
    threads: Iterable[tuple[int, int]] = (),
) -> Iterator[CellInSpace]:
    """Cell by cell from the boundary inward, until no face at the front has an apex.

    Parameters
    ----------
    points : n points of three numbers
        The vertices of the boundary and those inside; others are left out.
    faces : triples of indices
        The first front: what is to be meshed is ahead of each.
    loose, threads : indices, pairs of indices
        Vertices inside that are on no face, and inner segments.
    """
    front = front_of(points, faces, loose, threads)
    while (face := next((one for one in front.faces if one not in front.stuck), None)) is not None:
        d = apex_in_space(front, face)
        if d is None:
            front.stuck.add(face)  # for ever, since what is not meshed only shrinks
            continue
        others = sorted(front.vertices() - {*face, d})
        ahead = [v for v in others if not is_behind_face(front, (*face, v))]
        ties = tuple(v for v in ahead if sphere_sign(front, face, d, v) == 0 and is_visible(front, face, v))
        hidden = tuple(v for v in ahead if sphere_sign(front, face, d, v) > 0)
        without_cell(front, (*face, d))
        yield CellInSpace(face, d, ties, hidden, tuple(front.faces))


def apex_in_space(front: FrontInSpace, face: Face) -> int | None:
    """The visible vertex whose sphere has no other visible one inside; or None."""
    best = None
    for v in sorted(front.vertices() - set(face)):
        if is_visible(front, face, v):
            if best is None or is_first(front, face, v, best):
                best = v
    return best


def is_visible(front: FrontInSpace, face: Face, v: int) -> bool:
    """Whether the tetrahedron of a face and a vertex passes all tests."""
    return not any(fails(front, (*face, v)) for fails in SPACE_TESTS.values())


def sphere_sign(front: FrontInSpace, face: Face, d: int, v: int) -> int:
    """Whether v is inside the sphere of a face and d (1), on it (0), or outside (-1)."""
    return in_sphere([front.points[w] for w in (*face, d)], front.points[v])


def is_first(front: FrontInSpace, face: Face, v: int, d: int) -> bool:
    """Whether v comes before d, both ahead of a face, where the last vertex has the largest height.

    On one sphere, v is the sum of a, b, c, d times its barycentric coordinates. So it is inside if its height
    is less than that sum of heights; the sign is that of the last vertex in it.
    """
    sign = sphere_sign(front, face, d, v)
    if sign != 0:
        return sign > 0
    cell = (*face, d)
    for last in sorted((*cell, v), reverse=True):
        if last == v:
            return False
        weight = orient([front.points[v if w == last else w] for w in cell])
        if weight != 0:
            return weight > 0
    raise AssertionError("v is ahead of the face")
