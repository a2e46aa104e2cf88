"""The plain wedges: by hand, against values of the Jacobian, and a counterexample for six corners."""

from __future__ import annotations

from fractions import Fraction
from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct.geometry.jacobians import wedge_signs
from unstruct.plain.prisms import (
    column_limit,
    graded_heights,
    layer_places,
    minus,
    quadratics,
    wedge_is_positive,
)

BASE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
INTEGER = st.integers(-3, 3)
CORNERS = st.lists(st.tuples(INTEGER, INTEGER, INTEGER), min_size=6, max_size=6)


def test_by_hand() -> None:
    up = [(0, 0, 1)] * 3
    assert quadratics(BASE, up) == [(1, 0, 0)] * 3
    assert column_limit(BASE, up) == inf
    assert wedge_is_positive(BASE, [(0, 0, 1), (1, 0, 1), (0, 1, 1)])
    assert not wedge_is_positive(BASE, [(0, 0, -1), (1, 0, -1), (0, 1, -1)])
    inward = [(1, 1, 3), (-2, 1, 3), (1, -2, 3)]  # to (1, 1, 3) / 3 all three
    assert column_limit(BASE, inward) == pytest.approx(1 / 3)
    assert not wedge_is_positive(BASE, [(1, 1, 3), (-1, 1, 3), (1, -1, 3)])


def test_positive_corners_are_not_enough() -> None:
    """Of random wedges with positive corners some are not positive inside."""
    rng = np.random.default_rng(1)
    corners = rng.integers(-4, 5, (20_000, 6, 3)).astype(float)
    ends = np.array([[1, 2], [2, 0], [0, 1]])
    at = []
    for i, (j, k) in enumerate(ends):
        for level in (0, 3):
            p, q, r = (corners[:, v + level] for v in (i, j, k))
            normal = np.cross(q - p, r - p)
            at.append((normal * (corners[:, i + 3] - corners[:, i])).sum(axis=1))
    fine = np.nonzero(np.min(at, axis=0) > 0)[0]
    rows = corners[fine].astype(int).tolist()
    bad = [row for row in rows if not wedge_is_positive(row[:3], row[3:])]
    assert len(bad) / len(fine) > 0.1


@given(CORNERS)
def test_the_sign_is_the_library_s(corners: list[tuple[int, int, int]]) -> None:
    assert wedge_is_positive(corners[:3], corners[3:]) == (
        wedge_signs(np.array([corners], dtype=float))[0] == 1
    )


@given(CORNERS)
def test_limits(corners: list[tuple[int, int, int]]) -> None:
    """Just below the limit the column is positive, if it is so at its base, and just above it is not."""
    base, rays = corners[:3], corners[3:]
    limit = column_limit(base, rays)
    if not all(q[0] > 0 for q in quadratics(base, rays)):
        return
    for factor, good in ((Fraction(99, 100), True), (Fraction(101, 100), False)):
        if limit == inf and not good:
            continue
        t = factor * Fraction(min(limit, 1e3))
        cap = [minus(p, minus((0, 0, 0), (t * v[0], t * v[1], t * v[2]))) for p, v in zip(base, rays)]
        positive = wedge_is_positive(base, cap)
        assert positive if good else not positive or _touches(quadratics(base, rays))


def _touches(rows: list[tuple[int, int, int]]) -> bool:
    """Whether a quadratic has a double root, which rounding may miss or which is no change of sign."""
    return any(b * b == 4 * a * c for a, b, c in rows)


def test_heights() -> None:
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
    found = graded_heights(points, [(0, 1, 2), (1, 3, 2)], [0.1, 9.0, 9.0, 9.0], 0.5)
    np.testing.assert_allclose(found, [0.1, 0.6, 0.6, 1.1])
    rows = layer_places(points, [(0, 0, 1)] * 4, found, [0, 0.5, 1])
    assert rows[0] == points and rows[1][3] == (1, 1, pytest.approx(0.55))
