"""Circumcenter insertion on the unit torus, compiled: Bowyer-Watson without a boundary.

The half-edges are those of `connect.insertion.plane`, without ghosts. Besides its vertex each corner has a
``shift`` by whole periods: in its own frame a triangle has the corners ``xy[vertex[e]] + shift[e]``. The two
triangles at an edge have the same edge up to a common shift. Coordinates are multiples of ``GRID``, so that
all copies are exact.

Every circumradius must be below 1/4: the caller checks the first triangles, and by relation (1) of the book's
chapter 2.6a it remains true for the others. Then the cavity of a point lies within 1/2 of it, so that it
contains no two copies of a triangle, and no vertex appears twice in the star.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, MORE, ROUNDED
from ...base.jit import inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import VERTICES, next_edge, prev_edge
from ...predicates.kernels import incircle
from .worst import NONE, enter, measures, record, top

GRID = 2.0**-50  # of the coordinates; a corner in [-2, 3) is then a double, and a quarter of it below 1


class Torus(NamedTuple):
    """The triangulation."""

    xy: NDArray[np.float64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    shift: NDArray[np.int32]
    state: NDArray[np.int64]


class TorusScratch(NamedTuple):
    """Work arrays of the search for a cavity: waiting half-edges and their frames, free and new slots."""

    stack: NDArray[np.int32]
    frame: NDArray[np.int32]
    spare: NDArray[np.int32]
    fresh: NDArray[np.int32]


@inline
def corner(torus, e):
    """The place of the corner of half-edge e, in the frame of its triangle."""
    v = torus.vertex[e]
    return torus.xy[v, 0] + torus.shift[e, 0], torus.xy[v, 1] + torus.shift[e, 1]


@lean
def _enter(torus, contest, t):
    ax, ay = corner(torus, 3 * t)
    bx, by = corner(torus, 3 * t + 1)
    cx, cy = corner(torus, 3 * t + 2)
    enter(contest, t, ax, ay, bx, by, cx, cy)


@lean
def enter_all(torus, contest):
    """Judge all triangles, and put them into the tournaments."""
    for t in range(torus.state[COUNT]):
        _enter(torus, contest, t)


@inline
def in_circle(torus, o, fx, fy, px, py):
    """Whether p is in the open circle of the triangle of half-edge o, moved by (fx, fy)."""
    ax, ay = corner(torus, o)
    bx, by = corner(torus, next_edge(o))
    cx, cy = corner(torus, prev_edge(o))
    s = 0.25
    return (
        incircle(
            s * (ax + fx),
            s * (ay + fy),
            s * (bx + fx),
            s * (by + fy),
            s * (cx + fx),
            s * (cy + fy),
            s * px,
            s * py,
        )
        > 0
    )


@inline
def push(twin, shift, stack, frame, depth, e, fx, fy):
    """Put the half-edge beyond e on the stack with the frame of its triangle; the frame of e is (fx, fy)."""
    o = twin[e]
    stack[depth] = o
    frame[depth, 0] = fx + shift[next_edge(e), 0] - shift[prev_edge(o), 0]
    frame[depth, 1] = fy + shift[next_edge(e), 1] - shift[prev_edge(o), 1]


@lean
def star(torus, scratch, p, t, px, py):
    """Replace the cavity of p, found from triangle t, by its star, and return its number of triangles.

    As in `insert2` of `connect.insertion.plane`, each half-edge that is taken from the stack either extends
    the cavity or gives a triangle of the star at once. (px, py) is p in the frame of t; ``xy[p]`` becomes the
    same point in [0, 1) x [0, 1).
    """
    xy, vertex, twin, shift, state = torus.xy, torus.vertex, torus.twin, torus.shift, torus.state
    stack, frame, spare = scratch.stack, scratch.frame, scratch.spare
    wx, wy = math.floor(px), math.floor(py)
    xy[p, 0], xy[p, 1] = px - wx, py - wy
    count = state[COUNT]
    spare[0], spares, depth = t, 1, 0
    for k in range(2, -1, -1):
        push(twin, shift, stack, frame, depth, 3 * t + k, 0, 0)
        depth += 1
    first = before = np.int64(-1)
    k = 0
    while depth > 0:
        depth -= 1
        o = np.int64(stack[depth])
        fx, fy = frame[depth, 0], frame[depth, 1]
        right, left = next_edge(o), prev_edge(o)
        if in_circle(torus, o, fx, fy, px, py):
            spare[spares] = o // 3
            spares += 1
            push(twin, shift, stack, frame, depth, left, fx, fy)
            push(twin, shift, stack, frame, depth + 1, right, fx, fy)
            depth += 2
            continue
        a, b = vertex[left], vertex[right]
        ax, ay = shift[left, 0] + fx - wx, shift[left, 1] + fy - wy
        bx, by = shift[right, 0] + fx - wx, shift[right, 1] + fy - wy
        if spares > 0:
            spares -= 1
            slot = np.int64(spare[spares])
        else:
            slot = count
            count += 1
        new = 3 * slot
        vertex[new], vertex[new + 1], vertex[new + 2] = p, a, b
        shift[new, 0], shift[new, 1] = 0, 0
        shift[new + 1, 0], shift[new + 1, 1] = ax, ay
        shift[new + 2, 0], shift[new + 2, 1] = bx, by
        twin[new], twin[o] = o, new
        if before < 0:
            first = new
        else:
            twin[new + 2], twin[before + 1] = before + 1, new + 2
        before = new
        scratch.fresh[k] = slot
        k += 1
    twin[first + 2], twin[before + 1] = before + 1, first + 2
    state[COUNT], state[VERTICES] = count, p + 1
    return k


@lean
def insert_on_torus(torus, scratch, contest, stop):
    """Insert circumcenters of worst triangles until there are ``stop`` vertices: DONE, MORE or ROUNDED.

    If the contest's ``rows`` and ``events`` have room, the record of each step is written into them: the
    state before it, and circumradius, value and vertices of the triangle.
    """
    state, tree = torus.state, contest.tree
    while state[VERTICES] < stop:
        if tree[1] == NONE:
            return DONE
        t = top(tree)
        p = state[VERTICES]
        ax, ay = corner(torus, 3 * t)
        bx, by = corner(torus, 3 * t + 1)
        cx, cy = corner(torus, 3 * t + 2)
        radius, _, _, _, _, qx, qy = measures(ax, ay, bx, by, cx, cy)
        px, py = math.floor(qx / GRID + 0.5) * GRID, math.floor(qy / GRID + 0.5) * GRID
        if not in_circle(torus, 3 * t, 0, 0, px, py):
            return ROUNDED
        if p < len(contest.events):
            record(contest, torus.vertex, t, p, radius)
        k = star(torus, scratch, p, t, px, py)
        for i in range(k):
            _enter(torus, contest, scratch.fresh[i])
    return MORE if tree[1] > NONE else DONE
