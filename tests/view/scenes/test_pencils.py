"""Circles through an edge: captions and intervals agree with exact signs."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from unstruct import InputError
from unstruct.plain.predicates import in_sphere
from unstruct.view import check_frame
from unstruct.view.scenes.pencils import PENCILS, pencil_state

ENDS = [(-1, 0), (1, 0)]


@pytest.mark.parametrize("preset", PENCILS)
@pytest.mark.parametrize("eighths", [*range(-16, 17, 3), -16, 0, 16])
def test_the_whole_range(preset: str, eighths: int) -> None:
    """The circle with offset t passes through (0, t + sqrt(1 + t^2)): compare with distances as fractions."""
    t = Fraction(eighths, 8)
    one = pencil_state(float(t), preset)
    check_frame(one)
    power = [Fraction(x) ** 2 + (Fraction(y) - t) ** 2 - 1 - t * t for x, y in PENCILS[preset]]
    inside = [name for name, p in zip("CDEFG", power) if p < 0]
    on = [name for name, p in zip("CDEFG", power) if p == 0]
    caption = f"inside: {', '.join(inside)}" if inside else "empty"
    assert one["caption"] == caption + (f"; on the circle: {', '.join(on)}" if on else "")
    if not inside:
        assert "empty for" in one["number"]


@pytest.mark.parametrize("preset", PENCILS)
def test_an_interval_is_claimed_exactly_where_a_circle_of_three_points_is_empty(preset: str) -> None:
    rows = [*ENDS, *PENCILS[preset]]
    found = False
    for q in range(2, len(rows)):
        if rows[q][1]:
            corners = [rows[0], rows[1], rows[q]] if rows[q][1] > 0 else [rows[1], rows[0], rows[q]]
            found = found or all(in_sphere(corners, p) <= 0 for p in rows)
    assert found == ("empty for" in pencil_state(0.0, preset)["number"])


def test_marks_on_the_axis_are_centers() -> None:
    one = pencil_state(0.25)
    (marks,) = (i for i in one["items"] if i["kind"] == "points" and i["role"] == "voronoi")
    for (x, y), (_, t) in zip(PENCILS["five points"], marks["data"]):
        assert np.isclose(x * x + (y - t) ** 2, 1 + t * t)


@pytest.mark.parametrize("offset", [-2.1, 2.1, float("nan")])
def test_wrong_offsets(offset: float) -> None:
    with pytest.raises(InputError, match=r"offset = .* must lie between -2"):
        pencil_state(offset)
