"""A static tree over axis-parallel boxes: which of them meet a box or contain a point. See chapter 1."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.jit import inline, kernel

__all__ = ["BOXES_IN_LEAF", "BoxTree", "bounding_boxes", "square_to_box"]


BOXES_IN_LEAF = 4  # boxes in a leaf of the tree
USUAL_HITS = 32  # boxes that a query meets, for which there is room at first


@inline
def _touch(low, high, other_low, other_high):
    """Whether two closed boxes meet."""
    for j in range(low.shape[0]):
        if low[j] > other_high[j] or high[j] < other_low[j]:
            return False
    return True


@inline
def square_to_box(x, y, z, low, high, w):
    """The squared distance of a point in space from box w; infinite if it is empty."""
    u = max(low[w, 0] - x, x - high[w, 0], 0.0)
    v = max(low[w, 1] - y, y - high[w, 1], 0.0)
    s = max(low[w, 2] - z, z - high[w, 2], 0.0)
    return u * u + v * v + s * s


class Boxes(NamedTuple):
    """Boxes in a tree: those of its nodes, the order of the boxes in its leaves, the boxes."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    order: NDArray[np.int64]
    box_low: NDArray[np.float64]
    box_high: NDArray[np.float64]


@kernel
def _candidates(query_low, query_high, tree, start, boxes):
    """The boxes that meet each query box. Those for which ``boxes`` has no room are only counted.

    Node i of the tree has the children 2 i and 2 i + 1; the second half of the nodes are leaves.
    ``start[q + 1]`` receives the number of pairs of the queries 0 to q.
    """
    low, high, order, box_low, box_high = tree
    leaves = low.shape[0] // 2
    stack = np.empty(128, dtype=np.int64)
    count = 0
    for q in range(query_low.shape[0]):
        top = 1
        stack[0] = 1
        while top > 0:
            top -= 1
            node = stack[top]
            if not _touch(query_low[q], query_high[q], low[node], high[node]):
                continue
            if node < leaves:
                stack[top] = 2 * node
                stack[top + 1] = 2 * node + 1
                top += 2
                continue
            first = (node - leaves) * BOXES_IN_LEAF
            for i in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                t = order[i]
                if _touch(query_low[q], query_high[q], box_low[t], box_high[t]):
                    if count < boxes.shape[0]:
                        boxes[count] = t
                    count += 1
        start[q + 1] = count


@inline
def _spaced(i):
    """The number i, below 2^31, with a zero bit inserted between any two of its bits."""
    i = (i | i << 16) & 0x0000FFFF0000FFFF
    i = (i | i << 8) & 0x00FF00FF00FF00FF
    i = (i | i << 4) & 0x0F0F0F0F0F0F0F0F
    i = (i | i << 2) & 0x3333333333333333
    return (i | i << 1) & 0x5555555555555555


@kernel
def _morton(box_low, box_high, bits, keys):
    """Keys of boxes by their centers: interleaved bits of coordinates, in order along a Z-shaped curve.

    Halves are used because the span of the largest doubles would overflow. The order need not be exact.
    """
    d = min(box_low.shape[1], 62)  # of more coordinates no bit has room
    first, span = np.empty(d), np.finfo(np.float64).tiny
    for j in range(d):
        least, most = np.inf, -np.inf
        for i in range(box_low.shape[0]):
            center = box_low[i, j] / 2 + box_high[i, j] / 2
            least, most = min(least, center), max(most, center)
        first[j] = least / 2
        span = max(span, most / 2 - least / 2)
    wide, last = 2.0**bits, 2.0**bits - 1
    grid = np.empty(d, dtype=np.int64)
    for i in range(box_low.shape[0]):
        for j in range(d):
            half = (box_low[i, j] / 2 + box_high[i, j] / 2) / 2 - first[j]
            grid[j] = int(min(half / span * wide, last))
        if d == 2:
            keys[i] = 2 * _spaced(grid[0]) + _spaced(grid[1])
            continue
        key = 0
        for b in range(bits - 1, -1, -1):
            for j in range(d):
                key = 2 * key + ((grid[j] >> b) & 1)
        keys[i] = key


@kernel
def _enclose(box_low, box_high, order, low, high):
    """Write the boxes of the nodes of a tree: leaves from their boxes, others from their children."""
    leaves = low.shape[0] // 2
    for node in range(2 * leaves - 1, -1, -1):
        for j in range(low.shape[1]):
            low[node, j], high[node, j] = np.inf, -np.inf
        if node >= leaves:
            first = (node - leaves) * BOXES_IN_LEAF
            for i in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                t = order[i]
                for j in range(low.shape[1]):
                    low[node, j] = min(low[node, j], box_low[t, j])
                    high[node, j] = max(high[node, j], box_high[t, j])
        elif node > 0:
            for child in (2 * node, 2 * node + 1):
                for j in range(low.shape[1]):
                    low[node, j] = min(low[node, j], low[child, j])
                    high[node, j] = max(high[node, j], high[child, j])


def _curve_order(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    keys = np.empty(len(low), dtype=np.int64)
    _morton(low, high, max(1, 62 // low.shape[1]), keys)
    return np.argsort(keys, kind="stable")


def bounding_boxes(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and highest coordinates of each of many groups of points, (m, k, d) -> twice (m, d)."""
    low, high = corners[:, 0], corners[:, 0]
    for k in range(1, corners.shape[1]):  # numpy is slow at many minima of short rows
        low, high = np.minimum(low, corners[:, k]), np.maximum(high, corners[:, k])
    return low, high


class BoxTree:
    """A static tree over axis-parallel closed boxes, sorted along a space-filling curve; O(m log m)."""

    def __init__(self, low: np.ndarray, high: np.ndarray):
        m, d = low.shape
        self.box_low, self.box_high = np.ascontiguousarray(low), np.ascontiguousarray(high)
        self.order = _curve_order(self.box_low, self.box_high) if m else np.empty(0, dtype=np.int64)
        leaves = 1 << max(0, (-(-m // BOXES_IN_LEAF) - 1).bit_length())
        self.low, self.high = np.empty((2 * leaves, d)), np.empty((2 * leaves, d))
        _enclose(self.box_low, self.box_high, self.order, self.low, self.high)

    def pairs(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All pairs of a query box and a box of the tree that meet, sorted by query."""
        queries = (np.ascontiguousarray(low), np.ascontiguousarray(high))
        tree = Boxes(self.low, self.high, self.order, self.box_low, self.box_high)
        start = np.zeros(len(low) + 1, dtype=np.int64)
        room = USUAL_HITS * len(low) + len(self.order)  # memory that is not written to costs nothing
        boxes = np.empty(room, dtype=np.int64)
        _candidates(*queries, tree, start, boxes)
        count = int(start[-1])
        if count > room:
            boxes = np.empty(count, dtype=np.int64)
            _candidates(*queries, tree, start, boxes)
        return np.repeat(np.arange(len(low)), np.diff(start)), boxes[:count]
