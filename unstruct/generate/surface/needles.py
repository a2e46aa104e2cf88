"""Flat parts of a given surface divided into other triangles, among which searches are quicker."""

from __future__ import annotations

import numpy as np

from ...domain.given_surface import GivenSurface
from ...geometry.embedded import flat_rows
from .given_flips import flip_needles

__all__ = ["without_needles"]

SAME_PLACES = 2.0**-50  # in scaled coordinates, up to 1: as far apart may two diagonals be


def without_needles(given: GivenSurface) -> GivenSurface:
    """The same surface, where its plane parts are not divided into needles.

    The boxes of a fan of needles overlap: a search looked at all of them.
    """
    support = given.support
    rows = support.held.rows
    xyz = support.points * support.factor
    sound = np.flatnonzero((rows != rows[:, [1, 2, 0]]).all(axis=1))
    sound = sound[np.setdiff1d(np.arange(len(sound)), flat_rows(support.points, rows[sound]))]
    found = flip_needles(xyz, rows[sound].astype(np.int32), support.features, SAME_PLACES)
    if found.flips == 0:
        return given
    triangles = rows.copy()
    triangles[sound] = found.triangles
    return given._replace(support=support.of_triangles(triangles))
