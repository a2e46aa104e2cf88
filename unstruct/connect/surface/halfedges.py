"""Triangles of a surface as half-edges in arrays that grow, and the operations by which it is remeshed.

Half-edge 3 t + k lies opposite corner k of triangle t, as its entry in `Mesh.neighbors` does. It begins at
the next corner and ends at the one before:

        p = vertex[e]
       / \\
      /   \\         e runs from u = vertex[next_edge(e)] to w = vertex[prev_edge(e)];
     u --> w        twin[e], beyond it, runs from w to u; it is -1 on the boundary
      \\ e /
       \\ /
        q

A *corner* is also the number of a half-edge: that of the triangle's vertex. The corners of a vertex, each
reached from the one before by turning counterclockwise, are its star. Feature edges carry the number of their
curve on both half-edges. Every operation keeps a manifold one.
"""

from __future__ import annotations

from ...base.jit import inline, lean
from ..insertion.halfedges import UNUSED, next_edge, prev_edge
from .sheets import (
    ALONG_CURVE,
    CORNER,
    FIRST_FREE,
    FREE_SLOT,
    LAST_MARK,
    SEAM_CURVES,
    SHARED,
    SMOOTH,
    SURFACE_SLOTS,
    SURFACE_VERTICES,
    Sheets,
)

__all__ = [
    "ALONG_CURVE",
    "CORNER",
    "SEAM_CURVES",
    "SHARED",
    "SMOOTH",
    "SURFACE_SLOTS",
    "SURFACE_VERTICES",
    "Sheets",
    "can_collapse",
    "can_flip",
    "collapse_edge",
    "edge_between",
    "first_corner",
    "flip_edge",
    "has_room",
    "split_edge",
    "split_triangle",
    "turned",
    "turned_back",
]


# ---------------------------------------------------------------------- looking


@inline
def turned(twin, c):
    """The corner after c, counterclockwise around the same vertex; -1 beyond the boundary."""
    e = twin[next_edge(c)]
    return next_edge(e) if e >= 0 else -1


@inline
def turned_back(twin, c):
    """The corner before c, clockwise around the same vertex; -1 beyond the boundary."""
    e = twin[prev_edge(c)]
    return prev_edge(e) if e >= 0 else -1


@inline
def first_corner(s, v):
    """The corner from which turning counterclockwise passes the whole star of v."""
    c = s.at[v]
    if s.kind[v] != SMOOTH:  # the boundary is a feature
        start = c
        back = turned_back(s.twin, c)
        while back >= 0 and back != start:
            c = back
            back = turned_back(s.twin, c)
        c = start if back == start else c
    return c


@lean
def edge_between(s, u, w):
    """A half-edge between two vertices, the one from u to w if there is such; -1 if there is no edge."""
    start = first_corner(s, u)
    c = start
    while True:
        if s.vertex[next_edge(c)] == w:
            return prev_edge(c)
        last = c
        c = turned(s.twin, c)
        if c < 0:
            return next_edge(last) if s.vertex[prev_edge(last)] == w else -1
        if c == start:
            return -1


@lean
def _near_copy(s, x, w):
    """Whether a vertex is joined to a copy of another one."""
    start = first_corner(s, x)
    c = start
    while True:
        if s.on[s.vertex[next_edge(c)]] == s.on[w]:
            return True
        last = c
        c = turned(s.twin, c)
        if c < 0:
            return s.on[s.vertex[prev_edge(last)]] == s.on[w]
        if c == start:
            return False


@inline
def joined_to_copy(s, u, w):
    """Whether an edge between two vertices might be there already, between copies of them.

    Of two vertices that have copies, no edge is sure.
    """
    if s.on[u] <= SHARED:
        return s.on[w] <= SHARED or _near_copy(s, w, u)
    return s.on[w] <= SHARED and _near_copy(s, u, w)


@inline
def can_flip(s, e):
    """Whether the surface stays a manifold with the same features if edge e is flipped."""
    f = s.twin[e]
    if f < 0 or s.curve[e] >= 0:
        return False
    p, q = s.vertex[e], s.vertex[f]
    return p != q and edge_between(s, p, q) < 0 and not joined_to_copy(s, p, q)


@lean
def can_collapse(s, e):
    """Whether the vertex u where e begins can be merged into its end w; its curve, if any, must be that of e.

    This is the link condition: the neighbors that u and w have in common are those opposite e, and what is
    left is no pair of triangles back to back. Two features are never merged, and no new edge joins vertices
    whose copies are joined.
    """
    u, w, p, f = s.vertex[next_edge(e)], s.vertex[prev_edge(e)], s.vertex[e], s.twin[e]
    if s.kind[u] == CORNER or (s.kind[u] == ALONG_CURVE and s.curve[e] < 0):
        return False
    if s.curve[next_edge(e)] >= 0 and s.curve[prev_edge(e)] >= 0:
        return False
    if s.twin[next_edge(e)] < 0 and s.twin[prev_edge(e)] < 0:
        return False
    q = -1
    if f >= 0:
        q = s.vertex[f]
        if p == q or (s.curve[next_edge(f)] >= 0 and s.curve[prev_edge(f)] >= 0):
            return False
        if s.twin[next_edge(f)] < 0 and s.twin[prev_edge(f)] < 0:
            return False
    s.state[LAST_MARK] += 1
    stamp = s.state[LAST_MARK]
    start = first_corner(s, w)
    c, around_w, open_w = start, 0, False
    while True:
        s.mark[s.vertex[next_edge(c)]] = stamp
        around_w += 1
        last = c
        c = turned(s.twin, c)
        if c < 0:
            s.mark[s.vertex[prev_edge(last)]] = stamp
            open_w = True
            break
        if c == start:
            break
    start = first_corner(s, u)
    c, around_u, open_u = start, 0, False
    while True:
        x = s.vertex[next_edge(c)]
        if x != w and x != p and x != q and (s.mark[x] == stamp or joined_to_copy(s, w, x)):
            return False
        around_u += 1
        last = c
        c = turned(s.twin, c)
        if c < 0:
            x = s.vertex[prev_edge(last)]
            if x != w and x != p and x != q and (s.mark[x] == stamp or joined_to_copy(s, w, x)):
                return False
            open_u = True
            break
        if c == start:
            break
    if open_u and open_w and f >= 0:  # an edge across a strip between two parts of the boundary
        return False
    return around_u > 3 or around_w > 3 or open_u or open_w


# ---------------------------------------------------------------------- changing


@inline
def has_room(s, vertices, triangles):
    """Whether the arrays have room for this many more."""
    state = s.state
    return (
        state[SURFACE_VERTICES] + vertices <= s.at.shape[0]
        and state[SURFACE_SLOTS] + triangles <= s.name.shape[0]
    )


@inline
def _new_vertex(s):
    v = s.state[FIRST_FREE]
    if v >= 0:
        s.state[FIRST_FREE] = -3 - s.at[v]
    else:
        v = s.state[SURFACE_VERTICES]
        s.state[SURFACE_VERTICES] = v + 1
    return v


@inline
def _free_vertex(s, v):
    s.at[v] = -3 - s.state[FIRST_FREE]
    s.state[FIRST_FREE] = v


@inline
def _new_triangle(s):
    t = s.state[FREE_SLOT]
    if t >= 0:
        s.state[FREE_SLOT] = s.twin[3 * t]
    else:
        t = s.state[SURFACE_SLOTS]
        s.state[SURFACE_SLOTS] = t + 1
    return t


@inline
def _free_triangle(s, t):
    s.vertex[3 * t] = UNUSED
    s.twin[3 * t] = s.state[FREE_SLOT]
    s.state[FREE_SLOT] = t


@inline
def _tie(s, e, f):
    """Make two half-edges twins; either may be -1."""
    if e >= 0:
        s.twin[e] = f
    if f >= 0:
        s.twin[f] = e


@lean
def _halved(s, e, m):
    """Halve the triangle of e at the vertex m on e: (p, u, w) becomes (p, u, m) and (p, m, w).

    Returns the half-edge from m to w.
    """
    after, before = next_edge(e), prev_edge(e)
    p, w, outer = s.vertex[e], s.vertex[before], s.twin[after]
    t = _new_triangle(s)
    s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2] = p, m, w
    s.curve[3 * t], s.curve[3 * t + 1], s.curve[3 * t + 2] = s.curve[e], s.curve[after], -1
    s.name[t] = s.name[e // 3]
    s.vertex[before] = m
    s.curve[after] = -1
    _tie(s, 3 * t + 1, outer)
    _tie(s, 3 * t + 2, after)
    s.at[w] = 3 * t + 2
    s.at[m] = 3 * t + 1
    return 3 * t


@lean
def split_edge(s, e):
    """Halve an edge and its triangles at its middle, and return the new vertex; `has_room` for 1 and 2."""
    f = s.twin[e]
    u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
    m = _new_vertex(s)
    for k in range(3):
        s.xyz[m, k] = 0.5 * (s.xyz[u, k] + s.xyz[w, k])
    s.kind[m] = ALONG_CURVE if s.curve[e] >= 0 else SMOOTH
    s.on[m], s.near[m], s.mark[m] = s.curve[e], s.near[u], 0
    s.size[m], s.cap[m] = 0.5 * (s.size[u] + s.size[w]), 0.5 * (s.cap[u] + s.cap[w])
    s.allowed[m] = 0.5 * (s.allowed[u] + s.allowed[w])
    g = _halved(s, e, m)
    if f < 0:
        s.twin[g] = -1
    else:
        h = _halved(s, f, m)
        _tie(s, e, h)
        _tie(s, f, g)
    return m


@lean
def split_triangle(s, t):
    """Join a new vertex in the middle of a triangle to its corners, and return it; `has_room` for 1 and 2."""
    a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
    m = _new_vertex(s)
    for k in range(3):
        s.xyz[m, k] = (s.xyz[a, k] + s.xyz[b, k] + s.xyz[c, k]) / 3.0
    s.kind[m], s.on[m], s.near[m], s.mark[m] = SMOOTH, -1, s.near[a], 0
    s.size[m] = (s.size[a] + s.size[b] + s.size[c]) / 3.0
    s.cap[m] = (s.cap[a] + s.cap[b] + s.cap[c]) / 3.0
    s.allowed[m] = (s.allowed[a] + s.allowed[b] + s.allowed[c]) / 3.0
    one, two = _new_triangle(s), _new_triangle(s)  # (a, b, m) stays, (b, c, m) and (c, a, m) are new
    across_a, across_b = s.twin[3 * t], s.twin[3 * t + 1]
    s.vertex[3 * one], s.vertex[3 * one + 1], s.vertex[3 * one + 2] = b, c, m
    s.vertex[3 * two], s.vertex[3 * two + 1], s.vertex[3 * two + 2] = c, a, m
    s.curve[3 * one], s.curve[3 * one + 1], s.curve[3 * one + 2] = -1, -1, s.curve[3 * t]
    s.curve[3 * two], s.curve[3 * two + 1], s.curve[3 * two + 2] = -1, -1, s.curve[3 * t + 1]
    s.name[one], s.name[two] = s.name[t], s.name[t]
    s.vertex[3 * t + 2] = m
    s.curve[3 * t], s.curve[3 * t + 1] = -1, -1
    _tie(s, 3 * one + 2, across_a)
    _tie(s, 3 * two + 2, across_b)
    _tie(s, 3 * t, 3 * one + 1)
    _tie(s, 3 * one, 3 * two + 1)
    _tie(s, 3 * two, 3 * t + 1)
    s.at[a], s.at[b], s.at[c], s.at[m] = 3 * t, 3 * t + 1, 3 * one + 1, 3 * t + 2
    return m


@lean
def flip_edge(s, e):
    """Turn edge u w of the triangles (p, u, w) and (q, w, u) into p q; `can_flip` says whether it may be.

    The triangles become (p, u, q) and (q, w, p); the new edge is that of the half-edge ``next_edge(e)``.
    """
    f = s.twin[e]
    e_after, e_before, f_after, f_before = next_edge(e), prev_edge(e), next_edge(f), prev_edge(f)
    u, w = s.vertex[e_after], s.vertex[f_after]
    beyond_e, beyond_f = s.twin[e_after], s.twin[f_after]
    curve_e, curve_f = s.curve[e_after], s.curve[f_after]
    s.vertex[e_before], s.vertex[f_before] = s.vertex[f], s.vertex[e]
    _tie(s, e, beyond_f)
    _tie(s, f, beyond_e)
    s.curve[e], s.curve[f] = curve_f, curve_e
    s.twin[e_after], s.twin[f_after] = f_after, e_after
    s.curve[e_after], s.curve[f_after] = -1, -1
    s.at[u], s.at[w], s.at[s.vertex[e]], s.at[s.vertex[f]] = e_after, f_after, e, f


@lean
def _closed_up(s, e):
    """Take away the triangle (p, u, w) of e, whose sides at p become one."""
    one, two = s.twin[next_edge(e)], s.twin[prev_edge(e)]  # p -> w and u -> p
    p, w = s.vertex[e], s.vertex[prev_edge(e)]
    curve = max(s.curve[next_edge(e)], s.curve[prev_edge(e)])
    _tie(s, one, two)
    if one >= 0:
        s.curve[one] = curve
        s.at[p], s.at[w] = next_edge(one), prev_edge(one)
    if two >= 0:
        s.curve[two] = curve
        s.at[p], s.at[w] = prev_edge(two), next_edge(two)
    _free_triangle(s, e // 3)


@lean
def collapse_edge(s, e):
    """Merge the vertex u where e begins into its end w, which stays in its place; see `can_collapse`."""
    f = s.twin[e]
    u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
    start = first_corner(s, u)
    c = start
    while True:
        s.vertex[c] = w
        c = turned(s.twin, c)
        if c < 0 or c == start:
            break
    _closed_up(s, e)
    if f >= 0:
        _closed_up(s, f)
    _free_vertex(s, u)
