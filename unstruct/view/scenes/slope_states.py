"""How wrong the slope of a linear interpolant can be: two strips of gradients, as a frame (section 2.6d)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.simplex import angles, circumcenter, circumradius
from ..draw import frames as fr
from .choices import within

__all__ = ["SLOPE_FEET", "SLOPE_HEIGHTS", "slope_bounds", "slope_state"]

SLOPE_HEIGHTS = (0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.732)
SLOPE_FEET = (0.0, 0.2, 0.4, 0.6, 0.8, 0.95)
SLOPE_BASE = np.array([[-1.0, 0.0], [1.0, 0.0]])
GRADIENTS_AT, GRADIENT_SCALE = np.array([4.7, 0.4]), 0.65  # where the plane of gradients is drawn
REACH_OF_STRIP = 12.0
SLOPE_WINDOW = (-2.6, 7.2, -2.3, 3.0)


def slope_bounds(corners: Any) -> np.ndarray:
    """The four corners (4, 2) of the gradients that the error of interpolation may have at corner 0.

    Second derivatives are at most 1 in every direction. The first corner is the error of x -> |x|^2 / 2.
    """
    c, a, b = np.asarray(corners, dtype=float)
    sides = np.array([a - c, b - c])
    half = (sides**2).sum(axis=1) / 2  # |g . side| is at most this
    determinant = sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]
    across = np.array([[sides[1, 1], -sides[0, 1]], [-sides[1, 0], sides[0, 0]]]) / determinant
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    right = signs * half
    return np.stack([(across * row).sum(axis=1) for row in right])


def slope_state(height: float = 0.6, foot: float = 0.4) -> fr.Frame:
    """A triangle on the base from (-1, 0) to (1, 0), and the gradients of the error at its apex.

    Parameters
    ----------
    height : float
        Of the apex C.
    foot : float
        Where its height meets the base, from 0 (the middle) to 1.

    Returns
    -------
    dict
        The triangle with its circle; beside it the two strips with the parallelogram in which they meet, and
        a circle with the radius R. The number has the angle at C, R, and the farthest corner.
    """
    within("height", height, 0.1, 2.0)
    within("foot", foot, 0.0, 1.0)
    apex = np.array([foot, height])
    triangle = np.vstack([apex, SLOPE_BASE])
    center, radius = circumcenter(triangle), float(circumradius(triangle))
    allowed = slope_bounds(triangle)
    farthest = float(np.sqrt((allowed**2).sum(axis=1)).max())
    drawn = GRADIENTS_AT + GRADIENT_SCALE * allowed
    strips = []
    for side in SLOPE_BASE - apex:
        unit = side / np.sqrt((side**2).sum())
        turned = np.array([-unit[1], unit[0]])
        edge = np.sqrt((side**2).sum()) / 2
        for sign in (-1, 1):
            middle = GRADIENTS_AT + GRADIENT_SCALE * sign * edge * unit
            strips.append([middle - REACH_OF_STRIP * turned, middle + REACH_OF_STRIP * turned])
    items = [
        fr.circles("circumcircle", [center], [radius]),
        fr.polygons("cell", [triangle]),
        fr.segments("voronoi", [[center, apex]]),
        fr.dots("vertex", triangle),
        fr.labels("vertex", triangle, "CAB"),
        fr.segments("muted", strips),
        fr.polygons("cavity", [drawn]),
        fr.circles("circumcircle", [GRADIENTS_AT], [GRADIENT_SCALE * radius]),
        fr.segments("voronoi", [[GRADIENTS_AT, drawn[0]]]),
        fr.dots("vertex", [GRADIENTS_AT]),
        fr.dots("inserted", [drawn[0]]),
        fr.labels("vertex", [GRADIENTS_AT], "0"),
    ]
    angle = float(np.degrees(angles(triangle)[0]))
    text = "the farthest corner is on the circle" if farthest < radius * (1 + 1e-9) else "beyond the circle"
    number = f"angle at C {angle:.0f}°, R = {radius:.2f}, farthest corner {farthest:.2f}"
    return fr.frame(text, *items, number=number, view=SLOPE_WINDOW)
