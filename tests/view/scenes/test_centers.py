"""The widget of circumcenter insertion: every state of every preset, and what its captions say."""

import json
import re

import numpy as np
import pytest

from unstruct import InputError, view
from unstruct.view.scenes.centers import CENTERS


def numbers(frame: dict) -> dict[str, float]:
    return {k: float(v) for k, v in re.findall(r"(\S+) = ([\d.e+-]+)", frame["number"])}


@pytest.mark.parametrize("preset", CENTERS)
def test_over_its_whole_range(preset):
    history = view.circumcenter_history(preset)
    for step, frame in enumerate(history):
        view.check_frame(frame)
        assert frame == view.circumcenter_state(step, preset)
        assert set(numbers(frame)) == {"R", "l", "μ"}
    assert "And so on" in history[-1]["caption"]
    for step in (-1, len(history)):
        with pytest.raises(InputError, match="must lie between"):
            view.circumcenter_state(step, preset)


def test_without_a_boundary_nothing_rises():
    radii = [numbers(frame)["R"] for frame in view.circumcenter_history()]
    assert (np.diff(radii) <= 0).all() and radii[-1] < radii[0]
    assert not any("risen" in frame["caption"] for frame in view.circumcenter_history())


def test_the_kept_triangle_shows_the_failure():
    history = view.circumcenter_history("nasty: a triangle, its edges kept")
    radii = [numbers(frame)["R"] for frame in history]
    assert radii[1] > 3 * radii[0] and radii[-1] == radii[1]
    assert "risen" in history[1]["caption"] and "outside" in history[1]["caption"]
    mended = view.circumcenter_history("the same triangle, its edges split")
    assert numbers(mended[-1])["R"] < radii[0] and any("halve" in f["caption"] for f in mended)


def test_unknown_preset():
    with pytest.raises(InputError, match="no preset"):
        view.circumcenter_state(0, "a sphere")


def test_the_shell_holds_all_presets():
    panel = view.circumcenters()
    assert [v["name"] for v in panel.player.variants] == list(CENTERS)
    assert len(json.dumps(panel.player.variants)) < 150_000
    assert repr(panel).startswith("Panel(preset: ")
