"""A k-d tree as flat arrays, for searches that shrink their ball as they go.

Node i has the children 2 i + 1 and 2 i + 2 and covers the points ``start[i]`` to ``start[i] + size[i] - 1``
of the order; a leaf holds at most ``POINTS_IN_LEAF`` points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.jit import inline, kernel

__all__ = ["POINTS_IN_LEAF", "Tree", "beyond", "distance2"]

POINTS_IN_LEAF = 6


@dataclass(frozen=True)
class Tree:
    """Points in the order of a k-d tree."""

    order: NDArray[np.int64]
    start: NDArray[np.int64]
    size: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @classmethod
    def of(cls, points: NDArray[np.float64]) -> Tree:
        """Build by medians along the widest side of each box: O(n log^2 n)."""
        n, d = points.shape
        nodes = 1
        while n > POINTS_IN_LEAF * (nodes + 1) // 2:  # nodes = 2^(j + 1) - 1: 2^j leaves
            nodes = 2 * nodes + 1
        order = np.arange(n)
        start, size = np.zeros(nodes, dtype=np.int64), np.zeros(nodes, dtype=np.int64)
        low, high = np.empty((nodes, d)), np.empty((nodes, d))
        _build(points, order, start, size, low, high)
        return cls(order, start, size, low, high)


@kernel
def _build(points, order, start, size, low, high):
    size[0] = len(points)
    for node in range(len(start)):
        first, last = start[node], start[node] + size[node]
        for i in range(points.shape[1]):
            low[node, i], high[node, i] = np.inf, -np.inf
            for j in range(first, last):
                low[node, i] = min(low[node, i], points[order[j], i])
                high[node, i] = max(high[node, i], points[order[j], i])
        if 2 * node + 2 < len(start):
            widest = 0
            for i in range(1, points.shape[1]):
                if high[node, i] - low[node, i] > high[node, widest] - low[node, widest]:
                    widest = i
            part = order[first:last].copy()
            sequence = np.argsort(points[part, widest])
            for j in range(len(part)):
                order[first + j] = part[sequence[j]]
            half = size[node] // 2
            start[2 * node + 1], size[2 * node + 1] = first, half
            start[2 * node + 2], size[2 * node + 2] = first + half, size[node] - half


@inline
def distance2(low, high, node, x):
    """Squared distance from x to the box of the node."""
    total = 0.0
    for i in range(len(x)):
        if x[i] < low[node, i]:
            total += (low[node, i] - x[i]) ** 2
        elif x[i] > high[node, i]:
            total += (x[i] - high[node, i]) ** 2
    return total


@inline
def beyond(low, high, node, normal, a):
    """The largest value of normal . (x - a) over the box of the node."""
    total = 0.0
    for i in range(len(a)):
        if normal[i] > 0:
            total += normal[i] * (high[node, i] - a[i])
        else:
            total += normal[i] * (low[node, i] - a[i])
    return total
