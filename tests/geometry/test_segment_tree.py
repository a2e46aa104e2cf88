"""Distances and weighted distances to segments, over brute force that shares no code."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.geometry.segment_tree import SegmentTree


def brute(x: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """All distances (k, s), by projecting on the line and by comparing the two ends."""
    result = np.empty((len(x), len(segments)))
    for i, p in enumerate(x):
        for j, (a, b) in enumerate(segments):
            candidates = [a, b]
            square = np.dot(b - a, b - a)
            if square > 0 and 0 < np.dot(p - a, b - a) < square:
                candidates.append(a + np.dot(p - a, b - a) / square * (b - a))
            result[i, j] = min(np.linalg.norm(p - c) for c in candidates)
    return result


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 40),
    st.integers(1, 3),
    st.floats(0, 5),
    st.sampled_from([1, 1e9]),
)
def test_least_is_that_of_brute_force(seed: int, many: int, d: int, growth: float, scale: float) -> None:
    rng = np.random.default_rng(seed)
    segments = rng.integers(-4, 5, (many, 2, d)) * scale
    weights, x = rng.random(many) * scale, rng.random((20, d)) * 12 * scale - 6 * scale
    table = brute(x, segments)
    assert np.allclose(SegmentTree(segments).distance(x), table.min(axis=1), rtol=1e-12, atol=1e-12 * scale)
    best, which = SegmentTree(segments, weights).least(x, growth)
    wanted = weights + growth * table
    assert np.allclose(best, wanted.min(axis=1), rtol=1e-12)
    assert np.allclose(wanted[np.arange(len(x)), which], best, rtol=1e-12)


def test_nearest_says_where() -> None:
    tree = SegmentTree([[[0, 0], [4, 0]], [[0, 3], [0, 3]]])
    which, t = tree.nearest([[1, 1], [-2, -1], [9, 0], [0.5, 2.5]])
    assert which.tolist() == [0, 0, 0, 1]
    assert t.tolist() == [0.25, 0.0, 1.0, 0.0]


def test_what_is_not_beaten_stays() -> None:
    values, which = SegmentTree([[0.0], [10.0]], [1.0, 2.0]).least([[0.5], [9.0]], 1.0, [1.25, 99.0])
    assert values.tolist() == [1.25, 3.0] and which.tolist() == [-1, 1]


def test_ends_are_exact() -> None:
    """A point of a segment's end is at distance 0, whatever the coordinates."""
    rng = np.random.default_rng(0)
    segments = rng.random((50, 2, 2)) * 1e-3 + 1e5
    assert (SegmentTree(segments).distance(segments[:, 1]) == 0).all()


@pytest.mark.parametrize(
    ("segments", "weights", "words"),
    [
        (np.empty((0, 2)), None, "s >= 1"),
        ([1.0, 2.0], None, "shape"),
        ([[[0, 0]]], None, "shape"),
        ([[0, 0], [np.nan, 1]], None, "not finite"),
        ([[0, 0], [1, 1]], [1.0], "2 finite numbers"),
        ([[0, 0], [1, 1]], [1.0, np.inf], "2 finite numbers"),
    ],
)
def test_bad_input(segments: object, weights: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        SegmentTree(segments, weights)


def test_bad_questions() -> None:
    tree = SegmentTree([[0.0, 0.0]], [1.0])
    with pytest.raises(InputError, match="weights"):
        tree.distance([[1.0, 1.0]])
    with pytest.raises(InputError, match=r"shape \(k, 2\)"):
        tree.least([[1.0]], 1.0)
    with pytest.raises(InputError, match="growth"):
        tree.least([[1.0, 1.0]], -1.0)


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("growth", [0.0, 0.3, 2.0])
def test_weights_that_change_along_segments(dimension: int, growth: float) -> None:
    rng = np.random.default_rng(dimension)
    segments, weights = rng.random((40, 2, dimension)), rng.random((40, 2))
    segments[:5, 1] = segments[:5, 0]  # of no length: the less of both
    x = rng.random((60, dimension)) * 3 - 1
    t = np.linspace(0, 1, 2001)[:, None]
    places = segments[:, :1] + t * (segments[:, 1:] - segments[:, :1])
    values = weights[:, 0] + t * (weights[:, 1] - weights[:, 0])
    away = np.linalg.norm(x[:, None, None] - places, axis=3)
    wanted = (values.T + growth * away).min(axis=2)
    best, which = SegmentTree(segments, weights).least(x, growth)
    assert (best <= wanted.min(axis=1) + 1e-14).all() and np.allclose(best, wanted.min(axis=1), atol=2e-3)
    assert np.allclose(wanted[np.arange(60), which], best, atol=2e-3)
