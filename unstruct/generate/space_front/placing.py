"""Where the front in space wants its next point, compiled.

ABC is a face of the front, what is unfinished on its positive side, h the wanted length at the barycenter of
the wanted cell. Three rules are built in:

- *equal sides*: XA = XB = XC = h, with h kept between 0.55 and 2 times the mean edge of ABC. X lies on the
  line through the circumcenter of ABC at right angles to it; if ABC is obtuse, through the middle of its
  longest edge;
- *sphere*: the sphere through A, B, C and X has the radius sqrt(6) / 4 h, as in a regular tetrahedron;
- *angle*: at the edge of ABC where the angle to the next face of the front is least, the front is closed if
  that is less than 94 degrees, and the angle is halved if it is less than 169 degrees. Otherwise *equal
  sides*. A regular tetrahedron has 70.5 degrees; 94 and 169 are where one, two or three parts are nearest.

Book: 3.5.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline
from ...connect.spatial.cavity import corner
from ...connect.spatial.opening import next_face, third
from ..volume_points.limits import REGULAR, wanted_in_space
from ..volume_points.measures import face_center

SAME_SIDES, AT_EDGE, ON_SPHERE, BY_CALLER = range(4)
SHORTEST_LATERAL, LONGEST_LATERAL = 0.55, 1.4  # times the mean edge of ABC
# The angles are compared by their cosines: arccos(1/3) times 4/3 and 12/5.
COS_CONNECT, COS_HALVE = -0.06995, -0.98269


@inline
def _across(xyz, a, b, v, out, at):
    """Write the unit vector from the line ab to v, at right angles to it; returns whether there is one."""
    ex, ey, ez = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    wx, wy, wz = xyz[v, 0] - xyz[a, 0], xyz[v, 1] - xyz[a, 1], xyz[v, 2] - xyz[a, 2]
    share = (ex * wx + ey * wy + ez * wz) / (ex * ex + ey * ey + ez * ez)
    wx, wy, wz = wx - share * ex, wy - share * ey, wz - share * ez
    length = np.sqrt(wx * wx + wy * wy + wz * wz)
    if not length > 0.0:
        return False
    out[at], out[at + 1], out[at + 2] = wx / length, wy / length, wz / length
    return True


@apart
def at_front_edge(solid, face, side, p, out):
    """Write the point by the angle at the edges of a face as vertex p: 0 for no rule, 1 for p, 2 to close.

    The normal of the face is in ``out[3:6]``; ``out[6:12]`` is used. "Close" means that the apex of the cell
    ahead is the third vertex of the next face.
    """
    xyz, t, k = solid.xyz, face & ~3, face & 3
    best, near_a, near_b, apex, far = COS_HALVE, -1, -1, -1, -1
    for i in range(3):
        a, b = solid.vertex[t + corner(k, i)], solid.vertex[t + corner(k, (i + 1) % 3)]
        c = solid.vertex[t + corner(k, (i + 2) % 3)]
        other = next_face(solid, face, a, b)
        if other < 0:
            continue
        d = third(solid, other, a, b)
        if not (_across(xyz, a, b, c, out, 6) and _across(xyz, a, b, d, out, 9)):
            continue
        if out[3] * out[9] + out[4] * out[10] + out[5] * out[11] <= 0.0:  # 180 degrees or more
            continue
        cosine = out[6] * out[9] + out[7] * out[10] + out[8] * out[11]
        if cosine > best:
            best, near_a, near_b, apex, far = cosine, a, b, d, c
    if near_a < 0:
        return 0
    if best > COS_CONNECT:
        return 2 if solid.vertex[face] == apex else 0
    _across(xyz, near_a, near_b, far, out, 6)
    _across(xyz, near_a, near_b, apex, out, 9)
    total = half = 0.0
    for j in range(3):
        out[6 + j] += out[9 + j]
        total += out[6 + j] * out[6 + j]
        half += 0.25 * (xyz[near_b, j] - xyz[near_a, j]) ** 2
    length = np.sqrt(max(side * side - half, 0.25 * half) / total)
    for j in range(3):
        xyz[p, j] = 0.5 * (xyz[near_a, j] + xyz[near_b, j]) + length * out[6 + j]
    return 1


@apart
def ideal_apex(solid, limits, placement, face, p, out):
    """Write the ideal point for a front face as vertex p; ``out[20]`` has the height of the center ahead.

    That is the height of the circumcenter of the cell ahead above the face. Returns h, the lateral edge, and
    whether the front should be closed with the apex ahead; the unit normal of the face is in ``out[3:6]``.
    """
    xyz, t, k = solid.xyz, face & ~3, face & 3
    a, b, c = solid.vertex[t + corner(k, 0)], solid.vertex[t + corner(k, 1)], solid.vertex[t + corner(k, 2)]
    pp = face_center(xyz, a, b, c, out)
    ab = ac = bc = 0.0
    for j in range(3):
        ab += (xyz[b, j] - xyz[a, j]) ** 2
        ac += (xyz[c, j] - xyz[a, j]) ** 2
        bc += (xyz[c, j] - xyz[b, j]) ** 2
        out[12 + j] = (xyz[a, j] + xyz[b, j] + xyz[c, j]) / 3.0
    mean, r = np.sqrt((ab + ac + bc) / 3.0), solid.region[face >> 2]
    h = wanted_in_space(limits, r, out[12], out[13], out[14])
    if not pp < np.inf:  # the face is flat up to rounding
        for j in range(3):
            xyz[p, j] = out[12 + j]
        return h, h, False
    side = min(max(h, SHORTEST_LATERAL * mean), LONGEST_LATERAL * mean)
    if limits.first[r] >= 0:  # once more, where the barycenter of the wanted cell is
        d = 0.25 * np.sqrt(max(side * side - mean * mean / 3.0, 0.0))
        h = wanted_in_space(limits, r, out[12] + d * out[3], out[13] + d * out[4], out[14] + d * out[5])
        side = min(max(h, SHORTEST_LATERAL * mean), LONGEST_LATERAL * mean)
    if placement == AT_EDGE:
        found = at_front_edge(solid, face, side, p, out)
        if found > 0:
            return h, side, found == 2
    longest = max(ab, max(ac, bc))
    if 2.0 * longest > ab + ac + bc:
        u, v = (a, b) if longest == ab else ((a, c) if longest == ac else (b, c))
        for j in range(3):
            out[j] = 0.5 * (xyz[u, j] + xyz[v, j])
        pp = 0.25 * longest
    if placement == ON_SPHERE:
        f = max(REGULAR * side, np.sqrt(pp))
        d = f + np.sqrt(max(f * f - pp, 0.0))
    else:
        d = np.sqrt(max(side * side - pp, 0.25 * pp))
    d = min(d, max(out[20], 0.5 * np.sqrt(pp)))
    for j in range(3):
        xyz[p, j] = out[j] + d * out[3 + j]
    return h, side, False
