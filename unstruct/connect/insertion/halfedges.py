"""Triangles as half-edges, and the walk through them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...predicates.kernels import incircle, orient2
from .engine import COUNT, FREE, GHOST, LAST

__all__ = [
    "GHOST",
    "SEGMENTS",
    "UNUSED",
    "VERTICES",
    "HalfEdges",
    "conflict_across",
    "end_of",
    "free_slot",
    "locate2",
    "locate_all2",
    "new_slot",
    "next_edge",
    "prev_edge",
    "start_of",
]


class HalfEdges(NamedTuple):
    """A triangulation of the plane in half-edges (see `plane`), whose vertices are numbered as the input was.

    `GHOST` is the third vertex of the triangle beyond each hull edge. ``xy`` is the input times ``factor``, a
    power of two such that |xy| <= 1.
    """

    xy: NDArray[np.float64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    factor: float


@inline
def _corner(e):
    """e modulo 3 for 0 <= e < 2^31: without what a remainder does for negative numbers."""
    return e - 3 * (int(e) * 2863311531 >> 33)


@inline
def next_edge(e):
    """The half-edge after e in its triangle, counterclockwise."""
    return e - 2 if _corner(e) == 2 else e + 1


@inline
def prev_edge(e):
    """The half-edge before e in its triangle."""
    return e + 2 if _corner(e) == 0 else e - 1


@inline
def _side(xy, a, b, px, py):
    return orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py)


@kernel
def start2(xy, vertex, twin, state):
    """The first triangle, on points 0, 1, 2, and its three ghosts."""
    left = _side(xy, 0, 1, xy[2, 0], xy[2, 1]) > 0
    vertex[0], vertex[1], vertex[2] = 0, 1 if left else 2, 2 if left else 1
    for k in range(3):
        ghost = 3 * (1 + k)
        vertex[ghost] = GHOST
        vertex[ghost + 1] = vertex[(k + 2) % 3]
        vertex[ghost + 2] = vertex[(k + 1) % 3]
        twin[ghost], twin[k] = k, ghost
        before = 3 * (1 + (k + 2) % 3) + 2
        twin[ghost + 1], twin[before] = before, ghost + 1
    state[COUNT] = 4
    state[LAST] = 0


@kernel
def locate2(xy, vertex, twin, t, px, py):
    """Walk from triangle t to a triangle that contains p, or to a ghost beyond whose edge p strictly lies.

    The walk crosses only edges that have p strictly beyond them; in a Delaunay triangulation it
    cannot return to a triangle.
    """
    for k in range(3):
        if vertex[3 * t + k] == GHOST:
            t = twin[3 * t + k] // 3
            break
    o = np.int64(-1)
    for k in range(3):
        e = 3 * t + k
        if _side(xy, vertex[next_edge(e)], vertex[prev_edge(e)], px, py) < 0:
            o = np.int64(twin[e])
            break
    if o < 0:
        return np.int64(t)
    while True:
        c = vertex[o]
        if c == GHOST:
            return o // 3
        right, left = next_edge(o), prev_edge(o)
        if _side(xy, vertex[left], c, px, py) < 0:
            o = np.int64(twin[right])
        elif _side(xy, c, vertex[right], px, py) < 0:
            o = np.int64(twin[left])
        else:
            return o // 3


@kernel
def locate_all2(xy, vertex, twin, t, rows, found):
    """`locate2` for each row; every walk begins where the last one ended."""
    for i in range(len(rows)):
        t = locate2(xy, vertex, twin, t, rows[i, 0], rows[i, 1])
        found[i] = t


@inline
def conflict_across(xy, a, b, c, px, py):
    """Is p in the open disk of triangle (c, b, a), entered from the cavity across the edge a -> b?"""
    if (a | b | c) >= 0:
        return incircle(xy[c, 0], xy[c, 1], xy[b, 0], xy[b, 1], xy[a, 0], xy[a, 1], px, py) > 0
    if c == GHOST:  # entered from inside the hull: p beyond the hull edge, or on it
        return _side(xy, a, b, px, py) <= 0
    if a == GHOST:  # entered from the next ghost
        return _side(xy, c, b, px, py) > 0
    return _side(xy, a, c, px, py) > 0


# Further entries of the state.
VERTICES = 8  # how many vertices there are
SEGMENTS = 9  # how many subsegments there are

UNUSED = -2  # the first vertex of a slot without a triangle; its first twin is the next such slot, or -1


@inline
def new_slot(twin, state):
    """A slot for a triangle: a freed one, or the next at the end."""
    slot = state[FREE]
    if slot >= 0:
        state[FREE] = twin[3 * slot]
        return slot
    slot = state[COUNT]
    state[COUNT] = slot + 1
    return slot


@inline
def free_slot(vertex, twin, region, state, slot):
    """Give a slot back."""
    vertex[3 * slot] = UNUSED
    twin[3 * slot] = state[FREE]
    region[slot] = -1
    state[FREE] = slot


@inline
def start_of(vertex, e):
    """The vertex where half-edge e begins."""
    return vertex[next_edge(e)]


@inline
def end_of(vertex, e):
    """The vertex where half-edge e ends."""
    return vertex[prev_edge(e)]
