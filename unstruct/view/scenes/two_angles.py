"""An edge between a point on its left and a point on its right: the two angles, as a frame (section 2.4b)."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["TWO_ANGLES", "TWO_ANGLE_X", "TWO_ANGLE_Y", "two_angle_state"]

# Q, below the edge from (-1, 0) to (1, 0); P moves above it, on a grid of quarters, so that signs are exact.
TWO_ANGLES: dict[str, tuple[float, float]] = {
    "Q sees a right angle": (0.0, -1.0),
    "Q sees a small angle": (0.75, -1.75),
    "Q sees a large angle": (-0.25, -0.5),
    "nasty: Q on a level with the end": (1.25, -0.25),
}
TWO_ANGLE_X = tuple(k / 4 for k in range(-6, 7))
TWO_ANGLE_Y = tuple(k / 4 for k in range(1, 9))
TWO_ANGLE_WINDOW = [-3.0, 3.0, -2.6, 2.9]


def two_angle_state(x: float = 0.25, y: float = 1.5, preset: str = "Q sees a right angle") -> fr.Frame:
    """The circles through both ends of an edge that contain neither P above it nor Q below it.

    Parameters
    ----------
    x, y : float
        The place of P; y between 1/8 and 2, x between -2 and 2.
    preset : str
        A key of `TWO_ANGLES`, which determines Q.

    Returns
    -------
    dict
        A frame. The centers that are left form the green stretch between two diamonds; the circles are those
        through P and through Q. The caption is decided by the exact sign of the sum of the two cotangents,
        and the number gives both angles.
    """
    q = preset_named(TWO_ANGLES, preset)
    within("x", x, -2, 2)
    within("y", y, 0.125, 2)
    top, below = _cotangent(x, y), _cotangent(*q)
    total = top + below
    high, low = float(top), -float(below)
    if total > 0:
        caption = "an edge of every Delaunay triangulation"
    elif total == 0:
        caption = "one circle is left, through P and Q: an edge of some Delaunay triangulations"
    else:
        caption = "no center is left: missing, whatever other points there are"
    ends, points = np.array([(-1.0, 0.0), (1.0, 0.0)]), np.array([(x, y), q])
    centers = [(0.0, high), (0.0, low)]
    line = "voronoi" if total >= 0 else "bad"
    items: list[Any] = [
        fr.segments("muted", [[(0, TWO_ANGLE_WINDOW[2]), (0, TWO_ANGLE_WINDOW[3])]]),
        fr.circles("circumcircle", centers, np.hypot(1.0, [high, low])),
        fr.segments("edge", [[p, end] for p in points for end in ends]),
        fr.segments("constrained" if total >= 0 else "bad", [ends]),
        fr.segments(line, [[(0.0, low), (0.0, high)]]),
        fr.dots("voronoi", centers),
        fr.dots("vertex", [*ends, points[1]]),
        fr.dots("inserted", [points[0]], handles=["P"]),
        fr.labels("vertex", np.vstack([ends - [0.0, 0.1], points + np.array([0.12, 0.05])]), "uvPQ"),
    ]
    angles = np.degrees(np.arctan2(1.0, [high, -low]))
    number = f"∠P + ∠Q = {angles[0]:.1f}° + {angles[1]:.1f}° = {angles.sum():.1f}°"
    return fr.frame(caption, *items, number=number, view=TWO_ANGLE_WINDOW)


def _cotangent(x: float, y: float) -> Fraction:
    """Of the angle under which (x, y) sees the edge."""
    a, b = Fraction(x), Fraction(y)
    return (a * a + b * b - 1) / (2 * abs(b))
