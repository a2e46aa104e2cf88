"""Surfaces with even triangles: of level sets, of the plane sides of a body, of patches that are unrolled.

Points that two patches share are computed once, so that patches fit together bit for bit, and no sum of
products is left to a library of linear algebra: the same surfaces on every processor.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.arguments import as_count, as_seed, finite, positive
from ..base.elementary import cosines, sines
from ..base.errors import IncompleteWarning, InputError
from ..domain.domain import Domain
from ..generate.rebay.voronoi_segment import voronoi_segment
from ..generate.stuffing.stuffing import isosurface_stuffing
from ..geometry.edge_vectors import lengths
from ..mesh.mesh import Mesh
from ..sizing.source_sizes import points as point_sizes
from .bodies import LevelSet

__all__ = [
    "Patch",
    "joined_patches",
    "level_surface",
    "meshed_sides",
    "mirrored",
    "patch_of",
    "scanned_surface",
    "spread",
]

Array = NDArray[np.float64]
Triangles = NDArray[np.int32]
PATCH_GROWTH = 0.25  # of the size inside a patch, from that of its border
SLOPE_STEP = 1e-6  # for differences of a level set; unit: the wanted edge length
NEWTON_ROUNDS = 4
OFF_SURFACE = 0.05  # points that Newton's steps do not bring as near stay where they were; unit: the length
SIDE_ROWS = 4096  # samples of a line for its lengths
RAY_HALVINGS = 50  # of the part of a ray that contains the surface


class Patch(NamedTuple):
    """A part of a surface: points in space, triangles, and a name."""

    points: Array
    triangles: Triangles
    name: str


def patch_of(ring: Array, corners: Array, place: Callable[[Array], Array], name: str, far: float) -> Patch:
    """A patch from its border in a plane, counterclockwise seen from outside of the body.

    Parameters
    ----------
    ring : (k, 2) float64
        The border, unrolled into a plane; its points are kept.
    corners : (k, 3) float64
        The same in space.
    place : function (m, 2) -> (m, 3)
        For points inside.
    far : float
        The size far from the border, in the plane. Near it, it is the spacing of the border.
    """
    steps = lengths(np.roll(ring, -1, axis=0) - ring)
    spacing = np.minimum((steps + np.roll(steps, 1)) / 2, far)
    k = len(ring)
    number = np.arange(k)
    domain = Domain(ring, np.column_stack([number, np.roll(number, -1)]))
    fixed = domain.spaced(dict.fromkeys(range(k), 1))
    size = point_sizes(ring, spacing, growth=PATCH_GROWTH, far=max(far, float(spacing.max())))
    with warnings.catch_warnings():  # at sharp corners cells are larger than asked for
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = voronoi_segment(fixed, size, split_boundary=False)
    points = np.concatenate([corners, place(mesh.points[k:])])
    return Patch(points, np.asarray(mesh.simplices, dtype=np.int32), name)


def mirrored(patches: Sequence[Patch], axis: int) -> list[Patch]:
    """Patches and their mirror images in the plane where a coordinate is 0."""
    sign = np.where(np.arange(3) == axis, -1.0, 1.0)
    others = [Patch(p.points * sign + 0.0, p.triangles[:, ::-1], p.name) for p in patches]
    return [*patches, *others]


def joined_patches(patches: Sequence[Patch]) -> Domain:
    """The body that patches enclose: points with equal coordinates become one; markers are the names."""
    every = np.concatenate([p.points for p in patches]) + 0.0
    first = np.cumsum([0, *(len(p.points) for p in patches)])
    cells = np.concatenate([p.triangles + first[i] for i, p in enumerate(patches)])
    points, number = np.unique(every, axis=0, return_inverse=True)
    ends = np.cumsum([0, *(len(p.triangles) for p in patches)])
    markers: dict[str, list[int]] = {}
    for i, p in enumerate(patches):
        markers.setdefault(p.name, []).extend(range(ends[i], ends[i + 1]))
    return Domain(points, number.ravel()[cells].astype(np.int32), markers=markers)


def spread(start: float, end: float, length: Callable[[Array], Array]) -> Array:
    """Places from start to end (both included) whose distances are about the wanted lengths."""
    t = np.linspace(0.0, 1.0, SIDE_ROWS + 1)
    x = start + (end - start) * t
    density = 1.0 / length(x)
    share = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2)])
    total = share[-1] * abs(end - start) / SIDE_ROWS
    count = max(1, round(float(total)))
    found = np.interp(np.arange(count + 1) / count * share[-1], share, x)
    found[0], found[-1] = start, end
    return found


# ---------------------------------------------------------------------- plane sides


def meshed_sides(body: Domain, size: float) -> Domain:
    """A body with plane sides whose surface is triangles of about one size.

    Parameters
    ----------
    body : Domain
        In space, with facets that are polygons without holes, as of `Domain.box` and `examples.notched_box`.
    size : float
        The wanted edge length. Each edge of the body is cut into a whole number of parts.

    Returns
    -------
    Domain
        With the same markers, on the triangles.
    """
    h = positive(size, "size")
    if not isinstance(body, Domain) or body.dimension != 3:
        raise InputError("body must be a Domain in space")
    patches = []
    for i, facet in enumerate(body.facets):
        row = np.asarray(facet)
        if row.ndim != 1 or row.dtype == object:
            raise InputError(f"facet {i} has holes: meshed_sides takes polygons without them")
        patches.append(_side(body.points[row], f"{i}", h))
    found = joined_patches(patches)
    pieces = {name: [found.markers[str(i)] for i in rows] for name, rows in body.markers.items()}
    markers = {name: np.concatenate(rows) for name, rows in pieces.items() if len(rows)}
    return Domain(found.points, found.facets, markers=markers, regions=body.regions)


def _side(corners: Array, name: str, h: float) -> Patch:
    """The patch of a polygon; its plane is that of coordinates which its normal is nearest to."""
    border = np.concatenate([_cut(p, q, h)[:-1] for p, q in zip(corners, np.roll(corners, -1, axis=0))])
    rows = corners - corners[0]
    normal = np.zeros(3)
    for a, b in zip(rows, np.roll(rows, -1, axis=0)):
        normal += np.cross(a, b)
    normal /= lengths(normal)
    k = int(np.argmax(np.abs(normal)))
    u = np.eye(3)[(k + 1) % 3] * (1.0 if normal[k] > 0 else -1.0)
    v = np.eye(3)[(k + 2) % 3]
    if np.count_nonzero(normal) > 1:
        u = u - (u * normal).sum() * normal
        u /= lengths(u)
        v = np.cross(normal, u)
    flat = np.column_stack([((border - corners[0]) * axis).sum(axis=1) for axis in (u, v)])
    return patch_of(flat, border, lambda x: corners[0] + x[:, :1] * u + x[:, 1:] * v, name, h)


def _cut(p: Array, q: Array, h: float) -> Array:
    """Points of an edge with about equal distances, the same from either end."""
    turned = tuple(p) > tuple(q)
    a, b = (q, p) if turned else (p, q)
    count = max(1, round(float(lengths(b - a)) / h))
    t = np.arange(count + 1)[:, None] / count
    found = a * (1.0 - t) + b * t
    return found[::-1] if turned else found


# ---------------------------------------------------------------------- level sets


def level_surface(body: LevelSet, size: float, *, rounds: int = 12) -> Domain:
    """The surface of a level set as even triangles.

    Parameters
    ----------
    body : LevelSet
    size : float
        The wanted edge length.
    rounds : int
        How often each point is moved to the mean of its triangles, and back onto the surface.

    Returns
    -------
    Domain
        Edges of the body are cut off by the width of a triangle.

    Raises
    ------
    DomainError
        If the surface touches itself, where the body is thinner than triangles: give a smaller size.

    Notes
    -----
    The border of `isosurface_stuffing`, whose angles are bounded, made rounder.
    """
    h, many = positive(size, "size"), as_count(rounds, "rounds")
    if not isinstance(body, LevelSet):
        raise InputError("body must be a LevelSet, as examples.noisy_ball() is")
    filled = isosurface_stuffing(body, 1.25 * h)
    used, number = np.unique(filled.boundary, return_inverse=True)
    points, cells = filled.points[used], number.reshape(-1, 3).astype(np.int32)
    for _ in range(many):
        points = _onto(body, _evened(points, cells), h, points)
    return Domain(points, cells)


def _evened(points: Array, cells: Triangles) -> Array:
    """Each point at the mean of the centers of its triangles, by their areas."""
    corners = points[cells]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    weight, flat = lengths(normal), cells.ravel()
    center = (corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0
    total = np.bincount(flat, np.repeat(weight, 3), len(points))
    sums = [np.bincount(flat, np.repeat(weight * center[:, k], 3), len(points)) for k in range(3)]
    return np.stack(sums, axis=1) / total[:, None]


def _onto(body: LevelSet, x: Array, h: float, before: Array) -> Array:
    """Points moved onto the surface by Newton's steps; those that do not get there stay where they were."""
    step = SLOPE_STEP * h
    for _ in range(NEWTON_ROUNDS):
        value = body(x)
        slope = np.stack([(body(x + d) - body(x - d)) / (2 * step) for d in step * np.eye(3)], axis=1)
        square = np.maximum((slope * slope).sum(axis=1), 1e-6)
        move = (value / square)[:, None] * slope
        far = np.maximum(lengths(move) / (0.5 * h), 1.0)
        x = x - move / far[:, None]
    return np.where((np.abs(body(x)) < OFF_SURFACE * h)[:, None], x, before)


def scanned_surface(
    body: LevelSet, slices: int = 24, around: int = 96, *, error: float = 1e-4, seed: int = 0
) -> Mesh:
    """A body as a scanner measures it: many points along each slice, slices far apart, joined to needles.

    Parameters
    ----------
    body : LevelSet
        It contains the origin, and rays from there leave it once.
    slices, around : int
        How many cones of rays around the z axis, and rays in each; at least 1 and 3. Two more rays go
        along the axis.
    error : float
        Of the measured distances: the standard deviation, as a part of each.
    seed : int
        By chance are these errors, and how far each slice is turned.

    Returns
    -------
    Mesh
        A closed surface of ``2 * slices * around`` triangles.

    Raises
    ------
    InputError
        If the body does not contain the origin, for too few rays, and for a negative error.
    """
    many, rays, off = as_count(slices, "slices"), as_count(around, "around"), finite(error, "error")
    if not isinstance(body, LevelSet):
        raise InputError("body must be a LevelSet, as examples.noisy_ball() is")
    if many < 1 or rays < 3 or off < 0:
        raise InputError(f"slices = {many}, around = {rays}, error = {off:g} must be at least 1, 3 and 0")
    if not body(np.zeros((1, 3)))[0] > 0:
        raise InputError("body must contain the origin, from which it is scanned")
    rng = np.random.default_rng(as_seed(seed))
    down = np.pi * np.arange(1, many + 1)[:, None] / (many + 1)
    turn = 2 * np.pi * (np.arange(rays) + rng.random((many, 1))) / rays
    wide, z = sines(down), cosines(down) + np.zeros(rays)
    way = np.stack([wide * cosines(turn), wide * sines(turn), z], axis=2).reshape(-1, 3)
    way = np.vstack([[0.0, 0.0, 1.0], way, [0.0, 0.0, -1.0]])
    low, high = np.zeros(len(way)), np.full(len(way), float(lengths(np.abs(body.box).max(axis=0))))
    for _ in range(RAY_HALVINGS):
        middle = (low + high) / 2
        inside = body(way * middle[:, None]) > 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    points = way * (low * (1 + off * rng.normal(size=len(way))))[:, None]
    return Mesh(points, _slices_joined(many, rays))


def _slices_joined(many: int, rays: int) -> Triangles:
    """The triangles between neighboring slices, and at both ends of the axis."""
    i, end = np.arange(rays), many * rays + 1
    j = (i + 1) % rays
    rows = [np.stack([0 * i, 1 + i, 1 + j], axis=1)]
    for a in range(1, end - rays, rays):
        b = a + rays
        rows += [np.stack([a + i, b + i, b + j], axis=1), np.stack([a + i, b + j, a + j], axis=1)]
    last = end - rays
    rows.append(np.stack([last + i, 0 * i + end, last + j], axis=1))
    return np.vstack(rows).astype(np.int32)
