"""The circles through both ends of an edge, and which points they contain, as a frame (section 2.2a)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["PENCILS", "pencil_state"]

# The edge is from A = (-1, 0) to B = (1, 0). All coordinates are exact, so that all signs are.
PENCILS: dict[str, list[tuple[float, float]]] = {
    "five points": [(0.5, 1.5), (-1.25, 1.0), (0.0, 2.5), (0.25, -1.0), (-1.0, -1.75)],
    "no empty circle": [(0.25, 0.75), (0.5, 2.0), (-0.25, -0.75)],
    "nasty: a point on AB": [(0.25, 0.0), (0.5, 2.0), (-0.5, -1.5)],
    "nasty: three on a circle": [(1.0, 1.0), (-1.0, 1.0), (0.5, 1.5), (0.0, -1.25)],
}
PENCIL_ENDS = np.array([(-1.0, 0.0), (1.0, 0.0)])
PENCIL_WINDOW = [-2.7, 2.7, -2.5, 2.9]
FAR_OUT = 2.0  # the largest offset of the slider


def pencil_state(offset: float = 0.0, preset: str = "five points") -> fr.Frame:
    """The circle through A and B with its center at height ``offset`` over the middle of AB.

    Parameters
    ----------
    offset : float
        Between -2 and 2; multiples of 1/8 are computed without rounding.
    preset : str
        A key of `PENCILS`.

    Returns
    -------
    dict
        A frame. Diamonds on the axis are the centers at which the circle passes through the points of the
        same name. The number is the interval of offsets for which the circle is empty.
    """
    rows = np.array(preset_named(PENCILS, preset))
    within("offset", offset, -FAR_OUT, FAR_OUT)
    names = "CDEFG"[: len(rows)]
    square, height = (rows**2).sum(axis=1) - 1.0, rows[:, 1]
    power = square - 2.0 * offset * height
    inside, on = power < 0, power == 0
    across = height != 0
    own = square[across] / (2.0 * height[across])
    front, behind = own[height[across] > 0], own[height[across] < 0]
    low, high = behind.max(initial=-np.inf), front.min(initial=np.inf)
    between = [name for name, s, y in zip(names, square, height) if y == 0 and s < 0]
    if between:
        number = f"no circle is empty: {between[0]} is between A and B"
    elif low > high:
        number = f"no circle is empty: behind up to {low:.2f}, in front from {high:.2f}"
    else:
        number = f"t = {offset:g}; empty for {low:.2f} ≤ t ≤ {high:.2f}"
    caption = f"inside: {_listed(names, inside)}" if inside.any() else "empty"
    caption += f"; on the circle: {_listed(names, on)}" if on.any() else ""
    shown = np.abs(own) <= PENCIL_WINDOW[3] - 0.3
    axis = np.column_stack([np.zeros(int(shown.sum())), own[shown]])
    letters = [name for name, y in zip(names, height) if y != 0]
    # a letter beside a center near AB would lie on the edge
    near = np.where(axis[:, 1] < 0, -0.36, 0.08)
    aside = np.column_stack([axis[:, 0] - 0.42, axis[:, 1] + np.where(np.abs(axis[:, 1]) < 0.2, near, -0.12)])
    items: list[Any] = [
        fr.segments("muted", [[(0, PENCIL_WINDOW[2]), (0, PENCIL_WINDOW[3])]]),
        fr.segments("muted", [[(PENCIL_WINDOW[0], 0), (PENCIL_WINDOW[1], 0)]]),
        fr.circles("circumcircle", [(0, offset)], [np.sqrt(1.0 + offset * offset)]),
        fr.segments("front", [PENCIL_ENDS]),
        fr.dots("voronoi", axis),
        fr.labels("voronoi", aside, [name for name, seen in zip(letters, shown) if seen]),
        fr.dots("vertex", np.vstack([PENCIL_ENDS, rows[~inside]])),
        fr.dots("bad", rows[inside]),
        fr.labels("vertex", np.vstack([PENCIL_ENDS, rows]), "AB" + names),
        fr.dots("inserted", [(0, offset)], handles=["center"]),
    ]
    return fr.frame(caption, *items, number=number, view=PENCIL_WINDOW)


def _listed(names: str, chosen: np.ndarray) -> str:
    return ", ".join(name for name, here in zip(names, chosen) if here)
