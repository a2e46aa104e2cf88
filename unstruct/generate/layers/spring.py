"""When an opposing front is near: by the nearest point, or by the forces of springs (12.3.3).

S. Pirzadeh (AIAA Journal 34 (1996) 43-49) imagines springs from the ends of a front edge to the candidates
for its next point. The candidate with the least force is taken. If that is a point that exists, another
front is near, and the edge stops.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["nearest_stops", "spring_force", "spring_stops"]

Array = NDArray[np.float64]
NEAR_STEPS = 2.0  # by the nearest point: so many steps and ...
NEAR_SPACINGS = 1.0  # ... so many spacings away an opposing point is near


def spring_force(x: Array, a: Array, b: Array, rest: Array) -> Array:
    """The sum of the forces, of stretched and of compressed springs, from points x to a and b.

    Each force is the difference of the spring's length and its rest length, for springs of unit stiffness.
    """
    return np.abs(np.hypot(*(x - a).T) - rest) + np.abs(np.hypot(*(x - b).T) - rest)


def spring_stops(edge: tuple[Array, Array], new: tuple[Array, Array], existing: Array) -> NDArray[np.bool_]:
    """Whether an existing point takes less force than both new points of an edge.

    Parameters
    ----------
    edge : two arrays, shape (k, 2)
        The ends of front edges.
    new : two arrays, shape (k, 2)
        The points that the rays of both ends make next.
    existing : (k, 2) float64
        A point of another front for each edge.

    Notes
    -----
    The rest length is that of the edge: springs are relaxed at the apex of the equilateral triangle. A new
    point one step d above an end of an edge of length s takes the force sqrt(s^2 + d^2) - d. An existing
    point at the height g above the middle takes less if it is nearer than about 1.4 s, for small d: that is
    the "local cell size" within which fronts are to stop. With a rest length of 0 it would be within
    sqrt(d s / 2), so near that the rest between two fronts could not be filled well.

    The least force alone fails in a gap much narrower than the edge: springs to a point nearer than about
    sqrt(d s / 2) are compressed to half their length and take more force than the new points do. So a point
    that stretches neither spring is near in any case.
    """
    a, b = edge
    rest = np.hypot(*(b - a).T)
    own = np.minimum(spring_force(new[0], a, b, rest), spring_force(new[1], a, b, rest))
    slack = np.maximum(np.hypot(*(existing - a).T), np.hypot(*(existing - b).T)) <= rest
    return slack | (spring_force(existing, a, b, rest) < own)


def nearest_stops(new: Array, step: Array, apart: Array, existing: Array) -> NDArray[np.bool_]:
    """Whether an existing point is within two steps and one spacing of a new point."""
    return np.hypot(*(existing - new).T) < NEAR_STEPS * step + NEAR_SPACINGS * apart
