"""Vertices in the middle of straight edges between two polygons, which nothing else needs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.polygons import Polygons

__all__ = ["straight_vertices"]

Array = NDArray[np.float64]


def straight_vertices(
    pieces: Polygons, x: Array, within: float, only: NDArray[np.bool_] | None = None
) -> NDArray[np.int64]:
    """The vertices that can be dropped: two edges meet there, in a line up to a distance.

    Parameters
    ----------
    pieces : Polygons
        All pieces of a body.
    x : (n, 3) float64
    within : float
        How far dropped vertices may be from the edges that replace them.
    only : (n,) bool, optional
        Vertices that may be dropped; all by default.

    Notes
    -----
    One after the other, so that no edge passes a dropped vertex at a larger distance, and no polygon loses
    its last three corners. O(n log n) for vertices on short chains.
    """
    ends, _ = pieces.sides
    edges = np.unique(np.sort(ends.astype(np.int64), axis=1), axis=0)
    degree = np.bincount(edges.ravel(), minlength=len(x))
    free = degree == 2 if only is None else (degree == 2) & only
    beside: dict[int, set[int]] = {}
    for a, b in edges[free[edges].any(axis=1)].tolist():
        beside.setdefault(a, set()).add(b)
        beside.setdefault(b, set()).add(a)
    passed: dict[tuple[int, int], list[int]] = {}
    dropped = []
    for v in np.flatnonzero(free).tolist():
        a, b = sorted(beside[v])
        if b in beside[a]:
            continue
        skipped = [v, *passed.get((min(a, v), max(a, v)), []), *passed.get((min(b, v), max(b, v)), [])]
        if not _near(x[a], x[b], x[skipped], within):
            continue
        passed[a, b] = skipped
        beside[a] = (beside[a] - {v}) | {b}
        beside[b] = (beside[b] - {v}) | {a}
        dropped.append(v)
    return np.array(dropped, dtype=np.int64)


def _near(a: Array, b: Array, q: Array, within: float) -> bool:
    """Whether points are near a segment, and between its ends."""
    along, away = b - a, q - a
    square = along[0] ** 2 + along[1] ** 2 + along[2] ** 2
    share = (away[:, 0] * along[0] + away[:, 1] * along[1] + away[:, 2] * along[2]) / square
    off = away - share[:, None] * along
    return bool(((share > 0.0) & (share < 1.0) & ((off * off).sum(axis=1) <= within * within)).all())
