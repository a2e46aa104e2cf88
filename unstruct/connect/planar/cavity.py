"""Insertion among constrained edges in two phases, compiled: a cavity is found and judged, then replaced.

The half-edges are those of `insertion.plane`: the triangulation covers the sphere, with ghost triangles
beyond the hull, so that every edge has two sides. In addition, ``mark[e]`` is the number of the *subsegment*
on half-edge e (the same on its twin), -1 for none, and ``region[t]`` is the part of the domain to which
triangle t belongs, -1 outside. Kernels take these arrays as one record, `Plane`, and write cavities into
another, `Scratch`.

An insertion of p first collects its *cavity*, without any change: the triangles whose open circle contains p
and that are reached from a seed across unmarked edges. The array ``cells`` gets the triangles, and ``rim``
the half-edges of the boundary of the cavity, counterclockwise. If p lies strictly to the left of every
boundary edge, the polygon is star-shaped about p, and joining p to the boundary gives a valid triangulation,
whatever the seed was and however p was rounded. Otherwise the caller learns which edge is in the way, and
nothing has changed. In a constrained Delaunay triangulation the result is constrained Delaunay: a circle that
contains p belongs to a triangle in the cavity, or to one that is hidden from p behind a marked edge.

A subsegment a -> b is split in the same way, from both of its sides at once. The point p need not lie on it:
it may be rounded, or lie on the curve that the subsegment stands for. The *fan* of a side is the set of new
triangles on that side.

         boundary, left             The left fan keeps the region of the left triangle, the right fan that
         v --------- .              of the right one; p-u and p-v are the two halves. If p is beyond the
         |  \\   p  /  \\             chord, the triangle between chord and halves changes sides: this is
         . -- \\--/---- u            how the boundary follows a curve.
         boundary, right

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

TOO_LARGE = -1  # in place of the number of boundary edges: the search met more triangles than there are


@lean
def walk(xy, vertex, twin, t, px, py):
    """A triangle that contains p, or a ghost beyond whose hull edge p lies, in any triangulation.

    The edge of a triangle that is tested first changes, in a fixed sequence: otherwise a walk in a
    triangulation that is not Delaunay could run in a circle for ever. Marked edges are no obstacle.
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
    """Search the cavity from the inner half-edges on the stack; marked edges belong to its boundary."""
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
    """`find_cavity`, inlined for hot loops, with any records that have these arrays."""
    stack = scratch.stack
    scratch.cells[0] = t
    stack[0], stack[1], stack[2] = 3 * t + 2, 3 * t + 1, 3 * t
    return _grow(plane, scratch, np.int64(3), px, py, np.int64(1), np.int64(0))


@lean
def find_cavity(plane, scratch, t, px, py):
    """The cavity of p from triangle t, whose open circle contains p: (m, k), ``cells[:m]`` and ``rim[:k]``.

    ``rim`` has the inner half-edges of its boundary, counterclockwise; k = m + 2. k is ``TOO_LARGE`` if the
    seed is hidden from p in such a way that the search runs in a circle (the arrays have the length of the
    triangulation).
    """
    return find_cavity_here(plane, scratch, t, px, py)


@lean
def blocked_by(xy, vertex, rim, k, px, py):
    """The place in ``rim`` of the first edge that does not have p strictly on its left; -1 for none.

    The answer is k if all edges have p on their left, but wind around it twice (p is hidden from the seed).
    """
    turns = 0
    for i in range(k):
        a, b = start_of(vertex, rim[i]), end_of(vertex, rim[i])
        if a != GHOST and b != GHOST:
            if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) <= 0:
                return i
            if xy[a, 1] <= py < xy[b, 1]:  # the edge crosses the ray from p to the right, upward
                turns += 1
    return k if turns > 1 else -1


@inline
def _star(plane, scratch, m, k, split, p):
    """Join p to the boundary: the triangle on edge i is ``fresh[i]``, p first. Mark ``split`` is dropped."""
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
        if s == split:  # the chord, where it is an edge of the boundary
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

    ``fresh[:k]`` are the new triangles; each has p as its first vertex, so that half-edge 3 t is on the
    boundary of the cavity. They inherit the region of the cavity.
    """
    commit_here(plane, scratch, m, k, p)


@lean
def find_split(plane, scratch, e, px, py):
    """The cavity of a split of the subsegment on half-edge e at p: (m, k, h).

    ``rim[:h]`` is its boundary on the left of e, ``rim[h:k]`` that on the right; m = 0 or k = ``TOO_LARGE``
    if there is no cavity. `blocked_by` judges it.
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
        # if the left side is not in the cavity, its boundary is the chord, which must not be crossed again
        mark[e], mark[f] = -1, s
        stack[0] = e
        m, k = _grow(plane, scratch, one, px, py, m, h)
    mark[e], mark[f] = s, s
    return m, k, h


@lean
def commit_split(plane, scratch, e, m, k, h, p, t):
    """Split the subsegment on half-edge e at vertex p, parameter t of its piece; return the new number.

    The half that contains the old first end keeps its number; the other half is the last subsegment.
    Otherwise as `commit`; ``fresh[:h]`` lie on the left of e.
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
    # The left boundary begins at v, the right one at u; half-edge 3 t + 2 runs from p to such a beginning.
    for i, number in ((h, to_u), (0, to_v)):
        o = 3 * fresh[i] + 2
        mark[o], mark[twin[o]] = number, number
        plane.where[number] = o
    state[VERTICES] = max(state[VERTICES], p + 1)
    state[BUSY] = 0
    return new
