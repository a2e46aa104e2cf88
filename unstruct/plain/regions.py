"""What an outline encloses, told plainly: the even-odd rule with exact signs (section 2.6d of the book).

Facets are pairs of numbers of points, in any order and direction. They may meet only in common ends.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from .predicates import orient

__all__ = ["crosses", "crossings", "is_inside", "odd_vertices"]

Point = Sequence[Any]
Points = Sequence[Point]
Facet = tuple[int, int]
Facets = Iterable[Facet]


def odd_vertices(facets: Facets) -> list[int]:
    """The vertices at which an odd number of facets meet: with one of them there is no inside."""
    met = Counter(v for facet in facets for v in facet)
    return sorted(v for v, count in met.items() if count % 2)


def crosses(x: Point, ahead: Point, a: Point, b: Point) -> bool:
    """Whether the ray from x through ``ahead`` counts the facet ab; x is on no facet.

    A vertex on the ray counts as on the right of it: no facet is met in a vertex.
    """
    left = [orient([x, ahead, p]) > 0 for p in (a, b)]
    if left[0] == left[1]:
        return False
    right_end, left_end = (a, b) if left[1] else (b, a)
    return orient([right_end, left_end, x]) > 0


def crossings(points: Points, facets: Facets, x: Point, ahead: Point) -> list[Facet]:
    """The facets that the ray from x through ``ahead`` counts."""
    return [(a, b) for a, b in facets if crosses(x, ahead, points[a], points[b])]


def is_inside(points: Points, facets: Facets, x: Point) -> bool:
    """Whether a ray from x to the right counts an odd number of facets."""
    ahead = (Fraction(x[0]) + 1, x[1])
    return len(crossings(points, facets, x, ahead)) % 2 == 1
