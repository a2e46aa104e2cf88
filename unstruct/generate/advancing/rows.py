"""The rows of a classical front, its edges or faces, that come and go, and the queue in which they wait.

A row that has left is given to the next edge or face that comes. The *stamp* of a row is the number of what
is in it, in the order in which they came. An entry of the queue has both, so that it is known whether what
waits is still at the front. Fronts are records with the fields ``state`` (see below), ``stamp``, ``first``,
for each vertex the first row of which it is the first vertex, and ``chain``, the next such row, or the next
free one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.heap import pop, push
from ...base.jit import inline
from ...connect.insertion.engine import grown

__all__ = [
    "ALIVE",
    "CELLS_MADE",
    "FREE_ROW",
    "FRONT_STATE",
    "ROWS",
    "VERTEX_COUNT",
    "Waiting",
    "drop_row",
    "entry_of",
    "in_turn",
    "is_current",
    "larger_counts",
    "new_row",
    "next_in_turn",
    "put_in_chain",
    "room_to_wait",
    "row_of_entry",
]  # fmt: skip

# Places in the state: rows so far, the first free one, how many are at the front, the next stamp, how many
# vertices there are, and how many cells have been made.
ROWS, FREE_ROW, ALIVE, NEXT_STAMP, VERTEX_COUNT, CELLS_MADE, FRONT_STATE = range(7)
STAMPED = 4294967296  # 2^32: an entry is so many times the stamp, and the row


class Waiting(NamedTuple):
    """The rows that wait, and the candidates of a step: two heaps."""

    keys: NDArray[np.float64]
    entries: NDArray[np.int64]
    many: NDArray[np.int64]  # (1,) how many wait
    measures: NDArray[np.float64]
    candidates: NDArray[np.int64]


def room_to_wait(old: Waiting | None, rows: int, vertices: int) -> Waiting:
    """The queue with room for a front of so many rows and vertices; ``old`` is what was in it before."""
    none = np.empty(0, dtype=np.int64)
    if old is None:
        old = Waiting(np.empty(0), none, np.zeros(1, dtype=np.int64), np.empty(0), none)
    rows = 2 * max(rows, int(old.many[0])) + 64
    return Waiting(
        grown(old.keys, rows), grown(old.entries, rows), old.many, np.empty(vertices + 16),
        np.empty(vertices + 16, dtype=np.int64),
    )  # fmt: skip


def larger_counts(state: NDArray[np.int64], rows: int, vertices: int, cells: int) -> tuple[int, int, int]:
    """Half as much room again for rows, vertices and cells, wherever little is left."""
    if state[ALIVE] + 64 > rows - rows // 8:
        rows += rows // 2 + 64
    if state[VERTEX_COUNT] + 8 > vertices - vertices // 8:
        vertices += vertices // 2 + 64
    if state[CELLS_MADE] + 8 > cells - cells // 8:
        cells += cells // 2 + 64
    return rows, vertices, cells


@inline
def new_row(front):
    """A free row, with the next stamp."""
    state = front.state
    row = state[FREE_ROW]
    if row >= 0:
        state[FREE_ROW] = front.chain[row]
    else:
        row = state[ROWS]
        state[ROWS] += 1
    front.stamp[row] = state[NEXT_STAMP]
    state[NEXT_STAMP] += 1
    state[ALIVE] += 1
    return row


@inline
def put_in_chain(front, row, v):
    """Let a new row be the first one of its first vertex."""
    front.chain[row] = front.first[v]
    front.first[v] = row


@inline
def drop_row(front, row, v):
    """Take a row, of which v is the first vertex, out of the chain of v, and let it be free."""
    if front.first[v] == row:
        front.first[v] = front.chain[row]
    else:
        before = np.int64(front.first[v])
        while front.chain[before] != row:
            before = np.int64(front.chain[before])
        front.chain[before] = front.chain[row]
    state = front.state
    front.stamp[row] = -1
    front.chain[row] = state[FREE_ROW]
    state[FREE_ROW] = row
    state[ALIVE] -= 1


@inline
def entry_of(stamp, row):
    """What waits for a row."""
    return np.int64(stamp[row] * STAMPED + row)


@inline
def row_of_entry(entry):
    return np.int64(entry % STAMPED)


@inline
def is_current(stamp, entry):
    """Whether what waits is still at the front."""
    return stamp[entry % STAMPED] == entry // STAMPED


@inline
def in_turn(waiting, stamp, row, key):
    """Put a row into the queue."""
    waiting.many[0] = push(waiting.keys, waiting.entries, waiting.many[0], key, entry_of(stamp, row))


@inline
def next_in_turn(waiting, stamp):
    """The next row that is still at the front, -1 if there is none, and its key."""
    key = 0.0
    while waiting.many[0] > 0:
        entry, key = waiting.entries[0], waiting.keys[0]
        waiting.many[0] = pop(waiting.keys, waiting.entries, waiting.many[0])
        if is_current(stamp, entry):
            return row_of_entry(entry), key
    return np.int64(-1), key
