"""The spring criterion at one edge, and layers over a wall."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct.plain import layers as plain
from unstruct.view import check_frame
from unstruct.view.scenes.springs import SPRING_X, SPRING_Y, spring_state, stretch_state


@pytest.mark.parametrize("height", [0.1, 0.4, 0.8])
def test_the_whole_range_of_the_springs(height: float) -> None:
    a, b = (0.0, 0.0), (1.0, 0.0)
    new = (0.0, height), (1.0, height)
    said = set()
    for x in SPRING_X:
        for y in SPRING_Y:
            one = spring_state(x, y, height)
            check_frame(one)
            near = plain.near(a, b, new, [(x, y)])
            assert ("is near" in one["caption"]) == near
            assert ((x, y) in [tuple(p) for p in one["items"][0]["data"]]) == near
            said.add(one["caption"])
    assert len(said) >= 3


def test_the_sentences_of_the_springs() -> None:
    for place, text in (
        ((0.4, 0.8), "less force"), ((0.4, 0.4), "no spring is stretched"), ((0.4, 1.6), "the layer is made"),
        ((0.4, -0.8), "no valid cell"), ((0.4, 0.0), "no valid cell"),
    ):  # fmt: skip
        assert text in spring_state(*place, 0.4)["caption"]


def test_the_whole_range_of_the_layers() -> None:
    for first in (0.001, 0.003, 0.01, 0.03, 0.099):
        for growth in (1.05, 1.1, 1.3, 1.5, 2.0):
            one = stretch_state(first, growth)
            check_frame(one)
            count = int(one["caption"].split()[0])
            heights = first * growth ** np.arange(count + 1)
            assert heights[-1] >= 0.1 * (1 - 1e-9) and (heights[:-1] < 0.1).all()
            thick, low, high = (float(word.strip(",")) for word in one["number"].split() if word[0].isdigit())
            assert low - 0.01 <= thick <= high + 0.01
            assert thick == pytest.approx(heights[:-1].sum(), abs=0.006)
