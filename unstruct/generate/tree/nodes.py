"""All cells of a tree, level by level: those that are divided and the leaves, and where the leaves lie.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import frozen
from .contacts import Boundary
from .growing import level_of
from .linear import Leaves, Linear, children_of, nodes_of
from .lookup import centers_of

__all__ = ["TreeNodes", "all_nodes", "states_of"]


class TreeNodes(NamedTuple):
    """All cells of a tree, those that are divided and the leaves, level by level.

    Attributes
    ----------
    levels : (k,) int8
    centers : (k, d) float64
    parents : (k,) int64
        The number of the parent; -1 for the root, which is the first.
    leaves : (k,) int64
        The number of the leaf; -1 for cells that are divided.
    """

    levels: NDArray[np.int8]
    centers: NDArray[np.float64]
    parents: NDArray[np.int64]
    leaves: NDArray[np.int64]


def all_nodes(linear: Linear, leaves: Leaves, box: NDArray[np.float64]) -> TreeNodes:
    """The cells of a tree over the box (2, d): k divisions make 1 + 2**d k of them."""
    d, low, side = linear.dimension, box[0], box[1] - box[0]
    blocks, begin, above = [], 0, np.empty(0, dtype=np.int64)
    for level in range(linear.depth + 1):
        keys = nodes_of(linear, level)
        divided = np.zeros(len(keys), dtype=bool)
        if level < linear.depth:
            divided[np.searchsorted(keys, linear.split[level])] = True
        leaf = np.searchsorted(leaves.first, keys << np.uint64(d * (linear.depth - level)))
        parent = np.repeat(above, 1 << d) if level else np.array([-1])
        levels = np.full(len(keys), level, dtype=np.int8)
        blocks.append((levels, centers_of(keys, low, side, level), parent, np.where(divided, -1, leaf)))
        above = begin + np.flatnonzero(divided)
        begin += len(keys)
    return TreeNodes(*(frozen(np.concatenate(column)) for column in zip(*blocks, strict=True)))


def states_of(
    linear: Linear, leaves: Leaves, box: NDArray[np.float64], boundary: Boundary
) -> NDArray[np.int8]:
    """Where each leaf lies: 1 inside of the boundary, -1 outside, 0 if it meets the leaf's inside: (n,)."""
    d, low, side = linear.dimension, box[0], box[1] - box[0]
    states = np.empty(len(leaves.keys), dtype=np.int8)
    nodes = level_of(low, side, np.zeros(1, dtype=np.uint64), 0, boundary, None)
    while True:
        level = nodes.level
        divided = np.zeros(len(nodes.keys), dtype=bool)
        if level < linear.depth:
            divided[np.searchsorted(nodes.keys, linear.split[level])] = True
        first = nodes.keys[~divided] << np.uint64(d * (linear.depth - level))
        assert nodes.contacts is not None
        states[np.searchsorted(leaves.first, first)] = nodes.contacts.state[~divided]
        if not divided.any():
            return states
        nodes = level_of(low, side, children_of(nodes.keys[divided], d), level + 1, boundary, nodes)
