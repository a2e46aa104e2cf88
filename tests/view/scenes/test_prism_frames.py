"""The bar with a groove: what its nine pictures say is true."""

from __future__ import annotations

import pytest

from unstruct.plain import prisms
from unstruct.view import check_frame
from unstruct.view.scenes.prism_frames import GROOVE_NAMES, groove, groove_frames, groove_layers


def turned(heights: list[float]) -> list[str]:
    """The sides whose columns are not positive at these heights of the corners."""
    points, triangles = groove()
    rays = groove_layers()["directions"] * 2
    tops = prisms.layer_places(points, rays, heights * 2, [1.0])[0]
    found = []
    for k, t in enumerate(triangles):
        if not prisms.wedge_is_positive([points[v] for v in t], [tops[v] for v in t]):
            found.append(GROOVE_NAMES[k // 2] + GROOVE_NAMES[(k // 2 + 1) % 8])
    return sorted(set(found))


def test_the_frames() -> None:
    frames, made = groove_frames(), groove_layers()
    for one in frames:
        check_frame(one)
    assert [one["view"] for one in frames] == [frames[0]["view"]] * 9
    assert made["turned"] == [4] and "EF turned over" in frames[4]["number"]
    assert turned([1.3] * 8) == ["EF"] and not turned([0.39] * 8) and "0.4" in frames[3]["number"]
    least = min(made["limit"])
    assert not turned([least - 1e-6] * 8) and turned([least + 1e-6] * 8) == ["EF"]
    assert f"height {least:.2f}: EF" in frames[5]["number"]


def test_limits_and_gradation() -> None:
    made = groove_layers()
    assert not turned(made["limited"]) and not turned(made["heights"])
    assert sum(h < 1.3 for h in made["limited"]) == 2
    assert sum(h < g for h, g in zip(made["heights"], made["limited"])) == 2
    levels = made["places"]
    assert len(levels) == 5 and {y for row in levels for _, y, _ in row} == {0.0}


@pytest.mark.parametrize("wanted", [0.2, 0.8, 3.0])
def test_other_heights(wanted: float) -> None:
    for one in groove_frames(wanted):
        check_frame(one)
    assert not turned(groove_layers(wanted)["heights"])
