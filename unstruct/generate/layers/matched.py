"""The size of the rest: that of the envelope's edges, growing from there, and nowhere above the given one."""

from __future__ import annotations

import math
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.jit import inline, kernel, lean
from ...geometry.segment_tree import SegmentTree
from ...sizing.field import SizeField, as_size
from ...sizing.table import CHILD, CORNERS, FIRST_LEVELS, FRESH, RESOLVED, SizeTable, box_of, table_of

__all__ = ["FILL_GROWTH", "MatchedSize", "is_behind", "matched_size"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
FILL_GROWTH = 0.2  # of the size with the distance from the envelope
COARSE = 0.15  # the relative tolerance of a table of the matched size
BROADEST = 2.0  # wanted edge lengths: larger leaves are divided in any case
WITHIN_ROUNDING = 1.0 - 1e-9  # far more than rounding
SPREAD = 73856093, 19349663  # numbers that spread places over a table


class MatchedSize(SizeField):
    """The size matched to an envelope: it has many kinks, of which a table need not resolve each.

    Parameters
    ----------
    given : SizeField
    ends : (e, 2, 2) float64
        The edges of the envelope, with the rest on their left.
    """

    thorough = False

    def __init__(self, given: SizeField, ends: Array):
        length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
        self.given, self.ends, self.tree = given, ends, SegmentTree(ends, length)
        known = given.growth if given.constant is None else 0.0
        marks = [ends.mean(axis=1), *([given.landmarks] if len(given.landmarks) else [])]
        super().__init__(
            partial(_matched, self.tree, given), landmarks=np.concatenate(marks), name="matched to layers",
            growth=None if known is None else max(known, FILL_GROWTH),
        )  # fmt: skip

    def table(
        self, lower: ArrayLike, upper: ArrayLike, *, factor: float = 1.0, tolerance: float = COARSE,
        max_depth: int = 24, max_nodes: int = 1_000_000,
    ) -> SizeTable:  # fmt: skip
        """As `SizeField.table`, but coarser, and from fewer values.

        The size changes by no more than its growth in a unit of length. So a leaf that is not larger than
        some wanted edge lengths cannot hide much, and it is judged by its middle alone; where its corners
        tell that any middle would do, not even by that. (`error` is the largest one that was seen.) Only
        leaves that are divided need values at other places, once for two neighbors, and the given size is
        asked for only where it may be less than that of the envelope. Edges so far away that they give more
        than the given size can be anywhere are not looked for. Leaves within layers or bodies stay large.
        """
        tolerance = max(tolerance, COARSE)
        if self.growth is None:
            return super().table(
                lower, upper, factor=factor, tolerance=tolerance, max_depth=max_depth, max_nodes=max_nodes
            )
        box = box_of(lower, upper, factor, tolerance)
        span, change = box[1] - box[0], self.given.growth or 0.0
        far = (FILL_GROWTH + change) * float(np.hypot(*span))
        away = change * np.hypot(*((FRESH - 0.5) * span).T)
        blocks, child, level = self._first(box, far, tolerance)
        count, worst = sum(map(len, blocks)), np.zeros(1)
        for depth in range(FIRST_LEVELS, max_depth + 1):
            side = 0.5**depth
            most = 0 if depth == max_depth else (max_nodes - count) // 4
            rows = np.empty(len(level.place), dtype=np.int64)
            asked = level, box, side, self.ends, tolerance, (count, most), child[-1], (rows, worst)
            many = _judge(*asked)
            if many < 0:
                self._find_edges(level, rows[:-many], box, side)
                many = _judge(*asked)
            if not many:
                break
            level = self._divided(level, rows[:many], (box, side, away), far, tolerance)
            blocks.append(level.values)
            child.append(np.empty(4 * many, dtype=np.int64))
            count += 4 * many
        capped = {"resolved": 0, "depth": 0, "nodes": 0}
        return table_of(blocks, np.concatenate(child), box, factor, float(worst[0]), capped)

    def _divided(
        self, level: Level, rows: Integers, frame: tuple[Array, float, Array], far: float, tolerance: float
    ) -> Level:
        """The children of some leaves.

        ``frame`` is the box, their side, and how much the given size may change from their middles to the
        places `FRESH`, in units of the side.
        """
        box, side, away = frame
        many = 4 * len(rows)
        x, bound, same = np.empty((many, 2)), np.empty(many), np.empty(many, dtype=np.int64)
        seen = np.full(1 << (2 * many).bit_length(), -1, dtype=np.int64)
        n = _probe(level, rows, box, side, away, x, bound, (same, seen))
        found, bound, _ = self._least(x[:n], bound[:n], 0.0)
        made = _level(many)
        _divide(level, rows, (found, bound, same), side, away, made)
        self._ask_middles(made, box, side / 2, far * side / 4, tolerance)
        return made

    def _ask_middles(self, level: Level, box: Array, side: float, reach: float, tolerance: float) -> None:
        """Find the sizes at the middles of leaves, but for those that stay whatever they are."""
        many = len(level.place)
        rows, x = np.empty(many, dtype=np.int64), np.empty((many, 2))
        n = _doubtful(level, box, side, self.growth, tolerance, rows, x)
        rows = rows[:n]
        found, bound, edge = self._least(x[:n], level.bound[rows], reach)
        level.middle[rows], level.bound[rows], level.edge[rows] = np.minimum(found, bound), bound, edge

    def _least(self, x: Array, bound: Array, far: float) -> tuple[Array, Array, Integers]:
        """The sizes of the envelope at some points, what the given size is at least there, and the edges.

        The given size is at least ``bound``. It is not asked for where that is not less than the size of the
        envelope; where it is more by ``far``, which is enough for all of a leaf, it is not needed exactly.
        """
        found, edge = self._of_edges(x, self.given.most)
        ask, enough = np.empty(len(x), dtype=np.int64), np.empty(len(x))
        many = _ask(found, bound, far, ask, enough)
        if many == len(x):
            bound = self.given.below(x, enough)
        elif many:
            bound[ask[:many]] = self.given.below(x[ask[:many]], enough[:many])
        return found, bound, edge

    def _of_edges(self, x: Array, most: float) -> tuple[Array, Integers]:
        """The sizes that the edges give, up to ``most``, and the edges that give them; -1 for no edge."""
        found = np.full(len(x), most)
        return found, self.tree.lower(x, FILL_GROWTH, found)

    def _find_edges(self, level: Level, rows: Integers, box: Array, side: float) -> None:
        """Find the edges of the middles of some leaves where they were too far away to matter."""
        rows = rows[level.edge[rows] < 0]
        middle = box[0] + (level.place[rows] + 0.5) * side * (box[1] - box[0])
        level.edge[rows] = self._of_edges(middle, np.inf)[1]

    def _first(self, box: Array, far: float, tolerance: float) -> tuple[list[Array], list[Integers], Level]:
        """The first levels: values and children by level; and the last one."""
        many = 1 << FIRST_LEVELS
        x = np.empty(((many + 1) * (many + 1), 2))
        _lattice(box, np.arange(many + 1) / many, x)
        found, bound, _ = self._least(x, np.zeros(len(x)), 0.0)
        sizes = np.minimum(found, bound)
        levels = [_level(4**depth) for depth in range(FIRST_LEVELS + 1)]
        child, count = [], 0
        for depth, level in enumerate(levels):
            _lay_out(levels[max(depth - 1, 0)], depth, sizes, level)
            count += len(level.place)
            child.append(count + 4 * np.arange(len(level.place)))
        self._ask_middles(levels[-1], box, 1.0 / many, far / 2 / many, tolerance)
        return [level.values for level in levels], child, levels[-1]


class Level(NamedTuple):
    """The leaves of one depth.

    Attributes
    ----------
    place : (m, 2) int64
        Integer coordinates of the lower corner, in units of the side of a leaf.
    values : (m, 4) float64
        Sizes at the corners.
    middle, bound : (m,) float64
        The size at the middle, and what the given size is at least there. The first is 0 where it is not
        known because the leaf stays whatever it is.
    edge : (m,) int64
        The edge that the middle has its size from; -1 if all give more than the given size can be.
    """

    place: Integers
    values: Array
    middle: Array
    bound: Array
    edge: Integers


def _level(many: int) -> Level:
    """Room for so many leaves."""
    return Level(
        np.empty((many, 2), dtype=np.int64), np.empty((many, 4)), np.empty(many), np.empty(many),
        np.empty(many, dtype=np.int64),
    )  # fmt: skip


@kernel
def _lattice(box, t, x):
    """Write a lattice of places in a box, from coordinates between 0 and 1 that both axes have."""
    many = len(t)
    for i in range(many):
        for k in range(many):
            x[i * many + k, 0] = min(box[0, 0] + t[i] * (box[1, 0] - box[0, 0]), box[1, 0])
            x[i * many + k, 1] = min(box[0, 1] + t[k] * (box[1, 1] - box[0, 1]), box[1, 1])


@kernel
def _lay_out(above, depth, corners, level):
    """Fill a level of the first ones from the level above, and from a lattice of corners."""
    shift = FIRST_LEVELS - depth
    side = 1 << FIRST_LEVELS
    for i in range(len(level.place)):
        for k in range(2):
            level.place[i, k] = 2 * above.place[i // 4, k] + (i % 4 >> k & 1) if depth > 0 else 0
        u, v = level.place[i, 0], level.place[i, 1]
        for k in range(4):
            level.values[i, k] = corners[(u + (k & 1) << shift) * (side + 1) + (v + (k >> 1) << shift)]
        level.bound[i] = 0.0


@inline
def is_behind(ends, edge, x, y, far):
    """Whether a point is on the right of an edge, opposite it, and so far away; no edge is -1."""
    if edge < 0:
        return False
    ux, uy = ends[edge, 1, 0] - ends[edge, 0, 0], ends[edge, 1, 1] - ends[edge, 0, 1]
    vx, vy = x - ends[edge, 0, 0], y - ends[edge, 0, 1]
    along, square = ux * vx + uy * vy, ux * ux + uy * uy
    return 0.0 <= along <= square and ux * vy - uy * vx < -far * math.sqrt(square)


@inline
def _error(level, i):
    """The relative error of a leaf at its middle."""
    values = level.values
    total = 0.0 + values[i, 0] + values[i, 1] + values[i, 2] + values[i, 3]
    return abs(total / 4 / level.middle[i] - 1.0)


@inline
def _must_divide(level, i, box, side, ends, tolerance):
    """Whether a leaf is to be divided."""
    if level.middle[i] == 0.0:
        return False
    wide, tall = box[1, 0] - box[0, 0], box[1, 1] - box[0, 1]
    length, far, middle = side * max(wide, tall), side / 2 * math.hypot(wide, tall), level.middle[i]
    if not (length > BROADEST * middle or _error(level, i) > tolerance):
        return False
    least = middle
    for k in range(4):
        least = min(least, level.values[i, k])
    if not length > RESOLVED * least:
        return False
    x = box[0, 0] + (level.place[i, 0] + 0.5) * side * wide
    y = box[0, 1] + (level.place[i, 1] + 0.5) * side * tall
    return not is_behind(ends, level.edge[i], x, y, far)


@lean
def _judge(level, box, side, ends, tolerance, numbers, child, found):
    """Write which leaves are to be divided, and the first children of all; returns how many are divided.

    ``numbers`` are the number of the next node and how many leaves may be divided: if there are more, none
    is. ``found`` gets their rows and, in one entry, the largest error of those that stay. Where the edge of
    some of these rows is not known, nothing else is written, and their number is returned as a negative one.
    """
    count, most = numbers
    rows, worst = found
    many, known = 0, True
    for i in range(len(child)):
        if _must_divide(level, i, box, side, ends, tolerance):
            rows[many], known = i, known and level.edge[i] >= 0
            many += 1
    if not known:
        return -many
    if many > most:
        many = 0
    next_row = 0
    for i in range(len(child)):
        if next_row < many and rows[next_row] == i:
            child[i] = count + 4 * next_row
            next_row += 1
        else:
            child[i] = -1
            if level.middle[i] > 0.0:
                worst[0] = max(worst[0], _error(level, i))
    return many


@lean
def _doubtful(level, box, side, growth, tolerance, rows, x):
    """Write the leaves that some middle would divide, and their middles; returns how many there are.

    The others get the size 0 there.
    """
    wide, tall = box[1, 0] - box[0, 0], box[1, 1] - box[0, 1]
    length, reach = side * max(wide, tall), growth * side / 2 * math.hypot(wide, tall)
    many = 0
    for i in range(len(level.place)):
        values = level.values
        mean = (0.0 + values[i, 0] + values[i, 1] + values[i, 2] + values[i, 3]) / 4
        low = min(values[i, 0], values[i, 1], values[i, 2], values[i, 3])
        least, most = max(values[i, 0], values[i, 1], values[i, 2], values[i, 3]) - reach, low + reach
        even = (
            length <= WITHIN_ROUNDING * BROADEST * least
            and mean <= WITHIN_ROUNDING * (1.0 + tolerance) * least
        )
        small = length <= WITHIN_ROUNDING * RESOLVED * min(low, least)
        if small or (even and WITHIN_ROUNDING * mean >= (1.0 - tolerance) * most):
            level.middle[i] = 0.0
            continue
        rows[many] = i
        for j in range(2):
            place = (level.place[i, j] + 0.5) * side
            x[many, j] = min(box[0, j] + place * (box[1, j] - box[0, j]), box[1, j])
        many += 1
    return many


@lean
def _probe(level, rows, box, side, away, x, bound, numbers):
    """Write the middles of the sides of leaves that are divided, and what the given size is at least there.

    A side that two of them have is written once; returns how many there are. ``numbers`` are the number of
    the middle for each side of each leaf, which is written, and room to look middles up, filled with -1.
    """
    same, seen = numbers
    many, last = 0, len(seen) - 1
    for r in range(len(rows)):
        i = rows[r]
        for k in range(4):
            u, v = level.place[i, 0] + FRESH[k, 0], level.place[i, 1] + FRESH[k, 1]
            u_at = min(box[0, 0] + u * side * (box[1, 0] - box[0, 0]), box[1, 0])
            v_at = min(box[0, 1] + v * side * (box[1, 1] - box[0, 1]), box[1, 1])
            at = (int(2.0 * u) * SPREAD[0] ^ int(2.0 * v) * SPREAD[1]) & last
            while seen[at] >= 0 and (x[seen[at], 0] != u_at or x[seen[at], 1] != v_at):
                at = (at + 1) & last
            least = level.bound[i] - side * away[k]
            if seen[at] < 0:
                seen[at] = many
                x[many, 0], x[many, 1], bound[many] = u_at, v_at, least
                many += 1
            same[4 * r + k] = seen[at]
            bound[seen[at]] = max(bound[seen[at]], least)
    return many


@lean
def _ask(found, bound, far, ask, enough):
    """Write for which points the given size is to be asked, and up to which size it matters; their number."""
    many = 0
    for i in range(len(found)):
        if bound[i] < found[i]:
            ask[many], enough[many] = i, found[i] + far
            many += 1
    return many


@kernel
def _divide(level, rows, probed, side, away, made):
    """Fill the leaves that some leaves are divided into, but for what is known from their middles.

    ``probed`` are both sizes at the middles of sides, and the numbers that `_probe` has written.
    """
    found, bound, same = probed
    known = np.empty(9)
    for r in range(len(rows)):
        i = rows[r]
        for k in range(4):
            j = same[4 * r + k]
            known[k], known[5 + k] = level.values[i, k], min(found[j], bound[j])
        known[4] = level.middle[i]
        for c in range(4):
            child = 4 * r + c
            made.bound[child], made.edge[child] = level.bound[i] - side * away[4 + c], -1
            for k in range(4):
                made.values[child, k] = known[CHILD[c, k]]
            for j in range(2):
                made.place[child, j] = 2 * level.place[i, j] + CORNERS[c, j]


def matched_size(size: Any, points: Array, top: Integers) -> SizeField:
    """The size of the rest: that of the envelope's edges, growing from there, and nowhere above ``size``."""
    return MatchedSize(as_size(size), points[top])


def _matched(tree: SegmentTree, size: SizeField, x: Array) -> Array:
    """The minimum; the tree looks only for what is below the size."""
    found = size(x)
    tree.lower(x, FILL_GROWTH, found)
    return found
