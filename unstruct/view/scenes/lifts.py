"""Points of a line lifted to the parabola, an interval, and the line above its ends (section 2.0)."""

from __future__ import annotations

import numpy as np

from ..draw import frames as fr
from .choices import within

__all__ = ["LIFT_CENTERS", "LIFT_RADII", "LIFT_WINDOW", "lift_state"]

# All places are multiples of 1/8, so that every square, and every sign, is exact.
LIFT_PLACES = (-1.875, -1.0, -0.25, 0.5, 1.75)
LIFT_CENTERS = [k / 8 for k in range(-12, 13)]
LIFT_RADII = [k / 8 for k in range(1, 15)]
LIFT_WINDOW = [-2.4, 2.4, -0.9, 4.6]
GROUND = -0.4  # the height at which the points themselves are drawn


def lift_state(center: float = -0.625, radius: float = 0.375) -> fr.Frame:
    """The ball of one dimension, an open interval, and the line through its lifted ends.

    Parameters
    ----------
    center : float
        Between -1.5 and 1.5; multiples of 1/8 are computed without rounding.
    radius : float
        Between 1/8 and 7/4.

    Returns
    -------
    dict
        A frame. Each point x is joined to its lifted point and this to the line; the number is the smallest
        of the differences (x - Q)^2 - R^2, the height of the lifted point above the line.
    """
    within("center", center, LIFT_CENTERS[0], LIFT_CENTERS[-1])
    within("radius", radius, LIFT_RADII[0], LIFT_RADII[-1])
    x = np.array(LIFT_PLACES)
    line = 2 * center * x - center**2 + radius**2
    power = x**2 - line
    inside, on = power < 0, power == 0
    ends = np.array([center - radius, center + radius])
    wide = np.linspace(LIFT_WINDOW[0], LIFT_WINDOW[1], 49)
    bowl = np.column_stack([wide, wide**2])
    far = np.array(LIFT_WINDOW[:2])
    across = np.column_stack([far, 2 * center * far - center**2 + radius**2])
    up = [[[a, GROUND], [a, a * a]] for a in x]
    items = [
        fr.segments("muted", np.stack([bowl[:-1], bowl[1:]], axis=1)),
        fr.segments("muted", up),
        fr.segments("circumcircle", [across]),
        fr.segments("muted", [[[a, GROUND], [a, a * a]] for a in ends]),
        fr.segments("inserted", [np.column_stack([ends, [GROUND, GROUND]])]),
        fr.segments("highlight", [[[a, a * a], [a, z]] for a, z in zip(x, line)]),
        fr.dots("vertex", np.column_stack([x, np.full(len(x), GROUND)])),
        fr.dots("accepted", np.column_stack([x, x * x])[~inside]),
        fr.dots("bad", np.column_stack([x, x * x])[inside]),
        fr.labels("vertex", np.column_stack([x, np.full(len(x), GROUND - 0.3)]), "ABCDE"),
    ]
    names = np.array(list("ABCDE"))
    caption = f"inside and below: {', '.join(names[inside])}" if inside.any() else "empty: nothing is below"
    caption += f"; on the line: {', '.join(names[on])}" if on.any() else ""
    least = int(np.argmin(power))
    number = f"smallest height above the line: {power[least]:+.2f} at {names[least]}"
    return fr.frame(caption, *items, number=number, view=LIFT_WINDOW)
