"""The flat parts of a surface of triangles between its sharp edges, up to the rounding of single precision.

Surfaces from files have coordinates of 24 bits. Then triangles of one flat side lie a little beside its
plane, and the normals of the thinnest are noise. See the book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...domain.domain import Domain
from ...geometry.inside_shell import side_mates
from ...geometry.support_features import united

__all__ = ["FLAT_PART", "FlatParts", "flat_parts"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
FLAT_PART = 1e-9  # of the extent of a body: so near to a plane, corners of a flat part are taken to be on it
ROUNDED_FLAT = 1e-6  # of the extent: how far they may be from a plane; single precision rounds by 1e-7
MOST_ROUNDING = 2.0**-22  # of the extent: by what single precision moves vertices against each other


class FlatParts(NamedTuple):
    """Flat parts, and the edges between them.

    Attributes
    ----------
    part : (t,) int64
        The flat part of each triangle.
    edges : (e, 2) int64
        The ends of the sharp edges.
    beside : (e, 2) int64
        The parts on both sides of each.
    frames : list of (origin, axes)
        For each part a point of its plane, and two perpendicular directions in it, of length 1.
    deviation : float
        The largest distance of a corner from the plane of its part.
    """

    part: Integers
    edges: Integers
    beside: Integers
    frames: list[tuple[Array, list[Array]]]
    deviation: float


class _Folds(NamedTuple):
    """Edges (e, 2), the two triangles at each, and the cosines of the angles between their normals."""

    ends: Integers
    one: Integers
    two: Integers
    cosine: Array


class _Planes(NamedTuple):
    """A point of the plane of each part, and its normal, each (k, 3)."""

    place: Array
    normal: Array


def flat_parts(domain: Domain, angle: float) -> FlatParts:
    """The parts between edges at which normals differ by at least `angle` degrees.

    Raises
    ------
    InputError
        If edges do not join two triangles, or a part is farther from a plane than 1e-6 of the extent.

    Notes
    -----
    If all parts between sharp edges are flat up to 1e-9 of the extent, they are the result. Otherwise
    triangles so thin that rounding can turn their normals by the angle do not decide: each joins a part
    beside it in whose plane it lies, and then no longer parts those beside it. O(n log n).

    `domain.space.merging.in_common_planes` is no substitute. It asks where planes are, and divides a smooth
    surface into strips; here the angle says which edges stay, and what is bent between them is refused, with
    the angle that would keep it. The names of facets do not matter, and what touches itself stays one part.
    """
    shell = domain.triangulated
    x, rows = shell.points, shell.bounding.astype(np.int64)
    extent = float(np.ptp(x[rows].reshape(-1, 3), axis=0).max())
    area = _area_vectors(x[rows])
    folds = _folds(rows, area / _lengths(area)[:, None])
    sharp = folds.cosine < np.cos(np.deg2rad(angle))
    part = _joined_over(len(rows), folds.one[~sharp], folds.two[~sharp])
    if (_heights(x[rows], part, _of_first(x[rows], area, part)) > FLAT_PART * extent).any():
        return _nearly_flat(x, rows, area, folds, angle)
    frames = [_frame(x[rows[i]]) for i in np.unique(part, return_index=True)[1]]
    return _result(part, folds, sharp, frames, 0.0)


def _result(
    part: Integers,
    folds: _Folds,
    sharp: NDArray[np.bool_],
    frames: list[tuple[Array, list[Array]]],
    deviation: float,
) -> FlatParts:
    beside = np.stack([part[folds.one[sharp]], part[folds.two[sharp]]], axis=1)
    return FlatParts(part, folds.ends[sharp], beside, frames, deviation)


def _nearly_flat(x: Array, rows: Integers, area: Array, folds: _Folds, angle: float) -> FlatParts:
    """Parts where triangles are beside the planes of their parts by more than the rounding of doubles."""
    p, size = x[rows], _lengths(area)
    extent = float(np.ptp(p.reshape(-1, 3), axis=0).max())
    near, limit = ROUNDED_FLAT * extent, np.cos(np.deg2rad(angle))
    longest = np.max([_lengths(p[:, k] - p[:, k - 1]) for k in range(3)], axis=0)
    thin = size / longest * np.sin(np.deg2rad(min(angle, 90.0))) <= MOST_ROUNDING * extent
    if thin.all():
        thin[:] = False
    one, two, thick = folds.one, folds.two, ~thin[folds.one] & ~thin[folds.two]
    sharp = folds.cosine < limit
    part = _joined_over(len(rows), one[thick & ~sharp], two[thick & ~sharp])
    planes = _fitted(p, area, part)
    settled = ~thin
    while True:  # thin triangles join parts in whose planes they lie
        candidate, goal = np.concatenate([one, two]), np.concatenate([two, one])
        open_ = ~settled[candidate] & settled[goal]
        candidate, goal = candidate[open_], part[goal[open_]]
        gap = np.abs(
            ((p[candidate] - planes.place[goal][:, None]) * planes.normal[goal][:, None]).sum(axis=2)
        )
        fits = gap.max(axis=1, initial=0.0) <= near
        if not fits.any():
            break
        chosen, first = np.unique(candidate[fits], return_index=True)
        part[chosen], settled[chosen] = goal[fits][first], True
    part = np.unique(part, return_inverse=True)[1]
    planes = _fitted(p, area, part)
    # thin triangles no longer part those on both sides of them
    cosine = (planes.normal[part[one]] * planes.normal[part[two]]).sum(axis=1)
    through = ~thick & (part[one] != part[two]) & (cosine >= limit)
    if through.any():
        part = _joined_over(int(part.max()) + 1, part[one[through]], part[two[through]])[part]
        planes = _fitted(p, area, part)
    height = _heights(p, part, planes)
    if (height > near).any():
        _refuse(p, height, part, folds, angle)
    sharp = (part[one] != part[two]) | (sharp & thick)
    frames = [
        _frame(_in_plane(p[i], planes.place[k], planes.normal[k]))
        for k, i in enumerate(_largest(size, part).tolist())
    ]
    return _result(part, folds, sharp, frames, float(height.max()))


def _refuse(p: Array, height: Array, part: Integers, folds: _Folds, angle: float) -> None:
    """Name the deviation, and the angle that keeps the edges at which the surface is bent."""
    extent = float(np.ptp(p.reshape(-1, 3), axis=0).max())
    row = int(np.argmax(height))
    here = (part[folds.one] == part[row]) & (part[folds.two] == part[row])
    one, two, cosine = folds.one[here], folds.two[here], folds.cosine[here]
    unit = _area_vectors(p)
    unit /= _lengths(unit)[:, None]
    rise = np.abs(((p[two] - p[one][:, :1]) * unit[one][:, None]).sum(axis=2)).max(axis=1, initial=0.0)
    bent = rise > ROUNDED_FLAT * extent
    least = np.rad2deg(np.arccos(np.clip(cosine[bent].max(), -1.0, 1.0))) if bent.any() else 0.0
    remedy = (
        f"take features = {least * 0.99:.3g}, which keeps the edges there, too, or " if bent.any() else ""
    )
    place = p[row].mean(axis=0).tolist()
    raise InputError(
        f"between edges of {angle:g} degrees or more the surface must be flat, up to {ROUNDED_FLAT:g} of the "
        f"extent; near {place} it is {height[row] / extent:.2g} of the extent away from a plane: {remedy}"
        "tetrahedralize(body, size, split_boundary=True), which keeps all edges"
    )


def _area_vectors(p: Array) -> Array:
    """Normals of triangles (t, 3, 3), twice as long as their areas."""
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    return np.stack([u[:, a - 2] * v[:, a - 1] - u[:, a - 1] * v[:, a - 2] for a in range(3)], axis=1)


def _lengths(v: Array) -> Array:
    return np.sqrt((v * v).sum(axis=1))


def _folds(rows: Integers, normal: Array) -> _Folds:
    """The edges of triangles (t, 3)."""
    mates = side_mates(rows)
    if (mates < 0).any():
        raise InputError("features needs a surface on which two facets meet at each edge")
    side = np.flatnonzero(np.arange(len(mates)) < mates)
    ends, beside = (
        np.stack([rows[at // 3, (at % 3 + 1) % 3], rows[at // 3, (at % 3 + 2) % 3]], axis=1)
        for at in (side, mates[side])
    )
    same_way = ends[:, 0] == beside[:, 0]
    low, high = ends.min(axis=1), ends.max(axis=1)
    order = np.lexsort((high, low))
    one, two = side // 3, mates[side] // 3
    cosine = (normal[one] * normal[two]).sum(axis=1) * np.where(same_way, -1.0, 1.0)
    return _Folds(np.stack([low, high], axis=1)[order], one[order], two[order], cosine[order])


def _joined_over(count: int, one: Integers, two: Integers) -> Integers:
    """Numbers that are equal for things that are joined, directly or by others."""
    parent = np.arange(count)
    united(one, two, parent)
    return np.unique(parent, return_inverse=True)[1]


def _of_first(p: Array, area: Array, part: Integers) -> _Planes:
    """The planes of the first triangles of parts."""
    first = np.unique(part, return_index=True)[1]
    return _Planes(p[first, 0], area[first] / _lengths(area[first])[:, None])


def _fitted(p: Array, area: Array, part: Integers) -> _Planes:
    """Planes through the middle of parts, across the sum of their area vectors."""
    count = int(part.max()) + 1
    size = _lengths(area)
    total = np.bincount(part, size, minlength=count)
    middle = p.mean(axis=1)
    place = np.stack([np.bincount(part, size * middle[:, a], minlength=count) for a in range(3)], axis=1)
    normal: Array = np.stack([np.bincount(part, area[:, a], minlength=count) for a in range(3)], axis=1)
    length = _lengths(normal)
    closed = length == 0.0  # no sum of normals tells a plane: any will do, since no closed part is flat
    if closed.any():
        normal[closed] = area[_largest(size, part)[closed]]
        length = _lengths(normal)
    return _Planes(place / total[:, None], normal / np.where(length > 0.0, length, 1.0)[:, None])


def _heights(p: Array, part: Integers, planes: _Planes) -> Array:
    """How far triangles are from the planes of their parts."""
    gap = p - planes.place[part][:, None, :]
    return np.abs((gap * planes.normal[part][:, None, :]).sum(axis=2)).max(axis=1)


def _largest(size: Array, part: Integers) -> Integers:
    """The largest triangle of each part."""
    order = np.lexsort((-size, part))
    return order[np.unique(part[order], return_index=True)[1]]


def _in_plane(corner: Array, place: Array, normal: Array) -> Array:
    """The feet of points on a plane."""
    return corner - ((corner - place) * normal).sum(axis=1)[:, None] * normal


def _frame(corner: Array) -> tuple[Array, list[Array]]:
    """The first corner of a triangle, and two perpendicular directions in its plane of length 1."""
    u, v = corner[1] - corner[0], corner[2] - corner[0]
    u = u / np.sqrt((u * u).sum())
    v = v - (u * v).sum() * u
    return corner[0], [u, v / np.sqrt((v * v).sum())]
