"""The triangles around each vertex of a wall, in order, and their normals."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.inside_shell import side_mates

__all__ = ["Stars", "stars_of", "unit_normals"]

Array = NDArray[np.float64]


class Stars(NamedTuple):
    """What stands around n vertices of t triangles that are turned alike.

    Attributes
    ----------
    start : (n + 1,) int64
    around : (3 t,) int64
        ``around[start[v] : start[v + 1]]`` are the places 3 t + k of vertex v in the triangles,
        counterclockwise; at a border they begin there.
    single : (n,) bool
        Whether they are one fan.
    mates : (3 t,) int64
        For each side, opposite corner k of triangle t, the other one at its edge; -1 at the border.
    """

    start: NDArray[np.int64]
    around: NDArray[np.int64]
    single: NDArray[np.bool_]
    mates: NDArray[np.int64]


@kernel
def _around(triangles, mates, start, around, single):
    """Write the fields of `Stars`; ``around`` is scratch in the beginning."""
    for t in range(len(triangles)):
        for k in range(3):
            start[triangles[t, k]] += 1
    for v in range(1, len(start)):
        start[v] += start[v - 1]
    for t in range(len(triangles) - 1, -1, -1):
        for k in range(2, -1, -1):
            v = triangles[t, k]
            start[v] -= 1
            around[start[v]] = 3 * t + k
    for v in range(len(single)):
        first, last = start[v], start[v + 1]
        single[v] = last > first
        if last == first:
            continue
        place = around[first]
        for i in range(first, last):  # a border begins where nothing is across the side before
            t, k = around[i] // 3, around[i] % 3
            if mates[3 * t + (k + 2) % 3] < 0:
                place = around[i]
                break
        begin, count = place, 0
        while place >= 0 and count < last - first:
            around[first + count] = place
            count += 1
            mate = mates[3 * (place // 3) + (place % 3 + 1) % 3]
            place = -1 if mate < 0 else 3 * (mate // 3) + (mate % 3 + 1) % 3
            if place == begin:
                break
        single[v] = count == last - first


def stars_of(triangles: NDArray[np.int32], vertices: int) -> Stars:
    """The stars of vertices 0 to ``vertices`` - 1. Where one is not `single`, it is not whole."""
    mates = side_mates(triangles)
    start, around = np.zeros(vertices + 1, dtype=np.int64), np.empty(3 * len(triangles), dtype=np.int64)
    single = np.empty(vertices, dtype=np.bool_)
    _around(triangles, mates, start, around, single)
    return Stars(start, around, single, mates)


@kernel
def _unit_normals(points, triangles, normals, double_area):
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        most = max(abs(x), abs(y), abs(z))
        if most > 0.0:  # so that squares do not underflow
            x, y, z = x / most, y / most, z / most
            length = np.sqrt(x * x + y * y + z * z)
            x, y, z, most = x / length, y / length, z / length, most * length
        normals[t, 0], normals[t, 1], normals[t, 2] = x, y, z
        double_area[t] = most


def unit_normals(points: Array, triangles: NDArray[np.int32]) -> tuple[Array, Array]:
    """Unit normals of triangles, rounded, and twice their areas; 0 where the area is 0."""
    normals, double_area = np.empty((len(triangles), 3)), np.empty(len(triangles))
    _unit_normals(points, triangles, normals, double_area)
    return normals, double_area
