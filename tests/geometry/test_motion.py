"""Motions: translations are one rounded sum, quarter turns are exact, files keep the map bit for bit."""

import numpy as np
import pytest

from unstruct.geometry.motion import Motion

POINTS = np.random.default_rng(0).normal(size=(200, 2)) * 10.0 ** np.arange(-8, 12).repeat(10)[:, None]


def test_translations_are_one_sum():
    shift = np.array([0.1, 1e5 / 3])
    assert np.array_equal(Motion.translation(shift)(POINTS), POINTS + shift)
    assert Motion.translation([1, 0, 2])(np.ones((4, 3))).tolist() == [[2, 1, 3]] * 4
    assert str(Motion.translation([0.5, 0])) == "moved by (0.5, 0)"


@pytest.mark.parametrize("quarter", range(-5, 6))
def test_quarter_turns_are_exact(quarter):
    turned = POINTS
    for _ in range(quarter % 4):
        turned = np.column_stack([-turned[:, 1], turned[:, 0]])
    assert np.array_equal(Motion.rotation(90.0 * quarter)(POINTS), turned)


@pytest.mark.parametrize("degrees", [-300.0, -17.3, 1e-3, 30.0, 45.0, 360 / 7, 180.0, 200.1, 359.0])
def test_rotations_are_those_of_complex_numbers(degrees):
    center = np.array([3.3, -2.1])
    motion = Motion.rotation(degrees, center)
    z = (POINTS - center) @ [1, 1j] * np.exp(1j * np.radians(degrees))
    found = motion(POINTS)
    assert np.abs((found - center) @ [1, 1j] - z).max() <= 2.0**-48 * np.abs(z).max()
    assert np.array_equal(motion(center), center)
    assert np.array_equal(motion(POINTS[3]), found[3]) and np.array_equal(motion(POINTS[None])[0], found)
    angle = degrees - 360.0 * round(degrees / 360.0)
    assert str(motion).startswith(f"turned by {angle:.6g}°".replace("-180", "180"))


def test_affine_maps_come_back():
    for motion in (Motion.translation([0.1, -7.0]), Motion.rotation(360 / 7), Motion.translation([1, 2, 3])):
        assert Motion.of_affine(motion.affine(), len(motion.shift)) == motion
    away = Motion.rotation(77.0, (5, 1))
    assert np.allclose(Motion.of_affine(away.affine(), 2)(POINTS[:80]), away(POINTS[:80]), atol=1e-13)
    assert "affine" in str(Motion.of_affine(np.diag([2.0, 1, 1, 1]), 3))
