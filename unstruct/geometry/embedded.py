"""Whether triangles in space meet only in common vertices and edges: a quick test, exact in both answers.

Nearly all pairs of near triangles of a surface have a vertex in common. They need not be looked at one by
one. Let the triangles at a vertex v be seen along a direction n, counterclockwise around v, each from the
front or from behind. If each other vertex begins as many of them as it ends, they cover all directions around
v equally often; if they cover one direction once, no two of them meet but in v and in common edges. Such a
vertex is called *clean*. A sum of normals serves as n for nearly every vertex, also at corners and edges.

The other pairs are found by a tree of boxes, each once. A line along a side of one of them, seen along an
axis, or the plane of one of them, separates nearly all of these. What is left is decided by exact signs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.jit import inline, kernel, lean
from ..predicates.filters import filter_orient2, filter_orient3
from .boxes import BOXES_IN_LEAF, BoxTree, bounding_boxes
from .triangle_pairs import clear_view, meeting, unit_points

__all__ = ["embedded", "flat_rows", "meeting_pairs"]

DOUBTFUL = 4  # pairs that are decided by exact signs, for each triangle: with more, the quick test gives up
NEAR_PAIRS = 1 << 12  # candidates that are collected before they are looked at
WAITING_NODES = 128  # nodes that wait; a tree of boxes is never half as deep


class Surface(NamedTuple):
    """Triangles in the order of the leaves of their tree, and what is known of them.

    ``view`` has for each triangle the coordinates in whose plane it surely turns counterclockwise, as
    3 i + j; -1 for none. ``clean`` is 1 for clean vertices.
    """

    xyz: NDArray[np.float64]
    rows: NDArray[np.int32]
    view: NDArray[np.int8]
    clean: NDArray[np.int8]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    box_low: NDArray[np.float64]
    box_high: NDArray[np.float64]


# ---------------------------------------------------------------------- vertices


@kernel
def _incident(triangles, start, around):
    """Write the places 3 t + k of vertex v in the triangles to ``around[start[v] : start[v + 1]]``."""
    for t in range(triangles.shape[0]):
        for k in range(3):
            start[triangles[t, k]] += 1
    for v in range(1, start.shape[0]):
        start[v] += start[v - 1]
    for t in range(triangles.shape[0] - 1, -1, -1):
        for k in range(2, -1, -1):
            v = triangles[t, k]
            start[v] -= 1
            around[start[v]] = 3 * t + k


@kernel
def _normals(xyz, triangles, normals, view):
    """Write unit normals, which are rounded, and the views of a `Surface`."""
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
        vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        length = np.sqrt(x * x + y * y + z * z)
        scale = 1.0 / length if length > 0.0 else 0.0
        normals[t, 0], normals[t, 1], normals[t, 2] = x * scale, y * scale, z * scale
        axis = 0 if abs(x) >= max(abs(y), abs(z)) else (1 if abs(y) >= abs(z) else 2)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        if (x if axis == 0 else (y if axis == 1 else z)) < 0.0:
            i, j = j, i
        sure = filter_orient2(xyz[a, i], xyz[a, j], xyz[b, i], xyz[b, j], xyz[c, i], xyz[c, j]) == 1
        view[t] = 3 * i + j if sure else -1


@inline
def _turns(xyz, n, v, a, b):
    """1 if a, b surely turn counterclockwise around v, seen against the direction n; -1 if surely clockwise.

    This is the filter of an orientation of which one row, n, is exact: its bound holds all the more.
    """
    return -filter_orient3(
        n[0], n[1], n[2],
        xyz[a, 0] - xyz[v, 0], xyz[a, 1] - xyz[v, 1], xyz[a, 2] - xyz[v, 2],
        xyz[b, 0] - xyz[v, 0], xyz[b, 1] - xyz[v, 1], xyz[b, 2] - xyz[v, 2], 0.0, 0.0, 0.0,
    )  # fmt: skip


@kernel
def _clean(xyz, triangles, normals, start, around, balance, clean):
    """Find clean vertices; ``balance`` has a 0 for each vertex, before and after.

    Triangles need not be turned in one direction: those that turn clockwise are seen from behind. In
    ``around`` their places are negative then.
    """
    n = np.empty(3)
    for v in range(clean.shape[0]):
        n[0], n[1], n[2] = 0.0, 0.0, 0.0
        first, last = start[v], start[v + 1]
        for i in range(first, last):
            t = around[i] // 3
            x, y, z = normals[t, 0], normals[t, 1], normals[t, 2]
            facing = 1.0 if n[0] * x + n[1] * y + n[2] * z >= 0.0 else -1.0
            n[0] += facing * x
            n[1] += facing * y
            n[2] += facing * z
        good, reference, begun = last > first, -1, 0
        for i in range(first, last):
            t, k = around[i] // 3, around[i] % 3
            a, b = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
            sign = _turns(xyz, n, v, a, b)
            good = good and (sign == 1 or sign == -1)
            if sign < 0:
                a, b = b, a
                around[i] = -1 - around[i]
            reference = a if i == first else reference
            begun += a == reference
            balance[a] += 1
            balance[b] -= 1
        for i in range(first, last):
            place = max(around[i], -1 - around[i])
            for k in range(3):
                good = good and balance[triangles[place // 3, k]] == 0
        for i in range(first, last):
            place = max(around[i], -1 - around[i])
            t, k = place // 3, place % 3
            a, b = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
            balance[a], balance[b] = 0, 0
            if around[i] < 0:
                a, b = b, a
            if good and a != reference and b != reference:  # it must not cover the direction of the reference
                good = _turns(xyz, n, v, a, reference) == -1 or _turns(xyz, n, v, reference, b) == -1
        clean[v] = good and begun == 1


# ---------------------------------------------------------------------- pairs of triangles


@inline
def _beyond(xyz, i, j, u, v, p):
    """Whether p surely lies to the right of u v, in the plane of the coordinates i and j."""
    return filter_orient2(xyz[u, i], xyz[u, j], xyz[v, i], xyz[v, j], xyz[p, i], xyz[p, j]) == -1


@inline
def _beside(xyz, view, a, b, c, d, e, f):
    """Whether a line along a side of a, b, c, in the plane of its view, surely has d, e, f beyond it."""
    i, j = view // 3, view % 3
    for _ in range(3):
        if _beyond(xyz, i, j, a, b, d) and _beyond(xyz, i, j, a, b, e) and _beyond(xyz, i, j, a, b, f):
            return True
        a, b, c = b, c, a
    return False


@inline
def _above(xyz, a, b, c, d, e, f):
    """Whether the plane of a, b, c surely has d, e, f on one side."""
    sign = 0
    for p in (d, e, f):
        one = filter_orient3(
            xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2],
            xyz[c, 0], xyz[c, 1], xyz[c, 2], xyz[p, 0], xyz[p, 1], xyz[p, 2],
        )  # fmt: skip
        if abs(one) != 1 or one == -sign:
            return False
        sign = one
    return True


@inline
def _touch(low, high, i, other_low, other_high, j):
    """Whether two boxes in space meet, without branches, which the processor could not foresee."""
    return (
        (low[i, 0] <= other_high[j, 0]) & (high[i, 0] >= other_low[j, 0])
        & (low[i, 1] <= other_high[j, 1]) & (high[i, 1] >= other_low[j, 1])
        & (low[i, 2] <= other_high[j, 2]) & (high[i, 2] >= other_low[j, 2])
    )  # fmt: skip


@lean
def _sifted(surface, pairs, count):
    """Keep those pairs, in place, without a clean vertex in common; how many they are.

    The first entry of those with other common vertices becomes -1 minus the triangle.
    """
    rows, clean, kept = surface.rows, surface.clean, 0
    for i in range(count):
        s, t = pairs[i, 0], pairs[i, 1]
        a, b, c = rows[s, 0], rows[s, 1], rows[s, 2]
        d, e, f = rows[t, 0], rows[t, 1], rows[t, 2]
        one = (a == d) | (a == e) | (a == f)
        two = (b == d) | (b == e) | (b == f)
        three = (c == d) | (c == e) | (c == f)
        pairs[kept, 0] = -1 - s if one | two | three else s
        pairs[kept, 1] = t
        kept += not ((one & clean[a]) | (two & clean[b]) | (three & clean[c]))
    return kept


@lean
def _left_over(surface, pairs, count, found, size):
    """Append to ``found`` the pairs that nothing separates; how many there are then, -1 for too many."""
    xyz, rows, view = surface.xyz, surface.rows, surface.view
    for i in range(_sifted(surface, pairs, count)):
        s, t = pairs[i, 0], pairs[i, 1]
        if s >= 0:
            a, b, c = rows[s, 0], rows[s, 1], rows[s, 2]
            d, e, f = rows[t, 0], rows[t, 1], rows[t, 2]
            if (
                (view[s] >= 0 and _beside(xyz, view[s], a, b, c, d, e, f))
                or (view[t] >= 0 and _beside(xyz, view[t], d, e, f, a, b, c))
                or _above(xyz, a, b, c, d, e, f)
                or _above(xyz, d, e, f, a, b, c)
            ):
                continue
        if size == found.shape[0]:
            return -1
        found[size, 0], found[size, 1] = s if s >= 0 else -1 - s, t
        size += 1
    return size


@lean
def _near(surface, one, other, pairs, count):
    """Append the pairs of triangles in two leaves, or in one, whose boxes meet; how many there are then."""
    low, high, leaves = surface.box_low, surface.box_high, surface.low.shape[0] // 2
    for s in range(one, min(one + BOXES_IN_LEAF, surface.rows.shape[0])):
        if _touch(low, high, s, surface.low, surface.high, leaves + other // BOXES_IN_LEAF):
            for t in range(max(other, s + 1), min(other + BOXES_IN_LEAF, surface.rows.shape[0])):
                pairs[count, 0], pairs[count, 1] = s, t
                count += _touch(low, high, s, low, high, t)
    return count


@kernel
def _doubtful(surface, pairs, found):
    """Write to ``found`` the pairs of triangles that only exact signs can decide; how many, -1 for too many.

    Each leaf is compared with those after it: with the subtrees to the right of its way from the root.
    ``pairs`` is scratch.
    """
    low, high, rows = surface.low, surface.high, surface.rows
    leaves = low.shape[0] // 2
    full = pairs.shape[0] - 2 * BOXES_IN_LEAF * BOXES_IN_LEAF  # a leaf by itself, and then with another one
    stack = np.empty(WAITING_NODES, dtype=np.int64)
    count = size = 0
    for first in range(0, rows.shape[0], BOXES_IN_LEAF):
        if count >= full:
            size, count = _left_over(surface, pairs, count, found, size), 0
            if size < 0:
                return -1
        count = _near(surface, first, first, pairs, count)
        leaf, top = leaves + first // BOXES_IN_LEAF, 0
        node = leaf
        while node > 1:
            stack[top] = node + 1
            top += node % 2 == 0
            node //= 2
        while top > 0:
            top -= 1
            node = stack[top]
            if not _touch(low, high, node, low, high, leaf):
                continue
            if node < leaves:
                stack[top], stack[top + 1] = 2 * node, 2 * node + 1
                top += 2
                continue
            count = _near(surface, first, (node - leaves) * BOXES_IN_LEAF, pairs, count)
            if count >= full:
                size, count = _left_over(surface, pairs, count, found, size), 0
                if size < 0:
                    return -1
    return _left_over(surface, pairs, count, found, size)


@kernel
def _meet(xyz, rows, pairs, meet, stop):
    """Note which pairs meet, an edge of one the other outside of common vertices; exact; how many do.

    With ``stop`` it ends at the first one.
    """
    count = 0
    for i in range(pairs.shape[0]):
        meet[i] = False
        for turned in range(2):
            s, t = pairs[i, turned], pairs[i, 1 - turned]
            for k in range(3):
                p, q = rows[s, k], rows[s, (k + 1) % 3]
                if not meet[i] and meeting(xyz, p, q, rows[t, 0], rows[t, 1], rows[t, 2])[0] != 0:
                    meet[i] = True
        count += meet[i]
        if stop and count > 0:
            break
    return count


def embedded(points: np.ndarray, triangles: np.ndarray) -> bool:
    """Whether no two triangles meet but in common vertices and common edges.

    Parameters
    ----------
    points : (n, 3) float64
        Different from each other.
    triangles : (t, 3) int32
        None of them flat, no two with the same vertices.

    Returns
    -------
    bool
        True is certain. False may also mean that there are too many pairs of near triangles to be decided
        here; `meetings_in_space` then knows.

    Notes
    -----
    O(t log t) for triangles of a surface.
    """
    if len(triangles) < 2:
        return True
    surface, _ = _surface(points, triangles)
    found = np.empty((DOUBTFUL * len(triangles) + 64, 2), dtype=np.int32)
    many = _doubtful(surface, np.empty((NEAR_PAIRS, 2), dtype=np.int32), found)
    meet = np.empty(max(many, 0), dtype=np.bool_)
    return bool(many >= 0 and _meet(surface.xyz, surface.rows, found[:many], meet, True) == 0)


def meeting_pairs(points: np.ndarray, triangles: np.ndarray) -> NDArray[np.int64]:
    """The pairs of triangles that meet outside of common vertices and edges, exactly: (k, 2).

    Parameters
    ----------
    points : (n, 3) float64
        Where two are equal, the triangles of both meet.
    triangles : (t, 3) int32
        None of them flat, no two with the same vertices.

    Notes
    -----
    O(t log t) for triangles of which few are near many others.
    """
    if len(triangles) < 2:
        return np.empty((0, 2), dtype=np.int64)
    surface, order = _surface(points, triangles)
    room, many = DOUBTFUL * len(triangles) + 64, -1
    while many < 0:
        found = np.empty((room, 2), dtype=np.int32)
        many, room = _doubtful(surface, np.empty((NEAR_PAIRS, 2), dtype=np.int32), found), 4 * room
    pairs = found[:many]
    meet = np.empty(many, dtype=np.bool_)
    _meet(surface.xyz, surface.rows, pairs, meet, False)
    return order[pairs[meet]]


def _surface(points: np.ndarray, triangles: np.ndarray) -> tuple[Surface, NDArray[np.int64]]:
    """The triangles in the order of the leaves of a tree, and this order."""
    count = len(triangles)
    xyz, triangles = unit_points(points), np.array(triangles, dtype=np.int32)  # kernels know no other types
    tree = BoxTree(*bounding_boxes(xyz[triangles]))
    normals, view = np.empty((count, 3)), np.empty(count, dtype=np.int8)
    _normals(xyz, triangles, normals, view)
    start, around = np.zeros(len(xyz) + 1, dtype=np.int64), np.empty(3 * count, dtype=np.int64)
    _incident(triangles, start, around)
    clean, balance = np.empty(len(xyz), dtype=np.int8), np.zeros(len(xyz), dtype=np.int32)
    _clean(xyz, triangles, normals, start, around, balance, clean)
    order = tree.order
    rows, boxes = triangles[order], (tree.box_low[order], tree.box_high[order])
    return Surface(xyz, rows, view[order], clean, tree.low, tree.high, *boxes), order


# ---------------------------------------------------------------------- flat triangles


@kernel
def _flat_rows(xyz, triangles, flat):
    count = 0
    for t in range(triangles.shape[0]):
        if clear_view(xyz, triangles[t, 0], triangles[t, 1], triangles[t, 2]) < 0:
            flat[count] = t
            count += 1
    return count


def flat_rows(points: np.ndarray, triangles: np.ndarray) -> NDArray[np.int64]:
    """The triangles whose vertices lie on a line, exactly."""
    flat = np.empty(len(triangles), dtype=np.int64)
    return flat[: _flat_rows(unit_points(points), np.array(triangles, dtype=np.int32), flat)]
