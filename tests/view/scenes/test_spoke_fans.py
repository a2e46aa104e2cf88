"""Rounds of midpoints at one vertex: the frames agree with the exact states of the plain version."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import InputError
from unstruct.plain import conforming as plain
from unstruct.view import check_frame
from unstruct.view.scenes.spoke_fans import (
    SPOKE_NUMBERS,
    SPOKE_RATIOS,
    equal_spokes,
    spoke_frames,
    spoke_history,
)


@pytest.mark.parametrize("spokes", SPOKE_NUMBERS)
@pytest.mark.parametrize("ratio", [0.5, *SPOKE_RATIOS])
def test_the_whole_range(spokes: int, ratio: float) -> None:
    frames = spoke_history(spokes, ratio)
    for one in frames:
        check_frame(one)
    endless = plain.period(plain.fan(equal_spokes(spokes, ratio).tolist())) > 0
    assert endless == ("<" in frames[0]["number"]) == ("it ends" not in frames[-1]["caption"])


def test_round_two_is_round_zero_enlarged() -> None:
    frames = spoke_history(10, 0.7)
    red = [next(i["data"] for i in one["items"] if i["role"] == "bad") for one in frames]
    assert np.allclose(red[0], red[2]) and np.allclose(red[1], red[3]) and not np.allclose(red[0], red[1])
    assert [one["caption"] for one in frames[:3]] == [
        "round 0 (1×): 5 missing",
        "round 1 (1×): 5 missing",
        "round 2 (2×): 5 missing",
    ]


def test_other_spokes() -> None:
    frames = spoke_frames([(3, 2), (4, 3), (-4, 3), (-2, 1), (-1, -3), (-1, -4)], 12)
    assert len(frames) == 13 and "missing" in frames[-1]["number"]
    assert "it ends" in spoke_frames([(1, 0), (0, 1)])[-1]["number"]


@pytest.mark.parametrize("values", [(7, 0.7), (10, 0.4), (10, 1.1), (10, float("nan"))])
def test_values_out_of_range_are_refused(values: tuple) -> None:
    with pytest.raises(InputError):
        spoke_history(*values)
