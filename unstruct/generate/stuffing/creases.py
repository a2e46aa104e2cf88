"""Creases kept: along them the stuffed cells are taken out, and the strip is filled up to the sharp edges.

Cells far from creases stay as they are, with the angles that are proved for them. What is between them and
the surface is a body of its own: it is bounded by their free faces, and on the flat parts of the surface by
triangles between their outlines and the creases, which are divided as the size wants. It is filled by
recovery. See the book, chapter 4c.
"""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import DomainError, IncompleteWarning
from ...domain.domain import Domain
from ...geometry.segment_tree import SegmentTree
from ...geometry.triangle_tree import TriangleTree
from ...mesh.domain_mesh import DomainMesh
from ...mesh.grouping import group_rows, sort_rows
from ...sizing.field import SizeField
from ..bodies.tetrahedralize import tetrahedralize
from ..rebay.voronoi_segment import voronoi_segment
from .ending import boundary_faces
from .flat_parts import FLAT_PART, flat_parts

__all__ = ["Creases", "Filled", "creases_of", "with_creases"]

Array = NDArray[np.float64]
SEEDS = 4  # with which the strip is filled, until it is filled exactly
STRIP_WIDTH = 1.0  # of a cell: cells with a vertex so near to a crease are taken out
GRADED_STRIP = 1.4  # the same where cells along the surface differ


class Creases(NamedTuple):
    """The sharp edges of a body, divided, and its flat parts.

    Attributes
    ----------
    points : (n, 3) float64
        The points of the domain, then those that divide edges.
    segments : (s, 2) int64
        Parts of sharp edges.
    part : (t,) int64
        The flat part of each triangle.
    parts : (s, 2) int64
        The flat parts on both sides of each segment.
    frames : list of (origin, axes)
        A point of the plane of each part, and two directions in it.
    deviation : float
        How far corners are from the planes of their parts.
    """

    points: Array
    segments: NDArray[np.int64]
    part: NDArray[np.int64]
    parts: NDArray[np.int64]
    frames: list[tuple[Array, list[Array]]]
    deviation: float


class Filled(NamedTuple):
    """A mesh with creases.

    Attributes
    ----------
    points : (v, 3) float64
    cells : (m, 4) int32
        First those that were kept, in their order, then those of the strip.
    strip : (m,) bool
    origin : (v,) int32
        The domain's point; -1 for others.
    """

    points: Array
    cells: NDArray[np.int32]
    strip: NDArray[np.bool_]
    origin: NDArray[np.int32]


def creases_of(domain: Domain, angle: float, field: SizeField) -> Creases:
    """The edges at which normals differ by at least `angle` degrees.

    Raises
    ------
    InputError
        If the parts of the surface between them are not flat, up to 1e-6 of the extent.
    """
    flat = flat_parts(domain, angle)
    begin, end = flat.edges.T
    points, segments, edge = _divided(domain.triangulated.points, begin, end, field)
    return Creases(points, segments, flat.part, flat.beside[edge], flat.frames, flat.deviation)


def _divided(
    x: Array, begin: NDArray[np.int64], end: NDArray[np.int64], field: SizeField
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    """Edges in equal parts that are not longer than the size in the middle of the edge."""
    side = x[end] - x[begin]
    length = np.sqrt((side * side).sum(axis=1))
    size = np.minimum.reduce([field(x[begin]), field(x[end]), field(x[begin] + 0.5 * side)])
    count = np.maximum(1, np.ceil(length / size - FLAT_PART)).astype(np.int64)
    points, segments, edge, n = [x], [], [], len(x)
    for k in range(len(begin)):
        share = np.arange(1, count[k]) / count[k]
        points.append(x[begin[k]] + share[:, None] * side[k])
        chain = np.concatenate([[begin[k]], n + np.arange(count[k] - 1), [end[k]]])
        segments.append(np.stack([chain[:-1], chain[1:]], axis=1))
        edge.append(np.full(count[k], k))
        n += count[k] - 1
    if not segments:
        return x, np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    return np.concatenate(points), np.concatenate(segments), np.concatenate(edge)


def with_creases(
    domain: Domain,
    creases: Creases,
    mesh: tuple[Array, NDArray[np.int32], NDArray[np.bool_]],
    size: tuple[SizeField, float],
    progress: bool,
) -> tuple[Filled | None, NDArray[np.bool_]]:
    """The mesh with its strip along creases filled anew, and which cells were taken out for that.

    If the strip cannot be filled exactly, there is no mesh.

    Parameters
    ----------
    domain : Domain
    creases : Creases
    mesh : (points, cells, on_surface)
        What was stuffed.
    size : (field, cell)
        The size of the strip, and the side of the smallest cells along the surface.
    progress : bool
    """
    points, cells, on_surface = mesh
    field, cell = size
    width = STRIP_WIDTH * cell if field.constant is not None else GRADED_STRIP * field(points)
    part, gone = _taken_out(domain, creases, mesh, width)
    kept = cells[~gone]
    faces, _ = boundary_faces(kept, np.ones(len(points), dtype=bool))
    outer = _among(faces, boundary_faces(cells, on_surface)[0])
    offset = len(creases.points)
    everything = np.concatenate([creases.points, points])
    triangles = [faces[~outer].astype(np.int64) + offset]
    for k in range(len(creases.frames)):
        covered = faces[outer & (part[faces[:, 0]] == k)].astype(np.int64) + offset
        try:
            found, more = _between(creases, k, covered, everything, field)
        except DomainError:  # rounding of the input makes the outline cross itself
            return None, gone
        triangles.append(found)
        everything = np.concatenate([everything, more])
    used, number = np.unique(np.concatenate(triangles), return_inverse=True)
    try:
        strip = Domain(everything[used], number.reshape(-1, 3))
    except DomainError:
        return None, gone
    for seed in range(SEEDS):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", IncompleteWarning)
            filled = tetrahedralize(strip, field, split_boundary=False, seed=seed, progress=progress)
        whole = filled.counts["missing triangles"] == 0 and filled.counts["missing segments"] == 0
        if whole and not len(filled.steiner):
            rows = kept.astype(np.int64) + offset
            return _joined(everything, rows, used, filled, creases.deviation, len(domain.points)), gone
    return None, gone


def _taken_out(
    domain: Domain,
    creases: Creases,
    mesh: tuple[Array, NDArray[np.int32], NDArray[np.bool_]],
    width: float | Array,
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The flat part on which each vertex of the surface lies (-1 for others), and the cells near creases."""
    points, cells, on_surface = mesh
    shell = domain.triangulated
    part = np.full(len(points), -1, dtype=np.int64)
    rows = np.flatnonzero(on_surface)
    which, _ = TriangleTree(shell.points[shell.bounding]).nearest(points[rows])
    part[rows] = creases.part[which]
    near = np.zeros(len(points), dtype=bool)
    if len(creases.segments):
        near = SegmentTree(creases.points[creases.segments]).distance(points) <= width
    parts = part[cells]
    most = parts.max(axis=1)
    several = ((parts >= 0) & (parts != most[:, None])).any(axis=1)
    return part, _without_touching(cells, on_surface, near[cells].any(axis=1) | several)


def _without_touching(
    cells: NDArray[np.int32], on_surface: NDArray[np.bool_], gone: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """The cells that are taken out, with those that would touch the surface in a vertex or an edge only."""
    n = len(on_surface)
    faces, owner = boundary_faces(cells, on_surface)
    pairs = np.sort(np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1), axis=2)
    keys = pairs[:, :, 0].astype(np.int64) * n + pairs[:, :, 1]
    known = np.unique(keys)
    rows = np.flatnonzero(on_surface[cells].any(axis=1))
    corners = cells[rows]
    ends = np.sort(np.stack([corners[:, [i, j]] for i in range(4) for j in range(i)], axis=1), axis=2)
    edge = ends[:, :, 0].astype(np.int64) * n + ends[:, :, 1]
    place = np.minimum(np.searchsorted(known, edge), len(known) - 1)
    is_edge = known[place] == edge
    gone = gone.copy()
    while True:
        kept = ~gone[owner]
        vertices, sides = np.zeros(n, dtype=bool), np.zeros(len(known), dtype=bool)
        vertices[faces[kept].ravel()] = True
        sides[np.searchsorted(known, keys[kept].ravel())] = True
        bare = (on_surface[corners] & ~vertices[corners]).any(axis=1) | (is_edge & ~sides[place]).any(axis=1)
        bare &= ~gone[rows]
        if not bare.any():
            return gone
        gone[rows[bare]] = True


def _among(faces: NDArray[np.int32], others: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which faces are among others, in any order of their vertices."""
    rows = np.concatenate([others, faces])
    sort_rows(rows)
    group, _ = group_rows(rows)
    return np.isin(group[len(others) :], group[: len(others)])


def _between(
    creases: Creases, k: int, covered: NDArray[np.int64], points: Array, field: SizeField
) -> tuple[NDArray[np.int64], Array]:
    """Triangles of the flat part k around those that cells cover already, and further points for them.

    The further points are numbered after `points`.
    """
    ends = np.sort(np.concatenate([covered[:, [0, 1]], covered[:, [1, 2]], covered[:, [2, 0]]]), axis=1)
    edges, count = np.unique(ends, axis=0, return_counts=True)
    here = creases.parts == k
    facets = np.concatenate([creases.segments[here.sum(axis=1) == 1], edges[count == 1]])
    inner = creases.segments[here.all(axis=1)]
    origin, axes = creases.frames[k]
    used, number = np.unique(np.concatenate([facets, inner]), return_inverse=True)
    number = number.reshape(-1, 2)
    gap = points[used] - origin
    flat = Domain(
        np.stack([(gap * axis).sum(axis=1) for axis in axes], axis=1),
        number[: len(facets)],
        inner=number[len(facets) :] if len(inner) else None,
    )

    def lifted(q: Array) -> Array:
        return origin + q[:, :1] * axes[0] + q[:, 1:] * axes[1]

    with warnings.catch_warnings():  # of triangles beside creases; the cells over them are judged later
        warnings.simplefilter("ignore", IncompleteWarning)
        mesh = voronoi_segment(flat, lambda q: field(lifted(q)), split_boundary=False)
    back = np.asarray(mesh.origin)
    new = np.flatnonzero(back < 0)
    vertex = np.where(back < 0, 0, used[back])
    vertex[new] = len(points) + np.arange(len(new))
    return vertex[mesh.simplices], lifted(mesh.points[new])


def _joined(
    everything: Array,
    kept: NDArray[np.int64],
    used: NDArray[np.int64],
    filled: DomainMesh,
    deviation: float,
    given: int,
) -> Filled:
    """The cells that were kept and those of the strip, whose vertices ``used`` has."""
    origin = np.asarray(filled.origin)
    new = np.flatnonzero(origin < 0)
    vertex = np.empty(len(origin), dtype=np.int64)
    vertex[origin >= 0] = used[origin[origin >= 0]]
    vertex[new] = len(everything) + np.arange(len(new))
    cells = np.concatenate([kept, vertex[filled.simplices]])
    found = np.concatenate([everything, filled.points[new]])
    strip = np.arange(len(cells)) >= len(kept)
    thin = FLAT_PART * float(np.ptp(found, axis=0).max()) + 2.0 * deviation
    while True:
        flat = _flat_on_surface(found, cells, strip, thin)
        if not flat.any():
            break
        cells, strip = cells[~flat], strip[~flat]
    live, number = np.unique(cells, return_inverse=True)
    back = np.where(live < given, live, -1).astype(np.int32)
    return Filled(found[live], number.reshape(-1, 4).astype(np.int32), strip, back)


def _flat_on_surface(
    points: Array, cells: NDArray[np.int64], strip: NDArray[np.bool_], thin: float
) -> NDArray[np.bool_]:
    """Cells of the strip in a flat part of the surface, to which rounding has given a volume.

    They have a face at the boundary, over which they are lower than `thin`. Without them, the flat part is
    divided into triangles in another way.
    """
    flat = np.zeros(len(cells), dtype=bool)
    faces, owner = boundary_faces(cells.astype(np.int32), np.ones(len(points), dtype=bool))
    faces, owner = faces[strip[owner]], owner[strip[owner]]
    fourth = cells[owner].sum(axis=1) - faces.sum(axis=1, dtype=np.int64)
    p = points[faces]
    u, v, w = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0], points[fourth] - p[:, 0]
    normal = np.stack([u[:, a - 2] * v[:, a - 1] - u[:, a - 1] * v[:, a - 2] for a in range(3)], axis=1)
    area = np.sqrt((normal * normal).sum(axis=1))
    flat[owner[np.abs((normal * w).sum(axis=1)) <= thin * area]] = True
    return flat
