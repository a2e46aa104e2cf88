"""Cutting pieces by a size: whole numbers of subsegments, at equal steps of the integral of ds / size.

With a metric the size is that in the direction of the piece; the integral is the metric length of the piece.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from ...base.errors import InputError
from ...base.jit import kernel
from ...geometry.outline import Outline
from ...sizing.metric import Metric
from ...sizing.space_metric import SpaceMetric
from .by_region import PieceSizes, piece_sizes, size_or_metric
from .prescribed import recut
from .sample import Sampled, safe

__all__ = ["Pieces", "Wanted", "evenly", "sized"]

METRIC_PARTS = 128  # a metric is looked at in so many parts of a straight piece of the size of the domain
MOST_SUBSEGMENTS = 1 << 25  # a size that asks for more subsegments is too small
# A size is too rough if its integral needs more parameter intervals at once than `STRETCH`, and more than
# `STRETCH_SHARE` for each piece.
STRETCH = 1 << 20
STRETCH_SHARE = 64


class Pieces(Protocol):
    """What has straight or curved pieces between points: an `Outline`, or edges in space."""

    @property
    def pieces(self) -> Any:
        """The vertices of each piece."""

    @property
    def curves(self) -> Any:
        """The pieces that are curved, by number."""

    @property
    def spacings(self) -> Any:
        """The pieces that are not measured, by number."""

    @property
    def points(self) -> np.ndarray:
        """The vertices."""

    def points_at(self, piece: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Points of many pieces by parameters."""

    def at(self, piece: int, t: Any) -> np.ndarray:
        """Points of one piece."""

    def name(self, piece: int) -> str:
        """What messages call a piece."""


class Wanted(Protocol):
    """Sizes along pieces: `PieceSizes`, or those along edges in space."""

    @property
    def fields(self) -> Sequence[Any]:
        """The fields from which they come."""

    def at(self, piece: np.ndarray, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """The sizes at points of pieces, in directions."""

    def even(self) -> np.ndarray:
        """For which pieces they are constant."""


def sized(outline: Outline, size: Any, step: float, coarse: Callable[[], Sampled]) -> Sampled:
    """The subsegments of all pieces by a size, or by sizes of regions; ``coarse`` cuts without a size.

    Spaced pieces have the points that are given for them, whatever the size is there.
    """
    if len(outline.pieces) == 0:
        return coarse()
    if isinstance(size, Mapping):
        wanted = piece_sizes(outline, coarse(), size)
    else:
        wanted = PieceSizes([size_or_metric(size)], np.zeros(len(outline.pieces), dtype=np.int64))
    owner, t0, t1 = evenly(outline, wanted, step)
    without = [g for g, field in enumerate(wanted.fields) if field is None]
    if without:
        owner, t0, t1 = _as_in(coarse(), np.isin(wanted.group, without), owner, t0, t1)
    # Where all pieces have sizes, those that are spaced have been kept whole.
    given = {p: t for p, t in outline.spacings.items() if len(t) > 2 or without}
    if given:
        owner, t0, t1 = recut(given, owner, t0, t1)
    return safe(outline, owner, t0, t1, np.inf)


def evenly(outline: Pieces, wanted: Wanted, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whole numbers of parameter intervals (piece, t0, t1) for pieces in the plane or in space.

    Parameters
    ----------
    outline : Outline, or what has its points, pieces, curves, spacings, points_at, at and name
    wanted : PieceSizes, or what has its fields, at and even
    step : float
        How much of the integral of ds / size one interval should have.
    """
    piece, t, total = _table(outline, wanted)
    start = np.searchsorted(piece, np.arange(len(outline.pieces)))
    begin = total[start]
    amount = np.append(begin[1:], total[-1]) - begin if len(start) else np.empty(0)
    if amount.sum() / step > MOST_SUBSEGMENTS:
        raise InputError(_too_small(outline, int(np.argmax(amount)), 0.5))
    count = np.maximum(np.rint(amount / step), 1).astype(np.int64)
    even = wanted.even()
    if outline.curves:
        even[list(outline.curves)] = False
    many = int(count.sum())
    owner, numbers = np.empty(many, dtype=np.int64), np.empty((4, many))
    share, place, t0, t1 = numbers
    _divide_evenly(count, begin, amount, owner, share, place)
    _join_evenly(even, owner, share, np.interp(place, total, piece + t), t0, t1)
    return owner, t0, t1


@kernel
def _divide_evenly(count, begin, amount, owner, share, place):
    """Write where subsegments begin: the piece, the share of it, and the integral up to there."""
    at = 0
    for p in range(len(count)):
        for j in range(count[p]):
            owner[at], share[at] = p, j / count[p]
            place[at] = begin[p] + share[at] * amount[p]
            at += 1


@kernel
def _join_evenly(even, owner, share, found, t0, t1):
    """Write the parameters of subsegments that follow each other; ``found`` are those of uneven pieces."""
    many = len(owner)
    for i in range(many):
        first = i == 0 or owner[i - 1] != owner[i]
        t0[i] = 0.0 if first else share[i] if even[owner[i]] else found[i] - owner[i]
        t1[i] = 1.0
        if not first:
            t1[i - 1] = t0[i]


def _as_in(
    sampled: Sampled, pieces: np.ndarray, piece: np.ndarray, t0: np.ndarray, t1: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The parameter intervals (piece, t0, t1), those of ``pieces`` (a mask) replaced by the sampled ones."""
    new, old = pieces[sampled.piece], ~pieces[piece]
    owner = np.concatenate([piece[old], sampled.piece[new]])
    t0 = np.concatenate([t0[old], sampled.span[new, 0]])
    t1 = np.concatenate([t1[old], sampled.span[new, 1]])
    order = np.lexsort((t0, owner))
    return owner[order], t0[order], t1[order]


def _table(outline: Pieces, size: Wanted) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples (piece, t) in order, with the integral of ds / size over all pieces up to each sample.

    Intervals are halved until their halves are nearly equal and agree with the whole, or far below a step.
    A row of an interval has its parameters, the points at its start, middle and end, and the size at the
    middle.
    """
    many = len(outline.pieces)
    parts = np.ones(many, dtype=np.int64)
    parts[list(outline.curves)] = 16
    parts[np.fromiter(outline.spacings, dtype=np.int64)] = 0
    if any(isinstance(one, (Metric, SpaceMetric)) for one in size.fields):
        # Along a piece that a layer crosses, a metric is fine in a short part only.
        a, b = outline.points[outline.pieces].transpose(1, 0, 2)
        share = np.abs(b - a).max(axis=1) / np.ptp(outline.points, axis=0).max()
        parts = np.maximum(parts, np.ceil(METRIC_PARTS * share).astype(np.int64))
    many = int(parts.sum())
    piece, t, rows = np.empty((3, many), dtype=np.int64), np.empty((3, many)), np.empty((many, 9))
    _lay_parts(parts, piece, t)
    x = outline.points_at(piece.ravel(), t.ravel())
    piece, along = piece[0], np.empty((many, 2))
    _begin(t, x, rows, along)
    rows[:, 8] = size.at(piece, x[many : 2 * many], along)
    done: list[tuple[np.ndarray, np.ndarray]] = []
    while len(piece):
        many = len(piece)
        both, quarters, along = (
            np.empty(2 * many, dtype=np.int64),
            np.empty(2 * many),
            np.empty((2 * many, 2)),
        )
        _quarter(rows, piece, both, quarters, along)
        x = outline.points_at(both, quarters)
        h = size.at(both, x, along)
        ended, ended_piece = np.empty((many, 3)), np.empty(many, dtype=np.int64)
        halves, halves_piece = np.empty((2 * many, 9)), np.empty(2 * many, dtype=np.int64)
        enough = _halve_uneven(rows, piece, x, h, ended, ended_piece, halves, halves_piece)
        done.append((ended_piece[:enough], ended[:enough]))
        rest = 2 * (len(piece) - enough)
        rows, piece = halves[:rest], halves_piece[:rest]
        if len(piece) > max(STRETCH, STRETCH_SHARE * len(outline.pieces)):
            raise InputError(_too_small(outline, int(piece[0]), float(rows[0, 0])))
    if not done:
        done.append((piece, rows[:, :3]))
    piece = np.concatenate([some for some, _ in done])
    t0, t1, amount = np.concatenate([some for _, some in done]).T
    order = np.lexsort((t0, piece))
    many = len(outline.pieces)
    owner, (end, total) = np.empty(len(order) + many, np.int64), np.empty((2, len(order) + many))
    _add_up(piece, t1, amount, order, many, owner, (end, total))
    return owner, end, total


@kernel
def _lay_parts(parts, piece, t):
    """Write the pieces of their parts, thrice, and the parameters of their starts, middles and ends."""
    at = 0
    for p in range(len(parts)):
        for j in range(parts[p]):
            t[0, at], t[2, at] = j / parts[p], (j + 1) / parts[p]
            t[1, at] = (t[0, at] + t[2, at]) / 2
            piece[0, at] = piece[1, at] = piece[2, at] = p
            at += 1


@kernel
def _begin(t, x, rows, along):
    """Fill the rows of parts, but for the sizes, and the chords, from starts, middles and ends in order."""
    m = len(rows)
    for i in range(m):
        rows[i, 0], rows[i, 1] = t[0, i], t[2, i]
        for k in range(2):
            rows[i, 2 + k], rows[i, 4 + k], rows[i, 6 + k] = x[i, k], x[m + i, k], x[2 * m + i, k]
            along[i, k] = x[2 * m + i, k] - x[i, k]


@kernel
def _add_up(piece, t1, amount, order, many, owner, sums):
    """Write the samples in order, with the sums of the amounts.

    One more sample at the head of each piece has the sum at the end of the piece before.
    """
    end, total = sums
    next_piece, at, sum_ = 0, 0, 0.0
    for i in range(len(order) + 1):
        p = piece[order[i]] if i < len(order) else many - 1
        while next_piece <= p:
            owner[at], end[at], total[at] = next_piece, 0.0, sum_
            next_piece, at = next_piece + 1, at + 1
        if i < len(order):
            sum_ += amount[order[i]]
            owner[at], end[at], total[at] = p, t1[order[i]], sum_
            at += 1


@kernel
def _quarter(rows, piece, both, quarters, along):
    """Write the pieces and parameters of the first quarters, then of the third ones, and the chords there."""
    m = len(piece)
    for i in range(m):
        both[i] = both[m + i] = piece[i]
        quarters[i], quarters[m + i] = (3 * rows[i, 0] + rows[i, 1]) / 4, (rows[i, 0] + 3 * rows[i, 1]) / 4
        for k in range(2):
            along[i, k] = rows[i, 4 + k] - rows[i, 2 + k]
            along[m + i, k] = rows[i, 6 + k] - rows[i, 4 + k]


@kernel
def _halve_uneven(rows, piece, x, h, ended, ended_piece, halves, halves_piece):
    """Divide the intervals (rows of `_table`) that are uneven; the others end. Returns how many have ended.

    ``x`` and ``h`` are the points at the first quarters, then those at the third ones, and the sizes there.
    Of those that end ``ended`` gets both parameters and the integral. The sizes at the quarters are those at
    the middles of the halves.
    """
    m, many, more = len(piece), 0, 0
    for i in range(m):
        t0, t1, ax, ay = rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3]
        mx, my, bx, by, here = rows[i, 4], rows[i, 5], rows[i, 6], rows[i, 7], rows[i, 8]
        one, two = math.hypot(mx - ax, my - ay), math.hypot(bx - mx, by - my)
        p, q = one / h[i], two / h[m + i]
        whole, amount = (one + two) / here, p + q
        even = abs(one - two) <= 0.02 * (one + two)
        even = even and abs(p - q) <= 0.02 * amount and abs(amount - whole) <= 0.01 * amount
        if even or (amount < 0.02 and whole < 0.02):
            ended[many, 0], ended[many, 1], ended[many, 2], ended_piece[many] = t0, t1, amount, piece[i]
            many += 1
            continue
        middle = (t0 + t1) / 2
        for k in range(2):
            row, j = halves[more], i + k * m
            row[0], row[1] = (t0, middle) if k == 0 else (middle, t1)
            row[2], row[3] = (ax, ay) if k == 0 else (mx, my)
            row[4], row[5], row[8] = x[j, 0], x[j, 1], h[j]
            row[6], row[7] = (mx, my) if k == 0 else (bx, by)
            halves_piece[more] = piece[i]
            more += 1
    return many


def _too_small(outline: Pieces, piece: int, t: float) -> str:
    x = ", ".join(f"{value:.6g}" for value in outline.at(piece, t)[0].tolist())
    where = f"along {outline.name(piece)} near ({x})"
    return f"the size is too small or too rough {where}; make it larger or smoother there"
