"""The vertices of the leaves: numbered once, although up to 2**d leaves share each of them.

A vertex is the lowest corner of the leaf that begins there, and takes its number. Only those at which no leaf
begins need a search: on the upper sides of the box, and *hanging* ones, inside an edge or a face of a larger
leaf. See the book, chapter 4a.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct
from ...base.jit import inline, kernel
from .keys import compacted, interleaved
from .lookup import Grid, corners, entries, leaf_of

__all__ = ["Vertices", "numbered"]


class Vertices(NamedTuple):
    """The vertices of all leaves.

    Attributes
    ----------
    points : (v, d) float64
        First the lowest corners of the leaves, in their order, then the others.
    coordinates : (v, d) int64
        In cells of the deepest level.
    corners : (n, 2**d) int32
        Those of each leaf: bit a of the column tells on which side of the leaf it lies along axis a.
    """

    points: NDArray[np.float64]
    coordinates: NDArray[np.int64]
    corners: NDArray[np.int32]


@inline
def _lattice_key(x, y, z, side):
    """A number for each vertex of the lattice of the deepest level."""
    return (z * (side + 1) + y) * (side + 1) + x


@kernel
def _number(grid, shift, d, vertex, wanting, keys):
    """Fill in the corners that are lowest corners of leaves; list the others, with their keys."""
    first, levels, entry = grid.first, grid.levels, grid.entry
    side = np.int64(1) << np.int64(grid.depth)
    at = np.zeros(3, dtype=np.int64)
    count = 0
    for leaf in range(len(first)):
        width = np.int64(1) << np.int64(grid.depth - levels[leaf])
        for c in range(1 << d):
            on_top = False
            for a in range(d):
                at[a] = np.int64(compacted(first[leaf] >> np.uint64(a), d)) + ((c >> a) & 1) * width
                on_top |= at[a] == side
            if not on_top:
                key = interleaved(at[0], at[1], at[2], d)
                other = leaf_of(first, entry, shift, key)
                if first[other] == key:
                    vertex[leaf, c] = other
                    continue
            wanting[count] = leaf * (1 << d) + c
            keys[count] = _lattice_key(at[0], at[1], at[2], side)
            count += 1
    return count


def numbered(grid: Grid) -> Vertices:
    """The vertices of the leaves: O(n log n)."""
    n, d = len(grid.first), len(grid.low)
    vertex = np.empty((n, 1 << d), dtype=np.int32)
    wanting = np.empty(n << d, dtype=np.int64)
    keys = np.empty(n << d, dtype=np.int64)
    count = _number(grid, entries(grid.depth, d), d, vertex, wanting, keys)
    found = distinct(keys[:count])
    vertex.ravel()[wanting[:count]] = n + np.searchsorted(found, keys[:count])
    own = np.empty((n + len(found), d), dtype=np.int64)
    side = (1 << grid.depth) + 1
    for a in range(d):
        own[:n, a] = _axis(grid.first, a, d)
        own[n:, a] = found // side**a % side
    return Vertices(corners(grid.low, grid.side, own, grid.depth), own, vertex)


@kernel
def _compact_axis(first, a, d, result):
    for i in range(len(first)):
        result[i] = np.int64(compacted(first[i] >> np.uint64(a), d))


def _axis(first: NDArray[np.uint64], a: int, d: int) -> NDArray[np.int64]:
    result = np.empty(len(first), dtype=np.int64)
    _compact_axis(first, a, d, result)
    return result
