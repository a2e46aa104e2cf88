"""Places of rays whose directions are computed anew on each layer: they are no straight lines any more."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .records import Walls

__all__ = ["marched"]

Array = NDArray[np.float64]


def marched(
    walls: Walls,
    directed: Callable[[Walls], tuple[Array, NDArray[np.bool_]]],
    first: Array,
    height: Array,
    shares: Array,
) -> Array:
    """The places of rays on all levels, rounded: (levels + 1, r, 3).

    Parameters
    ----------
    walls : Walls
        With one ray at each vertex.
    directed : function of walls
        The directions on a surface, and which of them see all triangles there. Rays whose direction does not
        keep the one before.
    first : (r, 3) float64
        The directions of the first layer.
    height : (r,) float64
        The total heights; 0 for rays that stay.
    shares : (1, levels + 1) or (r, levels + 1) float64
        The heights of levels, in parts of the whole.
    """
    steps = np.diff(shares, axis=1)
    places = np.empty((shares.shape[1], *walls.points.shape))
    places[0], direction = walls.points, first
    moves = height > 0.0
    for k in range(len(places) - 1):
        if k:
            found, seen = directed(walls._replace(points=places[k]))
            direction = np.where((seen & moves)[:, None], found, direction)
        places[k + 1] = np.where(
            moves[:, None], places[k] + direction * (steps[:, k] * height)[:, None], places[k]
        )
    return places
