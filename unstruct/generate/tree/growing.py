"""A tree grows level by level: rules look at all nodes of a level, and those for which one asks are divided.

See the book, chapter 4a.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import as_numbers
from ...base.errors import InputError
from ...base.progress import progress_bar
from .contacts import ALL_OUTSIDE, Boundary, at_root, handed_down
from .criteria import Level, Rule
from .keys import DEEPEST_LEVEL, Keys
from .linear import Linear, children_of, linear_of

__all__ = ["MOST_LEAVES", "Growth", "Limits", "as_box", "deepest_level", "grow", "level_of"]

Array = NDArray[np.float64]
MOST_LEAVES = 50_000_000  # leaves of a tree, unless a budget is given
FINEST_SPACINGS = 64.0  # a cell has at least so many spacings of doubles along each axis


class Limits(NamedTuple):
    """`least`: nodes above this level are always divided; `most`: the deepest level; `cells`: a budget."""

    least: int
    most: int
    cells: int


class Growth(NamedTuple):
    """What was grown.

    Attributes
    ----------
    tree : Linear
    refused : list of (n,) uint64
        By level: the keys of leaves that a rule would have divided.
    reason : str
        Why; empty if none was refused.
    """

    tree: Linear
    refused: dict[int, Keys]
    reason: str


def deepest_level(low: Array, side: Array) -> int:
    """The deepest level on which cells are large enough for doubles, and keys have room."""
    d = len(low)
    spacing = np.spacing(np.maximum(np.abs(low), np.abs(low + side)))
    return int(max(0, min(DEEPEST_LEVEL[d], np.floor(np.log2((side / (FINEST_SPACINGS * spacing)).min())))))


def level_of(
    low: Array, side: Array, keys: Keys, level: int, boundary: Boundary | None, above: Level | None
) -> Level:
    """The nodes `keys` of a level. With a boundary, `above` has the level before it, whose divided nodes are
    their parents."""
    nodes = Level(level, keys, (low, side))
    if boundary is not None and above is None:
        nodes.contacts = at_root(boundary, *nodes.boxes)
    elif boundary is not None and above is not None and above.contacts is not None:
        divided = np.searchsorted(above.keys, keys[:: 1 << len(low)] >> np.uint64(len(low)))
        nodes.contacts = handed_down(boundary, above.contacts, divided, *nodes.boxes)
    return nodes


def grow(
    box: Array,
    rules: Sequence[Rule],
    limits: Limits,
    *,
    boundary: Boundary | None = None,
    progress: bool = False,
) -> Growth:
    """A tree over the box (2, d) whose nodes are divided where any rule asks for it.

    Nodes outside of the boundary are not divided, except above the level ``limits.least``. A level that would
    make more leaves than ``limits.cells`` is not begun: what is refused is told.
    """
    low, side = box[0], box[1] - box[0]
    d = len(low)
    split: list[Keys] = []
    nodes = level_of(low, side, np.zeros(1, dtype=np.uint64), 0, boundary, None)
    leaves, refused, reason = 1, {}, ""
    with progress_bar(progress, " cells") as bar:
        while True:
            wanted = np.zeros(len(nodes.keys), dtype=bool)
            for rule in rules:
                wanted |= rule(nodes)
            if nodes.contacts is not None:
                wanted &= nodes.contacts.state != ALL_OUTSIDE
            divided = wanted | (nodes.level < limits.least)
            more = int(divided.sum()) * ((1 << d) - 1)
            if nodes.level >= limits.most or leaves + more > limits.cells:
                if wanted.any():
                    refused[nodes.level] = nodes.keys[wanted]
                    deep = nodes.level >= limits.most
                    reason = (
                        f"level {limits.most}, the deepest" if deep else f"budget of {limits.cells:,} cells"
                    )
                break
            if not more:
                break
            leaves += more
            bar.update(more)
            split.append(nodes.keys[divided])
            children = children_of(split[-1], d)
            nodes = level_of(low, side, children, nodes.level + 1, boundary, nodes)
    return Growth(linear_of(split, d), refused, reason)


def as_box(box: object, dimension: int) -> Array:
    """Two opposite corners (2, d) as floats: the lower and the upper one.

    Raises
    ------
    InputError
        For anything else, and for a box that is empty.
    """
    try:
        corners_given = as_numbers(box, "the box")
    except InputError as error:
        what = f"a Domain or a box of two corners is needed, not {type(box).__name__}"
        raise InputError(f"{what}: {error}") from None
    if np.asarray(box).dtype == np.bool_:
        raise InputError("a box of two corners is needed, not bools")
    if corners_given.shape != (2, dimension):
        raise InputError(f"the box must be two corners, shape (2, {dimension}), not {corners_given.shape}")
    if not np.isfinite(corners_given).all():
        raise InputError(f"the corners of the box must be finite, not {corners_given.tolist()}")
    result = np.stack([corners_given.min(axis=0), corners_given.max(axis=0)])
    with np.errstate(over="ignore"):
        finite_sides = np.isfinite(result[1] - result[0]).all()
    if not (result[1] > result[0]).all() or not finite_sides:
        raise InputError(f"the box must have positive, finite sides; it goes from {result[0]} to {result[1]}")
    return result
