"""When an opposing point is near, by springs and by distance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.layers.spring import AHEAD, meet, nearest_stops, spring_force, spring_stops

A, B = np.array([[0.0, 0.0]]), np.array([[1.0, 0.0]])


def stops(height: float, step: float, across: float = 0.5) -> bool:
    """Whether a point at this height above an edge of length 1 stops it."""
    new = A + np.array([0.0, step]), B + np.array([0.0, step])
    return bool(spring_stops((A, B), new, np.array([[across, height]]))[0])


def test_springs_are_relaxed_at_the_apex_of_an_equilateral_triangle() -> None:
    apex = np.array([[0.5, np.sqrt(0.75)]])
    assert spring_force(apex, A, B, np.array([1.0]))[0] == pytest.approx(0.0, abs=1e-15)


@given(st.floats(1e-6, 1e-2), st.floats(0.02, 1.38))
def test_a_point_within_a_cell_is_near(step: float, height: float) -> None:
    assert stops(height, step)


@given(st.floats(1e-6, 0.9), st.floats(1.45, 100.0), st.floats(-3.0, 3.0))
def test_a_point_far_away_is_not(step: float, height: float, across: float) -> None:
    assert not stops(height, step, across)


def test_the_reach_is_the_root_of_two_for_thin_layers() -> None:
    """sqrt(g^2 + 1/4) - 1 = 1/2 at g = sqrt(2), where both candidates take the same force."""
    assert stops(np.sqrt(2.0) - 1e-3, 1e-6) and not stops(np.sqrt(2.0) + 1e-3, 1e-6)


def test_least_force_alone_misses_a_point_in_a_narrow_gap() -> None:
    """The source chapter's rule by itself: compressed springs push the opposing point away."""
    step, opposing = 0.0078125, np.array([[0.5, 0.03125]])
    rest, new = np.array([1.0]), A + np.array([0.0, step])
    assert spring_force(opposing, A, B, rest)[0] > spring_force(new, A, B, rest)[0]
    assert stops(0.03125, step)


def test_the_nearest_point() -> None:
    new, one = np.array([[0.0, 0.1]]), np.array([1.0])
    for away, near in ((1.15, True), (1.25, False)):
        found = nearest_stops(new, 0.1 * one, one, np.array([[0.0, 0.1 + away]]))
        assert bool(found[0]) == near


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_layer_by_layer(seed: int, spring: bool) -> None:
    """Two facing rows of rays and some loose points, beside loops over arrays."""
    rng = np.random.default_rng(seed)
    n, layers = 4, 5
    wall = np.column_stack([np.arange(n), np.zeros(n)])
    base = np.concatenate([wall, wall + np.array([0.0, rng.uniform(1, 4)])])
    direction = np.repeat([[0.0, 1.0], [0.0, -1.0]], n, axis=0)
    heights = np.concatenate([[0.0], np.cumsum(rng.uniform(0.05, 0.6, layers))])
    places = base[:, None] + direction[:, None] * heights[:, None]
    steps, apart = np.tile(np.diff(heights), (2 * n, 1)), np.ones((2 * n, layers + 1))
    before, after = np.arange(2 * n) - 1, np.arange(2 * n) + 1
    before[[0, n]] = after[[n - 1, 2 * n - 1]] = -1
    others = rng.uniform([0, 0.5], [n, 2.0], (3, 2))
    p, q = (a.ravel() for a in np.meshgrid(np.arange(2 * n), np.arange(2 * n + 3), indexing="ij"))
    level = rng.integers(0, layers + 1, 2 * n)
    expected, hit_at = level.copy(), np.zeros(2 * n, dtype=bool)
    for k in range(layers):
        stopped = set()
        for r, o in zip(p.tolist(), q.tolist()):
            if expected[r] <= k:
                continue
            x = places[o, min(k, expected[o])] if o < 2 * n else others[o - 2 * n]
            away = x - places[r, k]
            if not away @ direction[r] > AHEAD * np.hypot(*away):
                continue
            if spring:
                near = False
                for j in (before[r], after[r]):
                    if j >= 0:
                        edge = places[r, k][None], places[j, min(k, expected[j])][None]
                        new = places[r, k + 1][None], places[j, min(k + 1, expected[j])][None]
                        near = near or bool(spring_stops(edge, new, x[None])[0])
            else:
                near = bool(
                    nearest_stops(places[r, k + 1][None], steps[r, k : k + 1], np.ones(1), x[None])[0]
                )
            if near:
                stopped |= {r} | ({o} if o < 2 * n and expected[o] > k else set())
        for r in stopped:
            expected[r], hit_at[r] = k, True
    marks = np.zeros(2 * n, dtype=bool)
    meet((places, steps, apart), (direction, before, after), (p, q), others, spring, level, marks)
    assert np.array_equal(level, expected) and np.array_equal(marks, hit_at)
