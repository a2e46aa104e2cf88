"""Nearest points of a given surface and of its feature curves, for kernels: a walk, made sure by a tree.

A walk looks at the triangles that touch the nearest point of its triangle, and steps to one that is nearer.
It ends where no neighbor is nearer, or after some steps. That may be a wrong place, where a surface comes
close to itself. A search in the tree of boxes, with the distance of the walk as its bound
from the beginning, then looks at few boxes, and is certain (up to rounding of the distances).

With a normal, only triangles count whose normal has a positive product with it: the other side of a thin
plate does not, nor do flat triangles, whose normal is zero. A surface may be held more strictly: other
parts, which it is not joined to, do not count then, and triangles come first whose normals are nearer to the
given one. Where a surface crosses itself, the other sheet is as near.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.jit import apart, inline, kernel
from .boxes import BOXES_IN_LEAF, square_to_box
from .segment_tree import to_box
from .support_features import united
from .triangle_tree import onto, square_to_triangle

__all__ = [
    "WAITING_BOXES",
    "Held",
    "chain_rows",
    "nearest_from",
    "nearest_on_chain",
    "nearest_rows",
    "strictly",
    "walked",
]

FARTHEST_WALK = 24  # steps: from farther away a search in the tree is quicker
ON_SIDE = 1e-7  # a point whose weight of a corner is less may lie on the opposite side, but for rounding
MOST_AROUND = 24  # triangles at a vertex: from a vertex of more, a walk gives way to the tree
SHORT_CURVE = 12  # of a curve: all of them are looked at, without the tree
NEAR_COSINE_SQUARED = 0.25  # 60 degrees
WAITING_BOXES = 128  # boxes that wait; a tree of boxes is never half as deep


class Held(NamedTuple):
    """A given surface, for kernels; coordinates are scaled by the `factor` of its `Support`.

    Attributes
    ----------
    corners : (m, 3, 3)
    rows : (m, 3) int64
        Vertices of the triangles, equal ones with one number.
    normals : (m, 3)
        Unit vectors; zero for flat triangles.
    start, around : int64
        The triangles at vertex v are ``around[start[v] : start[v + 1]]``.
    low, high, order
        The tree of boxes of the triangles.
    edges : (k, 3, 3)
        Feature edges as triangles whose last two corners are equal.
    chain : (k,) int64
    edge_low, edge_high, edge_order
        The tree of boxes of the feature edges.
    part : (m,) int64
        Only triangles with the number of that of the guess count. All 0, if it is not held strictly.
    least : float
        The square of the cosine that comes first; 0 without strictness.
    """

    corners: NDArray[np.float64]
    rows: NDArray[np.int64]
    normals: NDArray[np.float64]
    start: NDArray[np.int64]
    around: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    order: NDArray[np.int64]
    edges: NDArray[np.float64]
    chain: NDArray[np.int64]
    edge_low: NDArray[np.float64]
    edge_high: NDArray[np.float64]
    edge_order: NDArray[np.int64]
    part: NDArray[np.int64]
    least: float


@inline
def _admitted(normals, t, n, least):
    """Whether triangle t faces the direction n; with n = 0, all do."""
    if n[0] == 0.0 and n[1] == 0.0 and n[2] == 0.0:
        return True
    along = normals[t, 0] * n[0] + normals[t, 1] * n[1] + normals[t, 2] * n[2]
    return along > 0.0 and along * along >= least * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2])


@kernel
def _joined_parts(rows, one, two):
    """Write pairs of vertices that are in one triangle."""
    for t in range(rows.shape[0]):
        one[2 * t], two[2 * t] = rows[t, 0], rows[t, 1]
        one[2 * t + 1], two[2 * t + 1] = rows[t, 1], rows[t, 2]


def strictly(held: Held) -> Held:
    """The same surface, its sheets kept apart as far as parts and directions tell them."""
    one, two = (np.empty(2 * len(held.rows), dtype=np.int64) for _ in range(2))
    _joined_parts(held.rows, one, two)
    parent = np.arange(len(held.start))
    united(one, two, parent)
    return held._replace(part=parent[held.rows[:, 0]], least=NEAR_COSINE_SQUARED)


@inline
def _is_in(rows, t, v):
    return rows[t, 0] == v or rows[t, 1] == v or rows[t, 2] == v


@apart
def walked(held, p, n, t, place):
    """Walk from triangle t to one that is nearer to p (3,) than all that touch it there, if it is not far.

    Parameters
    ----------
    held : Held
    p, n : (3,) float64
        The point, in scaled coordinates, and the direction that triangles must face; zero for any.
    t : int
        Where to begin; it need not face n.
    place : (6,) float64
        Receives the weights of the corners in the first three entries; the others are scratch.

    Returns
    -------
    int
        The triangle; -1 - t if it does not face n.
    """
    rows, trial = held.rows, place[3:]
    best = onto(p, held.corners[t], place)
    good = _admitted(held.normals, t, n, held.least)
    for _ in range(FARTHEST_WALK):
        moved = False
        k = 0 if place[0] > ON_SIDE else (1 if place[1] > ON_SIDE else 2)  # it depends on this corner
        v, other, inner = rows[t, k], -1, min(place[0], min(place[1], place[2])) > ON_SIDE
        for j in range(k + 1, 3):
            if place[j] > ON_SIDE:
                other = rows[t, j]
        if good and (inner or held.start[v + 1] - held.start[v] > MOST_AROUND):
            break  # only the plane of t matters near an inner point
        now = t
        for i in range(held.start[v], held.start[v + 1]):
            s = held.around[i]
            if s == now or not _admitted(held.normals, s, n, held.least):
                continue
            if good and other >= 0 and not _is_in(rows, s, other):
                continue
            if good and square_to_triangle(p[0], p[1], p[2], held.corners, s) >= best:
                continue
            square = onto(p, held.corners[s], trial)
            if square < best or not good:
                best, t, good, moved = square, s, True, True
                place[0], place[1], place[2] = trial[0], trial[1], trial[2]
        if not moved:
            break
    return t if good else -1 - t


@apart
def _searched(held, x, q, n, t, best, place, stack):
    """The triangle nearest to point x[q] of those that face n and are nearer than sqrt(best), else t.

    If t is negative, it is -1 - t with t any triangle in the right part; if none faces n, then all count.
    """
    part = held.part[max(t, -1 - t)]
    low, high, order, corners, trial = held.low, held.high, held.order, held.corners, place[3:]
    leaves, px, py, pz = low.shape[0] // 2, x[q, 0], x[q, 1], x[q, 2]
    for level in range(3):
        least = held.least if level == 0 else 0.0
        stack[0], size = 1, 1
        while size > 0:
            size -= 1
            w = stack[size]
            if square_to_box(px, py, pz, low, high, w) >= best:
                continue
            if w >= leaves:
                first = (w - leaves) * BOXES_IN_LEAF
                for k in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                    if held.part[order[k]] != part:
                        continue
                    if level < 2 and not _admitted(held.normals, order[k], n, least):
                        continue
                    if square_to_triangle(px, py, pz, corners, order[k]) >= best:
                        continue
                    square = onto(x[q], corners[order[k]], trial)
                    if square < best:
                        best, t = square, order[k]
                        place[0], place[1], place[2] = trial[0], trial[1], trial[2]
                continue
            one, two = 2 * w, 2 * w + 1
            if square_to_box(px, py, pz, low, high, one) < square_to_box(px, py, pz, low, high, two):
                one, two = two, one
            stack[size], stack[size + 1] = one, two
            size += 2
        if t >= 0:
            break
    return t


@apart
def nearest_from(held, x, q, n, t, place, stack):
    """The triangle of the surface that is nearest to point x[q], of those that face n, from a good guess t.

    Parameters
    ----------
    held : Held
    x : (k, 3) float64
        Points, in scaled coordinates.
    q : int
    n : (3,) float64
        The direction that the triangle must face, zero for any. If no triangle faces it, all count.
    t : int
        Where the walk begins: the result for a point close by.
    place : (6,) float64
        Receives the weights of the corners in its first three entries.
    stack : (`WAITING_BOXES`,) int64
        Scratch.

    Returns
    -------
    int
    """
    found = walked(held, x[q], n, t, place)
    best = onto(x[q], held.corners[found], place) if found >= 0 else np.inf
    return _searched(held, x, q, n, found, best, place, stack)


@kernel
def nearest_rows(held, x, normals, which, places):
    """`nearest_from` for many points; ``which`` has the guesses, -1 for the triangle of the point before."""
    place, stack, last = np.zeros(6), np.empty(WAITING_BOXES, dtype=np.int64), 0
    for q in range(x.shape[0]):
        last = which[q] if which[q] >= 0 else last
        last = nearest_from(held, x, q, normals[q], last, place, stack)
        which[q] = last
        places[q, 0], places[q, 1], places[q, 2] = place[0], place[1], place[2]


@inline
def _edges_of(chains, chain):
    """The first edge of a chain and the one after its last: chains are sorted."""
    low, high = 0, chains.shape[0]
    while low < high:
        middle = (low + high) // 2
        if chains[middle] < chain:
            low = middle + 1
        else:
            high = middle
    first, high = low, chains.shape[0]
    while low < high:
        middle = (low + high) // 2
        if chains[middle] <= chain:
            low = middle + 1
        else:
            high = middle
    return first, low


@kernel
def nearest_on_chain(held, x, q, chain, place, stack):
    """The feature edge of a chain that is nearest to x[q], -1 if there is none.

    ``place[1]`` receives the parameter on the edge, from 0 to 1 (the weights of its ends are ``place[0]`` and
    ``place[1]``). A chain of -1 stands for all of them.
    """
    low, high, order = held.edge_low, held.edge_high, held.edge_order
    leaves, trial = low.shape[0] // 2, place[3:]
    best, found = np.inf, -1
    first, last = _edges_of(held.chain, chain) if chain >= 0 else (0, 0)
    step = 1 if last - first <= SHORT_CURVE else (last - first) // SHORT_CURVE  # a bound from the beginning
    for e in range(first, last, step):
        square = onto(x[q], held.edges[e], trial)
        if square < best:
            best, found = square, e
            place[1] = trial[1] + trial[2]
            place[0] = 1.0 - place[1]
    if found >= 0 and step == 1:
        return found
    stack[0], size = 1, 1
    while size > 0:
        size -= 1
        w = stack[size]
        if to_box(x, q, low, high, w) ** 2 >= best:
            continue
        if w >= leaves:
            first = (w - leaves) * BOXES_IN_LEAF
            for k in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                if chain >= 0 and held.chain[order[k]] != chain:
                    continue
                square = onto(x[q], held.edges[order[k]], trial)
                if square < best:
                    best, found = square, order[k]
                    place[1] = trial[1] + trial[2]
                    place[0] = 1.0 - place[1]
            continue
        one, two = 2 * w, 2 * w + 1
        if to_box(x, q, low, high, one) < to_box(x, q, low, high, two):
            one, two = two, one
        stack[size], stack[size + 1] = one, two
        size += 2
    return found


@kernel
def chain_rows(held, x, chain, which, places):
    """`nearest_on_chain` for many points, each with its chain."""
    place, stack = np.zeros(6), np.empty(WAITING_BOXES, dtype=np.int64)
    for q in range(x.shape[0]):
        which[q] = nearest_on_chain(held, x, q, chain[q], place, stack)
        places[q] = place[1]
