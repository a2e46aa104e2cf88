"""Pairs of segments that meet: candidates from a grid or a tree in compiled code, decided by exact signs.

Used to validate regions; see the book, chapter 2.6d.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import fill
from ..base.jit import inline, kernel
from ..predicates.batch import orient_rows
from .boxes import BoxTree
from .segment_filter import SLACK, may_hold, may_meet
from .sweep import any_meeting

__all__ = ["CROSSING", "OVERLAPPING", "TOUCHING", "meetings", "none_meet", "vertices_on_segments"]

CROSSING, TOUCHING, OVERLAPPING = 1, 2, 3
# Tables of cells that are tried in turn. The first number of each is how many cells a segment of mean length
# spans. The second is how many comparisons per segment are allowed before the table is given up. The third is
# the crowd (see `_Grid`) from which on the table is not tried. Wide cells suit chains of segments, and narrow
# cells suit segments side by side. LAST_TABLE is tried after a sweep, with many comparisons.
TABLES, LAST_TABLE = ((0.5, 8, 10.0), (4.0, 60, 100.0)), (4.0, 4000)
LOOKED_AT_ONCE = 4096  # up to so many segments are first looked at in one call of a kernel
FEW_SEGMENTS = 48  # up to so many segments each is compared with each


# ---------------------------------------------------------------------- a table of cells


@inline
def _cell_range(ends, s, x0, y0, scale, ny, row, rows):
    """The range of columns that segment s may touch in a row of the grid; its range of rows if row < 0."""
    ax, ay = (ends[s, 0] - x0) * scale, (ends[s, 1] - y0) * scale
    bx, by = (ends[s, 2] - x0) * scale, (ends[s, 3] - y0) * scale
    if row < 0:
        return int(min(ay, by) - 1e-9), min(int(max(ay, by) + 1e-9), ny - 1)
    left, right = min(ax, bx), max(ax, bx)
    if rows > 1 and abs(by - ay) > 0.5:
        slope = (bx - ax) / (by - ay)
        one, two = ax + (row - 1e-9 - ay) * slope, ax + (row + 1 + 1e-9 - ay) * slope
        left, right = max(left, min(one, two)), min(right, max(one, two))
    return int(max(left - 1e-9, 0.0)), int(max(right + 1e-9, 0.0))


@inline
def _slot(row, column, mask):
    return (row * 73856093 + column * 19349663) & mask


@kernel
def _gather(points, segments, ends):
    """Write the coordinates of both ends of each segment; return their box and the sum of |dx| + |dy|."""
    x0 = y0 = np.inf
    x1 = y1 = -np.inf
    total = 0.0
    for s in range(segments.shape[0]):
        p, q = segments[s, 0], segments[s, 1]
        ax, ay, bx, by = points[p, 0], points[p, 1], points[q, 0], points[q, 1]
        ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3] = ax, ay, bx, by
        x0, y0, x1, y1 = min(x0, ax, bx), min(y0, ay, by), max(x1, ax, bx), max(y1, ay, by)
        total += abs(bx - ax) + abs(by - ay)
    return x0, y0, x1, y1, total


class Table(NamedTuple):
    """A grid of square cells, and a hash table of the cells that segments touch.

    The grid has its lowest corner at (x0, y0), ``scale`` cells per unit of length, and ``ny`` rows.
    """

    x0: float
    y0: float
    scale: float
    ny: int
    head: NDArray[np.int32]  # the last entry in each slot
    entries: NDArray[np.int32]  # row and column of a cell, a segment, the previous entry in the same slot
    seen: NDArray[np.int32]  # seen[t]: the last segment that t was compared with


@kernel
def _cell_pairs(ends, segments, table, looks, pairs):
    """Candidates that share a cell of a grid.

    Returns the number of pairs, of which as many as fit are written; or -1 if there are too many entries or
    more than ``looks`` comparisons. The table must be empty.
    """
    x0, y0, scale, ny, head, entries, seen = table
    used, count = 0, 0
    mask = head.shape[0] - 1
    for s in range(ends.shape[0]):
        first, last = _cell_range(ends, s, x0, y0, scale, ny, -1, 0)
        first = max(first, 0)
        for row in range(first, last + 1):
            left, right = _cell_range(ends, s, x0, y0, scale, ny, row, last - first + 1)
            for column in range(left, right + 1):
                slot = _slot(row, column, mask)
                e = head[slot]
                while e >= 0:
                    t = entries[e, 2]
                    looks -= 1
                    if seen[t] != s and entries[e, 0] == row and entries[e, 1] == column:
                        seen[t] = s
                        if may_meet(ends, segments, t, s):
                            if count < pairs.shape[0]:
                                pairs[count, 0], pairs[count, 1] = t, s
                            count += 1
                    e = entries[e, 3]
                if used == entries.shape[0] or looks < 0:
                    return -1
                entries[used, 0], entries[used, 1], entries[used, 2] = row, column, s
                entries[used, 3] = head[slot]
                head[slot] = used
                used += 1
    return count


@kernel
def none_meet(points, segments, alone):
    """Whether floating point proves it all: segments meet in common ends at most, and hold no lone vertex.

    Points are all different, no segment has zero length, ``alone`` are vertices that are no segment's end.
    False also where it would take more than one coarse look to tell.
    """
    s = segments.shape[0]
    ends = np.empty((s, 4))
    x0, y0, x1, y1, extent = _gather(points, segments, ends)
    if s <= FEW_SEGMENTS:
        for t in range(s):
            for u in range(t):
                if may_meet(ends, segments, u, t):
                    return False
            for v in alone:
                if may_hold(ends, t, points[v, 0], points[v, 1]):
                    return False
        return True
    cells, looks, most = TABLES[0]
    longer = max(x1 - x0, y1 - y0)
    if not 1e-140 < longer < 1e140 or extent * extent > most * s * (x1 - x0) * (y1 - y0):
        return False
    scale = cells * s / extent
    if longer * scale > 2.0**30:
        return False
    room = 2
    while room < 4 * cells * s:
        room *= 2
    head = fill(np.empty(room, dtype=np.int32), -1)
    entries = np.empty((int((4 + 2 * cells) * s), 4), dtype=np.int32)
    seen, none = fill(np.empty(s, dtype=np.int32), -1), np.empty((0, 2), dtype=np.int64)
    tall = int((y1 - y0) * scale) + 1
    table = Table(x0, y0, scale, tall, head, entries, seen)
    if _cell_pairs(ends, segments, table, looks * s, none) != 0:
        return False
    for v in alone:  # cells of segments overlap by more than rounding may move a point
        px, py = points[v, 0], points[v, 1]
        if not (x0 <= px <= x1 and y0 <= py <= y1):
            continue
        row, column = min(int((py - y0) * scale), tall - 1), int((px - x0) * scale)
        e = head[_slot(row, column, room - 1)]
        while e >= 0:
            if entries[e, 0] == row and entries[e, 1] == column and may_hold(ends, entries[e, 2], px, py):
                return False
            e = entries[e, 3]
    return True


@kernel
def _clear(points, segments):
    """Whether floating point proves that segments meet in common ends at most."""
    return none_meet(points, segments, np.empty(0, dtype=np.int32))


# ---------------------------------------------------------------------- a tree, for uneven lengths


@inline
def _apart(ax, ay, bx, by, low, high):
    """Whether a box certainly lies strictly on one side of the line ab; False in doubtful cases."""
    dx, dy = bx - ax, by - ay
    # Use the corners that are farthest to the left and to the right of the direction.
    left = dx * ((high[1] if dx > 0 else low[1]) - ay) - dy * ((low[0] if dy > 0 else high[0]) - ax)
    right = dx * ((low[1] if dx > 0 else high[1]) - ay) - dy * ((high[0] if dy > 0 else low[0]) - ax)
    wide, tall = abs(low[0] - ax) + abs(high[0] - ax), abs(low[1] - ay) + abs(high[1] - ay)
    slack = SLACK * (abs(dx) * tall + abs(dy) * wide) + 1e-290
    return left < -slack or right > slack


@kernel
def _tree_pairs(ends, segments, low, high, order, pairs):
    """Write the candidates that the tree of a `BoxTree` (four boxes per leaf) gives; return their number."""
    leaves = low.shape[0] // 2
    stack = np.empty(128, dtype=np.int64)
    count = 0
    for s in range(ends.shape[0]):
        ax, ay, bx, by = ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3]
        x0, x1, y0, y1 = min(ax, bx), max(ax, bx), min(ay, by), max(ay, by)
        top = 1
        stack[0] = 1
        while top > 0:
            top -= 1
            node = stack[top]
            l, h = low[node], high[node]
            if l[0] > x1 or h[0] < x0 or l[1] > y1 or h[1] < y0 or _apart(ax, ay, bx, by, l, h):
                continue
            if node < leaves:
                stack[top] = 2 * node
                stack[top + 1] = 2 * node + 1
                top += 2
                continue
            first = (node - leaves) * 4
            for i in range(first, min(first + 4, order.shape[0])):
                t = order[i]
                if t > s and may_meet(ends, segments, s, t):
                    if count < pairs.shape[0]:
                        pairs[count, 0], pairs[count, 1] = s, t
                    count += 1
    return count


# ---------------------------------------------------------------------- candidates, then exact signs


def _candidates(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Distinct pairs s < t that include all pairs that meet in more than a common end.

    In most inputs no segments meet. If cells are crowded, a sweep first finds out whether any pair meets.
    """
    nothing = np.empty((0, 2), dtype=np.int64)
    if len(segments) < 2:
        return nothing
    if len(segments) <= LOOKED_AT_ONCE and segments.dtype == np.int32 and points.flags.c_contiguous:
        # as arrays that cannot be written, for which validation has compiled it already
        points, segments = points.view(), segments.view()
        points.flags.writeable = segments.flags.writeable = False
        if _clear(points, segments):
            return nothing
    grid = _Grid(points, segments)
    for cells, looks, most in TABLES:
        pairs = grid.pairs(cells, looks) if grid.crowd < most else None
        if pairs is not None:
            return pairs
    if any_meeting(points, segments) is False:
        return nothing
    pairs = grid.pairs(*LAST_TABLE)
    return _tree_candidates(grid.ends, segments) if pairs is None else pairs


class _Grid:
    """Square cells over the box of some segments.

    ``crowd`` is how many segments would share a cell of their mean length if they were distributed evenly.
    """

    def __init__(self, points: np.ndarray, segments: np.ndarray):
        self.segments, self.ends = segments, np.empty((len(segments), 4))
        x0, y0, x1, y1, self.extent = _gather(points, segments, self.ends)
        self.low, self.wide, self.tall = (x0, y0), x1 - x0, y1 - y0
        area = max(self.wide, 1e-150) * max(self.tall, 1e-150) * len(segments)
        self.crowd: float = self.extent * (self.extent / area)

    def pairs(self, cells: float, looks: int) -> np.ndarray | None:
        """Candidates, with a cell size such that a segment of mean length spans ``cells`` cells.

        None if this takes more than ``looks`` comparisons per segment, or too many cells.
        """
        s, longer = len(self.ends), max(self.wide, self.tall)
        if not 1e-140 < longer < 1e140:
            return None
        scale = cells * s / self.extent
        if longer * scale > 2**30:
            return None
        head = np.full(2 ** int(np.ceil(np.log2(max(2, 4 * cells) * s))), -1, dtype=np.int32)
        entries = np.empty((int((4 + 2 * cells) * s), 4), dtype=np.int32)
        seen, pairs = np.full(s, -1, dtype=np.int32), np.empty((2 * s + 16, 2), dtype=np.int64)
        table = Table(*self.low, scale, int(self.tall * scale) + 1, head, entries, seen)
        while True:
            count = _cell_pairs(self.ends, self.segments, table, looks * s, pairs)
            if count < 0:
                return None
            if count <= len(pairs):
                return _sorted(pairs[:count], s)
            pairs = np.empty((count, 2), dtype=np.int64)
            head[:], seen[:] = -1, -1


def _tree_candidates(ends: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Candidates from a tree, which is suitable for any lengths."""
    tree = BoxTree(np.minimum(ends[:, :2], ends[:, 2:]), np.maximum(ends[:, :2], ends[:, 2:]))
    pairs = np.empty((2 * len(ends) + 16, 2), dtype=np.int64)
    count = _tree_pairs(ends, segments, tree.low, tree.high, tree.order, pairs)
    if count > len(pairs):
        pairs = np.empty((count, 2), dtype=np.int64)
        _tree_pairs(ends, segments, tree.low, tree.high, tree.order, pairs)
    return _sorted(pairs[:count], len(ends))


def _sorted(pairs: np.ndarray, s: int) -> np.ndarray:
    if len(pairs) == 0:
        return pairs
    keys = np.sort(pairs[:, 0] * s + pairs[:, 1])
    return np.column_stack([keys // s, keys % s])


def meetings(points: np.ndarray, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of segments that meet in more than a common end vertex, by exact signs.

    Parameters
    ----------
    points : (n, 2) float64
        Equal points are different vertices, so segments that end at equal points meet there.
    segments : (s, 2) int
        No segment may have zero length.

    Returns
    -------
    pairs : (c, 2) int64
        Rows of ``segments``, the smaller first, in lexicographic order.
    kind : (c,) int8
        1 if they cross inside both, 2 if an end of one is inside the other, 3 if they overlap along a line or
        are equal.

    Notes
    -----
    A grid is used if segments have similar lengths. Otherwise a sweep in O(s log s) first finds out whether
    any segments meet. If none do, the time is below a microsecond per segment.
    """
    pairs = _candidates(points, np.ascontiguousarray(segments))
    if len(pairs) == 0:
        return pairs, np.empty(0, dtype=np.int8)
    s, t = segments[pairs[:, 0]], segments[pairs[:, 1]]
    (p, q), (a, b) = s.T, t.T
    signs = np.stack(
        [orient_rows(points, np.column_stack(v)) for v in ((p, q, a), (p, q, b), (a, b, p), (a, b, q))]
    )
    kind = np.zeros(len(pairs), dtype=np.int8)
    across, back = signs[0] * signs[1], signs[2] * signs[3]
    shared = (s[:, :, None] == t[:, None, :]).any(axis=(1, 2))
    kind[(across < 0) & (back < 0)] = CROSSING
    kind[(across <= 0) & (back <= 0) & (kind == 0) & ~shared] = TOUCHING
    flat = np.nonzero((signs == 0).all(axis=0))[0]
    if len(flat):
        p, q = _ordered(*points[s[flat]].transpose(1, 0, 2))
        a, b = _ordered(*points[t[flat]].transpose(1, 0, 2))
        start, end = np.where(_before(p, a)[:, None], a, p), np.where(_before(q, b)[:, None], q, b)
        apart = np.where(shared[flat] | _before(end, start), 0, TOUCHING)
        kind[flat] = np.where(_before(start, end), OVERLAPPING, apart)
    return pairs[kind > 0], kind[kind > 0]


def _before(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Whether p < q lexicographically; for points on a line this is their order along it."""
    return (p[..., 0] < q[..., 0]) | ((p[..., 0] == q[..., 0]) & (p[..., 1] < q[..., 1]))


def _ordered(p: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    swap = _before(q, p)[:, None]
    return np.where(swap, q, p), np.where(swap, p, q)


def vertices_on_segments(points: np.ndarray, vertices: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Rows (vertex, segment) with the vertex strictly between the ends of the segment; exact."""
    if len(vertices) == 0 or len(segments) == 0:
        return np.empty((0, 2), dtype=np.int64)
    ends, at = points[segments], points[vertices]
    query, hit = BoxTree(ends.min(axis=1), ends.max(axis=1)).pairs(at, at)
    v, rows = vertices[query], segments[hit]
    own = (rows == v[:, None]).any(axis=1)
    v, rows, hit = v[~own], rows[~own], hit[~own]
    flat = orient_rows(points, np.column_stack([rows, v])) == 0
    return np.column_stack([v[flat], hit[flat]])
