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
    assert 10.76 < found.least < 10.77
    assert 164.70 < found.most < 164.71


@pytest.mark.parametrize(("bounds", "stencils"), [((10.77, 164.8), "++0-"), ((10.7, 164.7), "+000")])
def test_no_better_bounds_are_proved(bounds: tuple[float, float], stencils: str) -> None:
    found = stuffing_bounds(*bounds, stencils=stencils, halvings=4)
    assert not found.proved
    assert found.failed == (stencils,)


def test_halving_proves_what_whole_boxes_do_not() -> None:
    found = stuffing_bounds(10.809, 164.703, stencils="+000")
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
    assert ALPHA == (0.285, 0.3985)
