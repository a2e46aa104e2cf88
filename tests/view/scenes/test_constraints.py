"""Frames of constrained insertion and of principal components, over the whole range of their parameters."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.constraints import (
    COMPONENTS,
    SEGMENT_EXAMPLES,
    principal_component_state,
    segment_history,
    segment_state,
)
from unstruct.view.widgets.constraint_widgets import constrained_insertion, principal_component


@pytest.mark.parametrize("preset", SEGMENT_EXAMPLES)
def test_segment_histories(preset):
    frames = segment_history(preset)
    assert 6 <= len(frames) <= 18 and len({tuple(f["view"]) for f in frames}) == 1
    for one in frames:
        check_frame(one)
    assert any("crossed" in f["number"] for f in frames)
    assert segment_state(-3, preset) == frames[0] and segment_state(10**6, preset) == frames[-1]
    come, gone = frames[-2 if "refused" in frames[-1]["caption"] else -1]["number"].split(" of ")
    assert come.split(" = ")[1] == gone, "as many triangles come as go"


def test_the_presets_show_what_they_say():
    assert any("each part" in f["caption"] for f in segment_history("a vertex on the way"))
    assert "refused" in segment_history("nasty: two that cross")[-1]["caption"]
    assert sum("is to be an edge" in f["caption"] for f in segment_history("two segments")) == 2
    hanging = segment_history("nasty: an edge that hangs in")
    shown = [i for f in hanging if "two polygons" in f["caption"] for i in f["items"]]
    (around,) = [i for i in shown if i["role"] == "edge"]
    assert [[0.0, 4.0], [0.0, 1.2]] in around["data"], "the edge that hangs in stays"


@pytest.mark.parametrize("preset", COMPONENTS)
def test_components_over_their_range(preset):
    seen = set()
    for x in np.linspace(0, 1, 13):
        for y in np.linspace(0, 1, 13):
            one = principal_component_state(float(x), float(y), preset)
            check_frame(one)
            seen.add(one["number"].split(" = ")[0])
            if "hidden" in one["number"]:
                assert one["number"].endswith("hidden from P = 0"), (x, y, one)
    assert "edges of the component" in seen
    if "fixed" in preset:
        assert "Υ_P does not exist" in seen


def test_components_refuse():
    for x, y, preset in [(1.2, 0, "two pieces"), (0, -0.1, "two pieces"), (0.5, 0.5, "nothing")]:
        with pytest.raises(InputError):
            principal_component_state(x, y, preset)
    with pytest.raises(InputError, match="no preset"):
        segment_history("nothing")


def test_panels():
    panel = constrained_insertion()
    assert [v["name"] for v in panel.player.variants] == list(SEGMENT_EXAMPLES)
    panel = principal_component()
    assert [len(one["values"]) for one in panel.grid] == [len(COMPONENTS), 19, 19]
    first = principal_component_state(0.8, 0.25, next(iter(COMPONENTS)))
    assert panel.frames[0]["caption"] == first["caption"] and panel.frames[0]["number"] == first["number"]
