"""The circle with a segment as its diameter: which points are inside, exactly.

A point sees a segment under more than a right angle exactly when it lies inside that circle. The sign of
the dot product of its directions to the two ends decides this. A segment between two vertices whose open
disk contains no vertex is an edge of a Delaunay triangulation of the vertices (K. R. Gabriel and
R. R. Sokal, Systematic Zoology 18, 1969, 259-278). Book: 2.4b.
"""

from __future__ import annotations

import numpy as np

from ..base.jit import inline, kernel
from .exact import add, differences, multiply, sign
from .filters import ORIENT2_BOUND, TINY

__all__ = ["exact_in_disc", "in_disc"]


@inline
def in_disc(ax, ay, bx, by, px, py):
    """1 if p is strictly inside the circle with diameter ab, 0 if on it, -1 if outside; |coordinates| <= 1.

    The filter is that of an orientation: two products of differences, which are added here.
    """
    left = (ax - px) * (bx - px)
    right = (ay - py) * (by - py)
    dot = left + right
    bound = ORIENT2_BOUND * (abs(left) + abs(right)) + TINY
    if dot > bound:
        return -1
    if dot < -bound:
        return 1
    return exact_in_disc(ax, ay, bx, by, px, py)


@kernel
def exact_in_disc(ax, ay, bx, by, px, py):
    """`in_disc` by integers, for any finite doubles."""
    fits, s, w, n = differences(np.array([ax, ay, bx, by, px, py]), 2, 2, 6)
    if fits:
        value = s[0] * s[2] + s[1] * s[3]
        return int(value < 0) - int(value > 0)
    free = len(s)
    multiply(w, n, free - 4, free - 2, free)
    multiply(w, n, free - 3, free - 1, free + 1)
    add(w, n, free, free + 1, free)
    return -sign(w, n, free)
