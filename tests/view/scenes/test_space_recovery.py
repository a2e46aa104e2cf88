"""The recovery of an edge as frames: what the captions say is true."""

from __future__ import annotations

import numpy as np

from unstruct import delaunay
from unstruct.plain import refilling as plain
from unstruct.plain.predicates import orient
from unstruct.view import check_frame
from unstruct.view.scenes.space_recovery import edge_recovery_frames, missing_edge_items

EIGHT = [(-6, 0, 0), (6, 0, 0), (-3, 2, 3), (-2, -4, 0), (-3, 1, -4), (3, 2, 3), (1, -4, 0), (3, 2, -3)]


def test_an_edge_that_is_recovered() -> None:
    start = frozenset(positive(*cell) for cell in delaunay(np.array(EIGHT, float)).simplices.tolist())
    steps = list(plain.recovery_steps(EIGHT, start, 0, 1, 6))
    frames = edge_recovery_frames(EIGHT, [start, *(step.cells for step in steps)], 0, 1)
    for one in frames:
        check_frame(one)
    assert [int(one["number"][0]) for one in frames[::3]] == [4, 3, 2, 1]
    assert len(frames) == 12 and frames[-1]["number"] == "0 faces in the way"


def test_a_missing_edge() -> None:
    start = [positive(*cell) for cell in delaunay(np.array(EIGHT, float)).simplices.tolist()]
    items = missing_edge_items(EIGHT, start, 0, 1)
    assert [len(i["data"]) for i in items if i["role"] == "highlight"] == [4]
    assert len(missing_edge_items(EIGHT, start, 0, 1, names=False)) == len(items) - 1


def positive(a: int, b: int, c: int, d: int) -> tuple[int, ...]:
    return (a, b, c, d) if orient([EIGHT[v] for v in (a, b, c, d)]) > 0 else (a, b, d, c)
