"""Insertion among constrained edges in two phases, compiled: find and judge, then commit.

The half-edges are those of `insertion2`: the triangulation covers the sphere, with ghost triangles beyond the
hull, so that every edge has two sides. Besides, ``mark[e]`` is the number of the *subsegment* on half-edge e
(the same on its twin), -1 for none, and ``region[t]`` the part of the domain that triangle t belongs to,
-1 outside. Kernels take these arrays as one record, `Plane`, and what they write cavities into as another,
`Scratch`.

An insertion of p first collects, without a change, the triangles whose open circle holds p and that are
reached from a seed over unmarked edges: ``cells``, and the edges around them, counterclockwise: ``rim``.
If p lies strictly to the left of every rim edge, the polygon is star-shaped about p, and joining p to the
rim gives a valid triangulation, whatever the seed was and however p was rounded. Otherwise the caller learns
which edge is in the way, and nothing has happened. In a constrained Delaunay triangulation the result is
constrained Delaunay: a circle that holds p belongs to a triangle in the cavity, or to one that is hidden from
p behind a marked edge.

A subsegment a -> b is split in the same way, from both of its sides at once; p need not lie on it (it may be
rounded, or lie on the curve that the subsegment stands for):

           left rim                 the left fan keeps the region of the left triangle, the right fan that
         v --------- .              of the right one; p-u and p-v are the two halves. Where p is beyond the
         |  \\   p  /  \\             chord, the triangle between chord and halves changes sides: that is
         . -- \\--/---- u            what following a curve means.
               right rim

Source: the cavity by A. Bowyer and D. F. Watson (1981), with marked edges opaque. Book: 2.5, 2.6a.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import inline, lean
from ...predicates.kernels import orient2
from ..insertion.engine import BUSY, LAST
from ..insertion.halfedges import (
    GHOST,
    SEGMENTS,
    UNUSED,
    VERTICES,
    conflict_across,
    end_of,
    new_slot,
    next_edge,
    prev_edge,
    start_of,
)

TOO_LARGE = -1  # for the number of rim edges: the search met more triangles than there are


@lean
def walk(xy, vertex, twin, t, px, py):
    """A triangle that contains p, or a ghost beyond whose hull edge p lies; any triangulation will do.

    At each triangle the edge that is looked at first changes, in a fixed sequence: a walk in a triangulation
    that is not Delaunay could otherwise go round for ever. Marked edges are no obstacle.
    """
    for k in range(3):
        if vertex[3 * t + k] == GHOST:
            t = twin[3 * t + k] // 3
            break
    turn = 12345
    while True:
        turn = (turn * 1103515245 + 12345) % 2147483648
        first = (turn >> 16) % 3
        moved = False
        for i in range(3):
            e = 3 * t + (first + i) % 3
            a, b = start_of(vertex, e), end_of(vertex, e)
            if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) < 0:
                t = twin[e] // 3
                moved = True
                break
        if not moved:
            return t
        for k in range(3):
            if vertex[3 * t + k] == GHOST:
                return t


@inline
def _grow(plane, scratch, depth, px, py, m, k):
    """Turn through the cavity from the inner half-edges on the stack; marked edges belong to the rim."""
    vertex, stack = plane.vertex, scratch.stack
    while depth > 0:
        depth -= 1
        e = stack[depth]
        if plane.mark[e] < 0:
            o = plane.twin[e]
            right, left = next_edge(o), prev_edge(o)
            if conflict_across(plane.xy, vertex[left], vertex[right], vertex[o], px, py):
                if m >= len(scratch.cells):
                    return m, TOO_LARGE
                scratch.cells[m] = o // 3
                m += 1
                stack[depth], stack[depth + 1] = left, right
                depth += 2
                continue
        scratch.rim[k] = e
        k += 1
    return m, k


@inline
def find_cavity_here(plane, scratch, t, px, py):
    """`find_cavity`, inlined: for hot loops. Any records with these arrays will do."""
    stack = scratch.stack
    scratch.cells[0] = t
    stack[0], stack[1], stack[2] = 3 * t + 2, 3 * t + 1, 3 * t
    return _grow(plane, scratch, np.int64(3), px, py, np.int64(1), np.int64(0))


@lean
def find_cavity(plane, scratch, t, px, py):
    """The cavity of p from triangle t, whose open circle holds p: (m, k), ``cells[:m]`` and ``rim[:k]``.

    The rim has the inner half-edges, counterclockwise; k = m + 2. k is ``TOO_LARGE`` where the seed is hidden
    from p in such a way that the search goes round (the arrays have the length of the triangulation).
    """
    return find_cavity_here(plane, scratch, t, px, py)


@lean
def blocked_by(xy, vertex, rim, k, px, py):
    """The place in the rim of the first edge that p does not have strictly on its left; -1 for none.

    k where p has all of them on its left, but the rim winds round it twice (a seed from which p is hidden).
    """
    turns = 0
    for i in range(k):
        a, b = start_of(vertex, rim[i]), end_of(vertex, rim[i])
        if a != GHOST and b != GHOST:
            if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) <= 0:
                return i
            if xy[a, 1] <= py < xy[b, 1]:  # it crosses the ray from p to the right, upward
                turns += 1
    return k if turns > 1 else -1


@inline
def _star(plane, scratch, m, k, split, p):
    """Join p to the rim: the triangle on rim edge i is ``fresh[i]``, p first. Mark ``split`` is dropped."""
    vertex, twin, mark, hold, fresh = plane.vertex, plane.twin, plane.mark, scratch.hold, scratch.fresh
    for i in range(k):
        e = scratch.rim[i]
        hold[i, 0], hold[i, 1] = start_of(vertex, e), end_of(vertex, e)
        hold[i, 2], hold[i, 3] = twin[e], mark[e]
    before = np.int64(0)
    for i in range(k):
        slot = scratch.cells[i] if i < m else new_slot(twin, plane.state)
        fresh[i] = slot
        new = 3 * slot
        o, s = hold[i, 2], hold[i, 3]
        if s == split:  # the chord, where p has left it on one side
            s = -1
            mark[o] = -1
        vertex[new], vertex[new + 1], vertex[new + 2] = p, hold[i, 0], hold[i, 1]
        twin[new], twin[o] = o, new
        mark[new], mark[new + 1], mark[new + 2] = s, -1, -1
        if s >= 0:
            plane.where[s] = new
        if i > 0:
            twin[new + 2], twin[before + 1] = before + 1, new + 2
        before = new
    first = 3 * fresh[0]
    twin[first + 2], twin[before + 1] = before + 1, first + 2
    plane.state[LAST] = fresh[0]


@inline
def commit_here(plane, scratch, m, k, p):
    """`commit`, inlined."""
    state = plane.state
    state[BUSY] = 1
    part = plane.region[scratch.cells[0]]
    _star(plane, scratch, m, k, UNUSED, p)
    for i in range(k):
        plane.region[scratch.fresh[i]] = part
    state[VERTICES] = max(state[VERTICES], p + 1)
    state[BUSY] = 0


@lean
def commit(plane, scratch, m, k, p):
    """Replace the cavity by the star of p, whose coordinates are in its row of ``xy``.

    ``fresh[:k]`` are the new triangles; each has p as its first vertex, so that half-edge 3 t is on the rim.
    They inherit the region of the cavity.
    """
    commit_here(plane, scratch, m, k, p)


@lean
def find_split(plane, scratch, e, px, py):
    """The cavity of a split of the subsegment on half-edge e at p: (m, k, h).

    ``rim[:h]`` is the rim on the left of e, ``rim[h:k]`` that on the right; m = 0 or k = ``TOO_LARGE`` where
    there is none. Judge it by `blocked_by`.
    """
    mark, stack = plane.mark, scratch.stack
    f = plane.twin[e]
    s = mark[e]
    mark[e], mark[f] = -1, -1
    one, none = np.int64(1), np.int64(0)
    stack[0] = f
    m, h = _grow(plane, scratch, one, px, py, none, none)
    k = h
    if h >= 0:
        # where the left side is not in the cavity its rim is the chord: it must not be crossed again
        mark[e], mark[f] = -1, s
        stack[0] = e
        m, k = _grow(plane, scratch, one, px, py, m, h)
    mark[e], mark[f] = s, s
    return m, k, h


@lean
def commit_split(plane, scratch, e, m, k, h, p, t):
    """Split the subsegment on half-edge e at vertex p, parameter t of its piece; the new one's number.

    The half that holds the old first end keeps its number; the other half is the last subsegment. As
    `commit` otherwise; ``fresh[:h]`` lie on the left of e.
    """
    twin, mark, region, state, fresh = plane.twin, plane.mark, plane.region, plane.state, scratch.fresh
    ends, piece, span = plane.ends, plane.piece, plane.span
    state[BUSY] = 1
    s = mark[e]
    u = start_of(plane.vertex, e)
    left, right = region[e // 3], region[twin[e] // 3]
    _star(plane, scratch, m, k, s, p)
    for i in range(k):
        region[fresh[i]] = left if i < h else right
    new = state[SEGMENTS]
    state[SEGMENTS] = new + 1
    piece[new] = piece[s]
    ends[new, 0], ends[new, 1] = p, ends[s, 1]
    span[new, 0], span[new, 1] = t, span[s, 1]
    to_u, to_v = (s, new) if ends[s, 0] == u else (new, s)
    ends[s, 1], span[s, 1] = p, t
    # the left chain begins at v, the right one at u: half-edge 3 t + 2 runs from p to where a chain begins
    for i, number in ((h, to_u), (0, to_v)):
        o = 3 * fresh[i] + 2
        mark[o], mark[twin[o]] = number, number
        plane.where[number] = o
    state[VERTICES] = max(state[VERTICES], p + 1)
    state[BUSY] = 0
    return new
