"""The record of divided cells, and its leaves, against sets of cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from trees import leaves, packed, planted, unpacked

from unstruct.generate.tree.linear import Linear, children_of, leaves_of, linear_of, merged, nodes_of
from unstruct.plain import tree as plain

NONE = np.empty(0, dtype=np.uint64)


@pytest.mark.parametrize("d", [2, 3])
def test_leaves(d: int) -> None:
    @given(leaves(d))
    def check(cells: frozenset) -> None:
        tree = packed(cells, d)
        found = leaves_of(tree)
        depth = plain.depth(cells)
        assert tree.depth == depth and len(found.keys) == len(cells)
        assert len(cells) == 1 + (2**d - 1) * tree.divided
        assert len(plain.nodes(cells)) == 1 + 2**d * tree.divided
        assert found.first.tolist() == sorted(plain.key(cell, depth) for cell in cells)
        assert (found.first == found.keys << (d * (depth - found.levels)).astype(np.uint64)).all()
        assert unpacked(planted(cells, d)) == cells
        for level in range(depth + 2):
            own = sorted(plain.key(cell, level) for cell in plain.nodes(cells) if cell[0] == level)
            assert nodes_of(tree, level).tolist() == own

    check()


def test_one_leaf_and_levels_without_divisions() -> None:
    for d in (2, 3):
        tree = linear_of([NONE, NONE], d)
        assert tree == Linear((), d) and tree.depth == tree.divided == 0
        found = leaves_of(tree)
        assert found.keys.tolist() == found.levels.tolist() == found.first.tolist() == [0]


def test_children_and_unions_are_sorted() -> None:
    assert children_of(np.array([1, 5], dtype=np.uint64), 2).tolist() == [4, 5, 6, 7, 20, 21, 22, 23]
    union = merged(np.array([1, 4], dtype=np.uint64), np.array([4, 2, 2], dtype=np.uint64))
    assert union.tolist() == [1, 2, 4] and merged(union, NONE) is union


def test_more_levels_than_keys_have_room_for() -> None:
    with pytest.raises(ValueError, match="21 levels; keys have room for 20"):
        leaves_of(Linear((np.zeros(1, dtype=np.uint64),) * 21, 3))
