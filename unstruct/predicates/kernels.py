"""Exact signs for vertices and cells given by number, in two and three dimensions, for kernels.

Points are scaled (|coordinates| <= 1); a cell is a row of d + 1 vertices.
"""

from __future__ import annotations

from ..base.jit import inline, kernel
from .batch import incircle, insphere, orient2, orient3

__all__ = ["conflict", "moved", "orientation"]


@inline
def orientation(xy, a, b, c):
    """Orientation of three vertices of the plane: 1 where the way from a by b to c turns left."""
    return orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])


@kernel
def moved(points, cell, k, p):
    """Orientation of the cell after its corner k has been moved to vertex p.

    For a positive cell: 1 where p and corner k are on the same side of the facet opposite k, 0 on its
    plane, -1 beyond.
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
    """In-sphere sign of vertex p and a positive cell: 1 where p is strictly inside."""
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
