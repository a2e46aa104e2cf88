"""The proof of the angles: what it proves, what it must not prove, and the intervals below it."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.generate.stuffing.bounds import Interval, stuffing_bounds
from unstruct.generate.stuffing.warping import ALPHA

NUMBERS = st.floats(-1e6, 1e6)


def test_the_theorem() -> None:
    found = stuffing_bounds()
    assert found.proved
    assert found.failed == ()
    assert found.cases > 4000
    assert 10.784 < found.least < 10.785
    assert 164.737 < found.most < 164.738


@pytest.mark.parametrize(
    ("alpha", "bounds", "least", "most"),
    [
        ((0.28511, 0.39882), (10.784, 164.738), 10.7843, 164.7373),  # the largest least angle
        ((0.26649, 0.36918), (8.971, 158.741), 8.9717, 158.7403),  # the smallest largest one
        ((0.24999, 0.41189), (9.3171, 161.6432), 9.3171, 161.6431),  # Labelle's and Shewchuk's safe pair
    ],
)
def test_the_published_bounds(
    alpha: tuple[float, float], bounds: tuple[float, float], least: float, most: float
) -> None:
    """The paper has 10.7 and 164.8, or 8.9 and 158.8, or, with the third pair, 9.3171 and 161.6432."""
    found = stuffing_bounds(*bounds, alpha=alpha)
    assert found.proved
    assert abs(found.least - least) < 1e-4
    assert abs(found.most - most) < 1e-4


def test_no_pair_nearby_has_a_larger_least_angle() -> None:
    """The least angles of two stencils are in balance: other shares make one of them smaller."""

    def least(kind: str, long: float, short: float) -> float:
        return stuffing_bounds(alpha=(long, short), stencils=kind, halvings=0).least

    kinds = ("++0-", "+000")
    best = min(least(kind, *ALPHA) for kind in kinds)
    for long, short in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        alpha = (ALPHA[0] + long * 1e-5, ALPHA[1] + short * 1e-5)
        assert any(least(kind, *alpha) < best for kind in kinds)


@pytest.mark.parametrize(("bounds", "stencils"), [((10.785, 164.8), "++0-"), ((10.7, 164.73), "+000")])
def test_no_better_bounds_are_proved(bounds: tuple[float, float], stencils: str) -> None:
    found = stuffing_bounds(*bounds, stencils=stencils, halvings=4)
    assert not found.proved
    assert found.failed == (stencils,)


def test_halving_proves_what_whole_boxes_do_not() -> None:
    found = stuffing_bounds(9.3171, 161.6432, alpha=(0.24999, 0.41189), stencils="+00-")
    assert found.halvings == 1
    assert found.boxes > found.cases
    assert found.proved


def test_other_shares_fail() -> None:
    assert not stuffing_bounds(alpha=(0.25, 0.36), stencils="++0-", halvings=2).proved


@pytest.mark.parametrize(
    "wrong",
    [{"lower": 95.0}, {"upper": np.nan}, {"alpha": (0.6, 0.3)}, {"stencils": "+-+-"}, {"halvings": -1}],
)
def test_refusals(wrong: dict) -> None:
    with pytest.raises(InputError):
        stuffing_bounds(**wrong)


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
def test_intervals_contain_the_exact_results(a: float, b: float, c: float, d: float) -> None:
    one = Interval(np.array([min(a, b)]), np.array([max(a, b)]))
    two = Interval(np.array([min(c, d)]), np.array([max(c, d)]))
    for x in (a, b):
        for y in (c, d):
            for result, exact in (
                (one + two, Fraction(x) + Fraction(y)),
                (one - two, Fraction(x) - Fraction(y)),
                (one * two, Fraction(x) * Fraction(y)),
            ):
                assert Fraction(float(result.low[0])) <= exact <= Fraction(float(result.high[0]))


def test_the_shares_are_those_of_meshes() -> None:
    assert ALPHA == (0.28511, 0.39882)
