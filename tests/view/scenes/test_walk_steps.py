"""Walks: the power of P never rises in a Delaunay triangulation, and no triangle is entered twice."""

from __future__ import annotations

from itertools import pairwise

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.walk_steps import WALKS, walk_history


@pytest.mark.parametrize("preset", WALKS)
def test_walks(preset):
    frames = walk_history(preset)
    for one in frames:
        check_frame(one)
    assert len(frames) <= 12 and len({tuple(one["view"]) for one in frames}) == 1
    powers = [float(one["number"].split("= ")[1]) for one in frames]
    if preset.startswith("nasty"):
        assert powers[0] == powers[-1] and "never ends" in frames[-1]["caption"]
        assert any(p < q for p, q in pairwise(powers))
    else:
        assert all(p >= q for p, q in pairwise(powers)) and powers[-1] < 0
        assert frames[-1]["caption"].startswith("P is in")
        assert any(p == q for p, q in pairwise(powers)) == preset.startswith("ties")


def test_an_unknown_walk_is_refused():
    with pytest.raises(InputError, match="no preset"):
        walk_history("uphill")


def test_all_walks_fit_the_window_of_the_first():
    """A panel shows all its presets in the window of the first frame."""
    x0, x1, y0, y1 = walk_history()[0]["view"]
    for given in WALKS.values():
        assert all(x0 < x < x1 and y0 < y < y1 for x, y in [*given["points"], given["P"]])
