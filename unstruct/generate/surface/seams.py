"""Edges in which more than two triangles meet: they are divided first, alike in all sheets, and kept."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...base.jit import kernel
from ...connect.insertion.halfedges import next_edge, prev_edge
from ...connect.surface.complex import SurfaceComplex
from ...connect.surface.halfedges import CORNER, SEAM_CURVES, SURFACE_SLOTS, edge_between, split_edge

__all__ = ["divide_seams"]


@kernel
def _borders(sheets, found):
    """Write the half-edges without a twin as pairs of vertices; how many there are."""
    count = 0
    for e in range(3 * sheets.state[SURFACE_SLOTS]):
        if sheets.twin[e] < 0:
            found[count, 0], found[count, 1] = sheets.vertex[next_edge(e)], sheets.vertex[prev_edge(e)]
            count += 1
    return count


@kernel
def _divide(sheets, pairs, start, points, made):
    """Split the edge of each pair at ``points[start[i] : start[i + 1]]``, which begin at the second vertex.

    The new vertices are written to ``made``.
    """
    for i in range(pairs.shape[0]):
        e = edge_between(sheets, pairs[i, 0], pairs[i, 1])
        sheets.curve[e] += SEAM_CURVES
        for j in range(start[i], start[i + 1]):
            m = split_edge(sheets, e)
            for k in range(3):
                sheets.xyz[m, k] = points[j, k]
            sheets.kind[m], sheets.on[m] = CORNER, -1
            made[j] = m


def divide_seams(complex: SurfaceComplex, size: Callable[[np.ndarray], np.ndarray]) -> int:
    """Divide the edges where other than two triangles meet as a size asks for; how many edges there are.

    The points are the same, bit for bit, in all sheets, and corners of them from then on.

    Parameters
    ----------
    complex : SurfaceComplex
        As it was made.
    size : function (k, 3) -> (k,)
        In its coordinates.
    """
    s = complex.sheets
    found = np.empty((len(s.vertex), 2), dtype=np.int64)
    pairs = found[: _borders(s, found)]
    ends = complex.master[pairs]
    low, high = ends.min(axis=1), ends.max(axis=1)
    _, edge, count = np.unique(low * len(s.at) + high, return_inverse=True, return_counts=True)
    shared = np.flatnonzero(count[edge.ravel()] > 1)
    if not len(shared):
        return 0
    pairs, ends, edge = pairs[shared], ends[shared], edge.ravel()[shared]
    low, high = low[shared], high[shared]
    a, b = s.xyz[low], s.xyz[high]
    d = b - a
    length = np.sqrt(d[:, 0] ** 2 + d[:, 1] ** 2 + d[:, 2] ** 2)
    parts = np.maximum(np.rint(length / size(0.5 * (a + b))).astype(np.int64), 1)
    start = np.concatenate([[0], np.cumsum(parts - 1)])
    row = np.repeat(np.arange(len(pairs)), parts - 1)
    step = np.arange(start[-1]) - start[row]  # from the second vertex of the pair on
    forward = ends[row, 1] == low[row]
    place = np.where(forward, step + 1, parts[row] - 1 - step)
    t = (place / parts[row])[:, None]
    points = np.ascontiguousarray((1.0 - t) * a[row] + t * b[row])
    complex.grow(len(points), 2 * len(points))
    made = np.empty(len(points), dtype=np.int64)
    _divide(complex.sheets, np.ascontiguousarray(pairs), start, points, made)
    key = edge[row] * (int(parts.max()) + 1) + place
    order = np.argsort(key, kind="stable")
    first = order[np.searchsorted(key[order], key)]
    master = np.arange(int(complex.sheets.state[0]))
    master[: len(complex.master)] = complex.master
    master[made] = made[first]
    complex.master = master
    return int((count > 1).sum())
