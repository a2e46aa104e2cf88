"""The pictures of diagonal swapping: every state over its whole range; what they show is exactly so."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct import InputError, view
from unstruct.plain.lawson import least_angle_choice
from unstruct.plain.predicates import in_sphere, orient
from unstruct.view.scenes.swaps import CORNER_X, CORNER_Y, QUADRILATERALS, RUNS


@pytest.mark.parametrize("preset", QUADRILATERALS)
def test_the_choice_over_its_whole_range(preset):
    for x in (*CORNER_X, *np.linspace(-2, 2, 9)):
        for y in (*CORNER_Y, *np.linspace(-2, 2, 9)):
            view.check_frame(view.diagonal_choice_state(x, y, preset))
    x, y = QUADRILATERALS[preset]["start"]
    assert x in CORNER_X and y in CORNER_Y


@given(st.sampled_from(list(QUADRILATERALS)), st.integers(-8, 8), st.integers(-8, 8))
def test_the_caption_is_the_exact_choice(preset, i, j):
    frame = view.diagonal_choice_state(i / 4, j / 4, preset)
    ring = [*map(tuple, QUADRILATERALS[preset]["triangle"]), (i / 4, j / 4)]
    if orient([ring[0], ring[2], ring[3]]) <= 0:
        assert "beyond AC" in frame["caption"]
    elif min(orient([ring[k - 2], ring[k - 1], ring[k]]) for k in range(4)) <= 0:
        assert "not strictly convex" in frame["caption"] and in_sphere(ring[:3], ring[3]) <= 0
    else:
        word = {1: "inside", -1: "outside", 0: "on the circle"}[least_angle_choice(*ring)]
        assert word in frame["caption"] and "minimum angle: AC" in frame["number"]


def test_the_presets_show_what_they_promise():
    start = {
        name: view.diagonal_choice_state(*QUADRILATERALS[name]["start"], name) for name in QUADRILATERALS
    }
    assert "on the circle" in start["a rectangle: a tie"]["caption"]
    grows = start["the largest angle grows"]
    assert "BD replaces AC" in grows["caption"] and "maximum: AC 108.4°, BD 135.0°" in grows["number"]
    worse = start["one triangle gets worse"]
    assert "minimum angle: AC 18.4°, BD 26.6°" in worse["number"]


@pytest.mark.parametrize("preset", RUNS)
def test_runs_step_through_and_rise(preset):
    history = view.swap_history(preset)
    assert len(history) >= 4
    for k, frame in enumerate(history):
        assert view.swap_state(k, preset) == frame
        view.check_frame(frame)
    bars = []
    for frame in history:
        boxes = [b for i in frame["items"] if i["kind"] == "polygons" for b in i["data"] if b[0][0] >= 9]
        bars.append([h for _, h in sorted((b[0][0], b[2][1]) for b in boxes)])
    for before, after in pairwise(bars[:-1]):
        assert after > before  # lexicographically
    assert bars[-1] == bars[-2] and len(set(map(len, bars))) == 1
    for wrong in (-1, len(history)):
        with pytest.raises(InputError, match="step"):
            view.swap_state(wrong, preset)


@pytest.mark.parametrize(
    "call",
    [
        lambda: view.diagonal_choice_state(3, 0),
        lambda: view.diagonal_choice_state(float("nan"), 0),
        lambda: view.diagonal_choice_state(0, 0, "no such"),
        lambda: view.swap_state(0, "no such"),
    ],
)
def test_values_out_of_range_are_refused(call):
    with pytest.raises(InputError):
        call()


def test_the_choice_needs_no_kernel():
    panel = view.diagonal_choice()
    columns = {row["label"]: row["values"] for row in panel.grid}
    assert columns["preset"] == list(QUADRILATERALS)
    assert [len(columns[name]) for name in ("x of D", "y of D")] == [len(CORNER_X), len(CORNER_Y)]
    first = next(iter(QUADRILATERALS))
    shown = view.diagonal_choice_state(*QUADRILATERALS[first]["start"], first)
    assert panel.frames[0]["caption"] == shown["caption"]


def test_the_runs_need_no_kernel():
    panel = view.diagonal_swaps()
    assert [v["name"] for v in panel.player.variants] == list(RUNS) and not panel.controls
    assert [len(v["frames"]) for v in panel.player.variants] == [len(view.swap_history(n)) for n in RUNS]
