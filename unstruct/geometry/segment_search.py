"""The search of a `SegmentTree`: minima of "a value there plus a growth times the distance", compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.jit import apart, inline, kernel

__all__ = ["Packed", "Searched", "depth_of", "first_in", "pack", "search"]

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


class Searched(NamedTuple):
    """A tree, a growth, and room for a search, for kernels that call `search`: its arguments between both.

    Attributes
    ----------
    factor : float
    packed : Packed
    growth : float
    waiting : (128,) int64 and (128,) float64
    """

    factor: float
    packed: Packed
    growth: float
    waiting: tuple[Integers, Array]


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
def _apart_squared(point, boxes, node):
    """The squared distance from a point to a box; infinite for an empty box."""
    if len(point) == 2:
        u = max(boxes[node, 0] - point[0], point[0] - boxes[node, 2], 0.0)
        v = max(boxes[node, 1] - point[1], point[1] - boxes[node, 3], 0.0)
        return u * u + v * v
    total, d = 0.0, len(point)
    for j in range(d):
        away = max(boxes[node, j] - point[j], point[j] - boxes[node, d + j], 0.0)
        total += away * away
    return total


@inline
def _off_side(point, sides, k, t):
    """The squared distance from a point to the point of side k at t; at 1 that is its end, unrounded."""
    if len(point) == 2:
        ax, ay, bx, by = sides[k, 0], sides[k, 1], sides[k, 2], sides[k, 3]
        u = point[0] - (bx if t == 1.0 else ax + t * (bx - ax))
        v = point[1] - (by if t == 1.0 else ay + t * (by - ay))
        return u * u + v * v
    total, d = 0.0, len(point)
    for j in range(d):
        start, end = sides[k, j], sides[k, d + j]
        away = point[j] - (end if t == 1.0 else start + t * (end - start))
        total += away * away
    return total


@inline
def _along_side(point, sides, k):
    """The product of the vectors from the start of side k to a point and its end; the latter squared."""
    if len(point) == 2:
        ax, ay = sides[k, 0], sides[k, 1]
        ux, uy = sides[k, 2] - ax, sides[k, 3] - ay
        return ux * (point[0] - ax) + uy * (point[1] - ay), ux * ux + uy * uy
    along, square, d = 0.0, 0.0, len(point)
    for j in range(d):
        side = sides[k, d + j] - sides[k, j]
        along += side * (point[j] - sides[k, j])
        square += side * side
    return along, square


@inline
def _from_side(point, sides, k, growth):
    """The minimum of weight + growth * distance to a point over the points of side k.

    Let the weight rise by r along the length l of the segment. The minimum is taken at the point whose
    connection to the given one is turned from the perpendicular, against the rise, by an angle of sine
    r / (growth l). If there is no such angle, it is taken at the end with the lower weight; if the point lies
    beyond an end, at that end.
    """
    d = len(point)
    low, high = sides[k, 2 * d], sides[k, 2 * d + 1]
    rise = high - low
    along, square = _along_side(point, sides, k)
    if rise == 0.0:
        t = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    else:
        reach = growth * np.sqrt(square)
        if abs(rise) >= reach:
            t = 0.0 if rise > 0.0 else 1.0
        else:
            foot = along / square
            total = _off_side(point, sides, k, foot)
            t = foot - np.sqrt(total / square) * rise / np.sqrt((reach - rise) * (reach + rise))
            t = min(max(t, 0.0), 1.0)
    return (high if t == 1.0 else low + t * rise) + growth * np.sqrt(_off_side(point, sides, k, t))


@inline
def _of_leaf(point, sides, leaf, depth, growth, best):
    """The best of what is known, (value, side, leaf), and the sides of a leaf."""
    lowest, found, home = best
    many = sides.shape[0]
    for k in range(first_in(leaf, many, depth), first_in(leaf + 1, many, depth)):
        value = _from_side(point, sides, k, growth)
        if value < lowest:
            lowest, found, home = value, np.int64(k), leaf
    return lowest, found, home


@inline
def _below(point, packed, node, numbers, best, waiting):
    """The best of what is known, (value, side, leaf), and the sides below a node; nearer children first."""
    boxes, sides, _ = packed
    growth, inverse, depth = numbers
    stack, bound = waiting
    leaves, weight, top = boxes.shape[0] // 2, 2 * len(point), 0
    while node > 0:
        if node < leaves:
            near = 2 * node
            far = near + 1
            square, room = _apart_squared(point, boxes, near), best[0] - boxes[near, weight]
            square_far, room_far = _apart_squared(point, boxes, far), best[0] - boxes[far, weight]
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
            best = _of_leaf(point, sides, node - leaves, depth, growth, best)
        node = 0
        while top > 0 and node == 0:
            top -= 1
            if bound[top] < best[0]:
                node = stack[top]
    return best


@inline
def _answer(point, packed, numbers, home, known, waiting):
    """The least value for a point that is less than what is ``known``, its side and its leaf; -1 for none.

    ``home`` is the leaf that is tried first, or -1. ``waiting`` is room for nodes, and for what they give.
    """
    boxes, sides, _ = packed
    growth, inverse, depth = numbers
    leaves, weight = boxes.shape[0] // 2, 2 * len(point)
    best = known, np.int64(-1), np.int64(-1)
    if home >= 0:
        best = _of_leaf(point, sides, home, depth, growth, best)
    up, node = home + leaves, 0
    if best[1] < 0:
        up = 1
        node = int(boxes[1, weight] + growth * np.sqrt(_apart_squared(point, boxes, 1)) < known)
    while up > 1 or node > 0:
        if node > 0:
            best = _below(point, packed, node, numbers, best, waiting)
        node = 0
        while up > 1 and node == 0:
            other = up ^ 1
            room = best[0] - boxes[other, weight]
            if room > 0.0 and _apart_squared(point, boxes, other) <= (room * inverse) * (room * inverse):
                node = other
            up >>= 1
    return best


@apart
def search(x, factor, packed, growth, waiting, best, which):
    """Lower best[q] to the minimum over i of weight + growth * distance(x[q], segment i); which[q] is that i.

    A box is skipped if its minimum weight at its nearest point would not be lower. Most are skipped by
    squares, before any root is taken. Queries that follow each other are often close, so the leaf with the
    answer of the previous query is tried first. If it is better than what is known, the search goes up from
    there, and down only into those other children that are near enough: mostly none is. In the plane a point
    is a pair, and loops over coordinates, which take longer, are written out.
    ``x`` times ``factor`` are places in the units of the tree; ``waiting`` is room for 128 nodes, and for
    what they give.
    """
    order = packed.order
    home, found = np.int64(-1), np.int64(-1)
    inverse = (1.0 + BY_SQUARES) / growth if growth > 0.0 else np.inf
    numbers = growth, inverse, depth_of(packed.boxes.shape[0] // 2)
    for q in range(x.shape[0]):
        if x.shape[1] == 2:
            point = factor * x[q, 0], factor * x[q, 1]
            best[q], found, home = _answer(point, packed, numbers, home, best[q], waiting)
        else:
            best[q], found, home = _answer(x[q], packed, numbers, home, best[q], waiting)
        which[q] = order[found] if found >= 0 else -1
