"""The sliver with a weighted corner: its center, and whether it is in the weighted Delaunay triangulation."""

from __future__ import annotations

import numpy as np
import pytest

import unstruct
from unstruct import view
from unstruct.view.scenes.space_weights import POLE


@pytest.mark.parametrize("height", [0.02, 0.1, 0.3, 0.8])
@pytest.mark.parametrize("weight", [0.0, 0.01, 0.05, 0.2, 0.9])
def test_the_weighted_triangulation_says_the_same(height: float, weight: float) -> None:
    frame = view.weight_state(height, weight)
    view.check_frame(frame)
    points = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, height), (0, 0, POLE), (0, 0, -POLE)]
    mesh = unstruct.delaunay(points, weights=[0, 0, 0, weight, 0, 0])
    there = {0, 1, 2, 3} in [set(cell) for cell in mesh.simplices.tolist()]
    assert frame["caption"] == ("the sliver stays" if there else "the sliver is gone")
    center = float(frame["number"].split(";")[0].split()[-1])
    assert np.isclose(center, (height**2 - weight) / (2 * height), atol=0.006)
