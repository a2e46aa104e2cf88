"""How far the given triangles are themselves from a smooth surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.edge_vectors import lengths
from ...geometry.support import Support
from ...geometry.support_features import side_groups

__all__ = ["faceting"]


def faceting(support: Support) -> NDArray[np.float64]:
    """For each given triangle the distance by which it may be off a smooth surface, in scaled coordinates.

    Where two triangles of heights a and b over their common side turn by an angle t, and this is no feature,
    a smooth surface through their vertices is about min(a, b) t / 8 away, which is exact for cylinders.
    """
    held = support.held
    rows, corners = held.rows, held.corners
    place, group, _ = side_groups(rows)
    same = np.flatnonzero(group[1:] == group[:-1])
    one, two = place[same], place[same + 1]  # side k begins at corner k
    ends = np.sort(np.stack([rows.ravel()[one], rows.ravel()[one // 3 * 3 + (one + 1) % 3]], axis=1), axis=1)
    kept = np.sort(support.features, axis=1)
    n = int(rows.max()) + 1
    smooth = ~np.isin(ends[:, 0] * n + ends[:, 1], kept[:, 0] * n + kept[:, 1])
    one, two = one[smooth], two[smooth]
    side = lengths(np.roll(corners, -1, axis=1) - corners).ravel()
    area = lengths(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    height = np.minimum(area[one // 3], area[two // 3]) / np.where(side[one] > 0.0, side[one], 1.0)
    off = height * lengths(held.normals[one // 3] - held.normals[two // 3]) / 8.0
    result = np.zeros(len(rows))
    np.maximum.at(result, one // 3, off)
    np.maximum.at(result, two // 3, off)
    spread = np.zeros(n)  # a place in a triangle is near those around it
    np.maximum.at(spread, rows.ravel(), np.repeat(result, 3))
    return spread[rows].max(axis=1)
