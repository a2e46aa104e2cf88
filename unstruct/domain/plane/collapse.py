"""Dropping vertices of straight chains one by one, the least deviation first: the kernels of `simplified`.

A vertex v between two straight pieces, from a to v and from v to b, may be dropped if the closed triangle of
a, v, b contains no other vertex, no seed and no part of a curve, and a and b are not joined already. Then
the piece from a to b meets no other piece except in common vertices, and everything stays on its side: a
piece that enters the triangle has to end in it, since it crosses neither of the two old pieces.

      a . . . . . b        the run of a piece: the vertices that have been dropped between
       \\         /         its ends; each is within its tolerance of the piece
        \\   .   /
          - v -
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...base.heap import pop, push
from ...base.jit import inline, kernel, lean
from ...geometry.boxes import BOXES_IN_LEAF
from ...predicates.kernels import orient2, orientation

__all__ = ["Blockers", "Chains", "Limits", "collapse", "link"]

DISTANCE_ERROR = (
    2.0**-50
)  # a bound on the rounding error of a distance, in units of the length of the segment
CERTAINLY_BEYOND = 1e-15  # a relative bound above the rounding errors of a cross product


class Chains(NamedTuple):
    """Straight pieces in chains between fixed vertices, or around in a ring; free vertices lie between them.

    Attributes
    ----------
    ends : (m, 2) int64
        The vertices of each piece along its chain; -1 for pieces that are gone.
    first, dropped : (m,) int64
        The first vertex of its run, and how many there are.
    chain : (m,) int64
    into, out : (n,) int64
        The pieces before and after each free vertex; -1 for other vertices.
    after : (n,) int64
        For each free vertex the vertex after it in the input.
    tips : (c, 2) int64
        The fixed vertices of each chain; -1 for rings.
    left : (c,) int64
        How many pieces the chain has now.
    """

    ends: np.ndarray
    first: np.ndarray
    dropped: np.ndarray
    chain: np.ndarray
    into: np.ndarray
    out: np.ndarray
    after: np.ndarray
    tips: np.ndarray
    left: np.ndarray


class Limits(NamedTuple):
    """Per vertex how far away it may be from the new boundary, and the wanted length (inf without a size)."""

    tolerance: np.ndarray
    wanted: np.ndarray


class Blockers(NamedTuple):
    """A tree over what no triangle may contain: first the vertices, then seeds and boxes of curves.

    ``leaf`` is the leaf of each item, ``alive`` how many items below each node are still there.
    ``begin`` and ``at`` list the chains at each fixed vertex; ``stack`` is room for searches.
    """

    low: np.ndarray
    high: np.ndarray
    order: np.ndarray
    box_low: np.ndarray
    box_high: np.ndarray
    leaf: np.ndarray
    alive: np.ndarray
    begin: np.ndarray
    at: np.ndarray
    stack: np.ndarray


class _Waiting(NamedTuple):
    """Vertices that wait until the one that blocks them is gone: a doubly linked list for each blocker."""

    head: np.ndarray
    next: np.ndarray
    before: np.ndarray
    blocker: np.ndarray


# ---------------------------------------------------------------------- chains


@kernel
def link(pieces, free, begin, around, chains):
    """Fill in the chains of straight pieces; return their number. Turned pieces get their ends exchanged.

    ``begin`` and ``around`` list the pieces at each vertex. Chains between fixed vertices come first.
    """
    chain, tips, left = chains.chain, chains.tips, chains.left
    many = 0
    for v in range(free.shape[0]):
        if free[v]:
            continue
        for k in range(begin[v], begin[v + 1]):
            if chain[around[k]] < 0:
                tips[many, 0] = v
                tips[many, 1], left[many] = _walk(v, around[k], many, pieces, free, begin, around, chains)
                many += 1
    for s in range(pieces.shape[0]):
        if chain[s] < 0:
            tips[many, 0] = tips[many, 1] = -1
            v = pieces[s, 0]
            left[many] = _walk(v, s, many, pieces, free, begin, around, chains)[1]
            chains.out[v] = s
            chains.after[v] = chains.ends[s, 1]
            many += 1
    return many


@kernel
def _walk(v, s, number, pieces, free, begin, around, chains):
    """Number the pieces from vertex v along piece s on; return the last vertex and how many pieces."""
    length = 0
    while chains.chain[s] < 0:
        w = pieces[s, 1] if pieces[s, 0] == v else pieces[s, 0]
        chains.ends[s, 0], chains.ends[s, 1] = v, w
        chains.chain[s], chains.first[s], chains.dropped[s] = number, -1, 0
        length += 1
        if length > 1:
            chains.out[v] = s
            chains.after[v] = w
        if not free[w]:
            return w, length
        chains.into[w] = s
        s = around[begin[w] + 1] if around[begin[w]] == s else around[begin[w]]
        v = w
    return v, length


@lean
def _joined(chains, blockers, a, b):
    """Whether a straight piece joins a to b besides the two that meet in the vertex between them."""
    if chains.into[a] >= 0:
        return chains.ends[chains.into[a], 0] == b
    if chains.into[b] >= 0:
        return chains.ends[chains.out[b], 1] == a
    begin, at, tips, left = blockers.begin, blockers.at, chains.tips, chains.left
    if begin[a + 1] - begin[a] > begin[b + 1] - begin[b]:
        a, b = b, a
    for k in range(begin[a], begin[a + 1]):
        c = at[k]
        if left[c] == 1 and (tips[c, 0] == b or tips[c, 1] == b):
            return True
    return a == b


# ---------------------------------------------------------------------- deviation


@inline
def _excess(xy, a, b, w, tolerance):
    """The distance from vertex w to the segment from a to b, in units of the tolerance; never too small."""
    ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    wx, wy = xy[w, 0] - xy[a, 0], xy[w, 1] - xy[a, 1]
    length = np.sqrt(ux * ux + uy * uy)
    along = ux * wx + uy * wy
    if along <= 0.0:
        away = np.sqrt(wx * wx + wy * wy)
    elif along >= length * length:
        wx, wy = xy[w, 0] - xy[b, 0], xy[w, 1] - xy[b, 1]
        away = np.sqrt(wx * wx + wy * wy)
    else:
        away = abs(ux * wy - uy * wx) / length
    return (away * (1.0 + DISTANCE_ERROR) + DISTANCE_ERROR * length) / tolerance[w]


@lean
def _deviation(xy, chains, limits, v):
    """The largest excess over the run that dropping v would make; infinite if v is not to be dropped."""
    before, behind = chains.into[v], chains.out[v]
    a, b = chains.ends[before, 0], chains.ends[behind, 1]
    if limits.wanted[v] < np.inf:
        near = min(
            (xy[a, 0] - xy[v, 0]) ** 2 + (xy[a, 1] - xy[v, 1]) ** 2,
            (xy[b, 0] - xy[v, 0]) ** 2 + (xy[b, 1] - xy[v, 1]) ** 2,
        )
        if near >= limits.wanted[v] ** 2:
            return np.inf
    worst = _excess(xy, a, b, v, limits.tolerance)
    for s in (before, behind):
        w = chains.first[s]
        for _ in range(chains.dropped[s]):
            if worst > 1.0:
                return np.inf
            worst = max(worst, _excess(xy, a, b, w, limits.tolerance))
            w = chains.after[w]
    return worst if worst <= 1.0 else np.inf


# ---------------------------------------------------------------------- what is in the way


@inline
def _beyond(ax, ay, bx, by, x0, y0, x1, y1):
    """Whether the box from (x0, y0) to (x1, y1) certainly lies strictly to the right of the line ab."""
    dx, dy = bx - ax, by - ay
    left = dx * ((y1 if dx > 0 else y0) - ay) - dy * ((x0 if dy > 0 else x1) - ax)
    wide, tall = abs(x0 - ax) + abs(x1 - ax), abs(y0 - ay) + abs(y1 - ay)
    return left < -CERTAINLY_BEYOND * (abs(dx) * tall + abs(dy) * wide) - 1e-290


@lean
def _outside(corners, low, high, i):
    """Whether box i certainly does not meet a triangle, by the triangle's box and its three lines."""
    ax, ay, bx, by, cx, cy = corners
    x0, y0, x1, y1 = low[i, 0], low[i, 1], high[i, 0], high[i, 1]
    if x0 > max(ax, bx, cx) or x1 < min(ax, bx, cx) or y0 > max(ay, by, cy) or y1 < min(ay, by, cy):
        return True
    return (
        _beyond(ax, ay, bx, by, x0, y0, x1, y1)
        or _beyond(bx, by, cx, cy, x0, y0, x1, y1)
        or _beyond(cx, cy, ax, ay, x0, y0, x1, y1)
    )


@lean
def _holds(corners, px, py):
    """Whether a closed counterclockwise triangle contains a point; exact."""
    ax, ay, bx, by, cx, cy = corners
    for _ in range(3):
        if orient2(ax, ay, bx, by, px, py) < 0:
            return False
        ax, ay, bx, by, cx, cy = bx, by, cx, cy, ax, ay
    return True


@lean
def _in_the_way(xy, blockers, a, v, b):
    """An item in the closed triangle a, v, b, other than its corners; -1 if there is none."""
    turn = orientation(xy, a, v, b)
    if turn == 0:  # v lies between a and b
        return -1
    if turn < 0:
        a, b = b, a
    corners = (xy[a, 0], xy[a, 1], xy[v, 0], xy[v, 1], xy[b, 0], xy[b, 1])
    low, high, stack = blockers.box_low, blockers.box_high, blockers.stack
    leaves = blockers.low.shape[0] // 2
    top = 1
    stack[0] = 1
    while top > 0:
        top -= 1
        node = stack[top]
        if blockers.alive[node] == 0 or _outside(corners, blockers.low, blockers.high, node):
            continue
        if node < leaves:
            stack[top] = 2 * node
            stack[top + 1] = 2 * node + 1
            top += 2
            continue
        start = (node - leaves) * BOXES_IN_LEAF
        for k in range(start, min(start + BOXES_IN_LEAF, blockers.order.shape[0])):
            i = blockers.order[k]
            if blockers.leaf[i] < 0 or i == a or i == v or i == b or _outside(corners, low, high, i):
                continue
            point = low[i, 0] == high[i, 0] and low[i, 1] == high[i, 1]
            if not point or _holds(corners, low[i, 0], low[i, 1]):
                return i
    return -1


@lean
def _unlink(waiting, v):
    """Take v out of the list of its blocker, if it is in one."""
    w = waiting.blocker[v]
    if w >= 0:
        if waiting.before[v] >= 0:
            waiting.next[waiting.before[v]] = waiting.next[v]
        else:
            waiting.head[w] = waiting.next[v]
        if waiting.next[v] >= 0:
            waiting.before[waiting.next[v]] = waiting.before[v]
        waiting.blocker[v] = -1


@lean
def _wait(waiting, v, w):
    """Put v into the list of its blocker w."""
    waiting.blocker[v], waiting.before[v], waiting.next[v] = w, -1, waiting.head[w]
    if waiting.head[w] >= 0:
        waiting.before[waiting.head[w]] = v
    waiting.head[w] = v


# ---------------------------------------------------------------------- the loop


@lean
def _drop(chains, blockers, v):
    """Replace the two pieces at v by one; return its ends."""
    before, behind = chains.into[v], chains.out[v]
    if chains.dropped[before] == 0:
        chains.first[before] = v
    chains.dropped[before] += chains.dropped[behind] + 1
    b = chains.ends[behind, 1]
    chains.ends[before, 1] = b
    chains.ends[behind, 0] = chains.ends[behind, 1] = -1
    chains.left[chains.chain[before]] -= 1
    if chains.into[b] >= 0:
        chains.into[b] = before
    node = blockers.leaf[v]
    blockers.leaf[v] = -1
    while node > 0:
        blockers.alive[node] -= 1
        node //= 2
    return chains.ends[before, 0], b


@kernel
def collapse(xy, chains, limits, blockers):
    """Drop free vertices as long as that is possible, the least excess first; return how many.

    A vertex whose triangle is not empty waits until what is in the way is gone, or until it has other
    neighbors. So in the end no free vertex can be dropped.
    """
    n = chains.into.shape[0]
    key = np.full(n, np.inf)
    heap, what, size = np.empty(3 * n + 1), np.empty(3 * n + 1, dtype=np.int64), 0
    waiting = _Waiting(np.full(n, -1), np.full(n, -1), np.full(n, -1), np.full(n, -1))
    for v in range(n):
        if chains.into[v] >= 0 and blockers.leaf[v] >= 0:
            key[v] = _deviation(xy, chains, limits, v)
            if key[v] < np.inf:
                size = push(heap, what, size, key[v], v)
    dropped = 0
    while size > 0:
        v, now = what[0], heap[0]
        size = pop(heap, what, size)
        if blockers.leaf[v] < 0 or now != key[v] or waiting.blocker[v] >= 0:
            continue
        a, b = chains.ends[chains.into[v], 0], chains.ends[chains.out[v], 1]
        if _joined(chains, blockers, a, b):
            continue
        w = _in_the_way(xy, blockers, a, v, b)
        if w >= 0:
            if w < n:
                _wait(waiting, v, w)
            continue
        a, b = _drop(chains, blockers, v)
        dropped += 1
        for u in (a, b):
            if chains.into[u] >= 0:
                _unlink(waiting, u)
                key[u] = _deviation(xy, chains, limits, u)
                if key[u] < np.inf:
                    size = push(heap, what, size, key[u], u)
        u = waiting.head[v]
        while u >= 0:
            following = waiting.next[u]
            waiting.blocker[u] = -1
            size = push(heap, what, size, key[u], u)
            u = following
        waiting.head[v] = -1
    return dropped
