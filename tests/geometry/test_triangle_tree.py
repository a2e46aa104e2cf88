"""The nearest triangle, beside many points of all triangles, and beside planes and ends in exact cases."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.geometry.triangle_tree import TriangleTree

PARTS = 24
SHARES = np.array([(i, j, PARTS - i - j) for i in range(PARTS + 1) for j in range(PARTS + 1 - i)]) / PARTS


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32), st.integers(1, 40), st.sampled_from([-300, 0, 300]))
def test_beside_many_points_of_all(seed: int, count: int, exponent: int) -> None:
    """Integer corners: triangles that are flat, equal or points among them; also far from 1 in size."""
    rng = np.random.default_rng(seed)
    corners = rng.integers(-3, 4, (count, 3, 3)).astype(float)
    x = rng.integers(-9, 10, (20, 3)) / 2.0
    which, weights = TriangleTree(np.ldexp(corners, exponent)).nearest(np.ldexp(x, exponent))
    assert (weights >= 0).all() and np.allclose(weights.sum(axis=1), 1)
    found = np.linalg.norm((corners[which] * weights[..., None]).sum(axis=1) - x, axis=1)
    samples = (SHARES @ corners).reshape(-1, 3)
    wanted = np.array([np.linalg.norm(samples - row, axis=1).min() for row in x])
    assert (found <= wanted + 1e-12).all()
    assert (found >= wanted - 8.5 / PARTS).all(), "samples are that close to each other"


def test_places_by_hand() -> None:
    tree = TriangleTree([[[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[9, 9, 9], [9, 9, 9], [9, 9, 9]]])
    which, weights = tree.nearest([[1, 1, 5], [2, -3, 1], [5, 5, 0], [-1, -1, 0], [9, 9, 10]])
    assert which.tolist() == [0, 0, 0, 0, 1]
    assert weights[:4] == pytest.approx(
        np.array([[0.5, 0.25, 0.25], [0.5, 0.5, 0], [0, 0.5, 0.5], [1, 0, 0]])
    )


@pytest.mark.parametrize("height", [1e-3, 1e-4, 1e-6, 1e-8])
def test_points_in_needles_are_found_where_they_are(height: float) -> None:
    """The weights in a needle have large rounding errors at first, by which its points were off before."""
    rng = np.random.default_rng(21)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    for corner in range(3):
        needle = np.roll(np.array([[0, 0, 0], [1, 0, 0], [0.5, height, 0]]), corner, axis=0) @ turn.T / 2
        x = rng.dirichlet([1, 1, 1], 500) @ needle
        _, weights = TriangleTree(needle[None]).nearest(x)
        found = (needle[None] * weights[..., None]).sum(axis=1)
        assert (weights >= 0).all() and np.abs(found - x).max() < 8 * 2.0**-53
