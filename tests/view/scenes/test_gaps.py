"""Layers in a channel that narrows."""

from __future__ import annotations

import pytest

from unstruct.view import check_frame
from unstruct.view.scenes.gaps import gap_state


@pytest.mark.parametrize("stop", ["nearest", "spring"])
@pytest.mark.parametrize("first", [0.005, 0.02, 0.05])
def test_the_whole_range(stop: str, first: float) -> None:
    for gap in (0.1, 0.4, 1.2):
        one = gap_state(gap, first, stop)
        check_frame(one)
        left, right = (int(word) for word in one["number"].replace(",", "").split() if word.isdigit())
        assert left >= right >= 0 and left > 0


def test_a_narrow_end_has_fewer_layers() -> None:
    wide, narrow = gap_state(1.2)["number"], gap_state(0.1)["number"]
    assert wide != narrow and int(narrow.split()[-4]) < int(wide.split()[-4])
