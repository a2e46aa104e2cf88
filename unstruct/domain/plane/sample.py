"""Cutting pieces into subsegments: as few as keep the shape of the region, or as many as a size asks for.

A chord replaces a *stretch* of a curve, the part over it. A chord is called *safe* if no other chord or
stretch meets the chord and its stretch, and if no other vertex lies between them. Safe chords bound the same
regions as the curves, with the same holes.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from ...base.arrays import counted_off
from ...base.elementary import angle_of
from ...base.errors import InputError
from ...base.jit import kernel
from ...geometry.boxes import BoxTree
from ...geometry.outline import Outline
from ...geometry.segment_pairs import meetings
from ...predicates.batch import power_of_two
from .apart import surely_apart
from .corners import crossings_at_corners

__all__ = ["Sampled", "on_curve_text"]

SAMPLES = np.concatenate([[0, 1 / 64], np.arange(1, 8) / 8, [63 / 64, 1]])  # where a stretch is examined
CHORDS_WITHIN = len(SAMPLES) - 1  # the number of short chords between these samples
ON_CHORD = 2.0**-46  # of the largest coordinate: a vertex so near to a chord is on it, up to rounding
TURN = np.pi / 3  # the largest angle by which a curve may turn over one chord
# Curves that still conflict after so many halvings are reported as meeting.
HALVINGS = 40
# So are curves that still conflict when their chords are shorter than this (unit: the largest coordinate).
SHORTEST_CHORD = 2.0**-28
NEARBY = 1e-6  # a conflict so near to a common vertex is one at the vertex; unit: the largest coordinate
BY_CHORDS = "use the chords of Domain.sampled(size) of each alone, joined with resolve=True"
OF_ONE = "use chords between points of it, point(t), with resolve=True"
# Two curves are the same if they are nearer than this at all samples, in units of the largest coordinate.
SAME_CURVE = 2.0**-48
# Cutting ends if more chords than this conflict at once (and `SHARE` more for each curve). Curves that cross
# do so in some points only; so many conflicts arise only if curves lie on each other.
CONFLICTS = 1 << 16
SHARE = 64


@dataclass(frozen=True)
class Sampled:
    """The boundary and the inner pieces of a region, as straight subsegments.

    Attributes
    ----------
    points : (n, 2) float64
        First the points of the outline, then those that cut its pieces.
    origin : (n,) int32
        For each point the vertex of the domain that it is; -1 for the others.
    ends : (s, 2) int32
        The ends of the subsegments, piece after piece, from the first vertex of each piece to its last.
    piece : (s,) int32
        The piece of which each subsegment is a part: facets 0 to f - 1, then inner segments.
    span : (s, 2) float64
        The parameters of its ends on the piece; the ends of the piece have 0 and 1.
    outline : Outline
        What was sampled. Every method takes a `Sampled` as a domain of straight pieces with its names.
    """

    points: np.ndarray
    origin: np.ndarray
    ends: np.ndarray
    piece: np.ndarray
    span: np.ndarray
    outline: Outline

    def parts(self) -> dict[str, Any]:
        """The arguments of a `Domain` of straight pieces: the subsegments."""
        facets = self.piece < len(self.outline.facets)  # they come first
        many = np.bincount(self.piece, minlength=len(self.outline.pieces))
        start = np.cumsum(many) - many
        markers = {}
        for name, pieces in self.outline.markers.items():
            begin = np.repeat(start[pieces] - np.cumsum(many[pieces]) + many[pieces], many[pieces])
            markers[name] = begin + np.arange(len(begin))
        return {
            "points": self.points,
            "facets": self.ends[facets],
            "inner": self.ends[~facets],
            "markers": markers,
            "regions": self.outline.regions,
        }


# ---------------------------------------------------------------------- cutting


def assemble(outline: Outline, piece: np.ndarray, t0: np.ndarray, t1: np.ndarray) -> Sampled:
    """Subsegments for parameter intervals that fill each piece from 0 to 1, sorted by piece and t0."""
    n, inside = len(outline.points), np.flatnonzero(t1 < 1.0)
    points = np.empty((n + len(inside), 2))
    points[:n] = outline.points
    points[n:] = outline.points_at(piece[inside], t1[inside])
    origin, pieces = np.full(len(points), -1, dtype=np.int32), np.empty(len(piece), dtype=np.int32)
    origin[:n] = counted_off(n)
    pieces[:] = piece
    ends, span = np.empty((len(piece), 2), dtype=np.int32), np.empty((len(piece), 2))
    span[:, 0], span[:, 1] = t0, t1
    _join(outline.pieces, pieces, span, n, ends)
    return Sampled(points, origin, ends, pieces, span, outline)


@kernel
def _join(pieces, piece, span, first, ends):
    """Write the ends of subsegments that follow each other; points within pieces count from ``first`` on."""
    for s in range(len(piece)):
        ends[s, 0] = first - 1 if span[s, 0] > 0.0 else pieces[piece[s], 0]
        ends[s, 1] = pieces[piece[s], 1]
        if span[s, 1] < 1.0:
            ends[s, 1] = first
            first += 1


def halve(sampled: Sampled, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The parameter intervals (piece, t0, t1) after the subsegments ``rows`` (a mask) are halved."""
    times = np.where(rows, 2, 1)
    piece = np.repeat(sampled.piece, times)
    t0, t1 = np.repeat(sampled.span, times, axis=0).T.copy()
    at = np.cumsum(times)[rows] - 2
    middle = (t0[at] + t1[at]) / 2
    t1[at] = middle
    t0[at + 1] = middle
    return piece, t0, t1


# ---------------------------------------------------------------------- safety


def fine_chains(outline: Outline, sampled: Sampled, rows: np.ndarray) -> np.ndarray:
    """Points (r, CHORDS_WITHIN + 1, 2) along the stretches of the subsegments ``rows``."""
    inner = SAMPLES[1:-1]
    many = len(rows) * len(inner)
    piece, t = np.empty(many, dtype=np.int64), np.empty(many)
    chains = np.empty((len(rows), CHORDS_WITHIN + 1, 2))
    _lay_samples(sampled.piece, sampled.span, rows, inner, piece, t)
    x = outline.points_at(piece, t)
    _chain(sampled.points, sampled.ends, rows, x, chains)
    return chains


@kernel
def _lay_samples(pieces, span, rows, inner, piece, t):
    """Write the pieces and the parameters of samples between the ends of subsegments."""
    many = len(inner)
    for r in range(len(rows)):
        first, last = span[rows[r], 0], span[rows[r], 1]
        for k in range(many):
            piece[r * many + k], t[r * many + k] = pieces[rows[r]], first + (last - first) * inner[k]


@kernel
def _chain(points, ends, rows, x, chains):
    """Write the ends of subsegments with the samples between them."""
    many = chains.shape[1] - 2
    for r in range(len(rows)):
        for j in range(2):
            chains[r, 0, j] = points[ends[rows[r], 0], j]
            chains[r, many + 1, j] = points[ends[rows[r], 1], j]
            for k in range(many):
                chains[r, 1 + k, j] = x[r * many + k, j]


def turning(chains: np.ndarray) -> np.ndarray:
    """The total turn of each chain of points, without that inside of its short first and last chords."""
    found = np.empty(len(chains))
    _turning(chains, found)
    return found


@kernel
def _turning(chains, found):
    for r in range(chains.shape[0]):
        found[r] = 0.0
        for i in range(1, chains.shape[1] - 1):
            ux, uy = chains[r, i, 0] - chains[r, i - 1, 0], chains[r, i, 1] - chains[r, i - 1, 1]
            vx, vy = chains[r, i + 1, 0] - chains[r, i, 0], chains[r, i + 1, 1] - chains[r, i, 1]
            found[r] += abs(angle_of(ux * vy - uy * vx, ux * vx + uy * vy))


@kernel
def _boxes(chains, low, high):
    """The smallest and the largest coordinates of each chain of points."""
    for r in range(chains.shape[0]):
        for k in range(2):
            low[r, k] = high[r, k] = chains[r, 0, k]
            for i in range(1, chains.shape[1]):
                low[r, k], high[r, k] = min(low[r, k], chains[r, i, k]), max(high[r, k], chains[r, i, k])


@kernel
def _enclosed(at, chains, query, hit, inside):
    """Whether points lie in the polygons of chains and their chords, by the even-odd rule, up to rounding."""
    for q in range(query.shape[0]):
        x, y, chain = at[query[q], 0], at[query[q], 1], chains[hit[q]]
        for i in range(chain.shape[0]):
            j = i + 1 if i + 1 < chain.shape[0] else 0
            ax, ay, bx, by = chain[i, 0], chain[i, 1], chain[j, 0], chain[j, 1]
            if (ay <= y) != (by <= y):
                turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
                inside[q] ^= (turn > 0) == (by > ay)


def conflicts(outline: Outline, sampled: Sampled, rows: np.ndarray, chains: np.ndarray) -> np.ndarray:
    """Pairs of subsegments (c, 2) of which one or both must be cut to make the chords safe.

    ``rows`` are the curved subsegments, ``chains`` their `fine_chains`.
    """
    if len(rows) and surely_apart(outline, sampled.points, sampled.ends, rows, chains):
        return np.empty((0, 2), dtype=np.int64)
    pairs = [meetings(sampled.points, sampled.ends)[0]]
    if len(rows):
        pairs += [_fine_meetings(sampled, rows, chains), _vertices_between(outline, sampled, rows, chains)]
    return np.concatenate(pairs)


def _fine_meetings(sampled: Sampled, rows: np.ndarray, chains: np.ndarray) -> np.ndarray:
    """Pairs of a stretch and another stretch, or another subsegment, that meet."""
    n, k = len(sampled.points), CHORDS_WITHIN - 1
    inner = n + np.arange(len(rows) * k).reshape(-1, k)
    vertices = np.column_stack([sampled.ends[rows, 0], inner, sampled.ends[rows, 1]])
    segments = np.stack([vertices[:, :-1], vertices[:, 1:]], axis=2).reshape(-1, 2)
    points = np.concatenate([sampled.points, chains[:, 1:-1].reshape(-1, 2)])
    long = (points[segments[:, 0]] != points[segments[:, 1]]).any(axis=1)
    segments = np.concatenate([segments[long], sampled.ends])
    owner = np.concatenate([np.repeat(rows, CHORDS_WITHIN)[long], np.arange(len(sampled.ends))])
    pairs = owner[meetings(points, segments)[0]]
    return pairs[pairs[:, 0] != pairs[:, 1]]


def _vertices_between(outline: Outline, sampled: Sampled, rows: np.ndarray, chains: np.ndarray) -> np.ndarray:
    """Pairs (row, row) for subsegments that must be cut: a vertex or seed lies between chord and curve."""
    at = np.concatenate([sampled.points, *outline.regions.values()])
    low, high = np.empty((2, len(chains), 2))
    _boxes(chains, low, high)
    query, hit = BoxTree(low, high).pairs(at, at)
    own = (sampled.ends[rows[hit]] == query[:, None]).any(axis=1)
    query, hit = query[~own], hit[~own]
    inside = np.zeros(len(query), dtype=bool)
    _enclosed(at, chains, query, hit, inside)
    # A vertex on the chord itself would become one of the boundary.
    first, last = chains[hit, 0], chains[hit, -1]
    within = (at[query] >= np.minimum(first, last)) & (at[query] <= np.maximum(first, last))
    factor = power_of_two(sampled.points)  # products of very large coordinates are no doubles
    along, away = last * factor - first * factor, at[query] * factor - first * factor
    height = np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0])  # times the length of the chord
    rounding = ON_CHORD * np.abs(sampled.points * factor).max() * np.hypot(*along.T)
    inside |= within.all(axis=1) & (height <= rounding)
    cut = rows[hit[inside]]
    return np.column_stack([cut, cut])


def safe(outline: Outline, piece: np.ndarray, t0: np.ndarray, t1: np.ndarray, turn: float) -> Sampled:
    """Halve curved subsegments until the chords are safe, and no stretch turns by more than ``turn``.

    A straight piece whose parts touch another piece because of rounding becomes whole again.
    """
    bent = np.zeros(len(outline.pieces), dtype=bool)
    bent[list(outline.curves)] = True
    for _ in range(HALVINGS):
        sampled = assemble(outline, piece, t0, t1)
        curved = bent[sampled.piece]
        rows = np.nonzero(curved)[0]
        cut = np.zeros(len(curved), dtype=bool)
        chains = fine_chains(outline, sampled, rows)
        if turn < np.inf:
            cut[rows[turning(chains) > turn * (1 + 1e-9)]] = True
        if not cut.any():
            pairs = conflicts(outline, sampled, rows, chains)
            if len(pairs) == 0:
                return sampled
            cut[pairs.ravel()] = True
            straight = np.isin(sampled.piece, sampled.piece[cut & ~curved]) & ~curved
            cut &= curved
            if cut.sum() > CONFLICTS + SHARE * len(outline.curves):
                break
            if not cut.any():
                if not ((sampled.span[straight] != [0.0, 1.0]).any()):
                    break
                whole = straight & (sampled.span[:, 0] > 0)
                piece, (t0, t1) = sampled.piece[~whole], sampled.span[~whole].T.copy()
                t1[straight[~whole]] = 1.0
                continue
        a, b = sampled.points[sampled.ends[cut]].transpose(1, 0, 2)
        if (np.abs(b - a).max(axis=1) < SHORTEST_CHORD * np.abs(sampled.points).max()).any():
            break
        piece, t0, t1 = halve(sampled, cut)
    raise InputError(_meeting_text(outline, sampled, conflicts(outline, sampled, rows, chains)))


def _meeting_text(outline: Outline, sampled: Sampled, pairs: np.ndarray) -> str:
    if len(pairs) == 0:
        row = int(np.argmax(turning(fine_chains(outline, sampled, np.arange(len(sampled.ends))))))
        x, y = sampled.points[sampled.ends[row, 0]]
        name = outline.name(int(sampled.piece[row]))
        return f"{name} turns without end near ({x:.6g}, {y:.6g}): a curve must be smooth; put a vertex there"
    first, second = pairs[0]
    x, y = sampled.points[sampled.ends[first]].mean(axis=0)
    if first == second and len(outline.loose):
        away = np.hypot(*(outline.points[outline.loose] - [x, y]).T)
        if away.min() <= NEARBY * np.abs(outline.points).max():
            return on_curve_text(outline, int(outline.loose[away.argmin()]), int(sampled.piece[first]))
    return _pair_text(outline, int(sampled.piece[first]), int(sampled.piece[second]), x, y)


def on_curve_text(outline: Outline, vertex: int, piece: int) -> str:
    """What is said of a loose vertex that lies on a curve, or so near to it that no chords can tell."""
    x, y = outline.points[vertex]
    remedy = "let resolve=True do so" if outline.cuts().kind[piece] == 1 else "move the point"
    where = f"{outline.name(piece)}, at ({x:.6g}, {y:.6g})"
    return f"point {vertex} lies on {where}; split the piece there, or {remedy}"


def _pair_text(outline: Outline, first: int, second: int, x: float, y: float) -> str:
    one, two = outline.name(first), outline.name(second)
    both = f"{one} meets itself" if one == two else f"{one} and {two} cross or touch"
    kind = outline.cuts().kind
    shared = np.intersect1d(*outline.pieces[[first, second]]) if first != second else ()
    near = NEARBY * np.abs(outline.points).max()
    if len(shared) and np.hypot(*(outline.points[shared] - [x, y]).T).min() <= near:
        return (
            f"{one} and {two} touch at their common vertex near ({x:.6g}, {y:.6g}) and bend to the same "
            f"side, so that no chords tell them apart; move one of them, or {BY_CHORDS}"
        )
    remedy = "put a vertex there"
    if first != second and max(kind[first], kind[second]) < 2:
        return f"{both} near ({x:.6g}, {y:.6g}); {remedy}, or let resolve=True split the pieces"
    remedy += f" and split the pieces at it, or {OF_ONE if first == second else BY_CHORDS}"
    return f"{both} near ({x:.6g}, {y:.6g}); {remedy} (resolve=True splits only straight pieces and arcs)"


# ---------------------------------------------------------------------- without a size


def _refuse_repeated(outline: Outline) -> None:
    """Raise if two curves have the same ends and the same points: cutting would show it only after long."""
    curved = np.sort(outline.pieces[list(outline.curves)], axis=1)
    curved = curved[np.lexsort(curved.T)]
    if not (curved[1:] == curved[:-1]).all(axis=1).any():
        return
    with_ends: dict[tuple[int, int], list[int]] = {}
    for piece in outline.curves:
        a, b = outline.pieces[piece].tolist()
        with_ends.setdefault((min(a, b), max(a, b)), []).append(piece)
    for (a, b), pieces in with_ends.items():
        for one, two in combinations(pieces, 2):
            turned = outline.pieces[one, 0] != outline.pieces[two, 0]
            x, y = outline.at(one, SAMPLES), outline.at(two, SAMPLES)[:: -1 if turned else 1]
            if np.abs(x - y).max() <= SAME_CURVE * np.abs(x).max():
                names = f"{outline.name(one)} and {outline.name(two)}"
                raise InputError(f"{names} are the same curve between points {a} and {b}; drop one of them")


def coarse(outline: Outline) -> Sampled:
    """Keep straight pieces whole, and cut curves as coarsely as is safe."""
    many = len(outline.pieces)
    if not outline.curves:  # straight pieces have been validated already
        span = np.zeros((many, 2))
        span[:, 1] = 1.0
        return Sampled(
            outline.points, counted_off(len(outline.points)), outline.pieces, counted_off(many), span, outline
        )
    _refuse_repeated(outline)
    whole = np.arange(many)
    pairs, places = crossings_at_corners(outline)
    if len(pairs):
        raise InputError(_pair_text(outline, *pairs[0].tolist(), *places[0].tolist()))
    return safe(outline, whole, np.zeros(len(whole)), np.ones(len(whole)), TURN)
