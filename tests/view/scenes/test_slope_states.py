"""The gradients of an interpolation error: each is that of a quadratic function, which is solved for here."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from unstruct import InputError
from unstruct.simplex import angles, circumcenter, circumradius
from unstruct.view import check_frame
from unstruct.view.scenes.slope_states import SLOPE_FEET, SLOPE_HEIGHTS, slope_bounds, slope_state


@pytest.mark.parametrize("height", SLOPE_HEIGHTS)
def test_the_whole_range(height: float) -> None:
    for foot in SLOPE_FEET:
        one = slope_state(height, foot)
        check_frame(one)
        radius, farthest = (float(part.split()[-1]) for part in one["number"].split(",")[1:3])
        triangle = np.array([[foot, height], [-1, 0], [1, 0]])
        assert abs(radius - circumradius(triangle)) < 0.006
        at = np.linalg.norm(slope_bounds(triangle), axis=1)
        assert abs(farthest - at.max()) < 0.006 and np.isclose(at[0], circumradius(triangle))
        obtuse = angles(triangle)[0] >= np.pi / 2
        assert (one["caption"].startswith("the farthest")) == obtuse
        assert at.max() < np.sqrt(3) * circumradius(triangle) * (1 + 1e-12) or angles(triangle)[0] < np.pi / 3


def test_each_corner_is_the_error_of_a_function_of_second_derivatives_one_along_the_sides() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        c, a, b = rng.uniform(-1, 1, (3, 2))
        for signs, bound in zip(((-1, -1), (1, -1), (1, 1), (-1, 1)), slope_bounds([c, a, b])):
            for sign, end in zip(signs, (a, b)):
                assert np.isclose(bound @ (end - c), sign * ((end - c) ** 2).sum() / 2)


def test_the_first_corner_is_the_error_of_half_the_square() -> None:
    for c, a, b in itertools.islice(itertools.permutations(np.random.default_rng(1).random((5, 2)), 3), 20):
        assert np.allclose(slope_bounds([c, a, b])[0], c - circumcenter(np.array([c, a, b])))


def test_unknown_values() -> None:
    with pytest.raises(InputError, match="height = 0 must"):
        slope_state(0)
    with pytest.raises(InputError, match="foot = 2 must"):
        slope_state(1, 2)
