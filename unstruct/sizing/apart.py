"""The parts of the surface of a body, and which of them count as apart: for the local feature size in space.

Triangles that meet smoothly are one face, edges where faces end or bend sharply are chained to curves, and
what ends curves is a corner; so a ball of a thousand triangles is one face, not a thousand features. See the
book, 2.8c.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import distinct
from ..base.elementary import cosine
from ..geometry.boxes import BOXES_IN_LEAF, BoxTree, bounding_boxes
from ..predicates.batch import power_of_two
from .surface import SHARP_EDGE

__all__ = ["OPPOSED_BITS", "Parts", "SurfaceTree", "parts_of", "tree_of_parts"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
MIXED_PARTS = -1  # the part of a node of the tree that has elements of several
SQUARES_A_SIDE = 9  # directions are rounded to squares of a grid on each side of a cube, by at most 9 degrees
OPPOSED_COSINE = (
    -0.31
)  # the cosine of 108 degrees, beyond which rounded directions are opposed: never below 90
AROUND_TRIANGLE = ((0, 1), (1, 2), (2, 0))


class Parts(NamedTuple):
    """The elements of a surface: triangles of faces, edges of curves, corners; coordinates are scaled.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        The last corner of an edge is there twice, and that of a corner three times.
    vertices : (m, 3) int64
    direction : (m,) int64
        The number of the rounded direction of the normal of a triangle, or of an edge; that after
        the last one for a corner.
    part : (m,) int64
        The face, curve or corner that it belongs to.
    start, touching : (p + 1,), (q,) int64
        The parts that have a vertex in common with part i are touching[start[i] : start[i + 1]], in order.
    """

    corners: Array
    vertices: Integers
    direction: Integers
    part: Integers
    start: Integers
    touching: Integers


class SurfaceTree(NamedTuple):
    """A tree of boxes over elements, as for `BoxTree`, with what is known of each node.

    Attributes
    ----------
    low, high : (2 l, 3) float64
    order : (m,) int64
    part : (2 l,) int64
        The part of all elements below the node, or `MIXED_PARTS`.
    facing : (2 l, w) int64
        Which rounded directions they have, as bits.
    against : (2 l, w) int64
        Which rounded directions are opposed to one of them.
    extent : (2 l,) float64
        The sum of the sides of its box.
    """

    low: Array
    high: Array
    order: Integers
    part: Integers
    facing: Integers
    against: Integers
    extent: Array


def parts_of(domain: Any) -> tuple[Parts, float]:
    """The parts of the surface of a body, and the factor by which its coordinates were multiplied.

    Parameters
    ----------
    domain : Domain
        In space.

    Notes
    -----
    Two triangles are of one face if no other one is at their common edge, if they turn by less than 40
    degrees there, and if they are of the same piece or have the same names. Edges of two faces, of inner
    facets, within a face that is sharp there, and inner segments are chained where two meet and turn by less
    than 40 degrees. What else ends an edge is a corner, and so are loose points. O(n log n).
    """
    shell = domain.triangulated
    factor = power_of_two(shell.points)
    x = shell.points * factor
    triangles = shell.triangles.astype(np.int64)
    a, b, c = x[triangles].transpose(1, 0, 2)
    normal = _unit(np.cross(b - a, c - a))
    face, sharp = _faces(domain, triangles, normal)
    segments = np.sort(shell.segments.astype(np.int64), axis=1)
    width = max(len(x), 1)
    edges = np.concatenate([sharp, segments])
    edges = np.stack(np.divmod(distinct(edges[:, 0] * width + edges[:, 1]), width), axis=1)
    curve, along, ends = _curves(x, edges)
    used = np.zeros(len(x), dtype=bool)
    used[triangles.ravel()], used[edges.ravel()] = True, True
    loose = np.asarray(domain.loose, dtype=np.int64)
    single = np.union1d(ends, loose[~used[loose]] if len(loose) else loose)
    faces, curves = _count(face), _count(curve)
    vertices = np.concatenate([triangles, edges[:, [0, 1, 1]], np.repeat(single[:, None], 3, axis=1)])
    part = np.concatenate([face, faces + curve, faces + curves + np.arange(len(single))])
    direction = np.concatenate([_rounded(normal), _rounded(along), np.full(len(single), NO_DIRECTION)])
    start, touching = _touching(vertices, part, len(x), faces + curves + len(single))
    return Parts(np.ascontiguousarray(x[vertices]), vertices, direction, part, start, touching), factor


def tree_of_parts(parts: Parts) -> SurfaceTree:
    """The tree of the elements; O(m log m)."""
    tree = BoxTree(*bounding_boxes(parts.corners))
    nodes = len(tree.low)
    own = _bits(np.eye(NO_DIRECTION + 1, dtype=bool))
    facing, against = (bits[parts.direction[tree.order]] for bits in (own, OPPOSED_BITS))
    owner, node = parts.part[tree.order], nodes // 2 + np.arange(len(tree.order)) // BOXES_IN_LEAF
    part, every = (
        np.full(nodes, MIXED_PARTS, dtype=np.int64),
        np.zeros((2, nodes, own.shape[1]), dtype=np.int64),
    )
    low, high = owner, owner
    while node[0] > 0:  # level by level
        start = np.flatnonzero(np.append(True, np.diff(node) != 0))
        node = node[start]
        low, high = np.minimum.reduceat(low, start), np.maximum.reduceat(high, start)
        facing, against = np.bitwise_or.reduceat(facing, start), np.bitwise_or.reduceat(against, start)
        part[node] = np.where(low == high, low, MIXED_PARTS)
        every[0, node], every[1, node] = facing, against
        node = node // 2
    empty = tree.low[:, 0] > tree.high[:, 0]
    extent = np.where(empty, 0.0, np.where(empty[:, None], 0.0, tree.high - tree.low).sum(axis=1))
    return SurfaceTree(tree.low, tree.high, tree.order, part, every[0], every[1], extent)


def _all_directions() -> Array:
    """The middles of the squares of a grid on the sides of a cube, as unit vectors."""
    line = (2 * np.arange(SQUARES_A_SIDE) + 1) / SQUARES_A_SIDE - 1.0
    u, v = (a.ravel() for a in np.meshgrid(line, line))
    one = np.ones_like(u)
    rows = [
        np.stack([sign * one, u, v], axis=1)[:, np.roll(np.arange(3), k)]
        for k in range(3)
        for sign in (1, -1)
    ]
    return _unit(np.concatenate(rows))


def _rounded(rows: Array) -> Integers:
    """The number of the direction in `DIRECTIONS` for each unit vector."""
    axis = np.abs(rows).argmax(axis=1)
    place = np.arange(len(rows))
    most = rows[place, axis]
    side = 2 * axis + (most < 0)
    # np.roll by k moves the first column to place k, and the others behind it
    u, v = rows[place, (axis + 1) % 3], rows[place, (axis + 2) % 3]
    scale = np.where(most == 0.0, 1.0, np.abs(most))
    i, j = (
        np.clip(np.floor((a / scale + 1.0) * (SQUARES_A_SIDE / 2)), 0, SQUARES_A_SIDE - 1).astype(np.int64)
        for a in (u, v)
    )
    return (side * SQUARES_A_SIDE + j) * SQUARES_A_SIDE + i


def _bits(rows: NDArray[np.bool_]) -> Integers:
    """Rows of booleans as bits of integers."""
    words = -(-rows.shape[1] // 64)
    padded = np.zeros((len(rows), 64 * words), dtype=bool)
    padded[:, : rows.shape[1]] = rows
    return np.packbits(padded, axis=1, bitorder="little").view("<i8").astype(np.int64)


def _unit(rows: Array) -> Array:
    length = np.linalg.norm(rows, axis=1)
    return rows / np.where(length > 0, length, 1.0)[:, None]


def _count(number: Integers) -> int:
    return int(number.max()) + 1 if len(number) else 0


def _opposed() -> Integers:
    """For each direction, and for none, which ones are opposed to it."""
    rows = np.concatenate([DIRECTIONS, np.zeros((1, 3))])
    return _bits((rows[:, None] * rows).sum(axis=2) < OPPOSED_COSINE)


def _components(pairs: Integers, many: int) -> Integers:
    """Numbers of what is connected by pairs of ``many`` things."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(many, many))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _names(domain: Any) -> Integers:
    """A number for each piece, the same for pieces with the same names."""
    names = np.zeros(len(domain.pieces), dtype=np.int64)
    for rows in domain.markers.values():
        with_name = np.zeros(len(names), dtype=np.int64)
        with_name[np.asarray(rows, dtype=np.int64)] = 1
        names = np.unique(2 * names + with_name, return_inverse=True)[1].ravel().astype(np.int64)
    return names


def _faces(domain: Any, triangles: Integers, normal: Array) -> tuple[Integers, Integers]:
    """The face of each triangle, and the edges at which it is not smooth, (e, 2)."""
    many, piece = len(triangles), domain.triangulated.piece.astype(np.int64)
    if many == 0:
        return np.empty(0, dtype=np.int64), np.empty((0, 2), dtype=np.int64)
    pairs = triangles[:, AROUND_TRIANGLE].reshape(-1, 2)
    forward = pairs[:, 0] < pairs[:, 1]
    pairs = np.sort(pairs, axis=1)
    key = pairs @ np.array([int(triangles.max()) + 1, 1])
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.append(True, np.diff(key[order]) != 0))
    two = np.diff(np.append(first, len(order))) == 2
    one, other = order[first[two]], order[first[two] + 1]
    names = _names(domain)
    s, t = one // 3, other // 3
    flat = (normal[s] * normal[t]).sum(axis=1)
    alike = (piece[s] == piece[t]) | (
        (flat > cosine(SHARP_EDGE)) & (forward[one] != forward[other]) & (names[piece[s]] == names[piece[t]])
    )
    alike &= (piece[s] < len(domain.facets)) == (piece[t] < len(domain.facets))
    face = _components(np.stack([s[alike], t[alike]], axis=1), many)
    smooth = np.zeros(len(first), dtype=bool)
    smooth[np.flatnonzero(two)[alike]] = True
    return face, pairs[order[first[~smooth]]]


def _curves(x: Array, edges: Integers) -> tuple[Integers, Array, Integers]:
    """The curve of each edge, unit vectors along the curves, and the vertices at which curves end.

    Each edge has two directions; those that follow each other are connected. So each curve is found twice,
    once for each of its directions, and one of them is taken.
    """
    many = len(edges)
    if many == 0:
        return np.empty(0, dtype=np.int64), np.empty((0, 3)), np.empty(0, dtype=np.int64)
    along = _unit(x[edges[:, 1]] - x[edges[:, 0]])
    flat = edges.ravel()
    order = np.argsort(flat, kind="stable")
    first = np.flatnonzero(np.append(True, np.diff(flat[order]) != 0))
    two = np.diff(np.append(first, len(order))) == 2
    one, other = order[first[two]], order[first[two] + 1]
    away_one = along[one // 2] * np.where(one % 2 == 0, 1.0, -1.0)[:, None]
    away_other = along[other // 2] * np.where(other % 2 == 0, 1.0, -1.0)[:, None]
    through = -(away_one * away_other).sum(axis=1) > cosine(SHARP_EDGE)
    one, other = one[through], other[through]
    # Direction 0 of an edge leads to its second end: into a vertex by one edge, out of it by the other.
    into, out = 2 * (one // 2) + (one % 2 == 0), 2 * (other // 2) + (other % 2 == 1)
    back = np.stack([into ^ 1, out ^ 1], axis=1)[:, ::-1]
    found = _components(np.concatenate([np.stack([into, out], axis=1), back]), 2 * many).reshape(-1, 2)
    along = np.where((found[:, 0] <= found[:, 1])[:, None], along, -along)
    curve = np.unique(found.min(axis=1), return_inverse=True)[1].ravel().astype(np.int64)
    passed = np.zeros(len(first), dtype=bool)
    passed[np.flatnonzero(two)[through]] = True
    return curve, along, flat[order[first[~passed]]]


def _touching(vertices: Integers, part: Integers, points: int, many: int) -> tuple[Integers, Integers]:
    """The parts with a common vertex, as `Parts` has them."""
    rows = distinct((vertices * many + part[:, None]).ravel())
    vertex, owner = np.divmod(rows, many)
    count = np.bincount(vertex, minlength=points)
    keys = []
    for size in np.unique(count[count > 1]).tolist():
        at = owner[count[vertex] == size].reshape(-1, size)
        keys.append(distinct((at[:, :, None] * many + at[:, None, :]).ravel()))
    every = distinct(np.concatenate([*keys, np.empty(0, dtype=np.int64)]))
    first, second = np.divmod(every, many) if many else (every, every)
    start = np.searchsorted(first, np.arange(many + 1)).astype(np.int64)
    return start, np.ascontiguousarray(second)


DIRECTIONS = _all_directions()
NO_DIRECTION = len(DIRECTIONS)
OPPOSED_BITS = _opposed()
