"""Inside or outside by the even-odd rule, exactly, and the area that segments enclose, correctly rounded."""

from __future__ import annotations

from math import fsum

import numpy as np

from ..base.arrays import fill
from ..base.jit import inline, kernel
from ..predicates.batch import orient_rows, power_of_two
from ..predicates.close import two_product
from .boxes import BoxTree, bounding_boxes

__all__ = [
    "PARTIALS",
    "add_exactly",
    "cells_area",
    "enclosed_area",
    "even_odd",
    "left_parity",
    "on_the_right",
    "products",
    "right_parity",
]


PARTIALS = 2200  # doubles that do not overlap may have one bit each: 2098 span all exponents
POINTS_AT_ONCE = 1 << 14  # how many points are processed at a time


def even_odd(points: np.ndarray, segments: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Whether rays to the right from ``x`` cross an odd number of segments, and whether x is on one.

    Parameters
    ----------
    points : (n, 2) float64
    segments : (s, 2) int
        Each vertex must have an even number of segments.
    x : (k, 2) float64

    Returns
    -------
    odd, on : (k,) bool
        Both are exact. For points on segments (``on``), ``odd`` counts each segment as half-open.
    """
    odd, on = np.zeros(len(x), dtype=bool), np.zeros(len(x), dtype=bool)
    if len(x) == 0:
        return odd, on
    ends = points[segments]
    low, high = bounding_boxes(ends)
    far = max(high[:, 0].max(initial=0.0), x[:, 0].max(initial=0.0))
    tree = BoxTree(low, high)
    for i in range(0, len(x), POINTS_AT_ONCE):
        part = x[i : i + POINTS_AT_ONCE]
        reach = part.copy()
        reach[:, 0] = far
        query, hit = tree.pairs(part, reach)
        a, b = segments[hit].T
        flip = points[a, 1] > points[b, 1]
        a, b = np.where(flip, b, a), np.where(flip, a, b)
        y = part[query, 1]
        simplices = np.stack([points[a], points[b], part[query]], axis=1)
        left = orient_rows(simplices.reshape(-1, 2), np.arange(3 * len(a)).reshape(-1, 3))
        over = (points[a, 1] <= y) & (y < points[b, 1]) & (left > 0)
        odd[i : i + POINTS_AT_ONCE] = np.bincount(query[over], minlength=len(part)) % 2 == 1
        flat = left == 0
        level = flat & (part[query] >= low[hit]).all(axis=1) & (part[query] <= high[hit]).all(axis=1)
        on[i + query[level]] = True
    return odd, on


def left_parity(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Whether the left side of each segment is inside, for segments that do not cross; exact.

    The answer is the same along a chain of segments, whose inner vertices belong to only two segments each.
    So one ray per chain suffices. It starts at the lower end of the chain's first segment, just to the right
    of it. Of two vertices at the same height, the right one counts as higher, so that no segment is level.
    """
    if len(segments) == 0:
        return np.zeros(0, dtype=bool)
    chain, along = np.empty(len(segments), dtype=np.int64), np.zeros(len(segments), dtype=bool)
    _chains(_mates(segments), chain, along)
    heads = np.unique(chain, return_index=True)[1]
    inside = right_parity(points, segments, segments[heads])
    return np.where(_below(points, segments[heads]), ~inside, inside)[chain] ^ along


def right_parity(points: np.ndarray, segments: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Whether an odd number of segments lies to the right of each of ``rows``; exact.

    They are counted at the lower end of each row, just to the right of it when looking upward. The rows may
    be segments themselves, or other pairs of vertices whose connections cross no segment.
    """
    query, _ = on_the_right(points, segments, rows)
    return np.bincount(query, minlength=len(rows)) % 2 == 1


def on_the_right(points: np.ndarray, segments: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All pairs of a row and a segment to the right of it, as `right_parity` counts them: their numbers."""
    if len(segments) == 0:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    up = _below(points, segments)
    lower, upper = np.where(up[:, None], segments, segments[:, ::-1]).T
    foot, top = np.where(_below(points, rows)[:, None], rows, rows[:, ::-1]).T
    ends = points[segments]
    low, high = bounding_boxes(ends)
    at = points[foot]
    reach = at.copy()
    reach[:, 0] = np.maximum(high[:, 0].max(), at[:, 0])
    query, hit = BoxTree(low, high).pairs(at, reach)
    f, c, d = foot[query], lower[hit], upper[hit]
    same = c == f
    over = (same | _below(points, np.column_stack([c, f]))) & _below(points, np.column_stack([f, d]))
    query, hit, f, c, d, same = query[over], hit[over], f[over], c[over], d[over], same[over]
    # A segment counts if it lies to the right at the height of the foot, or leaves the foot to the right of
    # the row.
    corners = np.column_stack([f, np.where(same, d, c), np.where(same, top[query], d)])
    right = orient_rows(points, corners) > 0
    return query[right], hit[right]


def _below(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    a, b = points[rows[:, 0]], points[rows[:, 1]]
    return (a[:, 1] < b[:, 1]) | ((a[:, 1] == b[:, 1]) & (a[:, 0] < b[:, 0]))


def _mates(segments: np.ndarray) -> np.ndarray:
    """For end 2 s + e of segment s: the other end at its vertex if exactly two ends meet there, else -1."""
    vertex = segments.ravel()
    order = np.argsort(vertex, kind="stable")
    first = np.concatenate([[0], np.nonzero(np.diff(vertex[order]))[0] + 1, [len(vertex)]])
    double = first[:-1][np.diff(first) == 2]
    mates = np.full(len(vertex), -1, dtype=np.int64)
    mates[order[double]], mates[order[double + 1]] = order[double + 1], order[double]
    return mates


@kernel
def _chains(mates, chain, against):
    """The chain of each segment, and whether the segment runs against the first segment of its chain."""
    fill(chain, -1)
    count = 0
    for start in range(len(chain)):
        if chain[start] >= 0:
            continue
        chain[start] = count
        for leave in (2 * start, 2 * start + 1):
            previous, turned = leave, False
            end = mates[previous]
            while end >= 0 and chain[end // 2] < 0:
                if end % 2 == previous % 2:  # the segments meet head to head or tail to tail
                    turned = not turned
                chain[end // 2] = count
                against[end // 2] = turned
                previous = end + 1 - 2 * (end % 2)
                end = mates[previous]
        count += 1


def enclosed_area(points: np.ndarray, segments: np.ndarray) -> float:
    """Area enclosed by closed chains that have the inside on their left; correctly rounded.

    The cross products are split into exact sums of doubles (Dekker) and added without error. Coordinates are
    scaled by a power of two first. Only terms that underflow, below 2^-1074 times the square of the largest
    coordinate, are lost.
    """
    factor = power_of_two(points)
    xa, ya = (points[segments[:, 0]] * factor).T
    xb, yb = (points[segments[:, 1]] * factor).T
    parts = [*products(xa, yb), *products(-ya, xb)]
    return fsum(np.concatenate(parts).tolist()) / 2 / factor / factor


def cells_area(points: np.ndarray, triangles: np.ndarray) -> float:
    """The sum of the areas of counterclockwise triangles, correctly rounded like `enclosed_area`."""
    factor = power_of_two(points)
    partials = np.zeros(PARTIALS)
    count = _twice_area(points * factor, triangles, partials)
    return fsum(partials[:count].tolist()) / 2 / factor / factor


@inline
def add_exactly(partials, count, x):
    """Add a term to ``count`` partial sums without error, like `math.fsum`; return how many they are then."""
    left = 0
    for j in range(count):
        y = partials[j]
        if abs(x) < abs(y):
            x, y = y, x
        high = x + y
        low = y - (high - x)
        if low != 0.0:
            partials[left] = low
            left += 1
        x = high
    partials[left] = x
    return left + 1


@kernel
def _twice_area(xy, triangles, partials):
    """Add the cross products of all sides without error, like `math.fsum`; return how many partial sums."""
    count = 0
    terms = np.empty(4)
    for t in range(triangles.shape[0]):
        for k in range(3):
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            terms[0], terms[1] = two_product(xy[a, 0], xy[b, 1])
            terms[2], terms[3] = two_product(-xy[a, 1], xy[b, 0])
            for i in range(4):
                count = add_exactly(partials, count, terms[i])
    return count


def products(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split a b into high + low, exactly (Dekker), for moderate exponents."""
    high = a * b
    ah, al = _split(a)
    bh, bl = _split(b)
    return high, al * bl - (((high - ah * bh) - al * bh) - ah * bl)


def _split(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    c = 134217729.0 * a
    high = c - (c - a)
    return high, a - high
