"""Given edges that are kept where parts of a surface are too near each other for triangles across them.

A triangle whose corners lie on several given triangles is beside these, the farther the more they turn: with
edges of length h on a smooth surface of curvature k by about h^2 k / 8. Two parts of a surface at less than
that distance from each other, meshed each by itself, cross, and halving edges helps only down to the square
root of the distance. Where the bent edges between given triangles are kept, all new triangles lie on given
ones: if these do not meet, nor do they, however near they are, up to the rounding of vertices.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...domain.given_surface import GivenSurface
from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.edge_vectors import lengths
from ...geometry.support import Support
from ...geometry.support_features import side_groups

__all__ = ["GROWN_MUCH", "HELPED", "KEEPINGS", "MOST_TIMES", "creases_near", "keeping", "total_area"]

Array = NDArray[np.float64]
STRAIGHT_ON = 2.0**-44  # in scaled coordinates, up to 1: edges at which the surface bends by less are left
FARTHER = 3.0  # as far from triangles that cross are edges kept each time
KEEPINGS = 4  # times that edges are kept where triangles still cross
HELPED = 0.5  # of the area of triangles that cross: if more is left, halving edges does not help
GROWN_MUCH = 2.0  # times as many triangles as before halving: with more, it costs too much
MOST_TIMES = 2  # as many vertices as before and as given, together: with more, kept edges are no remedy


def total_area(corners: Array) -> float:
    """The area of triangles (k, 3, 3)."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * float(lengths(np.cross(u, v)).sum())


def _bent(support: Support) -> NDArray[np.int64]:
    """The edges of two triangles that do not lie in one plane: (k, 2)."""
    held = support.held
    place, group, size = side_groups(held.rows)
    second = np.flatnonzero((group[1:] == group[:-1]) & (size[group[1:]] == 2)) + 1
    one, two = place[second - 1], place[second]
    heights = np.zeros(len(one))
    for a, b in ((one, two), (two, one)):
        corner = held.corners[a // 3, a % 3]
        far = held.corners[b // 3, (b % 3 + 2) % 3]
        heights = np.maximum(heights, np.abs(((far - corner) * held.normals[a // 3]).sum(axis=1)))
    flat = held.rows.ravel()
    chosen = one[heights > STRAIGHT_ON]
    return np.stack([flat[chosen], flat[chosen - chosen % 3 + (chosen + 1) % 3]], axis=1)


def creases_near(support: Support, corners: Array, kept: int) -> NDArray[np.int64]:
    """The bent edges of a given surface under triangles and around them: (k, 2).

    Without those that are features already.

    Parameters
    ----------
    corners : (t, 3, 3)
        In scaled coordinates.
    kept : int
        How often edges were kept before: each time, three times as far from the triangles; at first as far as
        these are large.
    """
    edges = _bent(support)
    n = len(support.points)
    old = np.sort(support.features, axis=1)
    edges = np.sort(edges, axis=1)
    edges = edges[~np.isin(edges[:, 0] * n + edges[:, 1], old[:, 0] * n + old[:, 1])]
    if not len(edges) or not len(corners):
        return np.empty((0, 2), dtype=np.int64)
    reach = FARTHER**kept * lengths(corners - corners[:, [1, 2, 0]]).max(axis=1)[:, None]
    low, high = bounding_boxes(corners)
    ends = support.points[edges] * support.factor
    around = BoxTree(low - reach, high + reach)
    return edges[np.unique(around.pairs(*bounding_boxes(ends))[0])]


def keeping(given: GivenSurface, edges: NDArray[np.int64], sharp: float | None) -> GivenSurface:
    """The same surface with other edges as features, too.

    Parameters
    ----------
    given : GivenSurface
    edges : (k, 2) int64
        By the first of equal vertices. Those that are no edges of it are left out.
    sharp : float, optional
        As the surface was made with.
    """
    old, n = given.support, len(given.support.points)
    rows = np.sort(np.stack([old.held.rows, old.held.rows[:, [1, 2, 0]]], axis=2).reshape(-1, 2), axis=1)
    edges = np.sort(edges, axis=1)
    edges = edges[np.isin(edges[:, 0] * n + edges[:, 1], rows[:, 0] * n + rows[:, 1])]
    support = Support(
        old.points,
        old.triangles,
        sharp=sharp,
        edges=np.concatenate([old.features, edges]),
        corners=old.corners,
    )
    return given._replace(support=support)
