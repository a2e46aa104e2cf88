"""Heights: limited by columns, graded along edges, placed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.prisms.heights import SAFE_SHARE, edges_of_columns, graded, limited, placed
from unstruct.generate.prisms.records import COLUMN, FULL, GRADATION, HIDDEN_RAY


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.1, 1.0, 4.0]))
def test_graded_heights_are_the_largest_that_are_allowed(seed: int, slope: float) -> None:
    """As all shortest paths have it: the least over all vertices of height plus slope times the way."""
    rng = np.random.default_rng(seed)
    points = rng.random((12, 3))
    columns = np.array([rng.permutation(12)[:3] for _ in range(10)], dtype=np.int32)
    edges = edges_of_columns(columns)
    height = rng.random(12) * float(rng.choice([0.1, 1.0]))
    height[rng.random(12) < 0.2] = 0.0
    far = np.full((12, 12), np.inf)
    np.fill_diagonal(far, 0.0)
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    far[edges[:, 0], edges[:, 1]] = far[edges[:, 1], edges[:, 0]] = slope * length
    for k in range(12):
        far = np.minimum(far, far[:, k : k + 1] + far[k])
    wanted = (height + far).min(axis=1)
    found, reason = graded(points, edges, height, np.zeros(12, dtype=np.int8), slope)
    assert found == pytest.approx(wanted, abs=1e-12)
    assert ((reason == GRADATION) == (found < height)).all()


def test_limits_of_a_concave_fold() -> None:
    """Two rays that lean towards each other: the column ends where they meet."""
    points = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 1.0, 0.0)])
    rays = np.array([(0.5, 0.0, 1.0), (-0.5, 0.0, 1.0), (0.0, 0.0, 1.0)])
    columns = np.array([(0, 1, 2)], dtype=np.int32)
    height, reason = limited(points, rays, columns, np.full(3, 2.0))
    assert height == pytest.approx(np.full(3, SAFE_SHARE)) and (reason == COLUMN).all()
    height, reason = limited(points, rays, columns, np.full(3, 0.5))
    assert (height == 0.5).all() and (reason == FULL).all()
    height, reason = limited(points, rays, columns, np.array([0.5, 0.0, 0.5]))
    assert height[1] == 0.0 and reason[1] == HIDDEN_RAY


def test_places() -> None:
    points, rays = np.eye(3), np.ones((3, 3))
    shares = np.array([[0.0, 0.25, 1.0]])
    found = placed(points, rays, np.array([0.0, 2.0, 4.0]), shares)
    assert (found[0] == points).all() and (found[:, 0] == points[0]).all()
    assert (found[1, 1] == points[1] + 0.5).all() and (found[2, 2] == points[2] + 4.0).all()
    own = placed(points, rays, np.ones(3), np.array([[0, 0.1, 1], [0, 0.2, 1], [0, 0.3, 1.0]]))
    assert (own[1] == points + np.array([[0.1], [0.2], [0.3]])).all()
