"""The table of the size that follows an envelope."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import sizing
from unstruct.generate.layers.matched import COARSE, FILL_GROWTH, matched_size
from unstruct.generate.layers.matched_levels import is_behind
from unstruct.geometry.parity import even_odd

LOWER, UPPER = [0.0, 0.0], [1.0, 1.0]


def ring(rng: np.random.Generator, edges: int) -> tuple[np.ndarray, np.ndarray]:
    """An envelope around a body in the middle, with the rest on the left of its edges."""
    t = (np.arange(edges) + rng.uniform(-0.4, 0.4, edges)) / edges * 2 * np.pi
    points = 0.5 + rng.uniform(0.05, 0.35, (edges, 1)) * np.stack([np.cos(t), np.sin(t)], axis=1)
    return points, np.column_stack([np.roll(np.arange(edges), -1), np.arange(edges)])


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(5, 60), st.sampled_from(["number", "sources", "function"]))
def test_the_table_is_near_the_size(seed: int, edges: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    points, top = ring(rng, edges)
    size = {
        "number": 0.2,
        "sources": sizing.sources(rng.random((5, 2)), 0.05, growth=0.3),
        "function": lambda x: 0.1 + 0.05 * x[:, 0],
    }[kind]
    field = matched_size(size, points, top)
    table = field.table(LOWER, UPPER)
    x = rng.random((400, 2))
    x = x[~even_odd(points, top, x)[0]]
    a, b = points[top].transpose(1, 0, 2)
    t = np.clip((((x[:, None] - a) * (b - a)).sum(-1)) / ((b - a) ** 2).sum(-1), 0, 1)
    away = np.linalg.norm(x[:, None] - a - t[..., None] * (b - a), axis=-1)
    wanted = (np.linalg.norm(b - a, axis=1) + FILL_GROWTH * away).min(axis=1)
    wanted = np.minimum(wanted, sizing.minimum(size)(x))
    assert field(x) == pytest.approx(wanted)
    assert (
        np.abs(table(x) / wanted - 1).max() < 3 * COARSE
    )  # the middles of leaves are tested, not all places
    assert np.median(np.abs(table(x) / wanted - 1)) < COARSE / 2


def test_leaves_behind_the_envelope_stay_large() -> None:
    """An envelope from left to right through the middle: the rest, and all that is fine, is above."""
    points = np.column_stack([np.arange(2001) / 2000, np.full(2001, 0.5)])
    top = np.column_stack([np.arange(2000), np.arange(1, 2001)])
    field = matched_size(1.0, points, top)
    places, _ = field.table(LOWER, UPPER).corners()
    above, below = (places[:, 1] > 0.5).sum(), (places[:, 1] < 0.5).sum()
    assert below < 0.8 * above
    behind = [is_behind(field.ends, 400, 0.2002, y, 0.01) for y in (0.7, 0.3, 0.499)]
    assert behind == [False, True, False]


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(5, 60), st.sampled_from([0.02, 0.2]), st.booleans())
def test_edges_too_far_to_matter_change_no_table(seed: int, edges: int, most: float, even: bool) -> None:
    rng = np.random.default_rng(seed)
    points, top = ring(rng, edges)
    size = sizing.as_size(most) if even else sizing.sources(rng.random((5, 2)), 0.01, growth=0.3, far=most)
    one = matched_size(size, points, top).table(LOWER, UPPER).nodes
    size = size if even else sizing.minimum(size)  # it does not know how large it is at most
    size.most = np.inf
    other = matched_size(size, points, top).table(LOWER, UPPER).nodes
    assert np.array_equal(one.child, other.child) and np.array_equal(one.values, other.values)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(5, 60), st.sampled_from(["number", "sources"]))
def test_middles_that_are_not_asked_change_no_table(seed: int, edges: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    points, top = ring(rng, edges)
    size = 0.2 if kind == "number" else sizing.sources(rng.random((5, 2)), 0.01, growth=0.3, far=0.2)
    one = matched_size(size, points, top).table(LOWER, UPPER)
    doubting = matched_size(size, points, top)
    doubting.growth = np.inf  # so any middle is possible in any leaf
    other = doubting.table(LOWER, UPPER)
    assert np.array_equal(one.child, other.child) and np.array_equal(one.values, other.values)
    assert one.error <= other.error
