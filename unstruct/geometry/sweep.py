"""Whether any two segments meet: a line sweeps over the plane, and the segments that it cuts are kept sorted.

The method is that of M. I. Shamos, D. Hoey, *Geometric intersection problems*, FOCS 1976, 208-215, here with
exact signs, and several segments may share a vertex. Used to validate regions; see the book, chapter 2.6d.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.jit import kernel
from ..predicates.batch import scaled
from ..predicates.kernels import orientation

__all__ = ["any_meeting", "lexicographic"]

BLOCK = 128  # segments in a block of the ordered list


class Line(NamedTuple):
    """The segments that the sweep line cuts, from the lowest to the highest, in blocks.

    How many blocks are in use is handed along beside the record.
    """

    blocks: NDArray[np.int64]  # (., BLOCK) numbers of segments
    held: NDArray[np.int64]  # how many segments each block holds
    directory: NDArray[np.int64]  # the blocks in their order; the free ones follow


def lexicographic(points: np.ndarray) -> np.ndarray:
    """The order of points by x, for equal x by y, and for equal points by number."""
    order = np.argsort(points[:, 0], kind="stable")
    x = points[order, 0]
    same = x[1:] == x[:-1]
    if same.any():
        rows = np.nonzero(np.append(same, False) | np.append(False, same))[0]
        some = order[rows]
        order[rows] = some[np.lexsort((some, points[some, 1], points[some, 0]))]
    return order


@kernel
def _meet(xy, left, right, s, t):
    """Whether two neighboring segments on the sweep line meet in more than a common end.

    One has an end off the line of the other, so that two segments with a common end cannot overlap.
    """
    p, q, a, b = left[s], right[s], left[t], right[t]
    if p == a or q == b or p == b or q == a:
        return False
    if orientation(xy, p, q, a) * orientation(xy, p, q, b) > 0:
        return False
    return orientation(xy, a, b, p) * orientation(xy, a, b, q) <= 0


@kernel
def _find(xy, left, right, line, many, v):
    """The place (block, offset) of the lowest segment that is not below vertex v; (many, 0) if none is."""
    blocks, count, directory = line
    low, high = 0, many  # the last block whose first segment is below v
    while low < high:
        middle = (low + high) // 2
        s = blocks[directory[middle], 0]
        if orientation(xy, left[s], right[s], v) > 0:
            low = middle + 1
        else:
            high = middle
    if low == 0:
        return 0, 0
    block = directory[low - 1]
    first, last = 1, count[block]
    while first < last:
        middle = (first + last) // 2
        s = blocks[block, middle]
        if orientation(xy, left[s], right[s], v) > 0:
            first = middle + 1
        else:
            last = middle
    if first == count[block]:
        return low, 0
    return low - 1, first


@kernel
def _remove(line, many, i, j):
    """Remove the segment at place (i, j); return the number of remaining blocks."""
    blocks, count, directory = line
    block = directory[i]
    count[block] -= 1
    for k in range(j, count[block]):
        blocks[block, k] = blocks[block, k + 1]
    if count[block] > 0:
        return many
    for k in range(i, many - 1):
        directory[k] = directory[k + 1]
    directory[many - 1] = block  # this block is free and will be used next
    return many - 1


@kernel
def _insert(line, many, i, j, s):
    """Insert segment s before place (i, j); return its place and the number of blocks."""
    blocks, count, directory = line
    if j == 0 and i > 0:  # append it to the previous block
        i -= 1
        j = count[directory[i]]
    if many == 0:
        many, i, j = 1, 0, 0
        count[directory[0]] = 0
    block = directory[i]
    if count[block] == BLOCK:  # its upper half becomes a block of its own
        fresh = directory[many]
        for k in range(many, i + 1, -1):
            directory[k] = directory[k - 1]
        directory[i + 1] = fresh
        many += 1
        half = BLOCK // 2
        for k in range(half):
            blocks[fresh, k] = blocks[block, half + k]
        count[block], count[fresh] = half, half
        if j > half:
            i, j, block = i + 1, j - half, fresh
    for k in range(count[block], j, -1):
        blocks[block, k] = blocks[block, k - 1]
    blocks[block, j] = s
    count[block] += 1
    return i, j, many


@kernel
def _sweep(xy, order, left, right, start, begin, line, chosen):
    """Whether any two segments meet in more than a common end; ``start`` lists them by left ends."""
    blocks, count, directory = line
    many = 0
    for v in order:
        i, j = _find(xy, left, right, line, many, v)
        while i < many:  # remove the segments through v; if one of them does not end there, segments meet
            s = blocks[directory[i], j]
            if orientation(xy, left[s], right[s], v) != 0:
                break
            if right[s] != v:
                return True
            last = j == count[directory[i]] - 1
            before = many
            many = _remove(line, many, i, j)
            if last and many == before:
                i, j = i + 1, 0
        below, above = -1, -1
        if i < many:
            above = blocks[directory[i], j]
        if j > 0:
            below = blocks[directory[i], j - 1]
        elif i > 0:
            below = blocks[directory[i - 1], count[directory[i - 1]] - 1]
        fresh = begin[v + 1] - begin[v]
        if fresh == 0:
            if below >= 0 and above >= 0 and _meet(xy, left, right, below, above):
                return True
            continue
        for k in range(fresh):  # sort the segments that start at v from the lowest to the highest
            s = start[begin[v] + k]
            m = k
            while m > 0:
                side = orientation(xy, v, right[chosen[m - 1]], right[s])
                if side == 0:
                    return True
                if side > 0:
                    break
                chosen[m] = chosen[m - 1]
                m -= 1
            chosen[m] = s
        if below >= 0 and _meet(xy, left, right, below, chosen[0]):
            return True
        if above >= 0 and _meet(xy, left, right, chosen[fresh - 1], above):
            return True
        for k in range(fresh):
            i, j, many = _insert(line, many, i, j, chosen[k])
            j += 1
            if j == count[directory[i]]:
                i, j = i + 1, 0
    return False


def any_meeting(points: np.ndarray, segments: np.ndarray) -> bool | None:
    """Whether any two segments meet in more than a common end vertex; exact, O(s log s).

    Parameters
    ----------
    points : (n, 2) float64
        Equal points are different vertices, so segments that end at equal points meet there.
    segments : (s, 2) int
        No segment may have zero length.

    Returns
    -------
    bool or None
        None if this was not decided, because the coordinates cannot be scaled by one factor exactly.
    """
    xy, exact = scaled(points)
    if not exact:
        return None
    n, s = len(points), len(segments)
    order = lexicographic(xy)
    rank = np.empty(n, dtype=np.int64)
    rank[order] = np.arange(n)
    turned = rank[segments[:, 0]] > rank[segments[:, 1]]
    left = np.where(turned, segments[:, 1], segments[:, 0]).astype(np.int64)
    right = np.where(turned, segments[:, 0], segments[:, 1]).astype(np.int64)
    used = np.zeros(n, dtype=bool)
    used[segments.ravel()] = True
    order = order[used[order]]
    if (xy[order[1:]] == xy[order[:-1]]).all(axis=1).any():
        return True
    starts = np.bincount(left, minlength=n)
    begin = np.concatenate([[0], np.cumsum(starts)])
    room = 2 * s // BLOCK + 3  # every block but the first was half full when it was made
    blocks = np.empty((max(room, 3) * 2, BLOCK), dtype=np.int64)
    line = Line(blocks, np.zeros(len(blocks), dtype=np.int64), np.arange(len(blocks)))
    start, chosen = np.argsort(left, kind="stable"), np.empty(starts.max(initial=1), dtype=np.int64)
    return bool(_sweep(xy, order, left, right, start, begin, line, chosen))
