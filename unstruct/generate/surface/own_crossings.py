"""Where a given surface crosses itself: a mesh on it crosses itself there, too, however fine it is."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...geometry.crossing_places import crossing_places, near_places
from ...geometry.edge_vectors import lengths
from ...geometry.embedded import flat_rows, meeting_pairs
from ...geometry.support import Support

__all__ = ["CROSSES_ANOTHER", "OWN_CROSSING", "OwnCrossings"]

Array = NDArray[np.float64]
OWN_CROSSING = "the given surface crosses itself here"
CROSSES_ANOTHER = "crosses another triangle: give a smaller size there"


class OwnCrossings:
    """The places where triangles of a given surface meet outside of common vertices and edges.

    They are looked for at the first question; surfaces whose meshes do not cross ask none.

    Parameters
    ----------
    support : Support
    """

    def __init__(self, support: Support):
        self.support = support

    @cached_property
    def places(self) -> Array:
        """What each pair of triangles that meet has in common, in scaled coordinates: (k, 3, 3)."""
        support = self.support
        rows = support.held.rows
        rows = rows[(rows != rows[:, [1, 2, 0]]).all(axis=1)]
        rows = rows[np.unique(np.sort(rows, axis=1), axis=0, return_index=True)[1]]
        rows = rows[np.setdiff1d(np.arange(len(rows)), flat_rows(support.points, rows))]
        pairs = meeting_pairs(support.points, rows)
        return crossing_places(support.points * support.factor, rows, pairs)

    @property
    def count(self) -> int:
        """How many pairs of given triangles meet, if that was asked; else 0."""
        return len(self.places) if "places" in self.__dict__ else 0

    def among(self, points: Array, triangles: np.ndarray, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Which pairs of triangles of a mesh (k, 2) meet where the given surface does.

        That is so if it meets itself within the longest edge of the two.

        Parameters
        ----------
        points : (n, 3)
            In scaled coordinates.
        """
        if not len(pairs):
            return np.zeros(0, dtype=bool)
        x = points[triangles]
        longest = lengths(x - x[:, [1, 2, 0]]).max(axis=1)
        found = crossing_places(points, triangles, pairs)
        return near_places(self.places, found, longest[pairs].max(axis=1))

    def others(self, points: Array, triangles: np.ndarray) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The triangles of a mesh that meet others though the given surface does not, and where it does.

        Parameters
        ----------
        points : (n, 3)
            In scaled coordinates.
        triangles : (t, 3) int32
            None of them flat, no two with the same vertices.
        """
        pairs = meeting_pairs(points, triangles)
        own = self.among(points, triangles, pairs)
        return np.unique(pairs[~own]), np.unique(pairs[own])
