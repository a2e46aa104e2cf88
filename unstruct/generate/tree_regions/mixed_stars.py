"""Vertices of quadrilaterals and triangles are moved to where the worst corner around them is better.

Here the worst corner counts, not the sum of all as in `generate.quads.relaxing`: meshes of trees promise the
angles of their quadrilaterals, 39 to 141 degrees, which a better sum may break. See the book, chapter 4b.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...predicates.batch import scaled, unscaled
from ...predicates.kernels import orient2

__all__ = ["cells_at", "smoothed"]

GOOD = 0.75  # vertices all of whose corners are better stay
EQUILATERAL = 2.0 / math.sqrt(3.0)
HALVED_STEPS = 6  # lengths of steps, each half of the one before, from a quarter of the shortest edge on
QUAD_SINE = 0.63  # the least of a corner of a quadrilateral: between 39.05 and 140.95 degrees
LESS_BEYOND = 2.0  # what a smaller sine of a quadrilateral counts less: no triangle is worth it
SINE_GAIN = 1e-3  # by which the worst corner has to improve


def cells_at(cells: NDArray[np.int32], n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The cells of each vertex as rows: those of v are ``indices[indptr[v]:indptr[v + 1]]``; -1 is none."""
    rows = cells.ravel()
    order = np.argsort(rows, kind="stable")[int((rows < 0).sum()) :]
    return np.searchsorted(rows[order], np.arange(n + 1)), order // cells.shape[1]


@inline
def _corner(xy, a, b, c):
    """The sine of the angle at b from c to a."""
    ux, uy, vx, vy = xy[c, 0] - xy[b, 0], xy[c, 1] - xy[b, 1], xy[a, 0] - xy[b, 0], xy[a, 1] - xy[b, 1]
    squares = (ux * ux + uy * uy) * (vx * vx + vy * vy)
    return (ux * vy - uy * vx) / math.sqrt(squares) if squares > 0.0 else -1.0


@inline
def _worst(xy, cells, members, start, stop, less):
    """The least sine of a corner of these cells; that of triangles in units of 60 degrees, that of
    quadrilaterals beyond their limit counts as so much less."""
    worst = 1.0
    for m in range(start, stop):
        t = members[m]
        sides = 4 if cells[t, 3] >= 0 else 3
        unit = 1.0 if sides == 4 else EQUILATERAL
        for k in range(sides):
            a, b, c = cells[t, (k + sides - 1) % sides], cells[t, k], cells[t, (k + 1) % sides]
            sine = _corner(xy, a, b, c)
            if sides == 4 and sine < QUAD_SINE:
                sine -= less
            worst = min(worst, unit * sine)
    return worst


@inline
def _valid(xy, cells, members, start, stop):
    """Whether every corner of these cells turns left: exactly."""
    for m in range(start, stop):
        t = members[m]
        sides = 4 if cells[t, 3] >= 0 else 3
        for k in range(sides):
            a, b, c = cells[t, (k + sides - 1) % sides], cells[t, k], cells[t, (k + 1) % sides]
            if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) <= 0:
                return False
    return True


@kernel
def _smooth(xy, cells, indptr, members, free, rounds):
    """Search in eight directions from each free vertex; returns how many moves were made."""
    moves = 0
    todo = free.copy()  # after the first round those beside a vertex that moved
    for _ in range(rounds):
        before = moves
        for v in range(len(xy)):
            start, stop = indptr[v], indptr[v + 1]
            if not todo[v] or start == stop:
                continue
            todo[v] = False
            less = LESS_BEYOND
            old = _worst(xy, cells, members, start, stop, less)
            if old < 0.0:  # one is beyond already
                less = 0.0
                old = _worst(xy, cells, members, start, stop, less)
            if old >= GOOD:
                continue
            x, y = xy[v, 0], xy[v, 1]
            shortest = np.inf
            for m in range(start, stop):
                for k in range(4):
                    w = cells[members[m], k]
                    if w >= 0 and w != v:
                        shortest = min(shortest, (xy[w, 0] - x) ** 2 + (xy[w, 1] - y) ** 2)
            step, best, bx, by = 0.25 * math.sqrt(shortest), old, x, y
            for _ in range(HALVED_STEPS):
                cx, cy = bx, by
                for direction in range(9):
                    dx, dy = direction % 3 - 1, direction // 3 - 1
                    xy[v, 0], xy[v, 1] = cx + step * dx, cy + step * dy
                    new = _worst(xy, cells, members, start, stop, less)
                    if new > best:
                        best, bx, by = new, xy[v, 0], xy[v, 1]
                step *= 0.5
            xy[v, 0], xy[v, 1] = bx, by
            if best < old + SINE_GAIN or not _valid(xy, cells, members, start, stop):
                xy[v, 0], xy[v, 1] = x, y
                continue
            moves += 1
            for m in range(start, stop):
                for k in range(4):
                    w = cells[members[m], k]
                    if w >= 0:
                        todo[w] = free[w]
        if moves == before:
            break
    return moves


def smoothed(
    points: NDArray[np.float64], cells: NDArray[np.int32], free: NDArray[np.bool_], rounds: int = 6
) -> tuple[NDArray[np.float64], int]:
    """Move free vertices to where the worst corner of the cells around them is better.

    Parameters
    ----------
    points : (n, 2) float64
    cells : (m, 4) int32
        Counterclockwise and convex; -1 in the last column of triangles.
    free : (n,) bool
    rounds : int

    Returns
    -------
    points : (n, 2) float64
        All cells are still convex, exactly. The least sine of the corners around a vertex never falls, and
        no quadrilateral leaves 39 to 141 degrees so that a triangle gains, unless one there has already.
    moves : int
    """
    xy, exact = scaled(points)
    if not exact:
        return points, 0
    before = xy.copy()
    moves = _smooth(xy, cells, *cells_at(cells, len(xy)), free, rounds)
    moved = (xy != before).any(axis=1)
    result = points.copy()
    place = int(np.argmax(np.abs(points)))
    result[moved] = unscaled(xy[moved], float(before.flat[place] / points.flat[place]))
    return result, moves
