"""The size of the rest: that of the envelope's edges, growing from there, and nowhere above the given one."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...geometry.segment_tree import SegmentTree
from ...sizing.field import SizeField, as_size
from ...sizing.table import CHILD, CORNERS, FIRST_LEVELS, FRESH, RESOLVED, SizeTable, box_of, table_of

__all__ = ["FILL_GROWTH", "MatchedSize", "matched_size"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
FILL_GROWTH = 0.2  # of the size with the distance from the envelope
COARSE = 0.15  # the relative tolerance of a table of the matched size
MIDDLES = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])  # which of the places `FRESH` leaves may have
BROADEST = 2.0  # wanted edge lengths: larger leaves are divided in any case


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

    def least(self, x: Array, bound: Array, reach: Array) -> tuple[Array, Array, Integers]:
        """The size at points x, where the given one is at least ``bound``; a better such bound; the edge.

        The bounds tell of all points within ``reach`` of x whether the given size matters there.
        """
        found, edge = self.tree.least(x, FILL_GROWTH)
        rows = np.flatnonzero(bound < found)
        bound = bound.copy()
        enough = found[rows] + (FILL_GROWTH + (self.given.growth or 0.0)) * reach[rows]
        bound[rows] = self.given.below(x[rows], enough)
        return np.minimum(found, bound), bound, edge

    def behind(self, x: Array, edge: Integers, far: float) -> NDArray[np.bool_]:
        """Which points are on the right of these edges, opposite them, and so far away."""
        a, b = self.ends[edge].transpose(1, 0, 2)
        side, away = b - a, x - a
        along, square = (side * away).sum(axis=1), (side * side).sum(axis=1)
        cross = side[:, 0] * away[:, 1] - side[:, 1] * away[:, 0]
        return (along >= 0.0) & (along <= square) & (cross < -far * np.sqrt(square))

    def table(
        self, lower: ArrayLike, upper: ArrayLike, *, factor: float = 1.0, tolerance: float = COARSE,
        max_depth: int = 24, max_nodes: int = 1_000_000,
    ) -> SizeTable:  # fmt: skip
        """As `SizeField.table`, but coarser, and from fewer values.

        The size changes by no more than its growth in a unit of length. So a leaf that is not larger than
        some wanted edge lengths cannot hide much, and it is judged by its middle alone. Only leaves that are
        divided need values at other places, and the given size is asked for only where it may be less than
        that of the envelope. Leaves within layers or bodies stay large.
        """
        tolerance = max(tolerance, COARSE)
        if self.growth is None:
            return super().table(
                lower, upper, factor=factor, tolerance=tolerance, max_depth=max_depth, max_nodes=max_nodes
            )
        box = box_of(lower, upper, factor, tolerance)
        span, change = box[1] - box[0], self.given.growth or 0.0

        def at(place: Array, bound: Array, reach: Any) -> tuple[Array, Array, Integers]:
            """The sizes at relative coordinates; ``reach`` is in units of the diagonal of the box."""
            x = np.minimum(box[0] + place.reshape(-1, 2) * span, box[1])
            far = np.broadcast_to(np.hypot(*span) * reach, bound.shape).ravel()
            values, better, edges = self.least(x, bound.ravel(), far)
            return values.reshape(bound.shape), better.reshape(bound.shape), edges.reshape(bound.shape)

        blocks, child, place, (middle, bound, edge) = self._first(at)
        worst, count, values = 0.0, sum(map(len, blocks)), blocks[-1]
        away = change * np.hypot(*((FRESH - 0.5) * span).T)
        for depth in range(FIRST_LEVELS, max_depth + 1):
            side = 0.5**depth
            length = side * span.max()
            error = np.abs(values.mean(axis=1) / middle - 1.0)
            divide = (error > tolerance) | (length > BROADEST * middle)
            divide &= length > RESOLVED * np.minimum(middle, values.min(axis=1))
            divide[divide] = ~self.behind(
                box[0] + (place[divide] + 0.5) * side * span, edge[divide], side / 2 * np.hypot(*span)
            )
            divide &= (depth < max_depth) & (count + 4 * int(divide.sum()) <= max_nodes)
            worst = max(worst, float(error[~divide].max(initial=0.0)))
            rows = np.flatnonzero(divide)
            child[-1][:] = -1
            if not len(rows):
                break
            child[-1][rows] = count + 4 * np.arange(len(rows))
            probes, better, edges = at(
                (place[rows, None] + FRESH) * side, bound[rows, None] - side * away, side / 4 * MIDDLES
            )  # fmt: skip
            known = np.concatenate([values[rows], middle[rows, None], probes[:, :4]], axis=1)
            values, middle = known[:, CHILD].reshape(-1, 4), probes[:, 4:].ravel()
            bound, edge = better[:, 4:].ravel(), edges[:, 4:].ravel()
            place = (2 * place[rows, None] + CORNERS).reshape(-1, 2)
            blocks.append(values)
            child.append(np.empty(len(values), dtype=np.int64))
            count += len(values)
        capped = {"resolved": 0, "depth": 0, "nodes": 0}
        return table_of(blocks, np.concatenate(child), box, factor, worst, capped)

    def _first(self, at: Any) -> tuple[list[Array], list[Integers], Integers, list[Any]]:
        """The first levels: values and children by level; of the last one places and the middles."""
        many = 1 << FIRST_LEVELS
        lattice = np.arange(2 * many + 1) / (2 * many)
        corner, center = (
            at(np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1), np.full((len(t), len(t)), -np.inf), reach)
            for t, reach in ((lattice[::2], 0.0), (lattice[1::2], 0.5 / many))
        )
        blocks, child = [], []
        place, count = np.zeros((1, 2), dtype=np.int64), 0
        for depth in range(FIRST_LEVELS + 1):
            if depth:
                place = (2 * place[:, None] + CORNERS).reshape(-1, 2)
            i, j = ((place[:, None] + CORNERS) << (FIRST_LEVELS - depth)).transpose(2, 0, 1)
            blocks.append(corner[0][i, j])
            count += len(place)
            child.append(count + 4 * np.arange(len(place)))
        i, j = place.T
        return blocks, child, place, [one[i, j] for one in center]


def matched_size(size: Any, points: Array, top: Integers) -> SizeField:
    """The size of the rest: that of the envelope's edges, growing from there, and nowhere above ``size``."""
    return MatchedSize(as_size(size), points[top])


def _matched(tree: SegmentTree, size: SizeField, x: Array) -> Array:
    """The minimum; the tree looks only for what is below the size."""
    return tree.least(x, FILL_GROWTH, size(x))[0]
