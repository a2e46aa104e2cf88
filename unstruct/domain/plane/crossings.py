"""Segments split where vertices lie on them and, if this is allowed, where they cross.

A vertex on a segment splits it exactly. A crossing is rounded to doubles, which bends both segments a little,
so that they may meet others; all this is repeated until the exact search finds nothing. Segments may coincide
afterward: whoever asks decides what that means.
"""

from __future__ import annotations

from collections.abc import Callable
from math import frexp, ldexp
from typing import NamedTuple

import numpy as np

from ...base.errors import InputError
from ...geometry.outline import Outline
from ...geometry.segment_pairs import CROSSING, meetings, vertices_on_segments
from .account import Repair
from .faults import Fault, crossing_place, first_copies, refuse

__all__ = ["Split", "distinct_segments", "split"]

SPLIT_ROUNDS = 60
EXACT_ROUNDS = 6  # in the first so many rounds crossings are rounded to the nearest doubles


class Split(NamedTuple):
    """Segments that meet at vertices only, or coincide.

    Attributes
    ----------
    points : (n, 2) float64
        The given points first; copies of them are used by no segment.
    segments : (s, 2) int64
        The parts of each segment in its direction, segment after segment.
    source : (s,) int64
        The given segment that each is a part of.
    first : (k,) int64
        For each given point the lowest number of a point with equal coordinates.
    repairs : list of Repair
        The crossings.
    """

    points: np.ndarray
    segments: np.ndarray
    source: np.ndarray
    first: np.ndarray
    repairs: list[Repair]


def distinct_segments(segments: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(rows, group, first): distinct segments in either direction, the row of each, its first segment.

    Rows are in the order of first appearance.
    """
    low, high = np.sort(segments, axis=1).T
    _, first, group = np.unique(low * np.int64(n) + high, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    return segments[first[order]], place[group.ravel()], first[order]


def split(points: np.ndarray, segments: np.ndarray, label: Callable[[int], str], *, resolve: bool) -> Split:
    """Split segments so that they meet at vertices only.

    Parameters
    ----------
    points : (k, 2) float64
        Equal points count as one.
    segments : (s, 2) int64
        Those of zero length are left out.
    label : function
        The name in messages of each given segment.
    resolve : bool
        Whether segments may cross.

    Raises
    ------
    InputError
        For crossings without ``resolve``: two segments are named, and the place.
    """
    given, first, given_segments = len(points), first_copies(points), segments.astype(np.int32)
    segments, source = first[segments].astype(np.int64), np.arange(len(segments))
    repairs: list[Repair] = []
    alone = np.ones(len(points), dtype=bool)
    for turn in range(SPLIT_ROUNDS):
        long = segments[:, 0] != segments[:, 1]
        segments, source = segments[long], source[long]
        rows, group, head = distinct_segments(segments, len(points))
        pairs, kinds = meetings(points, rows)
        cross = pairs[kinds == CROSSING]
        if len(cross) and not resolve:
            outline = Outline(points[:given], given_segments, given_segments[:0], {}, {}, {})
            refuse(outline, [_crossing(points, rows[pair], source[head[pair]], label) for pair in cross])
        alone = np.zeros(len(points), dtype=bool)
        alone[first] = True  # the copies are on no segment
        alone[rows.ravel()] = False
        near = np.union1d(rows[pairs.ravel()].ravel(), np.flatnonzero(alone))
        on = vertices_on_segments(points, near, rows)
        if len(on) == len(cross) == 0:
            return Split(points, segments, source, first[:given], repairs)
        points, first, fresh = _with_crossings(points, first, rows, cross, turn)
        for (i, j), v in zip(cross.tolist(), fresh.tolist()):
            x, y = points[v].tolist()
            one, two = sorted((int(source[head[i]]), int(source[head[j]])))
            text = f"{label(one)} and {label(two)} cross; both were split at ({x:.17g}, {y:.17g})"
            repairs.append(Repair("crossing", text, (x, y), (one, two)))
        cuts = np.concatenate([on, np.column_stack([np.tile(fresh, 2), cross.T.ravel()])])
        segments, source = _cut(points, segments, source, group, cuts)
    raise InputError(
        f"the lines could not be split in {SPLIT_ROUNDS} rounds; round the coordinates to fewer digits"
    )


def _crossing(points: np.ndarray, pair: np.ndarray, source: np.ndarray, label: Callable[[int], str]) -> Fault:
    one, two = sorted(source.tolist())
    x, y = crossing_place(points, *pair)
    text = (
        f"{label(one)} and {label(two)} cross at ({x:.17g}, {y:.17g}); correct them, or let resolve=True "
        "split both there"
    )
    return Fault("crossing", text, (x, y), (one, two))


def _with_crossings(
    points: np.ndarray, first: np.ndarray, rows: np.ndarray, cross: np.ndarray, turn: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The points with those where pairs of segments cross, `first_copies` again, and the vertex of each.

    In later rounds they are rounded to a grid, which becomes coarser: then there are fewer places for
    further crossings.
    """
    if len(cross) == 0:
        return points, first, np.empty(0, dtype=np.int64)
    place = np.array([crossing_place(points, rows[i], rows[j]) for i, j in cross.tolist()])
    if turn >= EXACT_ROUNDS:
        spacing = ldexp(1.0, frexp(float(np.abs(points).max()))[1] - 53 + turn - EXACT_ROUNDS)
        place = np.round(place / spacing) * spacing
    every = np.concatenate([points, place])
    found = first_copies(every)
    return every, found, found[len(points) :]


def _cut(
    points: np.ndarray, segments: np.ndarray, source: np.ndarray, group: np.ndarray, cuts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The segments split at ``cuts``: pairs (vertex, distinct segment), in the order along each of them.

    Points on a segment, and nearly those beside it, are ordered by the coordinate that changes most.
    """
    cuts = np.unique(cuts[:, ::-1], axis=0)
    start = np.searchsorted(cuts[:, 0], np.arange(group.max() + 2))
    times = start[group + 1] - start[group]
    owner = np.repeat(np.arange(len(segments)), times)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(times) - times, times) + start[group[owner]]
    vertex = cuts[place, 1]
    own = (segments[owner] == vertex[:, None]).any(axis=1)
    owner, vertex = owner[~own], vertex[~own]
    a, b = points[segments].transpose(1, 0, 2)
    steep = np.abs(b[:, 1] / 2 - a[:, 1] / 2) > np.abs(b[:, 0] / 2 - a[:, 0] / 2)
    main = np.where(steep, 1, 0)
    back = np.take_along_axis(a, main[:, None], 1) > np.take_along_axis(b, main[:, None], 1)
    sign = np.where(back.ravel(), -1.0, 1.0)[owner]
    x = points[vertex]
    order = np.lexsort(
        (x[np.arange(len(x)), 1 - main[owner]], sign * x[np.arange(len(x)), main[owner]], owner)
    )
    owner, vertex = owner[order], vertex[order]
    count = np.bincount(owner, minlength=len(segments))
    ends = np.cumsum(count + 2)
    chain = np.empty(ends[-1], dtype=np.int64)
    inside = np.ones(len(chain), dtype=bool)
    inside[ends - 1] = inside[ends - count - 2] = False
    chain[inside] = vertex
    chain[ends - count - 2], chain[ends - 1] = segments.T
    last = np.zeros(len(chain), dtype=bool)
    last[ends - 1] = True
    at = np.flatnonzero(~last)
    return np.column_stack([chain[at], chain[at + 1]]), np.repeat(source, count + 1)
