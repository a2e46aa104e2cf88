"""What is said of triangles of a surface in the end: they miss the size, or cross others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.edge_vectors import lengths
from ...geometry.embedded import embedded, flat_rows
from ...geometry.support import Support
from ...sizing.asked import MUCH_LONGER
from ...sizing.field import SizeField
from .own_crossings import CROSSES_ANOTHER, OWN_CROSSING, OwnCrossings

__all__ = ["crossing_reasons", "missed_size"]


def missed_size(points: np.ndarray, triangles: np.ndarray, size: SizeField) -> NDArray[np.int64]:
    """The triangles that are much larger than the size: that at the barycenter, or that at a corner.

    At a corner all three edges must be too long, for a size may change within a triangle. O(n).
    """
    x = points[triangles]
    sides = lengths(x - x[:, [1, 2, 0]])
    longest, shortest = sides.max(axis=1), sides.min(axis=1)
    used = np.unique(triangles)
    least = np.empty(len(points))
    least[used] = size(points[used])
    at_corner = shortest > MUCH_LONGER * least[triangles].min(axis=1)
    return np.flatnonzero((longest > MUCH_LONGER * size(x.mean(axis=1))) | at_corner)


def crossing_reasons(
    points: np.ndarray, triangles: NDArray[np.int32], support: Support
) -> tuple[dict[int, str], int]:
    """The triangles that cross others, with the reason, and how many pairs of given triangles meet.

    The given ones are asked only if the mesh crosses itself; `points` are scaled.
    """
    if embedded(points, triangles):
        return {}, 0
    sound = np.setdiff1d(np.arange(len(triangles)), flat_rows(points, triangles))
    crossings = OwnCrossings(support)
    crossed, own = crossings.others(points, np.ascontiguousarray(triangles[sound]))
    why = dict.fromkeys(sound[own].tolist(), OWN_CROSSING)
    return why | dict.fromkeys(sound[crossed].tolist(), CROSSES_ANOTHER), crossings.count
