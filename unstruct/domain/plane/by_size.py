"""Cutting pieces by a size: whole numbers of subsegments, at equal steps of the integral of ds / size.

With a metric the size is that in the direction of the piece; the integral is the metric length of the piece.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np

from ...base.errors import InputError
from ...geometry.outline import Outline
from ...sizing.metric import Metric
from .by_region import PieceSizes, piece_sizes, size_or_metric
from .prescribed import recut
from .sample import Sampled, safe

__all__ = ["Pieces", "evenly", "sized"]

METRIC_PARTS = 128  # a metric is looked at in so many parts of a straight piece of the size of the domain
MOST_SUBSEGMENTS = 1 << 25  # a size that asks for more subsegments is too small
# A size is too rough if its integral needs more parameter intervals at once than `STRETCH`, and more than
# `STRETCH_SHARE` for each piece.
STRETCH = 1 << 20
STRETCH_SHARE = 64


class Pieces(Protocol):
    """What has straight or curved pieces between points: an `Outline`, or edges in space."""

    points: np.ndarray
    pieces: Any
    curves: Any
    spacings: Any

    def points_at(self, piece: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Points of many pieces by parameters."""

    def at(self, piece: int, t: Any) -> np.ndarray:
        """Points of one piece."""

    def name(self, piece: int) -> str:
        """What messages call a piece."""


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
    if outline.spacings:
        owner, t0, t1 = recut(outline.spacings, owner, t0, t1)
    return safe(outline, owner, t0, t1, np.inf)


def evenly(outline: Pieces, wanted: PieceSizes, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whole numbers of parameter intervals (piece, t0, t1) for pieces in the plane or in space.

    Parameters
    ----------
    outline : Outline, or what has its points, pieces, curves, spacings, points_at, at and name
    wanted : PieceSizes
        A field for each piece.
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
    owner = np.repeat(np.arange(len(count)), count)
    j = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    even = wanted.even()
    if outline.curves:
        even[list(outline.curves)] = False
    share = j / count[owner]
    place = begin[owner] + share * amount[owner]
    t0 = np.where(even[owner], share, np.interp(place, total, piece + t) - owner)
    t0 = np.where(j == 0, 0.0, t0)
    last = np.append(owner[1:] != owner[:-1], True)
    t1 = np.where(last, 1.0, np.append(t0[1:], 1.0))
    return owner, t0, t1


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


def _table(outline: Pieces, size: PieceSizes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples (piece, t) in order, with the integral of ds / size over all pieces up to each sample.

    Intervals are halved until their halves are nearly equal and agree with the whole, or far below a step.
    """
    many = len(outline.pieces)
    parts = np.where(np.isin(np.arange(many), list(outline.curves)), 16, 1)
    parts[list(outline.spacings)] = 0
    if any(isinstance(one, Metric) for one in size.fields):
        # Along a piece that a layer crosses, a metric is fine in a short part only.
        a, b = outline.points[outline.pieces].transpose(1, 0, 2)
        share = np.abs(b - a).max(axis=1) / np.ptp(outline.points, axis=0).max()
        parts = np.maximum(parts, np.ceil(METRIC_PARTS * share).astype(np.int64))
    piece = np.repeat(np.arange(many), parts)
    j = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    t0, t1 = j / parts[piece], (j + 1) / parts[piece]
    done: list[tuple[np.ndarray, ...]] = []
    while len(piece):
        t = np.stack([t0, (3 * t0 + t1) / 4, (t0 + t1) / 2, (t0 + 3 * t1) / 4, t1])
        x = outline.points_at(np.tile(piece, 5), t.ravel()).reshape(5, len(piece), -1)
        chord = x[2::2] - x[:-2:2]
        flat = 2 * len(piece), -1
        h = size.at(np.tile(piece, 2), x[1::2].reshape(flat), chord.reshape(flat)).reshape(2, -1)
        h1 = size.at(piece, x[2], x[4] - x[0])
        length = np.hypot.reduce(chord, axis=2)
        halves = length / h
        whole, amount = length.sum(axis=0) / h1, halves.sum(axis=0)
        even = np.abs(length[0] - length[1]) <= 0.02 * length.sum(axis=0)
        even &= (np.abs(halves[0] - halves[1]) <= 0.02 * amount) & (np.abs(amount - whole) <= 0.01 * amount)
        enough = even | ((amount < 0.02) & (whole < 0.02))
        done.append((piece[enough], t0[enough], t1[enough], amount[enough]))
        rest = ~enough
        piece, (t0, t1) = (
            np.repeat(piece[rest], 2),
            np.stack([np.stack([t0, t[2]])[:, rest].T.ravel(), np.stack([t[2], t1])[:, rest].T.ravel()]),
        )
        if len(piece) > max(STRETCH, STRETCH_SHARE * many):
            raise InputError(_too_small(outline, int(piece[0]), float(t0[0])))
    if not done:
        done.append((piece, t0, t1, t0))
    piece, t0, t1, amount = (np.concatenate(parts) for parts in zip(*done))
    order = np.lexsort((t0, piece))
    piece, t1, amount = piece[order], t1[order], amount[order]
    # One more sample at the head of each piece has the integral of the end of the piece before.
    total = np.cumsum(amount)
    heads = np.searchsorted(piece, np.arange(many))
    return (
        np.insert(piece, heads, np.arange(many)),
        np.insert(t1, heads, 0.0),
        np.insert(total, heads, np.concatenate([[0.0], total])[heads]),
    )


def _too_small(outline: Pieces, piece: int, t: float) -> str:
    x = ", ".join(f"{value:.6g}" for value in outline.at(piece, t)[0].tolist())
    where = f"along {outline.name(piece)} near ({x})"
    return f"the size is too small or too rough {where}; make it larger or smoother there"
