"""The front as a set of directed edges with what is not meshed on their left, and the exact tests, compiled.

The edges and the vertices at the front are in two digital trees. A loose vertex, inside and on no edge, is at
the front until a triangle reaches it. A new triangle ABC on the front edge AB changes the front by a
symmetric difference:

            C            AB leaves. CA leaves if it is at the front (what is not meshed is on its left, and
           / \\           that is the triangle); otherwise AC enters, and what is beyond it is not meshed.
          /   \\          BC leaves, or CB enters.
         A-----B

`first_fault` decides by exact signs whether a triangle may be made. It may if C is strictly on the left of
AB, no edge of the front meets the open triangle, and no vertex of the front is in the closed triangle,
besides its corners. Then all of the open triangle is unmeshed: it is connected, it is unmeshed along AB, and
whoever leaves what is unmeshed crosses the front. In particular no hole is swallowed, since its vertices
would be inside.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...connect.insertion.engine import grown
from ...predicates.kernels import orient2
from ..advancing.digital_tree import DigitalTree, gather, larger_tree, new_tree, plant, planted, pull
from ..advancing.rows import (
    ALIVE,
    CELLS_MADE,
    FREE_ROW,
    FRONT_STATE,
    VERTEX_COUNT,
    drop_row,
    larger_counts,
    new_row,
    put_in_chain,
)

__all__ = [
    "CROSSED",
    "HOLDS",
    "NOT_LEFT",
    "NO_FAULT",
    "OpenFront",
    "advance_over",
    "enter_edge",
    "enter_vertex",
    "first_fault",
    "has_room",
    "larger_front",
    "meets_inside",
    "new_front",
    "row_of",
]  # fmt: skip

# What `first_fault` finds.
NO_FAULT, NOT_LEFT, CROSSED, HOLDS = range(4)


class OpenFront(NamedTuple):
    """The arrays of a front."""

    xy: NDArray[np.float64]  # the vertices, |coordinates| <= 1
    ends: NDArray[np.int32]  # (., 2) the edges; -1 where a row is free
    region: NDArray[np.int32]  # the region on the left
    stamp: NDArray[np.int64]  # the number of the edge in the order in which edges came; no two are the same
    chain: NDArray[np.int32]  # the next row whose edge starts at the same vertex, or the next free row
    first: NDArray[np.int32]  # for each vertex the first row whose edge starts there, -1 for none
    loose: NDArray[np.bool_]  # whether a vertex is at the front without an edge
    edges: DigitalTree
    vertices: DigitalTree
    state: NDArray[np.int64]
    made: NDArray[np.int32]  # (., 4) the triangles in the order in which they were made, and their regions


def new_front(xy: NDArray[np.float64], rows: int, capacity: int) -> OpenFront:
    """A front without edges.

    Parameters
    ----------
    xy : ndarray, shape (n, 2)
        The vertices, which are not at the front yet.
    rows : int
        Room for so many edges at one time.
    capacity : int
        Room for so many vertices.
    """
    places = np.zeros((max(capacity, len(xy)), 2))
    places[: len(xy)] = xy
    state = np.zeros(FRONT_STATE, dtype=np.int64)
    state[FREE_ROW], state[VERTEX_COUNT] = -1, len(xy)
    return OpenFront(
        places, np.full((rows, 2), -1, dtype=np.int32), np.empty(rows, dtype=np.int32),
        np.full(rows, -1, dtype=np.int64), np.empty(rows, dtype=np.int32),
        np.full(len(places), -1, dtype=np.int32), np.zeros(len(places), dtype=bool), new_tree(rows, 2),
        new_tree(len(places), 2), state, np.empty((2 * len(places) + 8, 4), dtype=np.int32),
    )  # fmt: skip


def larger_front(front: OpenFront) -> OpenFront:
    """The same front with half as much room again, wherever little is left."""
    rows, n, made = larger_counts(front.state, len(front.ends), len(front.xy), len(front.made))
    ends, stamp = np.full((rows, 2), -1, dtype=np.int32), np.full(rows, -1, dtype=np.int64)
    ends[: len(front.ends)], stamp[: len(front.ends)] = front.ends, front.stamp
    first, loose = np.full(n, -1, dtype=np.int32), np.zeros(n, dtype=bool)
    first[: len(front.first)], loose[: len(front.loose)] = front.first, front.loose
    return OpenFront(
        grown(front.xy, n), ends, grown(front.region, rows), stamp, grown(front.chain, rows), first, loose,
        larger_tree(front.edges, rows) if rows > len(front.ends) else front.edges,
        larger_tree(front.vertices, n) if n > len(front.xy) else front.vertices, front.state,
        grown(front.made, made),
    )  # fmt: skip


@inline
def has_room(front):
    """Whether one more step fits: two edges, a vertex, a triangle."""
    state = front.state
    return (
        state[ALIVE] + 4 < len(front.ends)
        and state[VERTEX_COUNT] + 2 < len(front.first)
        and state[CELLS_MADE] + 2 < len(front.made)
    )


@inline
def enter_vertex(front, v):
    """Put vertex v, which has no edge at the front, into the front."""
    front.loose[v] = True
    plant(front.vertices, v, (front.xy[v, 0], front.xy[v, 1]), 0.0)


@lean
def enter_edge(front, a, b, region):
    """Put the edge from a to b into the front; return its row."""
    xy, row = front.xy, new_row(front)
    front.ends[row, 0], front.ends[row, 1] = a, b
    front.region[row] = region
    front.loose[a] = front.loose[b] = False
    if not planted(front.vertices, a):
        plant(front.vertices, a, (xy[a, 0], xy[a, 1]), 0.0)
    put_in_chain(front, row, a)
    dx, dy = abs(xy[b, 0] - xy[a, 0]), abs(xy[b, 1] - xy[a, 1])
    middle = (0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1]))
    plant(front.edges, row, middle, 0.5 * max(dx, dy))
    return row


@lean
def leave_edge(front, row):
    """Take an edge out of the front, and the vertex where it starts if no other edge starts there."""
    a = np.int64(front.ends[row, 0])
    drop_row(front, row, a)
    if front.first[a] < 0:
        pull(front.vertices, a)
    pull(front.edges, row)
    front.ends[row, 0] = front.ends[row, 1] = -1


@inline
def row_of(front, a, b):
    """The row of the edge from a to b, -1 if it is not at the front."""
    row = np.int64(front.first[a])
    while row >= 0 and front.ends[row, 1] != b:
        row = np.int64(front.chain[row])
    return row


@lean
def advance_over(front, row, c):
    """Make the triangle of the edge in ``row`` and vertex c; return the two rows that entered, or -1."""
    a, b, region = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1]), front.region[row]
    k = front.state[CELLS_MADE]
    front.made[k, 0], front.made[k, 1], front.made[k, 2], front.made[k, 3] = a, b, c, region
    front.state[CELLS_MADE] += 1
    met, other = row_of(front, c, a), row_of(front, b, c)
    # Edges enter before others leave, so that vertices that stay at the front are not taken out in between.
    one = enter_edge(front, a, c, region) if met < 0 else np.int64(-1)
    two = enter_edge(front, c, b, region) if other < 0 else np.int64(-1)
    leave_edge(front, row)
    if met >= 0:
        leave_edge(front, met)
    if other >= 0:
        leave_edge(front, other)
    return one, two


# --- the tests ------------------------------------------------------------------------------------


@inline
def turn(xy, u, v, w):
    """Orientation of three vertices; 0 at once if two of them are the same."""
    if w == u or w == v:
        return 0
    return orient2(xy[u, 0], xy[u, 1], xy[v, 0], xy[v, 1], xy[w, 0], xy[w, 1])


@inline
def meets_inside(xy, a, b, c, s, t):
    """Whether the segment st meets the open, counterclockwise triangle abc.

    An open triangle and a segment are disjoint if and only if the line of one of the four segments has them
    on its two closed sides.
    """
    bs, bt = turn(xy, b, c, s), turn(xy, b, c, t)
    if bs <= 0 and bt <= 0:
        return False
    cs, ct = turn(xy, c, a, s), turn(xy, c, a, t)
    if cs <= 0 and ct <= 0:
        return False
    az, bz = turn(xy, a, b, s), turn(xy, a, b, t)
    if az <= 0 and bz <= 0:
        return False
    if (bs > 0 and cs > 0 and az > 0) or (bt > 0 and ct > 0 and bz > 0):
        return True
    one, two, three = turn(xy, s, t, a), turn(xy, s, t, b), turn(xy, s, t, c)
    return not ((one >= 0 and two >= 0 and three >= 0) or (one <= 0 and two <= 0 and three <= 0))


@inline
def reaches(xy, a, b, c, s, t):
    """Whether the boxes of the triangle abc and the segment st have a point in common."""
    return (
        min(xy[s, 0], xy[t, 0]) <= max(xy[a, 0], xy[b, 0], xy[c, 0])
        and max(xy[s, 0], xy[t, 0]) >= min(xy[a, 0], xy[b, 0], xy[c, 0])
        and min(xy[s, 1], xy[t, 1]) <= max(xy[a, 1], xy[b, 1], xy[c, 1])
        and max(xy[s, 1], xy[t, 1]) >= min(xy[a, 1], xy[b, 1], xy[c, 1])
    )


@inline
def window_of(xy, a, b, c):
    """The box of three vertices: smallest x and y, largest x and y."""
    return (
        min(xy[a, 0], xy[b, 0], xy[c, 0]), min(xy[a, 1], xy[b, 1], xy[c, 1]),
        max(xy[a, 0], xy[b, 0], xy[c, 0]), max(xy[a, 1], xy[b, 1], xy[c, 1]),
    )  # fmt: skip


@lean
def blocking_edge(front, a, b, c):
    """The row of a front edge that meets the open triangle abc, -1 for none."""
    xy, ends, found = front.xy, front.ends, front.edges.found
    for i in range(gather(front.edges, window_of(xy, a, b, c))):
        s, t = np.int64(ends[found[i], 0]), np.int64(ends[found[i], 1])
        if reaches(xy, a, b, c, s, t) and meets_inside(xy, a, b, c, s, t):
            return np.int64(found[i])
    return np.int64(-1)


@lean
def holds_vertex(front, a, b, c):
    """Whether a vertex of the front, besides the corners, is in the closed triangle abc."""
    xy, found = front.xy, front.vertices.found
    for i in range(gather(front.vertices, window_of(xy, a, b, c))):
        v = np.int64(found[i])
        if v != a and v != b and v != c:
            if turn(xy, a, b, v) >= 0 and turn(xy, b, c, v) >= 0 and turn(xy, c, a, v) >= 0:
                return True
    return False


@lean
def first_fault(front, a, b, c):
    """Why the triangle abc on the front edge ab must not be made: NO_FAULT, NOT_LEFT, CROSSED or HOLDS."""
    if turn(front.xy, a, b, c) <= 0:
        return NOT_LEFT
    if blocking_edge(front, a, b, c) >= 0:
        return CROSSED
    return HOLDS if holds_vertex(front, a, b, c) else NO_FAULT
