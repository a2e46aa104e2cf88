"""Edges that face each other, and how far apart they are, in kernels."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...geometry.boxes import BoxTree

__all__ = ["beside", "mark_crowded", "mark_long"]

FACING = 0.35  # the sine of the angle under which edges see each other's middles at least, if they face


def beside(
    x: NDArray[np.float64], edges: NDArray[np.int64], many: int, factor: float
) -> tuple[tuple[NDArray[np.int64], NDArray[np.int64]], NDArray[np.float64]]:
    """Pairs of one of the first edges and any edge that may be nearer than a factor times the length of it.

    Returns the lengths of all edges, too.
    """
    (low, high, query_low, query_high), length = np.empty((4, len(edges), 2)), np.empty(len(edges))
    _enclose_edges(x, edges, factor, (low, high), (query_low, query_high), length)
    return BoxTree(low, high).pairs(query_low[:many], query_high[:many]), length


@kernel
def _enclose_edges(x, edges, factor, boxes, queries, length):
    """Write the boxes of edges, wider ones, and their lengths."""
    for i in range(len(edges)):
        a, b = edges[i, 0], edges[i, 1]
        length[i] = math.hypot(x[b, 0] - x[a, 0], x[b, 1] - x[a, 1])
        for k in range(2):
            low, high = min(x[a, k], x[b, k]), max(x[a, k], x[b, k])
            boxes[0][i, k], boxes[1][i, k] = low, high
            queries[0][i, k], queries[1][i, k] = low - factor * length[i], high + factor * length[i]


@inline
def _foot(px, py, ax, ay, bx, by):
    """Where on the segment ab the nearest point to p is, from 0 to 1, and its distance."""
    ux, uy = bx - ax, by - ay
    t = ((px - ax) * ux + (py - ay) * uy) / max(ux * ux + uy * uy, 1e-300)
    t = min(max(t, 0.0), 1.0)
    return t, math.hypot(px - ax - t * ux, py - ay - t * uy)


@inline
def _nearest(x, edges, i, j):
    """The nearest places on edges i and j that do not cross, from 0 to 1, and their distance."""
    a, b, c, d = edges[i, 0], edges[i, 1], edges[j, 0], edges[j, 1]
    t, least = _foot(x[c, 0], x[c, 1], x[a, 0], x[a, 1], x[b, 0], x[b, 1])
    s = 0.0
    place, away = _foot(x[d, 0], x[d, 1], x[a, 0], x[a, 1], x[b, 0], x[b, 1])
    if away < least:
        t, s, least = place, 1.0, away
    place, away = _foot(x[a, 0], x[a, 1], x[c, 0], x[c, 1], x[d, 0], x[d, 1])
    if away < least:
        t, s, least = 0.0, place, away
    place, away = _foot(x[b, 0], x[b, 1], x[c, 0], x[c, 1], x[d, 0], x[d, 1])
    if away < least:
        t, s, least = 1.0, place, away
    return t, s, least


@inline
def _share(rows, i, j):
    """Whether two rows of two numbers have one in common."""
    a, b = rows[i, 0], rows[i, 1]
    return a == rows[j, 0] or a == rows[j, 1] or b == rows[j, 0] or b == rows[j, 1]


@inline
def _leftward(x, edges, i, u, v):
    """The product of a vector and the left normal of edge i, which is as long as the edge."""
    a, b = edges[i, 0], edges[i, 1]
    return u * (x[a, 1] - x[b, 1]) + v * (x[b, 0] - x[a, 0])


@kernel
def mark_long(x, edges, corners, pairs, length, gap, long):
    """Mark the sides that are longer than ``gap`` times the distance to an edge that they face.

    Parameters
    ----------
    x : (n, 2) float64
    edges, corners : (e, 2) int
        First the sides, with what is meshed on their left; then edges that may be faced from both sides. And
        the corners of the pieces that they are part of: pieces that share one are as near as its angle makes
        them.
    pairs : tuple of ndarray
        A side and an edge each.
    length : (e,) float64
    gap : float
    long : (m,) bool
        For each side.
    """
    first, second = pairs
    for row in range(len(first)):
        i, j = first[row], second[row]
        if _share(edges, i, j) or _share(corners, i, j):
            continue
        t, s, distance = _nearest(x, edges, i, j)
        a, b, c, d = edges[i, 0], edges[i, 1], edges[j, 0], edges[j, 1]
        u = x[c, 0] + s * (x[d, 0] - x[c, 0]) - (x[a, 0] + t * (x[b, 0] - x[a, 0]))
        v = x[c, 1] + s * (x[d, 1] - x[c, 1]) - (x[a, 1] + t * (x[b, 1] - x[a, 1]))
        if not _leftward(x, edges, i, u, v) > 0.0:
            continue
        if j >= len(long) or _leftward(x, edges, j, u, v) < 0.0:
            long[i] |= length[i] > gap * distance


@kernel
def mark_crowded(x, edges, pairs, length, room, many, crowded):
    """Mark edges that another edge faces at less than ``room`` times the length of the first, and that one.

    As for `mark_long`, but edges face each other if their middles do; the first ``many`` edges have a left.
    """
    first, second = pairs
    for row in range(len(first)):
        i, j = first[row], second[row]
        if _share(edges, i, j):
            continue
        a, b, c, d = edges[i, 0], edges[i, 1], edges[j, 0], edges[j, 1]
        u = (x[c, 0] + x[d, 0]) / 2 - (x[a, 0] + x[b, 0]) / 2
        v = (x[c, 1] + x[d, 1]) / 2 - (x[a, 1] + x[b, 1]) / 2
        far = FACING * math.hypot(u, v)
        if not _leftward(x, edges, i, u, v) > far * length[i]:
            continue
        if j >= many or _leftward(x, edges, j, u, v) < -far * length[j]:
            if _nearest(x, edges, i, j)[2] < room * length[i]:
                crowded[i] = crowded[j] = True
