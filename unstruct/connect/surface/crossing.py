"""Which edges of a Voronoi diagram in space meet which triangles, exactly.

A Voronoi edge is the segment between the circumcenters of two tetrahedra with a common face, or a ray from
one of them through a face of the convex hull. Doubles decide what is farther than rounding from any change;
the rest is decided by fractions. Closed segments and closed triangles meet if they have a point in common.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...geometry.boxes import BOXES_IN_LEAF, BoxTree, bounding_boxes
from ...geometry.edge_vectors import exponents
from .sphere_signs import as_integers

__all__ = ["Duals", "centers_of", "dual_crossings", "in_triangle", "meets_exactly", "on_line", "plane_center"]

Array = NDArray[np.float64]
WELL_SHAPED = 1e-7  # of the terms of a determinant: if it is less, the center is computed by fractions
BLUR = 1e-8  # no computed place is farther off, in units of its distance from what it is made of
CENTERS_AT_ONCE = 1 << 18
WAITING_DUALS = 128


class Duals(NamedTuple):
    """Voronoi edges of a Delaunay mesh.

    Attributes
    ----------
    faces : (f, 3) int32
        The faces that they cross, each turned so that the first tetrahedron lies below it.
    cells : (f, 2) int32
        Their tetrahedra; the second is -1 at the convex hull.
    start, end : (f, 3) float64
        Circumcenters; the end of a ray is as far away as was asked for.
    blur : (f,) float64
        How far these may be off.
    """

    faces: NDArray[np.int32]
    cells: NDArray[np.int32]
    start: Array
    end: Array
    blur: Array


def _spheres(x: Array) -> tuple[Array, Array, Array]:
    """Twice the determinant, twice its absolute terms, the numerator of the center less corner 0."""
    u, v, w = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0], x[:, 3] - x[:, 0]
    squares = [a[:, 0] * a[:, 0] + a[:, 1] * a[:, 1] + a[:, 2] * a[:, 2] for a in (u, v, w)]
    crosses = [_cross(v, w), _cross(w, u), _cross(u, v)]
    top = sum(s[:, None] * c for s, c in zip(squares, crosses))
    det = u[:, 0] * crosses[0][:, 0] + u[:, 1] * crosses[0][:, 1] + u[:, 2] * crosses[0][:, 2]
    size = abs(u[:, 0] * crosses[0][:, 0]) + abs(u[:, 1] * crosses[0][:, 1]) + abs(u[:, 2] * crosses[0][:, 2])
    return det + det, size + size, top


def _cross(u: Any, v: Any) -> Any:
    parts = [u[:, k - 2] * v[:, k - 1] - u[:, k - 1] * v[:, k - 2] for k in range(3)]
    return np.stack(parts, axis=1)


def exact_centers(points: Array, rows: NDArray) -> NDArray:
    """Circumcenters of tetrahedra as fractions, in units in which ``points`` are given: (k, 3) objects."""
    flat = as_integers(points, rows.ravel())[0].reshape(-1, 4, 3)
    twice, _, top = _spheres(flat)
    unit = _unit(points, rows)
    result = np.empty((len(rows), 3), dtype=object)
    for i in range(len(rows)):
        for k in range(3):
            result[i, k] = (flat[i, 0, k] + Fraction(top[i, k], twice[i])) * unit
    return result


def _unit(points: Array, rows: NDArray) -> Fraction:
    """What 1 means in the integers of `as_integers`."""
    for x in points[np.unique(rows)].ravel().tolist():
        if x != 0.0:
            at = np.argwhere(points[rows.ravel()] == x)[0]
            whole = as_integers(points, rows.ravel())[0][at[0], at[1]]
            return Fraction(x) / whole
    return Fraction(1)


def centers_of(points: Array, rows: NDArray[np.int32]) -> tuple[Array, Array]:
    """Circumcenters of tetrahedra (m, 4), and how far they may be off."""
    center, blur = np.empty((len(rows), 3)), np.empty(len(rows))
    for i in range(0, len(rows), CENTERS_AT_ONCE):
        part = rows[i : i + CENTERS_AT_ONCE]
        x = points[part]
        twice, size, top = _spheres(x)
        bad = ~(np.abs(twice) > WELL_SHAPED * size) | (np.abs(twice) < 1e-280)
        safe = np.where(bad, 1.0, twice)
        away = top / safe[:, None]
        if bad.any():
            exact = exact_centers(points, part[bad])
            away[bad] = np.array([[float(v) for v in row] for row in exact]).reshape(-1, 3) - x[bad, 0]
        center[i : i + len(part)] = x[:, 0] + away
        blur[i : i + len(part)] = BLUR * (np.abs(away).max(axis=1) + np.abs(x[:, 0]).max(axis=1))
    return center, blur


@inline
def _along(low, high, node, start, step, wide):
    """Whether the segment from start to start + step comes within ``wide`` of a box."""
    first, last = 0.0, 1.0
    for k in range(3):
        one, two = low[node, k] - wide - start[k], high[node, k] + wide - start[k]
        if step[k] == 0.0:
            if one > 0.0 or two < 0.0:
                return False
            continue
        one, two = one / step[k], two / step[k]
        if one > two:
            one, two = two, one
        first, last = max(first, one), min(last, two)
    return first <= last


@inline
def _relation(start, end, corner, normals, t, wide):
    """1 if a segment surely meets a triangle, -1 if surely not, 0 otherwise; and where on the segment."""
    n = normals[t]
    one = two = 0.0
    for k in range(3):
        one += n[k] * (start[k] - corner[t, 0, k])
        two += n[k] * (end[k] - corner[t, 0, k])
    if (one > wide and two > wide) or (one < -wide and two < -wide):
        return -1, 0.0
    sure = abs(one) > wide and abs(two) > wide
    # how far the computed crossing may be off: by the blur, divided by how steeply the segment crosses
    at = one / (one - two) if one != two else 0.0
    at = min(max(at, 0.0), 1.0)
    length = 0.0
    for k in range(3):
        length += (end[k] - start[k]) ** 2
    length = np.sqrt(length)
    slope = abs(one - two)
    off = wide + (wide * length / slope if slope > wide else length)
    inside = True
    for i in range(3):
        j = (i + 1) % 3
        ex, ey = corner[t, j, 0] - corner[t, i, 0], corner[t, j, 1] - corner[t, i, 1]
        ez = corner[t, j, 2] - corner[t, i, 2]
        px = start[0] + at * (end[0] - start[0]) - corner[t, i, 0]
        py = start[1] + at * (end[1] - start[1]) - corner[t, i, 1]
        pz = start[2] + at * (end[2] - start[2]) - corner[t, i, 2]
        cross = n[0] * (ey * pz - ez * py) + n[1] * (ez * px - ex * pz) + n[2] * (ex * py - ey * px)
        room = off * np.sqrt(ex * ex + ey * ey + ez * ez)
        if cross < -room:
            return -1, at
        inside = inside and cross > room
    return (1 if sure and inside else 0), at


@kernel
def _crossings(duals, tree, corner, normals, first, sure, doubt):
    """Write pairs (dual edge, triangle) that surely meet, and those that may; (next edge, both counts)."""
    low, high, order = tree
    leaves = low.shape[0] // 2
    stack = np.empty(WAITING_DUALS, dtype=np.int64)
    many = open_ = 0
    step = np.empty(3)
    for f in range(first, duals.start.shape[0]):
        a, b = duals.start[f], duals.end[f]
        for k in range(3):
            step[k] = b[k] - a[k]
        wide = duals.blur[f]
        begun, opened = many, open_
        stack[0], top = 1, 1
        while top > 0:
            top -= 1
            node = stack[top]
            if not _along(low, high, node, a, step, wide):
                continue
            if node < leaves:
                stack[top], stack[top + 1] = 2 * node, 2 * node + 1
                top += 2
                continue
            begin = (node - leaves) * BOXES_IN_LEAF
            for i in range(begin, min(begin + BOXES_IN_LEAF, order.shape[0])):
                t = order[i]
                relation, _ = _relation(a, b, corner, normals, t, wide)
                if relation < 0:
                    continue
                if many == sure.shape[0] or open_ == doubt.shape[0]:
                    return f, begun, opened
                if relation > 0:
                    sure[many, 0], sure[many, 1] = f, t
                    many += 1
                else:
                    doubt[open_, 0], doubt[open_, 1] = f, t
                    open_ += 1
    return duals.start.shape[0], many, open_


def unit_normals(corner: Array) -> Array:
    """Unit normals of triangles (t, 3, 3)."""
    edges = corner[:, 1:] - corner[:, :1]
    edges = np.ldexp(edges, -exponents(edges)[:, None, None])  # products of lengths may be no doubles
    n = _cross(edges[:, 0], edges[:, 1])
    length = np.sqrt(n[:, 0] ** 2 + n[:, 1] ** 2 + n[:, 2] ** 2)
    return n / np.where(length > 0.0, length, 1.0)[:, None]


def dual_crossings(points: Array, tets: NDArray[np.int32], duals: Duals, corner: Array) -> NDArray[np.int64]:
    """All pairs (Voronoi edge, triangle) that have a point in common, exactly: (k, 2), sorted.

    Parameters
    ----------
    points : (n, 3)
        Of the Delaunay mesh.
    tets : (m, 4)
    duals : Duals
    corner : (t, 3, 3)
        The corners of the triangles, none of them flat.
    """
    corner = np.ascontiguousarray(corner)
    boxes = BoxTree(*bounding_boxes(corner))
    tree, normals = (boxes.low, boxes.high, boxes.order), unit_normals(corner)
    room = 4 * len(corner) + 2 * len(duals.start) + 64
    sure, doubt = np.empty((room, 2), dtype=np.int64), np.empty((room, 2), dtype=np.int64)
    parts, unsure, first = [np.empty((0, 2), dtype=np.int64)], [np.empty((0, 2), dtype=np.int64)], 0
    while first < len(duals.start):
        before = first
        first, many, open_ = _crossings(duals, tree, corner, normals, first, sure, doubt)
        parts.append(sure[:many].copy())
        unsure.append(doubt[:open_].copy())
        if first == before:  # one edge alone needs more
            sure, doubt = np.empty((2 * len(sure), 2), np.int64), np.empty((2 * len(sure), 2), np.int64)
    left = np.concatenate(unsure)
    if len(left):
        parts.append(left[meets_exactly(points, tets, duals, corner, left)])
    found = np.concatenate(parts)
    return found[np.lexsort((found[:, 1], found[:, 0]))]


# ---------------------------------------------------------------------- by fractions


def meets_exactly(
    points: Array, tets: NDArray[np.int32], duals: Duals, corner: Array, pairs: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Whether pairs (Voronoi edge, triangle) have a point in common, by fractions alone."""
    known: dict[int, list[Fraction]] = {}
    result = np.empty(len(pairs), dtype=np.bool_)
    for i, (f, t) in enumerate(pairs.tolist()):
        ends = []
        for cell in duals.cells[f].tolist():
            if cell >= 0 and cell not in known:
                known[cell] = list(exact_centers(points, tets[cell : cell + 1])[0])
            ends.append(known[cell] if cell >= 0 else None)
        a, b, c = ([Fraction(x) for x in points[v].tolist()] for v in duals.faces[f].tolist())
        ray = ends[1] is None
        step = _cross_of(_minus(b, a), _minus(c, a)) if ray else _minus(ends[1], ends[0])
        result[i] = on_line(ends[0], step, Fraction(0), None if ray else Fraction(1), corner[t])
    return result


def _minus(x: Any, y: Any) -> list[Fraction]:
    return [p - q for p, q in zip(x, y)]


def _cross_of(u: Any, v: Any) -> list[Fraction]:
    return [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]


def _dot_of(u: Any, v: Any) -> Fraction:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def on_line(start: Any, step: Any, low: Any, high: Any, corner: Array) -> bool:
    """Whether start + s step lies in a closed triangle (3, 3) for an s in [low, high]; None is infinite."""
    a, b, c = ([Fraction(x) for x in row] for row in corner.tolist())
    normal = _cross_of(_minus(b, a), _minus(c, a))
    height, fall = _dot_of(normal, _minus(start, a)), -_dot_of(normal, step)
    if fall != 0:
        s = height / fall
        if (low is not None and s < low) or (high is not None and s > high):
            return False
        place = [x + s * d for x, d in zip(start, step)]
        return all(
            _dot_of(normal, _cross_of(_minus(q, p), _minus(place, p))) >= 0
            for p, q in ((a, b), (b, c), (c, a))
        )
    if height != 0:
        return False
    for p, q in ((a, b), (b, c), (c, a)):  # in the plane: the part of the line on the inner side of each edge
        inward = _cross_of(normal, _minus(q, p))
        now, change = _dot_of(inward, _minus(start, p)), _dot_of(inward, step)
        if change == 0:
            if now < 0:
                return False
            continue
        s = -now / change
        if change > 0:
            low = s if low is None else max(low, s)
        else:
            high = s if high is None else min(high, s)
    return low is None or high is None or low <= high


def plane_center(corner: Array) -> list[Fraction]:
    """The circumcenter of a triangle (3, 3) in its plane, as fractions."""
    a, b, c = ([Fraction(x) for x in row] for row in corner.tolist())
    u, v = _minus(b, a), _minus(c, a)
    n = _cross_of(u, v)
    s, t, scale = _dot_of(u, u), _dot_of(v, v), 2 * _dot_of(n, n)
    one, two = _cross_of(v, n), _cross_of(n, u)
    return [x + (s * p + t * q) / scale for x, p, q in zip(a, one, two)]


def in_triangle(place: list[Fraction], corner: Array) -> bool:
    """Whether a point lies in a closed triangle (3, 3), exactly."""
    still = [Fraction(0)] * 3
    return on_line(place, still, Fraction(0), Fraction(0), corner)
