"""Triangles that overlap in a plane, and edges in planes of triangles: their common arrangement, exactly.

A group of triangles is cut along all sides of its members, and along edges of other pieces in its plane. New
vertices are where sides cross. They must be doubles exactly, as they are for sides along the axes: rounded
ones would leave the plane and the sides, and so open the surface.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.polygons import Polygons
from ...geometry.segment_pairs import CROSSING, vertices_on_segments
from ...geometry.segment_pairs import meetings as segment_meetings
from ...geometry.triangle_pairs import (
    EDGES_CROSS,
    PIERCES,
    Meetings,
    clear_view,
    side,
    sides_index,
    turn,
    unit_points,
)
from .cutting import Shell
from .faults import repeats
from .flat import NO_ENDS, triangulated

__all__ = ["Arrangement", "Group", "arranged", "groups_in_planes", "in_plane"]


class Group(NamedTuple):
    """Pieces in one plane that hang together by overlaps, and sides of others in their plane."""

    rows: list[int]
    edges: NDArray[np.int32]


class Arrangement(NamedTuple):
    """The parts of a group.

    Attributes
    ----------
    fresh : (k, 3) float64
        New vertices, numbered from the number of points on.
    parts : (m, 3) int
        Triangles, counterclockwise in ``view``.
    covers : list of list of int
        For each part the pieces of the group in which it lies; at least one.
    view : int
        As 3 i + j.
    """

    fresh: NDArray[np.float64]
    parts: NDArray[np.int32]
    covers: list[list[int]]
    view: int


def groups_in_planes(shell: Shell, polygons: Polygons, edges: np.ndarray, met: Meetings) -> list[Group]:
    """The groups of pieces that overlap in a plane, or inside of which there are sides of other pieces."""
    xyz, triangles = unit_points(shell.points), shell.triangles
    parent: dict[int, int] = {}
    along: dict[int, list[int]] = {}

    def root(row: int) -> int:
        while parent.setdefault(row, row) != row:
            parent[row] = parent[parent[row]]
            row = parent[row]
        return row

    for one, two in zip(*map(np.ndarray.tolist, repeats(triangles))):
        parent[root(int(shell.piece[one]))] = root(int(shell.piece[two]))
    key, owner = sides_index(triangles)
    sides = {(min(pair), max(pair)) for pair in polygons.sides[0].tolist()} if len(met.edge) else set()
    for e, t, kind in zip(met.edge.tolist(), met.triangle.tolist(), met.kind.tolist()):
        p, q = sorted(edges[e].tolist())
        if kind in (PIERCES, EDGES_CROSS) or not in_plane(xyz, triangles[t], (p, q)):
            continue
        row = int(shell.piece[t])
        if (p, q) in sides and _enters(xyz, triangles[t], (p, q)):
            along.setdefault(row, []).append(e)
            root(row)
        first, last = np.searchsorted(key, [(p << 32) | q, ((p << 32) | q) + 1])
        for other in owner[first:last].tolist():
            if shell.piece[other] != row and _overlap(xyz, triangles[t], triangles[other]):
                parent[root(int(shell.piece[other]))] = root(row)
    members: dict[int, list[int]] = {}
    for row in sorted(parent):
        members.setdefault(root(row), []).append(row)
    return [
        Group(rows, edges[sorted({e for row in rows for e in along.get(row, ())})].reshape(-1, 2))
        for rows in members.values()
    ]


def in_plane(xyz: np.ndarray, triangle: np.ndarray, vertices: tuple[int, ...]) -> bool:
    """Whether vertices lie in the plane of a triangle, exactly."""
    a, b, c = triangle.tolist()
    return all(v in (a, b, c) or side(xyz, a, b, c, v) == 0 for v in vertices)


def _enters(xyz: np.ndarray, triangle: np.ndarray, ends: tuple[int, ...]) -> bool:
    """Whether a segment in the plane of a triangle has points inside of it."""
    view = clear_view(xyz, *triangle)
    i, j = view // 3, view % 3
    a, b, c = triangle.tolist()
    whole = turn(xyz, i, j, a, b, c)
    for u, v in ((a, b), (b, c), (c, a)):
        if all(turn(xyz, i, j, u, v, w) * whole <= 0 for w in ends):
            return False
    signs = [turn(xyz, i, j, *ends, w) for w in (a, b, c)]
    return min(signs) < 0 < max(signs)


def _overlap(xyz: np.ndarray, one: np.ndarray, two: np.ndarray) -> bool:
    """Whether two triangles lie in one plane and have area in common: no side of either separates them."""
    if not in_plane(xyz, one, tuple(two.tolist())):
        return False
    view = clear_view(xyz, *one)
    i, j = view // 3, view % 3
    for here, there in ((one.tolist(), two.tolist()), (two.tolist(), one.tolist())):
        whole = turn(xyz, i, j, *here)
        for k in range(3):
            u, v = here[k], here[(k + 1) % 3]
            if all(turn(xyz, i, j, u, v, w) * whole <= 0 for w in there):
                return False
    return True


def arranged(points: np.ndarray, polygons: Polygons, group: Group, on: np.ndarray) -> Arrangement | None:
    """The arrangement of a group; None if sides cross where there is no double.

    Parameters
    ----------
    points : (n, 3) float64
    polygons : Polygons
    group : Group
        Its pieces lie in a plane exactly.
    on : (k,) int
        Vertices that lie on pieces of the group.
    """
    ends, owner = polygons.select(np.array(group.rows)).sides
    number, at = np.unique(np.concatenate([ends.ravel(), group.edges.ravel(), on]), return_inverse=True)
    local, fresh = points[number], np.empty((0, 3))
    segments = at[: ends.size + group.edges.size].reshape(-1, 2)
    bits = [1 << int(k) for k in owner] + [0] * len(group.edges)  # the piece of each side
    view = _view(local, at[: ends.size])
    axes = [view // 3, view % 3]
    while True:
        parts = _split(np.ascontiguousarray(local[:, axes]), segments, bits)
        segments, bits = np.array(list(parts), dtype=np.int64), list(parts.values())
        pairs, kinds = segment_meetings(np.ascontiguousarray(local[:, axes]), segments)
        crossing = pairs[kinds == CROSSING]
        if len(crossing) == 0:
            break
        places = {_crossing(local, axes, segments[s], segments[t]) for s, t in crossing.tolist()}
        exact = {where for where in places if where is not None}
        if len(exact) < len(places):
            return None
        more = np.array(sorted(exact))
        local, fresh = np.concatenate([local, more]), np.concatenate([fresh, more])
    found, wrong = triangulated(
        unit_points(local), NO_ENDS, view, chords=segments, also=np.arange(len(local))
    )
    if wrong is not None:
        return None
    masks = _covers(found, parts)
    kept = np.flatnonzero([mask > 0 for mask in masks])
    numbers = np.concatenate([number, len(points) + np.arange(len(fresh))]).astype(np.int32)
    covers = [[row for k, row in enumerate(group.rows) if masks[i] >> k & 1] for i in kept.tolist()]
    return Arrangement(fresh, numbers[found[kept]], covers, view)


def _view(local: np.ndarray, vertices: np.ndarray) -> int:
    """How to look at the plane of these vertices, which do not all lie on a line."""
    xyz = unit_points(local)
    first, *rest = np.unique(vertices).tolist()
    return next(view for v in rest[1:] if (view := int(clear_view(xyz, first, rest[0], v))) >= 0)


def _split(flat: np.ndarray, segments: np.ndarray, bits: list[int]) -> dict[tuple[int, int], int]:
    """Segments cut at all vertices on them: each part with the pieces of which it is a side."""
    inside: dict[int, list[int]] = {}
    for v, s in vertices_on_segments(flat, np.arange(len(flat)), segments).tolist():
        inside.setdefault(s, []).append(v)
    parts: dict[tuple[int, int], int] = {}
    for s, (p, q) in enumerate(segments.tolist()):
        chain = sorted((p, q, *inside.get(s, ())), key=lambda v: tuple(flat[v]))
        for pair in pairwise(chain):
            pair = (min(pair), max(pair))
            parts[pair] = parts.get(pair, 0) ^ bits[s]
    return parts


def _crossing(points: np.ndarray, axes: list[int], s: np.ndarray, t: np.ndarray) -> tuple[float, ...] | None:
    """Where two segments of a plane cross, if the coordinates are doubles."""
    a, b, c, d = ([Fraction(x) for x in points[v].tolist()] for v in (*s, *t))
    i, j = axes
    over = (b[i] - a[i]) * (d[j] - c[j]) - (b[j] - a[j]) * (d[i] - c[i])
    share = ((c[i] - a[i]) * (d[j] - c[j]) - (c[j] - a[j]) * (d[i] - c[i])) / over
    place = [x + share * (y - x) for x, y in zip(a, b)]
    rounded = tuple(map(float, place))
    return rounded if all(x == y for x, y in zip(place, rounded)) else None


def _covers(triangles: np.ndarray, sides: dict[tuple[int, int], int]) -> list[int]:
    """For each triangle the pieces in which it lies, as bits: they change where a side of one is passed.

    Outside of all triangles there are none.
    """
    around: dict[tuple[int, int], list[int]] = {}
    for t, (a, b, c) in enumerate(triangles.tolist()):
        for u, v in ((a, b), (b, c), (c, a)):
            around.setdefault((min(u, v), max(u, v)), []).append(t)
    masks = [-1] * len(triangles)
    stack = []
    for edge, found in around.items():
        if len(found) == 1 and masks[found[0]] < 0:
            masks[found[0]] = sides.get(edge, 0)
            stack.append(found[0])
    while stack:
        t = stack.pop()
        a, b, c = triangles[t].tolist()
        for u, v in ((a, b), (b, c), (c, a)):
            edge = (min(u, v), max(u, v))
            for other in around[edge]:
                if masks[other] < 0:
                    masks[other] = masks[t] ^ sides.get(edge, 0)
                    stack.append(other)
    return masks
