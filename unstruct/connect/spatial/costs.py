"""What a refill of a small cavity costs: faces in the way of a target, the worst shape, cells at a vertex."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, lean
from ...geometry.stretched import METRIC_COLUMNS, metric_badness
from .records import COST_KIND, GUARD_COUNT, LOCALS, NUMBERED, TARGET
from .signs import DISJOINT, in_order, meets, remembered_side

__all__ = [
    "ANY",
    "DEGREE",
    "EDGE",
    "FACE",
    "NEVER",
    "SHAPE",
    "UNSEEN",
    "Signs",
    "badness",
    "face_cost",
    "face_number",
    "local_sign",
    "packed_face",
    "tet_cost",
    "unpacked_face",
]

# What is summed over a refill (SHAPE: what is the largest in it).
ANY = 0  # nothing: any refill is as good as another
EDGE = 1  # faces that the segment TARGET meets
FACE = 2  # edges of faces that meet the triangle TARGET
SHAPE = 3  # the badness of the worst tetrahedron
DEGREE = 4  # tetrahedra at the vertex TARGET; other faces must not meet the segment of the two next entries
NEVER = 1e300  # more than any cost
UNSEEN = 2  # a sign that is not known yet


@inline
def face_number(n, x, y, z):
    """The number of the oriented face x, y, z: the same for y, z, x."""
    if x < y and x < z:
        return (x * n + y) * n + z
    if y < z:
        return (y * n + z) * n + x
    return (z * n + x) * n + y


@inline
def packed_face(n, x, y, z):
    """The number of an oriented face in the lowest twelve bits, then its vertices, the least first.

    To take a number apart needs divisions: they took a tenth of the time of a search.
    """
    if x < y and x < z:
        a, b, c = x, y, z
    elif y < z:
        a, b, c = y, z, x
    else:
        a, b, c = z, x, y
    return ((a * n + b) * n + c) | a << 12 | b << 16 | c << 20


@inline
def unpacked_face(packed):
    """Number and vertices of a face."""
    return packed & 4095, packed >> 12 & 15, packed >> 16 & 15, packed >> 20


@apart
def _fill_sign(xyz, label, memo, sign, at, packed):
    """Write the sign of these vertices, four bits each, to its place in the table."""
    a, b, c, d = label[packed >> 12], label[packed >> 8 & 15], label[packed >> 4 & 15], label[packed & 15]
    sign[at] = remembered_side(xyz, memo, a, b, c, d)


@inline
def local_sign(xyz, r, a, b, c, d):
    """Orientation of four local vertices, from the table if it is there."""
    m = r.size[NUMBERED]
    a, b, c, d, sign = in_order(a, b, c, d)
    at = ((a * m + b) * m + c) * m + d
    if r.sign[at] == UNSEEN:
        _fill_sign(xyz, r.label, r.memo, r.sign, at, a << 12 | b << 8 | c << 4 | d)
    return sign * r.sign[at]


class Signs(NamedTuple):
    """The arrays of a `Local` that signs need: a call with all of them copies two hundred numbers."""

    label: NDArray[np.int32]
    memo: NDArray[np.int32]
    sign: NDArray[np.int8]
    size: NDArray[np.int64]


class Costs(NamedTuple):
    """The arrays of a `Local` that costs need."""

    label: NDArray[np.int32]
    memo: NDArray[np.int32]
    sign: NDArray[np.int8]
    size: NDArray[np.int64]
    goal: NDArray[np.int64]
    guard: NDArray[np.int32]
    edge: NDArray[np.int8]
    cost: NDArray[np.float64]
    judged: NDArray[np.int32]
    costly: NDArray[np.int32]
    barred: NDArray[np.int32]


@apart
def _in_the_way(xyz, r, a, b, u, v, w):
    """Whether the open segment ab meets the closed triangle uvw, all local: `meets` by the table of signs."""
    label = r.label
    s = o = y = z = -1
    if a == u or a == v or a == w:
        s, o = a, b
    if b == u or b == v or b == w:
        if s >= 0:
            return False
        s, o = b, a
    if s >= 0:
        y, z = (v, w) if s == u else ((w, u) if s == v else (u, v))
        if local_sign(xyz, r, s, y, z, o) != 0:
            return False
        return meets(xyz, label[a], label[b], label[u], label[v], label[w]) != DISJOINT
    above, below = local_sign(xyz, r, u, v, w, a), local_sign(xyz, r, u, v, w, b)
    if above == 0 and below == 0:
        return meets(xyz, label[a], label[b], label[u], label[v], label[w]) != DISJOINT
    if above * below >= 0:
        return False
    first, second = local_sign(xyz, r, a, b, u, v), local_sign(xyz, r, a, b, v, w)
    if first * second < 0:
        return False
    third = local_sign(xyz, r, a, b, w, u)
    return not min(first, second, third) < 0 < max(first, second, third)


@lean
def _edge_cost(xyz, r, i, j):
    """1 if the edge between local vertices meets the triangle that is sought, otherwise 0."""
    at = min(i, j) * r.size[LOCALS] + max(i, j)
    known = r.edge[at] >> 1 & 3
    if known == 0:
        goal = r.goal
        signs = Signs(r.label, r.memo, r.sign, r.size)
        known = 2 if _in_the_way(xyz, signs, i, j, goal[0], goal[1], goal[2]) else 1
        r.edge[at] |= known << 1
    return known - 1


@apart
def _fill_cost(xyz, r, packed):
    """Write what a face costs."""
    n, kind = r.size[LOCALS], r.size[COST_KIND]
    at, x, y, z = unpacked_face(packed)
    cost, signs = 0.0, Signs(r.label, r.memo, r.sign, r.size)
    if kind == EDGE:
        cost = 1.0 if _in_the_way(xyz, signs, r.goal[0], r.goal[1], x, y, z) else 0.0
    elif kind == FACE:
        cost = float(_edge_cost(xyz, r, x, y) + _edge_cost(xyz, r, y, z) + _edge_cost(xyz, r, z, x))
    elif kind == DEGREE and r.size[TARGET + 1] >= 0:
        p = r.goal[0]  # what is between the segment and the point on it is not in the way
        if x != p and y != p and z != p and _in_the_way(xyz, signs, r.goal[1], r.goal[2], x, y, z):
            cost = NEVER
    for i in range(r.size[GUARD_COUNT]):
        if _in_the_way(xyz, signs, r.guard[i, 0], r.guard[i, 1], x, y, z):
            cost = NEVER
            break
    r.cost[at] = cost
    for k in range(3):
        a, b, c = (x, y, z) if k == 0 else ((y, z, x) if k == 1 else (z, x, y))
        for pair in (a * n + b, b * n + a):
            r.judged[pair] |= 1 << c
            if cost > 0.0:
                r.costly[pair] |= 1 << c
            if cost >= NEVER:
                r.barred[pair] |= 1 << c


@inline
def face_cost(xyz, r, x, y, z):
    """What the face costs: NEVER if an edge that must stay meets it."""
    low, high = min(x, y, z), max(x, y, z)
    n = r.size[LOCALS]
    middle = x + y + z - low - high
    at = (low * n + middle) * n + high
    if r.cost[at] < 0:
        costs = Costs(
            r.label, r.memo, r.sign, r.size, r.goal, r.guard, r.edge, r.cost, r.judged, r.costly, r.barred
        )
        _fill_cost(xyz, costs, at | low << 12 | middle << 16 | high << 20)
    return r.cost[at]


@apart
def badness(xyz, a, b, c, d):
    """From 0 for a regular tetrahedron to 1 for a flat one: 1 - 6 sqrt(2) volume / (mean square edge)^1.5.

    If the vertices carry a metric (`geometry.stretched`), in this.
    """
    if xyz.shape[1] == METRIC_COLUMNS:
        return metric_badness(xyz, a, b, c, d)
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    wx, wy, wz = xyz[d, 0] - xyz[a, 0], xyz[d, 1] - xyz[a, 1], xyz[d, 2] - xyz[a, 2]
    six = ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx)
    total = ux * ux + uy * uy + uz * uz + vx * vx + vy * vy + vz * vz + wx * wx + wy * wy + wz * wz
    total += (ux - vx) ** 2 + (uy - vy) ** 2 + (uz - vz) ** 2
    total += (vx - wx) ** 2 + (vy - wy) ** 2 + (vz - wz) ** 2
    total += (wx - ux) ** 2 + (wy - uy) ** 2 + (wz - uz) ** 2
    mean = total / 6.0
    cube = mean * np.sqrt(mean)
    return 1.0 if cube <= 0.0 else 1.0 - np.sqrt(2.0) * six / cube  # it may vanish by underflow


@inline
def tet_cost(xyz, r, a, b, c, d):
    """What the tetrahedron on local vertices costs beside its faces."""
    kind, label = r.size[COST_KIND], r.label
    if kind == SHAPE:
        return badness(xyz, label[a], label[b], label[c], label[d])
    if kind == DEGREE:
        p = r.size[TARGET]
        return 1.0 if label[a] == p or label[b] == p or label[c] == p or label[d] == p else 0.0
    return 0.0
