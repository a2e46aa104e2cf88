"""Which leaves are neighbors: across faces, edges or corners, in any tree, balanced or not.

Each leaf looks for the cell of its own size beyond each of its faces, edges and corners. If a leaf as large
or larger contains that cell, the two are neighbors. Pairs of leaves of different size are thus found from
the smaller one. See the book, chapter 4a.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct
from ...base.jit import kernel
from .keys import compacted, interleaved
from .lookup import Grid, entries, leaf_of

__all__ = ["neighbor_pairs", "rows_of_pairs"]


@kernel
def _pairs(grid, shift, d, most, pairs):
    """Pairs (leaf, neighbor as large or larger); with repetitions across edges and corners."""
    count = 0
    side = np.int64(1) << np.int64(grid.depth)
    low = np.zeros(3, dtype=np.int64)
    cell = np.zeros(3, dtype=np.int64)
    for leaf in range(len(grid.first)):
        level = grid.levels[leaf]
        width = np.int64(1) << np.int64(grid.depth - level)
        for a in range(d):
            low[a] = np.int64(compacted(grid.first[leaf] >> np.uint64(a), d))
        for code in range(3**d):
            axes, rest, inside = 0, code, True
            for a in range(d):
                move = rest % 3 - 1
                rest //= 3
                axes += move != 0
                cell[a] = low[a] + move * width
                inside &= 0 <= cell[a] < side
            if axes == 0 or axes > most or not inside:
                continue
            other = leaf_of(grid.first, grid.entry, shift, interleaved(cell[0], cell[1], cell[2], d))
            if grid.levels[other] <= level:
                pairs[count, 0], pairs[count, 1] = leaf, other
                count += 1
    return count


def neighbor_pairs(grid: Grid, most: int) -> NDArray[np.int64]:
    """All pairs (i, j) of leaves that are neighbors, both ways, each once, sorted by i and then j: (m, 2).

    `most` is the number of axes along which they may differ: 1 across faces, d across corners.
    """
    d, n = len(grid.low), len(grid.first)
    around = (2 * d, 8 if d == 2 else 18, 26)[most - 1]
    pairs = np.empty((around * n, 2), dtype=np.int64)
    found = pairs[: _pairs(grid, entries(grid.depth, d), d, most, pairs)]
    keys = distinct(np.concatenate([found[:, 0] * n + found[:, 1], found[:, 1] * n + found[:, 0]]))
    return np.column_stack(np.divmod(keys, n))


def rows_of_pairs(pairs: NDArray[np.int64], n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Sorted pairs as rows: the neighbors of leaf i are ``indices[indptr[i]:indptr[i + 1]]``."""
    return np.searchsorted(pairs[:, 0], np.arange(n + 1)), pairs[:, 1].copy()
