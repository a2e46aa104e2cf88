"""Points that pieces must have: a spacing given along a piece, and pieces that are images of others."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log
from typing import Any, NamedTuple

import numpy as np

from ...base.arguments import positive
from ...base.arrays import flagged
from ...base.errors import InputError
from ...geometry.motion import Motion
from ...geometry.outline import Outline
from .sample import HALVINGS, Sampled, conflicts, fine_chains, safe

__all__ = ["Match", "Spacing", "carried", "mirrored", "parameters", "recut", "spaced"]

SAMPLES_ALONG = 4097  # of a curve, to measure it
SAME_PARAMETER = 2.0**-40  # parameters that differ by less are equal
MOST_EDGES = 1 << 22  # along one piece


@dataclass(frozen=True)
class Spacing:
    """How long the edges along a piece are, from its first vertex to its second; see `Domain.spaced`.

    Parameters
    ----------
    count : int, optional
        The number of edges.
    first, last : float, optional
        The lengths of the first and the last edge. They are met as nearly as a whole number of edges allows.
    growth : float, optional
        The quotient of each edge and the one before; 1 by default.

    Notes
    -----
    Give ``count``, ``count`` and ``growth``, ``first`` and ``last``, or ``first`` and ``growth``. Lengths are
    a geometric sequence along the true curve.
    """

    count: int | None = None
    first: float | None = None
    last: float | None = None
    growth: float | None = None

    def __post_init__(self) -> None:
        given = {k for k in ("count", "first", "last", "growth") if getattr(self, k) is not None}
        if given not in ({"count"}, {"count", "growth"}, {"first", "last"}, {"first", "growth"}):
            raise InputError(
                "a Spacing takes count, count and growth, first and last, or first and growth, not "
                f"{sorted(given) or 'nothing'}"
            )
        for name in given - {"count"}:
            positive(getattr(self, name), name)
        if "count" in given:
            whole = isinstance(self.count, int | np.integer) and not isinstance(self.count, bool)
            if not whole or not 1 <= int(self.count or 0) <= MOST_EDGES:
                raise InputError(f"count = {self.count!r} must be a whole number of edges, at least 1")

    def shares(self, length: float) -> np.ndarray:
        """The parts of a length at which its edges end: from 0 to 1, (count + 1,)."""
        first, last = self.first or 0.0, self.last or 0.0
        growth = 1.0 if self.growth is None else float(self.growth)
        if self.count is not None:
            number = float(self.count)
        elif self.last is None:
            even = abs(growth - 1.0) < 1e-12
            inside = 1.0 + length * (growth - 1.0) / first  # decreasing lengths may never fill the piece
            if inside <= 0.0:
                raise InputError(
                    f"edges from {first:g} on with growth {growth:g} never fill a piece of length {length:g}"
                )
            number = length / first if even else log(inside) / log(growth)
        elif max(first, last) >= length:
            number = 1.0 if first + last > 1.5 * length else 2.0
        elif abs(first - last) < 1e-12 * first:
            number = length / first
        else:
            number = 1.0 + log(last / first) / log((length - first) / (length - last))
        if number > MOST_EDGES:
            raise InputError(f"{self} asks for {number:.3g} edges along a piece of length {length:g}")
        many = max(round(number), 1)
        if self.last is not None:
            growth = (last / first) ** (1.0 / (many - 1)) if many > 1 else 1.0
        power = np.arange(many) * np.log(growth)
        lengths = np.exp(power - power.max())
        ends = np.append(0.0, np.cumsum(lengths))
        share = ends / ends[-1] if growth != 1.0 else np.arange(many + 1) / many
        share[-1] = 1.0
        if not (np.diff(share) > 0).all():
            raise InputError(f"{self} asks for edges shorter than rounding on a piece of length {length:g}")
        return share


class Match(NamedTuple):
    """Two pieces of which the second is the first one, moved.

    Attributes
    ----------
    first, second : int
    turned : bool
        Whether they run in opposite directions.
    motion : Motion
        Points of the second are the images of those of the first.
    """

    first: int
    second: int
    turned: bool
    motion: Motion


def parameters(outline: Outline, piece: int, spacing: Spacing) -> np.ndarray:
    """The parameters of the points of a spacing along a piece, 0 and 1 included."""
    if piece not in outline.curves:
        a, b = outline.points[outline.pieces[piece]]
        return spacing.shares(float(np.hypot(*(b - a))))
    t = np.linspace(0.0, 1.0, SAMPLES_ALONG)
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(outline.at(piece, t), axis=0).T)))
    found = np.interp(spacing.shares(float(along[-1])) * along[-1], along, t)
    found[0], found[-1] = 0.0, 1.0
    return found


# ---------------------------------------------------------------------- applied to what was sampled


def _start(sampled: Sampled, pieces: int) -> np.ndarray:
    return np.searchsorted(sampled.piece, np.arange(pieces + 1))


def recut(
    given: dict[int, np.ndarray], piece: np.ndarray, t0: np.ndarray, t1: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The parameter intervals (piece, t0, t1), with those of some pieces between given parameters."""
    keys = np.fromiter(given, dtype=np.int64, count=len(given))
    many = np.fromiter(map(len, given.values()), dtype=np.int64, count=len(given))
    old = ~flagged(int(max(keys.max(), piece.max(initial=-1))) + 1, keys)[piece]
    place, last = np.concatenate(list(given.values())), np.cumsum(many) - 1
    owner = np.concatenate([piece[old], np.repeat(keys, many - 1)])
    t0 = np.concatenate([t0[old], place[~flagged(len(place), last)]])
    t1 = np.concatenate([t1[old], place[~flagged(len(place), last - many + 1)]])
    order = np.lexsort((t0, owner))
    return owner[order].astype(np.int64), t0[order], t1[order]


def _cut_as(outline: Outline, sampled: Sampled, given: dict[int, np.ndarray]) -> Sampled:
    """The subsegments with those of some pieces at given parameters; cut further where that is not safe."""
    return safe(outline, *recut(given, sampled.piece, *sampled.span.T), np.inf)


def _images(outline: Outline, sampled: Sampled) -> dict[int, np.ndarray]:
    """The parameters of pieces that are not yet cut as those that they match."""
    start = _start(sampled, len(outline.pieces))
    found: dict[int, np.ndarray] = {}
    for match in outline.matches:
        own = []
        for piece in (match.first, match.second):
            rows = slice(start[piece], start[piece + 1])
            own.append(np.append(sampled.span[rows, 0], 1.0))
        one, two = own
        if match.turned:
            two = 1.0 - two[::-1]
        if len(one) == len(two) and np.abs(one - two).max() <= SAME_PARAMETER:
            continue
        finer = len(one) >= len(two)
        if (match.first in outline.spacings) != (match.second in outline.spacings):
            finer = match.first in outline.spacings if len(one) != len(two) else finer
        both = one if finer else two
        found[match.first], found[match.second] = both, 1.0 - both[::-1] if match.turned else both
    return found


def spaced(outline: Outline, sampled: Sampled, cut: bool = False) -> Sampled:
    """The subsegments with the points of spaced pieces; they are cut further only where that is not safe.

    ``cut`` says that they have been cut so, and perhaps further.
    """
    if not outline.spacings:
        return sampled
    if cut:
        many = np.bincount(sampled.piece, minlength=len(outline.pieces))
        parts = np.fromiter(map(len, outline.spacings.values()), dtype=np.int64, count=len(outline.spacings))
        if (many[list(outline.spacings)] == parts - 1).all():
            return sampled
    piece, t0, t1 = recut(outline.spacings, sampled.piece, *sampled.span.T)
    if np.array_equal(piece, sampled.piece) and np.array_equal(np.column_stack([t0, t1]), sampled.span):
        return sampled  # they have been cut so
    return safe(outline, piece, t0, t1, np.inf)


def mirrored(outline: Outline, sampled: Sampled) -> Sampled:
    """The subsegments, those of matched pieces cut in the same way, with points that are equal but moved."""
    if not outline.matches:
        return sampled
    for _ in range(HALVINGS):
        given = _images(outline, sampled)
        if not given:
            break
        sampled = _cut_as(outline, sampled, given)
    else:
        raise InputError(
            f"{outline.name(min(given))} and {outline.name(max(given))} match, but cannot be cut in the same "
            "way: another piece is too near to one of them"
        )
    return _moved(outline, sampled)


def _moved(outline: Outline, sampled: Sampled) -> Sampled:
    """The points on the second of two matched pieces put exactly where those of the first are, moved."""
    points, start = sampled.points.copy(), _start(sampled, len(outline.pieces))
    for match in outline.matches:
        one, two = (
            sampled.ends[start[piece] : start[piece + 1] - 1, 1] for piece in (match.first, match.second)
        )
        points[two[::-1] if match.turned else two] = match.motion(points[one])
    moved = replace(sampled, points=points)
    if np.array_equal(points, sampled.points):
        return moved
    rows = np.flatnonzero(np.isin(moved.piece, list(outline.curves)))
    pairs = conflicts(outline, moved, rows, fine_chains(outline, moved, rows))
    if len(pairs):
        name, other = (outline.name(int(moved.piece[row])) for row in pairs[0])
        raise InputError(f"{name} and {other} touch when the points of matched pieces are made equal")
    return moved


def carried(sampled: Sampled, new: Any) -> None:
    """Let a domain of the subsegments keep spaced and matched pieces as they are."""
    outline = sampled.outline
    if not outline.spacings and not outline.matches:
        return
    start = _start(sampled, len(outline.pieces))
    whole = np.array([0.0, 1.0])
    new.spacings = {k: whole for p in outline.spacings for k in range(start[p], start[p + 1])}
    new.matches = []
    for match in outline.matches:
        one, two = (range(start[piece], start[piece + 1]) for piece in (match.first, match.second))
        rows = zip(one, reversed(two) if match.turned else two)
        new.matches += [Match(i, j, match.turned, match.motion) for i, j in rows]
