"""Rebay's points in space: on the Voronoi segment of a face between an accepted cell and one that waits.

The face has the circumradius p and the circumcenter M; F is the circumcenter of the cell that waits, and
q = |MF|. As in the plane, the new point X is on the line MF at the distance d = R + sqrt(R^2 - p^2) from M,
with R = min(max(f, p), (p^2 + q^2) / 2 q): the sphere through the face and X has the radius R. Faces of the
boundary are active as if there were accepted cells beyond. See the book, 2.8c.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline
from .limits import REGULAR, wanted_in_space
from .measures import face_center, judge_cell
from .queues import enter_cell

__all__ = ["active_face", "after_giving_up", "place_on_voronoi"]


@inline
def _waits(w, t, out):
    cause, _, _ = judge_cell(w.solid, w.limits, t, out)
    return cause & ~w.why[t] & 3


@apart
def active_face(w, t, out):
    """The face of cell t with the least circumradius beyond which no cell waits; -1 if there is none."""
    best, chosen = np.inf, np.int64(-1)
    for k in range(4):
        face = np.int64(4 * t + k)
        over = w.solid.across[face]
        if w.solid.mark[face] < 0 and over >= 0 and _waits(w, over >> 2, out):
            continue
        a, b = w.solid.vertex[4 * t + (k + 1 & 3)], w.solid.vertex[4 * t + (k + 2 & 3)]
        square = face_center(w.solid.xyz, a, b, w.solid.vertex[4 * t + (k + 3 & 3)], out)
        if square < best:
            best, chosen = square, face
    return chosen


@apart
def place_on_voronoi(w, t, face, p, out):
    """Write the point for a face of cell t; returns the wanted circumradius f there, 0 for no point."""
    solid, xyz = w.solid, w.solid.xyz
    judge_cell(solid, w.limits, t, out)
    fx, fy, fz = out[0], out[1], out[2]
    k = face & 3
    a, b, c = solid.vertex[4 * t + (k + 1 & 3)], solid.vertex[4 * t + (k + 2 & 3)], 0
    c = solid.vertex[4 * t + (k + 3 & 3)]
    pp = face_center(xyz, a, b, c, out)
    apex, inward = solid.vertex[face], 0.0
    for j in range(3):
        inward += (xyz[apex, j] - xyz[a, j]) * out[3 + j]
    sign = 1.0 if inward > 0.0 else -1.0
    q = sign * ((fx - out[0]) * out[3] + (fy - out[1]) * out[4] + (fz - out[2]) * out[5])
    x = y = z = 0.0
    for v in (a, b, c):
        x, y, z = x + xyz[v, 0] / 3.0, y + xyz[v, 1] / 3.0, z + xyz[v, 2] / 3.0
    f = REGULAR * wanted_in_space(w.limits, solid.region[t], x, y, z)
    if not q > 0.0 or not pp < np.inf or not f < np.inf:
        return 0.0
    radius = min(max(f, np.sqrt(pp)), (pp + q * q) / (2.0 * q))
    d = q if q * q < pp else radius + np.sqrt(max(radius * radius - pp, 0.0))
    for j in range(3):
        xyz[p, j] = out[j] + sign * d * out[3 + j]
    return f


@apart
def after_giving_up(w, t, out):
    """Let the cells beside one that waits no more wait: they have an active face now."""
    for k in range(4):
        over = w.solid.across[4 * t + k]
        if over >= 0 and w.solid.mark[4 * t + k] < 0:
            enter_cell(w, over >> 2, out)
