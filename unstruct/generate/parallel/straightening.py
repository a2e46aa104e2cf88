"""Interfaces of parts made straighter: their vertices move, and the coarse triangles stay triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...predicates.kernels import orient2

__all__ = ["least_of_all", "straightened"]

STRAIGHTENING_ROUNDS = 12
SHORTER_STEPS = 3  # a step that makes an angle too small is halved so often
KEPT_SINE = 0.17860619515673032  # the square of the sine of 25 degrees; below it no angle may become smaller


def straightened(
    points: NDArray[np.float64],
    simplices: NDArray[np.int32],
    edges: NDArray[np.int64],
    free: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """The points, those on interfaces moved toward the middle of their neighbors there.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
    simplices : ndarray of int32, shape (t, 3)
        Positively oriented, and so they stay (exact). No angle below 25 degrees becomes smaller, and none
        falls below that.
    edges : ndarray of int64, shape (e, 2)
        Between the parts, and pieces of the region where these end.
    free : ndarray of bool, shape (n,)
        Which points may move.
    """
    moved = points.copy()
    order = np.argsort(simplices.ravel(), kind="stable")
    star = np.searchsorted(simplices.ravel()[order], np.arange(len(points) + 1))
    both = np.concatenate([edges, edges[:, ::-1]])
    both = both[np.lexsort(both.T[::-1])]
    start = np.searchsorted(both[:, 0], np.arange(len(points) + 1))
    rows = np.flatnonzero(free & (np.diff(start) > 0))
    _straighten(moved, simplices, (order // 3, star), (np.ascontiguousarray(both[:, 1]), start), rows)
    return moved


@kernel
def least_of_all(points, simplices):
    """The least `least_sine` of all triangles."""
    least = 1.0
    for t in range(len(simplices)):
        least = min(least, least_sine(points, simplices, t))
    return least


@kernel
def least_sine(points, simplices, t):
    """The square of the sine of the least angle of a triangle."""
    square = np.empty(3)
    for k in range(3):
        a, b = simplices[t, (k + 1) % 3], simplices[t, (k + 2) % 3]
        dx, dy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        square[k] = dx * dx + dy * dy
    a, b, c = simplices[t, 0], simplices[t, 1], simplices[t, 2]
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    twice = ux * vy - uy * vx
    shortest = min(square[0], square[1], square[2])
    for k in range(3):
        if square[k] == shortest:
            return twice / square[(k + 1) % 3] * (twice / square[(k + 2) % 3])
    return 0.0


@kernel
def _worst(points, simplices, cells, first, last):
    """The least `least_sine` of a star, or -1 if a triangle of it is not positive (exact)."""
    worst = 2.0
    for i in range(first, last):
        a, b, c = simplices[cells[i], 0], simplices[cells[i], 1], simplices[cells[i], 2]
        ax, ay, bx, by = points[a, 0], points[a, 1], points[b, 0], points[b, 1]
        if orient2(ax, ay, bx, by, points[c, 0], points[c, 1]) <= 0:
            return -1.0
        worst = min(worst, least_sine(points, simplices, cells[i]))
    return worst


@kernel
def _straighten(points, simplices, stars, ends, rows):
    cells, star = stars
    other, start = ends
    for _ in range(STRAIGHTENING_ROUNDS):
        for v in rows:
            x, y, many = 0.0, 0.0, start[v + 1] - start[v]
            for i in range(start[v], start[v + 1]):
                x += points[other[i], 0]
                y += points[other[i], 1]
            old = points[v, 0], points[v, 1]
            dx, dy = x / many - old[0], y / many - old[1]
            before = _worst(points, simplices, cells, star[v], star[v + 1])
            done = many < 2
            step = 1.0
            for _half in range(SHORTER_STEPS):
                if done:
                    break
                points[v, 0], points[v, 1] = old[0] + step * dx, old[1] + step * dy
                after = _worst(points, simplices, cells, star[v], star[v + 1])
                done = after >= min(before, KEPT_SINE)
                step /= 2
            if not done:
                points[v, 0], points[v, 1] = old
