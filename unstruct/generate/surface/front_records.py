"""The front on a surface: its edges, its vertices in a grid in space, and the edges of the mesh so far.

An edge of the front runs from u to v with what is not meshed on its left, seen against its normal. At a
crease two edges of the front lie between the same vertices, one for each side; where sheets branch there are
more, so each edge has a normal of its own. The vertices of the front are in a hash grid of cubes, one size of
cubes for each octave of the wanted length.
"""

from __future__ import annotations

from math import frexp
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean

__all__ = [
    "FRONT_EDGES",
    "FRONT_LEVELS",
    "FRONT_TRIANGLES",
    "FRONT_VERTICES",
    "SurfaceFront",
    "bucket_of",
    "close_edge",
    "enter_front_vertex",
    "in_grid",
    "known_edge",
    "note_edge",
    "octave_of",
    "open_edge",
    "side_of_cubes",
    "surface_front_arrays",
]

FRONT_VERTICES, FRONT_EDGES, FRONT_TRIANGLES, STAMPS, KNOWN_EDGES, FRONT_LEVELS = range(6)
SPAN_OF_CUBES = 4.0  # the side of cubes, in wanted lengths at the lower end of an octave
LOWEST_OCTAVE = 1100  # added to exponents, so that levels are positive


class SurfaceFront(NamedTuple):
    """The arrays of a front on a surface.

    Attributes
    ----------
    xyz : (n, 3)
        Scaled coordinates.
    near, part : (n,) int64
        The triangle of the surface at each vertex, and its component of the surface.
    level, cube, after, same : (n,) int64
        The octave of the wanted length, the bucket of the grid (-1: not in it), the next vertex in the bucket
        and the next one of the level.
    heads, tails : (n,) int64
        The last edge of the front that begins at each vertex, and that ends there; -1 for none.
    loose : (n,) int8
        1 for vertices that must be in the mesh and have no edge yet.
    ends : (f, 2) int64
    normal : (f, 3)
    seat : (f,) int64
        The triangle of the surface at the middle of each edge of the front.
    stamp : (f,) int64
        The age of each edge; -1 if it is not in the front.
    next_head, next_tail : (f,) int64
        The lists of the edges that begin or end at a vertex.
    triangles : (m, 3) int64
    home : (m,) int64
        The triangle of the surface at each new triangle.
    keys : (h,) int64, a hash table
        The edges of the mesh.
    buckets : (b,) int64
        The first vertex of each bucket of the grid.
    at_level, of_level : (l,) int64
        How many vertices of the grid have each level, from the lowest on, and the last one.
    level_box : (l, 2, 3)
        The box of the vertices of each level.
    held_normals : (t, 3)
        Of the triangles of the surface.
    state : (6,) int64
        How many vertices, edges, triangles, stamps and known edges there are; the lowest level.
    """

    xyz: NDArray[np.float64]
    near: NDArray[np.int64]
    part: NDArray[np.int64]
    level: NDArray[np.int64]
    cube: NDArray[np.int64]
    after: NDArray[np.int64]
    same: NDArray[np.int64]
    heads: NDArray[np.int64]
    tails: NDArray[np.int64]
    loose: NDArray[np.int8]
    ends: NDArray[np.int64]
    normal: NDArray[np.float64]
    seat: NDArray[np.int64]
    stamp: NDArray[np.int64]
    next_head: NDArray[np.int64]
    next_tail: NDArray[np.int64]
    triangles: NDArray[np.int64]
    home: NDArray[np.int64]
    keys: NDArray[np.int64]
    buckets: NDArray[np.int64]
    at_level: NDArray[np.int64]
    of_level: NDArray[np.int64]
    level_box: NDArray[np.float64]
    held_normals: NDArray[np.float64]
    state: NDArray[np.int64]


def surface_front_arrays(
    vertices: int, levels: tuple[int, int], normals: NDArray[np.float64]
) -> SurfaceFront:
    """An empty front with room for so many vertices whose wanted lengths are in these octaves."""
    many = levels[1] - levels[0] + 1
    edges, triangles = 8 * vertices + 64, 3 * vertices + 64
    buckets = 1 << (2 * vertices + 64).bit_length()
    none = [np.full(vertices, -1, dtype=np.int64) for _ in range(5)]
    zero = [np.zeros(vertices, dtype=np.int64) for _ in range(3)]
    unused = [np.full(edges, -1, dtype=np.int64) for _ in range(3)]
    return SurfaceFront(
        np.empty((vertices, 3)),
        zero[0],
        zero[1],
        zero[2],
        none[0],
        none[1],
        none[2],
        none[3],
        none[4],
        np.zeros(vertices, dtype=np.int8),
        np.zeros((edges, 2), dtype=np.int64),
        np.zeros((edges, 3)),
        np.zeros(edges, dtype=np.int64),
        unused[0],
        unused[1],
        unused[2],
        np.zeros((triangles, 3), dtype=np.int64),
        np.zeros(triangles, dtype=np.int64),
        np.full(4 * buckets, -1, dtype=np.int64),
        np.full(buckets, -1, dtype=np.int64),
        np.zeros(many, dtype=np.int64),
        np.full(many, -1, dtype=np.int64),
        np.stack([np.full((many, 3), np.inf), np.full((many, 3), -np.inf)], axis=1),
        normals,
        np.array([0, 0, 0, 0, 0, levels[0]], dtype=np.int64),
    )


# ---------------------------------------------------------------------- the grid


@inline
def octave_of(length):
    """The octave of a positive length."""
    return frexp(length)[1] + LOWEST_OCTAVE


@inline
def side_of_cubes(level):
    """The side of the cubes of a level."""
    return SPAN_OF_CUBES * 2.0 ** (level - LOWEST_OCTAVE - 1)


@inline
def bucket_of(front, level, i, j, k):
    """The bucket of a cube."""
    h = (i * 73856093) ^ (j * 19349663) ^ (k * 83492791) ^ (level * 2654435)
    return h & (front.buckets.shape[0] - 1)


@lean
def in_grid(front, v):
    """Put a vertex into the grid, if it is not there."""
    if front.cube[v] >= 0:
        return
    side = side_of_cubes(front.level[v])
    b = bucket_of(
        front,
        front.level[v],
        np.int64(np.floor(front.xyz[v, 0] / side)),
        np.int64(np.floor(front.xyz[v, 1] / side)),
        np.int64(np.floor(front.xyz[v, 2] / side)),
    )
    front.after[v] = front.buckets[b]
    front.buckets[b], front.cube[v] = v, b
    i = front.level[v] - front.state[FRONT_LEVELS]
    front.same[v] = front.of_level[i]
    front.of_level[i] = v
    front.at_level[i] += 1
    for m in range(3):
        front.level_box[i, 0, m] = min(front.level_box[i, 0, m], front.xyz[v, m])
        front.level_box[i, 1, m] = max(front.level_box[i, 1, m], front.xyz[v, m])


@lean
def enter_front_vertex(front, p, length, near, part):
    """Add a vertex at p, which is not in the grid yet; return its number."""
    v = front.state[FRONT_VERTICES]
    for m in range(3):
        front.xyz[v, m] = p[m]
    lowest, most = front.state[FRONT_LEVELS], front.at_level.shape[0] - 1
    front.level[v] = lowest + min(max(octave_of(length) - lowest, 0), most)
    front.near[v], front.part[v] = near, part
    front.state[FRONT_VERTICES] = v + 1
    return v


# ---------------------------------------------------------------------- edges


@inline
def _slot(front, u, v):
    """The place in the table of an edge, or where it would be put."""
    key = min(u, v) * 2147483648 + max(u, v)
    mask = front.keys.shape[0] - 1
    i = ((key ^ (key >> 29)) * 1000003 ^ (key >> 17)) & mask
    while front.keys[i] >= 0 and front.keys[i] != key:
        i = (i + 1) & mask
    return i


@lean
def known_edge(front, u, v):
    """Whether the mesh has the edge."""
    return front.keys[_slot(front, u, v)] >= 0


@lean
def note_edge(front, u, v):
    """Note an edge of the mesh."""
    i = _slot(front, u, v)
    front.state[KNOWN_EDGES] += front.keys[i] < 0
    front.keys[i] = min(u, v) * 2147483648 + max(u, v)


@lean
def open_edge(front, u, v, n, seat):
    """Put an edge into the front; return its row."""
    e = front.state[FRONT_EDGES]
    front.state[FRONT_EDGES] = e + 1
    front.ends[e, 0], front.ends[e, 1], front.seat[e] = u, v, seat
    front.normal[e, 0], front.normal[e, 1], front.normal[e, 2] = n[0], n[1], n[2]
    front.stamp[e] = front.state[STAMPS]
    front.state[STAMPS] += 1
    front.next_head[e], front.heads[u] = front.heads[u], e
    front.next_tail[e], front.tails[v] = front.tails[v], e
    front.loose[u], front.loose[v] = 0, 0
    in_grid(front, u)
    in_grid(front, v)
    note_edge(front, u, v)
    return e


@inline
def _unlink(first, following, v, e):
    if first[v] == e:
        first[v] = following[e]
        return
    i = first[v]
    while following[i] != e:
        i = following[i]
    following[i] = following[e]


@lean
def close_edge(front, e):
    """Take an edge out of the front."""
    u, v = front.ends[e, 0], front.ends[e, 1]
    _unlink(front.heads, front.next_head, u, e)
    _unlink(front.tails, front.next_tail, v, e)
    front.stamp[e] = -1
