"""Convex pieces of a region: diagonals of its triangulation are removed; whether two pieces overlap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.boxes import BoxTree
from ...predicates.batch import power_of_two
from ...predicates.kernels import orient2, orientation

__all__ = ["convex_pieces", "first_overlap"]

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]


@kernel
def _merge(xy, simplices, neighbors, after, before):
    """Remove diagonals while both angles at their ends stay at most pi (Hertel and Mehlhorn).

    Half-edge 3 t + k runs from corner k + 1 of triangle t to corner k + 2. ``after`` receives the next
    half-edge around the piece, -1 for half-edges that are removed; ``before`` the one before.
    """
    m = simplices.shape[0]
    for h in range(3 * m):
        t, k = h // 3, h % 3
        after[h], before[h] = 3 * t + (k + 1) % 3, 3 * t + (k + 2) % 3
    for h in range(3 * m):
        t, k = h // 3, h % 3
        u = neighbors[t, k]
        if u < t:
            continue
        g = 0
        while neighbors[u, g] != t:
            g += 1
        g += 3 * u
        a, b = simplices[t, (k + 1) % 3], simplices[t, (k + 2) % 3]
        p, q, r, s = before[h], after[g], before[g], after[h]
        if (
            orientation(xy, simplices[p // 3, (p % 3 + 1) % 3], a, simplices[q // 3, (q % 3 + 2) % 3]) >= 0
            and orientation(xy, simplices[r // 3, (r % 3 + 1) % 3], b, simplices[s // 3, (s % 3 + 2) % 3])
            >= 0
        ):
            after[p], before[q], after[r], before[s] = q, p, s, r
            after[h] = after[g] = -1


@kernel
def _list(simplices, after, start, corner):
    """Write the corners of all pieces, one after another, and where each starts; return their number."""
    count, size = 0, 0
    for first in range(after.shape[0]):
        if after[first] < 0:
            continue
        h = first
        while after[h] >= 0:
            corner[size] = simplices[h // 3, (h % 3 + 1) % 3]
            size += 1
            ahead = after[h]
            after[h] = -1
            h = ahead
        count += 1
        start[count] = size
    return count


def convex_pieces(
    points: Floats, simplices: NDArray[np.int32], neighbors: NDArray[np.int32]
) -> tuple[Floats, Counts]:
    """Convex polygons that tile the region of a triangulation.

    Parameters
    ----------
    points : (n, 2) array
    simplices, neighbors : (m, 3) arrays of int32
        Counterclockwise triangles, of which any two neighbors have different numbers.

    Returns
    -------
    corner : (c, 2) array
        Corners of the pieces, counterclockwise, one piece after another. An angle may be straight.
    start : (p + 1,) array of int64
        Piece i has the corners start[i] to start[i + 1] - 1.

    Notes
    -----
    At most four times as many pieces as there must be: S. Hertel, K. Mehlhorn, LNCS 158 (1983) 207-218. O(m).
    """
    m = len(simplices)
    after, before = np.empty(3 * m, dtype=np.int64), np.empty(3 * m, dtype=np.int64)
    _merge(points * power_of_two(points), simplices, neighbors, after, before)
    start, corner = np.zeros(m + 1, dtype=np.int64), np.empty(3 * m, dtype=np.int64)
    count = _list(simplices, after, start, corner)
    return points[corner[: start[count]]], start[: count + 1]


@kernel
def _apart(xy, start, i, j):
    """Whether a side of piece i has no corner of piece j strictly on its inner side."""
    low, high = start[i], start[i + 1]
    for a in range(low, high):
        b = a + 1 if a + 1 < high else low
        beyond = True
        for c in range(start[j], start[j + 1]):
            if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) > 0:
                beyond = False
                break
        if beyond:
            return True
    return False


@kernel
def _first_overlap(xy, start, one, other):
    for k in range(one.shape[0]):
        if not _apart(xy, start, one[k], other[k]) and not _apart(xy, start, other[k], one[k]):
            return k
    return -1


def first_overlap(corner: Floats, start: Counts, owner: Counts) -> tuple[int, int] | None:
    """The owners of two convex pieces with different owners that have interior points in common; exact.

    Two convex polygons have none exactly when a side of one of them separates them.
    """
    low = np.minimum.reduceat(corner, start[:-1])
    high = np.maximum.reduceat(corner, start[:-1])
    one, other = BoxTree(low, high).pairs(low, high)
    chosen = owner[one] < owner[other]
    one, other = one[chosen], other[chosen]
    k = _first_overlap(corner * power_of_two(corner), start, one, other)
    return None if k < 0 else (int(owner[one[k]]), int(owner[other[k]]))
