"""Edges and triangles in space that meet where they should not: candidates from a tree, decided exactly.

Triangles form an embedded complex if any two of them have at most a common vertex or a common edge. This
holds exactly when no edge meets a triangle outside of their common vertices: where two triangles overlap, or
one passes through the other, the end of their common part lies on an edge of one of them. See the book, 2.8b.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..base.jit import inline, kernel
from ..predicates.batch import scaled
from ..predicates.filters import filter_orient2
from ..predicates.kernels import orient2, orient3
from .boxes import BoxTree, bounding_boxes
from .evened import evened

__all__ = [
    "EDGES_CROSS", "OVERLAP", "PIERCES", "VERTEX_ON_EDGE", "VERTEX_ON_TRIANGLE", "Meetings", "clear_view",
    "crossing_segments", "edges_of", "meeting", "meetings_in_space", "place_in_triangle",
    "places_on_triangles", "points_on_edges", "points_on_triangles", "side", "sides_index", "turn",
    "unit_points",
]  # fmt: skip

# How an edge meets a triangle: it passes through the inside; through an edge; its end, or a vertex of the
# triangle, lies on an edge of the other; its end lies inside of the triangle; they overlap in a plane.
PIERCES, EDGES_CROSS, VERTEX_ON_EDGE, VERTEX_ON_TRIANGLE, OVERLAP = 1, 2, 3, 4, 5
EDGES_AT_ONCE = 1 << 17  # bounds the memory of candidates


class Meetings(NamedTuple):
    """Edges and triangles that meet outside of common vertices.

    Attributes
    ----------
    edge, triangle : (m,) int64
        Their numbers.
    kind : (m,) int8
        `PIERCES`, `EDGES_CROSS`, `VERTEX_ON_EDGE`, `VERTEX_ON_TRIANGLE` or `OVERLAP`.
    vertex : (m,) int32
        The vertex that lies on an edge or a triangle; -1 for the other kinds.
    """

    edge: NDArray[np.int64]
    triangle: NDArray[np.int64]
    kind: NDArray[np.int8]
    vertex: NDArray[np.int32]


# ---------------------------------------------------------------------- one point or edge, one triangle


@inline
def _side(xyz, a, b, c, p):
    """The side of the plane of a, b, c on which p lies."""
    return orient3(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2],
        xyz[c, 0], xyz[c, 1], xyz[c, 2], xyz[p, 0], xyz[p, 1], xyz[p, 2],
    )  # fmt: skip


@kernel
def side(xyz, a, b, c, p):
    """`_side`, compiled once, since its exact stages are long."""
    return _side(xyz, a, b, c, p)


@kernel
def turn(xyz, i, j, a, b, c):
    """The orientation of a, b, c seen along an axis: in the plane of the coordinates i and j."""
    return orient2(xyz[a, i], xyz[a, j], xyz[b, i], xyz[b, j], xyz[c, i], xyz[c, j])


@kernel
def clear_view(xyz, a, b, c):
    """Two coordinates in whose plane the triangle is not flat, as 3 i + j; -1 if a, b, c are collinear.

    They are those in which it appears largest; so it is seldom that the choice needs an exact sign.
    """
    best, found = -1.0, 0
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        area = abs(
            (xyz[b, i] - xyz[a, i]) * (xyz[c, j] - xyz[a, j])
            - (xyz[b, j] - xyz[a, j]) * (xyz[c, i] - xyz[a, i])
        )
        if area > best:
            best, found = area, axis
    for step in range(3):
        axis = (found + step) % 3
        i, j = (axis + 1) % 3, (axis + 2) % 3
        if turn(xyz, i, j, a, b, c) != 0:
            return 3 * i + j
    return -1


@kernel
def place_in_triangle(xyz, a, b, c, p):
    """The place of p in the plane of the triangle: 0 outside, 1 inside, 2 + k on the edge opposite k."""
    view = clear_view(xyz, a, b, c)
    i, j = view // 3, view % 3
    whole = turn(xyz, i, j, a, b, c)
    on = 1
    for k in range(3):
        u, v = (b, c) if k == 0 else ((c, a) if k == 1 else (a, b))
        s = turn(xyz, i, j, u, v, p) * whole
        if s < 0:
            return 0
        if s == 0:
            on = 2 + k
    return on


@kernel
def _on_segment(xyz, p, q, v):
    """Whether v lies inside the segment p q, exactly: all three projections are flat, and it is between."""
    for axis in range(3):
        if turn(xyz, (axis + 1) % 3, (axis + 2) % 3, p, q, v) != 0:
            return False
    for k in range(3):
        low, high = min(xyz[p, k], xyz[q, k]), max(xyz[p, k], xyz[q, k])
        if not low <= xyz[v, k] <= high:
            return False
    return v not in (p, q)


@kernel
def _in_plane(xyz, p, q, a, b, c):
    """How a segment in the plane of a triangle, with at most one common vertex, meets it: kind and vertex."""
    for v in (p, q):
        if v in (a, b, c):
            continue
        on = place_in_triangle(xyz, a, b, c, v)
        if on > 1:
            return VERTEX_ON_EDGE, v
        if on == 1:
            return OVERLAP, -1
    for v in (a, b, c):
        if _on_segment(xyz, p, q, v):
            return VERTEX_ON_EDGE, v
    view = clear_view(xyz, a, b, c)
    i, j = view // 3, view % 3
    for k in range(3):
        u, v = (b, c) if k == 0 else ((c, a) if k == 1 else (a, b))
        if u in (p, q) or v in (p, q):
            continue
        if (
            turn(xyz, i, j, p, q, u) * turn(xyz, i, j, p, q, v) < 0
            and turn(xyz, i, j, u, v, p) * turn(xyz, i, j, u, v, q) < 0
        ):
            return OVERLAP, -1
    return 0, -1


@kernel
def meeting(xyz, p, q, a, b, c):
    """How the segment p q meets the triangle outside of common vertices: kind (0: not at all), and vertex."""
    one_common, two_common = p == a or p == b or p == c, q == a or q == b or q == c
    if one_common or two_common:  # most pairs in a surface; the sign of a common vertex is 0, and expensive
        if one_common and two_common:
            return 0, -1
        if side(xyz, a, b, c, q if one_common else p) != 0:
            return 0, -1
        return _in_plane(xyz, p, q, a, b, c)
    one = side(xyz, a, b, c, p)
    two = side(xyz, a, b, c, q)
    if one * two > 0:
        return 0, -1
    if one == 0 and two == 0:
        return _in_plane(xyz, p, q, a, b, c)
    if one == 0 or two == 0:
        v = p if one == 0 else q
        on = place_in_triangle(xyz, a, b, c, v)
        if on == 0:
            return 0, -1
        return (VERTEX_ON_TRIANGLE, v) if on == 1 else (VERTEX_ON_EDGE, v)
    x, y, z = side(xyz, p, q, a, b), side(xyz, p, q, b, c), side(xyz, p, q, c, a)
    if min(x, y, z) < 0 < max(x, y, z):
        return 0, -1
    zeros = (x == 0) + (y == 0) + (z == 0)
    if zeros == 0:
        return PIERCES, -1
    if zeros == 1:
        return EDGES_CROSS, -1
    return VERTEX_ON_EDGE, b if x == y == 0 else (c if y == z == 0 else a)


# ---------------------------------------------------------------------- many


@kernel
def _views(xyz, triangles, views):
    """For each triangle the two coordinates in whose plane it is seen counterclockwise, as 3 i + j."""
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        view = clear_view(xyz, a, b, c)
        i, j = view // 3, view % 3
        views[t] = view if turn(xyz, i, j, a, b, c) > 0 else 3 * j + i


@inline
def _beyond(xyz, i, j, u, v, p):
    """Whether p surely lies to the right of u v, in the plane of the coordinates i and j."""
    return filter_orient2(xyz[u, i], xyz[u, j], xyz[v, i], xyz[v, j], xyz[p, i], xyz[p, j]) == -1


@inline
def _surely_apart(xyz, view, p, q, a, b, c):
    """Whether the segment and the triangle are, as seen along an axis, without doubt on two sides of a line.

    It spares exact signs where surfaces are flat. At a common vertex the line goes through it: nothing of the
    triangle is seen there but this vertex, and so they meet nowhere else in space.
    """
    i, j = view // 3, view % 3
    for _ in range(3):
        if p == a or q == a:
            other = q if p == a else p
            return _beyond(xyz, i, j, a, b, other) or _beyond(xyz, i, j, c, a, other)
        a, b, c = b, c, a
    for _ in range(3):
        if _beyond(xyz, i, j, a, b, p) and _beyond(xyz, i, j, a, b, q):
            return True
        a, b, c = b, c, a
    return False


@kernel
def _judge(xyz, edges, triangles, views, pairs, kinds, vertices):
    """Keep the pairs that meet, in place; return how many they are."""
    count = 0
    for i in range(pairs.shape[1]):
        e, t = pairs[0, i], pairs[1, i]
        p, q, a, b, c = edges[e, 0], edges[e, 1], triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if _surely_apart(xyz, views[t], p, q, a, b, c):
            continue
        kind, vertex = meeting(xyz, p, q, a, b, c)
        if kind != 0:
            pairs[0, count], pairs[1, count], kinds[count], vertices[count] = e, t, kind, vertex
            count += 1
    return count


def unit_points(points: np.ndarray) -> np.ndarray:
    """Coordinates times a power of two, at most 1 in magnitude; an error if that is not exact."""
    xyz, exact = scaled(np.ascontiguousarray(points))
    if not exact:
        raise InputError(
            "the coordinates span more than 300 orders of magnitude; set those that are nearly 0 to 0"
        )
    return xyz


def edges_of(triangles: np.ndarray) -> np.ndarray:
    """The edges of triangles, each once, smaller vertex first: (e, 2) int32."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return _once(ends)


def _once(ends: np.ndarray) -> np.ndarray:
    ends = np.sort(ends, axis=1).astype(np.int64)
    key = np.sort((ends[:, 0] << 32) | ends[:, 1])  # np.unique uses a hash table, which takes twice as long
    key = key[np.concatenate([[True], key[1:] != key[:-1]])] if len(key) else key
    return np.column_stack([key >> 32, key & (2**32 - 1)]).astype(np.int32)


def sides_index(triangles: np.ndarray) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The sides of triangles as sorted keys, and the triangle of each."""
    ends = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1).astype(np.int64)
    key = (ends[:, 0] << 32) | ends[:, 1]
    order = np.argsort(key, kind="stable")
    return key[order], order // 3


def meetings_in_space(points: np.ndarray, triangles: np.ndarray, edges: np.ndarray) -> Meetings:
    """All edges that meet a triangle outside of common vertices.

    Parameters
    ----------
    points : (n, 3) float64
        Different from each other.
    triangles : (t, 3) int
        None of them flat.
    edges : (e, 2) int
        Those of the triangles, and others, which have different ends.

    Returns
    -------
    Meetings
        Sorted by edge; exact. O((e + t) log t) for triangles of a surface.
    """
    xyz = unit_points(points)
    where, slack = evened(xyz, edges)
    low, high = bounding_boxes(where[triangles])
    tree = BoxTree(low - slack, high + slack)
    views = np.empty(len(triangles), dtype=np.int8)
    _views(xyz, triangles, views)
    found = []
    for first in range(0, len(edges) if len(triangles) else 0, EDGES_AT_ONCE):
        part = edges[first : first + EDGES_AT_ONCE]
        query, hit = tree.pairs(*bounding_boxes(where[part]))
        pairs = np.stack([query + first, hit])
        kinds, vertices = np.empty(len(query), dtype=np.int8), np.empty(len(query), dtype=np.int32)
        count = _judge(xyz, edges, triangles, views, pairs, kinds, vertices)
        found.append((*pairs[:, :count].copy(), kinds[:count].copy(), vertices[:count].copy()))
    if not found:
        none = np.empty(0, dtype=np.int64)
        return Meetings(none, none, none.astype(np.int8), none.astype(np.int32))
    return Meetings(*map(np.concatenate, zip(*found)))


@kernel
def places_on_triangles(xyz, rows, triangles, query, hit, where):
    """For each pair 0 apart, 1 inside, 2 + k on the edge opposite vertex k, 5 at a vertex."""
    for i in range(query.shape[0]):
        p, t = rows[query[i]], hit[i]
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if p in (a, b, c):
            where[i] = 5
        elif side(xyz, a, b, c, p) != 0:
            where[i] = 0
        else:
            where[i] = place_in_triangle(xyz, a, b, c, p)


def points_on_triangles(
    points: np.ndarray, rows: np.ndarray, triangles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which of the points ``rows`` lie on triangles of which they are no vertex.

    Returns
    -------
    row, triangle, place : ndarray
        The point, the triangle; 1 inside, 2 + k on the edge opposite vertex k.
    """
    xyz = unit_points(points)
    query, hit = BoxTree(*bounding_boxes(xyz[triangles])).pairs(xyz[rows], xyz[rows])
    where = np.empty(len(query), dtype=np.int8)
    places_on_triangles(xyz, rows, triangles, query, hit, where)
    on = (where > 0) & (where < 5)
    return rows[query[on]], hit[on], where[on]


@kernel
def _on_edges(xyz, rows, edges, query, hit, on):
    for i in range(query.shape[0]):
        on[i] = _on_segment(xyz, edges[hit[i], 0], edges[hit[i], 1], rows[query[i]])


def points_on_edges(points: np.ndarray, rows: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of the points ``rows`` lie inside which edges: pairs of a point and the number of an edge."""
    xyz = unit_points(points)
    query, hit = BoxTree(*bounding_boxes(xyz[edges])).pairs(xyz[rows], xyz[rows])
    on = np.empty(len(query), dtype=np.bool_)
    _on_edges(xyz, rows, edges, query, hit, on)
    return rows[query[on]], hit[on]


@kernel
def _cross(xyz, rows, one, two, crossing):
    """Whether segments without a common vertex cross inside of both."""
    for i in range(one.shape[0]):
        p, q, a, b = rows[one[i], 0], rows[one[i], 1], rows[two[i], 0], rows[two[i], 1]
        crossing[i] = False
        if a in (p, q) or b in (p, q) or side(xyz, p, q, a, b) != 0:
            continue
        view = clear_view(xyz, p, q, a)
        if view < 0:  # then a lies on their line, and no inside of the one meets that of the other
            continue
        j, k = view // 3, view % 3
        crossing[i] = (
            turn(xyz, j, k, p, q, a) * turn(xyz, j, k, p, q, b) < 0
            and turn(xyz, j, k, a, b, p) * turn(xyz, j, k, a, b, q) < 0
        )


def crossing_segments(points: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of segments without a common vertex that cross inside of both, each pair once; exact."""
    xyz = unit_points(points)
    low, high = bounding_boxes(xyz[rows])
    one, two = BoxTree(low, high).pairs(low, high)
    one, two = one[one < two], two[one < two]
    crossing = np.empty(len(one), dtype=np.bool_)
    _cross(xyz, rows, one, two, crossing)
    return one[crossing], two[crossing]
