"""Scenes in space as frames: what is in front is painted last, and all steps of an insertion can be drawn."""

from __future__ import annotations

import numpy as np

from unstruct.plain import bowyer_watson_space as plain
from unstruct.view import check_frame, item3
from unstruct.view.scenes.space_frames import bodies, space_frame
from unstruct.view.scenes.space_insertion import space_insertion_frames

CUBE = [[k & 1, k >> 1 & 1, k >> 2 & 1] for k in range(8)]


def test_the_nearer_face_is_painted_later() -> None:
    near, far = [[0, 2, 3], [1, 3, 7]], [[0, 1, 2]]
    scene = [item3("polygons", "bad", near[:1], CUBE), item3("polygons", "cell", far, CUBE)]
    for azimuth in (0, 90, 200):
        one = space_frame(scene, "two faces", azimuth=azimuth, elevation=10)
        check_frame(one)
        toward = np.array([np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth)), np.tan(np.radians(10))])
        middles = {i["role"]: np.mean([CUBE[v] for v in i["data"][0]], axis=0) @ toward for i in scene}
        shown = [i["role"] for i in one["items"]]
        assert shown == sorted(middles, key=middles.get)


def test_every_kind() -> None:
    scene = [
        bodies("cavity", [(0, 1, 2, 4)], CUBE),
        bodies("accepted", [], CUBE),
        item3("segments", "edge", [[0, 7]], CUBE),
        item3("points", "vertex", CUBE),
        item3("labels", "vertex", CUBE[:2], text="AB"),
        item3("spheres", "circumcircle", [[0.5, 0.5, 0.5, 0.9]]),
    ]
    one = space_frame(scene, "all", number="1")
    check_frame(one)
    assert {i["kind"] for i in one["items"]} == {"polygons", "segments", "points", "labels", "circles"}
    assert sum(len(i["data"]) for i in one["items"] if i["kind"] == "polygons") == 4


def test_an_insertion_has_four_frames_a_point() -> None:
    rows, cells = plain.around([(1, 2, 2), (3, 2, 1), (2, 4, 3)], "cube", 2)
    steps = list(plain.by_insertion(rows, cells, range(3)))
    frames = space_insertion_frames(rows, cells, steps)
    assert len(frames) == 1 + 4 * len(steps)
    for one in frames:
        check_frame(one)
    assert frames[0]["number"] == "5 cells" and frames[3]["number"] == "5 cells go"
    assert frames[4]["number"] == "12 cells come, 12 in all"


def test_cavities_are_listed_by_names() -> None:
    rows, cells = plain.around([(1, 2, 2), (3, 2, 1)], "cube", 2)
    steps = list(plain.by_insertion(rows, cells, range(2)))
    frames = space_insertion_frames(rows, cells, steps, names="XYABCDEFGH")
    assert frames[1]["caption"] == "point X" and frames[5]["caption"] == "point Y"
    listed = frames[3]["number"].removeprefix("5 cells go: ").split(", ")
    assert {frozenset(cell) for cell in listed} == {
        frozenset("XYABCDEFGH"[v] for v in c) for c in steps[0].cavity
    }
