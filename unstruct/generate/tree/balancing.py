"""Balance: no leaf has a neighbor that is more than one level deeper.

One pass from the deepest level upward makes a tree balanced with the fewest further cells. Where a node of
level l is divided, its children lie beside nodes of level l, and these exist if their parents are divided. Of
the cells around the node, half lie in its own parent. The others lie in the neighbors of that parent on the
node's side of it: at most 2**d - 1 nodes of level l - 1. See the book, chapter 4a.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import frozen
from ...base.jit import kernel
from .keys import Keys, compacted, interleaved
from .linear import Linear, linear_of

__all__ = ["ACROSS", "balanced", "directions"]

ACROSS = ("faces", "edges", "corners")  # what two cells share at least, from the most to the least
HASH_STEP = np.uint64(
    0x9E3779B97F4A7C15
)  # 2**64 over the golden ratio (Knuth, The Art of Computer Programming 3, 6.4)


def directions(across: str, dimension: int) -> int:
    """Along how many axes at once neighbors may differ: 1 across faces, d across corners."""
    return {"faces": 1, "edges": min(2, dimension), "corners": dimension}[across]


@kernel
def _wanted(keys, level, d, most, found):
    """The nodes of level - 1 that must be divided because those of `keys` are; sorted runs, with repetitions.

    Nodes of one parent follow each other, so that what they want is gathered for the parent: a set of bits,
    bit b for its neighbor with the offsets b % 3 - 1, b // 3 % 3 - 1 and b // 9 - 1.
    """
    n, i, count = len(keys), 0, 0
    side = np.int64(1) << (level - 1)
    low = np.empty(3, dtype=np.int64)
    while i < n:
        parent = keys[i] >> np.uint64(d)
        wanted = np.int64(0)
        while i < n and keys[i] >> np.uint64(d) == parent:
            child = np.int64(keys[i] & np.uint64((1 << d) - 1))
            i += 1
            for axes in range(1 << d):
                bits, b, unit, weight = 0, np.int64(0), 1, axes
                for a in range(d):
                    move = 0
                    if weight & 1:
                        bits += 1
                        move = 1 if (child >> a) & 1 else -1
                    b += (move + 1) * unit
                    unit *= 3
                    weight >>= 1
                if d == 2:
                    b += 9
                if bits <= most:
                    wanted |= np.int64(1) << b
        for a in range(d):
            low[a] = np.int64(compacted(parent >> np.uint64(a), d))
        for b in range(27):
            if not (wanted >> b) & 1:
                continue
            x, y, z = low[0] + b % 3 - 1, low[1] + b // 3 % 3 - 1, np.int64(b // 9 - 1)
            if d == 3:
                z += low[2]
            if x < 0 or y < 0 or z < 0 or x >= side or y >= side or z >= side:
                continue
            found[count] = interleaved(x, y, z, d)
            count += 1
    return count


@kernel
def _new(keys, wanted, count, table):
    """Move to the front of `wanted` those that are not in `keys`, each once; return their number.

    `table` is a hash table of a power of two entries, filled with the largest number.
    """
    empty = np.uint64(0xFFFFFFFFFFFFFFFF)
    mask = np.uint64(len(table) - 1)
    shift = np.uint64(64)
    size = len(table)
    while size > 1:
        shift -= np.uint64(1)
        size >>= 1
    new = 0
    for turn in range(2):
        rows = keys if turn == 0 else wanted[:count]
        for i in range(len(rows)):
            key = rows[i]
            at = (key * HASH_STEP) >> shift
            while table[at] != empty and table[at] != key:
                at = (at + np.uint64(1)) & mask
            if table[at] == empty:
                table[at] = key
                if turn == 1:
                    wanted[new] = key
                    new += 1
    return new


def _divided_too(tree_level: Keys, keys: Keys, level: int, dimension: int, most: int) -> Keys:
    """The nodes of level - 1 that are divided when those of `keys` are: `tree_level`, and what these want."""
    parents = 1 + np.count_nonzero(np.diff(keys >> np.uint64(dimension)))
    wanted = np.empty(parents * (3**dimension), dtype=np.uint64)
    count = _wanted(frozen(keys), level, dimension, most, wanted)
    room = 2 * (len(tree_level) + count) + 2
    table = np.full(1 << int(room - 1).bit_length(), np.iinfo(np.uint64).max, dtype=np.uint64)
    new = _new(frozen(tree_level), wanted, count, table)
    if not new:
        return tree_level
    return np.sort(np.concatenate([tree_level, wanted[:new]]))


def balanced(tree: Linear, across: str = "corners") -> Linear:
    """The smallest balanced tree that has all cells of this one.

    Parameters
    ----------
    tree : Linear
    across : "faces", "edges" or "corners"
        Which leaves count as neighbors.

    Returns
    -------
    Linear

    Notes
    -----
    O(n log n) for n nodes: a hash table and a sort a level. Source: D. Moore, *The cost of balancing
    generalized quadtrees*, Proc. 3rd ACM Symp. Solid Modeling, 1995. Book: 4a.
    """
    split: list[NDArray[np.uint64]] = list(tree.split)
    most = directions(across, tree.dimension)
    for level in range(len(split) - 1, 0, -1):
        split[level - 1] = _divided_too(split[level - 1], split[level], level, tree.dimension, most)
    return linear_of(split, tree.dimension)
