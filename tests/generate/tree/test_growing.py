"""Growth: limits, boxes, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from interrupts import interrupt

from unstruct import InputError, quadtree
from unstruct.generate.tree.criteria import by_size
from unstruct.generate.tree.growing import MOST_LEAVES, Limits, as_box, deepest_level, grow
from unstruct.generate.tree.keys import DEEPEST_LEVEL
from unstruct.sizing import as_size

UNIT = np.array([[0.0, 0.0], [1.0, 1.0]])


@pytest.mark.parametrize(
    ("box", "says"),
    [
        (3, r"two corners, shape \(2, 2\)"),
        ("x", "a Domain or a box of two corners is needed, not str"),
        ([[0, 0], [1]], "a Domain or a box"),
        ([[0, 0, 0], [1, 1, 1]], r"shape \(2, 2\), not \(2, 3\)"),
        ([[0, 0], [0, 1]], "positive, finite sides"),
        ([[0, 0], [np.nan, 1]], "must be finite"),
        ([[-1e308, 0], [1e308, 1]], "positive, finite sides"),
        (None, "two corners|Domain or a box"),
    ],
)
def test_boxes_that_are_none(box: object, says: str) -> None:
    with pytest.raises(InputError, match=says):
        as_box(box, 2)
    with pytest.raises(InputError):
        quadtree(box)


def test_corners_in_any_order() -> None:
    assert as_box([(1, 0), (0, 2)], 2).tolist() == [[0, 0], [1, 2]]
    assert quadtree([(1, 1), (0, 0)], 0.5) == quadtree([(0, 0), (1, 1)], 0.5)


def test_the_deepest_level_depends_on_the_place() -> None:
    for d in (2, 3):
        assert deepest_level(np.zeros(d), np.ones(d)) == DEEPEST_LEVEL[d]
        assert deepest_level(np.full(d, 1e8), np.ones(d)) < 24
        assert deepest_level(np.full(d, 1.0), np.full(d, 1e-15)) == 0
    # cells of the deepest level are boxes of their own
    low, side = np.array([1e8, -3.0]), np.array([1.0, 1.0])
    level = deepest_level(low, side)
    planes = low[0] + side[0] * (np.arange(1 << 10) / (1 << level))
    assert (np.diff(planes) > 0).all()


def test_levels() -> None:
    tree = quadtree(UNIT, min_level=3)
    assert tree.counts.tolist() == [0, 0, 0, 64] and tree.complete
    with pytest.warns(match="64 leaves are not divided as asked: level 3, the deepest"):
        tree = quadtree(UNIT, 0.01, max_level=3)
    assert tree.counts.tolist() == [0, 0, 0, 64] and len(tree.unfinished) == 64
    assert tree.reason == "further divisions were refused: level 3, the deepest"


def test_budget() -> None:
    """A level that would exceed the budget is not begun."""
    growth = grow(UNIT, [by_size(as_size(0.01))], Limits(0, 30, 100))
    assert growth.tree.depth == 3 and [*growth.refused] == [3] and len(growth.refused[3]) == 64
    with pytest.warns(match="budget of 100 cells"):
        tree = quadtree(UNIT, 0.01, budget=100)
    assert len(tree) == 64 <= 100 < MOST_LEAVES
    np.testing.assert_array_equal(tree.unfinished, np.arange(64))


def test_unfinished_leaves_after_balancing_are_leaves() -> None:
    at = np.array([0.3, 0.3])
    with pytest.warns(match="leaves are not divided"):
        tree = quadtree(UNIT, lambda x: 1e-6 + 0.1 * np.abs(x - at).max(axis=1), max_level=6)
    assert (tree.levels[tree.unfinished] == 6).all() and tree.locate(at) in tree.unfinished


def test_interrupts_are_heard_between_levels(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = interrupt(monkeypatch, lambda: quadtree(UNIT, 0.01, progress=True), "cells", at=3)
    assert steps == [3, 12, 48]  # leaves that each level adds


def test_progress(capsys: pytest.CaptureFixture[str]) -> None:
    tree = quadtree(UNIT, 0.1, progress=True)
    assert tree == quadtree(UNIT, 0.1) and "cells" in capsys.readouterr().err
