"""Balance, against repeated division of the plain version."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from trees import leaves, planted, toward, unpacked

from unstruct.generate.tree.balancing import balanced, directions
from unstruct.generate.tree.keys import DEEPEST_LEVEL, keys_of
from unstruct.generate.tree.linear import Linear, leaves_of
from unstruct.plain import tree as plain

KINDS = [(2, "faces"), (2, "corners"), (3, "faces"), (3, "edges"), (3, "corners")]


@pytest.mark.parametrize(("d", "across"), KINDS)
def test_as_by_repeated_division(d: int, across: str) -> None:
    @settings(max_examples=30 if d == 2 else 8)
    @given(leaves(d, deepest=6 if d == 2 else 4, targets=3))
    def check(cells: frozenset) -> None:
        found = unpacked(planted(cells, d).balanced(across))
        assert found == plain.balance(cells, across)
        if len(found) < 150:
            assert plain.is_balanced(found, across)

    check()


@pytest.mark.parametrize(("d", "across"), KINDS)
def test_balance_of_a_balanced_tree_changes_nothing(d: int, across: str) -> None:
    cells = toward(d, [((127,) * d, 6), ((64,) * d, 3)])
    tree = planted(cells, d).balanced(across)
    assert len(tree) > len(cells) and tree.balanced(across) == tree and tree.is_balanced(across)
    assert not planted(cells, d).is_balanced(across)


@pytest.mark.parametrize("d", [2, 3])
def test_the_deepest_level(d: int) -> None:
    """Divided toward the middle from below, as deep as keys reach: all levels must follow."""
    deepest = DEEPEST_LEVEL[d]
    split = [keys_of(np.full((1, d), (1 << level >> 1) - (level > 0))) for level in range(deepest)]
    found = leaves_of(balanced(Linear(tuple(split), d)))
    levels = np.bincount(found.levels)
    assert len(levels) == deepest + 1 and levels[-1] == 1 << d
    assert sum(int(n) << d * (deepest - level) for level, n in enumerate(levels)) == 1 << d * deepest
    tree = planted({(0,) * (d + 1)}, d)
    tree.linear = balanced(Linear(tuple(split), d))
    assert tree.is_balanced()


def test_directions() -> None:
    assert [directions(kind, 2) for kind in ("faces", "edges", "corners")] == [1, 2, 2]
    assert [directions(kind, 3) for kind in ("faces", "edges", "corners")] == [1, 2, 3]
