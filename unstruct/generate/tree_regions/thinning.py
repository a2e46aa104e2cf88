"""Points along pieces of a domain, of which those go that are too near to another one.

See the book, chapter 4b.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel

__all__ = ["thinned"]


@kernel
def _thin(piece, ends, points, spacing, rank, most, keep):
    """Mark what stays: one rank after the other, along each piece from its start to its end."""
    many = len(piece)
    after = np.empty(many, dtype=np.int64)  # the next point on the same piece that stays, or -1
    for r in range(most, -1, -1):
        following = -1
        for i in range(many - 1, -1, -1):
            if i + 1 < many and piece[i + 1] != piece[i]:
                following = -1
            after[i] = following
            if keep[i]:
                following = i
        before = -1
        for i in range(many):
            p = piece[i]
            if before >= 0 and piece[before] != p:
                before = -1
            if rank[i] == r:
                ax, ay, bx, by = ends[p, 0], ends[p, 1], ends[p, 2], ends[p, 3]
                if before >= 0:
                    ax, ay = points[before, 0], points[before, 1]
                if after[i] >= 0:
                    bx, by = points[after[i], 0], points[after[i], 1]
                x, y, far = points[i, 0], points[i, 1], spacing[i]
                one = (ax - x) * (ax - x) + (ay - y) * (ay - y)
                two = (bx - x) * (bx - x) + (by - y) * (by - y)
                keep[i] = min(one, two) >= far * far
            if keep[i]:
                before = i


def thinned(
    piece: NDArray[np.int64],
    ends: NDArray[np.float64],
    points: NDArray[np.float64],
    spacing: NDArray[np.float64],
    rank: NDArray[np.int64],
) -> NDArray[np.bool_]:
    """Which points along pieces stay, so that none is nearer to those beside it than its spacing.

    Parameters
    ----------
    piece : (k,) int64
        Sorted; along each piece the points follow each other.
    ends : (p, 4) float64
        The ends of the pieces, which always stay.
    points : (k, 2) float64
    spacing : (k,) float64
    rank : (k,) int64
        Points with higher ranks go first; among them, the first along the piece.
    """
    keep = np.zeros(len(piece), dtype=bool)
    _thin(piece, ends, points, spacing, rank, int(rank.max(initial=0)), keep)
    return keep
