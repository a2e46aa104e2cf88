"""The search of a `SegmentTree`: minima of "a value there plus a growth times the distance", compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.jit import inline, kernel

__all__ = ["Packed", "depth_of", "first_in", "pack", "search"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

BY_SQUARES = 1e-14  # above the rounding errors of squares and products


class Packed(NamedTuple):
    """A tree for `search`: what one step reads is in one row, and segments are in the order of leaves.

    Attributes
    ----------
    boxes : (2 leaves, 2 d + 1) float64
        Lower corner, upper corner, and least weight of each node.
    sides : (s, 2 d + 2) float64
        The ends of each segment, and the weights there.
    order : (s,) int64
    """

    boxes: Array
    sides: Array
    order: Integers


@inline
def depth_of(leaves):
    """The depth of the leaves, of which there are two to this power."""
    depth = 0
    while leaves > 1:
        leaves, depth = leaves >> 1, depth + 1
    return depth


@inline
def first_in(leaf, many, depth):
    """The place of the first segment of a leaf in the order: ``many`` segments share the leaves evenly."""
    return leaf * many >> depth


# In the plane loops over coordinates take twice the time, so it has branches of its own.


@kernel
def pack(nodes, boxes, sides):
    """Fill the arrays of `Packed` from those of `SegmentNodes`."""
    low, high, least, order, segments, weights = nodes
    d = low.shape[1]
    for node in range(boxes.shape[0]):
        for j in range(d):
            boxes[node, j], boxes[node, d + j] = low[node, j], high[node, j]
        boxes[node, 2 * d] = least[node]
    for k in range(order.shape[0]):
        for end in range(2):
            for j in range(d):
                sides[k, end * d + j] = segments[order[k], end, j]
            sides[k, 2 * d + end] = weights[order[k], end]


@inline
def _apart_squared(x, q, boxes, node):
    """The squared distance from point q to a box; infinite for an empty box."""
    if x.shape[1] == 2:
        u = max(boxes[node, 0] - x[q, 0], x[q, 0] - boxes[node, 2], 0.0)
        v = max(boxes[node, 1] - x[q, 1], x[q, 1] - boxes[node, 3], 0.0)
        return u * u + v * v
    total, d = 0.0, x.shape[1]
    for j in range(d):
        away = max(boxes[node, j] - x[q, j], x[q, j] - boxes[node, d + j], 0.0)
        total += away * away
    return total


@inline
def _along_side(x, q, sides, k):
    """The product of the vectors from the start of side k to point q and its end; the latter squared."""
    if x.shape[1] == 2:
        ax, ay = sides[k, 0], sides[k, 1]
        ux, uy = sides[k, 2] - ax, sides[k, 3] - ay
        return ux * (x[q, 0] - ax) + uy * (x[q, 1] - ay), ux * ux + uy * uy
    along, square, d = 0.0, 0.0, x.shape[1]
    for j in range(d):
        side = sides[k, d + j] - sides[k, j]
        along += side * (x[q, j] - sides[k, j])
        square += side * side
    return along, square


@inline
def _off_side(x, q, sides, k, t):
    """The squared distance from point q to the point of side k at t; at 1 that is its end, unrounded."""
    if x.shape[1] == 2:
        ax, ay, bx, by = sides[k, 0], sides[k, 1], sides[k, 2], sides[k, 3]
        u = x[q, 0] - (bx if t == 1.0 else ax + t * (bx - ax))
        v = x[q, 1] - (by if t == 1.0 else ay + t * (by - ay))
        return u * u + v * v
    total, d = 0.0, x.shape[1]
    for j in range(d):
        start, end = sides[k, j], sides[k, d + j]
        away = x[q, j] - (end if t == 1.0 else start + t * (end - start))
        total += away * away
    return total


@inline
def _from_side(x, q, sides, k, growth):
    """The minimum of weight + growth * distance to x[q] over the points of side k.

    Let the weight rise by r along the length l of the segment. The minimum is taken at the point whose
    connection to x[q] is turned from the perpendicular, against the rise, by an angle of sine r / (growth l).
    If there is no such angle, it is taken at the end with the lower weight; if the point lies beyond an end,
    at that end.
    """
    low, high = sides[k, 2 * x.shape[1]], sides[k, 2 * x.shape[1] + 1]
    rise = high - low
    along, square = _along_side(x, q, sides, k)
    if rise == 0.0:
        t = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    else:
        reach = growth * np.sqrt(square)
        if abs(rise) >= reach:
            t = 0.0 if rise > 0.0 else 1.0
        else:
            foot = along / square
            total = _off_side(x, q, sides, k, foot)
            t = foot - np.sqrt(total / square) * rise / np.sqrt((reach - rise) * (reach + rise))
            t = min(max(t, 0.0), 1.0)
    return (high if t == 1.0 else low + t * rise) + growth * np.sqrt(_off_side(x, q, sides, k, t))


@kernel
def search(x, packed, growth, best, which):
    """Lower best[q] to the minimum over i of weight + growth * distance(x[q], segment i); which[q] is that i.

    A box is skipped if its minimum weight at its nearest point would not be lower. Most are skipped by
    squares, before any root is taken. Queries that follow each other are often close, so the answer of the
    previous query is tried first.
    """
    boxes, sides, order = packed
    leaves, weight = boxes.shape[0] // 2, 2 * x.shape[1]
    depth = depth_of(leaves)
    stack, bound = np.empty(128, dtype=np.int64), np.empty(128)
    last, inverse = np.int64(-1), (1.0 + BY_SQUARES) / growth if growth > 0.0 else np.inf
    for q in range(x.shape[0]):
        lowest, found = best[q], np.int64(-1)
        if last >= 0:
            value = _from_side(x, q, sides, last, growth)
            if value < lowest:
                lowest, found = value, last
        node, top = 1, 0
        if not boxes[1, weight] + growth * np.sqrt(_apart_squared(x, q, boxes, 1)) < lowest:
            node = 0
        while node > 0:
            if node < leaves:
                near = 2 * node
                far = near + 1
                square, room = _apart_squared(x, q, boxes, near), lowest - boxes[near, weight]
                square_far, room_far = _apart_squared(x, q, boxes, far), lowest - boxes[far, weight]
                to_this = room > 0.0 and square <= (room * inverse) * (room * inverse)
                to_other = room_far > 0.0 and square_far <= (room_far * inverse) * (room_far * inverse)
                if to_this and to_other:
                    to_near = boxes[near, weight] + growth * np.sqrt(square)
                    to_far = boxes[far, weight] + growth * np.sqrt(square_far)
                    if to_far < to_near:
                        near, far, to_near, to_far = far, near, to_far, to_near
                    stack[top], bound[top] = far, to_far
                    top += 1
                if to_this or to_other:
                    node = near if to_this else far
                    continue
            else:
                leaf, many = node - leaves, order.shape[0]
                for k in range(first_in(leaf, many, depth), first_in(leaf + 1, many, depth)):
                    value = _from_side(x, q, sides, k, growth)
                    if value < lowest:
                        lowest, found = value, np.int64(k)
            node = 0
            while top > 0 and node == 0:
                top -= 1
                if bound[top] < lowest:
                    node = stack[top]
        best[q], which[q], last = lowest, order[found] if found >= 0 else -1, found
