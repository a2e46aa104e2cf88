"""The parts of a body in which leaves of an octree lie that no piece enters. See the book, chapter 4c."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...domain.space.parts import parts_in_space
from ..tree.cells import TreeCells
from .meeting import meetings
from .numbering import named_parts
from .pattern import linked

__all__ = ["regions_of_leaves"]


def regions_of_leaves(tree: TreeCells, chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
    """For each leaf the number of the part of the body that it lies in; -1 if it is not chosen.

    Parameters
    ----------
    tree : TreeCells
        An octree over a domain.
    chosen : (n,) bool
        Leaves inside of the body whose insides no facet and no inner facet meets.

    Notes
    -----
    Leaves that share a face are in one part, unless a piece lies in the face: then both touch it. For one
    leaf of all that hang together, the part is found exactly. O(n log n), and O(n) for each part.
    """
    shell = tree.domain.triangulated
    parts = parts_in_space(shell.points, shell.triangles)
    free = chosen.copy()
    free[meetings(tree, chosen, shell.points, shell.triangles, touching=True)[0]] = False
    root = linked(tree.grid, chosen, free)
    heads = np.flatnonzero(chosen & (root == np.arange(len(root))))
    part = np.full(len(root), -1, dtype=np.int64)
    part[heads] = parts.locate(np.asarray(tree.centers)[heads])
    seeds = np.concatenate([np.empty((0, 3)), *tree.domain.regions.values()])
    of_seed = parts.locate(seeds)
    used = np.unique(part[heads])
    if len(used) == 0:
        return part
    place = np.searchsorted(used, of_seed).clip(max=len(used) - 1)
    numbers = named_parts(tree.domain, np.arange(len(used)), place, used[place] == of_seed)
    return np.where(chosen, numbers[np.searchsorted(used, part[root]).clip(max=len(used) - 1)], -1)
