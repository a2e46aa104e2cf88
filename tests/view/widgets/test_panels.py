"""Panels: the frames of the whole grid are stored, each once, and are what the function gives."""

import base64
import json
import zlib

import numpy as np
import pytest

import unstruct
from unstruct import InputError, view
from unstruct.view import frames as fr
from unstruct.view.widgets.panels import MOST_STATES

POINTS = np.random.default_rng(0).random((40, 2))
MESH = fr.mesh_items(POINTS, unstruct.delaunay(POINTS).simplices)
GRID = {"preset": ["plain", "nasty"], "x": np.linspace(0, 1, 12), "y": range(8)}


def state(preset, x, y):
    point = fr.dots("inserted", [[x, y / 7]], handles=["P"])
    more = [fr.circles("circumcircle", [[x, y / 7]], [0.1])] if preset == "nasty" else []
    return fr.frame(f"{preset}: P at {x:.2f}, {y}", *MESH, point, *more, number=f"x y = {x * y:.2f}")


def unpacked(made):
    whole = json.loads(zlib.decompress(base64.b64decode(made.packed)))
    return [
        [{**frame, "items": [whole["items"][k] for k in frame["items"]]} for frame in frames]
        for frames in whole["histories"]
    ]


def test_every_state_of_the_grid_is_stored():
    made = view.panel(state, GRID, alt="a point in a mesh.", start={"preset": "nasty"})
    stored = unpacked(made)
    assert len(stored) == 2 * 12 * 8 and made.variant == 96
    assert made.frames == stored[96]
    assert [axis["list"] for axis in made.grid] == [True, False, False]
    assert [axis["start"] for axis in made.grid] == [1, 0, 0]
    assert made.grid[1]["values"][1] == "0.0909091" and made.grid[2]["values"][7] == "7"
    for number, (preset, x, y) in enumerate(
        (p, x, y) for p in GRID["preset"] for x in GRID["x"] for y in GRID["y"]
    ):
        (frame,) = stored[number]
        wanted = state(preset, x, y)
        assert [frame["caption"], frame["number"]] == [wanted["caption"], wanted["number"]]
        for item, other in zip(frame["items"], wanted["items"], strict=True):
            assert item["role"] == other["role"]
            assert all(np.allclose(a, b, atol=2e-4) for a, b in zip(item["data"], other["data"], strict=True))
    assert len(made.packed) < 6000, "the mesh, which stays, is stored once"


def test_a_state_may_be_a_history():
    def steps(count):
        return [fr.frame(f"step {k}", fr.dots("vertex", [[0, 0], [k, 1]])) for k in range(count)]

    made = view.panel(steps, {"count": [2, 5]}, alt="points.", labels={"count": "number of steps"})
    assert [len(frames) for frames in unpacked(made)] == [2, 5]
    assert made.grid[0]["label"] == "number of steps"
    assert made.view[1] > 4, "the window holds all frames"
    assert made.still()[:4] == b"\x89PNG"


@pytest.mark.parametrize(
    ("grid", "options", "said"),
    [
        ({}, {}, "one to 3 parameters, not 0"),
        ({name: [1, 2] for name in "abcd"}, {}, "one to 3 parameters, not 4"),
        ({"x": [1]}, {}, "x needs at least two values"),
        ({"x": [1, 2, 1]}, {}, "x has a value twice"),
        ({"x": range(MOST_STATES + 1)}, {}, "3001 combinations"),
        ({"x": [0, 1]}, {"start": {"y": 1}}, "start names 'y'"),
        ({"x": [0, 1]}, {"labels": {"y": "a"}}, "labels names 'y'"),
        ({"x": [0, 1]}, {"start": {"x": 0.5}}, r"x=0.5, which is not in the grid: \[0, 1\]"),
        ({"x": [0, np.float64("nan")]}, {}, r"state\(x=nan\): item 0"),
    ],
)
def test_errors_name_the_parameter(grid, options, said):
    def point(x):
        return fr.frame("a", fr.dots("vertex", [[x, 0], [1, 1]]))

    with pytest.raises(InputError, match=said):
        view.panel(point, grid, alt="a point.", **options)


def test_a_state_without_frames_is_named():
    with pytest.raises(InputError, match=r"state\(x='a'\) gives no frame"):
        view.panel(lambda x: [], {"x": ["a", "b"]}, alt="nothing.")
