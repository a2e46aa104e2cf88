"""Rounds in which cells with small or large angles are made better; see `raising` for the kernels.

Only tetrahedra of the background where levels meet are looked at: the theorem speaks of all others. See the
book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ..tree.lookup import Grid
from .background import background_tetrahedra
from .raising import LARGEST_COSINE, Stars, State, raise_stars, room_of, survey_pieces, survey_stars

__all__ = ["Background", "Cut", "poor_cells", "raised_angles", "stars_at"]

Array = NDArray[np.float64]
ROUNDS_OF_RAISING = 6
MORE_VERTICES = 2  # from this round on, those around are visited, too


class Background(NamedTuple):
    """Tetrahedra over an octree.

    Attributes
    ----------
    points : (n, 3) float64
        First the corners of leaves, then their centers.
    place : (n, 3) int64
        Their coordinates in halves of the smallest leaves' sides.
    sign : (n,) int8
        1 inside, 0 on the surface, -1 outside.
    cells : (m, 4) int32
        Those with a vertex inside.
    grid : Grid
    corners : (l, 8) int32
        The octree: its leaves, and their corners.
    """

    points: Array
    place: NDArray[np.int64]
    sign: NDArray[np.int8]
    cells: NDArray[np.int32]
    grid: Grid
    corners: NDArray[np.int32]


class Cut(NamedTuple):
    """Places and signs of vertices, which change here, and the keys and places of all cut points."""

    points: Array
    sign: NDArray[np.int8]
    keys: NDArray[np.int64]
    places: Array


class Raised(NamedTuple):
    """How many vertices have changed, and the tetrahedra of the background that still have poor cells."""

    changed: int
    poor: NDArray[np.int64]


@kernel
def _suspects(cells, sign, mixed, rows):
    """List the tetrahedra with a vertex at which levels meet, and one that is not inside."""
    count = 0
    for row in range(len(cells)):
        there = beside = False
        for k in range(4):
            there |= mixed[cells[row, k]]
            beside |= sign[cells[row, k]] <= 0
        if there and beside:
            rows[count] = row
            count += 1
    return count


def raised_angles(
    background: Background, cut: Cut, least: NDArray[np.int64], mixed: NDArray[np.bool_]
) -> Raised:
    """Move vertices so that dihedral angles are from 10 to 165 degrees, where that can be done.

    Parameters
    ----------
    background : Background
    cut : Cut
    least : (n,) int64
        The squares of the shortest edges at vertices, in the unit of `place`.
    mixed : (n,) bool
        The vertices at which levels meet.
    """
    n = len(cut.sign)
    rows = np.empty(len(background.cells), dtype=np.int64)
    rows = rows[: _suspects(background.cells, cut.sign, mixed, rows)].copy()
    if not len(rows):
        return Raised(0, rows)
    cell = float(background.grid.side[0]) * 0.5 ** (background.grid.depth + 1)
    factor = 0.5 ** np.frexp(cell)[1]  # so that products are doubles
    xyz = np.concatenate([cut.points, cut.places]) * factor
    length = np.sqrt(least.astype(np.float64)) * (cell * factor)
    state = State(xyz, xyz[:n], xyz[:n], background.place, cut.sign, background.sign, cut.keys, length)
    poor = _poor(background, state, rows)
    if not len(poor):
        return Raised(0, poor)
    state = state._replace(image=xyz[:n].copy(), lattice=background.points * factor)
    signs, seen = cut.sign.copy(), np.zeros(n, dtype=np.bool_)
    for number in range(ROUNDS_OF_RAISING):
        vertices = background.cells[poor].ravel().astype(np.int64)
        if number >= MORE_VERTICES:
            around = background.cells[_rows_at(background, vertices)]
            vertices = np.concatenate([vertices, around.ravel()])
        vertices = vertices[np.sort(np.unique(vertices, return_index=True)[1])]
        stars = stars_at(background, vertices)
        changes = raise_stars(state, stars, vertices, number > 0, room_of(stars))
        seen[vertices] = True
        poor = _poor(background, state, _rows_at(background, vertices))  # the others are as they were
        if not len(poor) or (not changes and number >= MORE_VERTICES):
            break
    visited = np.flatnonzero(seen)
    moved = (xyz[visited] != cut.points[visited] * factor).any(axis=1)
    changed = visited[moved | (signs[visited] != cut.sign[visited])]
    cut.points[changed] = xyz[changed] / factor
    return Raised(len(changed), poor)


@kernel
def _beside(cells, flags, rows):
    """List the tetrahedra with a vertex that is flagged."""
    count = 0
    for row in range(len(cells)):
        if flags[cells[row, 0]] or flags[cells[row, 1]] or flags[cells[row, 2]] or flags[cells[row, 3]]:
            rows[count] = row
            count += 1
    return count


def _rows_at(background: Background, vertices: NDArray[np.int64]) -> NDArray[np.int64]:
    """The tetrahedra of the background with one of these vertices."""
    flags = np.zeros(len(background.sign), dtype=np.bool_)
    flags[vertices] = True
    rows = np.empty(len(background.cells), dtype=np.int64)
    return rows[: _beside(background.cells, flags, rows)].copy()


def _poor(background: Background, state: State, rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """The tetrahedra of the background, among some, that have a poor cell, the worst first."""
    stars, bad = Stars(background.cells, np.zeros(1, dtype=np.int64), rows), np.empty(len(rows))
    survey_stars(state, stars, room_of(stars), bad)
    poor = np.flatnonzero(bad >= LARGEST_COSINE)
    return rows[poor[np.argsort(-bad[poor], kind="stable")]]


def stars_at(background: Background, vertices: NDArray[np.int64]) -> Stars:
    """All tetrahedra at these vertices, also those outside of the body."""
    flags = np.full(len(background.sign), -1, dtype=np.int8)
    flags[vertices] = 1
    cells = background_tetrahedra(background.grid, background.corners, flags, few=True)
    order = np.argsort(cells.ravel(), kind="stable")
    start = np.zeros(len(flags) + 1, dtype=np.int64)
    start[1:] = np.cumsum(np.bincount(cells.ravel(), minlength=len(flags)))
    return Stars(cells, start, order // 4)


def poor_cells(
    points: Array, cells: NDArray[np.int32], owner: NDArray[np.int64], poor: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The cells with a dihedral angle below 10 or above 165 degrees in these tetrahedra of the background."""
    rows = np.flatnonzero(np.isin(owner, poor)) if len(poor) else poor
    bad = np.empty(len(rows))
    survey_pieces(points, cells[rows], bad)
    return rows[bad >= LARGEST_COSINE]
