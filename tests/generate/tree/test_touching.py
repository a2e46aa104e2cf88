"""Neighbors, against all pairs of leaves."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from trees import in_order, leaves, planted

from unstruct.generate.tree.touching import neighbor_pairs, rows_of_pairs
from unstruct.plain import tree as plain


@pytest.mark.parametrize("d", [2, 3])
def test_as_among_all_pairs(d: int) -> None:
    @settings(max_examples=25)
    @given(leaves(d, targets=3 if d == 2 else 2))
    def check(cells: frozenset) -> None:
        tree = planted(cells, d)
        order = in_order(tree)
        for across in ("faces", "corners") if d == 2 else ("faces", "edges", "corners"):
            indptr, indices = tree.neighbors(across)
            for i, cell in enumerate(order):
                found = indices[indptr[i] : indptr[i + 1]]
                assert (np.diff(found) > 0).all()
                assert {order[j] for j in found} == plain.neighbors(cells, cell, across)

    check()


def test_one_leaf_has_none() -> None:
    for d in (2, 3):
        tree = planted({(0,) * (d + 1)}, d)
        indptr, indices = tree.neighbors("corners")
        assert indptr.tolist() == [0, 0] and len(indices) == 0
        assert neighbor_pairs(tree.grid, d).shape == (0, 2)


def test_rows() -> None:
    indptr, indices = rows_of_pairs(np.array([[0, 2], [2, 0], [2, 3], [3, 2]]), 4)
    assert indptr.tolist() == [0, 1, 1, 3, 4] and indices.tolist() == [2, 0, 3, 2]
