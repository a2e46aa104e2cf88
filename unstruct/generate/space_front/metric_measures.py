"""What the front in space measures in a metric, compiled: cells and faces are mapped, then measured as usual.

A metric at a place is a factor L of its inverse (`sizing.space_metric_table`): the vector L w of space has
the image w, and metric lengths are those of images. The map keeps orientation. A few vertices of a cell are
mapped into the rows of ``local``, relative to some origin; circumcenters and lenses are those of
`volume_points.measures` there. Nothing here decides topology. Book: 3.3, 3.5.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline
from ...connect.spatial.cavity import corner
from ...sizing.space_metric_table import factor_in_space
from ..volume_points.measures import cell_center

LOCAL_CELL = np.arange(4, dtype=np.int32)  # the cell of the first four rows of ``local``


@inline
def map_vertex(xyz, v, m, ox, oy, oz, local, row):
    """Write the image of vertex v, relative to (ox, oy, oz), into a row."""
    l11, l21, l22, l31, l32, l33 = m
    x = (xyz[v, 0] - ox) / l11
    y = (xyz[v, 1] - oy - l21 * x) / l22
    local[row, 0], local[row, 1] = x, y
    local[row, 2] = (xyz[v, 2] - oz - l31 * x - l32 * y) / l33


@inline
def put_back(m, ox, oy, oz, out, at, xyz, p):
    """Write the point with the image ``out[at : at + 3]`` as vertex p."""
    l11, l21, l22, l31, l32, l33 = m
    x, y, z = out[at], out[at + 1], out[at + 2]
    xyz[p, 0] = ox + l11 * x
    xyz[p, 1] = oy + l21 * x + l22 * y
    xyz[p, 2] = oz + l31 * x + l32 * y + l33 * z


@apart
def metric_at_cell(xyz, vertex, t, table):
    """The metric at the barycenter of cell t."""
    x = y = z = 0.0
    for k in range(4):
        v = vertex[4 * t + k]
        x, y, z = x + 0.25 * xyz[v, 0], y + 0.25 * xyz[v, 1], z + 0.25 * xyz[v, 2]
    return factor_in_space(table, x, y, z)


@apart
def map_cell(xyz, vertex, face, m, p, local):
    """Map the corners of a face, as seen from within its cell, and the apex, into the first four rows.

    The origin is vertex p, or the apex if p is -1.
    """
    t, k = face & ~3, face & 3
    o = vertex[face] if p < 0 else p
    ox, oy, oz = xyz[o, 0], xyz[o, 1], xyz[o, 2]
    for i in range(3):
        map_vertex(xyz, vertex[t + corner(k, i)], m, ox, oy, oz, local, i)
    map_vertex(xyz, vertex[face], m, ox, oy, oz, local, 3)


@inline
def square_of_row(local, i):
    """The squared metric length of a row."""
    return local[i, 0] ** 2 + local[i, 1] ** 2 + local[i, 2] ** 2


@inline
def square_between(local, i, j):
    """The squared metric length between two rows."""
    return (
        (local[i, 0] - local[j, 0]) ** 2 + (local[i, 1] - local[j, 1]) ** 2 + (local[i, 2] - local[j, 2]) ** 2
    )


@apart
def square_of_cell(xyz, vertex, t, table, local, out):
    """The squared circumradius of cell t in the metric at its barycenter; inf if it is flat."""
    map_cell(xyz, vertex, 4 * t, metric_at_cell(xyz, vertex, t, table), -1, local)
    square, _, _ = cell_center(local, LOCAL_CELL, 0, out)
    return square


@apart
def square_of_face(xyz, vertex, face, table, local):
    """The square of twice the area of a face, in the metric at the barycenter of its cell."""
    map_cell(xyz, vertex, face, metric_at_cell(xyz, vertex, face >> 2, table), -1, local)
    uu, vv, ww = square_between(local, 0, 1), square_between(local, 0, 2), square_between(local, 1, 2)
    dot = 0.5 * (uu + vv - ww)
    return uu * vv - dot * dot


@apart
def in_metric_ball(xyz, vertex, t, p, m, local, out):
    """Whether p is in the metric sphere of cell t, up to rounding; so it is if the cell is flat."""
    map_cell(xyz, vertex, 4 * t, m, p, local)
    square, _, _ = cell_center(local, LOCAL_CELL, 0, out)
    return not out[0] ** 2 + out[1] ** 2 + out[2] ** 2 >= square


@inline
def _near_segment(local, i, j):
    """The squared distance of 0 from the segment between two rows."""
    uu, oo, vv = square_between(local, i, j), square_of_row(local, i), square_of_row(local, j)
    along = 0.5 * (uu + oo - vv)
    if not (along > 0.0 and along < uu):
        return min(oo, vv)
    return max(oo - along * along / uu, 0.0)


@apart
def near_wall(local):
    """The squared distance of 0 from the triangle of the first three rows."""
    nearest = min(_near_segment(local, 0, 1), min(_near_segment(local, 1, 2), _near_segment(local, 2, 0)))
    ux, uy, uz = local[1, 0] - local[0, 0], local[1, 1] - local[0, 1], local[1, 2] - local[0, 2]
    vx, vy, vz = local[2, 0] - local[0, 0], local[2, 1] - local[0, 1], local[2, 2] - local[0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    nn = nx * nx + ny * ny + nz * nz
    if not nn > 0.0:
        return nearest
    for i in range(3):  # whether the foot of 0 is on the inner side of all edges
        j = (i + 1) % 3
        ex, ey, ez = local[j, 0] - local[i, 0], local[j, 1] - local[i, 1], local[j, 2] - local[i, 2]
        cx, cy, cz = ey * nz - ez * ny, ez * nx - ex * nz, ex * ny - ey * nx
        if cx * local[i, 0] + cy * local[i, 1] + cz * local[i, 2] < 0.0:
            return nearest
    height = local[0, 0] * nx + local[0, 1] * ny + local[0, 2] * nz
    return min(nearest, height * height / nn)
