"""A tree without pointers: for each level the sorted keys of its nodes that are divided.

Everything else follows from these arrays. The leaves are found by one walk through all levels at once, as the
divided nodes of a level are met in the order of their keys; and the first levels are the tree as it was when
only so many had been made. See the book, chapter 4a.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct, frozen
from ...base.jit import kernel
from .keys import DEEPEST_LEVEL, Keys

__all__ = ["Leaves", "Linear", "children_of", "leaves_of", "linear_of", "merged", "nodes_of"]


class Linear(NamedTuple):
    """``split[l]``: the sorted keys of the nodes of level l that are divided; the last is never empty."""

    split: tuple[Keys, ...]
    dimension: int

    @property
    def depth(self) -> int:
        """The level of the smallest leaves."""
        return len(self.split)

    @property
    def divided(self) -> int:
        """The number of nodes that are divided."""
        return sum(map(len, self.split))


class Leaves(NamedTuple):
    """The leaves in the order of the depth-first walk; all arrays are read-only.

    Attributes
    ----------
    keys : (n,) uint64
        On their own levels.
    levels : (n,) int8
    first : (n,) uint64
        The keys of their first cells on the level `depth` of the tree; increasing.
    """

    keys: Keys
    levels: NDArray[np.int8]
    first: Keys


def linear_of(split: Sequence[Keys], dimension: int) -> Linear:
    """The record, read-only, without levels at the end on which no node is divided."""
    levels = list(split)
    while levels and not len(levels[-1]):
        levels.pop()
    return Linear(tuple(map(frozen, levels)), dimension)


def children_of(keys: Keys, dimension: int) -> Keys:
    """The children of nodes, in order: (2**d n,)."""
    return ((keys[:, None] << np.uint64(dimension)) | np.arange(1 << dimension, dtype=np.uint64)).ravel()


def nodes_of(tree: Linear, level: int) -> Keys:
    """All nodes of a level, divided or not, in order."""
    if level == 0:
        return np.zeros(1, dtype=np.uint64)
    if level > tree.depth:
        return np.empty(0, dtype=np.uint64)
    return children_of(tree.split[level - 1], tree.dimension)


def merged(keys: Keys, others: Keys) -> Keys:
    """The union of sorted keys without repetitions and of any others; sorted, without repetitions."""
    return distinct(np.concatenate([keys, others])) if len(others) else keys


@kernel
def _walk(split, start, d, keys, levels, first):
    """Emit the leaves; `split` has the keys of all levels, those of level l from ``start[l]`` on."""
    depth = len(start) - 1
    at = start.copy()
    key, level, n = np.uint64(0), 0, 0
    last = np.uint64((1 << d) - 1)
    while True:
        if level < depth and at[level] < start[level + 1] and split[at[level]] == key:
            at[level] += 1
            level += 1
            key = key << np.uint64(d)
            continue
        keys[n], levels[n] = key, level
        first[n] = key << np.uint64(d * (depth - level))
        n += 1
        while level > 0 and key & last == last:
            key = key >> np.uint64(d)
            level -= 1
        if level == 0:
            return
        key += np.uint64(1)


def leaves_of(tree: Linear) -> Leaves:
    """The leaves of the tree, in O(their number)."""
    d = tree.dimension
    if tree.depth > DEEPEST_LEVEL[d]:
        raise ValueError(f"a tree of {tree.depth} levels; keys have room for {DEEPEST_LEVEL[d]}")
    n = 1 + ((1 << d) - 1) * tree.divided
    split = np.concatenate(tree.split) if tree.depth else np.empty(0, dtype=np.uint64)
    start = np.concatenate([[0], np.cumsum([len(keys) for keys in tree.split], dtype=np.int64)])
    keys, levels = np.empty(n, dtype=np.uint64), np.empty(n, dtype=np.int8)
    first = np.empty(n, dtype=np.uint64)
    _walk(split, start.astype(np.int64), d, keys, levels, first)
    return Leaves(frozen(keys), frozen(levels), frozen(first))
