"""What is said of triangles of a surface: they miss the size, are sharp, far off, or cross others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...connect.surface.complex import Taken
from ...geometry.edge_vectors import lengths
from ...geometry.embedded import embedded, flat_rows
from ...geometry.support import Support
from ...geometry.triangle_tree import TriangleTree
from ...sizing.asked import MUCH_LONGER
from ...sizing.field import SizeField
from .own_crossings import CROSSES_ANOTHER, OWN_CROSSING, OwnCrossings

__all__ = ["crossing_reasons", "farther_from", "missed_size", "sharp_triangles"]

MUCH_SHORTER = 0.1  # of the size: sharp triangles with a shorter edge are told


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


def sharp_triangles(
    corners: np.ndarray, curved: NDArray[np.bool_], on_creases: NDArray[np.bool_], size: SizeField
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which triangles (t, 3, 3) are sharp, if they are, as creases are near each other, or vertices are.

    A given angle between two creases is neither.

    Parameters
    ----------
    curved : (t, 3) bool
        Whether the side opposite each corner is on a crease.
    on_creases : (t, 3) bool
        Whether each corner is.
    """
    sides = lengths(corners[:, [1, 2, 0]] - corners[:, [2, 0, 1]])
    shortest = sides.argmin(axis=1)
    many, rows = curved.sum(axis=1), np.arange(len(sides))
    given = (many == 3) | ((many == 2) & ~curved[rows, shortest])
    short = sides[rows, shortest] < MUCH_SHORTER * size(corners.mean(axis=1))
    ends = on_creases[rows, (shortest + 1) % 3] & on_creases[rows, (shortest + 2) % 3]
    return (on_creases.all(axis=1) | (short & ends)) & ~given, short & ~given


def farther_from(support: Support, taken: Taken, most: np.ndarray) -> NDArray[np.int64]:
    """The slots of triangles with a sample that is farther from the surface than ``most`` of each (t,).

    Of the surface, too: the triangle that is nearest to the middle of a given one is meant.
    """
    points = taken.points / support.factor
    there, back = support.distances(points, taken.triangles)
    found = [taken.slots[there > most]]
    rows = np.flatnonzero(back > most.min(initial=np.inf))
    if len(rows):
        middle = support.points[support.triangles[rows]].mean(axis=1)
        near, _ = TriangleTree(points[taken.triangles]).nearest(middle)
        found.append(taken.slots[near[back[rows] > most[near]]])
    return np.concatenate(found)


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
