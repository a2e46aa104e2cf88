"""Bilinear patches that are apart, and crossings found by Newton's method."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.geometry.patches import patches_apart

FLAT = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)


def at(x: np.ndarray, u: float, v: float) -> np.ndarray:
    return (1 - u) * ((1 - v) * x[0] + v * x[3]) + u * ((1 - v) * x[1] + v * x[2])


def crosses(p: np.ndarray, q: np.ndarray, rng: np.random.Generator, starts: int = 10) -> bool:
    """Whether Newton's method finds p(u, v) = q(s, t) for some t, with all parameters well inside."""
    for _ in range(starts):
        t, z = rng.uniform(0.05, 0.95), rng.random(3)
        for _ in range(12):
            u, v, s = z
            jacobian = np.column_stack([
                at(p, 1, v) - at(p, 0, v), at(p, u, 1) - at(p, u, 0), at(q, 0, t) - at(q, 1, t)
            ])  # fmt: skip
            if abs(np.linalg.det(jacobian)) < 1e-9:
                break
            z = z - np.linalg.solve(jacobian, at(p, u, v) - at(q, s, t))
        if np.abs(at(p, *z[:2]) - at(q, z[2], t)).max() < 1e-10 and ((z > 0.02) & (z < 0.98)).all():
            return True
    return False


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 2), st.booleans())
def test_crossings_are_never_called_apart(seed: int, shared: int, triangle: bool) -> None:
    """Patches without a common corner, with one, and with a common edge."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-8, 9, (8 - shared, 3)).astype(float)
    one = np.arange(4)
    other = {0: [4, 5, 6, 7], 1: [0, 4, 5, 6], 2: [1, 0, 4, 5]}[shared]
    if triangle:
        other[3] = other[2]
    apart = patches_apart(points, one[None], np.array([other]))[0]
    assert not (apart and crosses(points[one], points[other], rng))


@pytest.mark.parametrize("angle", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("twist", [0.0, 0.3])
def test_patches_beside_a_common_edge(angle: float, twist: float) -> None:
    """Both rise from an edge at a small angle, and twist: apart as long as the angle is positive."""
    up = np.array([[0, 1, 0], [1, 1, twist]], dtype=float)
    points = np.vstack([FLAT[:2], up, np.add(up, [0, 0, angle])])
    one, other = np.array([[0, 1, 3, 2]]), np.array([[0, 1, 5, 4]])
    assert patches_apart(points, one, other)[0]
    points[4:, 2] -= [2 * angle, 0]
    assert not patches_apart(points, one, other)[0], "they change places along the edge"


def test_saddles_above_each_other() -> None:
    saddle = np.add(FLAT, [[0, 0, 1], [0, 0, -1], [0, 0, 1], [0, 0, -1]])
    one, other = np.array([[0, 1, 2, 3]]), np.array([[4, 5, 6, 7]])
    for gap, apart in ((0.5, True), (0.1, True), (0.0, False)):
        points = np.vstack([saddle, np.add(saddle, [0, 0, gap])])
        assert patches_apart(points, one, other)[0] == apart
    tent = np.array([[0.5, 0.5, 0.1], [0.4, 0.5, 2], [0.6, 0.5, 2]])
    for low, apart in ((0.1, True), (-0.1, False)):
        points = np.vstack([saddle, tent])
        points[4, 2] = low
        assert patches_apart(points, one, np.array([[4, 5, 6, 6]]))[0] == apart


def test_two_common_edges() -> None:
    """Patches with three common corners are apart if the fourth ones lie on different sides."""
    points = np.vstack([FLAT[:3], [[0, 1, 1]], [[0, 1, -1]], [[0, 1, 2]]])
    one = np.array([[0, 1, 2, 3]])
    assert patches_apart(points, one, np.array([[0, 1, 2, 4]]))[0]
    assert not patches_apart(points, one, np.array([[0, 1, 2, 5]]))[0]
    assert patches_apart(points, one, np.array([[0, 1, 2, 2]]))[0], "a triangle in the plane of the three"


def test_far_from_the_origin_nothing_is_certain() -> None:
    lifted = np.vstack([FLAT, np.add(FLAT, [0, 0, 1e-3])])
    rows = np.array([[0, 1, 2, 3]]), np.array([[4, 5, 6, 7]])
    assert patches_apart(lifted, *rows)[0]
    assert not patches_apart(lifted + 1e13, *rows)[0]
