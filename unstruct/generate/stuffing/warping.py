"""Cut points, and vertices of the lattice that are moved onto them if they are too close.

A cut point *violates* a vertex at an end of its edge if it divides the edge nearer to the vertex than a share
alpha of it, which is another one for long and for short edges. A vertex with violating cut points moves to
the nearest of them. Then it is on the surface, and its edges have no cut points any more. See the book,
chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct
from ...base.jit import kernel

__all__ = ["ALPHA", "Edges", "crossed_edges", "warped"]

# The shares for long and for short edges of a lattice. With them all dihedral angles are between 10.784 and
# 164.738 degrees, as `stuffing_bounds` proves. The least angles of two stencils are in balance there, so that
# none of the pairs next to it, and of those that were tried, has a larger one.
ALPHA = (0.28511, 0.39882)


class Edges(NamedTuple):
    """Edges between a vertex inside and one outside.

    Attributes
    ----------
    keys : (e,) int64
        ``i * n + j`` for i < j; increasing.
    inner, outer : (e,) int64
        The vertices inside and outside.
    """

    keys: NDArray[np.int64]
    inner: NDArray[np.int64]
    outer: NDArray[np.int64]


def crossed_edges(cells: NDArray[np.int32], sign: NDArray[np.int8]) -> Edges:
    """The edges of tetrahedra (m, 4) whose ends have opposite signs, each once."""
    n, found = len(sign), []
    for i in range(4):
        for j in range(i):
            a, b = cells[:, i], cells[:, j]
            crossed = sign[a] * sign[b] < 0
            a, b = a[crossed].astype(np.int64), b[crossed].astype(np.int64)
            found.append(np.minimum(a, b) * n + np.maximum(a, b))
    keys = distinct(np.concatenate(found))
    low, high = np.divmod(keys, n)
    swap = sign[low] < 0
    return Edges(keys, np.where(swap, high, low), np.where(swap, low, high))


@kernel
def _warp(start, edge, far, violates, distance, to):
    """Choose for each vertex the cut point to which it moves, in the order of the vertices.

    ``edge[start[v]:start[v + 1]]`` are the edges of vertex number v of those that have some, with the
    distance of their cut points and whether they violate it; ``to[v]`` becomes the edge, or -1. ``far`` has
    the other vertices of the edges. An edge loses its cut point when one of its ends moves.
    """
    for v in range(len(to)):
        best = np.int64(-1)
        for k in range(start[v], start[v + 1]):
            if violates[k] and to[far[k]] < 0 and (best < 0 or distance[k] < distance[best]):
                best = k
        to[v] = edge[best] if best >= 0 else np.int64(-1)


def warped(
    edges: Edges, share: NDArray[np.float64], length: NDArray[np.float64], limit: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Which vertices move, and onto which cut points.

    Parameters
    ----------
    edges : Edges
    share : (e,) float64
        Where the cut points are: 0 at the vertex inside, 1 at the one outside.
    length : (e,) float64
        Of the edges, in any unit.
    limit : (2, e) float64
        Cut points nearer than this to the inner and to the outer end of an edge violate it.

    Returns
    -------
    vertex, edge : (k,) int64
        The vertices that move, increasing, and the edges whose cut points they move to.
    """
    e = len(edges.keys)
    vertex = np.concatenate([edges.inner, edges.outer])
    other = np.concatenate([edges.outer, edges.inner])
    distance = np.concatenate([share * length, (1.0 - share) * length])
    order = np.argsort(vertex, kind="stable")
    known = distinct(vertex)
    start = np.searchsorted(vertex[order], known)
    edge = order % e if e else order
    to = np.full(len(known), -1, dtype=np.int64)
    _warp(
        np.append(start, 2 * e).astype(np.int64),
        edge,
        np.searchsorted(known, other[order]),
        distance[order] < limit.ravel()[order],
        distance[order],
        to,
    )
    moves = to >= 0
    return known[moves], to[moves]
