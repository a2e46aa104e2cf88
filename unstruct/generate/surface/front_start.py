"""What the front on a surface starts from: its curves, cut evenly, with an edge for each side."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.support import Support
from ...geometry.support_features import side_groups
from ...sizing.field import SizeField

__all__ = ["CutCurves", "cut_curves", "sides_of_curves"]

Array = NDArray[np.float64]
NO_LENGTH = 1e3  # scaled: no length
PROBES_OF_FEATURES = 8  # places in each feature edge, and in each wanted length, where the size is asked


class CutCurves(NamedTuple):
    """The curves of a surface as chords.

    Attributes
    ----------
    points : (p, 3)
        Corners of the surface, then the points on its curves, scaled.
    origin : (p,) int64
        The vertex of the surface that each is, -1 for none.
    rows : (s, 2) int64
        The chords, in the direction of their curves.
    feature : (s,) int64
        The feature edge of the surface at the middle of each.
    span : (s, 2)
        Where each begins and ends: the number of the feature plus the share of it.
    """

    points: Array
    origin: NDArray[np.int64]
    rows: NDArray[np.int64]
    feature: NDArray[np.int64]
    span: Array


def cut_curves(support: Support, size: SizeField, share: float, cap: Array) -> CutCurves:
    """Cut each curve into chords of the wanted lengths, times ``share``, at most ``cap`` (n,), evenly.

    O(k) for k chords and features.
    """
    xyz = support.points * support.factor
    number = {int(v): i for i, v in enumerate(support.corners)}
    points, origin = [xyz[v] for v in support.corners], [int(v) for v in support.corners]
    rows, features, spans = [], [], []
    starts = np.searchsorted(support.chain, np.arange(int(support.chain.max(initial=-1)) + 2))
    for first, last in zip(starts[:-1].tolist(), starts[1:].tolist()):
        edges = support.features[first:last]
        head, tail = int(edges[0, 0]), int(edges[-1, 1])
        closed = head == tail
        where = first + _cuts(
            xyz[edges], cap[edges], size, support.factor * share, 3 if closed else 1, support.factor
        )
        chain = []
        for k, at in enumerate(where.tolist()):
            end = k in (0, len(where) - 1)
            if end and head in number:
                chain.append(number[head if k == 0 else tail])
                continue
            if k == len(where) - 1:
                chain.append(chain[0])
                continue
            f = min(int(at), last - 1)
            t = at - f
            u, v = support.features[f]
            chain.append(len(points))
            points.append(xyz[u] if t == 0.0 else (xyz[v] if t == 1.0 else xyz[u] + t * (xyz[v] - xyz[u])))
            origin.append(int(u) if t == 0.0 else (int(v) if t == 1.0 else -1))
        rows += list(pairwise(chain))
        middle = (where[1:] + where[:-1]) / 2
        features += np.minimum(middle.astype(np.int64), last - 1).tolist()
        spans += list(zip(where[:-1].tolist(), where[1:].tolist()))
    return CutCurves(
        np.array(points).reshape(-1, 3),
        np.array(origin, dtype=np.int64),
        np.array(rows, dtype=np.int64).reshape(-1, 2),
        np.array(features, dtype=np.int64),
        np.array(spans).reshape(-1, 2),
    )


def _cuts(segments: Array, cap: Array, size: SizeField, scale: float, least: int, factor: float) -> Array:
    """Where a curve is cut: the number of its segment plus the share of it, from 0 to the last."""
    along = segments[:, 1] - segments[:, 0]
    length = np.sqrt(along[:, 0] ** 2 + along[:, 1] ** 2 + along[:, 2] ** 2)
    wanted = np.minimum(np.atleast_1d(size(segments.mean(axis=1) / factor)) * scale, cap.min(axis=1))
    probes = np.maximum(
        np.ceil(np.minimum(PROBES_OF_FEATURES * length / wanted, 1e5)), PROBES_OF_FEATURES
    ).astype(np.int64)
    owner = np.repeat(np.arange(len(segments)), probes)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(probes) - probes, probes)
    t = (step + 0.5) / probes[owner]
    x = segments[owner, 0] + t[:, None] * along[owner]
    most = np.minimum(cap[owner, 0], NO_LENGTH) + t * (
        np.minimum(cap[owner, 1], NO_LENGTH) - np.minimum(cap[owner, 0], NO_LENGTH)
    )
    weight = length[owner] / probes[owner] / np.minimum(np.atleast_1d(size(x / factor)) * scale, most)
    total = np.append(0.0, np.cumsum(weight))
    many = max(least, int(np.floor(total[-1] + 0.5)))
    wanted_at = total[-1] * np.arange(1, many) / many
    row = np.minimum(np.searchsorted(total, wanted_at, side="right") - 1, len(owner) - 1)
    part = (wanted_at - total[row]) / np.where(weight[row] > 0.0, weight[row], 1.0)
    inner = owner[row] + (step[row] + np.clip(part, 0.0, 1.0)) / probes[owner[row]]
    return np.concatenate([[0.0], inner, [float(len(segments))]])


def sides_of_curves(
    support: Support, curves: CutCurves
) -> tuple[NDArray[np.int64], Array, NDArray[np.int64], NDArray[np.int64]]:
    """One edge of the front for each chord and each triangle of the surface that it is a side of.

    Returns
    -------
    rows : (f, 2) int64
        From u to v, with the triangle on the left.
    normals : (f, 3)
    seats : (f,) int64
        The triangle. If that is flat, the first one across its longest side that is not, if there is one.
    chord : (f,) int64
    """
    own = support.held.rows
    place, group, _ = side_groups(own)
    ends = np.stack([own, own[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    n = len(support.points)
    keys = np.sort(ends[place], axis=1)
    keys = keys[:, 0] * n + keys[:, 1]
    wanted = np.sort(support.features[curves.feature], axis=1)
    wanted = wanted[:, 0] * n + wanted[:, 1]
    low, high = np.searchsorted(keys, wanted), np.searchsorted(keys, wanted, side="right")
    count = high - low
    chord = np.repeat(np.arange(len(wanted)), count)
    step = np.arange(len(chord)) - np.repeat(np.cumsum(count) - count, count)
    side = place[low[chord] + step]
    along = ends[side, 0] == support.features[curves.feature[chord], 0]
    rows = np.where(along[:, None], curves.rows[chord], curves.rows[chord][:, ::-1])
    seats = side // 3
    flat = np.flatnonzero((support.normals[seats] == 0.0).all(axis=1))
    for i in flat.tolist():
        seats[i] = _unflat(support, place, group, int(side[i]))
    return rows, support.normals[seats].copy(), seats, chord


def _unflat(support: Support, place: NDArray[np.int64], group: NDArray[np.int64], side: int) -> int:
    """A triangle with a direction behind a flat one, as seen from one of its sides."""
    seen, todo = {side // 3}, [side]
    where = np.empty(3 * len(support.triangles), dtype=np.int64)
    where[place] = np.arange(len(place))
    while todo:
        from_side = todo.pop()
        t = from_side // 3
        if support.normals[t].any():
            return t
        for k in range(3):
            one = 3 * t + k
            if one == from_side:
                continue
            i = where[one]
            for j in (i - 1, i + 1):
                if 0 <= j < len(place) and group[j] == group[i] and place[j] // 3 not in seen:
                    seen.add(place[j] // 3)
                    todo.append(int(place[j]))
    return side // 3
