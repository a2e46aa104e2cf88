"""The classical front in space on three bodies, from all sides."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.space_march_states import MARCH_SIDES, MARCH_WINDOW, MARCHES, march_state


@pytest.mark.parametrize("body", list(MARCHES))
def test_the_whole_range_of_marches(body: str) -> None:
    ends = {"seven points": "is empty", "eight points": "with 8 faces", "seven points, stuck": "with 8 faces"}
    captions = [one["caption"] for one in march_state(body)]
    frames = {"seven points": 9, "eight points": 5, "seven points, stuck": 6}
    assert ends[body] in captions[-1] and len(captions) == frames[body]
    for side in MARCH_SIDES:
        turned = march_state(body, side)
        assert [one["caption"] for one in turned] == captions
        for one in turned:
            check_frame(one)
            for item in one["items"]:
                if item["kind"] == "polygons":
                    xy = np.concatenate([np.asarray(row) for row in item["data"]])
                    assert (np.abs(xy) <= MARCH_WINDOW[1] - 0.05).all()


def test_another_body_is_refused() -> None:
    with pytest.raises(InputError, match="seven points"):
        march_state("a cube")
