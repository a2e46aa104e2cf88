"""Whether what a front has made is a mesh of its surface: counted, and exactly where it could meet itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.embedded import embedded, flat_rows, meeting_pairs
from ...geometry.support import Support
from ...geometry.support_features import fans_at, side_groups
from .front_sizes import parts_of

__all__ = ["fault_of_front", "meets_itself"]


def fault_of_front(
    points: np.ndarray,
    rows: NDArray[np.int64],
    origin: NDArray[np.int64],
    support: Support,
    curve_sides: NDArray[np.int64],
) -> str:
    """What is wrong with the triangles, in a few words; empty if they are a mesh of the surface.

    Parameters
    ----------
    points : (n, 3)
        Scaled.
    rows : (m, 3) int64
    origin : (n,) int64
        The vertex of the surface that each vertex is, or -1.
    curve_sides : (f, 2) int64
        The edges of the front at the beginning: each must be a side of one triangle, in its direction.
    """
    n = len(points)
    if len(rows) == 0:
        return "there is no triangle"
    place, _, size = side_groups(rows)
    ends = np.stack([rows, rows[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    along = ends[:, 0] * n + ends[:, 1]
    wanted = np.sort(curve_sides[:, 0] * n + curve_sides[:, 1])
    on_curve = np.concatenate([wanted, np.sort(curve_sides[:, 1] * n + curve_sides[:, 0])])
    own = np.isin(along[place], on_curve)
    if not np.array_equal(np.sort(along[place][own]), wanted):
        return "triangles are missing at curves, or there are too many"
    first = np.cumsum(size) - size
    rest = ~own[first]
    if (size[rest] != 2).any() or (ends[place[first[rest]], 0] == ends[place[first[rest] + 1], 0]).any():
        return "the front is not closed"
    fans, known = fans_at(rows, n), origin >= 0
    allowed = np.ones(n, dtype=np.int64)
    allowed[known] = fans_at(support.held.rows, len(support.points))[origin[known]]
    if (fans > allowed).any():
        return "fronts have met in a vertex only"
    if not _same_characters(rows, n, support):
        return "the mesh has other holes or components than the surface"
    if len(flat_rows(points, rows)):
        return "triangles are flat"
    return "it meets itself" if meets_itself(points, rows, support) else ""


def _same_characters(rows: NDArray[np.int64], n: int, support: Support) -> bool:
    """Whether components, over vertices, and the sum of their Euler characteristics agree."""
    own = support.held.rows
    own = own[(own != own[:, [1, 2, 0]]).all(axis=1)]
    found = []
    for triangles, many in ((rows, n), (own, len(support.points))):
        used = np.unique(triangles)
        label = parts_of(triangles, many)
        found.append(
            (len(np.unique(label[used])), len(used) - len(side_groups(triangles)[2]) + len(triangles))
        )
    return found[0] == found[1]


def meets_itself(points: np.ndarray, rows: NDArray[np.int64], support: Support) -> bool:
    """Whether triangles meet outside of common vertices and edges, and those of the surface do not; exact."""
    triangles = rows.astype(np.int32)
    if embedded(points, triangles) or not len(meeting_pairs(points, triangles)):
        return False
    own = support.held.rows
    own = own[(own != own[:, [1, 2, 0]]).all(axis=1)]
    own = own[np.setdiff1d(np.arange(len(own)), flat_rows(support.points, own))]
    return not len(meeting_pairs(support.points, own))
