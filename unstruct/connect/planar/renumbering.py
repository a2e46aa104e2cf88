"""Vertices and triangles of a complex in a new order, so that neighbors are near each other in memory.

Where a front advances from all sides at once, neighbors come to lie far apart. Passes over a large mesh are
then slow, because each star that they look at is scattered. Along a Hilbert curve it is in a few places.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.ordering import hilbert_order
from ..insertion.engine import COUNT, FREE, LAST
from ..insertion.halfedges import SEGMENTS, VERTICES
from .complex import PlanarComplex

__all__ = ["renumber"]


def renumber(c: PlanarComplex, first: int) -> tuple[NDArray[np.int32], NDArray[np.int32]] | None:
    """Order the vertices from ``first`` on along a Hilbert curve, and all triangles by their first vertex.

    Returns
    -------
    number, slot : ndarray of int32
        The new number of each vertex, and the new slot of each triangle. None, and nothing has changed, if
        there are free slots.

    Notes
    -----
    O(n). The arrays are replaced; subsegments keep their numbers.
    """
    if c.state[FREE] >= 0:
        return None
    n = c.size
    order = np.concatenate([np.arange(first), first + hilbert_order(c.xy[first:n])])
    number, slot = np.empty(n, dtype=np.int32), np.empty(c.triangles, dtype=np.int32)
    old = c.plane()
    new = old._replace(
        xy=np.empty_like(old.xy), vertex=np.empty_like(old.vertex), twin=np.empty_like(old.twin),
        mark=np.empty_like(old.mark), region=np.empty_like(old.region), where=np.empty_like(old.where),
        ends=np.empty_like(old.ends),
    )  # fmt: skip
    _move(old, new, order, number, slot, np.zeros(n + 1, dtype=np.int32))
    c.xy, c.vertex, c.twin, c.mark, c.region, c.where, c.ends = new[:7]
    return number, slot


@kernel
def _move(old, new, order, number, slot, start):
    """Write the arrays in the new order; ``start`` are zeros, one more than there are vertices."""
    state = old.state
    for i in range(state[VERTICES]):
        number[order[i]] = i
        new.xy[i, 0], new.xy[i, 1] = old.xy[order[i], 0], old.xy[order[i], 1]
    for t in range(state[COUNT]):
        slot[t] = state[VERTICES]
        for e in range(3 * t, 3 * t + 3):
            if old.vertex[e] >= 0:
                slot[t] = min(slot[t], number[old.vertex[e]])
        start[slot[t] + 1] += 1
    for v in range(state[VERTICES]):
        start[v + 1] += start[v]
    for t in range(state[COUNT]):
        key = slot[t]
        slot[t] = start[key]
        start[key] += 1
    for t in range(state[COUNT]):
        new.region[slot[t]] = old.region[t]
        for k in range(3):
            e, f = 3 * t + k, 3 * slot[t] + k
            v, o = old.vertex[e], old.twin[e]
            new.vertex[f] = number[v] if v >= 0 else v
            new.twin[f] = 3 * slot[o // 3] + o % 3
            new.mark[f] = old.mark[e]
    for s in range(state[SEGMENTS]):
        e = old.where[s]
        new.where[s] = 3 * slot[e // 3] + e % 3
        new.ends[s, 0], new.ends[s, 1] = number[old.ends[s, 0]], number[old.ends[s, 1]]
    state[LAST] = slot[state[LAST]]
