"""The nearest triangle in space of each of many points, by a tree of boxes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_points
from ..base.jit import apart, inline, kernel
from ..predicates.batch import power_of_two
from .boxes import BOXES_IN_LEAF, BoxTree, bounding_boxes, square_to_box

__all__ = ["TriangleTree", "onto", "square_to_triangle"]

Array = NDArray[np.float64]
THIN_SQUARED = 1e-3  # the squared sine of an angle of two degrees
DEEPEST_SEARCH = 128  # nodes that wait; a tree of boxes is never half as deep


@apart
def _onto_edge(p, corner, i, j, place):
    """Write the weights of the point of an edge that is nearest to p; returns the squared distance."""
    along = square = 0.0
    for m in range(3):
        side = corner[j, m] - corner[i, m]
        along += side * (p[m] - corner[i, m])
        square += side * side
    t = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    place[0] = place[1] = place[2] = 0.0
    place[i], place[j] = 1.0 - t, t
    total = 0.0
    for m in range(3):
        total += (p[m] - corner[i, m] - t * (corner[j, m] - corner[i, m])) ** 2
    return total


@apart
def _refined(p, corner, n, place):
    """Add to weights what is missing from their point to p in the plane; n is the normal by its square."""
    ux, uy, uz = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
    vx, vy, vz = corner[2, 0] - corner[0, 0], corner[2, 1] - corner[0, 1], corner[2, 2] - corner[0, 2]
    rx = p[0] - corner[0, 0] - place[1] * ux - place[2] * vx
    ry = p[1] - corner[0, 1] - place[1] * uy - place[2] * vy
    rz = p[2] - corner[0, 2] - place[1] * uz - place[2] * vz
    place[1] += n[0] * (ry * vz - rz * vy) + n[1] * (rz * vx - rx * vz) + n[2] * (rx * vy - ry * vx)
    place[2] += n[0] * (uy * rz - uz * ry) + n[1] * (uz * rx - ux * rz) + n[2] * (ux * ry - uy * rx)
    place[0] = 1.0 - place[1] - place[2]


@apart
def onto(p, corner, place):
    """Write the weights of the point of a triangle that is nearest to p; returns the squared distance."""
    ux, uy, uz = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
    vx, vy, vz = corner[2, 0] - corner[0, 0], corner[2, 1] - corner[0, 1], corner[2, 2] - corner[0, 2]
    wx, wy, wz = p[0] - corner[0, 0], p[1] - corner[0, 1], p[2] - corner[0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    if square > 0.0:
        one = nx * (wy * vz - wz * vy) + ny * (wz * vx - wx * vz) + nz * (wx * vy - wy * vx)
        two = nx * (uy * wz - uz * wy) + ny * (uz * wx - ux * wz) + nz * (ux * wy - uy * wx)
        if one >= 0.0 and two >= 0.0 and one + two <= square:
            place[1], place[2] = one / square, two / square
            place[0] = max(0.0, 1.0 - place[1] - place[2])
            height = wx * nx + wy * ny + wz * nz
            thin = THIN_SQUARED * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz)
            if square > thin:
                return height * height / square
            # The weights in a thin triangle are rounded badly: what they lack is found in the same way, which
            # may be below zero. A place on a side may be better still.
            _refined(p, corner, (nx / square, ny / square, nz / square), place)
            if min(place[0], min(place[1], place[2])) >= 0.0:
                inner, keep_1, keep_2 = 0.0, place[1], place[2]
                for m in range(3):
                    away = p[m] - place[0] * corner[0, m] - place[1] * corner[1, m] - place[2] * corner[2, m]
                    inner += away * away
                for i in range(3):
                    away = _onto_edge(p, corner, i, (i + 1) % 3, place)
                    if away <= inner:
                        return away
                place[0], place[1], place[2] = max(0.0, 1.0 - keep_1 - keep_2), keep_1, keep_2
                return inner
    k = 0
    best = _onto_edge(p, corner, 0, 1, place)
    for i in range(1, 3):
        away = _onto_edge(p, corner, i, (i + 1) % 3, place)
        if away < best:
            best, k = away, i
    return _onto_edge(p, corner, k, (k + 1) % 3, place)


@inline
def _square_to_side(x, y, z, c, t, i, j):
    """As `_onto_edge`, without the place."""
    ux, uy, uz = c[t, j, 0] - c[t, i, 0], c[t, j, 1] - c[t, i, 1], c[t, j, 2] - c[t, i, 2]
    wx, wy, wz = x - c[t, i, 0], y - c[t, i, 1], z - c[t, i, 2]
    square = ux * ux + uy * uy + uz * uz
    along = ux * wx + uy * wy + uz * wz
    s = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    return (wx - s * ux) ** 2 + (wy - s * uy) ** 2 + (wz - s * uz) ** 2


@inline
def square_to_triangle(x, y, z, c, t):
    """The squared distance of a point from triangle t: as `onto`, or a little less if it is thin."""
    ux, uy, uz = c[t, 1, 0] - c[t, 0, 0], c[t, 1, 1] - c[t, 0, 1], c[t, 1, 2] - c[t, 0, 2]
    vx, vy, vz = c[t, 2, 0] - c[t, 0, 0], c[t, 2, 1] - c[t, 0, 1], c[t, 2, 2] - c[t, 0, 2]
    wx, wy, wz = x - c[t, 0, 0], y - c[t, 0, 1], z - c[t, 0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    inner = np.inf
    if square > 0.0:
        one = nx * (wy * vz - wz * vy) + ny * (wz * vx - wx * vz) + nz * (wx * vy - wy * vx)
        two = nx * (uy * wz - uz * wy) + ny * (uz * wx - ux * wz) + nz * (ux * wy - uy * wx)
        if one >= 0.0 and two >= 0.0 and one + two <= square:
            thin = THIN_SQUARED * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz)
            if square > thin:
                height = wx * nx + wy * ny + wz * nz
                return height * height / square
            p, q = one / square, two / square
            o = 1.0 - p - q
            ex = x - o * c[t, 0, 0] - p * c[t, 1, 0] - q * c[t, 2, 0]
            ey = y - o * c[t, 0, 1] - p * c[t, 1, 1] - q * c[t, 2, 1]
            ez = z - o * c[t, 0, 2] - p * c[t, 1, 2] - q * c[t, 2, 2]
            inner = ex * ex + ey * ey + ez * ez
    inner = min(inner, _square_to_side(x, y, z, c, t, 0, 1))
    inner = min(inner, _square_to_side(x, y, z, c, t, 1, 2))
    return min(inner, _square_to_side(x, y, z, c, t, 2, 0))


@kernel
def _search(x, low, high, order, corners, which, places):
    """Write the nearest triangle of each point, and where on it; the node that is nearer is visited first."""
    leaves = low.shape[0] // 2
    stack = np.empty(DEEPEST_SEARCH, dtype=np.int64)
    place = np.empty(3)
    for q in range(x.shape[0]):
        px, py, pz, best = x[q, 0], x[q, 1], x[q, 2], np.inf
        if q > 0:  # a good bound from the beginning: the triangle of the point before
            best = onto(x[q], corners[which[q - 1]], place)
            which[q] = which[q - 1]
            places[q, 0], places[q, 1], places[q, 2] = place[0], place[1], place[2]
        stack[0], size = 1, 1
        while size > 0:
            size -= 1
            w = stack[size]
            if square_to_box(px, py, pz, low, high, w) >= best:
                continue
            if w >= leaves:
                first = (w - leaves) * BOXES_IN_LEAF
                for k in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                    if square_to_triangle(px, py, pz, corners, order[k]) >= best:
                        continue
                    square = onto(x[q], corners[order[k]], place)
                    if square < best:
                        best, which[q] = square, order[k]
                        places[q, 0], places[q, 1], places[q, 2] = place[0], place[1], place[2]
                continue
            one, two = 2 * w, 2 * w + 1
            nearer = square_to_box(px, py, pz, low, high, one) < square_to_box(px, py, pz, low, high, two)
            if nearer:
                one, two = two, one
            stack[size], stack[size + 1] = one, two
            size += 2


class TriangleTree:
    """A static tree over triangles in space.

    Parameters
    ----------
    corners : array_like, shape (m, 3, 3)
        At least one triangle; they may be flat.
    """

    def __init__(self, corners: ArrayLike):
        array = np.asarray(corners, dtype=np.float64)
        self.factor = power_of_two(array.reshape(-1, 3))
        self._corners = np.ascontiguousarray(array * self.factor)
        self._tree = BoxTree(*bounding_boxes(self._corners))

    def nearest(self, x: ArrayLike) -> tuple[NDArray[np.int64], Array]:
        """The nearest triangle of each point (k, 3), and the weights of its corners in the nearest point.

        O(log m) for each point, if it is near, and more quickly if successive points are close.
        """
        points = np.ascontiguousarray(as_points(x, "x") * self.factor)
        which, places = np.zeros(len(points), dtype=np.int64), np.zeros((len(points), 3))
        tree = self._tree
        _search(points, tree.low, tree.high, tree.order, self._corners, which, places)
        return which, places
