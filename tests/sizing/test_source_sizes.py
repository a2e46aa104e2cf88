"""Sources over dense brute force."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.sizing import lines, points, polygons, sources

RNG = np.random.default_rng(5)
X = RNG.random((300, 2)) * 3 - 1


def test_points_grow_up_to_the_cut_off() -> None:
    places, sizes = np.array([[0, 0], [1, 1], [1.5, 0.2]]), np.array([0.1, 0.02, 0.3])
    away = np.array([[math.dist(p, q) for q in places] for p in X])
    assert np.allclose(points(places, sizes, growth=0.3)(X), (sizes + 0.3 * away).min(axis=1))
    assert np.allclose(
        points(places, sizes, growth=0.3, far=0.31)(X), (sizes + 0.3 * away).min(axis=1).clip(max=0.31)
    )
    assert np.allclose(points(places, 0.05, growth=0)(X), 0.05)
    assert points(np.eye(3), 0.1)([[1, 0, 0], [0, 0, 0]]).tolist() == [0.1, 0.1 + 0.2]


def test_lines_are_dense_points() -> None:
    path = np.array([[0, 0], [1, 0.5], [0.5, 1.2]])
    t = np.linspace(0, 1, 4001)[:, None]
    dense = np.concatenate([a + t * (b - a) for a, b in pairwise(path)])
    away = np.array([np.hypot(*(dense - p).T).min() for p in X])
    assert np.allclose(lines(path, 0.05, growth=0.25)(X), 0.05 + 0.25 * away, atol=1e-4)


def test_polygons_with_a_hole() -> None:
    outer, hole = (
        np.array([[0, 0], [1, 0], [1, 1], [0, 1]]),
        np.array([[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]),
    )
    away_outer = np.hypot(*np.maximum(np.maximum(-X, X - 1), 0).T)
    depth = np.minimum(X - 0.3, 0.7 - X).min(axis=1)  # into the hole
    wanted = np.minimum(0.04 + 0.5 * np.maximum(away_outer, depth), 0.2)
    assert np.allclose(polygons([outer, hole], 0.04, growth=0.5, far=0.2)(X), wanted)
    assert np.allclose(polygons(outer, 0.04, growth=0.5)(X), 0.04 + 0.5 * away_outer)
    assert (polygons(outer, 0.04)(outer) == 0.04).all()


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0, 2))
def test_sources_are_lipschitz(seed: int, growth: float) -> None:
    rng = np.random.default_rng(seed)
    field = sources(rng.random((20, 2, 2)), rng.random(20) + 0.01, growth=growth, far=5.0)
    a, b = rng.random((2, 50, 2)) * 2
    assert (np.abs(field(a) - field(b)) <= growth * np.hypot(*(a - b).T) * (1 + 1e-12) + 1e-12).all()


def test_a_table_sees_every_source() -> None:
    places = RNG.random((40, 2))
    field = points(places, 1e-4, growth=0.2, far=0.1)
    assert np.allclose(field.table([0, 0], [1, 1])(places), 1e-4, rtol=0.05)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: points([[0, 0], [1, 1]], [0.1, 0.0]), r"size\[1\] = 0.0 at source 1"),
        (lambda: points([[0, 0], [1, 1]], [math.nan, 0.1]), r"size\[0\] = nan"),
        (lambda: points([[0, 0], [1, 1]], [0.1, 0.1, 0.1]), "one for each of 2 sources"),
        (lambda: points([[0, 0]], "small"), "size must be real numbers"),
        (lambda: points([[0, 0]], 0.1, far=0.05), "below the size"),
        (lambda: points([[0, 0]], 0.1, far=math.nan), "below the size"),
        (lambda: points([[0, 0]], 0.1, growth=-0.1), "growth"),
        (lambda: points(np.empty((0, 2)), 0.1), "s >= 1"),
        (lambda: points([[0, math.inf]], 0.1), "not finite"),
        (lambda: lines([[0, 0]], 0.1), "at least two points"),
        (lambda: polygons([[0, 0], [1, 1]], 0.1), "at least three points"),
    ],
)
def test_bad_sources(make: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()
