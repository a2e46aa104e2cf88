"""Searches, against all leaves one by one, in boxes of any corners: exact."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from trees import BOXES, exact, in_order, leaves, places, planted, toward

from unstruct import Tree
from unstruct.generate.tree.lookup import cells_of, corners, table_of
from unstruct.plain import tree as plain

CASES = [(d, box) for d in (2, 3) for box in range(3)]
DEEP = {2: [((85, 170), 8), ((255, 0), 3)], 3: [((85, 170, 128), 8), ((0, 0, 255), 2)]}


def queries(tree: Tree, rng: np.random.Generator) -> np.ndarray:
    """A grid, corners of leaves and their nearest doubles, and points far outside."""
    low, high = tree.corners
    rows = rng.integers(len(tree), size=60)
    at = np.where(rng.random((60, tree.dimension)) < 0.5, low[rows], high[rows])
    beside = np.nextafter(at, at + rng.integers(-1, 2, at.shape))
    return np.concatenate([places(tree.box, 5), at, beside, tree.box, 3 * tree.box])


@pytest.mark.parametrize(("d", "box"), CASES)
def test_locate(d: int, box: int) -> None:
    tree = planted(toward(d, DEEP[d]), d, BOXES[d][box])
    low, high = tree.corners
    last = high == tree.box[1]
    points = queries(tree, np.random.default_rng(box))
    for x, found in zip(points, tree.locate(points), strict=True):
        inside = ((low <= x) & ((x < high) | (last & (x == high)))).all(axis=1)
        assert np.flatnonzero(inside).tolist() == ([] if found < 0 else [found])


@pytest.mark.parametrize("d", [2, 3])
@given(data=st.data())
def test_locate_as_by_descent(d: int, data: st.DataObject) -> None:
    cells = data.draw(leaves(d))
    tree = planted(cells, d)
    number = st.integers(0, 64).map(lambda i: i / 64) | st.floats(-0.25, 1.25)
    x = np.array(data.draw(st.lists(st.tuples(*[number] * d), min_size=1, max_size=8)))
    order = in_order(tree)
    assert [None if i < 0 else order[i] for i in tree.locate(x)] == [plain.locate(cells, exact(q)) for q in x]


@pytest.mark.parametrize(("d", "box"), CASES)
def test_in_box(d: int, box: int) -> None:
    tree = planted(toward(d, DEEP[d]), d, BOXES[d][box])
    low, high = tree.corners
    rng = np.random.default_rng(box)
    ends = queries(tree, rng)
    for _ in range(40):
        a, b = np.sort(ends[rng.integers(len(ends), size=2)], axis=0)
        expected = np.flatnonzero(((low <= b) & (high >= a)).all(axis=1))
        assert tree.in_box(a, b).tolist() == expected.tolist()
    assert tree.in_box(tree.box[0], tree.box[1]).tolist() == list(range(len(tree)))


@pytest.mark.parametrize(("d", "box"), CASES)
def test_nearest(d: int, box: int) -> None:
    """No other leaf is nearer, by squares of distances in doubles; of equal ones the first."""
    tree = planted(toward(d, DEEP[d]), d, BOXES[d][box])
    low, high = tree.corners
    rng = np.random.default_rng(box)
    x = queries(tree, rng)
    for share in (0.02, 0.5):
        among = rng.random(len(tree)) < share
        among[rng.integers(len(tree))] = True
        gap = np.maximum(np.maximum(low - x[:, None], x[:, None] - high), 0.0)
        square = gap[..., 0] * gap[..., 0]
        for a in range(1, d):
            square = square + gap[..., a] * gap[..., a]
        square[:, ~among] = np.inf
        assert tree.nearest(x, among).tolist() == square.argmin(axis=1).tolist()
        assert tree.nearest(x, np.flatnonzero(among)).tolist() == square.argmin(axis=1).tolist()
    assert (tree.nearest(x, np.zeros(len(tree), dtype=bool)) == -1).all()


@pytest.mark.parametrize("d", [2, 3])
@settings(max_examples=30)
@given(data=st.data())
def test_nearest_in_rational_numbers(d: int, data: st.DataObject) -> None:
    tree = planted(data.draw(leaves(d, targets=2)), d)
    x = np.array(data.draw(st.tuples(*[st.integers(-16, 80).map(lambda i: i / 64)] * d)))
    square = []
    for low, high in zip(*tree.corners, strict=True):
        gaps = [max(a - q, q - b, Fraction(0)) for a, b, q in zip(*map(exact, (low, high, x)), strict=True)]
        square.append(sum(g * g for g in gaps))
    assert tree.nearest(x) == square.index(min(square))


@pytest.mark.parametrize("unit", [1e-250, 1e-3, 1e250])
def test_units(unit: float) -> None:
    """Squares of distances are doubles neither for very small numbers nor for very large ones."""
    cells = toward(2, DEEP[2])
    tree, scaled = planted(cells, 2), planted(cells, 2, [[0.0, 0.0], [unit, unit]])
    x = np.random.default_rng(0).uniform(-1, 2, (50, 2))
    among = [0, len(tree) // 2, len(tree) - 1]
    assert tree.nearest(x, among).tolist() == scaled.nearest(x * unit, among).tolist()
    far = 1e20 * np.array([[-1, -1], [1, 1]])  # equally far from all leaves, in doubles: the first
    assert tree.nearest(far).tolist() == [0, 0] and tree.nearest(1e280 * far).tolist() == [0, 0]
    assert tree.nearest([-1e9, -1e9]) == 0 and tree.nearest([1e9, 1e9]) == len(tree) - 1
    low, high = np.array([-3.0, -3.0]) * unit, np.array([-1e-30, 1.0]) * unit
    assert len(scaled.in_box(low, high)) == 0 and len(scaled.in_box(low, high * [0, 1])) > 0


def test_cells_and_corners_agree() -> None:
    """Corners have one formula: those of a level are corners of the next, and cells contain their points."""
    for d, box in CASES:
        low, high = np.array(BOXES[d][box], dtype=float)
        side = high - low
        i = np.random.default_rng(d).integers(0, 1 << 12, (50, d))
        np.testing.assert_array_equal(corners(low, side, i, 12), corners(low, side, 2 * i, 13))
        x = corners(low, side, i, 12)
        np.testing.assert_array_equal(cells_of(x, low, side, 12), i)
        below = np.maximum(np.nextafter(x, -np.inf), low)
        np.testing.assert_array_equal(cells_of(below, low, side, 12), np.maximum(i - 1, 0))
        np.testing.assert_array_equal(cells_of(high[None], low, side, 12), [[(1 << 12) - 1] * d])


def test_table() -> None:
    first = np.array([0, 4, 8, 12], dtype=np.uint64)
    assert table_of(first, 2, 2).tolist() == [0, *[1] * 4, *[2] * 4, *[3] * 4, *[4] * 4][:17]
