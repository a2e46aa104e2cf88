"""Heights of rays: limited by columns, by their neighbors, and, round by round, by what goes wrong."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from .columns import limits
from .records import COLUMN, FULL, GRADATION, HIDDEN_RAY

__all__ = ["LOWER_BY", "SAFE_SHARE", "edges_of_columns", "graded", "limited", "placed"]

Array = NDArray[np.float64]
SAFE_SHARE = 0.7  # of the height at which a column would not be positive
LOWER_BY = 0.7  # heights of what goes wrong are multiplied by this


def edges_of_columns(columns: NDArray[np.int32]) -> NDArray[np.int64]:
    """The edges of triangles, each once: (e, 2)."""
    ends = np.sort(columns[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    key = np.sort((ends[:, 0] << 32) | ends[:, 1])
    key = key[np.concatenate([[True], key[1:] != key[:-1]])] if len(key) else key
    return np.column_stack([key >> 32, key & (2**32 - 1)])


@kernel
def _lowest(columns, limit, height):
    for i in range(len(columns)):
        for k in range(3):
            height[columns[i, k]] = min(height[columns[i, k]], limit[i])


def limited(
    points: Array, directions: Array, columns: NDArray[np.int32], wanted: Array
) -> tuple[Array, NDArray[np.int8]]:
    """Heights of which no column is more than seven tenths of what it could have, and the reasons.

    Parameters
    ----------
    points, directions : (r, 3) float64
    columns : (c, 3) int32
    wanted : (r,) float64
        The heights that are wanted; 0 for rays that stay.
    """
    share = np.ones(len(wanted))
    _lowest(columns, SAFE_SHARE * limits(points, directions * wanted[:, None], columns), share)
    reason = np.where(share < 1.0, COLUMN, FULL).astype(np.int8)
    reason[wanted == 0.0] = HIDDEN_RAY
    return share * wanted, reason


@kernel
def _graded(start, edge, other, length, slope, height, changed):
    """Lower heights until neighbors differ by no more than the slope times their distance, from the lowest.

    Label-correcting: a vertex is looked at again when it was lowered.
    """
    n = len(height)
    queue, waits = np.empty(n, dtype=np.int64), np.ones(n, dtype=np.bool_)
    order = np.argsort(height)
    for i in range(n):
        queue[i] = order[i]
    head, count = 0, n
    while count > 0:
        v = queue[head]
        head, count = (head + 1) % n, count - 1
        waits[v] = False
        for i in range(start[v], start[v + 1]):
            w = other[i]
            most = height[v] + slope * length[edge[i]]
            if height[w] > most:
                height[w], changed[w] = most, True
                if not waits[w]:
                    queue[(head + count) % n] = w
                    count, waits[w] = count + 1, True


def graded(
    points: Array, edges: NDArray[np.int64], height: Array, reason: NDArray[np.int8], slope: float
) -> tuple[Array, NDArray[np.int8]]:
    """Heights lowered so that along each edge they differ by at most ``slope`` times its length.

    Returns
    -------
    height, reason
        New arrays; those that were lowered have the reason `GRADATION`.
    """
    difference = points[edges[:, 0]] - points[edges[:, 1]]
    x, y, z = difference.T
    length = np.sqrt(x * x + y * y + z * z)
    if not (np.abs(height[edges[:, 0]] - height[edges[:, 1]]) > slope * length).any():
        return height, reason
    ends = np.concatenate([edges, edges[:, ::-1]])
    order = np.argsort(ends[:, 0], kind="stable")
    start = np.searchsorted(ends[order, 0], np.arange(len(height) + 1))
    height, changed = height.copy(), np.zeros(len(height), dtype=np.bool_)
    _graded(start, order % len(edges), ends[order, 1], length, slope, height, changed)
    return height, np.where(changed, GRADATION, reason).astype(np.int8)


@kernel
def _placed(points, directions, height, shares, places):
    for k in range(len(places)):
        for i in range(len(points)):
            step = shares[min(i, len(shares) - 1), k] * height[i]
            for j in range(3):
                places[k, i, j] = points[i, j] + directions[i, j] * step if k > 0 else points[i, j]


def placed(points: Array, directions: Array, height: Array, shares: Array) -> Array:
    """The places of rays on all levels, rounded: (levels + 1, r, 3).

    Parameters
    ----------
    shares : (1, levels + 1) or (r, levels + 1) float64
        The heights of levels, in parts of the whole.
    """
    places = np.empty((shares.shape[1], *points.shape))
    _placed(points, directions, height, shares, places)
    return places
