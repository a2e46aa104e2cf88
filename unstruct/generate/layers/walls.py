"""The sides of walls on which layers are made, and what follows each side around the vertex at its end.

A *side* is a subsegment seen from one side, directed so that what is to be meshed lies on its left. An inner
piece has two. The constrained Delaunay triangulation of the sampled boundary knows their order: it is found
by turning around a vertex from triangle to triangle, without any computed angle.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct
from ...base.errors import InputError
from ...base.jit import lean
from ...connect.insertion.halfedges import end_of, next_edge, prev_edge, start_of
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
    return distinct(np.concatenate([np.empty(0, dtype=np.int64), *found])).astype(np.int64)


@lean
def _sides(where, twin, region, pieces, wall, half, number):
    """Write the half-edges on walls inside, and their numbers; returns how many there are."""
    many, count = len(pieces), 0
    for i in range(2 * many):
        e = np.int64(where[i % many])
        if i >= many:
            e = np.int64(twin[e])
        if wall[pieces[i % many]] and region[e // 3] >= 0:
            half[count], number[e] = e, count
            count += 1
    return count


@lean
def _turn(mesh, half, number, ends, columns):
    """Write ``ends`` and six other columns of `Walls`, in its order.

    The side, or subsegment, that follows is the first one when one turns inside around the end of a side.
    """
    vertex, twin, mark, region = mesh
    for i in range(len(half)):
        e = half[i]
        ends[i, 0], ends[i, 1] = start_of(vertex, e), end_of(vertex, e)
        columns[0, i], columns[1, i] = mark[e], region[e // 3]
        after, before = next_edge(e), prev_edge(e)
        while mark[after] < 0:
            after = next_edge(np.int64(twin[after]))
        while mark[before] < 0:
            before = prev_edge(np.int64(twin[before]))
        columns[2, i], columns[3, i] = number[after], number[before]
        columns[4, i] = mark[after] if number[after] < 0 else -1
        columns[5, i] = mark[before] if number[before] < 0 else -1


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
    half, number = np.empty(2 * c.segments, dtype=np.int64), np.full(len(c.mark), -1, dtype=np.int64)
    half = half[: _sides(c.where, c.twin, c.region, pieces, wall, half, number)]
    columns, ends = np.empty((6, len(half)), dtype=np.int64), np.empty((len(half), 2), dtype=np.int64)
    _turn((c.vertex, c.twin, c.mark, c.region), half, number, ends, columns)
    segment, region, after, before, bound_after, bound_before = columns
    return Walls(
        points, ends, segment, region, after, before, bound_after, bound_before, wake[pieces[segment]]
    )
