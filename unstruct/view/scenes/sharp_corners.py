"""Two segments with a common end, which halve each other if their angle is small."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...base.errors import InputError
from ..draw import frames as fr

__all__ = ["SHARP_WINDOW", "sharp_corner_state"]

SHARP_WINDOW = [-0.25, 1.2, -0.55, 1.1]
Lines = tuple[list[float], list[float]]
Encroached = tuple[int, float, float, float]  # the line, the ends of a part of it, a vertex of the other line


def sharp_corner_state(angle: float = 40.0, shorter: float = 0.75, halvings: int = 0) -> fr.Frame:
    """Two segments from one corner after so many halvings of encroached parts.

    Parameters
    ----------
    angle : float
        Between the segments, in degrees, above 0 and below 180.
    shorter : float
        The length of the upper segment; the lower one has the length 1.
    halvings : int
        How many parts are halved, if so many are encroached upon: on the lower segment first.

    Returns
    -------
    dict
        The vertices on both segments, the part that is halved next with its smallest circle, the vertex of
        the other segment in this circle, and how often parts were halved.
    """
    if not 0 < angle < 180 or shorter <= 0:
        raise InputError(f"angle = {angle} must be between 0 and 180, and shorter = {shorter} positive")
    c = float(np.cos(np.radians(angle)))
    lines: Lines = ([0.0, 1.0], [0.0, float(shorter)])
    made, found = 0, _encroached(lines, c)
    while found is not None and made < halvings:
        which, low, high, _ = found
        lines[which][:] = sorted([*lines[which], (low + high) / 2])
        made, found = made + 1, _encroached(lines, c)
    way = np.array([[1.0, 0.0], [c, np.sin(np.radians(angle))]])
    places = np.vstack([np.outer(line, way[k]) for k, line in enumerate(lines)])
    ends = [[way[k] * line[0], way[k] * line[-1]] for k, line in enumerate(lines)]
    items = [fr.segments("constrained", ends), fr.dots("vertex", places)]
    shortest = min(line[1] for line in lines)
    number = f"{made} halving{'s' if made != 1 else ''}; the shortest part at the corner: {shortest:.3g}"
    if found is None:
        return fr.frame("no vertex is in a circle: done", *items, number=number, view=SHARP_WINDOW)
    which, low, high, other = found
    items += [
        fr.circles("circumcircle", [way[which] * (low + high) / 2], [(high - low) / 2]),
        fr.segments("bad", [[way[which] * low, way[which] * high]]),
        fr.dots("inserted", [way[1 - which] * other]),
    ]
    return fr.frame("the red part is halved next", *items, number=number, view=SHARP_WINDOW)


def _encroached(lines: Lines, c: float) -> Encroached | None:
    """The first part with a vertex of the other line strictly inside of its smallest circle."""
    for which, mine in enumerate(lines):
        for low, high in pairwise(mine):
            for p in lines[1 - which][1:]:
                if p * p - (low + high) * p * c + low * high < 0:
                    return which, low, high, p
    return None
