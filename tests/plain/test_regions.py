"""What an outline encloses: the plain rule against other directions, and the library."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, InputError
from unstruct.plain import regions

COORDINATES = st.tuples(st.integers(-8, 8), st.integers(-8, 8))
SQUARE = ([(0, 0), (4, 0), (4, 4), (0, 4)], [(0, 1), (1, 2), (2, 3), (3, 0)])


@pytest.mark.parametrize(
    ("x", "inside"), [((1, 2), True), ((-1, 4), False), ((-1, 0), False), ((5, 0), False), ((2, -1), False)]
)
def test_a_ray_through_vertices_and_along_a_facet(x: tuple, inside: bool) -> None:
    assert regions.is_inside(*SQUARE, x) == inside


def test_huge_coordinates() -> None:
    """The point ahead is a fraction: one more is no other double there."""
    points = [(float(a) * 1e20, float(b) * 1e20) for a, b in SQUARE[0]]
    assert regions.is_inside(points, SQUARE[1], (1e20, 2e20))


@settings(max_examples=60, deadline=None)
@given(st.lists(COORDINATES, min_size=3, max_size=12, unique=True), COORDINATES, COORDINATES)
def test_a_closed_line_through_points(ring: list, place: tuple, turn: tuple) -> None:
    """Any closed line, mended at its crossings: each direction and the library say the same."""
    closed = [(i, (i + 1) % len(ring)) for i in range(len(ring))]
    try:
        domain = Domain(np.array(ring, dtype=float), closed, resolve=True)
    except InputError as error:  # the line encloses nothing
        assert "no facet is left that bounds a region" in str(error)
        return
    facets = [tuple(map(int, facet)) for facet in domain.facets]
    points = [tuple(map(float, p)) for p in domain.points]
    assert regions.odd_vertices(facets) == []
    x = (Fraction(2 * place[0] + 1, 2), Fraction(place[1]) + Fraction(1, 3))
    on = any(_on(points[a], points[b], x) for a, b in facets)
    if on:
        return
    found = regions.is_inside(points, facets, x)
    ahead = (x[0] + turn[0] * 2 + 1, x[1] + turn[1])
    assert found == (len(regions.crossings(points, facets, x, ahead)) % 2 == 1)
    assert found == bool(domain.contains([[float(x[0]), float(x[1])]])[0])


def _on(a: tuple, b: tuple, x: tuple) -> bool:
    a, b = tuple(map(Fraction, a)), tuple(map(Fraction, b))
    flat = (b[0] - a[0]) * (x[1] - a[1]) == (b[1] - a[1]) * (x[0] - a[0])
    return flat and min(a, b) <= x <= max(a, b)


def test_an_open_outline_has_no_inside() -> None:
    points, facets = [*SQUARE[0]], SQUARE[1][:3]
    assert regions.odd_vertices(facets) == [0, 3]
    counts = {len(regions.crossings(points, facets, (2, 2), ahead)) % 2 for ahead in ((3, 2), (1, 2))}
    assert counts == {0, 1}
