"""The classical advancing front in space, told plainly (section 3.5 of the book).

The front is a set of oriented triangles; what is not meshed is ahead of each, where orient(a, b, c, x) > 0.
An inner facet counts twice, once for each side. Loose vertices are at the front until a cell reaches them;
inner segments are in the way of cells of which they are no edges. A step takes the first face abc, and puts
the ideal point X ahead of it. The vertices of the front within a sphere about the barycenter M of abc, and X,
are tried in the order of their distance from M. The first one that passes all tests is taken, and the front
changes by the symmetric difference with the faces of the tetrahedron.

In space a valid vertex need not exist, even if all are tried: so a face is put aside, at first for flatter
cells and a point half as high, then for the roundest valid cell with any vertex. If no face has one, the
front is *stuck*. *Theorem.* Then there is no tetrahedron abcd of vertices of the front, on any of its faces
abc, that passes all tests, and what is left has no tetrahedralization without further vertices that contains
all faces of the front (with other diagonals in flat sides it may have one). *Proof.* A vertex that was
refused stays refused: what the tetrahedron overlaps stays meshed, and whatever touches it stays at the front
as long as it is not meshed. A tetrahedralization of what is left has a cell on each face of the front, and
all its cells pass the tests.

Sources: R. Löhner, P. Parikh, International Journal for Numerical Methods in Fluids 8 (1988) 1135-1149; the
source chapter, 12.3.1; E. Schönhardt, Mathematische Annalen 98 (1928) 309-312.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import inf, sqrt
from typing import Any

from unstruct.base.errors import InputError
from unstruct.plain.predicates import orient
from unstruct.plain.space_places import (
    Cell,
    Face,
    Place,
    away,
    clipped,
    determinant3,
    distance_to,
    exact,
    faces_of,
    lowest,
    minus,
    smallest_circle,
)

__all__ = [
    "SPACE_TESTS", "Attempt", "Choice", "FrontInSpace", "advance_in_space", "advancing_front_in_space",
    "by_age", "by_length", "by_size", "front_of", "is_behind_face", "is_crossed",
    "is_holding", "is_overlapping", "point_ahead", "without_cell",
]  # fmt: skip

Size = Callable[[Place], float]
OFF_VERTEX, OFF_FACE = 0.5, 0.22  # times the edges: new points keep these distances from the front
ROUND, ROUND_ASIDE = 0.3, 0.1  # the least quality of a cell with a vertex from the sphere
ASIDE, ANY = 1, 2  # levels of faces that were put aside


@dataclass
class FrontInSpace:
    """What is not meshed: all points, the faces in the order of coming, their levels, what is loose."""

    points: list[Place]
    faces: dict[Face, int]
    loose: set[int] = field(default_factory=set)
    threads: frozenset[tuple[int, int]] = frozenset()
    stuck: set[Face] = field(default_factory=set)
    refused: dict[Face, int] = field(default_factory=dict)  # up to which vertex none serves
    known: int = 0  # how many points there were when the first of these got stuck

    def vertices(self) -> set[int]:
        """All vertices at the front."""
        return {v for face in self.faces for v in face} | self.loose


@dataclass(frozen=True)
class Attempt:
    """A vertex (None: the ideal point), its distance from M, and the test that it fails ("" for none)."""

    vertex: int | None
    distance: float
    verdict: str


@dataclass(frozen=True)
class Choice:
    """One cell: its face, the ideal point, the search, what was tried, what was taken and why, the front."""

    face: Face
    ideal: Place | None
    radius: float
    candidates: tuple[Attempt, ...]
    chosen: int
    reason: str
    front: tuple[Face, ...]  # afterwards


Test = Callable[[FrontInSpace, Cell], bool]
Key = Callable[[FrontInSpace, Face, Size], float]


# --- the orders -----------------------------------------------------------------------------------


def by_size(front: FrontInSpace, face: Face, size: Size) -> float:
    """Where the wanted length is smallest comes first: the rule of the source chapter."""
    return size(barycenter(front, face))


def by_length(front: FrontInSpace, face: Face, size: Size) -> float:
    """The shortest edges come first."""
    a, b, c = (front.points[v] for v in face)
    return away(a, b) + away(b, c) + away(c, a)


def by_age(front: FrontInSpace, face: Face, size: Size) -> float:
    """The face that has waited longest comes first; it also decides between equals of the other orders."""
    return 0.0


# --- the tests ------------------------------------------------------------------------------------


def is_behind_face(front: FrontInSpace, cell: Cell) -> bool:
    """Whether the apex is not strictly ahead of the face."""
    return orient([front.points[v] for v in cell]) <= 0


def is_holding(front: FrontInSpace, cell: Cell) -> bool:
    """Whether the closed tetrahedron holds another vertex of the front."""
    others = front.vertices() - set(cell)
    return any(is_in(front, cell, front.points[v]) for v in others)


def is_crossed(front: FrontInSpace, cell: Cell) -> bool:
    """Whether a face of the front, or an inner segment, is in the way of the cell."""
    barriers = [*front.faces, *front.threads]
    return any(is_overlapping(front, cell, one) for one in barriers)


def is_overlapping(front: FrontInSpace, cell: Cell, other: Sequence[int]) -> bool:
    """Whether a triangle or segment and a cell share more than common corners span.

    It is cut off at the four sides of the positive cell. What is left is spanned by its
    corners, so it is more if one of these is no common corner.
    """
    left: list[Place] = [exact(front.points[v]) for v in other]
    for side in faces_of(cell):
        left = clipped(left, [exact(front.points[v]) for v in side])
    common = {exact(front.points[v]) for v in set(cell) & set(other)}
    return not set(left) <= common


# The tests by the names of what they refuse. Without "contains" and "crosses" a component of the front is
# swallowed: see the book.
SPACE_TESTS: Mapping[str, Test] = {"behind": is_behind_face, "contains": is_holding, "crosses": is_crossed}


# --- the procedure --------------------------------------------------------------------------------


def advancing_front_in_space(
    points: Sequence[Sequence[Any]],
    faces: Iterable[Sequence[int]],
    size: Size,
    *,
    loose: Iterable[int] = (),
    threads: Iterable[tuple[int, int]] = (),
    key: Key = by_size,
    reach: float = 1.5,
    tests: Mapping[str, Test] = SPACE_TESTS,
) -> Iterator[Choice]:
    """Make cells from the boundary inward until the front is empty, or stuck.

    Parameters
    ----------
    points : n points of three numbers
    faces : triples of indices
        The first front: what is to be meshed is ahead of each.
    size : function of a point
        The wanted edge length.
    loose, threads : indices, pairs of indices
        Vertices inside that are on no face, and inner segments.
    key : function of the front, a face and the size
        The face with the lowest value is next; of several, the oldest.
    reach : float
        The radius of the search, in heights of the regular tetrahedron with the edges of the ideal one.
    tests : dict of str to function
        What a cell must pass.

    Raises
    ------
    InputError
        For a ``reach`` that is not positive and finite.
    """
    if not 0 < reach < inf:
        raise InputError(f"reach must be positive and finite, not {reach!r}: it is the radius of the search")
    front = front_of(points, faces, loose, threads)
    while (face := next_face(front, size, key)) is not None:
        step = advance_in_space(front, face, size, reach, tests)
        if step is not None:
            yield step


def next_face(front: FrontInSpace, size: Size, key: Key) -> Face | None:
    """The next face; None if there is none, or all are stuck and there are no new points since."""
    waiting = [one for one in front.faces if one not in front.stuck]
    if not waiting and front.known != len(front.points):
        front.known, front.stuck = len(front.points), set()
        waiting = list(front.faces)
    return min(waiting, key=lambda one: (front.faces[one], key(front, one, size)), default=None)


def advance_in_space(
    front: FrontInSpace,
    face: Face,
    size: Size,
    reach: float,
    tests: Mapping[str, Test],
) -> Choice | None:
    """Make the cell on one face, and change the front; or put the face aside: None."""
    level, n = front.faces[face], len(front.points)
    x, radius = None, 0.0
    if level == ANY:
        found, tried = try_all(front, face, tests)
    else:
        x, edge = point_ahead(front, face, size, 0.5 if level == ASIDE else 1.0)
        radius = reach * edge * sqrt(2 / 3) * (1.5 if level == ASIDE else 1.0)
        found, tried = try_near(front, face, x, edge, radius, tests)
    if found is None:
        put_aside(front, face)
        return None
    reason = ("near vertex", "put aside", "all vertices")[level]
    if found == n and x is not None:
        reason = "new point"
        front.points.append(x)
    without_cell(front, (*face, found))
    return Choice(face, x, radius, tuple(tried), found, reason, tuple(front.faces))


def put_aside(front: FrontInSpace, face: Face) -> None:
    """Let a face wait for another search, or be stuck."""
    if front.faces[face] < ANY:
        front.faces[face] += 1
        return
    if not front.stuck:
        front.known = len(front.points)
    front.stuck.add(face)
    front.refused[face] = len(front.points)


def without_cell(front: FrontInSpace, cell: Cell) -> None:
    """The front after a cell: the symmetric difference with the faces of that."""
    for one in faces_of(cell):
        a, b, c = one
        if one in front.faces:
            del front.faces[one]
            front.stuck.discard(one)
        else:
            front.faces[lowest(a, c, b)] = 0
    front.loose.discard(cell[3])


def try_near(
    front: FrontInSpace, face: Face, x: Place, edge: float, radius: float, tests: Mapping[str, Test]
) -> tuple[int | None, list[Attempt]]:
    """Try the vertices in the sphere and the ideal point, which has the next number, by their distance."""
    m, new, least = barycenter(front, face), len(front.points), ROUND_ASIDE if front.faces[face] else ROUND
    near = {v: away(front.points[v], m) for v in front.vertices() - set(face)}
    near = {v: d for v, d in near.items() if d <= radius} | {new: away(x, m)}
    tried: list[Attempt] = []
    front.points.append(x)  # for the tests only
    for v in sorted(near, key=lambda one: (near[one], one)):
        cell = (*face, v)
        if v == new and is_too_near(front, face, x, edge):
            verdict = "too near"
        else:
            verdict = next((name for name, fails in tests.items() if fails(front, cell)), "")
        if not verdict and v != new and quality(front, cell) < least:
            verdict = "not round"
        tried.append(Attempt(None if v == new else v, near[v], verdict))
        if not verdict:
            break
    front.points.pop()
    return (v if not verdict else None), tried


def try_all(front: FrontInSpace, face: Face, tests: Mapping[str, Test]) -> tuple[int | None, list[Attempt]]:
    """Try all vertices ahead of the face that were not refused before.

    They are tried in wider and wider cubes about M, in each those first whose cells are the roundest.
    """
    m, tried, new = barycenter(front, face), [], front.refused.get(face, 0)
    rest = [v for v in front.vertices() - set(face) if v >= new]
    rest = [v for v in rest if not is_behind_face(front, (*face, v))]
    a, b, c = (front.points[v] for v in face)
    radius = away(a, b) + away(b, c) + away(c, a)
    while rest:
        inside = [v for v in rest if all(abs(x - y) <= radius for x, y in zip(front.points[v], m))]
        for v in sorted(inside, key=lambda one: (-quality(front, (*face, one)), one)):
            verdict = next((name for name, fails in tests.items() if fails(front, (*face, v))), "")
            tried.append(Attempt(v, away(front.points[v], m), verdict))
            if not verdict:
                return v, tried
        rest, radius = [v for v in rest if v not in inside], 2 * radius
    return None, tried


def point_ahead(front: FrontInSpace, face: Face, size: Size, lower: float = 1.0) -> tuple[Place, float]:
    """The ideal point, ``lower`` times as high, and its wanted distance from the corners of the face.

    Its foot is the center of the smallest circle around the face: the circumcenter, or, if an angle is
    obtuse, the middle of the longest edge. The distance is 1.25 to 3.5 times the radius of that circle; the
    wanted length is taken at the height of the center of a regular tetrahedron.
    """
    a, b, c = (front.points[v] for v in face)
    foot, radius = smallest_circle(a, b, c)
    u, v = minus(b, a), minus(c, a)
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    twice = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    unit = (n[0] / twice, n[1] / twice, n[2] / twice)
    up = radius * 0.3535533905932738
    h = size((foot[0] + up * unit[0], foot[1] + up * unit[1], foot[2] + up * unit[2]))
    edge = min(max(h, 1.25 * radius), 3.5 * radius)
    d = lower * sqrt(edge * edge - radius * radius)
    return (foot[0] + d * unit[0], foot[1] + d * unit[1], foot[2] + d * unit[2]), edge


def front_of(
    points: Sequence[Sequence[Any]],
    faces: Iterable[Sequence[int]],
    loose: Iterable[int] = (),
    threads: Iterable[tuple[int, int]] = (),
) -> FrontInSpace:
    """The first front."""
    rows: list[Place] = [(p[0], p[1], p[2]) for p in points]
    return FrontInSpace(
        rows, {lowest(*face): 0 for face in faces}, set(loose), frozenset(threads), known=len(rows)
    )


# --- signs, cells and lengths ---------------------------------------------------------------------


def is_in(front: FrontInSpace, cell: Cell, x: Place) -> bool:
    """Whether a point is in a closed positive cell."""
    return all(orient([*(front.points[v] for v in face), x]) >= 0 for face in faces_of(cell))


def barycenter(front: FrontInSpace, face: Face) -> Place:
    """The barycenter of a face."""
    a, b, c = (front.points[v] for v in face)
    return ((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0)


def quality(front: FrontInSpace, cell: Cell) -> float:
    """6 sqrt(2) volume / (root mean square edge)^3: 1 for a regular tetrahedron, near 0 for a flat one."""
    corners = [front.points[v] for v in cell]
    six = determinant3(*(minus(p, corners[0]) for p in corners[1:]))
    square = sum(away(p, q) ** 2 for p, q in combinations(corners, 2)) / 6.0
    return float(sqrt(2.0) * six / (square * sqrt(square)))


def is_too_near(front: FrontInSpace, face: Face, x: Place, edge: float) -> bool:
    """Whether a vertex, another face or a segment of the front is too near to x."""
    if any(away(front.points[v], x) < OFF_VERTEX * edge for v in front.vertices()):
        return True
    others = [one for one in [*front.faces, *front.threads] if one != face]
    return any(distance_to(x, [front.points[v] for v in one]) < OFF_FACE * edge for one in others)
