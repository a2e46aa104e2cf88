"""How the triangles of a surface are glued: half-edges, their twins, a vertex for each fan of triangles.

Half-edge ``3 t + k`` runs from corner k of triangle t to the next corner, with the triangle on its left. Its
*twin* is the same edge in the neighbor. The surface is cut open, without any error, where it is not an
oriented surface: edges of more than two triangles, and edges that two triangles run through in the same
direction, have no twins there; a vertex at which several fans of triangles meet becomes one vertex for each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel

__all__ = ["Gluing", "glued", "next_side", "previous_side"]


class Gluing(NamedTuple):
    """Half-edges of a surface that is cut open where it is no oriented surface.

    Attributes
    ----------
    vertex : (3 m,) int32
        Where each half-edge begins; vertices are numbered by fans.
    twin : (3 m,) int32
        -1 at boundaries and cuts.
    origin : (f,) int32
        The given vertex of each fan: for most surfaces 0, 1, 2, ... The first fan of a vertex has its number;
        further ones come after all vertices.
    cut : (3 m,) bool
        Half-edges that have no twin although the edge belongs to several triangles.
    first : (f,) int32
        A half-edge that begins at each fan: the first one counterclockwise at a boundary; -1 for a vertex
        that no triangle uses.
    """

    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    origin: NDArray[np.int32]
    cut: NDArray[np.bool_]
    first: NDArray[np.int32]


@inline
def next_side(h):
    """The half-edge after h in its triangle."""
    return h - 2 if h % 3 == 2 else h + 1


@inline
def previous_side(h):
    """The half-edge before h in its triangle."""
    return h + 2 if h % 3 == 0 else h - 1


@kernel
def _twins(rows, count, twin, cut):
    """Pair half-edges with the same two ends and opposite directions, by buckets of their lesser ends."""
    start = np.zeros(count + 1, dtype=np.int64)
    sides = np.empty(3 * rows.shape[0], dtype=np.int64)
    for t in range(rows.shape[0]):
        for k in range(3):
            start[min(rows[t, k], rows[t, (k + 1) % 3])] += 1
    for v in range(1, count + 1):
        start[v] += start[v - 1]
    for h in range(3 * rows.shape[0] - 1, -1, -1):
        v = min(rows[h // 3, h % 3], rows[h // 3, (h + 1) % 3])
        start[v] -= 1
        sides[start[v]] = h
    for v in range(count):
        for i in range(start[v], start[v + 1]):
            h = sides[i]
            a, b = rows[h // 3, h % 3], rows[h // 3, (h + 1) % 3]
            many, other = 0, -1
            for j in range(start[v], start[v + 1]):
                g = sides[j]
                c, d = rows[g // 3, g % 3], rows[g // 3, (g + 1) % 3]
                if (a == c and b == d) or (a == d and b == c):
                    many += 1
                    if a == d and b == c and a != b:
                        other = g
            twin[h] = other if many == 2 else -1
            cut[h] = many > 1 and twin[h] < 0


@kernel
def _fans(rows, count, twin, vertex, origin, first):
    """Number the fans of triangles around vertices; returns how many there are."""
    fans = count
    for v in range(count):
        first[v] = -1
        origin[v] = v
    for h in range(vertex.shape[0]):
        vertex[h] = -1
    for h in range(vertex.shape[0]):
        if vertex[h] >= 0:
            continue
        v = rows[h // 3, h % 3]
        start = h
        while twin[start] >= 0:  # clockwise to the boundary, or once around
            start = next_side(twin[start])
            if start == h:
                break
        f = v
        if first[v] >= 0:
            f = fans
            fans += 1
            origin[f] = v
        first[f] = start
        g = start
        while True:
            vertex[g] = f
            g = twin[previous_side(g)]
            if g < 0 or g == start:
                break
    return fans


def glued(rows: NDArray, count: int) -> Gluing:
    """The half-edges of triangles.

    Parameters
    ----------
    rows : (m, 3) int
        Triangles with three different corners each.
    count : int
        How many vertices there are.

    Notes
    -----
    O(m) if no vertex has many triangles, else the sum of squares of their numbers.
    """
    rows = np.ascontiguousarray(rows, dtype=np.int32)
    many = rows.size
    twin, cut = np.empty(many, dtype=np.int32), np.empty(many, dtype=np.bool_)
    _twins(rows, count, twin, cut)
    vertex = np.empty(many, dtype=np.int32)
    origin, first = np.empty(count + many, dtype=np.int32), np.empty(count + many, dtype=np.int32)
    fans = _fans(rows, count, twin, vertex, origin, first)
    return Gluing(vertex, twin, origin[:fans].copy(), cut, first[:fans].copy())
