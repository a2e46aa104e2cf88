"""Where are points: the leaf that contains each, the leaves that meet a box, the nearest leaf of some.

The corners of all cells come from one formula, `corner`. A point is first located by its coordinates in cells
of the deepest level, which rounding may get wrong by one cell, and then put right by comparison with corners.
So a point lies in the cell that contains it exactly. See the book, chapter 4a.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import frozen
from ...base.jit import inline, kernel
from ...predicates.batch import power_of_two
from .keys import Keys, compacted, interleaved

__all__ = [
    "Grid",
    "apart_squared",
    "boxes_of",
    "cells_of",
    "centers_of",
    "corner",
    "corners",
    "entries",
    "in_box",
    "leaf_of",
    "located",
    "nearest",
    "push_children",
    "stack_for",
    "table_of",
]

TABLE_BITS = 18  # of a key: the table has an entry for each of their values
BEYOND_BOX = -1
FARTHEST = 2.0**64  # points that are more extents of the box away are searched on their own


class Grid(NamedTuple):
    """The leaves as the kernels here read them.

    Attributes
    ----------
    first : (n,) uint64
        The keys of their first cells of the deepest level; increasing.
    levels : (n,) int8
    entry : (m + 1,) int64
        ``entry[i]``: the number of leaves whose key begins with bits less than i; see `table_of`.
    low, side : (d,) float64
        The box.
    depth : int
        The deepest level.
    """

    first: Keys
    levels: NDArray[np.int8]
    entry: NDArray[np.int64]
    low: NDArray[np.float64]
    side: NDArray[np.float64]
    depth: int


@inline
def corner(low, side, i, depth):
    """The coordinate of the i-th plane of cells of a level; that of 2 i of the next level is the same."""
    return low + side * (np.float64(i) / np.float64(np.int64(1) << np.int64(depth)))


def corners(
    low: NDArray[np.float64], side: NDArray[np.float64], i: NDArray[np.int64], level: int
) -> NDArray[np.float64]:
    """`corner` for integer coordinates (n, d) of a level."""
    return low + side * (i / float(1 << level))


def entries(depth: int, dimension: int) -> int:
    """By how many bits keys are shifted for the table."""
    return max(0, dimension * depth - TABLE_BITS)


def table_of(first: Keys, depth: int, dimension: int) -> NDArray[np.int64]:
    """The table over the leading bits of keys, from which binary searches start."""
    shift = np.uint64(entries(depth, dimension))
    count = 1 << min(dimension * depth, TABLE_BITS)
    return frozen(np.searchsorted(first >> shift, np.arange(count + 1, dtype=np.uint64)).astype(np.int64))


@kernel
def _boxes_of(keys, grid_low, side, level, low, high):
    """Write the corners of cells of a level; into `low` the centers, if `high` has no rows."""
    d = low.shape[1]
    for i in range(len(keys)):
        for a in range(d):
            at = np.int64(compacted(keys[i] >> np.uint64(a), d))
            first = corner(grid_low[a], side[a], at, level)
            last = corner(grid_low[a], side[a], at + 1, level)
            if len(high):
                low[i, a], high[i, a] = first, last
            else:
                low[i, a] = first + 0.5 * (last - first)


def boxes_of(
    keys: Keys, low: NDArray[np.float64], side: NDArray[np.float64], level: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lower and the upper corners of cells of a level: (n, d) each."""
    first, last = np.empty((2, len(keys), len(low)))
    _boxes_of(keys, low, side, level, first, last)
    return first, last


def centers_of(
    keys: Keys, low: NDArray[np.float64], side: NDArray[np.float64], level: int
) -> NDArray[np.float64]:
    """The centers of cells of a level: (n, d)."""
    centers = np.empty((len(keys), len(low)))
    _boxes_of(keys, low, side, level, centers, np.empty((0, len(low))))
    return centers


@inline
def leaf_of(first, entry, shift, key):
    """The leaf that contains the cell `key` of the deepest level."""
    i = np.int64(key >> np.uint64(shift))
    low, high = max(entry[i] - 1, 0), entry[i + 1]
    while high - low > 1:
        middle = (low + high) >> 1
        if first[middle] <= key:
            low = middle
        else:
            high = middle
    return low


@inline
def _plane(x, low, side, count):
    """The cell of `count` ones along an axis that contains x; the last one on the box's upper side."""
    i = min(max(np.int64((x - low) / side * count), 0), np.int64(count) - 1)
    while i > 0 and x < low + side * (np.float64(i) / count):
        i -= 1
    while i < np.int64(count) - 1 and x >= low + side * (np.float64(i + 1) / count):
        i += 1
    return i


@kernel
def _locate(grid, shift, x, found):
    d = x.shape[1]
    first, entry, low, side = grid.first, grid.entry, grid.low, grid.side
    count = np.float64(np.int64(1) << np.int64(grid.depth))
    cell = np.zeros(3, dtype=np.int64)
    for i in range(len(x)):
        inside = True
        for a in range(d):
            inside &= low[a] <= x[i, a] <= low[a] + side[a]
            cell[a] = _plane(x[i, a], low[a], side[a], count) if inside else np.int64(0)
        if inside:
            key = interleaved(cell[0], cell[1], cell[2], d)
            found[i] = leaf_of(first, entry, shift, key)
        else:
            found[i] = BEYOND_BOX


@kernel
def _cells(x, low, side, level, cells):
    count = np.float64(np.int64(1) << np.int64(level))
    for i in range(len(x)):
        for a in range(x.shape[1]):
            cells[i, a] = _plane(x[i, a], low[a], side[a], count)


def cells_of(
    x: NDArray[np.float64], low: NDArray[np.float64], side: NDArray[np.float64], level: int
) -> NDArray[np.int64]:
    """The integer coordinates (k, d) of the cells of a level that contain points of the box."""
    cells = np.empty(x.shape, dtype=np.int64)
    _cells(x, low, side, level, cells)
    return cells


def located(grid: Grid, x: NDArray[np.float64]) -> NDArray[np.int64]:
    """The leaf that contains each point (k, d); -1 outside of the box.

    A point on a face that cells share lies in the one with the larger coordinates.
    """
    found = np.empty(len(x), dtype=np.int64)
    _locate(grid, entries(grid.depth, x.shape[1]), x, found)
    return found


@inline
def apart_squared(grid, key, level, low, high, d):
    """The square of the distance between a node and a box, both closed; `key` is that of its first cell."""
    width = np.int64(1) << np.int64(grid.depth - level)
    total = 0.0
    for a in range(d):
        i = np.int64(compacted(key >> np.uint64(a), d))
        gap = max(
            corner(grid.low[a], grid.side[a], i, grid.depth) - high[a],
            low[a] - corner(grid.low[a], grid.side[a], i + width, grid.depth),
        )
        if gap > 0.0:
            total += gap * gap
    return total


@inline
def _beside(grid, key, level, low, high, d):
    """Whether a node and a box, both closed, have no point in common."""
    width = np.int64(1) << np.int64(grid.depth - level)
    for a in range(d):
        i = np.int64(compacted(key >> np.uint64(a), d))
        if corner(grid.low[a], grid.side[a], i, grid.depth) > high[a]:
            return True
        if corner(grid.low[a], grid.side[a], i + width, grid.depth) < low[a]:
            return True
    return False


@kernel
def _in_box(grid, low, high, stack, found):
    """Leaves that meet the box, in order; returns how many there are, also beyond the room in `found`."""
    d = len(low)
    top, count = 0, 0
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, len(grid.first), 0
    while top >= 0:
        begin, end, level = stack[top, 0], stack[top, 1], stack[top, 2]
        top -= 1
        if _beside(grid, grid.first[begin], level, low, high, d):
            continue
        if end - begin == 1:
            if count < len(found):
                found[count] = begin
            count += 1
            continue
        top = push_children(grid, begin, end, level, d, stack, top)
    return count


@inline
def push_children(grid, begin, end, level, d, stack, top):
    """Put the children of a node on the stack, the first of them on top."""
    key = grid.first[begin]
    step = np.uint64(1) << np.uint64(d * (grid.depth - level - 1))
    stop = end
    for child in range((1 << d) - 1, -1, -1):
        start = begin
        if child:
            bound = key + np.uint64(child) * step
            left, right = begin, stop
            while right - left > 0:
                middle = (left + right) >> 1
                if grid.first[middle] < bound:
                    left = middle + 1
                else:
                    right = middle
            start = left
        top += 1
        stack[top, 0], stack[top, 1], stack[top, 2] = start, stop, level + 1
        stop = start
    return top


def stack_for(grid: Grid, d: int) -> NDArray[np.int64]:
    """Room for the nodes that wait in a search from the root."""
    return np.empty(((1 << d) * (grid.depth + 1) + 1, 3), dtype=np.int64)


def in_box(grid: Grid, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.int64]:
    """The leaves that meet the closed box, in order: O(log n + their number)."""
    stack, room = stack_for(grid, len(low)), 64
    while True:
        found = np.empty(room, dtype=np.int64)
        count = _in_box(grid, low, high, stack, found)
        if count <= room:
            return found[:count].copy()
        room = count


@kernel
def _nearest(grid, before, x, stack, found):
    """For each point the nearest leaf of some; ``before[i]``: how many of these come before leaf i."""
    d = x.shape[1]
    for i in range(len(x)):
        best, leaf = np.inf, -1
        top = 0
        stack[0, 0], stack[0, 1], stack[0, 2] = 0, len(grid.first), 0
        while top >= 0:
            begin, end, level = stack[top, 0], stack[top, 1], stack[top, 2]
            top -= 1
            if before[begin] == before[end]:
                continue
            distance = apart_squared(grid, grid.first[begin], level, x[i], x[i], d)
            if distance > best or (distance == best and begin > leaf):
                continue
            if end - begin == 1:
                best, leaf = distance, begin
                continue
            base = top + 1
            top = push_children(grid, begin, end, level, d, stack, top)
            _nearest_last(grid, x[i], stack, base, top)
        found[i] = leaf


@inline
def _nearest_last(grid, x, stack, base, top):
    """Put the child that is nearest to x on top of the stack."""
    d = len(x)
    least, where = np.inf, top
    for s in range(base, top + 1):
        distance = apart_squared(grid, grid.first[stack[s, 0]], stack[s, 2], x, x, d)
        if distance < least:
            least, where = distance, s
    for c in range(3):
        stack[where, c], stack[top, c] = stack[top, c], stack[where, c]


def nearest(grid: Grid, among: NDArray[np.bool_], x: NDArray[np.float64]) -> NDArray[np.int64]:
    """The nearest of the leaves `among` for each point (k, d); of equally near ones the first; -1 if none."""
    before = np.concatenate([[0], np.cumsum(among)]).astype(np.int64)
    found = np.empty(len(x), dtype=np.int64)
    stack, ends = stack_for(grid, x.shape[1]), np.stack([grid.low, grid.low + grid.side])
    f = power_of_two(ends)  # squares of distances are doubles neither for large units nor for small ones
    far = np.abs(x).max(axis=1) > FARTHEST / f
    for rows in (~far, far):
        if rows.any():
            f = power_of_two(np.concatenate([ends, x[rows]]))
            rescaled = grid._replace(low=grid.low * f, side=grid.side * f)
            some = np.empty(int(rows.sum()), dtype=np.int64)
            _nearest(rescaled, before, x[rows] * f, stack, some)
            found[rows] = some
    return found
