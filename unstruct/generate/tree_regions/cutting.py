"""The boundary of a domain and its inner pieces, cut by the leaves of a quadtree.

See the book, chapter 4b.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...domain.domain import Domain
from ...domain.plane.sample import (
    HALVINGS,
    TURN,
    Sampled,
    assemble,
    fine_chains,
    halve,
    safe,
    turning,
)
from ...sizing.field import SizeField
from ..tree.cells import TreeCells
from ..tree.lookup import located
from .near import leaves_along

__all__ = ["cut_by_leaves", "leaf_size", "safe_and_round"]

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
    certain points. However large leaves are, curves are no coarser than by ``domain.sampled()``.
    """
    sampled = given = domain.sampled(leaf_size(cells))
    held = domain.held()
    for _ in range(HALVINGS):
        ends = sampled.points[sampled.ends].reshape(-1, 4)
        long = (leaves_along(cells.grid, ends) > MOST_OVER) & ~held[sampled.piece]
        if not long.any():
            break
        sampled = assemble(domain, *halve(sampled, long))
    sampled = _rounded(domain, sampled)
    return sampled if sampled is given else _safe(domain, sampled)


def safe_and_round(domain: Domain, sampled: Sampled) -> Sampled:
    """Subsegments that are safe, with curves that turn by at most 60 degrees over each, as by themselves.

    Pieces that must have certain points get others only where they are not safe.
    """
    return _safe(domain, _rounded(domain, sampled))


def _safe(domain: Domain, sampled: Sampled) -> Sampled:
    first, last = sampled.span.T.copy()
    return safe(domain, sampled.piece, first, last, np.inf)


def _rounded(domain: Domain, sampled: Sampled) -> Sampled:
    free = flagged(len(domain.pieces), list(domain.curves)) & ~domain.held()
    for _ in range(HALVINGS):
        rows = np.flatnonzero(free[sampled.piece])
        rows = rows[turning(fine_chains(domain, sampled, rows)) > TURN * (1 + 1e-9)]
        if not len(rows):
            break
        sampled = assemble(domain, *halve(sampled, flagged(len(sampled.ends), rows)))
    return sampled
