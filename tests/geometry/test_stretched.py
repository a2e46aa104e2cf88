"""Cells whose vertices carry a metric: as the mapped cell without one, and a gradient that helps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.connect.spatial.costs import badness
from unstruct.geometry.stretched import METRIC_COLUMNS, metric_badness, metric_gradient

SAME = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 1.0])


def cell(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A positive cell with one metric at all vertices, and its image, by numpy."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(4, 3))
    if np.linalg.det(x[1:] - x[0]) < 0:
        x[[0, 1]] = x[[1, 0]]
    root = np.tril(rng.normal(size=(3, 3)))
    root[np.diag_indices(3)] = np.abs(root.diagonal()) + 0.1
    b = root @ root.T
    rows = np.hstack([x @ root.T, np.tile(b[np.tril_indices(3)], (4, 1))])
    assert rows.shape[1] == METRIC_COLUMNS
    return rows, x


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10**6))
def test_badness_is_that_of_the_image(seed: int) -> None:
    rows, image = cell(seed)
    assert metric_badness(rows, 0, 1, 2, 3) == pytest.approx(badness(image, 0, 1, 2, 3), rel=1e-9)
    assert badness(rows, 0, 1, 2, 3) == metric_badness(rows, 0, 1, 2, 3)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10**6))
def test_a_small_move_along_the_gradient_helps(seed: int) -> None:
    """Whichever vertex moves; a, b, c, p is positive, as the kernels have it."""
    rows, _ = cell(seed)
    step = np.empty(3)
    for p, a, b, c in ((3, 0, 1, 2), (0, 1, 3, 2), (1, 0, 2, 3), (2, 0, 3, 1)):
        before = metric_badness(rows, a, b, c, p)
        assert metric_gradient(rows, p, a, b, c, step)
        moved = rows.copy()
        moved[p, :3] += 1e-5 * step
        assert metric_badness(moved, a, b, c, p) < before


def test_flat_cells() -> None:
    rows = np.hstack([np.zeros((4, 3)), np.tile(SAME, (4, 1))])
    assert metric_badness(rows, 0, 1, 2, 3) == 1.0
    assert not metric_gradient(rows, 0, 1, 2, 3, np.empty(3))
