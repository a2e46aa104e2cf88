"""How near vertices of a tree are to segments, and how many leaves long segments are.

Each segment goes down the tree, into the nodes that are near it by their own size. See the book, chapter 4b.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...predicates.batch import power_of_two
from ..tree.keys import compacted
from ..tree.lookup import Grid, apart_squared, corner, push_children, stack_for

__all__ = ["leaves_along", "nearness"]

SPOTS = 5  # of a leaf: four corners and its center


@inline
def _to_segment_squared(x, y, ax, ay, bx, by):
    """The square of the distance from (x, y) to the segment ab, which may be a point, and where."""
    ux, uy, vx, vy = bx - ax, by - ay, x - ax, y - ay
    length = ux * ux + uy * uy
    t = 0.0 if length == 0.0 else min(max((ux * vx + uy * vy) / length, 0.0), 1.0)
    dx, dy = vx - t * ux, vy - t * uy
    return dx * dx + dy * dy, t


@kernel
def _nearness(grid, ends, reach, spots, points, stack, found):
    longest = max(grid.side[0], grid.side[1])
    low, high = np.empty(2), np.empty(2)
    for s in range(len(ends)):
        ax, ay, bx, by = ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3]
        low[0], low[1], high[0], high[1] = min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)
        top = 0
        stack[0, 0], stack[0, 1], stack[0, 2] = 0, len(grid.first), 0
        while top >= 0:
            begin, end, level = stack[top, 0], stack[top, 1], stack[top, 2]
            top -= 1
            far = reach * longest / np.float64(np.int64(1) << level)
            if apart_squared(grid, grid.first[begin], level, low, high, 2) > far * far:
                continue
            if end - begin > 1:
                top = push_children(grid, begin, end, level, 2, stack, top)
                continue
            for k in range(SPOTS):
                v = spots[begin, k]
                if v >= 0:
                    away, t = _to_segment_squared(points[v, 0], points[v, 1], ax, ay, bx, by)
                    away /= points[v, 2] * points[v, 2]
                    if away < found[v, 0]:
                        found[v, 0], found[v, 1], found[v, 2] = away, s, t


def nearness(
    grid: Grid,
    ends: NDArray[np.float64],
    reach: float,
    spots: NDArray[np.int32],
    points: NDArray[np.float64],
    sizes: NDArray[np.float64],
) -> NDArray[np.float64]:
    """How near points of a quadtree are to segments.

    Parameters
    ----------
    grid : Grid
    ends : (s, 4) float64
        Both ends of each segment; it may be a point.
    reach : float
        Distances up to this many sizes are found; others may be larger than they are, or infinite.
    spots : (n, 5) int32
        The points of each leaf: its corners, and its center or -1.
    points : (v, 2) float64
    sizes : (v,) float64
        At most the longest edge of each leaf that has the point.

    Returns
    -------
    ndarray of float64, shape (v, 3)
        The least distance, squared, in units of the square of the size; the number of the segment, and where
        on it that is, from 0 to 1. Infinite, -1 and 0 where no segment was looked at.

    Notes
    -----
    O(s log n + pairs that are looked at). Distances are rounded.
    """
    found = np.tile([np.inf, -1.0, 0.0], (len(points), 1))
    f = power_of_two(np.stack([grid.low, grid.low + grid.side]))
    scaled = grid._replace(low=grid.low * f, side=grid.side * f)
    _nearness(scaled, ends * f, reach, spots, np.column_stack([points, sizes]) * f, stack_for(grid, 2), found)
    return found


@inline
def _overlap(a, b, low, high, last):
    """The part of a -> b between two planes, as two parameters; a plane that boxes share is in the upper."""
    if a == b:
        inside = low <= a < high or (last and a == high)
        return (0.0, 1.0) if inside else (1.0, 0.0)
    s, t = (low - a) / (b - a), (high - a) / (b - a)
    return max(min(s, t), 0.0), min(max(s, t), 1.0)


@kernel
def _leaves_along(grid, ends, stack, count):
    longest = max(grid.side[0], grid.side[1])
    low, high = np.empty(2), np.empty(2)
    all_cells = np.int64(1) << np.int64(grid.depth)
    for s in range(len(ends)):
        ax, ay, bx, by = ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3]
        low[0], low[1], high[0], high[1] = min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)
        length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
        count[s] = 0.0
        top = 0
        stack[0, 0], stack[0, 1], stack[0, 2] = 0, len(grid.first), 0
        while top >= 0:
            begin, end, level = stack[top, 0], stack[top, 1], stack[top, 2]
            top -= 1
            key = grid.first[begin]
            if apart_squared(grid, key, level, low, high, 2) > 0.0:
                continue
            width = np.int64(1) << np.int64(grid.depth - level)
            i, j = np.int64(compacted(key, 2)), np.int64(compacted(key >> np.uint64(1), 2))
            x0, x1 = (
                corner(grid.low[0], grid.side[0], i, grid.depth),
                corner(grid.low[0], grid.side[0], i + width, grid.depth),
            )
            y0, y1 = (
                corner(grid.low[1], grid.side[1], j, grid.depth),
                corner(grid.low[1], grid.side[1], j + width, grid.depth),
            )
            s0, s1 = _overlap(ax, bx, x0, x1, i + width == all_cells)
            t0, t1 = _overlap(ay, by, y0, y1, j + width == all_cells)
            share = min(s1, t1) - max(s0, t0)
            if share <= 0.0:
                continue
            if end - begin > 1:
                top = push_children(grid, begin, end, level, 2, stack, top)
            else:
                count[s] += share * length / (longest / np.float64(np.int64(1) << level))


def leaves_along(grid: Grid, ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """The integral of ds / h along segments (s, 4), h being the longest edge of the leaf there, but rounding.

    Notes
    -----
    O(log n + leaves that it meets) for a segment.
    """
    count = np.empty(len(ends))
    f = power_of_two(np.stack([grid.low, grid.low + grid.side]))
    scaled = grid._replace(low=grid.low * f, side=grid.side * f)
    _leaves_along(scaled, ends * f, stack_for(grid, 2), count)
    return count
