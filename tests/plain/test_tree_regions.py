"""Triangles of a tree cut and warped at a boundary, in exact arithmetic: areas, edges, bounds, errors."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.errors import InputError
from unstruct.plain import tree_regions as regions
from unstruct.plain import tree_templates as templates

SQUARES = sorted(templates.triangles({(2, i, j) for i in range(4) for j in range(4)}))
FRACTIONS = st.fractions(min_value=-2, max_value=2, max_denominator=40)


def twice_area(triangle: Any) -> Fraction:
    (ax, ay), (bx, by), (cx, cy) = triangle
    return (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)


def clipped_area(triangle: Any, level: Any) -> Fraction:
    """Twice the area of what lies inside a straight boundary, by cutting the polygon."""
    ring = []
    for p, q in zip(triangle, (*triangle[1:], triangle[0]), strict=True):
        f, g = level(p), level(q)
        if f <= 0:
            ring.append(p)
        if f * g < 0:
            ring.append(tuple(a + f / (f - g) * (b - a) for a, b in zip(p, q, strict=True)))
    return sum((twice_area((ring[0], p, q)) for p, q in pairwise(ring[1:])), Fraction(0))


def test_cotangents_of_known_triangles() -> None:
    assert regions.cotangents([(0, 0), (1, 0), (0, 1)]) == [0, 1, 1]
    low, high = Fraction(0), Fraction(2)
    assert regions.sharpest([[(low, low), (high, low), (high, Fraction(1))]]) == 2
    for turned in ([(0, 0), (0, 1), (1, 0)], [(0, 0), (1, 1), (2, 2)], [(0, 0), (0, 0), (1, 0)]):
        with pytest.raises(InputError, match="not counterclockwise"):
            regions.cotangents(turned)


def test_the_best_diagonal() -> None:
    a, b, c, d = (0, 0), (4, 0), (5, 3), (0, 1)
    both = [[(a, b, c), (a, c, d)], [(a, b, d), (b, c, d)]]
    assert regions.best_diagonal(a, b, c, d) == min(both, key=regions.sharpest)
    dart = [(0, 0), (4, 0), (1, 1), (0, 4)]  # one diagonal only
    assert regions.best_diagonal(*dart) == [(dart[0], dart[1], dart[2]), (dart[0], dart[2], dart[3])]
    with pytest.raises(InputError, match="no counterclockwise quadrilateral"):
        regions.best_diagonal(d, c, b, a)


@settings(deadline=None)
@given(a=FRACTIONS, b=FRACTIONS, c=FRACTIONS)
def test_cuts_at_lines_have_the_right_area_and_fit_together(a: Fraction, b: Fraction, c: Fraction) -> None:
    def level(p: Any) -> Fraction:
        return a * (p[0] - Fraction(1, 2)) + b * (p[1] - Fraction(1, 2)) - c / 2

    value = {p: level(p) for triangle in SQUARES for p in triangle}
    if set(value.values()) == {0}:
        return
    parts = regions.cut_all(SQUARES, value, level)
    assert all(twice_area(part) > 0 for part in parts)
    assert sum(map(twice_area, parts)) == sum(clipped_area(t, level) for t in SQUARES)
    edges = Counter(
        tuple(sorted(pair))
        for part in parts
        for pair in zip(part, (*part[1:], part[0]), strict=True)
    )  # fmt: skip
    for (p, q), times in edges.items():
        rim = any(p[k] == q[k] in (0, 1) for k in (0, 1))
        assert times == 2 or rim or level(p) == level(q) == 0


@settings(deadline=None, max_examples=60)
@given(a=FRACTIONS, b=FRACTIONS, c=FRACTIONS, threshold=st.fractions(0, Fraction(1, 4), max_denominator=20))
def test_warping_to_a_line_turns_nothing_over(
    a: Fraction, b: Fraction, c: Fraction, threshold: Fraction
) -> None:
    def level(p: Any) -> Fraction:
        return a * (p[0] - Fraction(1, 2)) + b * (p[1] - Fraction(1, 2)) - c / 2

    moved, value = regions.warp(SQUARES, level, threshold)
    assert all(twice_area(triangle) > 0 for triangle in moved)
    assert all(level(p) == v for p, v in value.items())  # a moved vertex lies on the line
    before = {p: level(p) for triangle in SQUARES for p in triangle}
    if not threshold:
        assert moved == SQUARES and value == before


def test_a_vertex_goes_to_the_nearest_crossing() -> None:
    triangle = ((Fraction(0), Fraction(0)), (Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)))
    moved, value = regions.warp([triangle], lambda p: p[0] + 2 * p[1] - Fraction(1, 5), Fraction(1, 4))
    assert moved[0][0] == (0, Fraction(1, 10)) and value[moved[0][0]] == 0
    assert moved[0][1:] == triangle[1:]


def test_three_corners_on_the_boundary() -> None:
    corners = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    flat = dict.fromkeys(corners, 0)
    assert regions.cut_all([corners], flat, lambda p: -1.0) == [corners]
    assert regions.cut_all([corners], flat, lambda p: 1.0) == []
    assert regions.cut(corners, flat) == []


@given(x=st.fractions(0, Fraction(1, 2), max_denominator=1000), y=st.fractions(0, Fraction(1, 2)))
def test_a_corner_moved_to_a_point_keeps_22_5_degrees(x: Fraction, y: Fraction) -> None:
    """Theorem 4b.6: the cotangent is at most 1 + sqrt(2), in the quadrant and, turned, in the others."""
    ring = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    for sx, sy in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        p = (sx * x, sy * y)
        parts = [t for k in (0, 2, 4, 6) for t in regions.best_diagonal(p, *ring[k : k + 3])]
        found = [c for t in parts for c in regions.cotangents(t)]
        assert max(found) <= 1 or (max(found) - 1) ** 2 <= 2
        assert min(found) >= 0 or (1 - min(found)) ** 2 <= 2
        assert sum(map(twice_area, parts)) == 8
