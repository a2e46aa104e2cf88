"""All triangulations of a few points, exactly and without flips: the judge of every optimality claim.

A triangulation here uses every point and covers the convex hull. Section 2.0 of the book.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, permutations
from typing import Any

from unstruct.plain.predicates import in_sphere, orient

__all__ = ["all_triangulations", "is_delaunay"]

Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]


def all_triangulations(points: Points) -> Iterator[frozenset[Triangle]]:
    """Each triangulation of the point set exactly once; counterclockwise triangles, least vertex first.

    Takes an edge that still lacks its left triangle, tries all that fit there, and goes on from each.
    The number of triangulations grows exponentially: meant for up to nine points or so.
    """
    turn = {t: orient([points[v] for v in t]) for t in permutations(range(len(points)), 3)}
    empty = [
        t for t in combinations(range(len(points)), 3) if turn[t] and not _holds_a_point(turn, t, len(points))
    ]
    empty = [t if turn[t] > 0 else (t[0], t[2], t[1]) for t in empty]

    def complete(chosen: frozenset[Triangle], open_edges: frozenset) -> Iterator[frozenset[Triangle]]:
        if not open_edges:
            yield chosen
            return
        edge = min(open_edges)
        for t in empty:
            if edge in _edges(t) and not any(_overlap(turn, t, s) for s in chosen):
                closed = {e for e in _edges(t) if e in open_edges}
                opened = {(v, u) for u, v in _edges(t) if (u, v) not in open_edges}
                yield from complete(chosen | {t}, (open_edges - closed) | opened)

    yield from complete(frozenset(), frozenset(_hull_edges(points, turn)))


def is_delaunay(points: Points, triangles: Any) -> bool:
    """The definition itself: no point strictly inside the circle of any (counterclockwise) triangle."""
    return all(in_sphere([points[v] for v in t], q) <= 0 for t in triangles for q in points)


def _edges(t: Triangle) -> list[tuple[int, int]]:
    return [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]


def _holds_a_point(turn: dict, t: Triangle, n: int) -> bool:
    """Whether another point lies inside t or on its boundary."""
    return any(all(turn[u, v, w] * turn[t] >= 0 for u, v in _edges(t)) for w in range(n) if w not in t)


def _overlap(turn: dict, s: Triangle, t: Triangle) -> bool:
    """Two convex sets have no interior point in common where an edge of one parts them."""
    return not any(
        all(w in (u, v) or turn[u, v, w] <= 0 for w in other)
        for one, other in [(s, t), (t, s)]
        for u, v in _edges(one)
    )


def _hull_edges(points: Points, turn: dict) -> Iterator[tuple[int, int]]:
    """Counterclockwise edges of the convex hull, divided at points that lie on them."""
    for u, v in permutations(range(len(points)), 2):
        others = [w for w in range(len(points)) if w not in (u, v)]
        line = [w for w in others if turn[u, v, w] == 0]
        ends = sorted([tuple(points[u]), tuple(points[v])])
        if all(turn[u, v, w] >= 0 for w in others) and not any(
            ends[0] < tuple(points[w]) < ends[1] for w in line
        ):
            yield u, v
