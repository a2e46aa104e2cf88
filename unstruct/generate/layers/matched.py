"""The size of the rest: that of the envelope's edges, growing from there, and nowhere above the given one."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...geometry.segment_search import Searched
from ...geometry.segment_tree import SegmentTree
from ...sizing.field import SizeField, as_size
from ...sizing.table import FIRST_LEVELS, FRESH, SizeTable, box_of, table_of
from .matched_levels import (
    Asked,
    Level,
    Limits,
    divide,
    judge,
    lattice,
    lay_out,
    measure,
    probe,
    room_for_level,
    room_to_ask,
)

__all__ = ["FILL_GROWTH", "MatchedSize", "matched_size"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
FILL_GROWTH = 0.2  # of the size with the distance from the envelope
COARSE = 0.15  # the relative tolerance of a table of the matched size


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
        length, middles = np.empty(len(ends)), np.empty((len(ends), 2))
        measure(ends, length, middles)
        self.given, self.ends, self.tree = given, ends, SegmentTree(ends, length)
        known = given.growth if given.constant is None else 0.0
        marks = [middles, *([given.landmarks] if len(given.landmarks) else [])]
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
        limits = Limits(float(self.given.most), float(self.growth), float(tolerance), far)
        searched = self.tree.searched(FILL_GROWTH)
        above, level, middles, many = self._first(box, searched, limits)
        blocks, child, worst = [above, level.values], [4 * np.arange(len(above)) + 1], np.zeros(1)
        count = len(above) + len(level.place)
        for depth in range(FIRST_LEVELS, max_depth + 1):
            side, room = 0.5**depth, 0 if depth == max_depth else (max_nodes - count) // 4
            first, rows = np.empty((2, len(level.place)), dtype=np.int64)
            child.append(first)
            frame, written = (box, side, self.ends, limits.tolerance, (count, room)), (first, rows, worst)
            many = judge(level, (middles.rows[:many], self._given(middles, many)), frame, written)
            if many < 0:
                self._find_edges(level, rows[:-many], box, side)
                many = judge(level, (rows[:0], worst[:0]), frame, written)
            if not many:
                break
            rows, sides, middles = rows[:many], room_to_ask(4 * many), room_to_ask(4 * many)
            made, seen = room_for_level(4 * many), np.empty(1 << (8 * many).bit_length(), dtype=np.int64)
            ways = box, side, away
            many = probe(level, (rows, seen), ways, searched, limits, sides)
            probed = sides, self._given(sides, many)
            many = divide(level, rows, ways, searched, limits, probed, made, middles)
            level, count = made, count + len(made.place)
            blocks.append(level.values)
        capped = {"resolved": 0, "depth": 0, "nodes": 0}
        return table_of(blocks, np.concatenate(child), box, factor, float(worst[0]), capped)

    def _first(self, box: Array, searched: Searched, limits: Limits) -> tuple[Array, Level, Asked, int]:
        """Sizes of the first levels; the last of these; the places where the given size is wanted next."""
        leaves = 1 << 2 * FIRST_LEVELS
        corners, middles = room_to_ask(((1 << FIRST_LEVELS) + 1) ** 2), room_to_ask(leaves)
        above, level = np.empty((leaves // 3, 4)), room_for_level(leaves)
        many = lattice(box, searched, limits, corners)
        given = self._given(corners, many)
        return above, level, middles, lay_out(corners, given, box, searched, limits, above, level, middles)

    def _given(self, asked: Asked, many: int) -> Array:
        """The given size at the places where it is wanted, as far as it matters."""
        return self.given.below(asked.places[:many], asked.enough[:many]) if many else asked.enough[:0]

    def _find_edges(self, level: Level, rows: Integers, box: Array, side: float) -> None:
        """Find the edges of the middles of some leaves where they were too far away to matter."""
        rows = rows[level.edge[rows] < 0]
        middle = box[0] + (level.place[rows] + 0.5) * side * (box[1] - box[0])
        level.edge[rows] = self.tree.lower(middle, FILL_GROWTH, np.full(len(middle), np.inf))


def matched_size(size: Any, points: Array, top: Integers) -> SizeField:
    """The size of the rest: that of the envelope's edges, growing from there, and nowhere above ``size``."""
    return MatchedSize(as_size(size), points[top])


def _matched(tree: SegmentTree, size: SizeField, x: Array) -> Array:
    """The minimum; the tree looks only for what is below the size."""
    found = size(x)
    tree.lower(x, FILL_GROWTH, found)
    return found
