"""Rows that come and go, and their queue: as dictionaries and sorted lists do it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from unstruct.base.jit import kernel
from unstruct.generate.advancing import rows as r


class Table(NamedTuple):
    state: NDArray[np.int64]
    stamp: NDArray[np.int64]
    chain: NDArray[np.int32]
    first: NDArray[np.int32]


@kernel
def enter(table, v):
    row = r.new_row(table)
    r.put_in_chain(table, row, v)
    return row


@kernel
def leave(table, row, v):
    r.drop_row(table, row, v)


@kernel
def wait(waiting, stamp, row, key):
    r.in_turn(waiting, stamp, row, key)


@kernel
def next_of(waiting, stamp):
    return r.next_in_turn(waiting, stamp)


EVENTS = st.lists(st.tuples(st.integers(0, 3), st.integers(0, 5), st.integers(0, 9)), max_size=120)


@settings(max_examples=30, deadline=None)
@given(EVENTS)
def test_rows_and_their_queue(events: list[tuple[int, int, int]]) -> None:
    """Chains have exactly the rows of their vertex; what has left is not served, in whatever row it was."""
    state = np.zeros(r.FRONT_STATE, dtype=np.int64)
    state[r.FREE_ROW] = -1
    table = Table(
        state, np.full(200, -1, dtype=np.int64), np.full(200, -1, dtype=np.int32),
        np.full(6, -1, dtype=np.int32),
    )  # fmt: skip
    waiting = r.room_to_wait(None, 4, 6)
    there: dict[int, int] = {}  # the vertex of each row
    queue: list[tuple[float, int]] = []  # keys, all different, and rows
    for i, (what, v, at) in enumerate(events):
        if what < 2:
            row = int(enter(table, v))
            assert row not in there and table.stamp[row] >= 0
            there[row] = v
            key = at + i / 1000
            waiting = r.room_to_wait(waiting, state[r.ALIVE], 6)
            wait(waiting, table.stamp, row, key)
            queue.append((key, row))
        elif what == 2 and there:
            row = sorted(there)[at % len(there)]
            leave(table, row, there.pop(row))
            queue = [one for one in queue if one[1] != row]
        elif what == 3:
            row, key = next_of(waiting, table.stamp)
            best = min(queue, default=(0.0, -1))
            assert row == best[1] and (row < 0 or key == best[0])
            queue = [one for one in queue if one != best]
        for v in range(6):
            row, chain = int(table.first[v]), []
            while row >= 0:
                chain.append(row)
                row = int(table.chain[row])
            assert sorted(chain) == sorted(k for k, u in there.items() if u == v)
    assert state[r.ALIVE] == len(there) and state[r.NEXT_STAMP] == sum(what < 2 for what, *_ in events)
