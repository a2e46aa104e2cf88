"""Kernels of gift wrapping: the apex of a face, found in a k-d tree with a shrinking ball.

A face is a row of d + 1 vertices with one free slot k; its free side is where the row becomes positive
with an apex in the slot. All decisions are exact signs; floating point only leaves out boxes and points
that are certainly outside (bounds below).
"""

from __future__ import annotations

import numpy as np

from ...base.jit import inline, kernel
from ...geometry.kd_tree import beyond, distance2
from ...predicates.filters import EPS, TINY
from ...predicates.kernels import conflict, moved
from .front import admitted

__all__ = ["find_apex", "holds_vertex", "tie"]

NO_APEX, SEEN = -1, -2  # no vertex on the free side; some, but none is admitted


@kernel
def tie(points, rank, row, q):
    """In-sphere sign of q when cospherical points are moved infinitesimally; never 0.

    Lift v to |p_v|^2 + e(v), with e growing without bound from rank to rank. With barycentric coordinates
    c_v of q, the lifted q is sum c_v e(v) - e(q) below the hyperplane of the lifted row. The highest rank
    decides: q itself for outside, another vertex by the sign of its c_v, unless that is 0.
    """
    limit = np.int64(2**62)
    while True:
        top, corner = rank[q], -1
        for k in range(len(row)):
            if top < rank[row[k]] < limit:
                top, corner = rank[row[k]], k
        if corner < 0:
            return -1
        sign = moved(points, row, corner, q)
        if sign != 0:
            return sign
        limit = top


@inline
def normal_of(points, row, k, normal):
    """A normal towards the free side, and a bound for the error of normal . (x - a), |coordinates| <= 1.

    a is corner (k + 1) % (d + 1). The bound is 64 EPS times the sum of the absolute products: the
    differences, at most 2, the normal and the sum take fewer than 12 roundings each.
    """
    w = len(row)
    a, b = row[(k + 1) % w], row[(k + 2) % w]
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    if w == 3:
        normal[0], normal[1] = -uy, ux
        return 64 * EPS * (abs(ux) + abs(uy)) * 2.0 + TINY
    c = row[(k + 3) % w]
    vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    uz, vz = points[b, 2] - points[a, 2], points[c, 2] - points[a, 2]
    turn = 1.0 if k % 2 == 0 else -1.0  # (k + 1, k + 2, k + 3, k) is an odd permutation for even k
    normal[0], normal[1], normal[2] = (
        turn * (vy * uz - uy * vz),
        turn * (vz * ux - uz * vx),
        turn * (vx * uy - ux * vy),
    )
    total = abs(uy * vz) + abs(uz * vy) + abs(uz * vx) + abs(ux * vz) + abs(ux * vy) + abs(uy * vx)
    return 64 * EPS * total * 2.0 + TINY


@inline
def _center_of(points, row, center):
    """Write the circumcenter, roughly; return the determinant, and write nothing where it is not positive."""
    w = len(row)
    a = row[0]
    ux, uy = points[row[1], 0] - points[a, 0], points[row[1], 1] - points[a, 1]
    vx, vy = points[row[2], 0] - points[a, 0], points[row[2], 1] - points[a, 1]
    if w == 3:
        uu, vv = ux * ux + uy * uy, vx * vx + vy * vy
        det = ux * vy - uy * vx
        if det <= 0.0:
            return det
        center[0] = points[a, 0] + 0.5 * (vy * uu - uy * vv) / det
        center[1] = points[a, 1] + 0.5 * (ux * vv - vx * uu) / det
    else:
        uz, vz = points[row[1], 2] - points[a, 2], points[row[2], 2] - points[a, 2]
        wx, wy, wz = (
            points[row[3], 0] - points[a, 0],
            points[row[3], 1] - points[a, 1],
            points[row[3], 2] - points[a, 2],
        )
        uu, vv, ww = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
        px, py, pz = vy * wz - vz * wy, vz * wx - vx * wz, vx * wy - vy * wx
        det = ux * px + uy * py + uz * pz
        if det <= 0.0:
            return det
        qx, qy, qz = wy * uz - wz * uy, wz * ux - wx * uz, wx * uy - wy * ux
        rx, ry, rz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        center[0] = points[a, 0] + 0.5 * (uu * px + vv * qx + ww * rx) / det
        center[1] = points[a, 1] + 0.5 * (uu * py + vv * qy + ww * ry) / det
        center[2] = points[a, 2] + 0.5 * (uu * pz + vv * qz + ww * rz) / det
    return det


@inline
def ball_of(points, row, center):
    """Write a center; return r2 such that no point at a squared distance of more than r2 is inside.

    With g(x) = |x - center|^2, *any* center, and barycentric coordinates c_v(x), the power of x is
    g(x) - sum c_v g(v). Let m, s be the greatest g(v) and the spread: inside means
    g(x) < m + s sum |c_v|, and |c_v| <= 4 / height <= 4 L^(d-1) / det with the longest edge L. Where
    rounding may have spoiled det, r2 is infinite.
    """
    w = len(row)
    det = _center_of(points, row, center)
    if det <= 0.0:
        return np.inf
    longest2, largest, smallest = 0.0, 0.0, np.inf
    for i in range(w):
        g = 0.0
        for j in range(w - 1):
            g += (points[row[i], j] - center[j]) ** 2
        largest, smallest = max(largest, g), min(smallest, g)
        for k in range(i):
            edge2 = 0.0
            for j in range(w - 1):
                edge2 += (points[row[i], j] - points[row[k], j]) ** 2
            longest2 = max(longest2, edge2)
    full = longest2 if w == 3 else longest2 * np.sqrt(longest2)  # L^d
    det -= 64 * EPS * full + TINY
    if det <= 0.0:
        return np.inf
    spread = largest - smallest + 32 * EPS * largest
    return (
        largest * (1 + 64 * EPS)
        + spread * (8.0 * w / det) * (np.sqrt(longest2) if w == 3 else longest2)
        + TINY
    )


@kernel
def find_apex(points, rank, start, size, low, high, row, k, cells, obstacles, work):
    """The vertex for slot k of the row, or NO_APEX, or SEEN; ``obstacles``: open half-faces, or None.

    Depth first, the child nearer to the face first. A box is left out where it is wholly behind the face
    or outside the ball of the best vertex so far.
    """
    d = points.shape[1]
    stack, middle, normal, center = work
    a = row[(k + 1) % (d + 1)]
    slack = normal_of(points, row, k, normal)
    for i in range(d):
        middle[i] = 0.0
        for j in range(d + 1):
            if j != k:
                middle[i] += points[row[j], i] / d
    best, r2 = NO_APEX, np.inf
    top, stack[0] = 1, 0
    while top > 0:
        top -= 1
        node = stack[top]
        if beyond(low, high, node, normal, points[a]) < -slack or distance2(low, high, node, center) > r2 * (
            1 + 1e-14
        ):
            continue
        left = 2 * node + 1
        if left < len(start):
            nearer = distance2(low, high, left, middle) <= distance2(low, high, left + 1, middle)
            stack[top], stack[top + 1] = (left + 1, left) if nearer else (left, left + 1)
            top += 2
            continue
        for q in range(start[node], start[node] + size[node]):
            if best >= 0:
                g = 0.0
                for i in range(d):
                    g += (points[q, i] - center[i]) ** 2
                if g > r2 * (1 + 1e-14):
                    continue
            if q == best or moved(points, row, k, q) <= 0:
                continue
            if best >= 0:
                row[k] = best
                sign = conflict(points, row, q)
                if sign < 0 or (sign == 0 and tie(points, rank, row, q) < 0):
                    continue
            row[k] = q
            if obstacles is not None:
                if best == NO_APEX:
                    best = SEEN
                if not admitted(points, row, cells, obstacles) or holds_vertex(
                    points, start, size, low, high, row, stack, top
                ):
                    continue
            best = q
            r2 = ball_of(points, row, center)
    return best


@kernel
def holds_vertex(points, start, size, low, high, row, stack, top):
    """Does the closed cell hold a vertex other than its corners? (``stack`` is in use up to ``top``.)"""
    w = len(row)
    floor, stack[top] = top, 0
    top += 1
    while top > floor:
        top -= 1
        node = stack[top]
        apart = False
        for i in range(w - 1):
            least, most = np.inf, -np.inf
            for j in range(w):
                least, most = min(least, points[row[j], i]), max(most, points[row[j], i])
            apart = apart or low[node, i] > most or high[node, i] < least
        if apart:
            continue
        if 2 * node + 2 < len(start):
            stack[top], stack[top + 1] = 2 * node + 1, 2 * node + 2
            top += 2
            continue
        for q in range(start[node], start[node] + size[node]):
            corner, inside = False, True
            for j in range(w):
                corner = corner or q == row[j]
            j = 0
            while inside and not corner and j < w:
                inside = moved(points, row, j, q) >= 0
                j += 1
            if inside and not corner:
                return True
    return False
