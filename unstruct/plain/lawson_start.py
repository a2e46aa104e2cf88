"""Lawson's whole construction: sorted points, each joined to the hull it sees, then flips (source: 12.6).

Points are sorted by x, then by y. So each comes strictly after all earlier ones, is never inside their hull,
and sees at least one side of it: it is joined to all sides that it sees. Then diagonals are swapped until no
edge is illegal (the rule of `unstruct.plain.lawson`), first those that the new point looks at.

While all points lie on a line there is no triangle; the first point off the line sees all edges between
neighbors on it. An edge that was swapped away never comes back: over its middle the lifted triangulation has
gone down, and it never goes up. So n points need at most n (n - 1) / 2 flips in all; those on the falling
branch of a parabola need (n - 2)(n - 3) / 2.

Source: C. L. Lawson, Software for C1 surface interpolation, in Mathematical Software III (1977) 161-194.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from unstruct.base.errors import DegenerateInputError
from unstruct.plain.bowyer_watson import planar_sites
from unstruct.plain.lawson import flip, triangle
from unstruct.plain.predicates import in_sphere, orient

__all__ = ["Change", "join", "lawson_start", "lawson_steps", "legalize"]

Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]
Edge = tuple[int, int]
Apex = dict[Edge, int]


@dataclass(frozen=True)
class Change:
    """One point that was joined, or one diagonal that was swapped, and all triangles afterwards."""

    kind: str  # "line" (the point is on a line with all before it), "join", "flip"
    vertex: int  # the point that came last
    seen: tuple[Edge, ...]  # the sides of the hull that it was joined to, from its right to its left
    swapped: tuple[Edge, Edge] | None  # the diagonal that went, the one that came
    hull: tuple[int, ...]  # counterclockwise; the points of the line in order while there is no triangle
    cells: frozenset[Triangle]


def lawson_start(points: Points) -> set[Triangle]:
    """The triangles of a Delaunay triangulation, counterclockwise, least vertex first.

    Raises
    ------
    InputError
        Where the points are not pairs of finite numbers, or two of them are equal.
    DegenerateInputError
        Where all points lie on a line.

    Notes
    -----
    O(n^2) flips; each state copies all triangles, which is O(n) more for each of them.
    """
    *_, last = lawson_steps(points)
    if not last.cells:
        flat = min(len(points) - 1, 1)
        raise DegenerateInputError(f"all {len(points)} points lie in a flat of dimension {flat}", flat)
    return set(last.cells)


def lawson_steps(points: Points) -> Iterator[Change]:
    """All states: each point when it is joined, and each flip after it."""
    sites = planar_sites(points)
    hull: list[int] = []
    apex: Apex = {}
    for v in sorted(range(len(sites)), key=sites.__getitem__):
        if not apex and (len(hull) < 2 or orient([sites[w] for w in (*hull[:2], v)]) == 0):
            hull.append(v)
            yield Change("line", v, (), None, tuple(hull), frozenset())
            continue
        hull, seen = join(sites, apex, hull, v)
        yield Change("join", v, tuple(seen), None, tuple(hull), _cells(apex))
        for swapped in legalize(sites, apex, seen):
            yield Change("flip", v, tuple(seen), swapped, tuple(hull), _cells(apex))


def join(
    sites: Sequence[tuple[Fraction, ...]], apex: Apex, hull: Sequence[int], v: int
) -> tuple[list[int], list[Edge]]:
    """Join a point to all sides of the hull that it sees; the new hull, and those sides.

    They follow each other: the hull is turned so that they come first. A line is seen as a hull of no width
    from one of its sides: with the point on the right of its edges as they are, or reversed.
    """
    if not apex:
        line = hull if orient([sites[w] for w in (*hull[:2], v)]) < 0 else hull[::-1]
        seen, rest = list(pairwise(line)), line[::-1]
    else:
        n = len(hull)
        visible = [orient([sites[w] for w in (hull[k], hull[(k + 1) % n], v)]) < 0 for k in range(n)]
        first = next(k for k in range(n) if visible[k] and not visible[k - 1])
        count = sum(visible)
        turned = [*hull[first:], *hull[:first]]
        seen = [(turned[k], turned[(k + 1) % n]) for k in range(count)]
        rest = [*turned[count:], turned[0]]
    for a, b in seen:  # v is on the right of a -> b
        apex |= {(b, a): v, (a, v): b, (v, b): a}
    return [v, *rest], seen


def legalize(
    sites: Sequence[tuple[Fraction, ...]], apex: Apex, edges: Sequence[Edge]
) -> Iterator[tuple[Edge, Edge]]:
    """Swap diagonals, beginning with these edges, until none is illegal; each one that went and that came."""
    stack = list(edges)
    while stack:
        u, v = stack.pop()
        if (u, v) not in apex or (v, u) not in apex:
            continue  # swapped away, or on the hull
        p, q = apex[u, v], apex[v, u]
        if in_sphere([sites[w] for w in (u, v, p)], sites[q]) > 0:
            flip(apex, u, v)
            stack += [(u, q), (q, v), (v, p), (p, u)]
            yield (u, v), (p, q)


def _cells(apex: Apex) -> frozenset[Triangle]:
    return frozenset(triangle(u, v, w) for (u, v), w in apex.items())
