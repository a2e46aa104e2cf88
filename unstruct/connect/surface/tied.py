"""Triangles with an empty sphere that are no faces of a Delaunay mesh: five vertices lie on a sphere.

The spheres through a triangle a, b, c have their centers on a line, a + (x + s n) / (2 |n|^2) with n normal
to the triangle and s any number. Vertex p lies inside for s > f / g if g = n . (p - a) is positive, for s < f
/ g if it is negative, and for all or no s if it is 0; f is the polynomial of `sphere_signs`. So the empty
spheres are those of an interval. Only vertices joined to a by an edge of the Delaunay mesh matter: a sphere
through a with vertices inside shrinks toward a until its inside is empty and some of them lie on it, and to
one of these a is joined.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.boxes import BoxTree, bounding_boxes
from ...mesh.mesh import Mesh
from ...predicates.batch import power_of_two
from ...predicates.filters import EPS, TINY
from .crossing import on_line

__all__ = ["tied_triangles"]

Array = NDArray[np.float64]
INTERVAL_BOUND = 64 * EPS


@kernel
def _hopeful(xyz, rows, start, joined, result):
    """Note triangles that may have an empty sphere: no two vertices joined to corner 0 exclude it."""
    for i in range(rows.shape[0]):
        a, b, c = rows[i, 0], rows[i, 1], rows[i, 2]
        ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
        vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
        A, B, C = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
        c_all = abs(ux * vx) + abs(uy * vy) + abs(uz * vz)
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        mx = abs(uy * vz) + abs(uz * vy)
        my, mz = abs(uz * vx) + abs(ux * vz), abs(ux * vy) + abs(uy * vx)
        low, high, result[i] = -np.inf, np.inf, True
        for j in range(start[a], start[a + 1]):
            p = joined[j]
            if p == b or p == c:
                continue
            wx, wy, wz = xyz[p, 0] - xyz[a, 0], xyz[p, 1] - xyz[a, 1], xyz[p, 2] - xyz[a, 2]
            F, D, E = wx * wx + wy * wy + wz * wz, ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
            d_all = abs(ux * wx) + abs(uy * wy) + abs(uz * wz)
            e_all = abs(vx * wx) + abs(vy * wy) + abs(vz * wz)
            f = F * (A * B - C * C) - A * B * (D + E) + C * (A * E + B * D)
            f_off = F * (A * B + c_all * c_all) + A * B * (d_all + e_all) + c_all * (A * e_all + B * d_all)
            f_off = INTERVAL_BOUND * f_off + TINY
            g = nx * wx + ny * wy + nz * wz
            g_off = INTERVAL_BOUND * (mx * abs(wx) + my * abs(wy) + mz * abs(wz)) + TINY
            if g > g_off:
                # the largest that f / g can be
                high = min(high, (f + f_off) / (g - g_off if f + f_off > 0.0 else g + g_off) + TINY)
            elif g < -g_off:
                low = max(low, (f + f_off) / (g + g_off if f + f_off > 0.0 else g - g_off) - TINY)
        if low - abs(low) * INTERVAL_BOUND > high + abs(high) * INTERVAL_BOUND:
            result[i] = False


def tied_triangles(mesh: Mesh, rows: NDArray, corner: Array) -> NDArray[np.bool_]:
    """Whether triangles have an empty sphere with its center on one of the triangles ``corner``, exactly.

    Parameters
    ----------
    mesh : Mesh
        A Delaunay mesh in space.
    rows : (k, 3) int
        Triangles on its vertices, none of them flat: those that are none of its faces.
    corner : (t, 3, 3)
        The triangles on which centers must lie.
    """
    result = np.zeros(len(rows), dtype=bool)
    start, joined = mesh.vertex_neighbor_vertices
    hopeful = np.zeros(len(rows), dtype=np.bool_)
    xyz = mesh.points * power_of_two(mesh.points)
    _hopeful(xyz, rows.astype(np.int64), start.astype(np.int64), joined.astype(np.int64), hopeful)
    if not hopeful.any():
        return result
    tree = BoxTree(*bounding_boxes(corner))
    for i in np.flatnonzero(hopeful):
        a = int(rows[i, 0])
        near = [p for p in joined[start[a] : start[a + 1]].tolist() if p not in rows[i]]
        result[i] = _tied(mesh.points[rows[i]], mesh.points[near], tree, corner)
    return result


def _tied(x: Array, others: Array, tree: BoxTree, corner: Array) -> bool:
    """Whether a triangle (3, 3) has a sphere without others inside that is centered on the triangles."""
    a, b, c = ([Fraction(v) for v in row] for row in x.tolist())
    u, v = [p - q for p, q in zip(b, a)], [p - q for p, q in zip(c, a)]
    n = [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]
    A, B, C = (sum(p * q for p, q in zip(*pair)) for pair in ((u, u), (v, v), (u, v)))
    low: Fraction | None = None
    high: Fraction | None = None
    for row in others.tolist():
        w = [Fraction(p) - q for p, q in zip(row, a)]
        F, D, E, g = (sum(p * q for p, q in zip(*pair)) for pair in ((w, w), (u, w), (v, w), (n, w)))
        f = F * (A * B - C * C) - A * B * (D + E) + C * (A * E + B * D)
        if g == 0:
            if f < 0:
                return False
        elif g > 0:
            high = f / g if high is None else min(high, f / g)
        else:
            low = f / g if low is None else max(low, f / g)
    if low is not None and high is not None and low > high:
        return False
    square = A * B - C * C
    one = [v[k - 2] * n[k - 1] - v[k - 1] * n[k - 2] for k in range(3)]
    two = [n[k - 2] * u[k - 1] - n[k - 1] * u[k - 2] for k in range(3)]
    middle = [p + (A * q + B * r) / (2 * square) for p, q, r in zip(a, one, two)]
    step = [p / (2 * square) for p in n]
    box_low, box_high = np.full((1, 3), -np.inf), np.full((1, 3), np.inf)
    if low is not None and high is not None:
        ends = np.array([[float(p + s * q) for p, q in zip(middle, step)] for s in (low, high)])
        reach = 1e-6 * (np.abs(corner).max() + np.abs(ends).max())
        box_low[0], box_high[0] = ends.min(axis=0) - reach, ends.max(axis=0) + reach
    _, found = tree.pairs(box_low, box_high)
    return any(on_line(middle, step, low, high, corner[t]) for t in found.tolist())
