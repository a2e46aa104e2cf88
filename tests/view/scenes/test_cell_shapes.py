"""The tetrahedron with two crossed edges: its measures against plain formulas."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
import pytest

from unstruct import InputError, view
from unstruct.plain.filling import shape

PAIRS = list(combinations(range(4), 2))


def dihedral(x: np.ndarray, i: int, j: int) -> float:
    """The angle at an edge: between the two other corners, seen along the edge."""
    along = (x[j] - x[i]) / np.linalg.norm(x[j] - x[i])
    k, m = sorted({0, 1, 2, 3} - {i, j})
    one, two = (v - (v @ along) * along for v in (x[k] - x[i], x[m] - x[i]))
    return float(np.degrees(np.arccos(one @ two / np.linalg.norm(one) / np.linalg.norm(two))))


def measures(frame: dict) -> list[float]:
    return [float(word) for word in re.findall(r"(?<= )[\d.]+", frame["number"])]


@pytest.mark.parametrize("height", [0.05, 0.1, 0.3, 0.8, 1.4])
@pytest.mark.parametrize("width", [0.05, 0.2, 0.6, 1.0])
def test_the_measures_are_those_of_the_cell(height: float, width: float) -> None:
    frame = view.cell_shape_state(height, width)
    view.check_frame(frame)
    round_, q, angle, ratio = measures(frame)
    corners = [(-1, 0, 0), (1, 0, 0), (0, -width, height), (0, width, height)]
    assert np.isclose(q, float(shape(corners, (0, 1, 2, 3))) ** 0.5, atol=0.006)
    assert abs(angle - min(dihedral(np.array(corners, float), *pair) for pair in PAIRS)) < 0.51
    center = (height**2 + width**2 - 1) / (2 * height)  # on the axis, above AB
    lengths = [2, 2 * width, (1 + width**2 + height**2) ** 0.5]
    assert np.isclose(ratio, (1 + center**2) ** 0.5 / min(lengths), atol=0.006)
    assert 0 < round_ <= 1


def test_nearly_regular_a_sliver_and_a_wedge() -> None:
    assert measures(view.cell_shape_state(1.4, 1.0)) == [1.0, 1.0, 70, 0.61]
    assert "does not see" in view.cell_shape_state(0.1, 1.0)["caption"]
    assert view.cell_shape_state(1.4, 0.05)["caption"] == "a thin cell: R/l is large"


def test_flat_cells_are_refused() -> None:
    with pytest.raises(InputError, match="height"):
        view.cell_shape_state(0.0, 1.0)
    with pytest.raises(InputError, match="width"):
        view.cell_shape_state(1.0, -1.0)
