"""How far triangles are, at samples, from other triangles: the largest distance, without the nearest places.

Only the largest distance of each triangle, or of all of them, is wanted. So the search for a sample may end
as soon as it finds a triangle of the other surface that is no farther than the largest distance so far. Often
it need not begin: the triangle that was found for the sample before is near enough.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.jit import inline, kernel
from .boxes import BOXES_IN_LEAF, square_to_box
from .triangle_tree import square_to_triangle

__all__ = ["Sampled", "Sought", "farthest_samples"]

MOST_WAITING = 128  # boxes that wait; a tree of boxes is never half as deep


class Sampled(NamedTuple):
    """The triangles on which samples are taken.

    Attributes
    ----------
    corners : (m, 3, 3) float64
    parts : (m,) int64
        Into how many parts the sides of each are cut.
    order : (m,) int64
        In which they are visited: neighbors soon after each other.
    """

    corners: NDArray[np.float64]
    parts: NDArray[np.int64]
    order: NDArray[np.int64]


class Sought(NamedTuple):
    """The triangles whose distance is wanted, in the order of the leaves of their tree of boxes."""

    corners: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


@inline
def _searched_near(x, y, z, sought, best, enough, last, stack):
    """The squared distance from the triangles, or one that is no more than ``enough``; and the triangle.

    The search begins with triangle ``last``, whose squared distance is ``best``.
    """
    corners, low, high = sought
    leaves = low.shape[0] // 2
    stack[0], size = 1, 1
    while size > 0 and best > enough:
        size -= 1
        w = stack[size]
        if square_to_box(x, y, z, low, high, w) >= best:
            continue
        while w < leaves:  # down to the nearest leaf
            one, two = 2 * w, 2 * w + 1
            first = square_to_box(x, y, z, low, high, one)
            second = square_to_box(x, y, z, low, high, two)
            if second < first:
                one, two, first, second = two, one, second, first
            if second < best:
                stack[size] = two
                size += 1
            w = one
            if first >= best:
                w = -1
                break
        if w < 0:
            continue
        begin = (w - leaves) * BOXES_IN_LEAF
        for t in range(begin, min(begin + BOXES_IN_LEAF, corners.shape[0])):
            square = square_to_triangle(x, y, z, corners, t)
            if square < best:
                best, last = square, t
    return best, last


@kernel
def farthest_samples(sampled, sought, each, far):
    """Write the largest squared distances at samples of triangles, and return the largest of all.

    Samples are the center of each triangle, and the points that divide its sides and itself evenly.

    Parameters
    ----------
    sampled : Sampled
    sought : Sought
    each : bool
        Whether the largest distance of each triangle is wanted; else that of all suffices.
    far : (m,) float64
        Receives the largest squared distance of each triangle; if only that of all is wanted, the largest up
        to this triangle.
    """
    stack = np.empty(MOST_WAITING, dtype=np.int64)
    c, last, worst, largest = sampled.corners, 0, 0.0, 0.0
    for g in range(sampled.order.shape[0]):
        t = sampled.order[g]
        k = sampled.parts[t]
        if each:
            worst = 0.0
        for i in range(-1, k + 1):
            for j in range(k + 1 - i if i >= 0 else 1):
                if i < 0:  # the center comes first: often it is the farthest
                    x = (c[t, 0, 0] + c[t, 1, 0] + c[t, 2, 0]) / 3.0
                    y = (c[t, 0, 1] + c[t, 1, 1] + c[t, 2, 1]) / 3.0
                    z = (c[t, 0, 2] + c[t, 1, 2] + c[t, 2, 2]) / 3.0
                else:
                    m = k - i - j
                    x = (i * c[t, 0, 0] + j * c[t, 1, 0] + m * c[t, 2, 0]) / k
                    y = (i * c[t, 0, 1] + j * c[t, 1, 1] + m * c[t, 2, 1]) / k
                    z = (i * c[t, 0, 2] + j * c[t, 1, 2] + m * c[t, 2, 2]) / k
                square = square_to_triangle(x, y, z, sought.corners, last)
                if square > worst:
                    square, last = _searched_near(x, y, z, sought, square, worst, last, stack)
                    worst = max(worst, square)
        far[t] = worst
        largest = max(largest, worst)
    return largest
