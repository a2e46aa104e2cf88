"""Whether directions see the triangles at their vertices: decided exactly for the directions as stored."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.jacobians import integers
from ...predicates.batch import power_of_two
from .records import Walls

__all__ = ["SIGN_ERROR", "SIGN_TINY", "visible"]

SIGN_ERROR = 2.0**-48  # of the product of the lengths (sums of magnitudes) of three vectors
SIGN_TINY = 1e-300


@kernel
def _sees(xyz, triangles, directions, seen, open_):
    """Note which directions see all triangles at their vertices; write the corners that rounding leaves open.

    Entries of ``open_`` are 3 t + k; returns how many there are.
    """
    count = 0
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
        wx, wy, wz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
        x, y, z = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        size = (abs(ux) + abs(uy) + abs(uz)) * (abs(wx) + abs(wy) + abs(wz))
        for k in range(3):
            d = directions[triangles[t, k]]
            sign = x * d[0] + y * d[1] + z * d[2]
            bound = SIGN_ERROR * size * (abs(d[0]) + abs(d[1]) + abs(d[2])) + SIGN_TINY
            if sign < -bound:
                seen[triangles[t, k]] = False
            elif not sign > bound:
                open_[count] = 3 * t + k
                count += 1
    return count


def visible(walls: Walls, directions: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether directions, as they are stored, see all triangles at their vertices: (n,), exact."""
    seen = np.ones(len(directions), dtype=np.bool_)
    xyz = walls.points * power_of_two(walls.points)
    rows = np.empty(3 * len(walls.triangles), dtype=np.int64)
    rows = rows[: _sees(xyz, walls.triangles, directions, seen, rows)]
    t, k = rows // 3, rows % 3
    v = walls.triangles[t, k]
    keep = seen[v]
    t, v = t[keep], v[keep]
    if len(t):
        x = integers(walls.points[walls.triangles[t]])
        d = integers(directions[v][:, None])[:, 0]
        e, f = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
        sign = d[:, 0] * (e[:, 1] * f[:, 2] - e[:, 2] * f[:, 1])
        sign += d[:, 1] * (e[:, 2] * f[:, 0] - e[:, 0] * f[:, 2])
        sign += d[:, 2] * (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])
        seen[v[(sign <= 0).astype(bool)]] = False
    return seen
