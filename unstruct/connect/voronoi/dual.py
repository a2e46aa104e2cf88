"""The combinatorics of a Voronoi diagram, derived from a Delaunay triangulation exactly.

Simplices on one common sphere form a *group* and share one Voronoi vertex, the center of that sphere.
A Delaunay edge is dual to a ridge, unless it is a diagonal that only divides a cospherical group; the cells
of its two sites then meet in less than a facet. Coordinates enter through exact signs only.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...predicates.batch import in_sphere, orient
from ...predicates.power import power_signs

__all__ = [
    "Ridges",
    "cospherical_groups",
    "find_ridges",
    "general_ridges",
    "planar_ridges",
    "planar_rings",
    "spatial_ridges",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

CELLS_AT_ONCE = 1 << 15  # the facets of so many cells are tested at a time, to bound the memory


class Ridges(NamedTuple):
    """Facets between cells. Rows of varying length are compressed: row r is flat[start[r]:start[r + 1]]."""

    points: Ints  # (r, 2) the two sites of each ridge
    start: NDArray[np.int64]  # (r + 1,) starts of the rows of `vertices`
    vertices: Ints  # the groups around each ridge, with -1 first if it is unbounded
    ray_start: NDArray[np.int64]  # (r + 1,) starts of the rows of `rays`
    rays: Ints  # rays of each ridge: at the first listed vertex, then at the last (only one in the plane)
    ray_facets: NDArray[np.int64]  # (h,) the facet of the hull behind each ray, as cell * (d + 1) + corner


def cospherical_groups(
    points: Floats, simplices: Ints, neighbors: Ints, weights: Floats | None = None
) -> tuple[Ints, tuple[int, int] | None]:
    """Number the simplices such that two have the same number exactly when they have the same circumsphere.

    All simplices on one sphere fill a convex polytope, so they are connected through facets, and tests of
    neighbors find them all. Groups are numbered in the order of their first simplices. With weights, spheres
    are orthogonal to those of their sites instead. The second value has two neighbors that are not locally
    Delaunay, if there are any.
    """
    m = len(simplices)
    tied = [np.empty((0, 2), dtype=np.int64)]
    for low in range(0, m, CELLS_AT_ONCE):
        across = neighbors[low : low + CELLS_AT_ONCE]
        t, corner = np.nonzero(across > np.arange(low, low + len(across))[:, None])
        u = across[t, corner]
        t += low
        if not len(t):
            continue
        beyond = simplices[u, np.argmax(neighbors[u] == t[:, None], axis=1)]
        if weights is None:
            inside = np.atleast_1d(in_sphere(points[simplices[t]], points[beyond]))
        else:
            inside = power_signs(points, weights, simplices[t], beyond)
        if (inside > 0).any():
            k = int(np.argmax(inside > 0))
            return np.arange(m, dtype=np.int32), (int(t[k]), int(u[k]))
        tied.append(np.stack([t[inside == 0], u[inside == 0]], axis=1))
    links = np.concatenate(tied)
    return (_linked(m, links) if len(links) else np.arange(m, dtype=np.int32)), None


def _linked(size: int, links: NDArray[np.int64]) -> Ints:
    """Number 0 .. size - 1 by connected components, in order of appearance."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    graph = csr_array((np.ones(len(links), dtype=np.int8), tuple(links.T)), shape=(size, size))
    label = connected_components(graph, directed=False)[1]
    _, first, piece = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int32)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[piece]


def find_ridges(points: Floats, simplices: Ints, neighbors: Ints, group: Ints) -> Ridges:
    """The ridges, by the method for the dimension; all methods find the same ridges."""
    if simplices.shape[1] == 3:
        return planar_ridges(simplices, neighbors, group)
    if simplices.shape[1] == 4:
        return spatial_ridges(points, simplices, neighbors, group)
    return general_ridges(points, simplices, neighbors, group)


# --- the plane ------------------------------------------------------------------------------------


def planar_ridges(simplices: Ints, neighbors: Ints, group: Ints) -> Ridges:
    """Ridges of a planar diagram, one for each edge between two groups or between a group and the outside."""
    m = len(simplices)
    cell, corner = np.nonzero((neighbors > np.arange(m)[:, None]) | (neighbors < 0))
    other = neighbors[cell, corner]
    left = group[cell]
    right = np.where(other < 0, -1, group[other])
    kept = left != right
    cell, corner, left, right = cell[kept], corner[kept], left[kept], right[kept]
    outer = right < 0
    sites = np.stack([simplices[cell, (corner + 1) % 3], simplices[cell, (corner + 2) % 3]], axis=1)
    r = len(cell)
    return Ridges(
        sites,
        np.arange(0, 2 * r + 1, 2),
        np.stack([np.where(outer, -1, left), np.where(outer, left, right)], axis=1).ravel().astype(np.int32),
        np.concatenate([[0], np.cumsum(outer)]),
        np.arange(outer.sum(), dtype=np.int32),
        cell[outer] * 3 + corner[outer],
    )


@kernel
def planar_rings(simplices, neighbors, group, first, start, ring):
    """Voronoi vertices around each site, counterclockwise, with -1 first if its cell is unbounded.

    ``start`` (sites + 1) and ``ring`` are filled; ``first`` is a work array. Returns the length of the ring.

            b
           / \\         t = (v, a, b). The next cell counterclockwise around v lies
          /   \\        beyond the edge v b, opposite a; the previous cell lies
         v --- a        beyond the edge v a, opposite b.
    """
    for v in range(first.size):
        first[v] = -1
    for t in range(simplices.shape[0]):
        for k in range(3):
            v = simplices[t, k]
            if first[v] < 0 or neighbors[t, (k + 2) % 3] < 0:
                first[v] = t
    size = 0
    for v in range(first.size):
        start[v] = begin = size
        t = first[v]
        if t < 0:
            continue  # a copy of another site
        if neighbors[t, (_corner(simplices, t, v) + 2) % 3] < 0:
            ring[size] = -1
            size += 1
        while True:
            if size == begin or ring[size - 1] != group[t]:
                ring[size] = group[t]
                size += 1
            t = neighbors[t, (_corner(simplices, t, v) + 1) % 3]
            if t < 0 or t == first[v]:
                break
        if size > begin + 1 and ring[size - 1] == ring[begin]:
            size -= 1
    start[first.size] = size
    return size


@inline
def _corner(simplices, t, v):
    """The place of vertex v in simplex t."""
    k = 0
    while simplices[t, k] != v:
        k += 1
    return k


# --- space ----------------------------------------------------------------------------------------

# The rows are even permutations: seen along p -> q, simplex (p, q, a, b) turns counterclockwise from a to b.
EDGES = np.array([[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]])


@inline
def _fourth(simplices, t, p, q, r):
    """The vertex of tetrahedron t other than p, q, r."""
    for k in range(4):
        v = simplices[t, k]
        if v != p and v != q and v != r:
            return v
    return -1


@kernel
def _turn(simplices, neighbors, t, p, q, a, b, least):
    """Turn around the edge p q, from t = (p, q, a, b) across the facet p q b, and so on.

    Returns the last cell and its corners a, b; the cell is -1 if the turn met a cell below ``least``.
    """
    s = t
    while True:
        u = neighbors[s, _corner(simplices, s, a)]
        if u < 0 or u == t:
            return s, a, b
        if u < least:
            return -1, a, b
        a, b = b, _fourth(simplices, u, p, q, b)
        s = u


@kernel
def _spatial(simplices, neighbors, group, pairs, start, ring, ends, thirds):
    """Rings of groups around all edges; each edge is found from the smallest cell that contains it.

    ``ends[r]`` receives the first and the last facet on the hull (4 * cell + corner), or -1 for closed rings;
    ``thirds[r]`` receives their vertices other than those of the edge. Returns the number of rings.
    """
    count, size = 0, 0
    for t in range(simplices.shape[0]):
        for e in range(6):
            p, q = simplices[t, EDGES[e, 0]], simplices[t, EDGES[e, 1]]
            a, b = simplices[t, EDGES[e, 2]], simplices[t, EDGES[e, 3]]
            last, la, lb = _turn(simplices, neighbors, t, p, q, a, b, t)
            if last < 0:
                continue
            open_end = neighbors[last, _corner(simplices, last, la)] < 0
            s, begin = t, size
            if open_end:  # turn in the other direction, with p, q and a, b exchanged
                s, b, a = _turn(simplices, neighbors, t, q, p, b, a, t)
                if s < 0:
                    continue
                ends[count, 0] = 4 * s + _corner(simplices, s, b)
                ends[count, 1] = 4 * last + _corner(simplices, last, la)
                thirds[count, 0], thirds[count, 1] = a, lb
                ring[size] = -1
                size += 1
            else:
                ends[count, 0], ends[count, 1] = -1, -1
            while True:
                if size == begin or ring[size - 1] != group[s]:
                    ring[size] = group[s]
                    size += 1
                if s == last:
                    break
                s = neighbors[s, _corner(simplices, s, a)]
                a, b = b, _fourth(simplices, s, p, q, b)
            if size > begin + 1 and ring[size - 1] == ring[begin]:
                size -= 1
            pairs[count, 0], pairs[count, 1] = p, q
            count += 1
            start[count] = size
    return count


def spatial_ridges(points: Floats, simplices: Ints, neighbors: Ints, group: Ints) -> Ridges:
    """Ridges of a diagram in space, with vertices in cyclic order (counterclockwise along the edge)."""
    m = len(simplices)
    outer = np.flatnonzero(neighbors.ravel() < 0)
    most = 6 * m
    pairs, ends = np.empty((most, 2), dtype=np.int32), np.empty((most, 2), dtype=np.int64)
    thirds = np.empty((most, 2), dtype=np.int32)
    start, ring = np.zeros(most + 1, dtype=np.int64), np.empty(2 * most, dtype=np.int32)
    count = _spatial(simplices, neighbors, group, pairs, start, ring, ends, thirds)
    pairs, ends, thirds, start = pairs[:count], ends[:count], thirds[:count], start[: count + 1]
    length, is_open = np.diff(start), ends[:, 0] >= 0
    # Around a diagonal there are at most two groups; on the hull there is one, between coplanar facets.
    kept = length >= 3
    doubtful = np.flatnonzero(is_open & (length == 2))
    bent = orient(points[np.hstack([pairs[doubtful], thirds[doubtful]])]) != 0
    kept[doubtful[bent]] = True
    ray_of, ray_facets = _merge_rays(4 * m, outer, ends[doubtful[~bent]])
    rows = np.flatnonzero(kept)
    flat = np.repeat(kept, length)
    return Ridges(
        pairs[rows],
        np.concatenate([[0], np.cumsum(length[rows])]),
        ring[: start[-1]][flat],
        np.concatenate([[0], np.cumsum(2 * is_open[rows])]),
        ray_of[ends[rows[is_open[rows]]]].ravel(),
        ray_facets,
    )


def _merge_rays(
    size: int, outer: NDArray[np.int64], same: NDArray[np.int64]
) -> tuple[Ints, NDArray[np.int64]]:
    """Number the facets of the hull; pairs in ``same`` (with one vertex and one plane) share a number."""
    place = np.full(size, -1, dtype=np.int64)
    place[outer] = np.arange(len(outer))
    label = _linked(len(outer), place[same.reshape(-1, 2)])
    first = np.unique(label, return_index=True)[1]
    ray_of = np.full(size, -1, dtype=np.int32)
    ray_of[outer] = label
    return ray_of, outer[first]


# --- any dimension --------------------------------------------------------------------------------


def general_ridges(points: Floats, simplices: Ints, neighbors: Ints, group: Ints) -> Ridges:
    """Ridges in any dimension, with vertices in increasing order.

    The smallest face of the Delaunay complex that contains an edge is the intersection of all the polytopes
    (groups) and all the flat faces of the hull that contain it. The edge is dual to a ridge exactly when that
    face is the edge itself.
    """
    width = simplices.shape[1]
    outer = np.flatnonzero(neighbors.ravel() < 0)
    facets = [frozenset(np.delete(simplices[f // width], f % width).tolist()) for f in outer.tolist()]
    same, flat = _coplanar(points, facets, group[outer // width])
    ray_of, ray_facets = _merge_rays(simplices.size, outer, outer[same])
    body: dict[int, set[int]] = {}
    around: dict[tuple[int, ...], set[int]] = {}
    for g, row in zip(group.tolist(), np.sort(simplices, axis=1).tolist()):
        body.setdefault(g, set()).update(row)
        for edge in combinations(row, 2):
            around.setdefault(edge, set()).add(g)
    beyond: dict[tuple[int, ...], list[int]] = {}
    for place, facet in enumerate(facets):
        for side in combinations(sorted(facet), 2):
            beyond.setdefault(side, []).append(place)
    pairs, rings, rays = [], [], []
    for pair, groups in around.items():
        hull = beyond.get(pair, [])
        faces = [body[g] for g in groups] + [flat[place] for place in hull]
        if len(set.intersection(*faces)) == 2:
            pairs.append(pair)
            rings.append([-1] * bool(hull) + sorted(groups))
            rays.append(sorted({int(ray_of[outer[place]]) for place in hull}))
    return Ridges(np.array(pairs, dtype=np.int32), *_compressed(rings), *_compressed(rays), ray_facets)


def _coplanar(
    points: Floats, facets: list[frozenset[int]], group: Ints
) -> tuple[NDArray[np.int64], list[set[int]]]:
    """Pairs of facets with one hyperplane and one Voronoi vertex; the sites in each facet's hyperplane.

    The sites are those of all facets that are connected to it within the hyperplane.
    """
    ridges: dict[frozenset[int], list[int]] = {}
    for place, facet in enumerate(facets):
        for v in facet:
            if len(facet) > 1:
                ridges.setdefault(facet - {v}, []).append(place)
    level: list[tuple[int, int]] = []
    for e, f in ridges.values():
        apex = next(iter(facets[f] - facets[e]))
        if orient(points[[*facets[e], apex]]) == 0:
            level.append((e, f))
    faces: dict[int, set[int]] = {}
    label = _linked(len(facets), np.array(level, dtype=np.int64).reshape(-1, 2)).tolist()
    for face, facet in zip(label, facets):
        faces.setdefault(face, set()).update(facet)
    same = np.array([(e, f) for e, f in level if group[e] == group[f]], dtype=np.int64)
    return same.reshape(-1, 2), [faces[face] for face in label]


def _compressed(rows: list[list[int]]) -> tuple[NDArray[np.int64], Ints]:
    start = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int64)
    return start, np.array([x for row in rows for x in row], dtype=np.int32)
