"""Facets of a body that lie in one plane, side by side, as one polygon each: triangles of a plane end, say.

The body is the same, and so are its names: only facets are joined that have the same ones. What is cut anew
in such a plane need not respect the edges between them, nor points on straight edges that two of them share.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...geometry.polygons import Polygons
from .cutting import views

__all__ = ["FlatParts", "flat_parts"]

Rows = NDArray[np.int64]
WITHIN_ONE_PLANE = (
    16 * 2.0**-53
)  # of the largest coordinate: how far points may be from the plane of a polygon
NEARLY_PARALLEL = 1e-6  # sine of the angle between normals of neighbors, from which planes are looked at


class FlatParts(NamedTuple):
    """A body with fewer facets.

    Attributes
    ----------
    arguments : dict
        Of `Domain`.
    vertex : (n,) int64
        For each of its points that of the body.
    group : (p,) int64
        For each piece of the body that of which it is a part.
    piece : (q,) int64
        For each of its pieces the first piece of the body that is a part of it.
    """

    arguments: dict[str, Any]
    vertex: Rows
    group: Rows
    piece: Rows


def flat_parts(
    domain: Any, which: NDArray[np.bool_], among: NDArray[np.bool_] | None = None
) -> FlatParts | None:
    """Join facets in common planes.

    Parameters
    ----------
    domain : Domain
        In space.
    which : (f,) bool
        Facets that are joined with all that lie beside them in their plane.
    among : (f,) bool, optional
        Facets that may be joined; all by default.

    Returns
    -------
    FlatParts or None
        None if nothing is joined. Groups whose outline touches itself stay as they are. Points on straight
        edges between two groups that are joined, which nothing else has, are left out. O(n log n).
    """
    facets, many = Polygons.of(domain.facets), len(domain.facets)
    group = _groups(domain, facets, np.ones(many, dtype=bool) if among is None else among)
    size = np.bincount(group, minlength=many)
    wanted = flagged(many, group[which]) & (size > 1)
    rings = {g: _rings(domain, facets, group == g) for g in np.flatnonzero(wanted).tolist()}
    rings = {g: found for g, found in rings.items() if found}
    if not rings:
        return None
    group = np.where(flagged(many, list(rings))[group], group, np.arange(many))  # each by its first member
    first = np.unique(group)
    _without_straight_points(domain, facets, group, rings)
    polygons = Polygons.of_rings([rings.get(g) or list(facets.rings(g)) for g in first.tolist()])
    inner = Polygons.of(domain.inner)
    used = flagged(len(domain.points), polygons.vertices, inner.vertices, np.asarray(domain.loose))
    vertex = np.flatnonzero(used)
    place = (np.cumsum(used) - 1).astype(np.int32)
    number = np.concatenate([np.searchsorted(first, group), len(first) + np.arange(len(inner))])
    arguments = {
        "points": domain.points[vertex],
        "facets": polygons.renumbered(place),
        "inner": inner.renumbered(place) if len(inner) else None,
        "markers": {name: np.unique(number[pieces]) for name, pieces in domain.markers.items()},
        "regions": dict(domain.regions) or None,
    }
    piece = np.concatenate([first, many + np.arange(len(inner))])
    return FlatParts(arguments, vertex, number, piece)


def _groups(domain: Any, facets: Polygons, among: NDArray[np.bool_]) -> Rows:
    """For each facet the first one of those in its plane with the same names, edge by edge."""
    many = len(facets)
    ends, owner = facets.sides
    low, high = np.sort(ends, axis=1).astype(np.int64).T
    key = low << 32 | high
    inner, _ = Polygons.of(domain.inner).sides if len(domain.inner) else (np.empty((0, 2)), None)
    taken = np.sort(np.asarray(inner, dtype=np.int64), axis=1)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    edge = key[order[same]]
    good = ~np.isin(edge, edge[1:][edge[1:] == edge[:-1]]) & ~np.isin(edge, taken[:, 0] << 32 | taken[:, 1])
    one, two = owner[order[same[good]]], owner[order[same[good] + 1]]
    one, two = one[among[one] & among[two]], two[among[one] & among[two]]
    names = _names(domain, many)
    xyz = np.asarray(domain.points, dtype=np.float64)
    normal, _ = views(xyz / max(float(np.abs(xyz).max()), 1e-300), facets)
    normal = normal / np.maximum(np.sqrt((normal * normal).sum(axis=1)), 1e-300)[:, None]
    cross = np.cross(normal[one], normal[two])
    flat = (names[one] == names[two]) & (np.abs(cross).max(axis=1, initial=0.0) < NEARLY_PARALLEL)
    one, two = one[flat], two[flat]
    flat = _in_plane(xyz, facets, normal, one, two)
    return _connected(many, one[flat], two[flat])


def _names(domain: Any, many: int) -> Rows:
    """Equal numbers for facets with the same markers."""
    table = np.zeros((many, len(domain.markers)), dtype=bool)
    for k, pieces in enumerate(domain.markers.values()):
        table[np.asarray(pieces)[np.asarray(pieces) < many], k] = True
    if table.shape[1] == 0:
        return np.zeros(many, dtype=np.int64)
    return np.unique(table, axis=0, return_inverse=True)[1].ravel()


def _in_plane(xyz: NDArray, facets: Polygons, normal: NDArray, one: Rows, two: Rows) -> NDArray[np.bool_]:
    """Whether all vertices of the second facets lie in the planes of the first ones."""
    tolerance = WITHIN_ONE_PLANE * float(np.abs(xyz).max(initial=0.0))
    good = np.ones(len(one), dtype=bool)
    for a, b in ((one, two), (two, one)):
        for k, (i, j) in enumerate(zip(a.tolist(), b.tolist())):
            if good[k]:
                x = xyz[facets.vertices_of(j)] - xyz[facets.vertices_of(i)[0]]
                good[k] = np.abs((x * normal[i]).sum(axis=1)).max() <= tolerance
    return good


def _connected(many: int, one: Rows, two: Rows) -> Rows:
    """The least number of those that are connected."""
    label = np.arange(many)
    while True:
        before = label.copy()
        np.minimum.at(label, one, before[two])
        np.minimum.at(label, two, before[one])
        label = label[label]
        if np.array_equal(label, before):
            return label


def _rings(domain: Any, facets: Polygons, chosen: NDArray[np.bool_]) -> list[list[int]]:
    """The outline and the holes of some facets together; nothing if a ring touches itself or another one."""
    ends, owner = facets.sides
    ends = np.sort(ends[chosen[owner]], axis=1).astype(np.int64)
    key, count = np.unique(ends[:, 0] << 32 | ends[:, 1], return_counts=True)
    border = np.column_stack([key[count == 1] >> 32, key[count == 1] & (2**32 - 1)])
    if len(border) == 0 or (np.bincount(border.ravel())[border.ravel()] != 2).any():
        return []
    beside: dict[int, list[int]] = {}
    for a, b in border.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    rings = []
    while beside:
        ring = [next(iter(beside))]
        while True:
            following = [v for v in beside.pop(ring[-1]) if v in beside]
            if not following:
                break
            ring.append(following[0])
        rings.append(ring)
    extent = [float(np.ptp(domain.points[ring], axis=0).max()) for ring in rings]
    return [rings[i] for i in sorted(range(len(rings)), key=lambda i: -extent[i])]


def _without_straight_points(
    domain: Any, facets: Polygons, group: Rows, rings: dict[int, list[list[int]]]
) -> None:
    """Leave points out of rings where two joined groups, and no other piece, meet along a straight line."""
    many, xyz = len(domain.points), np.asarray(domain.points, dtype=np.float64)
    owner = np.repeat(group[facets.sides[1]], 2)
    pairs = np.unique(np.column_stack([facets.sides[0].ravel(), owner]), axis=0)
    joined = np.isin(pairs[:, 1], list(rings))
    two = (np.bincount(pairs[:, 0], minlength=many) == 2) & (
        np.bincount(pairs[joined, 0], minlength=many) == 2
    )
    if len(domain.inner):
        two[Polygons.of(domain.inner).vertices] = False
    tolerance = WITHIN_ONE_PLANE * float(np.abs(xyz).max(initial=0.0))
    for g, found in rings.items():
        rings[g] = [_bends(xyz, np.asarray(ring), two, tolerance) for ring in found]


def _bends(xyz: NDArray, ring: Rows, loose: NDArray[np.bool_], tolerance: float) -> list[int]:
    """A ring without those of its points that may go and lie on a line between two that stay."""
    before, after = xyz[np.roll(ring, 1)] - xyz[ring], xyz[np.roll(ring, -1)] - xyz[ring]
    goes = loose[ring] & (_off_line(before, after) <= tolerance) & ((before * after).sum(axis=1) < 0.0)
    stay = np.flatnonzero(~goes)
    if len(stay) < 3:
        return ring.tolist()
    for k, i in enumerate(stay.tolist()):
        j = int(stay[(k + 1) % len(stay)])
        run = np.arange(i + 1, j + len(ring) * (j <= i)) % len(ring)
        away = xyz[ring[run]] - xyz[ring[i]]
        along = np.broadcast_to(xyz[ring[j]] - xyz[ring[i]], away.shape)
        if _off_line(away, along).max(initial=0.0) > tolerance:
            goes[run] = False
    return ring[~goes].tolist()


def _off_line(away: NDArray, along: NDArray) -> NDArray:
    """How far points are from the lines through the origin along some vectors."""
    length = np.sqrt((along * along).sum(axis=1))
    area = np.cross(away, along)
    return np.sqrt((area * area).sum(axis=1)) / np.maximum(length, 1e-300)
