"""What moves of vertices cannot raise: the tree is divided there, so that levels meet elsewhere.

Where all leaves around a tetrahedron have one size, the theorem bounds its angles, up to how far vertices may
move if levels meet nearby. So the larger leaves around poor cells are divided, the tree is balanced again,
and everything begins anew. No leaf becomes smaller than one beside it was. See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ..tree.balancing import balanced
from ..tree.keys import keys_of
from ..tree.linear import Linear, linear_of, merged
from ..tree.lookup import Grid
from .filling import Filling, background_of, filled_background
from .laying import Laid
from .raising import survey_pieces
from .rounds_of_raising import Background

__all__ = ["NOTHING_INSIDE", "filled_leaves"]

MOST_DIVISIONS = 4
NOTHING_INSIDE = "no vertex of the lattice is inside: the body is thinner than a cell; take a smaller size"


def filled_leaves(laid: Laid, budget: int) -> tuple[Laid, Background, Filling]:
    """The tetrahedra inside, over a tree with further divisions where that makes the worst of them better.

    Parameters
    ----------
    laid : Laid
    budget : int
        The largest number of leaves.
    """
    found = _filled(laid)
    best, worst = found, _worst(found[2])
    for _ in range(MOST_DIVISIONS):
        if not len(found[2].poor):
            break
        tree = _divided(found)
        if tree.divided == found[0].tree.divided or 1 + 7 * tree.divided > budget:
            break
        found = _filled(laid.over(tree))
        now = _worst(found[2])
        if now < worst:
            best, worst = found, now
    return best


def _filled(laid: Laid) -> tuple[Laid, Background, Filling]:
    background = background_of(laid.grid, laid.vertices, laid.sign)
    if not len(background.cells):
        raise InputError(NOTHING_INSIDE)
    return laid, background, filled_background(background, laid.shares)


def _worst(filling: Filling) -> float:
    """The badness of the worst cell; see `raising`."""
    bad = np.empty(len(filling.poor))
    survey_pieces(filling.points, filling.cells[filling.poor], bad)
    return float(bad.max(initial=-1.0))


def _divided(found: tuple[Laid, Background, Filling]) -> Linear:
    """The balanced tree in which all leaves around each poor tetrahedron are divided but the smallest."""
    laid, background, filling = found
    grid = laid.grid
    corners = background.cells[np.unique(filling.owner[filling.poor])]
    leaf = _leaves_around(grid, background.place[corners].reshape(-1, 3)).reshape(len(corners), -1)
    level = grid.levels[leaf]
    larger = np.unique(leaf[level < level.max(axis=1, keepdims=True)])
    split = list(laid.tree.split)
    for at in np.unique(grid.levels[larger]):
        rows = larger[grid.levels[larger] == at]
        split[at] = merged(split[at], grid.first[rows] >> np.uint64(3 * (grid.depth - int(at))))
    return balanced(linear_of(split, 3), "edges")


def _leaves_around(grid: Grid, place: NDArray[np.int64]) -> NDArray[np.int64]:
    """The leaves that contain the eight smallest cells at places: (8 n,)."""
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    cells = np.clip((place[:, None] - bits) >> 1, 0, (1 << grid.depth) - 1)
    return np.searchsorted(grid.first, keys_of(cells.reshape(-1, 3)), side="right") - 1
