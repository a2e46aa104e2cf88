"""Filling a polygon beside a segment with constrained Delaunay triangles, compiled.

The polygon lies on the left of its base V_0 V_n; its other sides are a chain V_0 ... V_n, each corner of
which was joined to the other side of the base by an old edge. So every corner sees the base.

`fill` finds, for one base after the other, the corner whose circle contains no other corner of the polygon.
This is Anglada's method; it needs k log k tests for corners at random places, but k^2 for rows of points
along the segment, where each base after the first cuts off one corner only. After too many tests,
`cut_ears` cuts the remaining polygons in one pass, and swaps then make the edges Delaunay. An ear at a
corner b with neighbors a and c may be cut: the lines of sight from a and c to the base enclose no corner
but b. As long as there is a corner there is an ear, by the sum of angles.

Sources: M. V. Anglada, Computers & Graphics 21 (1997) 215-223; G. T. Toussaint, D. Avis, On a convex hull
algorithm for polygons and its application to triangulation problems, Pattern Recognition 15 (1982) 23-29.
Book: 2.5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...predicates.kernels import incircle, orientation
from ..insertion.halfedges import next_edge, prev_edge
from .stars import legalize

__all__ = ["Chain", "Filling", "cut_ears", "fill", "load", "swap_all"]


class Chain(NamedTuple):
    """A chain of corners that is to be filled: the corners, and the edge from each to the next."""

    corners: NDArray[np.int64]  # vertices
    beyond: NDArray[np.int64]  # the half-edge on the other side of the edge
    marks: NDArray[np.int64]
    fresh: NDArray[np.int64]  # the half-edge that has replaced it, -1 as long as there is none


class Filling(NamedTuple):
    """The arrays for the insertion of segments: the triangulation, and scratch for one segment at a time."""

    xy: NDArray[np.float64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    mark: NDArray[np.int32]
    corner: NDArray[np.int32]  # for each vertex a half-edge opposite it
    where: NDArray[np.int32]  # for each segment a half-edge along it
    left: NDArray[np.int64]  # half-edges of the chain above a segment; afterwards scratch
    right: NDArray[np.int64]  # half-edges of the chain below it; afterwards scratch
    cells: NDArray[np.int64]  # the triangles that a segment crosses
    chains: NDArray[np.int64]  # (8, .) the rows of two `Chain`s
    stack: NDArray[np.int64]  # (., 3) polygons that remain to be filled
    pending: NDArray[np.int32]  # edges that remain to be tested


@inline
def load(w, half_edges, n, chain):
    """Record what a chain of n half-edges borders on, before its triangles are overwritten.

    Both sides of a dangling edge are in the chain; ``beyond[k]`` is then -2 - (place of the other side).
    """
    vertex, twin, corners, beyond = w.vertex, w.twin, chain.corners, chain.beyond
    for k in range(n):
        h = np.int64(half_edges[k])
        corners[k], beyond[k] = vertex[prev_edge(h)], twin[h]
        chain.marks[k], chain.fresh[k] = w.mark[h], -1
    corners[n] = vertex[next_edge(np.int64(half_edges[n - 1]))]
    for k in range(n):
        twin[beyond[k]] = -2 - k
    for k in range(n):
        if twin[half_edges[k]] < 0:
            beyond[k] = twin[half_edges[k]]


@inline
def close(w, chain, g, k):
    """Let half-edge g replace edge k of the chain."""
    twin, fresh = w.twin, chain.fresh
    o = chain.beyond[k]
    w.mark[g] = chain.marks[k]
    fresh[k] = g
    if o < 0:  # a dangling edge: it is joined when its other side is there
        o = fresh[-2 - o]
    if o >= 0:
        twin[g], twin[o] = o, g


@inline
def write(w, slot, a, b, c):
    """Write the triangle on the base a b with apex c; return the base s; b c is s + 1, c a is s + 2."""
    vertex, mark, corner = w.vertex, w.mark, w.corner
    s = 3 * np.int64(slot)
    vertex[s], vertex[s + 1], vertex[s + 2] = c, a, b
    corner[c], corner[a], corner[b] = s, s + 1, s + 2
    mark[s], mark[s + 1], mark[s + 2] = -1, -1, -1
    return s


@lean
def cut_ears(w, cells, used, chain, i, j):
    """Triangulate the polygon of the chain from V_i to V_j; return triangles used, and the base half-edge.

    The corners form a stack: as long as the last three turn right, the middle one is an ear. For each corner
    ``links`` has the half-edge towards the corner before it, -1 for an edge of the chain.
    """
    xy, twin, corners, places, links = w.xy, w.twin, chain.corners, w.left, w.right
    places[0] = i
    top = 0
    for k in range(i + 1, j + 1):
        top += 1
        places[top], links[top] = k, -1
        while top >= 2:
            a, b, c = corners[places[top - 2]], corners[places[top - 1]], corners[k]
            if orientation(xy, a, b, c) >= 0:
                break
            s = write(w, cells[used], a, c, b)
            used += 1
            for g, at in ((s + 2, top - 1), (s + 1, top)):
                h = links[at]
                if h < 0:
                    close(w, chain, g, places[at - 1])
                else:
                    twin[g], twin[h] = h, g
            top -= 1
            places[top], links[top] = k, s
    return used, np.int64(links[1])


@lean
def fill(w, cells, chain, n, patience):
    """Triangulate the polygon on the left of V_0 V_n; return its base half-edge, and the place of the first
    cell whose edges may not be Delaunay.

            V_c                 On V_i V_j: slot s, the base opposite V_c. The parts of
           /   \\  s + 1        the chain from V_i to V_c and from V_c to V_j are
    s + 2 /  s  \\              filled next, on s + 2 and s + 1.
        V_i-----V_j
    """
    xy, twin, corners, stack = w.xy, w.twin, chain.corners, w.stack
    base = np.int64(-1)
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, n, -1
    depth, used, asked, rough = 1, 0, 0, n
    while depth > 0:
        depth -= 1
        i, j, g = stack[depth, 0], stack[depth, 1], stack[depth, 2]
        if j == i + 1:
            close(w, chain, g, i)
            continue
        if asked > patience * n and g >= 0:
            rough = min(rough, used)
            used, s = cut_ears(w, cells, used, chain, i, j)
            twin[s], twin[g] = g, s
            continue
        a, b, c = corners[i], corners[j], i + 1
        v = corners[c]
        for k in range(i + 2, j):
            p = corners[k]
            if incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[v, 0], xy[v, 1], xy[p, 0], xy[p, 1]) > 0:
                c, v = k, p
        asked += j - i
        s = write(w, cells[used], a, b, v)
        used += 1
        if g < 0:
            base = s
        else:
            twin[s], twin[g] = g, s
        stack[depth, 0], stack[depth, 1], stack[depth, 2] = i, c, s + 2
        stack[depth + 1, 0], stack[depth + 1, 1], stack[depth + 1, 2] = c, j, s + 1
        depth += 2
    return base, rough


@lean
def swap_all(w, cells, first, last):
    """Swap edges of ``cells[first:last]``, and the edges affected, until all are locally Delaunay."""
    xy, vertex, twin, mark, pending = w.xy, w.vertex, w.twin, w.mark, w.pending
    again = True
    while again:
        again = False
        for k in range(first, last):
            for e in range(3 * np.int64(cells[k]), 3 * np.int64(cells[k]) + 3):
                pending[0] = e
                if legalize(xy, vertex, twin, mark, w.where, w.corner, pending, np.int64(1)) < 0:
                    again = True
