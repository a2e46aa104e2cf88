"""Which given segments and triangles are edges and faces of a complex: one pass over all cells.

The goals are sorted by their lowest vertex; of a closed surface a vertex has three edges and two triangles of
its own. So each edge and face of a cell is compared with very few of them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ..insertion.engine import COUNT
from .held import hold
from .records import Held, Solid
from .refill import EDGE

__all__ = ["all_faces", "edges_there", "look_up"]


@kernel
def _by_lowest(goals, width, start, order):
    """Sort goals by the lowest of their first ``width`` vertices: those of v are from ``start[v]`` on."""
    for g in range(goals.shape[0]):
        low = goals[g, 0]
        for k in range(1, width):
            low = min(low, goals[g, k])
        start[low] += 1
    for v in range(1, start.shape[0]):
        start[v] += start[v - 1]
    for g in range(goals.shape[0] - 1, -1, -1):
        low = goals[g, 0]
        for k in range(1, width):
            low = min(low, goals[g, k])
        start[low] -= 1
        order[start[low]] = g


@kernel
def _faces(solid, goals, start, order, face):
    """Write for each goal, a row of three vertices, the face that it is, as 4 t + k; returns how many are."""
    vertex, across, count = solid.vertex, solid.across, 0
    most = start.shape[0] - 1
    for t in range(solid.state[COUNT]):
        if vertex[4 * t] < 0:
            continue
        for k in range(4):
            if across[4 * t + k] < 4 * t + k:  # each face once; none of the hull is a goal
                continue
            u, v, w = vertex[4 * t + (k + 1 & 3)], vertex[4 * t + (k + 2 & 3)], vertex[4 * t + (k + 3 & 3)]
            low = min(u, min(v, w))
            if low >= most or start[low] == start[low + 1]:
                continue
            high = max(u, max(v, w))
            total = np.int64(u) + v + w
            for i in range(start[low], start[low + 1]):
                a, b, c = goals[order[i], 0], goals[order[i], 1], goals[order[i], 2]
                if np.int64(a) + b + c == total and max(a, max(b, c)) == high and face[order[i]] < 0:
                    face[order[i]] = 4 * t + k
                    count += 1
    return count


@kernel
def _edges(solid, goals, start, order, there):
    """Write for each goal, a row of two vertices, whether it is an edge."""
    vertex, most = solid.vertex, start.shape[0] - 1
    for t in range(solid.state[COUNT]):
        if vertex[4 * t] < 0:
            continue
        for j in range(3):
            for k in range(j + 1, 4):
                u, v = vertex[4 * t + j], vertex[4 * t + k]
                low, high = min(u, v), max(u, v)
                if low < most:
                    for i in range(start[low], start[low + 1]):
                        if max(goals[order[i], 0], goals[order[i], 1]) == high:
                            there[order[i]] = True


@kernel
def _mark(solid, face, number):
    """Mark these faces (-1: none) on both sides."""
    for i in range(face.shape[0]):
        if face[i] >= 0:
            solid.mark[face[i]] = number[i]
            if solid.across[face[i]] >= 0:
                solid.mark[solid.across[face[i]]] = number[i]


@kernel
def _hold(held, goals, there):
    """Hold the edges that are there."""
    for i in range(goals.shape[0]):
        if there[i]:
            hold(held, goals[i, 0], goals[i, 1], 1)


def _sorted(goals: NDArray[np.int32], width: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    start = np.zeros(int(goals[:, :width].max(initial=-1)) + 2, dtype=np.int32)
    order = np.empty(len(goals), dtype=np.int32)
    _by_lowest(goals, width, start, order)
    return start, order


def all_faces(solid: Solid, triangles: NDArray[np.int32]) -> bool:
    """Whether all triangles (m, 3) are faces; then they are marked with their numbers, else nothing is."""
    face = np.full(len(triangles), -1, dtype=np.int32)
    if _faces(solid, triangles, *_sorted(triangles, 3), face) < len(triangles):
        return False
    _mark(solid, face, np.arange(len(triangles), dtype=np.int32))
    return True


def edges_there(solid: Solid, segments: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which segments, rows that begin with two vertices, are edges: (k,)."""
    there = np.zeros(len(segments), dtype=np.bool_)
    _edges(solid, segments, *_sorted(segments, 2), there)
    return there


def look_up(solid: Solid, held: Held, kind: int, goals: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which goals are there, in the form of `survey`: (k,). They are held or marked from now on."""
    if kind == EDGE:
        there = edges_there(solid, goals)
        _hold(held, goals, there)
        return there
    face = np.full(len(goals), -1, dtype=np.int32)
    _faces(solid, goals, *_sorted(goals, 3), face)
    _mark(solid, face, goals[:, 3].copy())
    return face >= 0
