"""Exact signs in two and three dimensions, for kernels: of coordinates, or of vertices by their numbers.

Coordinates are scaled, at most 1 in magnitude. A cell is a row of d + 1 vertices.
"""

from __future__ import annotations

import numpy as np

from ..base.jit import inline, inline_with_arrays, kernel
from .close import close_incircle, close_insphere, close_orient2, close_orient3
from .filters import (
    UNDECIDED,
    filter_incircle,
    filter_insphere,
    filter_orient2,
    filter_orient3,
)

__all__ = ["conflict", "incircle", "insphere", "moved", "orient2", "orient3", "orientation"]


@inline
def orient2(ax, ay, bx, by, cx, cy):
    """Positive if a, b, c turn counterclockwise; exact for |coordinates| <= 1."""
    sign = filter_orient2(ax, ay, bx, by, cx, cy)
    if sign != UNDECIDED:
        return sign
    return close_orient2(ax, ay, bx, by, cx, cy)


@inline
def incircle(ax, ay, bx, by, cx, cy, px, py):
    """Positive if p is strictly inside the circle of counterclockwise a, b, c; |coordinates| <= 1."""
    sign = filter_incircle(ax, ay, bx, by, cx, cy, px, py)
    if sign != UNDECIDED:
        return sign
    return close_incircle(ax, ay, bx, by, cx, cy, px, py)


@inline_with_arrays
def orient3(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Sign of the determinant of rows b - a, c - a, d - a; exact for |coordinates| <= 1."""
    sign = filter_orient3(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz)
    if sign != UNDECIDED:
        return sign
    return -close_orient3((ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz))


@inline_with_arrays
def insphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz):
    """Positive if p is strictly inside the sphere of a, b, c, d with orient3 > 0; |coordinates| <= 1."""
    sign = filter_insphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz)
    if sign != UNDECIDED:
        return sign
    return -close_insphere(np.array([ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz]))


@inline
def orientation(xy, a, b, c):
    """Orientation of three vertices in the plane: 1 if the path from a through b to c turns left."""
    return orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])


@kernel
def moved(points, cell, k, p):
    """Orientation of the cell after its corner k has been moved to vertex p.

    For a positive cell: 1 if p and corner k are on the same side of the facet opposite k, 0 if p is in the
    plane of that facet, and -1 if p is beyond it.
    """
    a = p if k == 0 else cell[0]
    b = p if k == 1 else cell[1]
    c = p if k == 2 else cell[2]
    if points.shape[1] == 2:
        return orient2(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1])
    d = p if k == 3 else cell[3]
    return orient3(
        points[a, 0], points[a, 1], points[a, 2], points[b, 0], points[b, 1], points[b, 2],
        points[c, 0], points[c, 1], points[c, 2], points[d, 0], points[d, 1], points[d, 2],
    )  # fmt: skip


@kernel
def conflict(points, cell, p):
    """In-sphere sign of vertex p and a positive cell: 1 if p is strictly inside."""
    a, b, c = cell[0], cell[1], cell[2]
    if points.shape[1] == 2:
        return incircle(
            points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1],
            points[p, 0], points[p, 1],
        )  # fmt: skip
    d = cell[3]
    return insphere(
        points[a, 0], points[a, 1], points[a, 2], points[b, 0], points[b, 1], points[b, 2],
        points[c, 0], points[c, 1], points[c, 2], points[d, 0], points[d, 1], points[d, 2],
        points[p, 0], points[p, 1], points[p, 2],
    )  # fmt: skip
