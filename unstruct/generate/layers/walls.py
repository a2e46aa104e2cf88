"""The sides of walls on which layers are made, and what follows each side around the vertex at its end.

A *side* is a subsegment seen from one side, directed so that what is to be meshed lies on its left. An inner
piece has two. The constrained Delaunay triangulation of the sampled boundary knows their order: it is found
by turning around a vertex from triangle to triangle, without any computed angle.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import kernel
from ...connect.insertion.halfedges import next_edge, prev_edge
from ...connect.planar.complex import PlanarComplex
from ...domain.domain import Domain
from ...domain.plane.matching import pieces_of

__all__ = ["Walls", "wall_pieces", "walls_of"]

Integers = NDArray[np.int64]


class Walls(NamedTuple):
    """The sides of walls; m of them.

    Attributes
    ----------
    points : (n, 2) float64
        The vertices of the sampled boundary.
    ends : (m, 2) int64
        From one vertex to the next, with what is meshed on the left.
    segment, region : (m,) int64
        The subsegment that a side belongs to, and the number of the region on it.
    after, before : (m,) int64
        The side that follows at its end, that is first in the clockwise turn from the side itself, and the
        one that it follows; -1 if another piece comes first, where the wall is open.
    bound_after, bound_before : (m,) int64
        At open ends the subsegment that comes first; else -1.
    wake : (m,) bool
        Whether the side is that of a wake.
    """

    points: NDArray[np.float64]
    ends: Integers
    segment: Integers
    region: Integers
    after: Integers
    before: Integers
    bound_after: Integers
    bound_before: Integers
    wake: NDArray[np.bool_]


def wall_pieces(domain: Domain, which: Any, name: str) -> Integers:
    """Piece numbers by the name of a marker, a piece, or a list of both; all facets for None."""
    if which is None:
        return np.arange(len(domain.facets))
    if isinstance(which, str | int | np.integer):
        which = [which]
    try:
        parts = [which] if isinstance(which, np.ndarray) else list(which)
    except TypeError:
        raise InputError(f"{name} must be names of markers or piece numbers, not {which!r:.60}") from None
    found = [pieces_of(domain, part, name) for part in parts]
    return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *found])).astype(np.int64)


@kernel
def _turn(mark, twin, half, after, before):
    """The first half-edges on subsegments when one turns inside around the end, and the start, of each."""
    for i in range(len(half)):
        e = next_edge(half[i])
        while mark[e] < 0:
            e = next_edge(np.int64(twin[e]))
        after[i] = e
        e = prev_edge(half[i])
        while mark[e] < 0:
            e = prev_edge(np.int64(twin[e]))
        before[i] = e


def walls_of(c: PlanarComplex, points: NDArray[np.float64], wall: Any, wake: Any) -> Walls:
    """The sides of some pieces.

    Parameters
    ----------
    c : PlanarComplex
        The triangulated domain, its regions marked, before any point is inserted.
    points : (n, 2) float64
        Its vertices in the units of the domain.
    wall, wake : (p,) bool
        Which pieces are walls, wakes included, and which are wakes.
    """
    pieces = c.piece[: c.segments]
    first = c.where[: c.segments].astype(np.int64)
    half = np.concatenate([first, c.twin[first].astype(np.int64)])
    keep = np.tile(wall[pieces], 2) & (c.region[half // 3] >= 0)
    half = half[keep]
    third = half - half % 3
    ends = c.vertex[np.column_stack([third + (half + 1) % 3, third + (half + 2) % 3])].astype(np.int64)
    segment = c.mark[half].astype(np.int64)
    number = np.full(len(c.mark), -1, dtype=np.int64)
    number[half] = np.arange(len(half))
    after, before = np.empty((2, len(half)), dtype=np.int64)
    _turn(c.mark, c.twin, half, after, before)
    next_side, last_side = number[after], number[before]
    return Walls(
        points,
        ends,
        segment,
        c.region[half // 3].astype(np.int64),
        next_side,
        last_side,
        np.where(next_side < 0, c.mark[after], -1).astype(np.int64),
        np.where(last_side < 0, c.mark[before], -1).astype(np.int64),
        wake[pieces[segment]],
    )
