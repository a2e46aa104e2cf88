"""Divide and conquer for the Delaunay triangulation (cited by the source chapter, 12.6), told plainly.

The sites are sorted from left to right, those on one vertical from below upward, and halved again and again.
Two halves are merged by *cross edges*, one above the other; the lowest is the common tangent of the hulls
from below. Over the last one, the *base*, a circle through its ends grows upward like a bubble. The first
site that it meets is a neighbor of one of the two ends, in the left or in the right half. On each side a
candidate is found, and edges that the bubble cuts on the way to it are deleted; the better candidate gets the
next cross edge. Where neither side has one above the base, the base is the tangent from above, and all is
merged.

Edges are kept in the quad-edge structure. A *directed edge* is a pair (k, r): edge k, turned r quarters
counterclockwise; so (k, 0) and (k, 2) are its two directions, and (k, 1), (k, 3) those of the dual edge.
``next_at`` gives the next directed edge counterclockwise about the same origin. One operation changes it:
`splice` exchanges two entries, and their duals', which joins two rings about a vertex or parts one.

Source: L. Guibas, J. Stolfi, Primitives for the manipulation of general subdivisions and the computation of
Voronoi diagrams, ACM Transactions on Graphics 4 (1985) 74-123.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from unstruct.base.errors import DegenerateInputError
from unstruct.plain.bowyer_watson import planar_sites
from unstruct.plain.lawson import triangle
from unstruct.plain.predicates import in_sphere, orient

__all__ = ["Merge", "QuadEdges", "divide", "divide_and_conquer", "merge", "turned"]

Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]
Quarter = tuple[int, int]  # edge, quarter turns
Pair = tuple[int, int]  # the two ends of an edge
Ends = tuple[Quarter, Quarter]  # from the leftmost vertex along the hull, from the rightmost vertex


@dataclass(frozen=True)
class Merge:
    """One state: a set of two or three sites is done, or a base is found on the way upward."""

    kind: str  # "few" (two or three sites), "tangent" (the first base), "rise" (a next base), "merged"
    sites: tuple[int, ...]  # of this part, from left to right
    base: Pair | None  # its left and its right end
    candidates: tuple[int | None, int | None]  # the sites on the left and right from which the base came
    deleted: tuple[Pair, ...]  # on the way to the candidates
    edges: frozenset[Pair]  # all edges now, of other parts too, the lesser number first


@dataclass
class QuadEdges:
    """The quad-edge structure over exact sites."""

    sites: Sequence[tuple[Fraction, ...]]
    next_at: dict[Quarter, Quarter] = field(default_factory=dict)
    origin: dict[Quarter, int] = field(default_factory=dict)
    made: int = 0  # the edges made so far, those since deleted too

    def make(self, u: int, v: int) -> Quarter:
        """A new edge from u to v, not joined to any other."""
        k, self.made = self.made, self.made + 1
        self.next_at |= {(k, 0): (k, 0), (k, 1): (k, 3), (k, 2): (k, 2), (k, 3): (k, 1)}
        self.origin |= {(k, 0): u, (k, 2): v}
        return k, 0

    def splice(self, a: Quarter, b: Quarter) -> None:
        """Exchange what follows two directed edges, and what follows the duals after them."""
        alpha, beta = turned(self.next_at[a]), turned(self.next_at[b])
        for one, other in [(a, b), (alpha, beta)]:
            self.next_at[one], self.next_at[other] = self.next_at[other], self.next_at[one]

    def before_at(self, e: Quarter) -> Quarter:
        """The previous directed edge about the origin."""
        return turned(self.next_at[turned(e)])

    def along_left(self, e: Quarter) -> Quarter:
        """The next edge of the face on the left."""
        return turned(self.next_at[turned(e, 3)])

    def destination(self, e: Quarter) -> int:
        """The end of a directed edge."""
        return self.origin[turned(e, 2)]

    def connect(self, a: Quarter, b: Quarter) -> Quarter:
        """A new edge from the end of a to the origin of b, both on the left of one face."""
        e = self.make(self.destination(a), self.origin[b])
        self.splice(e, self.along_left(a))
        self.splice(turned(e, 2), b)
        return e

    def delete(self, e: Quarter) -> Pair:
        """Take an edge out of the rings about its ends; the edge, with the lesser number first."""
        for one in (e, turned(e, 2)):
            self.splice(one, self.before_at(one))
        u, v = sorted((self.origin[e], self.destination(e)))
        for r in range(4):
            del self.next_at[e[0], r]
            self.origin.pop((e[0], r), None)
        return u, v

    def is_left(self, v: int, e: Quarter) -> bool:
        """Whether a site is strictly on the left of a directed edge."""
        return orient([self.sites[w] for w in (self.origin[e], self.destination(e), v)]) > 0

    def is_right(self, v: int, e: Quarter) -> bool:
        """Whether a site is strictly on the right of a directed edge."""
        return self.is_left(v, turned(e, 2))

    def edges(self) -> frozenset[Pair]:
        """All edges, the lesser number first."""
        pairs = (sorted((self.origin[k, 0], self.origin[k, 2])) for k, r in self.next_at if r == 0)
        return frozenset((u, v) for u, v in pairs)

    def triangles(self) -> set[Triangle]:
        """The faces with three counterclockwise corners."""
        found = set()
        for e in self.origin:
            f = self.along_left(e)
            if self.along_left(self.along_left(f)) == e and self.is_left(self.destination(f), e):
                found.add(triangle(self.origin[e], self.origin[f], self.destination(f)))
        return found


def turned(e: Quarter, quarters: int = 1) -> Quarter:
    """A directed edge turned counterclockwise; by two quarters it is reversed."""
    return e[0], (e[1] + quarters) % 4


def divide_and_conquer(points: Points) -> set[Triangle]:
    """The triangles of a Delaunay triangulation, counterclockwise, least vertex first.

    Raises
    ------
    InputError
        Where the points are not pairs of finite numbers, or two of them are equal.
    DegenerateInputError
        Where all points lie on a line.

    Notes
    -----
    O(n log n) sign tests; each state copies all edges, which is O(n) more for each of them.
    """
    quad = _quad_edges(points)
    for _ in _divide(quad, _order(quad)):
        pass
    cells = quad.triangles()
    if not cells:
        flat = min(len(points) - 1, 1)
        raise DegenerateInputError(f"all {len(points)} points lie in a flat of dimension {flat}", flat)
    return cells


def divide(points: Points) -> Generator[Merge, None, Ends | None]:
    """All states, from the first two or three sites to the last merge; none for a single site."""
    quad = _quad_edges(points)
    return (yield from _divide(quad, _order(quad)))


def _quad_edges(points: Points) -> QuadEdges:
    sites = planar_sites(points)
    return QuadEdges(sites)


def _order(quad: QuadEdges) -> tuple[int, ...]:
    return tuple(sorted(range(len(quad.sites)), key=quad.sites.__getitem__))


def _divide(quad: QuadEdges, order: tuple[int, ...]) -> Generator[Merge, None, Ends | None]:
    """Triangulate some sites, given from left to right; the two ends of their hull."""
    if len(order) == 1:
        return None
    if len(order) <= 3:
        ends = _few(quad, order)
        yield Merge("few", order, None, (None, None), (), quad.edges())
        return ends
    half = len(order) // 2
    left = yield from _divide(quad, order[:half])
    right = yield from _divide(quad, order[half:])
    assert left is not None and right is not None  # halves of four or more have two or more
    return (yield from merge(quad, order, left, right))


def _few(quad: QuadEdges, order: tuple[int, ...]) -> Ends:
    """An edge, a triangle, or two edges where three sites lie on a line."""
    a = quad.make(order[0], order[1])
    if len(order) == 2:
        return a, turned(a, 2)
    b = quad.make(order[1], order[2])
    quad.splice(turned(a, 2), b)
    if quad.is_left(order[2], a):
        quad.connect(b, a)
    elif quad.is_right(order[2], a):
        c = quad.connect(b, a)
        return turned(c, 2), c
    return a, turned(b, 2)


def merge(quad: QuadEdges, order: tuple[int, ...], left: Ends, right: Ends) -> Generator[Merge, None, Ends]:
    """Join two halves from below upward."""
    (left_out, left_in), (right_in, right_out) = left, right
    left_in, right_in = _tangent(quad, left_in, right_in)
    base = quad.connect(turned(right_in, 2), left_in)  # from right to left
    if quad.origin[left_in] == quad.origin[left_out]:
        left_out = turned(base, 2)
    if quad.origin[right_in] == quad.origin[right_out]:
        right_out = base
    yield Merge("tangent", order, _base(quad, base), (None, None), (), quad.edges())
    while True:
        found, deleted = _candidates(quad, base)
        ends = tuple(quad.destination(e) if quad.is_right(quad.destination(e), base) else None for e in found)
        if ends == (None, None):
            yield Merge("merged", order, _base(quad, base), (None, None), deleted, quad.edges())
            return left_out, right_out
        if _right_is_better(quad, base, *ends):
            base = quad.connect(found[1], turned(base, 2))
        else:
            base = quad.connect(turned(base, 2), turned(found[0], 2))
        yield Merge("rise", order, _base(quad, base), (ends[0], ends[1]), deleted, quad.edges())


def _tangent(quad: QuadEdges, left_in: Quarter, right_in: Quarter) -> Ends:
    """Walk down both hulls, between the halves, until no site is below the line of the two origins."""
    while True:
        if quad.is_left(quad.origin[right_in], left_in):
            left_in = quad.along_left(left_in)
        elif quad.is_right(quad.origin[left_in], right_in):
            right_in = quad.next_at[turned(right_in, 2)]
        else:
            return left_in, right_in


def _candidates(quad: QuadEdges, base: Quarter) -> tuple[Ends, tuple[Pair, ...]]:
    """The edges from the base's ends to the candidates, after deleting those that the bubble cuts."""
    circle = [quad.sites[v] for v in (quad.destination(base), quad.origin[base])]
    deleted = []
    found = []
    for start, following in [(turned(base, 2), quad.next_at.__getitem__), (base, quad.before_at)]:
        e = following(start)
        while quad.is_right(quad.destination(e), base):
            after = following(e)
            corner, beyond = (quad.sites[quad.destination(f)] for f in (e, after))
            if in_sphere([*circle, corner], beyond) <= 0:
                break
            deleted.append(quad.delete(e))
            e = after
        found.append(e)
    return (found[0], found[1]), tuple(deleted)


def _right_is_better(quad: QuadEdges, base: Quarter, left: int | None, right: int | None) -> bool:
    """Whether the bubble meets the right candidate first; at the same time, the left one is taken."""
    if left is None or right is None:
        return left is None
    low_left, low_right = quad.destination(base), quad.origin[base]
    return in_sphere([quad.sites[v] for v in (low_left, low_right, left)], quad.sites[right]) > 0


def _base(quad: QuadEdges, base: Quarter) -> Pair:
    return quad.destination(base), quad.origin[base]
