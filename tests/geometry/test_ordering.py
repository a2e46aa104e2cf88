"""Hilbert keys and BRIO rounds."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.geometry.ordering import MAX_TABLE_DIMENSION, brio, hilbert_order, radix_argsort


@pytest.mark.parametrize(("d", "bits"), [(1, 5), (2, 1), (2, 5), (3, 1), (3, 3), (4, 2), (5, 2)])
def test_the_curve_steps_from_cell_to_adjacent_cell(d, bits):
    """On a full grid of 2**bits cells an axis, consecutive points differ by one in one coordinate."""
    grid = np.array(list(product(range(2**bits), repeat=d)), dtype=float)
    order = hilbert_order(grid)
    assert sorted(order) == list(range(len(grid)))
    assert (np.abs(np.diff(grid[order], axis=0)).sum(axis=1) == 1).all()


@pytest.mark.parametrize("d", [2, 3])
def test_the_curve_fills_each_cell_before_it_leaves(d):
    """The first 2**d-th of a full grid is one orthant of it, and so for the others."""
    grid = np.array(list(product(range(8), repeat=d)), dtype=float)
    orthants = (grid[hilbert_order(grid)] >= 4).reshape(2**d, -1, d)
    assert (orthants == orthants[:, :1]).all()


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_finite_points_give_a_permutation(data):
    d = data.draw(st.integers(1, MAX_TABLE_DIMENSION + 2))
    coordinate = st.floats(allow_nan=False, allow_infinity=False)
    rows = data.draw(st.lists(st.lists(coordinate, min_size=d, max_size=d), max_size=12))
    points = np.array(rows, dtype=float).reshape(len(rows), d)
    for order in (hilbert_order(points), brio(points)):
        assert sorted(order) == list(range(len(points)))


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((0, 2)),
        np.zeros((1, 3)),
        np.zeros((50, 2)),
        np.full((9, 3), 5e-324),
        np.array([[1.7e308, -1.7e308], [-1.7e308, 1.7e308], [0.0, 5e-324]]),
    ],
    ids=["none", "one", "equal", "subnormal", "overflowing extent"],
)
def test_extreme_boxes(points):
    assert sorted(hilbert_order(points)) == list(range(len(points)))


def test_equal_points_keep_their_order():
    points = np.repeat(np.random.default_rng(0).random((40, 2)), 5, axis=0)
    order = hilbert_order(points).reshape(40, 5)
    assert (np.diff(order, axis=1) == 1).all()


def test_rounds_grow_by_the_ratio_and_are_sorted_within():
    points = np.random.default_rng(1).random((40_000, 2))
    order = brio(points, 5)
    steps = np.linalg.norm(np.diff(points[order], axis=0), axis=1)
    # three rounds of 1/64, 7/64 and 7/8: the mean step falls as the density grows
    sizes = np.array([1, 7, 56]) * len(points) // 64
    parts = np.split(steps, np.cumsum(sizes)[:2])
    means = [part.mean() * np.sqrt(size) for part, size in zip(parts, sizes)]
    assert all(0.4 < mean < 1.6 for mean in means)
    plain = np.linalg.norm(np.diff(points, axis=0), axis=1).mean()
    assert steps.mean() < plain / 50


def test_the_seed_is_fixed_and_generators_are_taken():
    points = np.random.default_rng(2).random((500, 3))
    assert np.array_equal(brio(points), brio(points))
    assert np.array_equal(brio(points, 7), brio(points, np.random.default_rng(7)))
    assert not np.array_equal(brio(points, 7), brio(points, 8))
    assert np.array_equal(brio(points, rounds=1), hilbert_order(points))


def test_radix_sort_is_stable_and_right():
    keys = np.random.default_rng(3).integers(0, 1 << 60, 5000)
    keys[::3] = keys[0]
    assert np.array_equal(radix_argsort(keys.copy(), 60), np.argsort(keys, kind="stable"))


def test_wrong_shape():
    with pytest.raises(ValueError, match="shape"):
        hilbert_order(np.zeros(5))


def test_plain_python_gives_the_same_order():
    code = (
        "import json, numpy as np; from unstruct.geometry.ordering import brio\n"
        "rng = np.random.default_rng(0)\n"
        "print(json.dumps([brio(rng.random((300, d))).tolist() for d in (1, 2, 3, 5)]))"
    )
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    rng = np.random.default_rng(0)
    assert json.loads(run.stdout) == [brio(rng.random((300, d))).tolist() for d in (1, 2, 3, 5)]
