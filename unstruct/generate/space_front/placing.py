"""Where the front in space wants its next point, compiled.

ABC is a face of the front, what is unfinished on its positive side, h the wanted length near there. Book: 3.5.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import inline, lean
from ...connect.spatial.cavity import corner
from ...connect.spatial.opening import next_face, third
from ..volume_points.limits import REGULAR, wanted_in_space
from ..volume_points.measures import face_center

EQUAL_EDGES, BY_DIHEDRAL, ON_SPHERE = range(3)
SHORTEST_EDGE, LONGEST_EDGE = 0.55, 2.0  # times the mean edge of ABC: the lateral edges of the ideal cell
HEIGHT = (2.0 / 3.0) ** 0.5  # of a regular tetrahedron
LEAST_VOLUME = 0.05  # six volumes of an ideal cell are at least this times the cube of the mean edge


@inline
def ideal_apex(march, face, q, p, out):
    """Write the ideal point for a front face as vertex p; q is the height of the sphere of the cell ahead.

    Returns the wanted length h, the lateral edge, and whether there is a point (face is no needle).
    """
    solid, xyz = march.solid, march.solid.xyz
    t, k = face & ~3, face & 3
    a, b, c = solid.vertex[t + corner(k, 0)], solid.vertex[t + corner(k, 1)], solid.vertex[t + corner(k, 2)]
    pp = face_center(xyz, a, b, c, out)
    ab = ac = bc = mx = my = mz = 0.0
    for j in range(3):
        ab += (xyz[b, j] - xyz[a, j]) ** 2
        ac += (xyz[c, j] - xyz[a, j]) ** 2
        bc += (xyz[c, j] - xyz[b, j]) ** 2
    mean = np.sqrt((ab + ac + bc) / 3.0)
    mx, my, mz = (
        (xyz[a, 0] + xyz[b, 0] + xyz[c, 0]) / 3.0, (xyz[a, 1] + xyz[b, 1] + xyz[c, 1]) / 3.0,
        (xyz[a, 2] + xyz[b, 2] + xyz[c, 2]) / 3.0,
    )
    r, limits = solid.region[face >> 2], march.limits
    h = wanted_in_space(limits, r, mx, my, mz)
    if not pp < np.inf:
        return h, h, False
    side = min(max(h, SHORTEST_EDGE * mean), LONGEST_EDGE * mean)
    if limits.first[r] >= 0:
        d = 0.25 * np.sqrt(max(side * side - mean * mean / 3.0, 0.0))
        h = wanted_in_space(limits, r, mx + d * out[3], my + d * out[4], mz + d * out[5])
        side = min(max(h, SHORTEST_EDGE * mean), LONGEST_EDGE * mean)
    longest = max(ab, max(ac, bc))
    if 2.0 * longest > ab + ac + bc:  # obtuse: the center is outside; take the middle of the longest edge
        u, v = (a, b) if longest == ab else ((a, c) if longest == ac else (b, c))
        for j in range(3):
            out[j] = 0.5 * (xyz[u, j] + xyz[v, j])
        pp = 0.25 * longest
    radius = np.sqrt(pp)
    if march.rule.placement == ON_SPHERE:
        f = max(REGULAR * side, radius)
        d = f + np.sqrt(max(f * f - pp, 0.0))
    else:
        d = np.sqrt(max(side * side - pp, 0.25 * pp))
    d = min(d, max(q, 0.5 * radius))
    for j in range(3):
        xyz[p, j] = out[j] + d * out[3 + j]
    double = 0.0
    double = np.sqrt(max(ab * ac - (0.5 * (ab + ac - bc)) ** 2, 0.0))
    return h, side, double * d >= LEAST_VOLUME * mean * mean * mean
