"""The table of a size in space: trilinear between corners, and close to the field."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import InputError
from unstruct.sizing.space_table import size_in_space, sizes_in_space, space_nodes

BOX = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 1.0]])
NO_MARKS = np.empty((0, 3))


def distance(x: np.ndarray) -> np.ndarray:
    return 0.02 + 0.3 * np.linalg.norm(x - 0.3, axis=1)


def test_close_to_the_field() -> None:
    nodes = space_nodes(distance, BOX, 0.5, np.array([[0.3, 0.3, 0.3]]))
    x = np.random.default_rng(0).random((2000, 3)) * BOX[1]
    found = np.empty(len(x))
    sizes_in_space(*nodes, x * 0.5, found)
    assert np.abs(found / 0.5 / distance(x) - 1).max() < 0.06
    outside = size_in_space(*nodes, -1.0, 5.0, 0.2)
    assert outside == size_in_space(*nodes, 0.0, 1.0, 0.2)


def test_linear_sizes_are_exact_and_landmarks_are_seen() -> None:
    nodes = space_nodes(lambda x: 1.0 + x @ [1.0, 2.0, 3.0], BOX, 1.0, NO_MARKS)
    assert size_in_space(*nodes, 0.3, 1.1, 0.7) == pytest.approx(1 + 0.3 + 2.2 + 2.1)

    def spike(x: np.ndarray) -> np.ndarray:
        return np.where(np.linalg.norm(x - 0.41, axis=1) < 1e-3, 0.001, 0.5)

    mark = np.full((1, 3), 0.41)
    assert len(space_nodes(spike, BOX, 1.0, mark).child) > len(space_nodes(spike, BOX, 1.0, NO_MARKS).child)


def test_refused() -> None:
    with pytest.raises(InputError, match="range of doubles"):
        space_nodes(lambda x: np.full(len(x), 1e-200), BOX, 1e-200, NO_MARKS)
