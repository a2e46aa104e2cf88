"""Edges in which more than two triangles meet: they are divided first, alike in all sheets, and kept."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...base.jit import kernel
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.complex import SurfaceComplex
from ...connect.surface.halfedges import (
    CORNER,
    SEAM_CURVES,
    SURFACE_SLOTS,
    edge_between,
    split_edge,
)

__all__ = ["divide_seams", "follow_sizes"]


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
            sheets.kind[m] = CORNER
            made[j] = m


def divide_seams(complex: SurfaceComplex, size: Callable[[np.ndarray], np.ndarray]) -> tuple[int, int]:
    """Divide the edges where the surface is cut open, as a size asks for.

    That is where more than two triangles meet, or two that run through the edge in the same direction. How
    many edges there are of either kind is returned: a surface of one side, which cannot be turned alike, has
    the second kind where it closes. The points are the same, bit for bit, in all sheets, and corners of them
    from then on.

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
        return 0, 0
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
    complex.unite(made, made[first])
    return int((count > 2).sum()), int((count == 2).sum())


@kernel
def _along_seams(sheets, found):
    """Write the half-edges along seams; how many there are."""
    count = 0
    for e in range(3 * sheets.state[SURFACE_SLOTS]):
        if sheets.vertex[e - e % 3] != UNUSED and sheets.curve[e] >= SEAM_CURVES:
            found[count] = e
            count += 1
    return count


@kernel
def _halve_all(sheets, pairs, made):
    """Halve the edge of each pair of vertices, and write the new vertices, which are corners."""
    for i in range(pairs.shape[0]):
        m = split_edge(sheets, edge_between(sheets, pairs[i, 0], pairs[i, 1]))
        sheets.kind[m] = CORNER
        made[i] = m


def follow_sizes(complex: SurfaceComplex, longest: float, room: int) -> int:
    """Halve edges of seams, in all sheets alike, until they are short enough; how many vertices were made.

    Parameters
    ----------
    complex : SurfaceComplex
    longest : float
        The largest length, in wanted ones: in the shortest that is wanted at an end in any of the sheets.
    room : int
        How many vertices there may be, at most.
    """
    total = 0
    while True:
        s = complex.sheets
        found = np.empty(len(s.vertex), dtype=np.int64)
        sides = found[: _along_seams(s, found)]
        if not len(sides):
            return total
        u, w = (s.vertex[sides - sides % 3 + (sides + k) % 3] for k in (1, 2))
        ends = np.sort(np.stack([complex.masters(u), complex.masters(w)], axis=1), axis=1)
        edge = np.unique(ends, axis=0, return_inverse=True)[1].ravel()
        d = s.xyz[w] - s.xyz[u]
        length = np.sqrt(d[:, 0] ** 2 + d[:, 1] ** 2 + d[:, 2] ** 2)
        wanted = np.full(int(edge.max()) + 1, np.inf)
        np.minimum.at(wanted, edge, 0.5 * (s.size[u] + s.size[w]))
        chosen = length > longest * wanted[edge]
        many = int(chosen.sum())
        if many == 0 or many > room - total:
            return total
        complex.grow(many, 2 * many)
        made = np.empty(many, dtype=np.int64)
        _halve_all(complex.sheets, np.stack([u, w], axis=1)[chosen].astype(np.int64), made)
        _, first, group = np.unique(edge[chosen], return_index=True, return_inverse=True)
        complex.unite(made, made[first[group.ravel()]])
        total += many
