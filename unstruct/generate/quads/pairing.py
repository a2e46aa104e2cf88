"""Pairs of triangles that become convex quadrilaterals: the best first, then exchanges that make more.

See the book, chapters 4b and 6c.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...predicates.batch import scaled
from ...predicates.kernels import orient2

__all__ = ["corner_cosine", "pairs_of_triangles"]

MOST_COSINE = 0.77  # of the angles of a quadrilateral: they are between 39.6 and 140.4 degrees
DEEPEST_EXCHANGE = 8  # pairs that are exchanged at once
NO_PAIR = 9.0


@inline
def corner_cosine(xy, a, b, c):
    """The cosine of the angle at b of the path a, b, c."""
    ux, uy, vx, vy = xy[a, 0] - xy[b, 0], xy[a, 1] - xy[b, 1], xy[c, 0] - xy[b, 0], xy[c, 1] - xy[b, 1]
    squares = (ux * ux + uy * uy) * (vx * vx + vy * vy)
    return (ux * vx + uy * vy) / math.sqrt(squares) if squares > 0.0 else 1.0


@inline
def _cost(xy, a, p, b, q, sharpest):
    """The largest cosine of the quadrilateral a, p, b, q, or `NO_PAIR`; its halves apq, bqp are positive."""
    worst = max(
        max(abs(corner_cosine(xy, q, a, p)), abs(corner_cosine(xy, a, p, b))),
        max(abs(corner_cosine(xy, p, b, q)), abs(corner_cosine(xy, b, q, a))),
    )
    if not worst <= sharpest:
        return NO_PAIR
    if orient2(xy[a, 0], xy[a, 1], xy[p, 0], xy[p, 1], xy[b, 0], xy[b, 1]) <= 0:
        return NO_PAIR
    if orient2(xy[b, 0], xy[b, 1], xy[q, 0], xy[q, 1], xy[a, 0], xy[a, 1]) <= 0:
        return NO_PAIR
    return worst


@kernel
def _costs(xy, triangles, neighbors, closed, sharpest, cost):
    """The cost of the pair across each side; a side belongs to the triangle with the lower number."""
    for t in range(len(triangles)):
        for i in range(3):
            o = neighbors[t, i]
            cost[t, i] = NO_PAIR
            if o < 0 or closed[t, i]:
                continue
            a, p, q = triangles[t, i], triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]
            j = 0
            while neighbors[o, j] != t:
                j += 1
            if o < t:
                cost[t, i] = cost[o, j]
            else:
                cost[t, i] = _cost(xy, a, p, triangles[o, j], q, sharpest)


@kernel
def _greedy(order, neighbors, mate):
    for e in order:
        t, o = e // 3, neighbors[e // 3, e % 3]
        if mate[t] < 0 and mate[o] < 0:
            mate[t], mate[o] = o, t


@kernel
def _exchange(neighbors, cost, mate):
    """Paths from a single triangle to another, over sides that may and pairs that do join, turned over.

    Depth-first, to a depth; no triangle twice on a path. Returns how many pairs were won.
    """
    path = np.empty(DEEPEST_EXCHANGE + 1, dtype=np.int64)  # triangles that look for a mate
    side = np.empty(DEEPEST_EXCHANGE + 1, dtype=np.int64)  # at which side each is looking
    on = np.zeros(len(mate), dtype=np.bool_)
    won = 0
    for t in range(len(mate)):
        if mate[t] >= 0:
            continue
        depth = 0
        path[0], side[0], on[t] = t, 0, True
        while depth >= 0:
            s, i = path[depth], side[depth]
            if i == 3:
                on[s] = False
                if depth > 0:
                    on[mate[s]] = False
                depth -= 1
                continue
            side[depth] += 1
            o = np.int64(neighbors[s, i])
            if cost[s, i] >= NO_PAIR or on[o]:
                continue
            if mate[o] < 0:
                for d in range(depth, -1, -1):
                    s = path[d]
                    on[s] = False
                    if d > 0:
                        on[mate[s]] = False
                    other = np.int64(neighbors[s, side[d] - 1])
                    mate[s], mate[other] = other, s
                won += 1
                break
            if depth < DEEPEST_EXCHANGE and not on[mate[o]]:
                depth += 1
                path[depth], side[depth] = mate[o], 0
                on[o] = on[mate[o]] = True
    return won


def pairs_of_triangles(
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    closed: NDArray[np.bool_],
    sharpest: float = MOST_COSINE,
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]]:
    """Pair triangles to convex quadrilaterals, with angles between 39.6 and 140.4 degrees unless told.

    Parameters
    ----------
    points : (n, 2) float64
    triangles, neighbors : (m, 3) int32
        Positively oriented.
    closed : (m, 3) bool
        Sides across which there are no pairs.
    sharpest : float
        The largest cosine of an angle.

    Returns
    -------
    single : (t,) int64
        Triangles without a mate.
    quads : (q, 4) int32
        Counterclockwise; convex, exactly.
    both : (q, 2) int64
        The triangles of each.

    Notes
    -----
    Greedy by the largest deviation from right angles, then alternating paths of at most 8 exchanges:
    O(m log m). Of ties the first.
    """
    xy, _ = scaled(points)
    cost = np.empty(triangles.shape)
    _costs(xy, triangles, neighbors, closed, sharpest, cost)
    sides = np.flatnonzero((cost < NO_PAIR) & (neighbors > np.arange(len(triangles))[:, None]))
    mate = np.full(len(triangles), -1, dtype=np.int64)
    _greedy(sides[np.argsort(cost.ravel()[sides], kind="stable")], neighbors, mate)
    _exchange(neighbors, cost, mate)
    single = np.flatnonzero(mate < 0)
    first = np.flatnonzero(mate > np.arange(len(mate)))
    i = (neighbors[first] == mate[first, None]).argmax(axis=1)
    j = (neighbors[mate[first]] == first[:, None]).argmax(axis=1)
    rows = triangles[first]
    corner = [rows[np.arange(len(first)), (i + k) % 3] for k in range(3)]
    other = triangles[mate[first], j]
    quads = np.column_stack([corner[0], corner[1], other, corner[2]]).astype(np.int32)
    return single, quads, np.column_stack([first, mate[first]])
