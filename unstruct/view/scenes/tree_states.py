"""Trees of the library as frames: their leaves and hanging vertices, and a feature that the reader drags."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.errors import InputError
from ...generate.planting.planting import quadtree
from ...generate.planting.tree import Tree
from ..draw import frames as fr
from .trees import UNIT_WINDOW, many

__all__ = ["TREE_FEATURE", "TREE_KINDS", "TREE_PLACES", "tree_frame", "tree_state"]

TREE_FEATURE = 0.004  # the radius of the feature that the reader drags
TREE_PLACES = np.linspace(0.05, 0.95, 11).round(2).tolist()
# What the panel offers: the depth, and across what the tree is balanced.
TREE_KINDS: dict[str, tuple[int, str | None]] = {
    "depth 5, as divided": (5, None),
    "depth 5, balanced across sides": (5, "faces"),
    "depth 5, balanced across corners": (5, "corners"),
    "nasty: depth 8, as divided": (8, None),
    "nasty: depth 8, balanced across sides": (8, "faces"),
    "nasty: depth 8, balanced across corners": (8, "corners"),
}


def _hanging(tree: Tree) -> NDArray[np.float64]:
    """The places of the hanging vertices (k, d)."""
    return tree.mesh("cells").points[tree.hanging.vertices]


def tree_frame(
    tree: Tree, caption: str = "", *, hanging: bool = False, points: ArrayLike | None = None
) -> fr.Frame:
    """The leaves of a quadtree as a frame; of a domain those outside are pale, those that are cut hatched.

    Parameters
    ----------
    tree : Tree
        In the plane.
    caption : str
    hanging : bool
        Whether hanging vertices are marked.
    points : array_like, shape (k, 2), optional
        Points to be shown, too.

    Returns
    -------
    dict
        Its number says how many leaves there are, and the depth.
    """
    low, high = tree.corners
    boxes = np.stack([low, np.column_stack([high[:, 0], low[:, 1]]), high, _upper_left(low, high)], axis=1)
    roles = {1: "cell", 0: "waiting", -1: "muted"}
    items = [fr.polygons(roles[state], boxes[tree.states == state]) for state in (-1, 1, 0)]
    if hanging:
        items.append(fr.dots("vertex", _hanging(tree)))
    if points is not None:
        items.append(fr.dots("vertex", points))
    number = f"{many(len(tree), 'leaf', 'leaves')}, depth {tree.depth}"
    return fr.frame(caption, *items, number=number)


def _upper_left(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack([low[:, 0], high[:, 1]])


def tree_state(x: float = 0.32, y: float = 0.68, tree: str = "depth 5, balanced across corners") -> fr.Frame:
    """A quadtree that is divided around a small disc, the feature, which the reader drags.

    Parameters
    ----------
    x, y : float
        The center of the disc in the unit square; its radius is `TREE_FEATURE`.
    tree : str
        The depth, and the kind of balance: a name in `TREE_KINDS`.

    Returns
    -------
    dict
        The leaves, with dashes where only balance divides, and the hanging vertices. The number says how many
        times as many cells are divided with balance, and the bound of the theorem on its cost.

    Raises
    ------
    InputError
        For an unknown kind.
    """
    if tree not in TREE_KINDS:
        raise InputError(f"tree = {tree!r} must be one of {', '.join(map(repr, TREE_KINDS))}")
    depth, across = TREE_KINDS[tree]

    def meets(centers: NDArray[np.float64], sides: NDArray[np.float64]) -> NDArray[np.bool_]:
        beyond = np.maximum(np.abs(centers - [x, y]) - sides[:, None] / 2, 0.0)
        return ((beyond * beyond).sum(axis=1) <= TREE_FEATURE**2) & (sides > 0.5**depth)

    raw = quadtree([(0, 0), (1, 1)], divide=meets, balance=None)
    final = raw if across is None else raw.balanced(across)
    before, after = ((len(one) - 1) // 3 for one in (raw, final))
    hangs = _hanging(final)
    items = [
        fr.segments("cell", list(_crosses(final.linear.split))),
        fr.segments("layer", list(_crosses(_further(final, raw)))),
        fr.polygons("edge", [[(0, 0), (1, 0), (1, 1), (0, 1)]]),
        fr.dots("vertex", hangs),
        fr.circles("inserted", [(x, y)], [TREE_FEATURE]),
        fr.dots("inserted", [(x, y)], handles=["feature"]),
    ]
    caption = f"{len(final)} leaves, {many(len(hangs), 'hanging vertex', 'hanging vertices')}"
    number = f"{many(before, 'cell is', 'cells are')} divided"
    if across is not None:
        number += f", with balance {after}: {after / before:.2f} times as many (at most 9)"
    return fr.frame(caption, *items, number=number, view=UNIT_WINDOW)


def _further(tree: Tree, other: Tree) -> list[NDArray[np.uint64]]:
    """By level, the keys of the cells that one tree divides and another does not."""
    none = np.empty(0, dtype=np.uint64)
    split = [*other.linear.split, *[none] * tree.depth]
    return [np.setdiff1d(ours, theirs) for ours, theirs in zip(tree.linear.split, split, strict=False)]


def _crosses(split: Sequence[NDArray[np.uint64]]) -> Iterator[list[tuple[float, float]]]:
    """The two lines that divide each of these cells of the unit square, given by keys for each level."""
    for level, keys in enumerate(split):
        side = 0.5**level
        for key in keys.tolist():
            i = sum((key >> 2 * b & 1) << b for b in range(level))
            j = sum((key >> (2 * b + 1) & 1) << b for b in range(level))
            x, y, half = i * side, j * side, side / 2
            yield [(x + half, y), (x + half, y + side)]
            yield [(x, y + half), (x + side, y + half)]
