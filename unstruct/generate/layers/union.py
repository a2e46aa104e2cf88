"""Layers and the mesh of the rest as one mesh, with names, regions and the pieces of the boundary."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...connect.planar.complex import PlanarComplex
from ...geometry.triangle_shapes import planar_angles
from ...mesh.domain_mesh import DomainMesh
from ...mesh.mesh import Mesh
from .filling import Remainder
from .scene import Scene, bare
from .strips import Cells, Numbering

__all__ = ["Union", "extreme_angle", "split_quads", "union_of"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
TELLING = 0.99999  # cosines up to this one tell angles apart
ROUNDED_SQUARE = 1e-14  # above the rounding errors of sums of squares
LONGER = 1.0 + 1e-6  # ratio of squared edges: far beyond rounding
MEASURED_EDGE = 1e-70  # products of squares of edges above it are far above the least doubles


class Union(NamedTuple):
    """The arrays of the whole mesh.

    Attributes
    ----------
    points, origin : (n, 2) float64, (n,) int32
    cells : dict of str to ndarray of int32
    region, layer : (m,) int64
        Per cell, in the order of the cells: the region; the layer, from 1 on, 0 in the rest.
    segments, piece, span : ndarray
        The subsegments of all pieces.
    place : (p,) int64
        The number in the mesh of each numbered point, -1 for those that are not used.
    fill : (f,) int64
        The cells that came from the rest, in its order.
    """

    points: Array
    origin: NDArray[np.int32]
    cells: dict[str, NDArray[np.int32]]
    region: Integers
    layer: Integers
    segments: Integers
    piece: Integers
    span: Array
    place: Integers
    fill: Integers


def split_quads(points: Array, quads: Integers, made: NDArray[np.int32]) -> None:
    """Write convex quadrilaterals as two triangles each, by the diagonal with the smaller largest angle."""
    _split(np.ascontiguousarray(points), np.ascontiguousarray(quads), made)


@inline
def _square(points, a, b):
    return (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2


@inline
def _dot(points, a, b, c):
    """The product of the edges of the triangle abc that begin at a."""
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    return ux * vx + uy * vy


@inline
def _cosine(points, a, b, c):
    """The cosine of the angle at a of the triangle abc."""
    squares = _square(points, a, b) * _square(points, a, c)
    return _dot(points, a, b, c) / np.sqrt(max(squares, 1e-300))


@inline
def _least_cosine(points, a, b, c):
    """The cosine of the largest angle; where one edge is clearly the longest, that is opposite."""
    one, two, three = _square(points, b, c), _square(points, c, a), _square(points, a, b)
    if one > LONGER * max(two, three):  # the angle opposite the longest edge
        return _cosine(points, a, b, c)
    if two > LONGER * max(one, three):
        return _cosine(points, b, c, a)
    if three > LONGER * max(one, two):
        return _cosine(points, c, a, b)
    return min(_cosine(points, a, b, c), _cosine(points, b, c, a), _cosine(points, c, a, b))


@kernel
def _split(points, quads, made):
    for i in range(quads.shape[0]):
        a, b, c, d = quads[i, 0], quads[i, 1], quads[i, 2], quads[i, 3]
        one = min(_least_cosine(points, a, b, c), _least_cosine(points, a, c, d))
        two = min(_least_cosine(points, a, b, d), _least_cosine(points, b, c, d))
        made[2 * i, 0], made[2 * i, 1], made[2 * i, 2] = a, b, c
        made[2 * i + 1, 0], made[2 * i + 1, 1], made[2 * i + 1, 2] = a, c, d
        if two > one:
            made[2 * i, 2], made[2 * i + 1, 0], made[2 * i + 1, 1] = d, b, c


@kernel
def _extreme(points, cells, sharpest):
    """The triangle with the least cosine of an angle, or with the largest one; -1 where that is too little.

    That is if there is no triangle, if an edge is very short, or if the least angle is very small. The
    largest angle is opposite the longest edge, the least one opposite the shortest.
    """
    best, found = 2.0, np.int64(-1)
    for t in range(cells.shape[0]):
        a, b, c = cells[t, 0], cells[t, 1], cells[t, 2]
        one, two, three = _square(points, b, c), _square(points, c, a), _square(points, a, b)
        least, most = min(one, two, three), max(one, two, three)
        if least < MEASURED_EDGE * MEASURED_EDGE:
            return np.int64(-1)
        # Most triangles are told by three lengths alone, without knowing where the angle is.
        middle = max(min(one, two), min(max(one, two), three))
        if sharpest:
            twice, product = middle + most - least, middle * most
        else:
            twice, product = max(ROUNDED_SQUARE * most - (middle + least - most), 0.0), middle * least
        if best < 0.0 and twice * twice < 3.99 * best * best * product:
            continue
        if sharpest:
            one, two, three = -one, -two, -three
        if two >= max(one, three):
            a, b, c = b, c, a
        elif three >= max(one, two):
            a, b, c = c, a, b
        cosine = -_cosine(points, a, b, c) if sharpest else _cosine(points, a, b, c)
        if cosine < best:
            best, found = cosine, np.int64(t)
    return np.int64(-1) if sharpest and best < -TELLING else found


def extreme_angle(mesh: Mesh, sharpest: bool) -> float | None:
    """The least or the largest angle of a cell, in degrees, by one arctangent; None without cells."""
    at = int(_extreme(mesh.points, mesh.simplices, sharpest)) if set(mesh.cells) == {"triangle"} else -1
    found = planar_angles(mesh.points, mesh.simplices[at : at + 1]) if at >= 0 else None
    if found is not None:
        return float(found[0 if sharpest else 1][0])
    every = mesh.quality("min_angle" if sharpest else "max_angle")
    return float(every.min() if sharpest else every.max()) if len(every) else None


@kernel
def _mark(cells, used):
    """Mark the points that cells use."""
    for t in range(cells.shape[0]):
        for k in range(cells.shape[1]):
            used[cells[t, k]] = True


@kernel
def _identify(origin, vertex, many, known):
    """Give the points of the rest numbers: those of what they are, and new ones from ``many`` on.

    Returns how many points there are in all.
    """
    for i in range(len(origin)):
        known[i] = many if origin[i] < 0 else vertex[origin[i]]
        many += origin[i] < 0
    return many


@kernel
def _count_off(used, place):
    """Number the points that are used; the others get -1. Returns how many are used."""
    many = 0
    for i in range(len(used)):
        place[i] = many if used[i] else -1
        many += used[i]
    return many


@kernel
def _collect(own, other, known, place, vertices, points, origin):
    """Write the points that are used: our own ones, then those of the rest, whose numbers are ``known``.

    The first ``vertices`` of our own are those of the domain.
    """
    for i in range(len(own)):
        if place[i] >= 0:
            points[place[i], 0], points[place[i], 1] = own[i, 0], own[i, 1]
            origin[place[i]] = i if i < vertices else -1
    for i in range(len(known)):
        at = place[known[i]]
        if known[i] >= len(own) and at >= 0:
            points[at, 0], points[at, 1], origin[at] = other[i, 0], other[i, 1], -1


@kernel
def _label(quad, triangle, split, between, side, layer, region):
    """Write layers and regions of cells: both halves of the first ``split`` quadrilaterals, and triangles.

    Then ``between`` others follow, and the other quadrilaterals.
    """
    at = 0
    for i in range(split):
        for _ in range(2):
            layer[at], region[at] = quad[1][i] + 1, side[quad[0][i]]
            at += 1
    for i in range(len(triangle[0])):
        layer[at], region[at] = triangle[1][i] + 1, side[triangle[0][i]]
        at += 1
    at += between
    for i in range(split, len(quad[0])):
        layer[at], region[at] = quad[1][i] + 1, side[quad[0][i]]
        at += 1


@kernel
def _renumber(cells, place):
    """Give the points of cells their numbers in the mesh."""
    for t in range(cells.shape[0]):
        for k in range(cells.shape[1]):
            cells[t, k] = place[cells[t, k]]


def union_of(
    scene: Scene, c: PlanarComplex, level: Integers, numbers: Numbering, cells: Cells,
    rest: Remainder, fill: DomainMesh, triangles: bool,
) -> Union:  # fmt: skip
    """Join the layers and the mesh of the rest at their common points."""
    many = len(numbers.points)
    segments, piece, span = _layered(scene, level, numbers)
    origin = np.asarray(fill.origin)
    known = np.empty(len(origin), dtype=np.int32)
    total = _identify(origin, rest.vertex, many, known)
    fill_region = _regions(scene, c, rest, fill)
    rows = np.flatnonzero(rest.piece[fill.piece] >= 0)
    run = fill.piece[rows]
    t0, t1 = rest.span[run].T
    s = fill.span[rows]
    t = np.where(s == 1.0, t1[:, None], t0[:, None] + s * (t1 - t0)[:, None])
    segments = np.concatenate([segments, known[fill.segments[rows]]])
    piece, span = np.concatenate([piece, rest.piece[run]]), np.concatenate([span, t])
    side = scene.walls.region[scene.rays.side]
    q, t, f = len(cells.quads) if triangles else 0, len(cells.triangles), len(fill.simplices)
    quads = cells.quads[q:]
    corners: NDArray[np.int32] = np.empty((2 * q + t + f, 3), dtype=np.int32)
    split_quads(numbers.points, cells.quads[:q], corners[: 2 * q])
    corners[2 * q : 2 * q + t], corners[2 * q + t :] = cells.triangles, fill.simplices
    _renumber(corners[2 * q + t :], known)
    layer, region = np.zeros((2, len(corners) + len(quads)), dtype=np.int64)
    quad, triangle = (cells.quad_strip, cells.quad_layer), (cells.triangle_strip, cells.triangle_layer)
    _label(quad, triangle, q, f, side, layer, region)
    region[2 * q + t : 2 * q + t + f] = fill_region
    both: dict[str, NDArray[np.int32]] = {"triangle": corners, "quad": quads.astype(np.int32)}
    kept = {name: block for name, block in both.items() if len(block)}
    used, place = np.zeros(total, dtype=bool), np.empty(total, dtype=np.int64)
    for block in kept.values():
        _mark(block, used)
    n = _count_off(used, place)
    points, origin_of = np.empty((n, 2)), np.empty(n, dtype=np.int32)
    _collect(numbers.points, fill.points, known, place, len(scene.domain.points), points, origin_of)
    for block in kept.values():
        _renumber(block, place)
    order = np.lexsort((span[:, 0], piece))
    return Union(
        points, origin_of, kept, region, layer,
        place[segments.take(order, axis=0)], piece[order],
        span[order], place[:many], 2 * q + t + np.arange(f),
    )  # fmt: skip


def _layered(scene: Scene, level: Integers, numbers: Numbering) -> tuple[Integers, Integers, Array]:
    """The subsegments that only layers touch: of walls, and of pieces along which rays slid."""
    free, layer = bare(scene, level)
    rows = np.flatnonzero(layer & ~free)
    segments, piece, span = [scene.ends[rows]], [scene.piece[rows]], [scene.span[rows]]
    slides = scene.slides
    for r in np.flatnonzero((slides >= 0) & (level > 0)).tolist():
        k = np.arange(level[r] + 1)
        chain, t = numbers.at(np.full(len(k), r), k), scene.fronts.parameter[r, : level[r] + 1].copy()
        t[0] = round(float(t[0]))
        if t[0] > 0.5:
            chain, t = chain[::-1], t[::-1]
        segments.append(np.column_stack([chain[:-1], chain[1:]]))
        piece.append(np.full(len(k) - 1, slides[r]))
        span.append(np.column_stack([t[:-1], t[1:]]))
    return np.concatenate(segments), np.concatenate(piece), np.concatenate(span)


def _regions(scene: Scene, c: PlanarComplex, rest: Remainder, fill: DomainMesh) -> Integers:
    """The region of each cell of the rest in the whole domain, by an edge of a piece or of the envelope."""
    part = np.asarray(fill.markers["region"]).astype(np.int64)
    if not c.region.max(initial=0):  # there is but one
        return np.zeros(len(part), dtype=np.int64)
    n = len(fill.points)
    t = fill.simplices.astype(np.int64)
    keys = np.concatenate([t[:, i] * n + t[:, (i + 1) % 3] for i in range(3)])
    cell = np.tile(np.arange(len(t)), 3)
    order = np.argsort(keys, kind="stable")
    keys, cell = keys[order], cell[order]
    left, right = _sides(c)
    number = np.full(int(part.max(initial=-1)) + 1, -1, dtype=np.int64)
    start = np.searchsorted(scene.piece, np.arange(len(scene.domain.pieces) + 1))
    run = fill.piece
    middle = rest.span[run, 0] + fill.span.mean(axis=1) * (rest.span[run, 1] - rest.span[run, 0])
    source = rest.piece[run]
    # The subsegment that holds the middle of each segment.
    along = scene.piece + np.minimum(scene.span[:, 0], 1.0 - 1e-9)
    row = np.searchsorted(along, source + np.minimum(middle, 1.0 - 1e-12), side="right") - 1
    row = np.clip(row, start[np.maximum(source, 0)], start[np.maximum(source, 0) + 1] - 1)
    a, b = fill.segments.T.astype(np.int64)
    for first, second, region in ((a, b, left), (b, a, right)):
        key = first * n + second
        at = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
        found = keys[at] == key
        value = np.where(source < 0, rest.region[run], region[row])
        found &= (source >= 0) | (first is a)
        number[part[cell[at[found]]]] = value[found]
    return number[part]


def _sides(c: PlanarComplex) -> tuple[Integers, Integers]:
    """The regions on the left and on the right of each subsegment, seen along its piece."""
    e = c.where[: c.segments].astype(np.int64)
    begins = c.vertex[np.where(e % 3 == 2, e - 2, e + 1)] == c.ends[: c.segments, 0]
    one, two = c.region[e // 3], c.region[c.twin[e].astype(np.int64) // 3]
    return np.where(begins, one, two).astype(np.int64), np.where(begins, two, one).astype(np.int64)
