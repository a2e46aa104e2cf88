"""Which leaves of an octree are far enough from the surface of a body, and from all within it, to stay cubes.

See the book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...geometry.box_contact import pieces_in_boxes
from ...geometry.boxes import BoxTree, bounding_boxes
from ...predicates.batch import power_of_two
from ..tree.cells import TreeCells
from ..tree.contacts import INSIDE
from ..tree.vertices import Vertices
from .pattern import WHOLE, kinds_of_leaves, linked

__all__ = ["Kinds", "clear_leaves", "must_be_octree", "with_hexahedra"]

LEAVES_AT_ONCE = 1 << 16  # to bound the memory


class Kinds(NamedTuple):
    """What becomes of each leaf, and the number of its component: both (n,)."""

    kind: NDArray[np.int8]
    root: NDArray[np.int64]


def must_be_octree(tree: TreeCells, kind: str) -> None:
    """Raise if the tree is not an octree that is balanced across edges."""
    if tree.dimension != 3:
        raise InputError(f"{kind!r} is for octrees; this is a quadtree")
    if not tree.is_balanced("edges"):
        raise InputError(f'{kind!r} needs a tree that is balanced across edges: tree.balanced("edges")')


def clear_leaves(tree: TreeCells, margin: float) -> NDArray[np.bool_]:
    """The leaves inside whose boxes, larger by a margin on each side, meet nothing of the domain.

    Parameters
    ----------
    tree : TreeCells
        An octree.
    margin : float
        In sides of the leaf. With 0, leaves may touch the surface and what lies within the body.

    Returns
    -------
    (n,) bool
        Exact but for the rounding of the larger boxes.
    """
    clear = tree.states == INSIDE
    if tree.domain is None:
        return clear
    shell = tree.domain.triangulated
    used = np.zeros(len(shell.points), dtype=bool)
    used[shell.triangles], used[shell.segments] = True, True
    loose = np.flatnonzero(~used)[:, None]
    factor = power_of_two(np.concatenate([shell.points, tree.box]))
    for pieces in (shell.triangles, shell.segments, loose):
        if len(pieces):
            _without_met(tree, margin, shell.points * factor, pieces.astype(np.int64), factor, clear)
    return clear


def _without_met(
    tree: TreeCells,
    margin: float,
    points: NDArray[np.float64],
    pieces: NDArray[np.int64],
    factor: float,
    clear: NDArray[np.bool_],
) -> None:
    """Take away the leaves that the pieces meet."""
    boxes = BoxTree(*bounding_boxes(points[pieces]))
    low, high = tree.corners
    rows = np.flatnonzero(clear)
    for i in range(0, len(rows), LEAVES_AT_ONCE):
        part = rows[i : i + LEAVES_AT_ONCE]
        off = margin * (high[part] - low[part])
        first, last = (low[part] - off) * factor, (high[part] + off) * factor
        query, hit = boxes.pairs(first, last)
        meets = pieces_in_boxes(points, pieces, hit, first[query], last[query])
        clear[part[query[meets]]] = False


def with_hexahedra(tree: TreeCells, vertices: Vertices, chosen: NDArray[np.bool_], *, bare: bool) -> Kinds:
    """What becomes of the chosen leaves; those that hang together without any hexahedron are left out.

    Parameters
    ----------
    bare : bool
        See `kinds_of_leaves`.
    """
    kind = kinds_of_leaves(tree.grid, vertices, chosen, bare=bare)
    root = linked(tree.grid, chosen)
    some = np.zeros(len(root), dtype=bool)
    some[root[kind == WHOLE]] = True
    kept = chosen & some[root]
    return Kinds(np.where(kept, kind, np.int8(0)), np.where(kept, root, -1))
