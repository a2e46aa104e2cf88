"""Layers around the notched body, over the range of the panel."""

from __future__ import annotations

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.prism_states import PRISM_STOPS, prism_state


@pytest.mark.parametrize("stop", PRISM_STOPS)
def test_the_whole_range(stop: str) -> None:
    lowered = []
    for first in (0.01, 0.02, 0.04, 0.07):
        for growth in (1.0, 1.4):
            one = prism_state(first, growth, stop)
            check_frame(one)
            kinds = {(item["kind"], item["role"]): item["data"] for item in one["items"]}
            assert len(kinds["polygons", "cell"]) > 100 and len(kinds["points", "inserted"]) == 1
            lowered.append(len(kinds["segments", "highlight"]))
            assert ("100%" in one["number"]) == (lowered[-1] == 0)
            assert float(one["number"].split()[-1]) > 0
    assert lowered[0] == 0 < lowered[-1]


def test_an_unknown_rule() -> None:
    with pytest.raises(InputError, match="stop = 'go' must be one of 'squeeze', 'stop'"):
        prism_state(0.02, 1.2, "go")
