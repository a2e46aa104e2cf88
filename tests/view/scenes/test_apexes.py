"""A triangle whose apex moves: its circles are right, and the number is what the formulas say."""

from __future__ import annotations

from math import atan2, degrees, hypot

import numpy as np
import pytest

from unstruct import InputError
from unstruct.view import apex_state, check_frame


@pytest.mark.parametrize("x", np.linspace(-1, 2, 7))
@pytest.mark.parametrize("y", [0.01, 0.3, 0.85, 1.6])
def test_the_whole_range(x: float, y: float) -> None:
    one = apex_state(x, y)
    check_frame(one)
    outer, inner = (i["data"][0] for i in one["items"] if i["kind"] == "circles")
    for p in ((0, 0), (1, 0), (x, y)):
        assert abs(hypot(p[0] - outer[0], p[1] - outer[1]) / outer[2] - 1) < 1e-9
    for a, b in (((0, 0), (1, 0)), ((1, 0), (x, y)), ((x, y), (0, 0))):  # the distance of each side
        cross = (b[0] - a[0]) * (inner[1] - a[1]) - (b[1] - a[1]) * (inner[0] - a[0])
        assert abs(cross / hypot(b[0] - a[0], b[1] - a[1]) - inner[2]) < 1e-9
    ratio = 2 * inner[2] / outer[2]
    angles = [degrees(atan2(y, x)), degrees(atan2(y, 1 - x))]
    angles.append(180 - sum(angles))
    assert one["number"] == f"2r/R = {ratio:.2f}, minimum angle {min(angles):.0f}°"
    assert ratio <= 1 and one["caption"].startswith("a cap") == (max(angles) > 120)
    assert one["caption"].startswith("a needle") == (max(angles) <= 120 and min(angles) < 30)


@pytest.mark.parametrize(("x", "y"), [(2.1, 1), (0, 0), (0, 2), (float("nan"), 1)])
def test_wrong_places(x: float, y: float) -> None:
    with pytest.raises(InputError, match="must lie between"):
        apex_state(x, y)
