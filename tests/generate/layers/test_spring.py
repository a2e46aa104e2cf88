"""When an opposing point is near, by springs and by distance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct.generate.layers.spring import nearest_stops, spring_force, spring_stops

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
