"""A field of crosses: at each place two directions at right angles, which follow the boundary.

A cross is a direction up to quarter turns. With the direction (c, s) the pair (cos 4a, sin 4a) is the same
for all four arms, so that crosses can be added. Each inner vertex of a triangulation takes the direction of
the sum of its neighbors' pairs, again and again. See the book, chapter 6c.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel

__all__ = ["arm_of", "cross_field"]

CROSS_SWEEPS = 200
SMALL_CHANGE = 1e-3  # of a pair in a sweep; below it the field stands
NO_CROSS = 1e-3  # shorter sums of pairs at the boundary have none: the vertex is as one inside


@inline
def _doubled(c, s):
    """The direction at twice the angle."""
    return c * c - s * s, 2.0 * c * s


@inline
def _halved(c, s):
    """The direction at half the angle, between -90 and 90 degrees; (c, s) need not be of length 1."""
    length = math.sqrt(c * c + s * s)
    if length == 0.0:
        return 1.0, 0.0
    a, b = math.sqrt(max(0.0, 0.5 + 0.5 * c / length)), math.sqrt(max(0.0, 0.5 - 0.5 * c / length))
    return a, math.copysign(b, s)


@inline
def arm_of(c, s):
    """An arm of the cross with this pair."""
    c, s = _halved(c, s)
    return _halved(c, s)


@kernel
def _along_sides(xy, sides, pair, known):
    """The crosses of the ends of sides: of the sum of the pairs of their sides."""
    for k in range(len(sides)):
        a, b = sides[k, 0], sides[k, 1]
        x, y = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
        largest = max(abs(x), abs(y))  # the squares of very short sides would be zero
        x, y = x / largest, y / largest
        length = math.sqrt(x * x + y * y)
        c, s = _doubled(x / length, y / length)
        c, s = _doubled(c, s)
        for v in (a, b):
            pair[v, 0] += c
            pair[v, 1] += s
            known[v] = True
    for v in range(len(xy)):
        length = math.sqrt(pair[v, 0] ** 2 + pair[v, 1] ** 2)
        if known[v] and length > NO_CROSS:
            pair[v, 0] /= length
            pair[v, 1] /= length
        else:
            known[v] = False
            pair[v, 0], pair[v, 1] = 0.0, 0.0


@kernel
def _spread(start, ends, known, pair, queue):
    """From the boundary inward, in breadth: the first cross of a vertex is the mean of those known then."""
    tail = 0
    seen = known.copy()
    for v in range(len(known)):
        if known[v]:
            queue[tail] = v
            tail += 1
    head = 0
    while head < tail:
        v = queue[head]
        head += 1
        if not known[v]:
            pair[v, 0], pair[v, 1] = _mean(start, ends, pair, v)
        for k in range(start[v], start[v + 1]):
            w = ends[k]
            if not seen[w]:
                seen[w] = True
                queue[tail] = w
                tail += 1


@inline
def _mean(start, ends, pair, v):
    """The pair of unit length in the direction of the sum of the neighbors'; v's own, if the sum is zero."""
    c, s = 0.0, 0.0
    for k in range(start[v], start[v + 1]):
        c += pair[ends[k], 0]
        s += pair[ends[k], 1]
    length = math.sqrt(c * c + s * s)
    if length == 0.0:
        return pair[v, 0], pair[v, 1]
    return c / length, s / length


@kernel
def _sweep(start, ends, known, pair, forward):
    """Each vertex in turn takes the mean of its neighbors; returns the largest change."""
    n, largest = len(known), 0.0
    for i in range(n):
        v = i if forward else n - 1 - i
        if known[v]:
            continue
        c, s = _mean(start, ends, pair, v)
        largest = max(largest, max(abs(c - pair[v, 0]), abs(s - pair[v, 1])))
        pair[v, 0], pair[v, 1] = c, s
    return largest


def cross_field(
    xy: NDArray[np.float64], triangles: NDArray[np.int32], sides: NDArray[np.int32]
) -> NDArray[np.float64]:
    """The pairs (cos 4a, sin 4a) of the crosses at the vertices of a triangulation.

    Parameters
    ----------
    xy : (n, 2) float64
        Scaled.
    triangles : (m, 3) int32
    sides : (s, 2) int32
        At their ends one arm is along them; where sides meet, along the mean of their crosses.

    Returns
    -------
    (n, 2) float64
        Of unit length, but (0, 0) in parts that have no side.
    """
    n = len(xy)
    both = triangles[:, [0, 1, 1, 2, 2, 0, 1, 0, 2, 1, 0, 2]].reshape(-1, 2).astype(np.int64)
    rows = np.unique(both[:, 0] * n + both[:, 1])
    start, ends = np.searchsorted(rows, np.arange(n + 1) * n), rows % n
    pair, known = np.zeros((n, 2)), np.zeros(n, dtype=bool)
    _along_sides(xy, sides.astype(np.int64), pair, known)
    _spread(start, ends, known, pair, np.empty(n, dtype=np.int64))
    for k in range(CROSS_SWEEPS):
        if _sweep(start, ends, known, pair, k % 2 == 0) < SMALL_CHANGE:
            break
    return pair
