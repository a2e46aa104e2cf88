"""Distances to points and segments, and minima of "a value there plus a growth times the distance".

One tree of bounding boxes is used for both: with values 0 and growth 1 it gives distances. A value may
change linearly along its segment. See the book, chapter 2.3.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_points
from ..base.errors import InputError
from ..base.jit import inline, kernel
from ..predicates.batch import power_of_two
from .segment_search import Packed, Searched, depth_of, first_in, pack, search

__all__ = ["SegmentTree", "to_box", "to_segment"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


IN_LEAF = 2.0  # segments in a leaf of the tree, at most, on average


# In the plane loops over coordinates take twice the time, so what is needed most often has a branch for it.


@inline
def _to_box_squared(x, q, low, high, node):
    if x.shape[1] == 2:
        u = max(low[node, 0] - x[q, 0], x[q, 0] - high[node, 0], 0.0)
        v = max(low[node, 1] - x[q, 1], x[q, 1] - high[node, 1], 0.0)
        return u * u + v * v
    total = 0.0
    for j in range(x.shape[1]):
        away = max(low[node, j] - x[q, j], x[q, j] - high[node, j], 0.0)
        total += away * away
    return total


@inline
def to_box(x, q, low, high, node):
    """The distance from point q to a box; infinite for an empty box."""
    return np.sqrt(_to_box_squared(x, q, low, high, node))


@inline
def _along(x, q, segments, i):
    """The product of the vectors from the start of segment i to point q and its end; the latter squared."""
    if x.shape[1] == 2:
        ax, ay = segments[i, 0, 0], segments[i, 0, 1]
        ux, uy = segments[i, 1, 0] - ax, segments[i, 1, 1] - ay
        return ux * (x[q, 0] - ax) + uy * (x[q, 1] - ay), ux * ux + uy * uy
    along, square = 0.0, 0.0
    for j in range(x.shape[1]):
        side = segments[i, 1, j] - segments[i, 0, j]
        along += side * (x[q, j] - segments[i, 0, j])
        square += side * side
    return along, square


@inline
def _away(x, q, segments, i, t):
    """The squared distance from point q to the point of segment i at t; at 1 that is its end, unrounded."""
    if x.shape[1] == 2:
        ax, ay, bx, by = segments[i, 0, 0], segments[i, 0, 1], segments[i, 1, 0], segments[i, 1, 1]
        u = x[q, 0] - (bx if t == 1.0 else ax + t * (bx - ax))
        v = x[q, 1] - (by if t == 1.0 else ay + t * (by - ay))
        return u * u + v * v
    total = 0.0
    for j in range(x.shape[1]):
        start, end = segments[i, 0, j], segments[i, 1, j]
        away = x[q, j] - (end if t == 1.0 else start + t * (end - start))
        total += away * away
    return total


@inline
def to_segment(x, q, segments, i):
    """The distance from point q to segment i, whose ends may be equal."""
    along, square = _along(x, q, segments, i)
    t = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    return np.sqrt(_away(x, q, segments, i, t))


class SegmentNodes(NamedTuple):
    """The arrays of a `SegmentTree`: boxes, the least weight below each, the order of the segments."""

    low: Array
    high: Array
    least: Array
    order: Integers
    segments: Array
    weights: Array


@inline
def _select(values, order, first, last, place):
    """Reorder ``order[first:last]`` by values until that at ``place`` parts smaller ones from larger ones.

    C. A. R. Hoare, Communications of the ACM 4 (1961) 321-322: linear time, as a rule.
    """
    left, right = first, last - 1
    while left < right:
        pivot = values[order[(left + right) // 2]]
        i, j = left, right
        while i <= j:
            while values[order[i]] < pivot:
                i += 1
            while pivot < values[order[j]]:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if place <= j:
            right = j
        elif place >= i:
            left = i
        else:
            break


@kernel
def _halved(segments, low, high, leaves, order):
    """Order segments for the leaves of a tree: of each node they are divided at a median of its wider side.

    Writes their boxes, too. Boxes are smaller than along a curve: a search looks at a third fewer.
    """
    m, d, depth = segments.shape[0], segments.shape[2], depth_of(leaves)
    for i in range(m):
        order[i] = i
        for j in range(d):
            low[i, j] = min(segments[i, 0, j], segments[i, 1, j])
            high[i, j] = max(segments[i, 0, j], segments[i, 1, j])
    values = np.empty(m)
    stack = np.empty((64, 2), dtype=np.int64)  # ranges of leaves
    stack[0, 0], stack[0, 1] = 0, leaves
    top = 1
    while top > 0:
        top -= 1
        lower, upper = stack[top, 0], stack[top, 1]
        if upper - lower > 1:
            half = (lower + upper) // 2
            first, middle = first_in(lower, m, depth), first_in(half, m, depth)
            last = first_in(upper, m, depth)
            axis, widest = 0, -1.0
            for j in range(d):
                least, most = np.inf, -np.inf
                for k in range(first, last):
                    place = low[order[k], j] + high[order[k], j]
                    least, most = min(least, place), max(most, place)
                if most - least > widest:
                    axis, widest = j, most - least
            for k in range(first, last):
                values[order[k]] = low[order[k], axis] + high[order[k], axis]
            _select(values, order, first, last, middle)
            stack[top, 0], stack[top, 1], stack[top + 1, 0], stack[top + 1, 1] = half, upper, lower, half
            top += 2


@kernel
def _enclose(box_low, box_high, weights, order, low, high, least):
    """Write the boxes of all nodes, and the least weight below each."""
    leaves, m, d = least.shape[0] // 2, order.shape[0], low.shape[1]
    depth = depth_of(leaves)
    for node in range(2 * leaves - 1, -1, -1):
        least[node] = np.inf
        for j in range(d):
            low[node, j], high[node, j] = np.inf, -np.inf
        if node >= leaves:
            for k in range(first_in(node - leaves, m, depth), first_in(node - leaves + 1, m, depth)):
                i = order[k]
                least[node] = min(least[node], weights[i, 0], weights[i, 1])
                for j in range(d):
                    low[node, j] = min(low[node, j], box_low[i, j])
                    high[node, j] = max(high[node, j], box_high[i, j])
        elif node > 0:
            for child in (2 * node, 2 * node + 1):
                least[node] = min(least[node], least[child])
                for j in range(d):
                    low[node, j] = min(low[node, j], low[child, j])
                    high[node, j] = max(high[node, j], high[child, j])


class SegmentTree:
    """A static tree over segments (or points, which are segments of length zero) in any dimension.

    Parameters
    ----------
    segments : array_like, shape (s, 2, d) or (s, d)
        Segments by their two ends, or points.
    weights : array_like, shape (s,) or (s, 2), optional
        For `least`: a value for each segment, or a value at each of its ends with linear change between
        them; 0 by default.

    Raises
    ------
    InputError
        For no segments, wrong shapes, or entries that are not finite.
    """

    def __init__(self, segments: ArrayLike, weights: ArrayLike | None = None):
        array = np.asarray(segments)
        if array.ndim == 2:
            array = np.repeat(array[:, None], 2, axis=1)
        if array.ndim != 3 or array.shape[1] != 2 or 0 in array.shape:
            raise InputError(f"segments must have shape (s, 2, d) with s >= 1, not {array.shape}")
        ends = as_points(array.reshape(-1, array.shape[2]), "ends of segments")
        self.factor = power_of_two(ends)
        self.segments: Array = np.ascontiguousarray((ends * self.factor).reshape(array.shape))
        given = np.zeros(len(array)) if weights is None else np.array(weights, dtype=np.float64)
        if given.shape not in ((len(array),), (len(array), 2)) or not np.isfinite(given).all():
            raise InputError(f"weights must be {len(array)} finite numbers, not shape {given.shape}")
        self.weights: Array = given if given.ndim == 2 else np.repeat(given[:, None], 2, axis=1)
        many, d = len(array), array.shape[2]
        leaves = 1 << max(0, (int(np.ceil(many / IN_LEAF)) - 1).bit_length())
        boxes, nodes, order = np.empty((2, many, d)), np.empty((2, 2 * leaves, d)), np.empty(many, np.int64)
        _halved(self.segments, *boxes, leaves, order)
        least = np.empty(2 * leaves)
        _enclose(*boxes, self.weights, order, *nodes, least)
        self.nodes = SegmentNodes(nodes[0], nodes[1], least, order, self.segments, self.weights)
        self.packed = Packed(np.empty((2 * leaves, 2 * d + 1)), np.empty((many, 2 * d + 2)), order)
        pack(self.nodes, self.packed.boxes, self.packed.sides)

    def least(self, x: ArrayLike, growth: float, start: ArrayLike | None = None) -> tuple[Array, Integers]:
        """The minimum of weight + growth * distance over all segments.

        Parameters
        ----------
        x : array_like, shape (k, d)
        growth : float
            At least 0.
        start : array_like, shape (k,), optional
            Upper bounds: only lower values are searched.

        Returns
        -------
        values : ndarray, shape (k,)
        which : ndarray of int, shape (k,)
            The segment that gave each value; -1 where no value is lower than ``start``.
        """
        points = as_points(x, "x")
        if not 0 <= growth < np.inf:
            raise InputError(f"growth must be a finite number of at least 0, not {growth!r}")
        best = np.full(len(points), np.inf) if start is None else np.array(start, dtype=np.float64)
        return best, self.lower(points, growth, best)

    def lower(self, points: Array, growth: float, best: Array) -> Integers:
        """As `least`, but writes the values to ``best``, which has the bounds; only shapes are checked."""
        if points.shape[1] != self.segments.shape[2]:
            raise InputError(f"x must have shape (k, {self.segments.shape[2]}), not {points.shape}")
        which = np.empty(len(points), dtype=np.int64)
        places = np.ascontiguousarray(points)
        if places.shape[1] != 2:  # in the plane they are scaled as they are read
            places = places * self.factor
        search(places, *self.searched(growth), best, which)
        return which

    def searched(self, growth: float) -> Searched:
        """What kernels need to search on their own."""
        waiting = np.empty(128, dtype=np.int64), np.empty(128)
        return Searched(self.factor, self.packed, growth / self.factor, waiting)

    def distance(self, x: ArrayLike) -> Array:
        """The distance from each point (k, d) to the nearest segment, shape (k,)."""
        return self._nearest(x)[0]

    def nearest(self, x: ArrayLike) -> tuple[Integers, Array]:
        """The nearest segment of each point (k, d), and where on it: 0 at its first end, 1 at its second."""
        points, which = as_points(x, "x"), self._nearest(x)[1]
        start, end = self.segments[which, 0], self.segments[which, 1]
        square = ((end - start) ** 2).sum(axis=1)
        along = ((end - start) * (points * self.factor - start)).sum(axis=1)
        return which, np.clip(along / np.where(square > 0, square, 1.0), 0.0, 1.0)

    def _nearest(self, x: ArrayLike) -> tuple[Array, Integers]:
        if self.weights.any():
            raise InputError("this tree has weights; call `least` instead")
        return self.least(x, 1.0)
