"""The classical advancing front, told plainly (section 3.1 of the book).

The front is a set of directed edges; what is not meshed is on the left of each. An inner segment counts
twice, once in each direction. Loose vertices are at the front until a triangle reaches them. A step takes the
first edge AB, and puts the ideal point X ahead of it. The vertices of the front within a circle about the
middle M of AB, and X, are tried in the order of their distance from M. The first one that passes all tests is
taken, and the front changes by the symmetric difference with the sides of the triangle.

A valid vertex always exists, so that the front never sticks in the plane. *Theorem.* If the boundary is valid
and all triangles so far have passed the tests, each edge AB of the front has a vertex C of the front, or a
loose one, such that ABC passes them, too. *Proof.* What is on the left of the front is a polygonal region,
perhaps with holes and loose vertices; no vertex, loose or not, lies inside an edge of the front, since no
triangle had another one on a side. The region has a triangulation without further vertices:
one inserts diagonals between vertices, of which there is one as long as a piece is not an empty triangle.
(Take the leftmost corner v of the piece and its neighbors u and w. Either uw is a diagonal, or the triangle
uvw contains vertices; then the one that is farthest from uw is visible from v.) This triangulation has a
triangle on AB, and its third corner is C. So if the circle has no valid vertex, all vertices of the front are
tried. Only finitely many new points have room, since each keeps a distance from the front. So the number of
steps is finite, too.

Sources: R. Löhner, P. Parikh, International Journal for Numerical Methods in Fluids 8 (1988) 1135-1149; the
source chapter, 12.3.1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf, sqrt
from typing import Any

from unstruct.base.errors import InputError, MeshError
from unstruct.plain.predicates import orient

__all__ = [
    "TESTS", "Candidate", "Front", "Step", "advance", "advancing_front", "boundary_front", "crosses", "holds",
    "ideal_point", "is_behind", "oldest", "parity_left", "shortest", "smallest",
]  # fmt: skip

Point = tuple[Any, Any]
Edge = tuple[int, int]
Size = Callable[[Point], float]
CLEARANCE = 0.45  # times the wanted length: new points keep this distance from the front
ROUND_ENOUGH = 0.3  # the least 2 r / R of a triangle with a vertex from the circle


@dataclass
class Front:
    """What is not meshed: all points, the directed edges in the order of coming, loose vertices."""

    points: list[Point]
    edges: dict[Edge, None]
    loose: set[int]

    def vertices(self) -> set[int]:
        """All vertices at the front."""
        return {v for edge in self.edges for v in edge} | self.loose


@dataclass(frozen=True)
class Candidate:
    """A vertex (None: the ideal point), its distance from M, and the test that it fails ("" for none)."""

    vertex: int | None
    distance: float
    verdict: str


@dataclass(frozen=True)
class Step:
    """One triangle: its edge, the ideal point, the search, what was tried, what was taken and why."""

    edge: Edge
    ideal: Point
    radius: float
    candidates: tuple[Candidate, ...]
    chosen: int
    reason: str
    front: tuple[Edge, ...]  # afterwards


Test = Callable[[Front, Edge, int], bool]


# --- the orders -----------------------------------------------------------------------------------


def smallest(front: Front, edge: Edge, size: Size) -> float:
    """Where the wanted length is smallest comes first: the rule of the source chapter."""
    return size(middle(*ends(front, edge)))


def shortest(front: Front, edge: Edge, size: Size) -> float:
    """The shortest edge comes first."""
    return distance(*ends(front, edge))


def oldest(front: Front, edge: Edge, size: Size) -> float:
    """The edge that has waited longest comes first; it also decides between equals of the other orders."""
    return 0.0


# --- the tests ------------------------------------------------------------------------------------


def is_behind(front: Front, edge: Edge, c: int) -> bool:
    """Whether c is not strictly on the left of the edge."""
    return turn(front, *edge, c) <= 0


def crosses(front: Front, edge: Edge, c: int) -> bool:
    """Whether a new side crosses an edge of the front, or c lies on one."""
    a, b = edge
    for other in front.edges:
        if c not in other and on_segment(front, other, c):
            return True
        if cut(front, (a, c), other) or cut(front, (b, c), other):
            return True
    return False


def holds(front: Front, edge: Edge, c: int) -> bool:
    """Whether the closed triangle holds another vertex of the front."""
    a, b = edge
    sides = [(a, b), (b, c), (c, a)]
    rest = front.vertices() - {a, b, c}
    return any(all(turn(front, *side, v) >= 0 for side in sides) for v in rest)


# The tests by the names of what they refuse. Without "contains" a hole is swallowed: see the book.
TESTS: Mapping[str, Test] = {"behind": is_behind, "crosses": crosses, "contains": holds}


# --- the procedure --------------------------------------------------------------------------------


def advancing_front(
    points: Sequence[Sequence[Any]],
    facets: Iterable[Edge],
    size: Size,
    *,
    inner: Iterable[Edge] = (),
    key: Callable[[Front, Edge, Size], float] = smallest,
    reach: float = 1.5,
    tests: Mapping[str, Test] = TESTS,
) -> Iterator[Step]:
    """March from the boundary inward until the front is empty; one step for each triangle.

    Parameters
    ----------
    points : n points of two numbers
    facets : pairs of indices
        The boundary, even-odd, already cut as the size wants it; the first front.
    size : function of a point
        The wanted edge length.
    inner : pairs of indices
        Segments inside.
    key : function of the front, an edge and the size
        The edge with the lowest value is next; of several, the oldest.
    reach : float
        The radius of the search, in heights of an equilateral triangle with the sides of the ideal one. From
        sqrt(5)/2 = 1.118 on the circle always contains X, since these sides are at most 2 |AB|. X is a
        candidate in any case; with a smaller radius there are fewer others, and more searches are widened.
    tests : dict of str to function
        What a triangle must pass.

    Raises
    ------
    InputError
        For a ``reach`` that is not positive and finite.
    MeshError
        If no vertex passes all tests, which happens only if the boundary crosses itself or a test is missing.
        Then the march may also never end.
    """
    if not 0 < reach < inf:
        raise InputError(f"reach must be positive and finite, not {reach!r}: it is the radius of the search")
    front = boundary_front(points, facets, inner)
    while front.edges:
        edge = min(front.edges, key=lambda one: key(front, one, size))  # the first of several: the oldest
        yield advance(front, edge, size, reach, tests)


def advance(
    front: Front,
    edge: Edge,
    size: Size,
    reach: float,
    tests: Mapping[str, Test],
) -> Step:
    """Make the triangle on one edge, and change the front."""
    x, side = ideal_point(front, edge, size)
    radius = reach * (0.5 * sqrt(3.0)) * side
    found, tried = search(front, edge, x, side, radius, tests)
    reason = "near vertex"
    if found is None:
        found, more = search_wide(front, edge, radius, tests)
        tried, reason = tried + more, "wider search"
    elif found == len(front.points):
        reason = "new point"
        front.points.append(x)
    if found is None:
        raise MeshError(f"no vertex fits the edge {edge}: is the boundary valid?")
    a, b = edge
    for u, v in [(a, found), (found, b)]:  # the symmetric difference with the sides
        if (v, u) in front.edges:
            del front.edges[v, u]
        else:
            front.edges[u, v] = None
    del front.edges[edge]
    front.loose.discard(found)
    return Step(edge, x, radius, tuple(tried), found, reason, tuple(front.edges))


def search(
    front: Front,
    edge: Edge,
    x: Point,
    side: float,
    radius: float,
    tests: Mapping[str, Test],
) -> tuple[int | None, list[Candidate]]:
    """Try the vertices in the circle and the ideal point, in the order of distance.

    The ideal point has the next free number.
    """
    m, new, tried = middle(*ends(front, edge)), len(front.points), []
    near = {v: distance(front.points[v], m) for v in front.vertices() - set(edge)}
    near = {v: d for v, d in near.items() if d <= radius} | {new: distance(x, m)}
    front.points.append(x)  # for the tests only
    found = None
    for v in sorted(near, key=lambda one: (near[one], one)):
        if v == new and is_crowded(front, edge, v, CLEARANCE * side):
            verdict = "too near"
        else:
            failed = (k for k, fails in tests.items() if fails(front, edge, v))
            verdict = next(failed, "")
        if not verdict and v != new and roundness(front, edge, v) < ROUND_ENOUGH:
            verdict = "not round"
        tried.append(Candidate(None if v == new else v, near[v], verdict))
        if not verdict:
            found = v
            break
    front.points.pop()
    return found, tried


def search_wide(
    front: Front, edge: Edge, radius: float, tests: Mapping[str, Test]
) -> tuple[int | None, list[Candidate]]:
    """Try the vertices in wider and wider squares about M by the circumradii of their triangles."""
    m, tried = middle(*ends(front, edge)), []
    left = [v for v in front.vertices() - set(edge) if not is_behind(front, edge, v)]
    while left:
        radius *= 2
        inside = [v for v in left if all(abs(z - w) <= radius for z, w in zip(front.points[v], m))]
        for v in sorted(inside, key=lambda one: (circumradius(front, edge, one), one)):
            verdict = next((name for name, fails in tests.items() if fails(front, edge, v)), "")
            tried.append(Candidate(v, distance(front.points[v], m), verdict))
            if not verdict:
                return v, tried
        left = [v for v in left if v not in inside]
    return None, tried


def ideal_point(front: Front, edge: Edge, size: Size) -> tuple[Point, float]:
    """The point at the wanted distance from both ends, and that distance: .55 to 2 times the edge.

    The wanted length is taken at the center of the equilateral triangle on the edge.
    """
    a, b = ends(front, edge)
    (mx, my), ux, uy, length = middle(a, b), b[0] - a[0], b[1] - a[1], distance(a, b)
    nx, ny = -uy / length, ux / length
    h = size((mx + nx * length / (2 * sqrt(3.0)), my + ny * length / (2 * sqrt(3.0))))
    side = min(max(h, 0.55 * length), 2 * length)
    d = sqrt(side * side - 0.25 * length * length)
    return (mx + nx * d, my + ny * d), side


def boundary_front(points: Sequence[Sequence[Any]], facets: Iterable[Edge], inner: Iterable[Edge]) -> Front:
    """The first front: facets with the inside on their left, inner segments both ways, loose vertices."""
    rows = [(p[0], p[1]) for p in points]
    sides = [(a, b) for a, b in facets]
    edges = {(a, b) if parity_left(rows, sides, (a, b)) else (b, a): None for a, b in sides}
    edges |= {pair: None for a, b in inner for pair in ((a, b), (b, a))}
    used = {v for edge in edges for v in edge}
    loose = {v for v in range(len(rows)) if v not in used and right_parity(rows, sides, rows[v], None)}
    return Front(rows, edges, loose)


# --- signs and lengths ----------------------------------------------------------------------------


def turn(front: Front, u: int, v: int, w: int) -> int:
    """The orientation of three vertices."""
    return orient([front.points[u], front.points[v], front.points[w]])


def cut(front: Front, one: Edge, two: Edge) -> bool:
    """Whether two segments cross in a point that is inside both."""
    (p, q), (s, t) = one, two
    if {p, q} & {s, t}:
        return False
    return turn(front, p, q, s) * turn(front, p, q, t) < 0 and turn(front, s, t, p) * turn(front, s, t, q) < 0


def on_segment(front: Front, edge: Edge, c: int) -> bool:
    """Whether vertex c lies on the segment."""
    low, high = sorted(ends(front, edge))
    return turn(front, *edge, c) == 0 and low <= front.points[c] <= high


def parity_left(points: Sequence[Point], facets: Sequence[Edge], edge: Edge) -> bool:
    """Whether the inside is on the left of a facet, by the others to the right of its lower end."""
    a, b = edge
    up = (points[a][1], points[a][0]) < (points[b][1], points[b][0])
    right = right_parity(points, facets, points[a] if up else points[b], points[b] if up else points[a])
    return right != up


def right_parity(points: Sequence[Point], facets: Sequence[Edge], x: Point, top: Point | None) -> bool:
    """Whether an odd number of facets lies to the right of x; with ``top``, to the right of the segment from
    x to it.

    Of two vertices at the same height the right one counts as higher, so that no facet is level.
    """
    odd = False
    for a, b in facets:
        c, d = sorted((points[a], points[b]), key=lambda p: (p[1], p[0]))
        if (c[1], c[0]) <= (x[1], x[0]) < (d[1], d[0]):
            side = orient([x, d, top]) if c == x and top is not None else orient([c, d, x])
            odd ^= side > 0
    return odd


def ends(front: Front, edge: Edge) -> tuple[Point, Point]:
    """The ends of an edge."""
    return front.points[edge[0]], front.points[edge[1]]


def middle(p: Point, q: Point) -> Point:
    """The middle of two points: the barycenter of an edge."""
    return (0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]))


def distance(p: Point, q: Point) -> float:
    """The distance of two points."""
    dx, dy = q[0] - p[0], q[1] - p[1]
    return sqrt(dx * dx + dy * dy)


def roundness(front: Front, edge: Edge, c: int) -> float:
    """2 r / R of a triangle."""
    a, b = ends(front, edge)
    p, q, r = distance(a, b), distance(b, front.points[c]), distance(front.points[c], a)
    return (q + r - p) * (r + p - q) * (p + q - r) / (p * q * r)


def circumradius(front: Front, edge: Edge, c: int) -> float:
    """The circumradius over the length of the edge, for vertices on its left."""
    (ax, ay), (bx, by), (cx, cy) = *ends(front, edge), front.points[c]
    twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    product = distance((ax, ay), (cx, cy)) * distance((cx, cy), (bx, by))
    return product / twice if twice > 0 else float("inf")


def is_crowded(front: Front, edge: Edge, x: int, least: float) -> bool:
    """Whether a loose vertex or another edge of the front is nearer to x than ``least``."""
    others = [(v, v) for v in front.loose] + [other for other in front.edges if other != edge]
    return any(square_to(front, other, x) < least * least for other in others)


def square_to(front: Front, edge: Edge, x: int) -> float:
    """The squared distance of a vertex from a segment."""
    (ax, ay), (bx, by), (px, py) = *ends(front, edge), front.points[x]
    ux, uy, vx, vy = bx - ax, by - ay, px - ax, py - ay
    square = ux * ux + uy * uy
    part = min(max((ux * vx + uy * vy) / square, 0.0), 1.0) if square > 0 else 0.0
    dx, dy = vx - part * ux, vy - part * uy
    return dx * dx + dy * dy
