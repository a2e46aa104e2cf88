"""Which leaves of an octree are far enough from the surface of a body, and from all within it, to stay cubes.

See the book, chapter 4c.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...geometry.box_contact import pieces_in_boxes
from ...geometry.boxes import BoxTree, bounding_boxes
from ...predicates.batch import power_of_two
from ..tree.cells import TreeCells
from ..tree.contacts import ALL_INSIDE
from ..tree.vertices import Vertices
from .pattern import WHOLE, kinds_of_leaves, linked
from .planes import Planes

__all__ = ["Kinds", "clear_leaves", "must_be_octree", "with_hexahedra"]

Array = NDArray[np.float64]
AS_FAR = 0.6  # how far centers of leaves are from a triangle at least; unit: the root of twice its area
LEAVES_AT_ONCE = 1 << 16  # to bound the memory


class Kinds(NamedTuple):
    """What becomes of each leaf, and the number of its component: both (n,)."""

    kind: NDArray[np.int8]
    root: NDArray[np.int64]


def must_be_octree(tree: TreeCells, kind: str) -> None:
    """Raise if the tree is not an octree that is balanced across edges."""
    if tree.dimension != 3:
        raise InputError(f"{kind!r} is for octrees; this is a quadtree")
    if tree.balance not in ("edges", "corners") and not tree.is_balanced("edges"):
        raise InputError(f'{kind!r} needs a tree that is balanced across edges: tree.balanced("edges")')


def clear_leaves(
    tree: TreeCells, domain: Any, margin: float, planes: Planes | None = None
) -> NDArray[np.bool_]:
    """The leaves inside whose boxes, larger by a margin on each side, meet nothing of a domain.

    Parameters
    ----------
    tree : TreeCells
        An octree.
    domain : Domain or None
        That of the tree, of which pieces may be divided.
    margin : float
        In sides of the leaf. With 0, leaves may touch the surface and what lies within the body; otherwise
        they are farther from triangles that are larger than they.
    planes : Planes, optional
        Of the pieces: leaves may touch those that are in planes in which they have faces.

    Returns
    -------
    (n,) bool
        Exact but for the rounding of the larger boxes.
    """
    clear = tree.states == ALL_INSIDE
    if domain is None:
        return clear
    shell = domain.triangulated
    used = np.zeros(len(shell.points), dtype=bool)
    used[shell.triangles], used[shell.segments] = True, True
    loose = np.flatnonzero(~used)[:, None]
    factor = power_of_two(np.concatenate([shell.points, tree.box]))
    points = shell.points * factor
    for rows in (shell.triangles, shell.segments, loose):
        if len(rows):
            pieces = rows.astype(np.int64)
            reach = AS_FAR * _roots_of_areas(points[pieces]) if margin > 0.0 else np.zeros(len(pieces))
            own = None
            if planes is not None and rows is shell.triangles:
                own = Planes(planes.axis[shell.piece], planes.at[shell.piece])
            _without_met(tree, margin, (points, pieces, reach), factor, own, clear)
    return clear


def _roots_of_areas(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """The roots of twice the areas of triangles: the sides of squares as large; 0 for other pieces."""
    if x.shape[1] < 3:
        return np.zeros(len(x))
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    return np.sqrt(np.sqrt(normal[:, 0] ** 2 + normal[:, 1] ** 2 + normal[:, 2] ** 2))


def _without_met(
    tree: TreeCells,
    margin: float,
    given: tuple[Array, NDArray[np.int64], Array],
    factor: float,
    planes: Planes | None,
    clear: Any,
) -> None:
    """Take away leaves near pieces: `given` has points, rows, and how far away larger ones must be."""
    points, pieces, reach = given
    first, last = bounding_boxes(points[pieces])
    boxes = BoxTree(first - reach[:, None], last + reach[:, None])
    low, high = (corner * factor for corner in tree.corners)
    rows = np.flatnonzero(clear)
    for i in range(0, len(rows), LEAVES_AT_ONCE):
        part = rows[i : i + LEAVES_AT_ONCE]
        side = high[part] - low[part]
        query, hit = boxes.pairs(low[part] - margin * side, high[part] + margin * side)
        if planes is not None:
            at = part[query]
            kept = ~planes.passed(hit, *(corner[at] for corner in tree.corners))
            query, hit = query[kept], hit[kept]
        off = np.maximum(margin * side[query], reach[hit][:, None] - 0.5 * side[query])
        at = part[query]
        clear[at[pieces_in_boxes(points, pieces, hit, low[at] - off, high[at] + off)]] = False


def with_hexahedra(
    tree: TreeCells, vertices: Vertices, chosen: NDArray[np.bool_], *, bare: NDArray[np.int8] | bool
) -> Kinds:
    """What becomes of the chosen leaves; those that hang together without any hexahedron are left out.

    Parameters
    ----------
    bare : (n,) int8 or bool
        See `kinds_of_leaves`.
    """
    kind = kinds_of_leaves(tree.grid, vertices, chosen, bare=bare)
    root = linked(tree.grid, chosen)
    some = np.zeros(len(root), dtype=bool)
    some[root[kind == WHOLE]] = True
    kept = chosen & some[root]
    return Kinds(np.where(kept, kind, np.int8(0)), np.where(kept, root, -1))
