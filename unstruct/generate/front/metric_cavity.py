"""Cavities in a metric, compiled: what is measured goes through the metric, what decides topology is exact.

A metric at a place is a linear map (p, q, r) of the plane, `sizing.metric_table.root_at`: after it lengths
and circles are those of the plane. The map is rounded, and so is the test whether a point X lies in the
circle of a triangle. Therefore the cavity of X is not found by circles alone: it begins with the triangle
that contains X, and grows across an edge ab to the apex c only if X lies strictly to the left of ac and of
cb, exactly. Then c lies strictly between the rays from X through a and b. So the cavity stays star-shaped
about X, no triangle is met twice, and the star of X is a valid triangulation, whatever the metric is.

                c
              / | \\           ab is an edge of the boundary of the cavity, X on its left.
             /  |  \\          After growing, ac and cb take its place.
            b---+---a
             \\     /
                X             Source: Book, 3.3.

**Why this ends.** A point is placed only if the boundary of its cavity is at least `ROOM_AROUND` away, in the
metric at the point. The interior of a cavity contains no vertex, hence neither does the metric circle of this
radius about the new point, whatever the circles of the triangles around it are like. If h is the smallest
length that the table of the metric has, all points are at least `ROOM_AROUND` h from each other in the plane,
so that there is room for finitely many. (Distances to the vertices that it is joined to would not do: the
triangles beyond are not Delaunay in this metric, so a nearer vertex may be behind an edge.)
"""

from __future__ import annotations

import numpy as np

from ...base.codes import INSERTED, OUTSIDE, ROUNDED
from ...base.jit import inline, lean
from ...connect.insertion.halfedges import end_of, next_edge, prev_edge, start_of
from ...predicates.kernels import orient2

WALK = 1000  # triangles on the way to a point; a longer way is given up
ROOM_AROUND = 0.05  # no point nearer than that to the boundary of its cavity


@inline
def mapped(m, x, y):
    """The image of a vector under the map of a metric."""
    return m[0] * x + m[1] * y, m[1] * x + m[2] * y


@inline
def scale_of(m):
    """By how much the map multiplies areas: the inverse of the product of both lengths."""
    return m[0] * m[2] - m[1] * m[1]


@inline
def unmapped(m, x, y):
    """The vector with this image."""
    det = scale_of(m)
    return (m[2] * x - m[1] * y) / det, (m[0] * y - m[1] * x) / det


@inline
def square_of(m, x, y):
    """The squared metric length of a vector."""
    u, v = m[0] * x + m[1] * y, m[1] * x + m[2] * y
    return u * u + v * v


@inline
def within(m, xy, a, b, c, x, y):
    """Whether (x, y) lies inside the metric circle of the counterclockwise triangle abc, up to rounding."""
    ax, ay = mapped(m, xy[a, 0] - x, xy[a, 1] - y)
    bx, by = mapped(m, xy[b, 0] - x, xy[b, 1] - y)
    cx, cy = mapped(m, xy[c, 0] - x, xy[c, 1] - y)
    return (
        (ax * ax + ay * ay) * (bx * cy - by * cx)
        + (bx * bx + by * by) * (cx * ay - cy * ax)
        + (cx * cx + cy * cy) * (ax * by - ay * bx)
    ) > 0.0


@lean
def walk_inside(plane, t, x, y):
    """The triangle that contains (x, y), reached from triangle t without crossing a marked edge: (t, edge).

    ``edge`` is the half-edge on which the point lies, -1 if it is inside. t is -1 if the walk comes to a
    marked edge that has the point beyond it or on it, to a vertex at the point, or takes too long.
    """
    xy, vertex, twin, mark = plane.xy, plane.vertex, plane.twin, plane.mark
    turn = 12345
    for _ in range(WALK):
        turn = (turn * 1103515245 + 12345) % 2147483648
        first = (turn >> 16) % 3
        on, zeros, beyond = np.int64(-1), 0, np.int64(-1)
        for i in range(3):
            e = 3 * t + (first + i) % 3
            a, b = start_of(vertex, e), end_of(vertex, e)
            side = orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], x, y)
            if side < 0 and (beyond < 0 or mark[beyond] >= 0):
                beyond = np.int64(e)
            elif side == 0:
                on, zeros = np.int64(e), zeros + 1
        if beyond < 0:
            if zeros > 1 or (zeros == 1 and mark[on] >= 0):
                return np.int64(-1), on
            return np.int64(t), on
        if mark[beyond] >= 0:
            return np.int64(-1), on
        t = np.int64(twin[beyond] // 3)
    return np.int64(-1), np.int64(-1)


@lean
def find_metric_cavity(plane, scratch, m, t, on, x, y):
    """The cavity of (x, y) in the metric m, from triangle t that contains it: as `find_cavity`.

    ``on`` is the half-edge of t on which the point lies, -1 if it is inside.
    """
    xy, vertex, twin, mark = plane.xy, plane.vertex, plane.twin, plane.mark
    stack, cells, rim = scratch.stack, scratch.cells, scratch.rim
    cells[0] = t
    stack[0], stack[1], stack[2] = 3 * t + 2, 3 * t + 1, 3 * t
    depth, count, k = 3, np.int64(1), np.int64(0)
    while depth > 0:
        depth -= 1
        e = np.int64(stack[depth])
        if mark[e] < 0:
            o = np.int64(twin[e])
            a, b, c = start_of(vertex, e), end_of(vertex, e), vertex[o]
            if c >= 0 and (
                e == on
                or (
                    within(m, xy, c, b, a, x, y)
                    and orient2(xy[a, 0], xy[a, 1], xy[c, 0], xy[c, 1], x, y) > 0
                    and orient2(xy[c, 0], xy[c, 1], xy[b, 0], xy[b, 1], x, y) > 0
                )
            ):
                cells[count] = o // 3
                count += 1
                stack[depth], stack[depth + 1] = prev_edge(o), next_edge(o)
                depth += 2
                continue
        rim[k] = e
        k += 1
    return count, k


@inline
def is_close(sx, sy, vx, vy):
    """Whether the segment between two points of the mapped plane is nearer to 0 than `ROOM_AROUND`."""
    wx, wy = vx - sx, vy - sy
    square, along, cross = wx * wx + wy * wy, sx * wx + sy * wy, sx * vy - sy * vx
    if along >= 0.0 or along <= -square:  # an end is the nearest point
        return min(sx * sx + sy * sy, vx * vx + vy * vy) < ROOM_AROUND * ROOM_AROUND
    return cross * cross < ROOM_AROUND * ROOM_AROUND * square


@inline
def judge_in_metric(plane, rim, k, e, m, point, clearance):
    """What may speak against joining a point to the boundary of its cavity, measured in the metric.

    Returns the nearest vertex, apart from the ends of e, that is nearer than ``clearance`` (or -1); whether
    the point sees a marked edge under 120 degrees or more, or is too near to any edge of the boundary; and
    whether e belongs to the boundary (or is -1).
    """
    xy, vertex, mark = plane.xy, plane.vertex, plane.mark
    x, y = point
    a, b = (start_of(vertex, e), end_of(vertex, e)) if e >= 0 else (np.int64(-1), np.int64(-1))
    nearest, near = np.int64(-1), clearance * clearance
    flat, seen = False, e < 0
    for i in range(k):
        g = np.int64(rim[i])
        s, v = start_of(vertex, g), end_of(vertex, g)
        sx, sy = mapped(m, xy[s, 0] - x, xy[s, 1] - y)
        square = sx * sx + sy * sy
        if square < near and s != a and s != b:
            nearest, near = np.int64(s), square
        seen = seen or g == e
        vx, vy = mapped(m, xy[v, 0] - x, xy[v, 1] - y)
        flat = flat or is_close(sx, sy, vx, vy)
        if mark[g] >= 0 and g != e:
            dot = sx * vx + sy * vy
            flat = flat or (dot < 0.0 and 4.0 * dot * dot >= square * (vx * vx + vy * vy))
    return nearest, flat, seen


@inline
def attempt_in_metric(plane, scratch, t, e, m, point, clearance):
    """Find and judge the cavity of a point: (outcome, cells, k, the vertex that is too near).

    The search for the point begins at triangle t; the half-edge e must be on the boundary of its cavity,
    unless it is -1. Outcomes: INSERTED, OUTSIDE (the point is hidden), ROUNDED (it sees a marked edge under
    120 degrees or more, or it has a vertex or an edge that is too near).
    """
    t, on = walk_inside(plane, t, point[0], point[1])
    if t < 0:
        return OUTSIDE, np.int64(0), np.int64(0), np.int64(-1)
    count, k = find_metric_cavity(plane, scratch, m, t, on, point[0], point[1])
    nearest, flat, seen = judge_in_metric(plane, scratch.rim, k, e, m, point, clearance)
    if nearest >= 0 or flat:
        return ROUNDED, count, k, nearest
    return INSERTED if seen else OUTSIDE, count, k, nearest
