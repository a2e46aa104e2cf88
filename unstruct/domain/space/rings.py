"""Triangles between rings of points: surfaces of round bodies, with edges of about equal length everywhere.

Neighboring rings may have different numbers of points. Each side of either ring is the base of a triangle
whose tip lies on the other ring; in which order follows from the middles of the sides.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import cosines, sines

__all__ = ["between", "circle", "disc", "smoothed"]

SMOOTHINGS = 6  # of smoothing: more of them improve the worst angles by less than a degree


def circle(share: np.ndarray) -> np.ndarray:
    """Points (k, 2) of the unit circle at these shares of a full turn; exact at quarters of it."""
    quarter = np.floor(4 * share + 0.5)
    rest = 2 * np.pi * (share - quarter / 4)
    c, s = cosines(rest), sines(rest)
    turns = quarter.astype(np.int64) % 4
    x = np.choose(turns, [c, -s, -c, s])
    y = np.choose(turns, [s, c, -s, -c])
    return np.column_stack([x, y]) + 0.0


def between(
    first: int, count: int, phase: float, other: int, others: int, other_phase: float
) -> NDArray[np.int32]:
    """The triangles between two closed rings, (count + others, 3).

    Parameters
    ----------
    first, count : int
        The ring has the points first, ..., first + count - 1.
    phase : float
        The share of a turn, at most 1 / count, by which its first point is turned.
    other, others, other_phase
        The same of the other ring. Seen from where the turn is counterclockwise and this ring is the outer
        one, the triangles are counterclockwise.

    Notes
    -----
    O(n log n).
    """
    one = phase + (np.arange(count) + 0.5) / count
    two = other_phase + (np.arange(others) + 0.5) / others
    tip = np.searchsorted(two, one, side="left")  # so many sides of the other ring come before
    back = np.searchsorted(one, two, side="right")
    i, j = np.arange(count), np.arange(others)
    base = np.column_stack([first + i, first + (i + 1) % count, other + tip % others])
    rest = np.column_stack([first + back % count, other + (j + 1) % others, other + j])
    return np.concatenate([base, rest]).astype(np.int32)


def smoothed(
    points: np.ndarray,
    triangles: np.ndarray,
    free: np.ndarray,
    onto: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Move free points to the middle of their neighbors, and back onto the surface, some times.

    Parameters
    ----------
    points : (n, d) float64
    triangles : (t, 3) int32
        Closed, or with fixed points at their boundary.
    free : (n,) bool
    onto : function (n, d) -> (n, d)
    """
    start = triangles.ravel()
    end = triangles[:, [1, 2, 0]].ravel()  # of closed triangles: each neighbor once
    count = np.maximum(np.bincount(start, minlength=len(points)), 1)
    for _ in range(SMOOTHINGS):
        total = [np.bincount(start, points[end, k], minlength=len(points)) for k in range(points.shape[1])]
        points = np.where(free[:, None], onto(np.stack(total, axis=1) / count[:, None]), points)
    return points


def disc(count: int, phase: float) -> tuple[np.ndarray, NDArray[np.int32]]:
    """The unit disc in counterclockwise triangles, with so many points on its boundary, which come first.

    Their angles lie between 39 and 93 degrees. (Smoothing raises the mean, but lowers the least to 25.)
    """
    layers = max(1, round(count / (2 * np.pi) * 2 / np.sqrt(3)))
    counts = [max(3, round(count * k / layers)) for k in range(layers, 0, -1)]
    points, rows, first = [circle(phase + np.arange(count) / count)], [], 0
    for k, (n, m) in enumerate(pairwise(counts)):
        inner = (phase + 0.5 / n) % (1 / m)
        points.append((layers - k - 1) / layers * circle(inner + np.arange(m) / m))
        rows.append(between(first, n, phase, first + n, m, inner))
        first, phase = first + n, inner
    n, i = counts[-1], np.arange(counts[-1])
    rows.append(np.column_stack([first + i, first + (i + 1) % n, np.full(n, first + n)]).astype(np.int32))
    points.append(np.zeros((1, 2)))
    return np.concatenate(points), np.concatenate(rows)
