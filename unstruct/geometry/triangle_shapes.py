"""Angles and roundness of the triangles of a planar mesh in one compiled pass.

The values are those of `unstruct.geometry.simplex`, whose arrays of intermediate results take ten times as
long: the same operations in the same order, so that they agree up to the last bit of the arctangent.
"""

from __future__ import annotations

import math

import numpy as np

from ..base.arrays import frozen
from ..base.jit import inline, kernel

__all__ = ["PLANAR_QUALITIES", "planar_angles", "planar_shapes"]

PLANAR_QUALITIES = ("min_angle", "max_angle", "2r/R")
IN_DEGREES = 180.0 / math.pi
LEAST_EXPONENT = -1000  # of edges: smaller ones cannot be scaled by a product


@inline
def _between(ax, ay, bx, by):
    """`angle_between` of vectors a and b; -1 if a length underflows to zero."""
    la, lb = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
    if la == 0.0 or lb == 0.0:
        return -1.0
    ax, ay, bx, by = ax / la, ay / la, bx / lb, by / lb
    x, y, u, v = ax - bx, ay - by, ax + bx, ay + by
    return 2 * math.atan2(math.sqrt(x * x + y * y), math.sqrt(u * u + v * v))


@inline
def _edges(points, cells, t):
    """Half of the edges from the first corner of a triangle: differences of halves cannot overflow."""
    p, q, r = cells[t, 0], cells[t, 1], cells[t, 2]
    px, py = points[p, 0] * 0.5, points[p, 1] * 0.5
    return (
        points[q, 0] * 0.5 - px, points[q, 1] * 0.5 - py, points[r, 0] * 0.5 - px, points[r, 1] * 0.5 - py,
    )  # fmt: skip


@kernel
def _angles(points, cells, least, most):
    """Write the smallest and the largest angle of each triangle; False if one is beyond the range."""
    for t in range(cells.shape[0]):
        ax, ay, bx, by = _edges(points, cells, t)
        size = max(max(abs(ax), abs(ay)), max(abs(bx), abs(by)))
        if not size < np.inf:
            return False
        exponent = math.frexp(size)[1]
        q, r = cells[t, 1], cells[t, 2]
        cx, cy = points[r, 0] * 0.5 - points[q, 0] * 0.5, points[r, 1] * 0.5 - points[q, 1] * 0.5
        if (ax == 0.0 and ay == 0.0) or (bx == 0.0 and by == 0.0) or (cx == 0.0 and cy == 0.0):
            least[t] = most[t] = np.nan
            continue
        if exponent < LEAST_EXPONENT:
            return False
        s = math.ldexp(1.0, -exponent)
        ax, ay, bx, by, cx, cy = ax * s, ay * s, bx * s, by * s, cx * s, cy * s
        one, two, three = _between(ax, ay, bx, by), _between(cx, cy, -ax, -ay), _between(-bx, -by, -cx, -cy)
        if one < 0.0 or two < 0.0 or three < 0.0:
            return False
        least[t] = min(min(one, two), three) * IN_DEGREES
        most[t] = max(max(one, two), three) * IN_DEGREES
    return True


@kernel
def _roundness(points, cells, found):
    """Write 2r/R of each triangle; False if one is beyond the range."""
    for t in range(cells.shape[0]):
        ax, ay, bx, by = _edges(points, cells, t)
        size = max(max(abs(ax), abs(ay)), max(abs(bx), abs(by)))
        if not size < np.inf:
            return False
        exponent = math.frexp(size)[1]
        if exponent < LEAST_EXPONENT:
            return False
        s = math.ldexp(1.0, -exponent)
        ax, ay, bx, by = ax * s, ay * s, bx * s, by * s
        content = abs(ax * by - ay * bx)
        found[t] = 0.0
        if content > 0.0:
            cx, cy = bx - ax, by - ay
            la, lb = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
            lc = math.sqrt(cx * cx + cy * cy)
            radius, inner = la * lb * lc / (2 * content), content / (lc + lb + la)
            if not (inner > 0.0 and radius > 0.0):
                return False
            found[t] = 2 / (radius / inner)
    return True


def planar_angles(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The smallest and the largest angle of each triangle, in degrees; None as for `planar_shapes`."""
    if not _fit(points, cells):
        return None
    least, most = np.empty(len(cells)), np.empty(len(cells))
    return (least, most) if _angles(*_contiguous(points, cells), least, most) else None


def planar_shapes(name: str, points: np.ndarray, cells: np.ndarray) -> np.ndarray | None:
    """The quality ``name`` of triangles in the plane; None if `simplex.quality` must compute it.

    Parameters
    ----------
    name : str
        One of ``PLANAR_QUALITIES``.
    points : ndarray, shape (n, 2)
    cells : ndarray of int32, shape (m, 3)

    Returns
    -------
    ndarray, shape (m,), or None
        None for another shape or type, and where an edge is not finite, below 1e-300, or vanishes beside
        another.
    """
    if name not in PLANAR_QUALITIES or not _fit(points, cells):
        return None
    if name != "2r/R":
        both = planar_angles(points, cells)
        return None if both is None else both[name == "max_angle"]
    result = np.empty(len(cells))
    return result if _roundness(*_contiguous(points, cells), result) else None


def _fit(points: np.ndarray, cells: np.ndarray) -> bool:
    shapes = points.shape[1] == 2 and cells.shape[1:] == (3,)
    return shapes and points.dtype == np.float64 and cells.dtype == np.int32


def _contiguous(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both in one layout and read-only: for others the kernels would be compiled again."""
    return frozen(np.ascontiguousarray(points)), frozen(np.ascontiguousarray(cells))
