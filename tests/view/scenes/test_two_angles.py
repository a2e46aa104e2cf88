"""The two angles of an edge: captions agree with all triangulations of the four points."""

from __future__ import annotations

from itertools import combinations, product

import pytest

from unstruct import InputError
from unstruct.plain.triangulations import all_triangulations, is_delaunay
from unstruct.view import check_frame
from unstruct.view.scenes.two_angles import TWO_ANGLE_X, TWO_ANGLE_Y, TWO_ANGLES, two_angle_state


@pytest.mark.parametrize("preset", TWO_ANGLES)
def test_the_whole_range(preset: str) -> None:
    words = {True: "every", False: "missing", None: "some"}
    for x, y in product(TWO_ANGLE_X, TWO_ANGLE_Y):
        one = two_angle_state(x, y, preset)
        check_frame(one)
        points = [(-1, 0), (1, 0), (x, y), TWO_ANGLES[preset]]
        best = [cells for cells in all_triangulations(points) if is_delaunay(points, cells)]
        has = {any({0, 1} <= set(t) for t in cells) for cells in best}
        assert words[has.pop() if len(has) == 1 else None] in one["caption"]


def test_a_tie_leaves_one_center() -> None:
    assert "one circle is left" in two_angle_state(0.0, 1.0)["caption"]
    assert "90.0° + 90.0° = 180.0°" in two_angle_state(0.0, 1.0)["number"]


@pytest.mark.parametrize("values", [(3, 1), (0, 0), (0, 3), (float("nan"), 1), (0, 1, "none")])
def test_values_out_of_range_are_refused(values: tuple) -> None:
    with pytest.raises(InputError):
        two_angle_state(*values)


def test_the_grid_has_every_kind() -> None:
    found = {two_angle_state(x, y, name)["caption"][:12] for x, y in product(TWO_ANGLE_X, TWO_ANGLE_Y)
             for name in TWO_ANGLES}  # fmt: skip
    assert len(found) == 3 and all(len(set(pair)) == 2 for pair in combinations(found, 2))
