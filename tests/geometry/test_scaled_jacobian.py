"""The scaled Jacobian and the angles of rings: against formulas written out, and known values."""

from __future__ import annotations

import math

import numpy as np
import pytest

from unstruct.geometry import simplex
from unstruct.geometry.scaled_jacobian import ring_angles, ring_jacobian, scaled_jacobian


def regular(k: int) -> np.ndarray:
    turn = 2 * np.pi * np.arange(k) / k
    return np.column_stack([np.cos(turn), np.sin(turn)])


@pytest.mark.parametrize("k", [1, 2, 3, 4, 6])
def test_regular_simplices_have_one(k: int) -> None:
    corners = np.eye(k + 1)
    assert scaled_jacobian(corners) == pytest.approx(1)
    q = np.linalg.qr((corners[1:] - corners[0]).T)[0]
    flat = (corners - corners[0]) @ q
    assert abs(scaled_jacobian(flat)) == pytest.approx(1)
    assert scaled_jacobian(flat * ([-1] + [1] * (k - 1))) == pytest.approx(-scaled_jacobian(flat))


def test_known_values() -> None:
    right = np.array([[0, 0], [1, 0], [0, 1.0]])
    assert scaled_jacobian(right) == pytest.approx(2 / math.sqrt(3) * math.sqrt(0.5))
    corner = np.vstack([np.zeros(3), np.eye(3)])
    assert scaled_jacobian(corner) == pytest.approx(math.sqrt(0.5))
    assert scaled_jacobian(right * 1e300) == pytest.approx(scaled_jacobian(right * 1e-300))
    assert scaled_jacobian([[0, 0], [1, 1], [2, 2]]) == 0
    assert scaled_jacobian([[0, 0], [0, 0], [2, 2]]) == 0
    assert "scaled_jacobian" in simplex.QUALITIES


def test_the_least_sine_of_a_triangle() -> None:
    x = np.random.default_rng(0).random((50, 3, 2))
    sines = (np.sin(simplex.angles(x)) * np.sign(simplex.volume(x))[:, None]).min(axis=1)
    assert scaled_jacobian(x) == pytest.approx(2 / math.sqrt(3) * sines)
    assert ring_jacobian(x) == pytest.approx(scaled_jacobian(x))


@pytest.mark.parametrize("k", [3, 4, 5, 6, 9])
def test_regular_polygons(k: int) -> None:
    x = regular(k)[None]
    assert ring_jacobian(x) == pytest.approx([1]) and ring_jacobian(x[:, ::-1]) == pytest.approx([-1])
    assert np.degrees(ring_angles(x)) == pytest.approx(np.full((1, k), 180 - 360 / k))
    assert ring_angles(x[:, ::-1]) == pytest.approx(ring_angles(x))
    tilted = x @ np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]])
    assert ring_jacobian(tilted) == pytest.approx([1]) and ring_angles(tilted) == pytest.approx(
        ring_angles(x)
    )
    higher = np.concatenate([tilted, np.zeros((1, k, 2))], axis=2)
    assert ring_jacobian(higher) == pytest.approx([1]) and ring_angles(higher) == pytest.approx(
        ring_angles(x)
    )


def test_no_polygon_is_better_than_the_regular_one() -> None:
    rng = np.random.default_rng(1)
    for k in (4, 5, 7):
        x = regular(k) + 0.5 * rng.normal(size=(3000, k, 2))
        assert ring_jacobian(x).max() <= 1 + 1e-12


def test_angles_beyond_a_straight_line() -> None:
    arrow = np.array([[[0, 0], [4, 0], [1, 1], [0, 4.0]]])
    found = np.degrees(ring_angles(arrow))[0]
    sharp = math.degrees(math.atan2(1, 3))
    assert found == pytest.approx([90, sharp, 270 - 2 * sharp, sharp])
    assert found[2] > 180 and ring_jacobian(arrow)[0] < 0
    lifted = np.concatenate([arrow, np.zeros((1, 4, 1))], axis=2)
    assert ring_angles(lifted) == pytest.approx(ring_angles(arrow))
    assert np.isnan(ring_angles(np.array([[[0, 0], [0, 0], [1, 1], [0, 4.0]]]))).any()
