"""Angles, roundness and edges of the triangles of a planar mesh, each in one compiled pass.

The values are those of `unstruct.geometry.simplex`, whose arrays of intermediate results take ten times as
long: the same operations in the same order, so that they agree up to the last bit of the arctangent.
"""

from __future__ import annotations

import math

import numpy as np

from ..base.arrays import frozen
from ..base.jit import inline, kernel

__all__ = ["PLANAR_QUALITIES", "planar_angles", "planar_edges", "planar_shapes"]

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


@kernel
def _edge_lengths(points, cells, neighbors, lengths, middles):
    """Write the length and midpoint of each edge; return how many there are, -1 if neighbors do not agree."""
    count = 0
    for t in range(cells.shape[0]):
        for k in range(3):
            s, a, b = neighbors[t, k], cells[t, (k + 1) % 3], cells[t, (k + 2) % 3]
            if s >= 0:
                mutual = False
                for j in range(3):
                    c, d = cells[s, (j + 1) % 3], cells[s, (j + 2) % 3]
                    if neighbors[s, j] == t and ((c == b and d == a) or (c == a and d == b)):
                        mutual = True
                if not mutual:
                    return -1
                if s < t:
                    continue
            x, y = points[a, 0] - points[b, 0], points[a, 1] - points[b, 1]
            lengths[count] = math.sqrt(x * x + y * y)
            middles[count, 0] = (points[a, 0] + points[b, 0]) / 2
            middles[count, 1] = (points[a, 1] + points[b, 1]) / 2
            count += 1
    return count


def planar_edges(
    points: np.ndarray, cells: np.ndarray, neighbors: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """The lengths (e,) and midpoints (e, 2) of the edges of triangles, each once, without sorting them.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
    cells, neighbors : ndarray of int32, shape (m, 3)

    Returns
    -------
    tuple of ndarray, or None
        In the order of the first triangle of each edge. None for another shape or type, and where neighbors
        are not mutual or not across their common edge.
    """
    if not _fit(points, cells) or neighbors.dtype != np.int32:
        return None
    lengths, middles = np.empty(3 * len(cells)), np.empty((3 * len(cells), 2))
    arrays = *_contiguous(points, cells), frozen(np.ascontiguousarray(neighbors))
    count = _edge_lengths(*arrays, lengths, middles)
    return None if count < 0 else (lengths[:count], middles[:count])


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
