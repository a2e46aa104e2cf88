"""Vertices of leaves: each once, at the corners that `corners` gives."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from trees import BOXES, exact, leaves, planted

from unstruct.generate.tree.vertices import numbered
from unstruct.plain.tree_templates import vertices


@pytest.mark.parametrize("d", [2, 3])
def test_as_a_set_of_corners(d: int) -> None:
    @settings(max_examples=40)
    @given(leaves(d, targets=3), st.integers(0, 2))
    def check(cells: frozenset, box: int) -> None:
        tree = planted(cells, d)
        found = numbered(tree.grid)
        assert len(found.points) == len(vertices(cells))
        assert {exact(x) for x in found.points} == vertices(cells)
        assert (np.sort(np.unique(found.corners)) == np.arange(len(found.points))).all()
        tree = planted(cells, d, BOXES[d][box])
        found, (low, high) = numbered(tree.grid), tree.corners
        for c in range(1 << d):
            above = [bool(c >> a & 1) for a in range(d)]
            np.testing.assert_array_equal(found.points[found.corners[:, c]], np.where(above, high, low))
        first = found.corners[:, 0]
        np.testing.assert_array_equal(first, np.arange(len(tree)))

    check()
