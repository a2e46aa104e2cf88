"""Which leaves of a tree pieces of a domain meet or touch. See the book, chapter 4a."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.box_contact import pieces_in_boxes
from ...geometry.boxes import BoxTree, bounding_boxes
from ...predicates.batch import power_of_two
from ..tree.cells import TreeCells

__all__ = ["TOUCHES_WITHIN", "meetings"]

TOUCHES_WITHIN = 2.0**-20  # sides of a leaf from it to a piece, up to which the piece touches it
MET_AT_ONCE = 1 << 16  # leaves, to bound the memory


def meetings(
    tree: TreeCells,
    chosen: NDArray[np.bool_],
    points: NDArray[np.float64],
    pieces: NDArray[Any],
    *,
    touching: bool = False,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of chosen leaves and pieces that meet their insides, or also touch them.

    Parameters
    ----------
    tree : TreeCells
    chosen : (n,) bool
    points : (v, d) float64
    pieces : (m, k) int
        Points, segments or triangles.
    touching : bool
        Whether pieces count that are no farther than 2^-20 of its side from a leaf.

    Returns
    -------
    leaf, piece : (q,) int64
        Sorted by leaf. Exact, but for the distance of what touches.
    """
    found = [(np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64))]
    if len(pieces):
        rows = np.ascontiguousarray(pieces, dtype=np.int64)
        factor = power_of_two(np.concatenate([points, tree.box]))
        x = points * factor
        boxes = BoxTree(*bounding_boxes(x[rows]))
        low, high = (corner * factor for corner in tree.corners)
        leaves = np.flatnonzero(chosen)
        for i in range(0, len(leaves), MET_AT_ONCE):
            part = leaves[i : i + MET_AT_ONCE]
            off = (high[part] - low[part]) * (TOUCHES_WITHIN if touching else 0.0)
            query, hit = boxes.pairs(low[part] - off, high[part] + off)
            at = part[query]
            meets = pieces_in_boxes(x, rows, hit, low[at] - off[query], high[at] + off[query])
            found.append((at[meets], hit[meets]))
    leaf, piece = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.lexsort((piece, leaf))
    return leaf[order], piece[order]
