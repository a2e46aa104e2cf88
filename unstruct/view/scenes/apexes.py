"""A triangle with a fixed base whose apex the reader moves, with both circles and its quality (chapter 1)."""

from __future__ import annotations

import numpy as np

from ...geometry.simplex import circumcenter, circumradius, quality
from ..draw import frames as fr
from .choices import within

__all__ = ["apex_state"]

APEX_WINDOW = [-1.1, 2.1, -0.75, 1.75]


def apex_state(x: float = 0.5, y: float = 0.9) -> fr.Frame:
    """The triangle with the corners (0, 0), (1, 0) and (x, y).

    Parameters
    ----------
    x : float
        From -1 to 2.
    y : float
        From 0.01 to 1.6.

    Returns
    -------
    dict
        A frame with the inscribed and the circumscribed circle. The number has 2r/R and the minimum angle,
        the caption says what kind of triangle it is.
    """
    within("x", x, -1.0, 2.0)
    within("y", y, 0.01, 1.6)
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (x, y)])
    sides = np.hypot(*(np.roll(corners, -1, axis=0) - np.roll(corners, 1, axis=0)).T)  # opposite the corners
    half = sides.sum() / 2
    center, radius = (sides[:, None] * corners).sum(axis=0) / sides.sum(), y / 2 / half
    least, most = (float(quality(name, corners)) for name in ("min_angle", "max_angle"))
    caption = "neither angle nor edge is bad" if least >= 30 else "a needle: one edge is short"
    if most > 120:
        caption = "a cap: one angle is large"
    items = [
        fr.polygons("cell", [corners]),
        fr.circles("circumcircle", [circumcenter(corners)], [float(circumradius(corners))]),
        fr.circles("accepted", [center], [radius]),
        fr.dots("vertex", corners[:2]),
        fr.dots("inserted", [corners[2]], handles=["C"]),
        fr.labels("vertex", corners + np.array([(-0.15, -0.1), (0.06, -0.1), (0.06, 0.06)]), "ABC"),
    ]
    number = f"2r/R = {2 * radius / float(circumradius(corners)):.2f}, minimum angle {least:.0f}°"
    return fr.frame(caption, *items, number=number, view=APEX_WINDOW)
