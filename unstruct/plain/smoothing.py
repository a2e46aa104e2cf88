"""Smoothing told plainly: each vertex goes to the mean of its neighbors, if the mesh stays valid.

Rational arithmetic, sets and dictionaries; the oracle for `unstruct.generate.improve.smoothing`. Book: 2.6d.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

Point = tuple[Fraction, Fraction]

__all__ = ["laplacian_round"]


def area2(a: Point, b: Point, c: Point) -> Fraction:
    """Twice the signed area of a triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def laplacian_round(
    points: Sequence[Sequence[float]], triangles: Sequence[Sequence[int]], fixed: Iterable[int] = ()
) -> list[Point]:
    """One round over all vertices in turn: each that is not fixed moves to the mean of its neighbors.

    A move that would turn a triangle over, or flatten it, is not made.
    """
    place: list[Point] = [(Fraction(x), Fraction(y)) for x, y in points]
    still = set(fixed)
    for v in range(len(place)):
        star = [tuple(t) for t in triangles if v in t]
        around = {u for t in star for u in t} - {v}
        if v in still or not around:
            continue
        wanted = (
            sum((place[u][0] for u in around), Fraction(0)) / len(around),
            sum((place[u][1] for u in around), Fraction(0)) / len(around),
        )
        moved = {**{u: place[u] for u in around}, v: wanted}
        if all(area2(moved[a], moved[b], moved[c]) > 0 for a, b, c in star):
            place[v] = wanted
    return place
