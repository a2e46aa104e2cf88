"""The lengths of edges along walls: as the size asks for, and shorter in gaps and beside short pieces.

The edges of the envelope are not split later, so where two walls are near each other the edges along them
must be short enough for the gap, and the lengths of edges that follow each other must not differ too much.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain
from ...domain.plane.by_region import size_by_region
from ...domain.plane.prescribed import mirrored
from ...domain.plane.sample import halve, safe
from ...geometry.boxes import BoxTree
from ...sizing.field import SizeField, as_size
from ..boundary.constrained import complex_of
from .walls import Walls, walls_of

__all__ = ["nearest_places", "spaced_walls", "to_segment"]

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
    others = np.flatnonzero(~np.isin(np.arange(c.segments), walls.segment))
    edges = np.concatenate([walls.ends, c.ends[others].astype(np.int64)])
    owner = np.concatenate([piece[walls.segment], piece[others]])
    m = len(walls.ends)
    a, b = x[edges[:, 0]], x[edges[:, 1]]
    length = np.hypot(*(b - a).T)
    grown = (length[:m] / (OF_A_GAP * HALVED_BEYOND))[:, None]
    low, high = np.minimum(a, b), np.maximum(a, b)
    i, j = BoxTree(low, high).pairs(low[:m] - grown, high[:m] + grown)
    apart = (edges[i][:, :, None] != edges[j][:, None, :]).all(axis=(1, 2))
    # Pieces that share a corner are as near as its angle makes them.
    ends = domain.pieces[owner]
    apart &= (ends[i][:, :, None] != ends[j][:, None, :]).all(axis=(1, 2))
    i, j = i[apart], j[apart]
    left = np.column_stack([a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]])
    t, s, distance = nearest_places(a[i], b[i], a[j], b[j])
    away = a[j] + s[:, None] * (b - a)[j] - (a[i] + t[:, None] * (b - a)[i])
    facing = (away * left[i]).sum(axis=1) > 0.0
    facing &= (j >= m) | ((away * left[j]).sum(axis=1) < 0.0)
    long = np.zeros(m, dtype=bool)
    long[i[facing & (length[i] > HALVED_BEYOND * OF_A_GAP * distance)]] = True
    for side in (walls.after, walls.before):
        rows = np.flatnonzero(side >= 0)
        long[side[rows[length[side[rows]] > UNEVEN * length[rows]]]] = True
    return long, length[:m]


def to_segment(p: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """Where on the segment ab the nearest point to p is, from 0 to 1, and its distance."""
    side = b - a
    t = np.clip(((p - a) * side).sum(axis=1) / np.maximum((side**2).sum(axis=1), 1e-300), 0.0, 1.0)
    return t, np.hypot(*(p - a - t[:, None] * side).T)


def nearest_places(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, Array, Array]:
    """The nearest places on segments ab and cd that do not cross, from 0 to 1, and their distances."""
    zero, one = np.zeros(len(a)), np.ones(len(a))
    t_c, from_c = to_segment(c, a, b)
    t_d, from_d = to_segment(d, a, b)
    s_a, from_a = to_segment(a, c, d)
    s_b, from_b = to_segment(b, c, d)
    every = np.stack([from_c, from_d, from_a, from_b])
    which = np.argmin(every, axis=0)
    row = np.arange(len(a))
    t = np.stack([t_c, t_d, zero, one])[which, row]
    s = np.stack([zero, one, s_a, s_b])[which, row]
    return t, s, every[which, row]
