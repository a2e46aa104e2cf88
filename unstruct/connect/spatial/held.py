"""A hash table of edges, for kernels: which of them must not be destroyed."""

from __future__ import annotations

import numpy as np

from ...base.jit import inline, kernel, lean
from .records import Held

__all__ = ["grown_held", "hold", "holds", "new_held"]


def new_held(edges: int) -> Held:
    """An empty table with room for this many edges."""
    room = 64
    while room < 3 * edges:
        room *= 2
    return Held(np.full(room, -1, dtype=np.int64), np.zeros(room, dtype=np.int8))


@inline
def _place(held, u, v):
    """Where the edge is in the table, or would be."""
    key = (np.int64(min(u, v)) << 32) | np.int64(max(u, v))
    room = held.key.shape[0]
    place = (min(u, v) * 40503 + max(u, v) * 30011) & (room - 1)
    while held.key[place] != -1 and held.key[place] != key:
        place = (place + 1) & (room - 1)
    return place, key


def grown_held(held: Held, edges: int) -> Held:
    """The same table; another one with the same edges where there is no room for so many."""
    if 2 * edges <= len(held.key):
        return held
    larger = new_held(2 * edges)
    _copy(held, larger)
    return larger


@kernel
def hold(held, u, v, value):
    """Hold the edge uv (value 1), or no longer (value 0)."""
    place, key = _place(held, u, v)
    held.key[place] = key
    held.value[place] = value


@lean
def holds(held, u, v):
    """Whether the edge uv is held."""
    place, key = _place(held, u, v)
    return held.key[place] == key and held.value[place] == 1


@kernel
def _copy(held, larger):
    for i in range(held.key.shape[0]):
        if held.key[i] != -1:
            hold(larger, held.key[i] >> 32, held.key[i] & 0xFFFFFFFF, held.value[i])
