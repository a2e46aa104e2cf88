"""The tree of boxes, in the plane and in space: a window finds exactly what meets it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.advancing.digital_tree import (
    NOT_PLANTED,
    gather,
    larger_tree,
    new_tree,
    plant,
    planted,
    pull,
)

EVENTS = st.lists(
    st.tuples(st.integers(0, 30), st.tuples(*[st.integers(-8, 8)] * 3), st.integers(0, 4)), max_size=90
)


@pytest.mark.parametrize("d", [2, 3])
@settings(max_examples=30, deadline=None)
@given(EVENTS)
def test_the_tree_finds_what_is_there(d: int, events: list[tuple[int, tuple[int, ...], int]]) -> None:
    """Items come and go (those there leave), and the tree grows once; windows have sides of their own."""
    tree, there = new_tree(31, d), {}
    for step, (i, x, h) in enumerate(events):
        if step == 40:
            tree = larger_tree(tree, 50)
        if i in there:
            pull(tree, i)
            del there[i]
        else:
            plant(tree, i, tuple(c / 8 for c in x[:d]), h / 16)
            there[i] = np.array(x[:d]) / 8, h / 16
        low = np.array([x[0] - 3, x[1], x[2] - 1][:d]) / 8
        high = low + np.array([0.5, 0.25, 0.75][:d])
        count = gather(tree, (*low.tolist(), *high.tolist()))
        expected = {k for k, (c, r) in there.items() if (c - r <= high).all() and (c + r >= low).all()}
        assert set(tree.found[:count].tolist()) == expected and count == len(expected)
    assert {i for i in range(31) if tree.links[i, 2] != NOT_PLANTED} == set(there)
    assert all(planted(tree, i) == (i in there) for i in range(31))
