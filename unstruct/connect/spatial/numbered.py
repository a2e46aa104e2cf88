"""A hash table of edges with numbers, for kernels: the subsegments of a complex.

Like `held`, but an edge has a number, and it is known which vertices have edges in the table at all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel, lean

__all__ = ["Numbered", "forget_edge", "new_numbered", "number_edge", "number_edges", "number_of_edge"]


class Numbered(NamedTuple):
    """Keys of edges (-1: empty), their numbers (-1: not there any more), and how many each vertex has."""

    key: NDArray[np.int64]
    number: NDArray[np.int32]
    degree: NDArray[np.int32]


def new_numbered(edges: int, vertices: int) -> Numbered:
    """An empty table with room for this many edges, those that will be forgotten included."""
    room = 64
    while room < 2 * edges:
        room *= 2
    return Numbered(
        np.full(room, -1, dtype=np.int64),
        np.full(room, -1, dtype=np.int32),
        np.zeros(vertices, dtype=np.int32),
    )


@inline
def _slot(edges, u, v):
    """Where the edge is in the table, or would be."""
    low, high = np.int64(min(u, v)), np.int64(max(u, v))
    key, room = (low << 32) | high, edges.key.shape[0]
    slot = (low * 40503 + high * 30011) & (room - 1)
    while edges.key[slot] != -1 and edges.key[slot] != key:
        slot = (slot + 1) & (room - 1)
    return slot, key


@kernel
def number_edge(edges, u, v, number):
    """Enter the edge uv; there must be room."""
    slot, key = _slot(edges, u, v)
    if edges.key[slot] != key or edges.number[slot] < 0:
        edges.degree[u] += 1
        edges.degree[v] += 1
    edges.key[slot] = key
    edges.number[slot] = number


@kernel
def number_edges(edges, ends, first, last):
    """Enter the edges ``ends[first:last]`` by their rows."""
    for i in range(first, last):
        number_edge(edges, ends[i, 0], ends[i, 1], i)


@kernel
def forget_edge(edges, u, v):
    """Take the edge uv out."""
    slot, key = _slot(edges, u, v)
    if edges.key[slot] == key and edges.number[slot] >= 0:
        edges.number[slot] = -1
        edges.degree[u] -= 1
        edges.degree[v] -= 1


@lean
def number_of_edge(edges, u, v):
    """The number of the edge uv, -1 if it has none."""
    if edges.degree[u] == 0 or edges.degree[v] == 0:
        return np.int64(-1)
    slot, key = _slot(edges, u, v)
    return np.int64(edges.number[slot]) if edges.key[slot] == key else np.int64(-1)
