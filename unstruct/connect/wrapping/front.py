"""Kernels: whether the open faces admit a new cell. Exact, in two and three dimensions.

An open half-face is a number h = cell * (d + 1) + k, the facet opposite corner k of the cell. A new cell is
admitted if no open face reaches into its interior and, in space, if no edge of an open face crosses one of
its edges (two triangles that overlap in a plane would never match).
"""

from __future__ import annotations

from ...base.jit import inline, kernel
from ...geometry.triangle_pairs import side
from ...predicates.kernels import moved, orient2

__all__ = ["admitted"]


@kernel
def segment_enters(points, row, p, q):
    """Whether the closed segment pq meets the open cell.

    Two convex sets, one of them open, are disjoint exactly when a plane separates them. Here this is the
    plane of a facet with both ends of the segment behind it, or a plane through the segment and a corner (in
    two dimensions, the line of the segment) with the cell on one side.
    """
    w = len(row)
    for k in range(w):
        if moved(points, row, k, p) <= 0 and moved(points, row, k, q) <= 0:
            return False
    for i in range(1 if w == 3 else 4):
        if w == 4 and (row[i] == p or row[i] == q):
            continue
        left, right = False, False
        for j in range(w):
            if w == 3:
                r = row[j]
                sign = orient2(
                    points[p, 0], points[p, 1], points[q, 0], points[q, 1], points[r, 0], points[r, 1]
                )
            else:
                sign = side(points, p, q, row[i], row[j])
            left, right = left or sign > 0, right or sign < 0
        if left != right:
            return False
    return True


@kernel
def covers(points, row, a, b, c):
    """Whether triangle abc contains the whole section of its plane with the open cell, which is not empty.

    This is called only if no side of the triangle meets the open cell. The section then lies completely
    inside or completely outside the triangle, and it lies inside exactly when all its corners are in the
    closed triangle.
    """
    above, below = -1, -1
    for i in range(4):
        sign = side(points, a, b, c, row[i])
        if sign > 0:
            above = i
        elif sign < 0:
            below = i
    if above < 0 or below < 0:
        return False
    for i in range(4):
        here = side(points, a, b, c, row[i])
        for j in range(i if here == 0 else i + 1, i + 1 if here == 0 else 4):
            # A line through the corner of the section: an edge of the cell, or from a corner to one above.
            end = row[above] if here == 0 else row[j]
            if here != 0 and here * side(points, a, b, c, end) >= 0:
                continue
            s = side(points, row[i], end, a, b)
            t = side(points, row[i], end, b, c)
            u = side(points, row[i], end, c, a)
            if not ((s >= 0 and t >= 0 and u >= 0) or (s <= 0 and t <= 0 and u <= 0)):
                return False
    return True


@kernel
def edges_cross(points, row, p, q):
    """Whether segment pq and an edge of the tetrahedron cross in the interiors of both."""
    for i in range(4):
        for j in range(i):
            u, v = row[i], row[j]
            if u == p or u == q or v == p or v == q or side(points, p, q, u, v) != 0:
                continue
            for k in range(4):  # a corner outside the common plane gives the orientations within it
                r = row[k]
                if k != i and k != j:
                    if side(points, u, v, p, r) * side(points, u, v, q, r) < 0:
                        if side(points, p, q, u, r) * side(points, p, q, v, r) < 0:
                            return True
    return False


@inline
def apart(points, row, cells, c, k):
    """Whether the boxes of the cell and of facet (c, k) are disjoint."""
    w = len(row)
    for i in range(w - 1):
        low, high = points[row[0], i], points[row[0], i]
        for j in range(1, w):
            low, high = min(low, points[row[j], i]), max(high, points[row[j], i])
        left, right = True, True
        for j in range(w):
            if j != k:
                x = points[cells[c, j], i]
                left, right = left and x < low, right and x > high
        if left or right:
            return True
    return False


@kernel
def admitted(points, row, cells, opened):
    """Whether all open half-faces admit the cell ``row``."""
    w = len(row)
    for index in range(len(opened)):
        c, skip = opened[index] // w, opened[index] % w
        if apart(points, row, cells, c, skip):
            continue
        a, b = cells[c, (skip + 1) % w], cells[c, (skip + 2) % w]
        if segment_enters(points, row, a, b):
            return False
        if w == 4:
            e = cells[c, (skip + 3) % w]
            if (
                segment_enters(points, row, b, e)
                or segment_enters(points, row, e, a)
                or covers(points, row, a, b, e)
            ):
                return False
            if (
                edges_cross(points, row, a, b)
                or edges_cross(points, row, b, e)
                or edges_cross(points, row, e, a)
            ):
                return False
    return True
