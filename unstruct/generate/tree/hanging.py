"""Hanging vertices: those that lie in an edge or a face of a leaf without being one of its corners.

A function on the leaves that is linear along each edge is continuous if its value at such a vertex is that of
the larger leaf there. See the book, chapter 4a.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from .keys import compacted, interleaved
from .lookup import Grid, entries, leaf_of
from .vertices import Vertices

__all__ = ["Hanging", "hanging_of"]


class Hanging(NamedTuple):
    """Hanging vertices, and the vertices that decide what happens there.

    Attributes
    ----------
    vertices : (k,) int32
        Their numbers, increasing.
    parents : (k, 2) int32; in space (k, 4)
        The ends of the edge in which each lies, or the four corners of the face; of an edge they are
        followed by -1. Parents may hang themselves, on leaves that are still larger.
    weights : (k, 2) float64; in space (k, 4)
        By which values at the parents are multiplied, so that their sum is the value at the vertex; 0 where
        there is no parent. In a balanced tree these are 1/2 or 1/4.
    """

    vertices: NDArray[np.int32]
    parents: NDArray[np.int32]
    weights: NDArray[np.float64]


@kernel
def _largest(grid, shift, at, chosen, found):
    """The largest of the chosen leaves around each vertex of which it is no corner; -1 if there is none."""
    d = at.shape[1]
    side = np.int64(1) << np.int64(grid.depth)
    q = np.zeros(3, dtype=np.int64)
    for v in range(len(at)):
        found[v] = -1
        for c in range(1 << d):
            inside = True
            for a in range(d):
                q[a] = at[v, a] - ((c >> a) & 1)
                inside &= 0 <= q[a] < side
            if not inside:
                continue
            leaf = leaf_of(grid.first, grid.entry, shift, interleaved(q[0], q[1], q[2], d))
            if not chosen[leaf] or (found[v] >= 0 and grid.levels[leaf] >= grid.levels[found[v]]):
                continue
            mask = (np.int64(1) << np.int64(grid.depth - grid.levels[leaf])) - 1
            for a in range(d):
                if at[v, a] & mask:
                    found[v] = leaf


@kernel
def _parents(grid, vertices, hung, leaf, parents, weights):
    """The ends of the edge, or the corners of the face, of the leaf in which each vertex lies."""
    d = vertices.coordinates.shape[1]
    free, share = np.zeros(2, dtype=np.int64), np.zeros(2)
    for i in range(len(hung)):
        base, many = 0, 0
        width = np.int64(1) << np.int64(grid.depth - grid.levels[leaf[i]])
        for a in range(d):
            low = np.int64(compacted(grid.first[leaf[i]] >> np.uint64(a), d))
            away = vertices.coordinates[hung[i], a] - low
            if 0 < away < width:
                free[many], share[many] = a, away / width
                many += 1
            elif away == width:
                base |= 1 << a
        for c in range(1 << many):
            corner, weight = base, 1.0
            for k in range(many):
                upper = (c >> k) & 1
                corner |= upper << free[k]
                weight *= share[k] if upper else 1.0 - share[k]
            parents[i, c], weights[i, c] = vertices.corners[leaf[i], corner], weight


def hanging_of(grid: Grid, vertices: Vertices, chosen: NDArray[np.bool_]) -> Hanging:
    """The vertices of the chosen leaves that hang on others of them; O(n log n)."""
    d = len(grid.low)
    used = np.zeros(len(vertices.points), dtype=bool)
    used[vertices.corners[chosen]] = True
    rows = np.flatnonzero(used)
    leaf = np.empty(len(rows), dtype=np.int64)
    _largest(grid, entries(grid.depth, d), vertices.coordinates[rows], chosen, leaf)
    hung, leaf = rows[leaf >= 0], leaf[leaf >= 0]
    parents = np.full((len(hung), 2 * (d - 1)), -1, dtype=np.int32)
    weights = np.zeros(parents.shape)
    _parents(grid, vertices, hung, leaf, parents, weights)
    return Hanging(hung.astype(np.int32), parents, weights)
