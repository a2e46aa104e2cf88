"""Faults of the pieces of a region: an exact search; each fault names its pieces, vertices and place."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...base.arrays import fill, flagged
from ...base.errors import DomainError, InputError
from ...base.jit import inline, kernel
from ...geometry.outline import Outline
from ...geometry.segment_pairs import CROSSING, OVERLAPPING, meetings, none_meet, vertices_on_segments
from ...geometry.sweep import lexicographic

__all__ = ["Fault", "check_ends", "find_faults", "first_copies", "not_ends", "refuse"]

HALF_WORD = 2**32 - 1
MIX = (0x5BD1E995, 0x7ED55D17, 0x6B43A9B5, 0x4CF5AD43)  # odd numbers below 2^31
MANY = 1 << 12  # up to this many pieces one quick test is tried first; for more the stages are faster


@dataclass(frozen=True)
class Fault:
    """One fault: its kind, a sentence about it, its place, and the pieces and vertices that have it."""

    kind: str
    text: str
    place: tuple[float, ...]
    pieces: tuple[int, ...] = ()
    vertices: tuple[int, ...] = ()


def first_copies(points: np.ndarray) -> np.ndarray:
    """For each point the lowest number of a point with equal coordinates (0.0 equals -0.0)."""
    first = np.arange(len(points))
    points = np.ascontiguousarray(points)
    if not _any_equal(points, points.view(np.int64)):
        return first
    order = lexicographic(points)
    head = np.ones(len(points), dtype=bool)
    head[1:] = (points[order[1:], 0] != points[order[:-1], 0]) | (
        points[order[1:], 1] != points[order[:-1], 1]
    )
    if not head.all():
        first[order] = order[np.maximum.accumulate(np.where(head, first, 0))]
    return first


@inline
def _word(x, bits):
    """The bits of a coordinate; those of -0.0 are the ones of 0.0."""
    return np.int64(0) if x == 0.0 else bits


@kernel
def _any_equal(points, bits):
    """Whether two points are equal, by a hash table: a point goes to the first free place from its slot on.

    The slot mixes the halves of the ``bits`` of both coordinates by products that fit into 64 bits.
    """
    size = 4
    while size < 2 * points.shape[0]:
        size *= 2
    table = fill(np.empty(size, dtype=np.int32), -1)
    for i in range(points.shape[0]):
        x, y = _word(points[i, 0], bits[i, 0]), _word(points[i, 1], bits[i, 1])
        key = ((x & HALF_WORD) * MIX[0]) ^ (((x >> 32) & HALF_WORD) * MIX[1])
        key ^= ((y & HALF_WORD) * MIX[2]) ^ (((y >> 32) & HALF_WORD) * MIX[3])
        slot = (key >> 28) & (size - 1)
        while table[slot] >= 0:
            j = table[slot]
            if points[j, 0] == points[i, 0] and points[j, 1] == points[i, 1]:
                return True
            slot = (slot + 1) & (size - 1)
        table[slot] = i
    return False


@kernel
def _any_repeated(segments, head, after, seen):
    """Whether two segments join the same vertices: for each vertex the other ends of its segments are marked.

    A segment belongs to the smaller one of its vertices.
    """
    for s in range(segments.shape[0]):
        a = min(segments[s, 0], segments[s, 1])
        after[s], head[a] = head[a], s
    for a in range(head.shape[0]):
        s = head[a]
        while s >= 0:
            b = max(segments[s, 0], segments[s, 1])
            if seen[b] == a:
                return True
            seen[b] = a
            s = after[s]
    return False


@kernel
def _sound(points, bits, pieces, facets, straight):
    """Whether it is certain, by one quick test, that no stage of `find_faults` would find a fault.

    ``bits`` are those of the points as integers, and ``straight`` contains the straight pieces.
    """
    n = points.shape[0]
    odd = fill(np.empty(n, dtype=np.bool_), False)
    for i in range(pieces.shape[0]):
        a, b = pieces[i, 0], pieces[i, 1]
        if a < 0 or b < 0 or a >= n or b >= n or a == b:
            return False
        if i < facets:  # an even number of facets must meet
            odd[a] ^= True
            odd[b] ^= True
    spare, k = fill(np.empty(n, dtype=np.bool_), True), n
    for i in range(straight.shape[0]):
        for v in (straight[i, 0], straight[i, 1]):
            k -= spare[v]
            spare[v] = False
    alone = np.empty(k, dtype=np.int32)
    k = 0
    for v in range(n):
        if odd[v]:
            return False
        if spare[v]:
            alone[k] = v
            k += 1
    return not _any_equal(points, bits) and none_meet(points, straight, alone)


def crossing_place(points: np.ndarray, s: np.ndarray, t: np.ndarray) -> tuple[float, float]:
    """The point where the lines of two crossing segments meet, in rational arithmetic and rounded once."""
    (px, py), (qx, qy), (ax, ay), (bx, by) = (
        tuple(map(Fraction, points[v].tolist())) for v in (*s.tolist(), *t.tolist())
    )
    ux, uy, wx, wy = qx - px, qy - py, bx - ax, by - ay
    ratio = ((ax - px) * wy - (ay - py) * wx) / (ux * wy - uy * wx)
    return float(px + ratio * ux), float(py + ratio * uy)


# ---------------------------------------------------------------------- all faults of a domain


def refuse(outline: Outline, found: list[Fault]) -> None:
    """Raise an error for the first fault that says how many more there are, and carries them all."""
    if found:
        rest = len(found) - 1
        more = f" (and {rest} more fault{'s' if rest > 1 else ''})" if rest else ""
        parts = (outline.points, outline.facets, outline.inner, outline.curves)
        raise DomainError(found[0].text + more, Outline(*parts, outline.markers, outline.regions), found)


def find_faults(outline: Outline) -> list[Fault]:
    """All faults of the straight pieces and of the vertices, in stages: a stage is the last if it finds any.

    Curved pieces are tested when they are cut into chords, except for their vertices.
    """
    if len(outline.pieces) <= MANY:
        straight = _straight(outline)[1] if outline.curves else outline.pieces
        points = np.ascontiguousarray(outline.points)
        if _sound(points, points.view(np.int64), outline.pieces, len(outline.facets), straight):
            return []
    for stage in (_indices, _duplicates, _zero_length, _repeated, _crossings, _open_vertices):
        faults = stage(outline)
        if faults:
            return faults
    return []


def _place(point: np.ndarray) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _at(place: tuple[float, float]) -> str:
    return f"at ({place[0]:.17g}, {place[1]:.17g})"


def _indices(outline: Outline) -> list[Fault]:
    n, pieces = len(outline.points), outline.pieces
    if pieces.size == 0 or 0 <= pieces.min() <= pieces.max() < n:
        return []
    bad = np.nonzero(((pieces < 0) | (pieces >= n)).any(axis=1))[0]
    return [
        Fault(
            "index out of range",
            f"{outline.name(i)} = {outline.pieces[i].tolist()} refers to points outside 0..{n - 1}; correct "
            "the index, or let resolve=True drop the segment",
            (float("nan"), float("nan")),
            (i,),
        )
        for i in bad.tolist()
    ]


def _duplicates(outline: Outline) -> list[Fault]:
    first = first_copies(outline.points)
    result = []
    for copy in np.nonzero(first != np.arange(len(first)))[0].tolist():
        kept, place = int(first[copy]), _place(outline.points[copy])
        text = (
            f"points {kept} and {copy} are equal, {_at(place)}; use only one of them, or let resolve=True "
            "merge them"
        )
        result.append(Fault("duplicate points", text, place, vertices=(kept, copy)))
    return result


def _zero_length(outline: Outline) -> list[Fault]:
    result = []
    for i in np.nonzero(outline.pieces[:, 0] == outline.pieces[:, 1])[0].tolist():
        v = int(outline.pieces[i, 0])
        place = _place(outline.points[v])
        remedy = (
            "put a second vertex on the curve"
            if i in outline.curves
            else "drop it, or let resolve=True do so"
        )
        text = f"{outline.name(i)} = [{v}, {v}] has zero length, {_at(place)}; {remedy}"
        result.append(Fault("zero length", text, place, (i,), (v,)))
    return result


def _straight(outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """The straight pieces, and their vertices."""
    if not outline.curves:
        return np.arange(len(outline.pieces)), outline.pieces
    rows = np.flatnonzero(~flagged(len(outline.pieces), list(outline.curves)))
    return rows, outline.pieces[rows]


def not_ends(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Vertices that are no segment's end: loose ones, and those of curves alone."""
    spare = np.ones(len(points), dtype=bool)
    spare[segments.ravel()] = False
    return np.nonzero(spare)[0]


def _repeated(outline: Outline) -> list[Fault]:
    rows, segments = _straight(outline)
    head, seen = np.full((2, len(outline.points)), -1, dtype=np.int32)
    if not _any_repeated(segments, head, np.empty(len(rows), dtype=np.int32), seen):
        return []
    a, b = segments.astype(np.int64).T
    key = np.minimum(a, b) * len(outline.points) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    same = key[order[1:]] == key[order[:-1]]
    result = []
    for one, two in zip(rows[order[:-1][same]].tolist(), rows[order[1:][same]].tolist()):
        a, b = outline.points[outline.pieces[one]]
        place = _place(a / 2 + b / 2)
        text = (
            f"{outline.name(one)} and {outline.name(two)} join the same points "
            f"{outline.pieces[one].tolist()}, {_at(place)}; drop one, or let resolve=True do so (by the "
            "even-odd rule it drops both of two equal facets)"
        )
        result.append(Fault("repeated segment", text, place, (one, two)))
    return result


def overlap_place(s: np.ndarray, t: np.ndarray) -> tuple[float, float]:
    """The middle of the common part of two segments on a line."""
    ends = np.concatenate([s, t])
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    return _place(ends[order[1]] / 2 + ends[order[2]] / 2)


def _crossings(outline: Outline) -> list[Fault]:
    rows, segments = _straight(outline)
    pairs, kinds = meetings(outline.points, segments)
    spare = not_ends(outline.points, segments)
    if len(pairs) == 0 and len(spare) == 0:
        return []
    result = []
    for (i, j), kind in zip(pairs.tolist(), kinds.tolist()):
        one, two = int(rows[i]), int(rows[j])
        names = (
            f"{outline.name(one)} = {segments[i].tolist()} and {outline.name(two)} = {segments[j].tolist()}"
        )
        if kind == CROSSING:
            place = crossing_place(outline.points, segments[i], segments[j])
            text = f"{names} cross {_at(place)}; put a vertex there, or let resolve=True split both"
            result.append(Fault("crossing", text, place, (one, two)))
        elif kind == OVERLAPPING:
            place = overlap_place(outline.points[segments[i]], outline.points[segments[j]])
            where = f"near ({place[0]:.6g}, {place[1]:.6g})"
            text = f"{names} overlap {where}; shorten one, or let resolve=True do so"
            result.append(Fault("overlap", text, place, (one, two)))
    suspects = np.unique(np.concatenate([segments[pairs.ravel()].ravel(), spare]))
    touched = np.unique(pairs) if len(spare) == 0 else np.arange(len(rows))
    for v, i in vertices_on_segments(outline.points, suspects, segments[touched]).tolist():
        piece = int(rows[touched[i]])
        place = _place(outline.points[v])
        text = (
            f"point {v} lies on {outline.name(piece)} = {outline.pieces[piece].tolist()}, {_at(place)}; "
            "split the segment there, or let resolve=True do so"
        )
        result.append(Fault("vertex on a segment", text, place, (piece,), (v,)))
    return result


def _open_vertices(outline: Outline) -> list[Fault]:
    degree = np.bincount(outline.facets.ravel(), minlength=len(outline.points))
    result = []
    for v in np.nonzero(degree % 2)[0].tolist():
        touching = tuple(np.nonzero((outline.facets == v).any(axis=1))[0].tolist())
        place = _place(outline.points[v])
        text = (
            f"the boundary is open: {degree[v]} facet{'s meet' if degree[v] > 1 else ' ends'} at point {v}, "
            f"{_at(place)} (facets {', '.join(map(str, touching))}), but an even number must meet. Close the "
            "chain, give pieces that are no boundary as inner, or let resolve=True do so"
        )
        result.append(Fault("open boundary", text, place, touching, (v,)))
    return result


# ---------------------------------------------------------------------- curves


def check_ends(outline: Outline) -> None:
    """Raise if a curve does not start and end at its vertices (up to 2^-40 of the largest coordinate)."""
    others = np.flatnonzero(outline.batch.kind == 2).tolist()
    for piece in others if _batch_ends(outline) else outline.curves:
        ends = np.asarray(outline.curves[piece].point(np.array([0.0, 0.5, 1.0])), dtype=float)
        if ends.shape != (3, 2) or not np.isfinite(ends).all():
            raise InputError(f"the curve of {outline.name(piece)} must give finite points of shape (k, 2)")
        slack = 2.0**-40 * max(np.abs(ends).max(), np.abs(outline.points).max())
        for end, vertex, x in zip(("starts", "ends"), outline.pieces[piece], ends[[0, 2]]):
            if not (np.abs(x - outline.points[vertex]) <= slack).all():
                raise InputError(
                    f"the curve of {outline.name(piece)} {end} at {x.tolist()}, but vertex {vertex} is at "
                    f"{outline.points[vertex].tolist()}; move the vertex to the end of the curve"
                )


def _batch_ends(outline: Outline) -> bool:
    """Whether all curves of the library's own kinds start and end at their vertices."""
    piece = np.flatnonzero((outline.batch.kind == 1) | (outline.batch.kind > 2))
    if len(piece) == 0:
        return True
    ends = np.empty((len(piece), 3, 2))
    outline.batch.fill(np.repeat(piece, 3), np.tile([0.0, 0.5, 1.0], len(piece)), ends.reshape(-1, 2))
    slack = 2.0**-40 * np.maximum(np.abs(ends).max(axis=(1, 2)), np.abs(outline.points).max())
    off = np.abs(ends[:, [0, 2]] - outline.points[outline.pieces[piece]]).max(axis=(1, 2))
    return bool((off <= slack).all() and np.isfinite(ends).all())
