"""Where a front wants its next point: the two panels of 3.2 over their whole range."""

from __future__ import annotations

from math import radians, sqrt

import pytest

from unstruct.plain import front_points as rules
from unstruct.view import check_frame
from unstruct.view.scenes.wish_states import AHEAD_X, AHEAD_Y, RULE_ANGLES, ahead_state, angle_rule_state


@pytest.mark.parametrize("size", [0.6, 1.0, 1.6])
def test_the_whole_range_of_corners(size: float) -> None:
    counts = []
    for angle in RULE_ANGLES:
        one = angle_rule_state(angle, size)
        check_frame(one)
        counts.append(rules.parts(radians(angle)))
        word = {1: "closed", 2: "two", 3: "three", 4: "equal sides"}[counts[-1]]
        assert word in one["caption"]
        off = [float(x) for x in one["number"].split("are ")[1].split(" off")[0].split(", ")]
        assert off[counts[-1] - 1] == min(off)
    assert sorted(set(counts)) == [1, 2, 3, 4] and counts == sorted(counts)


@pytest.mark.parametrize("size", [0.5, 1.0, 1.5])
def test_the_whole_range_of_corners_ahead(size: float) -> None:
    said = {}
    for x in AHEAD_X:
        for y in AHEAD_Y:
            one = ahead_state(x, y, size)
            check_frame(one)
            reason, taken = rules.ahead((0.0, 0.0), (1.0, 0.0), (x, y), size)
            assert ("inserted" in one["caption"]) == (reason == "new point")
            assert ((x, y) in [tuple(p) for p in one["items"][0]["data"]]) == (reason == "new point")
            radius = float(one["number"].split()[2].rstrip(";"))
            assert abs(radius - 1.2 * size / sqrt(3)) < 0.01 or (
                (reason == "small enough") == (radius < 1.2 * size / sqrt(3))
            )
            said[reason] = said.get(reason, 0) + 1
            assert taken == (x, y) or reason == "new point"
    assert len(said) >= (3 if size > 0.5 else 2) and said["new point"] > 10


def test_the_sentences_of_the_corner_ahead() -> None:
    for place, text in (
        ((0.4, 1.0), "small enough"), ((0.4, 2.4), "X has room"), ((1.4, 0.8), "moved back"),
        ((0.6, 1.4), "too near"),
    ):  # fmt: skip
        assert text in ahead_state(*place, 1.0)["caption"]
