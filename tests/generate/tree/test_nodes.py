"""All cells of a tree: counts, parents, centers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from trees import exact, leaves, planted

from unstruct.generate.tree.nodes import all_nodes
from unstruct.plain import tree as plain


@pytest.mark.parametrize("d", [2, 3])
def test_as_sets(d: int) -> None:
    @settings(max_examples=40)
    @given(leaves(d, targets=3))
    def check(cells: frozenset) -> None:
        tree = planted(cells, d)
        found, expected = all_nodes(tree.linear, tree.leaves, tree.box), plain.nodes(cells)
        divided = len(expected) - len(cells)
        assert len(found.levels) == len(expected) == 1 + 2**d * divided
        assert len(tree) == 1 + (2**d - 1) * divided
        by_center = {plain.center(cell): cell for cell in expected}
        order = [by_center.pop(exact(x)) for x in found.centers]
        assert not by_center and [cell[0] for cell in order] == found.levels.tolist()
        for cell, above, leaf in zip(order, found.parents, found.leaves, strict=True):
            assert (above == -1) if cell[0] == 0 else order[above] == plain.parent(cell)
            assert (leaf >= 0) == (cell in cells)
        rows = found.leaves >= 0
        np.testing.assert_array_equal(np.sort(found.leaves[rows]), np.arange(len(tree)))
        np.testing.assert_array_equal(found.centers[rows], tree.centers[found.leaves[rows]])

    check()
