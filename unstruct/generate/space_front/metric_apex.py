"""Points of the front in space in a metric, compiled: where they are wanted, and whether they are possible.

What is measured goes through the metric at the point; what decides topology is exact. The cavity of a point
p is collected by metric spheres, from the cell ahead of a face on, and `settle_star` makes it one all of
whose walls p sees, by exact signs. So the mesh is valid whatever the metric is; it is not Delaunay.

**Why this ends.** A point is placed only if all walls of its cavity are at least `ROOM_IN_STAR` away, in the
metric at the point. The interior of the cavity contains no vertex, hence neither does the metric ball of this
radius about p. If h is the least length of the table of the metric, all new points are at least
`ROOM_IN_STAR` h from each other and from all vertices, so that there is room for finitely many. Every other
step accepts a cell. Book: 3.3, 3.5.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline
from ...connect.insertion.engine import STAMP
from ...connect.spatial.cavity import corner
from ...connect.spatial.opening import FACES_OPEN, STAR_CELLS, STAR_FIRST, STAR_SEEDS, STAR_WALLS
from ...connect.spatial.star import room_for_star, settle_star, unseen_across
from ...sizing.space_metric_table import factor_in_space
from ..volume_points.limits import REGULAR
from ..volume_points.measures import cell_center, encroaches_face, face_center
from .ledger import APEX_ROOM
from .metric_measures import (
    LOCAL_CELL,
    in_metric_ball,
    map_cell,
    map_vertex,
    near_wall,
    put_back,
    square_between,
    square_of_row,
)
from .placing import LONGEST_LATERAL, ON_SPHERE, SHORTEST_LATERAL
from .steps import (
    APEX_FITS,
    APEX_LENS,
    LACKS_SLOTS,
    LEAST_VOLUME,
    NOT_SEEN,
    TOO_FLAT_ANGLE,
    TOO_LOW,
    VERTEX_NEAR,
)  # fmt: skip

ROOM_IN_STAR = 0.05  # no point nearer than that to a wall of its cavity
FIRST_LOOK, LAST_LOOK = 0, 2  # how often the metric is looked up where the barycenter of the wanted cell is


@apart
def metric_apex(solid, table, placement, face, p, local, out):
    """Write the ideal point for a front face as vertex p.

    Returns the lateral edge (1 where the face allows it), the squared circumradius of the cell ahead, and
    whether p is in its sphere; all in the metric at the barycenter of the wanted cell.
    """
    xyz, t, k = solid.xyz, face & ~3, face & 3
    ox = oy = oz = 0.0
    for i in range(3):
        v = solid.vertex[t + corner(k, i)]
        ox, oy, oz = ox + xyz[v, 0] / 3.0, oy + xyz[v, 1] / 3.0, oz + xyz[v, 2] / 3.0
    x, y, z = ox, oy, oz
    side = mean = pp = 0.0
    m = factor_in_space(table, x, y, z)
    for look in range(FIRST_LOOK, LAST_LOOK + 1):
        m = factor_in_space(table, x, y, z)
        for i in range(3):
            map_vertex(xyz, solid.vertex[t + corner(k, i)], m, ox, oy, oz, local, i)
        map_vertex(xyz, solid.vertex[face], m, ox, oy, oz, local, 3)
        pp = face_center(local, 0, 1, 2, out)
        ab, ac, bc = square_between(local, 0, 1), square_between(local, 0, 2), square_between(local, 1, 2)
        mean = np.sqrt((ab + ac + bc) / 3.0)
        if not pp < np.inf:  # the face is flat up to rounding
            xyz[p, 0], xyz[p, 1], xyz[p, 2] = ox, oy, oz
            return 1.0, np.inf, False
        side = min(max(1.0, SHORTEST_LATERAL * mean), LONGEST_LATERAL * mean)
        d = 0.25 * np.sqrt(max(side * side - mean * mean / 3.0, 0.0))
        if look < LAST_LOOK:
            for j in range(3):
                out[12 + j] = d * out[3 + j]
            put_back(m, ox, oy, oz, out, 12, xyz, p)
            x, y, z = xyz[p, 0], xyz[p, 1], xyz[p, 2]
    square, _, _ = cell_center(local, LOCAL_CELL, 0, out)
    fx, fy, fz = out[0], out[1], out[2]
    face_center(local, 0, 1, 2, out)
    high = np.inf
    if square < np.inf:
        high = (fx - local[0, 0]) * out[3] + (fy - local[0, 1]) * out[4] + (fz - local[0, 2]) * out[5]
    longest = max(ab, max(ac, bc))
    if 2.0 * longest > ab + ac + bc:
        u, v = (0, 1) if longest == ab else ((0, 2) if longest == ac else (1, 2))
        for j in range(3):
            out[j] = 0.5 * (local[u, j] + local[v, j])
        pp = 0.25 * longest
    if placement == ON_SPHERE:
        f = max(REGULAR * side, np.sqrt(pp))
        d = f + np.sqrt(max(f * f - pp, 0.0))
    else:
        d = np.sqrt(max(side * side - pp, 0.25 * pp))
    d = min(d, max(high, 0.5 * np.sqrt(pp)))
    for j in range(3):
        out[12 + j] = out[j] + d * out[3 + j]
    put_back(m, ox, oy, oz, out, 12, xyz, p)
    ahead = (out[12] - fx) ** 2 + (out[13] - fy) ** 2 + (out[14] - fz) ** 2 < square
    return side, square, ahead


@apart
def collect_metric_star(solid, star, p, m, local, out):
    """Collect the cells around the seed of ``star`` whose metric spheres contain p, across unmarked faces."""
    solid.state[STAMP] += 1
    inside, size, head = 2 * solid.state[STAMP], 1, 0
    solid.stamp[star.cells[0]] = inside
    while head < size:
        t = np.int64(star.cells[head])
        head += 1
        for k in range(4):
            u = unseen_across(solid, t, k, inside)
            if u < 0:
                continue
            if in_metric_ball(solid.xyz, solid.vertex, u, p, m, local, out):
                star.cells[size] = u
                size += 1
                solid.stamp[u] = inside
            else:
                solid.stamp[u] = inside + 1
    star.sizes[STAR_CELLS] = size


@apart
def judge_metric_star(solid, star, face, p, m, clearance, local, out):
    """Whether the star that was found for p may be made: an outcome, and the vertex too near, or -1."""
    xyz, vertex = solid.xyz, solid.vertex
    nearest, near = np.int64(-1), clearance * clearance
    ox, oy, oz = xyz[p, 0], xyz[p, 1], xyz[p, 2]
    for j in range(3):
        local[3, j] = 0.0
    verdict = APEX_FITS if room_for_star(solid, star) else LACKS_SLOTS
    for i in range(star.sizes[STAR_WALLS]):
        wall = np.int64(star.walls[i])
        t, k = wall & ~3, wall & 3
        for j in range(3):
            v = vertex[t + corner(k, j)]
            map_vertex(xyz, v, m, ox, oy, oz, local, j)
            square = square_of_row(local, j)
            if wall != face and square < near and not _is_corner(vertex, face, v):
                nearest, near = np.int64(v), square
        if near_wall(local) < ROOM_IN_STAR * ROOM_IN_STAR:
            verdict = TOO_LOW
        square = face_center(local, 0, 1, 2, out)
        if wall == face:
            mean = (
                square_between(local, 0, 1) + square_between(local, 0, 2) + square_between(local, 1, 2)
            ) / 3
            six = _six_volumes(local)
            if not six >= LEAST_VOLUME * mean * np.sqrt(mean):
                verdict = TOO_LOW
        elif solid.mark[wall] >= 0 and encroaches_face(local, out, square, 3, APEX_LENS):
            verdict = TOO_FLAT_ANGLE if verdict != TOO_LOW else verdict
    return (VERTEX_NEAR, nearest) if nearest >= 0 else (verdict, nearest)


@inline
def _six_volumes(w):
    """Six times the volume of the first three rows and 0, positive if 0 sees the triangle from within."""
    return -(
        w[0, 0] * (w[1, 1] * w[2, 2] - w[1, 2] * w[2, 1])
        + w[0, 1] * (w[1, 2] * w[2, 0] - w[1, 0] * w[2, 2])
        + w[0, 2] * (w[1, 0] * w[2, 1] - w[1, 1] * w[2, 0])
    )


@inline
def _is_corner(vertex, face, v):
    """Whether v is a corner of a face."""
    t, k = face & ~3, face & 3
    return vertex[t + corner(k, 0)] == v or vertex[t + corner(k, 1)] == v or vertex[t + corner(k, 2)] == v


@apart
def try_metric_apex(march, face, p, side, local, out):
    """Search and judge the star of vertex p from the cell ahead of a face: an outcome and a vertex."""
    solid, star, xyz = march.solid, march.star, march.solid.xyz
    m = factor_in_space(march.table, xyz[p, 0], xyz[p, 1], xyz[p, 2])
    clearance = APEX_ROOM * min(1.0, side)
    map_cell(xyz, solid.vertex, face, m, p, local)
    if square_of_row(local, 3) < clearance * clearance:
        return VERTEX_NEAR, np.int64(solid.vertex[face])
    star.cells[0] = face >> 2
    star.sizes[STAR_SEEDS], star.sizes[STAR_FIRST], star.sizes[FACES_OPEN] = 1, 1, 0
    collect_metric_star(solid, star, p, m, local, out)
    if not settle_star(solid, star, march.edges, p, -1):
        return NOT_SEEN, np.int64(-1)
    return judge_metric_star(solid, star, face, p, m, clearance, local, out)
