"""The curves and corners of a surface of triangles that a mesh on it must keep.

Equal points count as one, triangles with fewer than three different corners do not count. A flat triangle
has the direction of its neighbor across its longest side: a crease that runs along flat triangles, as they
occur in files, is found on one side of each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.elementary import cosine
from ..base.jit import inline, kernel

__all__ = ["Features", "fans_at", "features_of", "same_points", "side_groups", "unit_normals", "united"]

Array = NDArray[np.float64]
WITHOUT_DIRECTION = (
    1e-12  # of the longest side squared: twice the area below which a direction is mere rounding
)
USUAL_TURN = 45.0  # degrees by which feature curves turn at a corner if creases are not asked for


class Features(NamedTuple):
    """What must be kept of a surface.

    Attributes
    ----------
    edges : (k, 2) int64
        One curve after the other, each edge beginning where the one before ends.
    chain : (k,) int64
        The curve that each edge belongs to: it runs from corner to corner, or is closed.
    corners : (c,) int64
        Sorted.
    """

    edges: NDArray[np.int64]
    chain: NDArray[np.int64]
    corners: NDArray[np.int64]


def same_points(points: np.ndarray) -> NDArray[np.int64]:
    """For each point the number of the first one that is equal to it."""
    order = np.lexsort(points.T)
    ordered = points[order]
    new = np.ones(len(points), dtype=bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.cumsum(new) - 1
    first = np.full(len(points), len(points), dtype=np.int64)
    np.minimum.at(first, group, order)
    result = np.empty(len(points), dtype=np.int64)
    result[order] = first[group]
    return result


@kernel
def _normals(xyz, rows, normals):
    """Write unit normals; zero for triangles that are flat or so nearly flat that they have no direction."""
    for t in range(rows.shape[0]):
        a, b, c = rows[t, 0], rows[t, 1], rows[t, 2]
        ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
        vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
        wx, wy, wz = vx - ux, vy - uy, vz - uz
        longest = max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz)
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        length = np.sqrt(x * x + y * y + z * z)
        scale = 1.0 / length if length > WITHOUT_DIRECTION * longest else 0.0
        normals[t, 0], normals[t, 1], normals[t, 2] = x * scale, y * scale, z * scale


def unit_normals(xyz: Array, rows: NDArray[np.int64]) -> Array:
    """Unit normals of triangles (m, 3); zero for those that have none. Coordinates up to 1."""
    normals = np.zeros((len(rows), 3))
    _normals(xyz, rows, normals)
    return normals


@inline
def _length_squared(xyz, a, b):
    x, y, z = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    return x * x + y * y + z * z


@kernel
def _lend(xyz, rows, mates, directions):
    """Give flat triangles the direction of their neighbor across their longest side, as far as that has one.

    ``mates[3 t + k]`` is the place of the same side (from corner k) in the one other triangle there, or -1. A
    neighbor that runs through the side in the same direction lends the opposite of its own.
    """
    moved = True
    while moved:
        moved = False
        for t in range(rows.shape[0]):
            if directions[t, 0] != 0.0 or directions[t, 1] != 0.0 or directions[t, 2] != 0.0:
                continue
            longest, side = -1.0, -1
            for k in range(3):
                square = _length_squared(xyz, rows[t, k], rows[t, (k + 1) % 3])
                if square > longest:
                    longest, side = square, k
            mate = mates[3 * t + side]
            if mate < 0:
                continue
            s = mate // 3
            sign = 1.0 if rows[s, mate % 3] != rows[t, side] else -1.0
            for j in range(3):
                directions[t, j] = sign * directions[s, j]
                moved = moved or directions[t, j] != 0.0


def side_groups(rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], ...]:
    """Sides that belong together: their places 3 t + k in order, the group of each, the size of groups.

    Side k of a triangle begins at its corner k. Triangles with fewer than three different corners have none.
    """
    ends = np.sort(np.stack([rows, rows[:, [1, 2, 0]]], axis=2).reshape(-1, 2), axis=1)
    whole = (rows != rows[:, [1, 2, 0]]).all(axis=1)
    place = np.flatnonzero(np.repeat(whole, 3))
    place = place[np.lexsort((ends[place, 1], ends[place, 0]))]
    new = np.ones(len(place), dtype=bool)
    new[1:] = (ends[place[1:]] != ends[place[:-1]]).any(axis=1)
    group = np.cumsum(new) - 1
    return place, group, np.bincount(group)


def _at_sides(xyz: Array, rows: NDArray[np.int64], normals: Array, sharp: float | None) -> np.ndarray:
    """The sides at which the surface ends, branches, or turns by more than ``sharp`` degrees: (k, 2)."""
    place, _, size = side_groups(rows)
    ends = np.stack([rows, rows[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    first = place[np.cumsum(size) - size]
    kept = size != 2
    pairs = np.flatnonzero(size == 2)
    one, two = first[pairs], place[np.cumsum(size)[pairs] - 1]
    kept[pairs] = ends[one, 0] == ends[two, 0]
    if sharp is not None:
        mates = np.full(3 * len(rows), -1, dtype=np.int64)
        mates[one], mates[two] = two, one
        directions = normals.copy()
        _lend(xyz, rows, mates, directions)
        u, v = directions[one // 3], directions[two // 3]
        product = u[:, 0] * v[:, 0] + u[:, 1] * v[:, 1] + u[:, 2] * v[:, 2]
        known = (u != 0.0).any(axis=1) & (v != 0.0).any(axis=1)
        kept[pairs] |= known & (product < cosine(np.deg2rad(sharp)))
    return np.sort(ends[first[kept]], axis=1)


@inline
def _root(parent, i):
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@kernel
def united(one, two, parent):
    """Unite the sets of each pair, and write to each entry of ``parent`` the least number of its set."""
    for i in range(one.shape[0]):
        a, b = _root(parent, one[i]), _root(parent, two[i])
        parent[max(a, b)] = min(a, b)
    for i in range(parent.shape[0]):
        parent[i] = _root(parent, i)


def fans_at(rows: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """How many fans, which have only the vertex in common, the triangles at each vertex form."""
    place, group, _ = side_groups(rows)
    same = np.flatnonzero(group[1:] == group[:-1])
    one, two = place[same], place[same + 1]
    ends: list[list[np.ndarray]] = [[], []]
    for p, into in ((one, ends[0]), (two, ends[1])):
        here, there = p, 3 * (p // 3) + (p % 3 + 1) % 3  # the corners at both ends of the side
        low = rows.ravel()[here] < rows.ravel()[there]
        into += [np.where(low, here, there), np.where(low, there, here)]
    parent = np.arange(rows.size)
    united(np.concatenate(ends[0]), np.concatenate(ends[1]), parent)
    whole = np.repeat((rows != rows[:, [1, 2, 0]]).all(axis=1), 3)
    return np.bincount(rows.ravel()[(parent == np.arange(rows.size)) & whole], minlength=n)


def _apexes(rows: NDArray[np.int64], normals: Array, n: int, turn: float) -> np.ndarray:
    """Whether some triangle at each vertex is tilted by more than ``turn`` degrees from their mean."""
    mean = np.zeros((n, 3))
    for k in range(3):
        np.add.at(mean, rows[:, k], normals)
    length = np.sqrt(mean[:, 0] ** 2 + mean[:, 1] ** 2 + mean[:, 2] ** 2)
    mean /= np.where(length > 0.0, length, 1.0)[:, None]
    result = np.zeros(n, dtype=bool)
    for k in range(3):
        at = mean[rows[:, k]]
        product = at[:, 0] * normals[:, 0] + at[:, 1] * normals[:, 1] + at[:, 2] * normals[:, 2]
        tilted = (product < cosine(np.deg2rad(turn))) & (normals != 0.0).any(axis=1)
        result[rows[tilted, k]] = True
    return result


def _turning(xyz: Array, edges: NDArray[np.int64], degree: np.ndarray, turn: float) -> np.ndarray:
    """The vertices with two feature edges at which these turn by more than ``turn`` degrees."""
    order = np.argsort(edges.ravel(), kind="stable")
    vertex = edges.ravel()[order]
    at = np.flatnonzero((vertex[1:] == vertex[:-1]) & (degree[vertex[1:]] == 2))
    one, two = order[at], order[at + 1]
    v = vertex[at]
    u, w = xyz[edges.ravel()[one ^ 1]] - xyz[v], xyz[edges.ravel()[two ^ 1]] - xyz[v]
    product = u[:, 0] * w[:, 0] + u[:, 1] * w[:, 1] + u[:, 2] * w[:, 2]
    lengths = [np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2 + x[:, 2] ** 2) for x in (u, w)]
    return v[product > -cosine(np.deg2rad(turn)) * lengths[0] * lengths[1]]


@kernel
def _follow(edges, start, at, corner, along, chain):
    """Write the edges in the order and direction of the curves that they form, and the number of each curve.

    The edges at vertex v are ``at[start[v] : start[v + 1]]``, two at a vertex that is no corner. Curves from
    corner to corner come first.
    """
    seen = np.zeros(edges.shape[0], dtype=np.bool_)
    count = number = 0
    for closed in range(2):
        for first in range(corner.shape[0]):
            if corner[first] == (closed == 1):
                continue
            for slot in range(start[first], start[first + 1]):
                edge, v = at[slot], first
                if seen[edge]:
                    continue
                while not seen[edge]:
                    seen[edge] = True
                    w = edges[edge, 1] if edges[edge, 0] == v else edges[edge, 0]
                    along[count, 0], along[count, 1], chain[count] = v, w, number
                    count += 1
                    v = w
                    if not corner[v]:
                        edge = at[start[v] + 1] if at[start[v]] == edge else at[start[v]]
                number += 1


def features_of(
    xyz: Array,
    rows: NDArray[np.int64],
    normals: Array,
    sharp: float | None,
    named: NDArray[np.int64],
    kept: NDArray[np.int64],
) -> Features:
    """The edges and corners to be kept; see `Support` for the parameters. O(m log m)."""
    n, turn = len(xyz), USUAL_TURN if sharp is None else sharp
    edges = np.concatenate([_at_sides(xyz, rows, normals, sharp), np.sort(named, axis=1)])
    edges = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0)
    degree = np.bincount(edges.ravel(), minlength=n)
    corner = (degree != 2) & (degree > 0)
    corner[_turning(xyz, edges, degree, turn)] = True
    corner[kept] = True
    corner |= fans_at(rows, n) > 1
    if sharp is not None:
        corner |= _apexes(rows, normals, n, turn) & (degree == 0)
    order = np.argsort(edges.ravel(), kind="stable")
    start = np.searchsorted(edges.ravel()[order], np.arange(n + 1))
    along, chain = np.empty(edges.shape, dtype=np.int64), np.empty(len(edges), dtype=np.int64)
    _follow(edges, start, order // 2, corner, along, chain)
    return Features(along, chain, np.flatnonzero(corner))
