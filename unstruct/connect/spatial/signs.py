"""Whether segments and triangles meet, by exact signs.

`side` is compiled once and called from everywhere: inlined into each kernel, the filter alone would cost
half a minute of compiling.
"""

from __future__ import annotations

from ...base.jit import apart, inline
from ...geometry.triangle_pairs import side
from ...predicates.filters import UNDECIDED, filter_orient3
from ...predicates.kernels import orient2

__all__ = ["COPLANAR", "DISJOINT", "INSIDE", "ON_EDGE", "in_order", "meets", "remembered_side", "side"]

DISJOINT = 0  # the open segment does not meet the closed triangle
INSIDE = 1  # it crosses the interior
ON_EDGE = 2  # it crosses one edge, from one side of the plane to the other
COPLANAR = 3  # it lies in the plane of the triangle, or goes through a vertex


@inline
def in_order(a, b, c, d):
    """Four numbers in increasing order, and the sign of the permutation."""
    sign = 1
    if a > b:
        a, b, sign = b, a, -sign
    if c > d:
        c, d, sign = d, c, -sign
    if a > c:
        a, c, sign = c, a, -sign
    if b > d:
        b, d, sign = d, b, -sign
    if b > c:
        b, c, sign = c, b, -sign
    return a, b, c, d, sign


@apart
def remembered_side(xyz, memo, a, b, c, d):
    """`side`, where what the filter leaves open is remembered: rows of four vertices and the sign.

    Vertices of facets that are planar up to rounding make most searches ask for the same exact signs.
    """
    quick = filter_orient3(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2],
        xyz[c, 0], xyz[c, 1], xyz[c, 2], xyz[d, 0], xyz[d, 1], xyz[d, 2],
    )  # fmt: skip
    if quick != UNDECIDED:
        return quick
    a, b, c, d, sign = in_order(a, b, c, d)
    at = (a * 73 + b * 1201 + c * 19_937 + d * 331_777) & (memo.shape[0] - 1)
    if memo[at, 0] != a or memo[at, 1] != b or memo[at, 2] != c or memo[at, 3] != d:
        memo[at, 4] = side(xyz, a, b, c, d)
        memo[at, 0], memo[at, 1], memo[at, 2], memo[at, 3] = a, b, c, d
    return sign * memo[at, 4]


@apart
def turn(xyz, axis, a, b, c):
    """Orientation of a, b, c as seen along an axis."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    return orient2(xyz[a, i], xyz[a, j], xyz[b, i], xyz[b, j], xyz[c, i], xyz[c, j])


@apart
def _axis(xyz, u, v, w):
    """An axis along which u, v, w are not seen on a line; 3 if they are on a line."""
    axis = 0
    while axis < 3 and turn(xyz, axis, u, v, w) == 0:
        axis += 1
    return axis


@apart
def _in_angle(xyz, s, o, y, z):
    """Whether the segment from s to o enters the triangle s, y, z."""
    if side(xyz, s, y, z, o) != 0:
        return DISJOINT
    axis = _axis(xyz, s, y, z)
    if axis == 3:
        return COPLANAR
    t = turn(xyz, axis, s, y, z)
    return COPLANAR if turn(xyz, axis, s, y, o) * t >= 0 and turn(xyz, axis, s, z, o) * t <= 0 else DISJOINT


@apart
def _cross(xyz, axis, a, b, p, q):
    """Whether the open segment ab meets the closed segment pq, in a plane."""
    p_side, q_side = turn(xyz, axis, a, b, p), turn(xyz, axis, a, b, q)
    a_side, b_side = turn(xyz, axis, p, q, a), turn(xyz, axis, p, q, b)
    if p_side == 0 and q_side == 0:  # on a line
        for k in range(3):
            low, high = min(xyz[a, k], xyz[b, k]), max(xyz[a, k], xyz[b, k])
            if low < high and (max(xyz[p, k], xyz[q, k]) <= low or min(xyz[p, k], xyz[q, k]) >= high):
                return False
        return True
    return p_side * q_side <= 0 and a_side * b_side < 0


@apart
def meets(xyz, a, b, u, v, w):
    """How the open segment ab meets the closed triangle uvw; DISJOINT also if ab is an edge of it."""
    s = o = y = z = -1
    if a == u or a == v or a == w:
        s, o = a, b
    if b == u or b == v or b == w:
        if s >= 0:
            return DISJOINT
        s, o = b, a
    if s >= 0:
        y, z = (v, w) if s == u else ((w, u) if s == v else (u, v))
        return _in_angle(xyz, s, o, y, z)
    above, below = side(xyz, u, v, w, a), side(xyz, u, v, w, b)
    if above * below > 0:
        return DISJOINT
    if above == 0 and below == 0:
        axis = _axis(xyz, u, v, w)
        if axis == 3:
            return COPLANAR
        crosses = (
            _cross(xyz, axis, a, b, u, v) or _cross(xyz, axis, a, b, v, w) or _cross(xyz, axis, a, b, w, u)
        )
        return COPLANAR if crosses else DISJOINT
    if above == 0 or below == 0:  # the plane meets the open segment nowhere
        return DISJOINT
    first, second, third = side(xyz, a, b, u, v), side(xyz, a, b, v, w), side(xyz, a, b, w, u)
    if min(first, second, third) < 0 < max(first, second, third):
        return DISJOINT
    zeros = (first == 0) + (second == 0) + (third == 0)
    return INSIDE if zeros == 0 else (ON_EDGE if zeros == 1 else COPLANAR)
