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
from .boxes import BOXES_IN_LEAF, BoxTree

__all__ = ["SegmentTree", "to_box", "to_segment"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@inline
def to_box(x, q, low, high, node):
    """The distance from point q to a box; infinite for an empty box."""
    total = 0.0
    for j in range(x.shape[1]):
        away = max(low[node, j] - x[q, j], x[q, j] - high[node, j], 0.0)
        total += away * away
    return np.sqrt(total)


@inline
def to_segment(x, q, segments, i):
    """The distance from point q to segment i, whose ends may be equal."""
    along, square = 0.0, 0.0
    for j in range(x.shape[1]):
        side = segments[i, 1, j] - segments[i, 0, j]
        along += side * (x[q, j] - segments[i, 0, j])
        square += side * side
    t = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    total = 0.0
    for j in range(x.shape[1]):
        start, end = segments[i, 0, j], segments[i, 1, j]
        foot = end if t == 1.0 else start + t * (end - start)
        away = x[q, j] - foot
        total += away * away
    return np.sqrt(total)


@inline
def _from_segment(x, q, segments, weights, i, growth):
    """The minimum of weight + growth * distance to x[q] over the points of segment i.

    Let the weight rise by r along the length l of the segment. The minimum is taken at the point whose
    connection to x[q] is turned from the perpendicular, against the rise, by an angle of sine r / (growth l).
    If there is no such angle, it is taken at the end with the lower weight; if the point lies beyond an end,
    at that end.
    """
    rise = weights[i, 1] - weights[i, 0]
    if rise == 0.0:
        return weights[i, 0] + growth * to_segment(x, q, segments, i)
    along, square = 0.0, 0.0
    for j in range(x.shape[1]):
        side = segments[i, 1, j] - segments[i, 0, j]
        along += side * (x[q, j] - segments[i, 0, j])
        square += side * side
    reach = growth * np.sqrt(square)
    if abs(rise) >= reach:
        t = 0.0 if rise > 0.0 else 1.0
    else:
        foot, total = along / square, 0.0
        for j in range(x.shape[1]):
            away = x[q, j] - (segments[i, 0, j] + foot * (segments[i, 1, j] - segments[i, 0, j]))
            total += away * away
        t = foot - np.sqrt(total / square) * rise / np.sqrt((reach - rise) * (reach + rise))
        t = min(max(t, 0.0), 1.0)
    total = 0.0
    for j in range(x.shape[1]):
        start, end = segments[i, 0, j], segments[i, 1, j]
        away = x[q, j] - (end if t == 1.0 else start + t * (end - start))
        total += away * away
    return (weights[i, 1] if t == 1.0 else weights[i, 0] + t * rise) + growth * np.sqrt(total)


@inline
def _to_box_2(px, py, low, high, node):
    """`to_box` in the plane."""
    x = max(low[node, 0] - px, px - high[node, 0], 0.0)
    y = max(low[node, 1] - py, py - high[node, 1], 0.0)
    return np.sqrt(x * x + y * y)


@inline
def _from_segment_2(px, py, segments, weights, i, growth):
    """`_from_segment` in the plane."""
    ax, ay, bx, by = segments[i, 0, 0], segments[i, 0, 1], segments[i, 1, 0], segments[i, 1, 1]
    low, rise = weights[i, 0], weights[i, 1] - weights[i, 0]
    ux, uy = bx - ax, by - ay
    along, square = ux * (px - ax) + uy * (py - ay), ux * ux + uy * uy
    if rise == 0.0:
        t = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    else:
        reach = growth * np.sqrt(square)
        if abs(rise) >= reach:
            t = 0.0 if rise > 0.0 else 1.0
        else:
            foot = along / square
            x, y = px - (ax + foot * ux), py - (ay + foot * uy)
            t = foot - np.sqrt((x * x + y * y) / square) * rise / np.sqrt((reach - rise) * (reach + rise))
            t = min(max(t, 0.0), 1.0)
    x, y = (px - bx, py - by) if t == 1.0 else (px - (ax + t * ux), py - (ay + t * uy))
    return (weights[i, 1] if t == 1.0 else low + t * rise) + growth * np.sqrt(x * x + y * y)


class SegmentNodes(NamedTuple):
    """The arrays of a `SegmentTree`: boxes, the least weight below each, the order of the segments."""

    low: Array
    high: Array
    least: Array
    order: Integers
    segments: Array
    weights: Array


@kernel
def _search(x, tree, growth, best, which):
    """Lower best[q] to the minimum over i of weight + growth * distance(x[q], segment i); which[q] is that i.

    A box is skipped if its minimum weight at its nearest point would not be lower. Queries that follow each
    other are often close, so the answer of the previous query is tried first.
    """
    low, high, least, order, segments, weights = tree
    leaves = low.shape[0] // 2
    stack, bound = np.empty(128, dtype=np.int64), np.empty(128)
    for q in range(x.shape[0]):
        i = which[q - 1] if q > 0 else -1
        if i >= 0:
            value = _from_segment(x, q, segments, weights, i, growth)
            if value < best[q]:
                best[q], which[q] = value, i
        top = 1
        stack[0], bound[0] = 1, least[1] + growth * to_box(x, q, low, high, 1)
        while top > 0:
            top -= 1
            node = stack[top]
            if bound[top] >= best[q]:
                continue
            if node < leaves:
                left = least[2 * node] + growth * to_box(x, q, low, high, 2 * node)
                right = least[2 * node + 1] + growth * to_box(x, q, low, high, 2 * node + 1)
                near = 0 if left <= right else 1
                if max(left, right) < best[q]:
                    stack[top], bound[top] = 2 * node + 1 - near, max(left, right)
                    top += 1
                if min(left, right) < best[q]:
                    stack[top], bound[top] = 2 * node + near, min(left, right)
                    top += 1
                continue
            first = (node - leaves) * BOXES_IN_LEAF
            for k in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                i = order[k]
                value = _from_segment(x, q, segments, weights, i, growth)
                if value < best[q]:
                    best[q] = value
                    which[q] = i


@kernel
def _search_2(x, tree, growth, best, which):
    """`_search` in the plane: without loops over coordinates it takes half the time."""
    low, high, least, order, segments, weights = tree
    leaves = low.shape[0] // 2
    stack, bound = np.empty(128, dtype=np.int64), np.empty(128)
    for q in range(x.shape[0]):
        px, py = x[q, 0], x[q, 1]
        i = which[q - 1] if q > 0 else -1
        if i >= 0:
            value = _from_segment_2(px, py, segments, weights, i, growth)
            if value < best[q]:
                best[q], which[q] = value, i
        top = 1
        stack[0], bound[0] = 1, least[1] + growth * _to_box_2(px, py, low, high, 1)
        while top > 0:
            top -= 1
            node = stack[top]
            if bound[top] >= best[q]:
                continue
            if node < leaves:
                left = least[2 * node] + growth * _to_box_2(px, py, low, high, 2 * node)
                right = least[2 * node + 1] + growth * _to_box_2(px, py, low, high, 2 * node + 1)
                near = 0 if left <= right else 1
                if max(left, right) < best[q]:
                    stack[top], bound[top] = 2 * node + 1 - near, max(left, right)
                    top += 1
                if min(left, right) < best[q]:
                    stack[top], bound[top] = 2 * node + near, min(left, right)
                    top += 1
                continue
            first = (node - leaves) * BOXES_IN_LEAF
            for k in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                i = order[k]
                value = _from_segment_2(px, py, segments, weights, i, growth)
                if value < best[q]:
                    best[q] = value
                    which[q] = i


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
        tree = BoxTree(self.segments.min(axis=1), self.segments.max(axis=1))
        lowest = _minima(self.weights.min(axis=1)[tree.order], len(tree.low) // 2)
        self.nodes = SegmentNodes(tree.low, tree.high, lowest, tree.order, self.segments, self.weights)

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
        if points.shape[1] != self.segments.shape[2]:
            raise InputError(f"x must have shape (k, {self.segments.shape[2]}), not {points.shape}")
        if not (np.isfinite(growth) and growth >= 0):
            raise InputError(f"growth must be a finite number of at least 0, not {growth!r}")
        best = np.full(len(points), np.inf) if start is None else np.array(start, dtype=np.float64)
        which = np.full(len(points), -1, dtype=np.int64)
        scaled = np.ascontiguousarray(points * self.factor)
        search = _search_2 if scaled.shape[1] == 2 else _search
        search(scaled, self.nodes, growth / self.factor, best, which)
        return best, which

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


def _minima(values: Array, leaves: int) -> Array:
    """The minimum value below each node of a tree whose leaves have `BOXES_IN_LEAF` values each, in order."""
    result = np.full(2 * leaves, np.inf)
    firsts = np.arange(0, len(values), BOXES_IN_LEAF)
    result[leaves : leaves + len(firsts)] = np.minimum.reduceat(values, firsts)
    while leaves > 1:
        half = leaves // 2
        result[half:leaves] = np.minimum(result[leaves : 2 * leaves : 2], result[leaves + 1 : 2 * leaves : 2])
        leaves = half
    return result
