"""The plain refinement of a box: spheres, rules and their end, against computations that share no code."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import simplex
from unstruct.base.errors import InputError
from unstruct.plain.bowyer_watson import exact_points
from unstruct.plain.refining_box import (
    bad_cells,
    encroaches,
    next_division,
    refine_box,
    smallest_sphere,
    subfacets,
    subsegments,
)

SQUARES = [tuple(map(int, row)) for row in "0132 4576 0154 2376 0264 1375".split()]


def box(*sides: int) -> list[tuple[int, ...]]:
    return list(product(*((0, side) for side in sides)))


def ratios(mesh: unstruct.Mesh) -> np.ndarray:
    return simplex.circumradius(mesh.corners) / simplex.edge_lengths(mesh.corners).min(axis=1)


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 4), st.lists(st.integers(-9, 9), min_size=12, max_size=12))
def test_the_smallest_sphere_passes_through_the_corners(many: int, numbers: list[int]) -> None:
    corners = np.array(numbers, float).reshape(4, 3)[:many]
    ways = corners[1:] - corners[0]
    if np.linalg.matrix_rank(ways) < many - 1:
        return
    center, square = smallest_sphere([tuple(map(int, p)) for p in corners])
    assert {sum((x - int(y)) ** 2 for x, y in zip(center, p)) for p in corners} == {square}
    in_span = np.linalg.lstsq(ways.T, np.array(center, float) - corners[0], rcond=None)[0]
    assert np.allclose(ways.T @ in_span + corners[0], np.array(center, float))


def test_encroaching_is_strict() -> None:
    points = exact_points([*box(4, 4, 4), (2, 1, 0), (2, 2, 0)])
    assert encroaches(points, (0, 4), points[8]) and not encroaches(points, (0, 4), points[9])
    assert not encroaches(points, (0, 4), points[0])


def test_pieces_of_a_box() -> None:
    points = exact_points([*box(4, 2, 2), (1, 0, 0), (3, 0, 0), (2, 0, 1)])
    parts = subsegments(points)
    assert len(parts) == 14 and {(0, 8), (8, 9), (9, 4)} <= set(parts)
    total = 0.0
    for piece in subfacets(points):
        a, b, c = (np.array(points[v], float) for v in piece)
        total += np.linalg.norm(np.cross(b - a, c - a)) / 2
    assert np.isclose(total, 2 * (4 * 2 + 4 * 2 + 2 * 2))


def test_a_rejected_center_leads_to_a_smaller_piece() -> None:
    """The vertex encroaches on a triangle whose center encroaches on an edge: this is halved."""
    points = [*box(4, 4, 4), (1, 1, 2)]
    found = list(refine_box(points))
    first, second = found[:2]
    assert first.piece == (0, 1) and first.center == (0, 0, 2) and not first.rejected
    assert second.piece == (0, 2) and second.rejected == ((0, 2, 9),)
    assert points[9:] == [one.center for one in found]


@pytest.mark.parametrize(
    ("sides", "inner", "nearest"),
    [
        ((4, 4, 4), [(Fraction(7, 4), 2, 2), (Fraction(9, 4), 2, 2)], 0.5),
        ((4, 4, 4), [(1, 1, 2)], 1.0),
        ((4, 4, 2), [(1, 2, 1), (3, 2, 1)], 1.0),
    ],
)
def test_the_end_keeps_every_promise(sides: tuple[int, ...], inner: list, nearest: float) -> None:
    points = [*box(*sides), *inner]
    count = len(points)
    found = list(refine_box(points, 2))
    assert len(points) == count + len(found)
    mesh = unstruct.delaunay(np.array(points, float))
    assert ratios(mesh).max() <= 2 + 1e-12
    apart = min(np.linalg.norm(np.subtract(p, q).astype(float)) for p, q in combinations(points, 2))
    assert apart >= nearest / 2**0.5
    for piece in subsegments(points):
        a, b = (np.array(points[v], float) for v in piece)
        assert all((a - p) @ (b - p) >= 0 for p in np.array(points, float))
    assert next_division(points, [], 2) is None
    domain = unstruct.Domain(np.array(points[:count], float), SQUARES)
    fast = unstruct.refine(domain, radius_edge=2)
    assert fast.complete and len(fast.points) < 2 * len(points)


def test_bad_cells_come_by_their_quotient() -> None:
    points = exact_points([*box(4, 4, 4), (Fraction(7, 4), 2, 2), (Fraction(9, 4), 2, 2)])
    mesh = unstruct.delaunay(np.array(points, float))
    bad = bad_cells(points, map(tuple, mesh.simplices.tolist()), 2)
    quotient = dict(zip(map(frozenset, mesh.simplices.tolist()), ratios(mesh)))
    assert {frozenset(one) for one in bad} == {cell for cell, r in quotient.items() if r > 2}
    found = [quotient[frozenset(one)] for one in bad]
    assert found == sorted(found, reverse=True) and len(found) >= 4


def test_a_budget_says_that_no_end_is_in_sight() -> None:
    with pytest.raises(InputError, match="larger ratio"):
        list(refine_box([*box(4, 4, 4), (1, 1, 2)], Fraction(1, 2), budget=20))
