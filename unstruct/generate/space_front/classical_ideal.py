"""The ideal point of a face of the classical front in space, and the quality of cells, compiled."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from ...base.jit import inline, lean
from ...sizing.space_table import SpaceNodes, size_in_space
from ..advancing.rows import VERTEX_COUNT

__all__ = ["SpaceChoices", "apart_by", "from_place", "ideal_in_space", "roundness_of", "wanted_at"]

LEAST_EDGE, MOST_EDGE = 1.25, 3.5  # the ideal edges in radii of the smallest circle around the face


class SpaceChoices(NamedTuple):
    """What the caller chooses."""

    order: int
    search: int
    reach: float  # the radius of the search: times the height of the ideal cell, or times its edges
    roundness: float  # the least quality of a cell with a candidate from this sphere
    constant: float  # the wanted length if it is the same everywhere, otherwise 0
    most: int  # no new point is made when there are so many vertices
    size: SpaceNodes


@inline
def wanted_at(choices, x, y, z):
    """The wanted length at a point."""
    size = choices.size
    if choices.constant > 0.0:
        return choices.constant
    return size_in_space(size.child, size.values, size.box, x, y, z)


@inline
def apart_by(xyz, u, v):
    """The distance of two vertices."""
    x, y, z = xyz[v, 0] - xyz[u, 0], xyz[v, 1] - xyz[u, 1], xyz[v, 2] - xyz[u, 2]
    return sqrt(x * x + y * y + z * z)


@inline
def from_place(xyz, v, x, y, z):
    """The distance of a vertex from a place."""
    dx, dy, dz = xyz[v, 0] - x, xyz[v, 1] - y, xyz[v, 2] - z
    return sqrt(dx * dx + dy * dy + dz * dz)


@lean
def ideal_in_space(front, choices, row, lower):
    """Write the ideal point of a face, ``lower`` times as high, to the next unused vertex: (edges, length).

    Its foot is the center of the smallest circle around the face: the circumcenter, or, if an angle is
    obtuse, the middle of the longest edge. The length is taken at the height of the center of the regular
    tetrahedron. Edges 0 mean that there is no such point, since lengths so small are lost to rounding.
    """
    xyz, n = front.xyz, front.state[VERTEX_COUNT]
    a, b, c = np.int64(front.corner[row, 0]), np.int64(front.corner[row, 1]), np.int64(front.corner[row, 2])
    p, q, r = apart_by(xyz, b, c), apart_by(xyz, c, a), apart_by(xyz, a, b)
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    twice = sqrt(nx * nx + ny * ny + nz * nz)  # the area
    if twice < 1e-200:
        return 0.0, 0.0
    one, two, three = p * p * (q * q + r * r - p * p), q * q * (r * r + p * p - q * q), 0.0
    three = r * r * (p * p + q * q - r * r)
    if one <= 0.0:
        one, two, three, radius = 0.0, 0.5, 0.5, 0.5 * p
    elif two <= 0.0:
        one, two, three, radius = 0.5, 0.0, 0.5, 0.5 * q
    elif three <= 0.0:
        one, two, three, radius = 0.5, 0.5, 0.0, 0.5 * r
    else:
        whole = one + two + three
        one, two, three, radius = one / whole, two / whole, three / whole, p * q * r / (2.0 * twice)
    x = one * xyz[a, 0] + two * xyz[b, 0] + three * xyz[c, 0]
    y = one * xyz[a, 1] + two * xyz[b, 1] + three * xyz[c, 1]
    z = one * xyz[a, 2] + two * xyz[b, 2] + three * xyz[c, 2]
    nx, ny, nz = nx / twice, ny / twice, nz / twice
    up = radius * 0.3535533905932738  # a quarter of the height of the regular tetrahedron
    h = wanted_at(choices, x + up * nx, y + up * ny, z + up * nz)
    edge = min(max(h, LEAST_EDGE * radius), MOST_EDGE * radius)
    d = lower * sqrt(edge * edge - radius * radius)
    xyz[n, 0], xyz[n, 1], xyz[n, 2] = x + d * nx, y + d * ny, z + d * nz
    return edge, h


@inline
def roundness_of(xyz, cell):
    """The quality 6 sqrt(2) V / (root mean square edge)^3 of a cell: 1 if regular, near 0 if flat."""
    a, b, c, d = cell[0], cell[1], cell[2], cell[3]
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    wx, wy, wz = xyz[d, 0] - xyz[a, 0], xyz[d, 1] - xyz[a, 1], xyz[d, 2] - xyz[a, 2]
    six = ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx)
    square = ux * ux + uy * uy + uz * uz + vx * vx + vy * vy + vz * vz + wx * wx + wy * wy + wz * wz
    square += (ux - vx) * (ux - vx) + (uy - vy) * (uy - vy) + (uz - vz) * (uz - vz)
    square += (vx - wx) * (vx - wx) + (vy - wy) * (vy - wy) + (vz - wz) * (vz - wz)
    square += (wx - ux) * (wx - ux) + (wy - uy) * (wy - uy) + (wz - uz) * (wz - uz)
    square /= 6.0
    below = square * sqrt(square)
    return 1.4142135623730951 * six / below if below > 0.0 else 0.0
