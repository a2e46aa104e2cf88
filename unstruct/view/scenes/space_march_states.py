"""The classical front on small bodies in space, step by step, from all sides."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ...base.errors import InputError
from ...examples.stuck_fronts import stuck_body
from ...plain import advancing_front_space as plain
from ...plain.space_places import Face, lowest
from ..draw import frames as fr
from .space_fronts import space_front_frames

__all__ = ["MARCHES", "MARCH_SIDES", "MARCH_WINDOW", "march_state"]

MARCH_WINDOW = (-1.1, 1.1, -1.1, 1.1)  # contains all bodies from all sides

MARCH_SIDES = list(range(-170, 190, 20))  # degrees, all around
MARCHES = {"seven points": "", "eight points": "convex", "seven points, stuck": "general"}
MARCH_POINTS = [(1, 3, 0), (1, 3, 3), (1, 3, 5), (4, 0, 5), (4, 1, 2), (5, 0, 4), (5, 3, 5)]
MARCH_FACES = [
    (2, 6, 3), (1, 6, 2), (1, 2, 3), (0, 3, 4), (0, 1, 3), (0, 6, 1), (0, 4, 6), (3, 6, 5), (3, 5, 4),
    (4, 5, 6),
]  # fmt: skip


class March(NamedTuple):
    """The points and the faces before the first step, and the steps, moved into the unit sphere."""

    points: list[Any]
    faces: list[Face]
    steps: list[plain.Choice]


@lru_cache(maxsize=8)
def march(body: str) -> March:
    """The plain front on one of the bodies."""
    if body == "seven points":
        points, faces = list(MARCH_POINTS), list(MARCH_FACES)
        steps = plain.advancing_front_in_space(points, faces, lambda x: 3.0, key=plain.by_age)
    else:
        domain = stuck_body(MARCHES[body])
        points = [(int(x), int(y), int(z)) for x, y, z in domain.points.tolist()]
        faces = [lowest(a, c, b) for a, b, c in domain.triangulated.triangles.tolist()]
        steps = plain.advancing_front_in_space(points, faces, lambda x: 2.0)
    x = np.array(points, dtype=float)
    center = (x.min(axis=0) + x.max(axis=0)) / 2
    unit = float(np.sqrt(((x - center) ** 2).sum(axis=1).max()))

    def moved(place: Any) -> tuple[float, float, float]:
        p, q, r = ((np.array(place, dtype=float) - center) / unit).tolist()
        return p, q, r

    shown = [
        replace(step, ideal=step.ideal and moved(step.ideal), radius=step.radius / unit) for step in steps
    ]
    return March([moved(p) for p in points], faces, shown)


def march_state(body: str = "seven points", seen_from: int = 30) -> list[fr.Frame]:
    """The plain classical front on a small body, step by step, seen from a side.

    Parameters
    ----------
    body : str
        A name in `MARCHES`. The first one is filled; on the other two the front sticks.
    seen_from : int
        The azimuth, in degrees.

    Returns
    -------
    list of dict
        See `space_front_frames`. The bodies are moved into the unit sphere, so that all lie in
        `MARCH_WINDOW`.

    Raises
    ------
    InputError
        For another body.
    """
    if body not in MARCHES:
        raise InputError(f"body = {body!r} must be one of {', '.join(map(repr, MARCHES))}")
    points, faces, steps = march(body)
    return space_front_frames(points, faces, steps, azimuth=seen_from, elevation=15.0)
