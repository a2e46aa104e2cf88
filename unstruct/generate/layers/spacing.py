"""The lengths of edges along walls: as the size asks for, and shorter in gaps and beside short pieces.

The edges of the envelope are not split later, so where two walls are near each other the edges along them
must be short enough for the gap, and the lengths of edges that follow each other must not differ too much.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain
from ...domain.plane.by_region import size_by_region
from ...domain.plane.prescribed import mirrored
from ...domain.plane.sample import halve, safe
from ...sizing.field import SizeField, as_size
from ..boundary.constrained import complex_of
from .facing import beside, mark_long
from .walls import Walls, walls_of

__all__ = ["spaced_walls"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

OF_A_GAP = 0.4  # edges along walls are at most so long, in units of the gap before them
HALVED_BEYOND = 1.4  # edges are halved if they exceed this length by this factor
UNEVEN = 2.2  # so many times longer than its neighbor an edge may be
FINEST_SHARE = 1.0 / 128.0  # of the length that the size asks for: in narrower gaps there are no layers
SPACING_ROUNDS = 16


def spaced_walls(
    domain: Domain, size: Any, wall: NDArray[np.bool_], wake: NDArray[np.bool_]
) -> tuple[PlanarComplex, Walls, SizeField]:
    """The triangulation of the sampled boundary, the sides of walls, and the size as one field.

    Subsegments of walls that are too long are halved, but for those of pieces with given points.

    Parameters
    ----------
    domain : Domain
    size : size, or dict of regions' names to sizes
    wall, wake : (p,) bool
        Pieces that are walls (wakes included), and wakes.
    """
    sampled = domain.sampled(size)
    free = ~domain.held()
    floor = -1.0
    for rounds in range(SPACING_ROUNDS + 1):
        c = complex_of(domain, sampled)
        walls = walls_of(c, sampled.points, wall, wake)
        if rounds == 0:
            field = as_size(size_by_region(c, size, domain.regions))
        if rounds == SPACING_ROUNDS or not len(walls.ends):
            break
        long, length = _too_long(domain, walls, c)
        if floor < 0.0:
            floor = FINEST_SHARE * float(length.min())
        long &= (length > floor) & free[c.piece[walls.segment]]
        if not long.any():
            break
        rows = np.zeros(c.segments, dtype=bool)
        rows[walls.segment[long]] = True
        order = np.lexsort((c.span[: c.segments, 0], c.piece[: c.segments]))
        sampled = mirrored(domain, safe(domain, *halve(sampled, rows[order]), np.inf))
    return c, walls, field


def _too_long(domain: Domain, walls: Walls, c: PlanarComplex) -> tuple[NDArray[np.bool_], Array]:
    """Which sides are too long for the gap before them or for their neighbors, and how long they are."""
    x = walls.points
    piece = c.piece[: c.segments].astype(np.int64)
    m = len(walls.ends)
    others = np.flatnonzero(~flagged(c.segments, walls.segment))
    edges = np.concatenate([walls.ends, c.ends[others]])
    corners = domain.pieces[piece[np.concatenate([walls.segment, others])]]
    pairs, length = beside(x, edges, m, 1.0 / (OF_A_GAP * HALVED_BEYOND))
    long = np.zeros(m, dtype=bool)
    mark_long(x, edges, corners, pairs, length, HALVED_BEYOND * OF_A_GAP, long)
    for side in (walls.after, walls.before):
        rows = np.flatnonzero(side >= 0)
        long[side[rows[length[side[rows]] > UNEVEN * length[rows]]]] = True
    return long, length[:m]
