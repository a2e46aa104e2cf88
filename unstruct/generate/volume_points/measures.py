"""Circumcenters and shapes of cells and faces in floating point, and what is encroached upon.

Nothing here decides topology: rounding may put a point a little off, or divide something a little too early.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline
from ...connect.spatial.cavity import corner
from .limits import BY_FIELD, BY_MEASURE, BY_QUALITY, BY_RADIUS, wanted_in_space
from .narrow import across_gap
from .sharp import feature_of, meet_sharply

__all__ = [
    "across_input",
    "cell_center",
    "encroaches_edge",
    "encroaches_face",
    "face_center",
    "face_size",
    "judge_cell",
]

TAN_30 = 3.0**-0.5
CLOSED_BALL = 1.0 - 1e-12  # of a squared radius: points on a sphere, up to rounding, are not in it


@inline
def _cross(a1, a2, a3, b1, b2, b3):
    return a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1


@apart
def cell_center(xyz, vertex, t, out):
    """Write the circumcenter of cell t; returns its squared circumradius and squared shortest edge.

    The radius is inf where rounding leaves nothing of it.
    """
    a, b, c, d = vertex[4 * t], vertex[4 * t + 1], vertex[4 * t + 2], vertex[4 * t + 3]
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    wx, wy, wz = xyz[d, 0] - xyz[a, 0], xyz[d, 1] - xyz[a, 1], xyz[d, 2] - xyz[a, 2]
    uu, vv, ww = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
    px, py, pz = _cross(vx, vy, vz, wx, wy, wz)
    qx, qy, qz = _cross(wx, wy, wz, ux, uy, uz)
    rx, ry, rz = _cross(ux, uy, uz, vx, vy, vz)
    six = ux * px + uy * py + uz * pz
    e1 = (ux - vx) ** 2 + (uy - vy) ** 2 + (uz - vz) ** 2
    e2 = (vx - wx) ** 2 + (vy - wy) ** 2 + (vz - wz) ** 2
    e3 = (wx - ux) ** 2 + (wy - uy) ** 2 + (wz - uz) ** 2
    shortest = min(min(min(uu, vv), min(ww, e1)), min(e2, e3))
    if not six > 0.0:
        return np.inf, shortest, 0.0
    x = (uu * px + vv * qx + ww * rx) / (2.0 * six)
    y = (uu * py + vv * qy + ww * ry) / (2.0 * six)
    z = (uu * pz + vv * qz + ww * rz) / (2.0 * six)
    out[0], out[1], out[2] = xyz[a, 0] + x, xyz[a, 1] + y, xyz[a, 2] + z
    return x * x + y * y + z * z, shortest, six


@apart
def sharpest(xyz, vertex, t, out):
    """The largest cosine of a dihedral angle of cell t; uses ``out[6:18]``."""
    for k in range(4):
        a, b, c = vertex[4 * t + corner(k, 0)], vertex[4 * t + corner(k, 1)], vertex[4 * t + corner(k, 2)]
        x, y, z = _cross(
            xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2],
            xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2],
        )  # fmt: skip
        length = max(np.sqrt(x * x + y * y + z * z), 1e-300)
        out[6 + 3 * k], out[7 + 3 * k], out[8 + 3 * k] = x / length, y / length, z / length
    best = -1.0
    for k in range(1, 4):
        for j in range(k):
            dot = 0.0
            for i in range(3):
                dot += out[6 + 3 * k + i] * out[6 + 3 * j + i]
            best = max(best, -dot)
    return best


@apart
def judge_cell(solid, limits, t, out):
    """Write the circumcenter of cell t; why it is bad (bits, 0 for not at all), and how bad.

    Returns bits, the worst quotient of a measure and its limit, and the squared circumradius; the squared
    shortest edge goes to ``out[18]``. A sliver that is not bad otherwise has the quotient 1/2.
    """
    r = solid.region[t]
    if r < 0:
        return 0, 0.0, 0.0
    square, shortest, six = cell_center(solid.xyz, solid.vertex, t, out)
    x = y = z = 0.0
    if limits.first[r] >= 0:
        for k in range(4):
            v = solid.vertex[4 * t + k]
            x, y, z = x + 0.25 * solid.xyz[v, 0], y + 0.25 * solid.xyz[v, 1], z + 0.25 * solid.xyz[v, 2]
    h = wanted_in_space(limits, r, x, y, z)
    cause, worst = 0, 0.0
    quotient = square / (limits.reach2 * h * h)
    if quotient > 1.0:
        cause, worst = cause | BY_MEASURE, quotient
    if six > limits.volume[r]:
        cause, worst = cause | BY_MEASURE, max(worst, six / limits.volume[r])
    quotient = square / (shortest * limits.ratio2)
    if quotient > 1.0:
        cause, worst = cause | BY_QUALITY, max(worst, quotient)
    if limits.sliver < 1.0 and cause == 0 and sharpest(solid.xyz, solid.vertex, t, out) > limits.sliver:
        cause, worst = BY_QUALITY, 0.5
    out[18] = shortest
    if limits.order == BY_RADIUS and cause:
        worst = square
    elif limits.order == BY_FIELD and cause:
        wanted = wanted_in_space(limits, limits.size.shape[0] - 1, out[0], out[1], out[2])
        worst = square / (wanted * wanted)
    return cause, worst, square


@apart
def across_input(w, t):
    """Whether the shortest edge of cell t joins parts that meet sharply (1), or is across a gap (2)."""
    best, u, v = np.inf, 0, 0
    for i in range(1, 4):
        for j in range(i):
            a, b, square = w.solid.vertex[4 * t + i], w.solid.vertex[4 * t + j], 0.0
            for k in range(3):
                square += (w.solid.xyz[a, k] - w.solid.xyz[b, k]) ** 2
            if square < best:
                best, u, v = square, a, b
    if meet_sharply(w.sharp, feature_of(w.sharp, w.feature, u), feature_of(w.sharp, w.feature, v), 0):
        return 1
    return 2 if across_gap(w, u, v, t) else 0


@apart
def face_center(xyz, a, b, c, out):
    """Write the circumcenter of a triangle and its unit normal; returns the squared radius, inf if none."""
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    nx, ny, nz = _cross(ux, uy, uz, vx, vy, vz)
    nn = nx * nx + ny * ny + nz * nz
    if not nn > 0.0:
        return np.inf
    px, py, pz = _cross(vx, vy, vz, nx, ny, nz)
    qx, qy, qz = _cross(nx, ny, nz, ux, uy, uz)
    x, y, z = (
        (uu * px + vv * qx) / (2.0 * nn), (uu * py + vv * qy) / (2.0 * nn), (uu * pz + vv * qz) / (2.0 * nn)
    )  # fmt: skip
    length = np.sqrt(nn)
    out[0], out[1], out[2] = xyz[a, 0] + x, xyz[a, 1] + y, xyz[a, 2] + z
    out[3], out[4], out[5] = nx / length, ny / length, nz / length
    return x * x + y * y + z * z


@inline
def encroaches_edge(xyz, a, b, p, lens):
    """Whether p is in the sphere with diameter ab, or (lens 1) sees ab under more than 120 degrees."""
    dot = pa = pb = 0.0
    for j in range(3):
        u, v = xyz[a, j] - xyz[p, j], xyz[b, j] - xyz[p, j]
        dot, pa, pb = dot + u * v, pa + u * u, pb + v * v
    if lens > 0.0:
        return dot < 0.0 and dot * dot > 0.25 * pa * pb
    return dot < (CLOSED_BALL - 1.0) * (pa + pb)


@inline
def encroaches_face(xyz, out, square, p, lens):
    """Whether p is in the sphere around the circumcenter that `face_center` has written.

    With lens 1: in both of the spheres through the circle that meet the plane at 60 degrees from within.
    """
    away = height = 0.0
    for j in range(3):
        away += (xyz[p, j] - out[j]) ** 2
        height += (xyz[p, j] - out[j]) * out[3 + j]
    if lens > 0.0:
        away += 2.0 * TAN_30 * np.sqrt(square) * abs(height)
    return away < CLOSED_BALL * square


@apart
def face_size(solid, limits, face, out):
    """The size wanted at a place for a face: the least one of the regions on its sides."""
    h, t = np.inf, face >> 2
    if solid.region[t] >= 0:
        h = wanted_in_space(limits, solid.region[t], out[0], out[1], out[2])
    if solid.across[face] >= 0 and solid.region[solid.across[face] >> 2] >= 0:
        r = solid.region[solid.across[face] >> 2]
        h = min(h, wanted_in_space(limits, r, out[0], out[1], out[2]))
    return h
