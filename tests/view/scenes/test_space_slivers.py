"""The corner that moves on a sphere: all states of the panel can be drawn, and say what is true."""

from __future__ import annotations

import re

import numpy as np
import pytest

from unstruct.view import check_frame
from unstruct.view.scenes.space_slivers import sliver_state


@pytest.mark.parametrize("seen_from", [-150.0, -60.0, 30.0])
def test_the_whole_range(seen_from: float) -> None:
    for latitude in (0, 2, 10, 45, 90):
        for longitude in (195, 225, 270, 345):
            one = sliver_state(latitude, longitude, seen_from)
            check_frame(one)
            ratio, angle, size = map(float, re.findall(r"\d+\.\d+", one["number"]))
            assert ratio >= 0.6 and 0 <= angle < 90 and 0 <= size < 0.6
            assert (latitude == 0) == one["caption"].startswith("flat")


def test_the_angle_vanishes_at_the_equator_and_the_ratio_does_not_see_it() -> None:
    found = [re.findall(r"\d+\.\d+", sliver_state(latitude)["number"]) for latitude in (40, 10, 2)]
    ratios, angles, sizes = np.array(found, dtype=float).T
    assert (np.diff(angles) < 0).all() and angles[-1] < 3 and (np.diff(sizes) < 0).all()
    assert (ratios < 0.8).all()
