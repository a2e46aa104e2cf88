"""Trees for tests: as sets of leaves (`unstruct.plain.tree`), and as the library has them."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
from hypothesis import strategies as st

from unstruct import Tree
from unstruct.generate.tree.keys import keys_of
from unstruct.generate.tree.linear import Linear, linear_of
from unstruct.plain import tree as plain

FINE = 8  # grids of points are as fine as the cells of this level
UNIT = {d: np.array([[0.0] * d, [1.0] * d]) for d in (2, 3)}
OFFSET = 1e8  # with these boxes, all corners of cells up to level 12 are still doubles of their own
BOXES = {
    2: [UNIT[2], [[-0.1, 0.3], [1.7, 0.4]], [[OFFSET, -OFFSET], [OFFSET + 3.0, 3.0 - OFFSET]]],
    3: [UNIT[3], [[-0.1, 0.3, 7.0], [1.7, 0.4, 9.1]], [[OFFSET, 0.0, -1e-9], [OFFSET + 3.0, 1e9, 1e-9]]],
}


def leaves(d: int, deepest: int = 5, targets: int = 4) -> st.SearchStrategy[frozenset]:
    """Leaves of trees that are divided around some points of a grid, which may lie on faces and corners."""
    grid = st.integers(0, (1 << FINE) - 1) | st.integers(0, 15).map(lambda i: min(i << (FINE - 4), 255))
    point = st.tuples(st.tuples(*[grid] * d), st.integers(0, deepest))
    return st.lists(point, max_size=targets).map(lambda rows: frozenset(toward(d, rows)))


def toward(d: int, rows: list) -> set:
    """The leaves of the tree in which the cells that contain a point are divided down to its level."""
    divided = set()
    for at, level in rows:
        divided |= {(m, *(i >> (FINE - m) for i in at)) for m in range(level)}
    return plain.build(d, divided.__contains__, FINE)


def packed(cells: set | frozenset, d: int) -> Linear:
    """The record of the library."""
    divided = plain.nodes(cells) - set(cells)
    split = []
    for level in range(plain.depth(cells)):
        rows = [cell[1:] for cell in divided if cell[0] == level]
        split.append(np.sort(keys_of(np.array(rows, dtype=np.int64).reshape(-1, d))))
    return linear_of(split, d)


def planted(cells: set | frozenset, d: int, box: object = None, balance: str | None = None) -> Tree:
    return Tree(packed(cells, d), np.array(UNIT[d] if box is None else box, dtype=float), balance)


def unpacked(tree: Tree) -> set:
    """The leaves as plain cells."""
    at = tree.coordinates >> (tree.depth - tree.levels.astype(np.int64))[:, None]
    return {(int(level), *map(int, i)) for level, i in zip(tree.levels, at, strict=True)}


def in_order(tree: Tree) -> list:
    """The leaves as plain cells, in the order of their numbers."""
    at = tree.coordinates >> (tree.depth - tree.levels.astype(np.int64))[:, None]
    return [(int(level), *map(int, i)) for level, i in zip(tree.levels, at, strict=True)]


def exact(x: np.ndarray) -> tuple[Fraction, ...]:
    return tuple(map(Fraction, x.tolist()))


def places(box: np.ndarray, many: int = 9) -> np.ndarray:
    """Points of a grid over a box, and just beside it."""
    low, high = np.asarray(box, dtype=float)
    steps = [np.concatenate([[np.nextafter(a, -np.inf)], np.linspace(a, b, many), [np.nextafter(b, np.inf)]])
             for a, b in zip(low, high, strict=True)]  # fmt: skip
    return np.array(list(product(*steps)))
