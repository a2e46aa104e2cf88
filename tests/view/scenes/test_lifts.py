"""The lifted line: what is below it is what is inside the interval, by fractions."""

from __future__ import annotations

from fractions import Fraction

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.lifts import LIFT_CENTERS, LIFT_PLACES, LIFT_RADII, lift_state


@pytest.mark.parametrize("center", LIFT_CENTERS)
@pytest.mark.parametrize("radius", LIFT_RADII)
def test_the_whole_range(center: float, radius: float) -> None:
    one = lift_state(center, radius)
    check_frame(one)
    low, high = Fraction(center) - Fraction(radius), Fraction(center) + Fraction(radius)
    inside = [name for name, x in zip("ABCDE", LIFT_PLACES) if low < Fraction(x) < high]
    on = [name for name, x in zip("ABCDE", LIFT_PLACES) if Fraction(x) in (low, high)]
    caption = f"inside and below: {', '.join(inside)}" if inside else "empty: nothing is below"
    assert one["caption"] == caption + (f"; on the line: {', '.join(on)}" if on else "")
    assert ("-" in one["number"]) == bool(inside)


def test_values_out_of_range() -> None:
    with pytest.raises(InputError, match="center = 2 must lie between"):
        lift_state(2, 1)
    with pytest.raises(InputError, match="radius = nan must lie between"):
        lift_state(0, float("nan"))
