"""The table of edges that must stay: a set of edges, also where it had to grow."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.connect.spatial.held import grown_held, hold, holds, new_held

EDGES = st.tuples(st.integers(0, 60), st.integers(0, 60)).filter(lambda ends: ends[0] != ends[1])


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(EDGES, st.booleans()), max_size=300))
def test_held_edges_against_a_set(steps: list[tuple[tuple[int, int], bool]]) -> None:
    table, inside, ever = new_held(5), set(), set()
    for (u, v), stays in steps:
        ever.add(frozenset((u, v)))
        table = grown_held(table, len(ever))
        hold(table, np.int32(u), np.int32(v), 1 if stays else 0)
        (inside.add if stays else inside.discard)(frozenset((u, v)))
    assert 2 * len(ever) <= len(table.key)
    for u in range(61):
        for v in range(u):
            assert holds(table, np.int32(v), np.int32(u)) == (frozenset((u, v)) in inside)


def test_a_table_with_room_stays() -> None:
    table = new_held(100)
    assert grown_held(table, 100) is table
    assert len(grown_held(table, 10_000).key) >= 20_000
