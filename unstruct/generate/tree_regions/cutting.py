"""The boundary of a domain and its inner pieces, cut by the leaves of a quadtree.

See the book, chapter 4b.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...domain.domain import Domain
from ...domain.plane.sample import HALVINGS, Sampled, assemble, halve, safe
from ...sizing.field import SizeField
from ..tree.cells import TreeCells
from ..tree.lookup import located
from .near import leaves_along

__all__ = ["cut_by_leaves", "leaf_size"]

MOST_OVER = 1.6  # a subsegment over more leaves than this is halved


def leaf_size(cells: TreeCells) -> SizeField:
    """The longest edge of the leaf at a point, as a size; beyond the box, at the nearest point of it."""

    def size(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return cells.sides[located(cells.grid, np.clip(x, *cells.box))]

    return SizeField(size, name="leaves of a tree")


def cut_by_leaves(cells: TreeCells, domain: Domain) -> Sampled:
    """The pieces of a domain cut into subsegments about as long as the leaves that they are in.

    `Domain.sampled` looks at some places of each piece only. Small leaves may lie between them: subsegments
    over more than `MOST_OVER` leaves are halved until there are none, except on pieces that must have
    certain points.
    """
    sampled = domain.sampled(leaf_size(cells))
    held = domain.held()
    changed = False
    for _ in range(HALVINGS):
        ends = sampled.points[sampled.ends].reshape(-1, 4)
        long = (leaves_along(cells.grid, ends) > MOST_OVER) & ~held[sampled.piece]
        if not long.any():
            break
        changed, sampled = True, assemble(domain, *halve(sampled, long))
    if not changed:
        return sampled
    first, last = sampled.span.T.copy()
    return safe(domain, sampled.piece, first, last, np.inf)
