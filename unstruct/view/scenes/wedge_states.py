"""One wedge between two planes: its sections, and the Jacobian along its height, as frames."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ...base.errors import InputError
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import space_frame

__all__ = ["WEDGES", "wedge_coefficients", "wedge_state"]

# The corners of upper triangles, at z = 3. The lower one is (0, 0), (3, 0), (0, 3), at z = 0.
WEDGES: dict[str, tuple[tuple[int, int], ...]] = {
    "straight": ((0, 0), (3, 0), (0, 3)),
    "wider above": ((-3, -3), (3, 0), (0, 3)),
    "turned by 90 degrees": ((3, 0), (3, 3), (0, 0)),
    "turned by 180 degrees": ((3, 3), (0, 3), (3, 0)),
    "six positive corners": ((6, 2), (-3, 2), (6, 1)),
}
LOWER_TRIANGLE = ((0, 0), (3, 0), (0, 3))
WEDGE_TOP = 3.0
PLOT_AT, PLOT_SIZE = (9.4, 1.2), (3.6, 2.8)  # where the graph of the Jacobian stands, and how large it is
PLOT_TOP = 3.2  # the value of the Jacobian at its upper end
STEPS_OF_CURVE = 40
ZERO_SECTION = 1e-9  # an area that is zero but for rounding
SENSES = ("↻", "↺")  # in which a, b, c follow each other in a section, seen from above
WEDGE_WINDOW = [-5.2, 16.6, -1.6, 5.6]


def wedge_coefficients(upper: tuple[tuple[int, int], ...]) -> tuple[Fraction, Fraction, Fraction]:
    """b0, b1, b2 of the Jacobian of the wedge from the lower triangle to another one in a parallel plane.

    The three rays are equally high, so that the three quadratics of the criterion are one: the area of the
    section at each height. The unit is the area of the lower triangle.
    """
    (e, f), (g, h) = (tuple((b[0] - t[0][0], b[1] - t[0][1]) for b in t[1:]) for t in (LOWER_TRIANGLE, upper))
    unit = _cross(e, f)
    return Fraction(1), (_cross(e, h) + _cross(g, f)) / (2 * unit), _cross(g, h) / unit


def _cross(u: tuple[int, int], v: tuple[int, int]) -> Fraction:
    return Fraction(u[0] * v[1] - u[1] * v[0])


def wedge_state(wedge: str = "six positive corners", height: float = 0.5) -> fr.Frame:
    """A wedge between two planes, its section at a height, and the Jacobian there.

    Parameters
    ----------
    wedge : str
        One of `WEDGES`.
    height : float
        From 0, the lower triangle, to 1, the upper one.

    Returns
    -------
    dict
        The wedge with its section, which is turned over where the Jacobian is negative; beside it the
        graph of the Jacobian over the height.
    """
    if wedge not in WEDGES:
        raise InputError(f"wedge = {wedge!r} must be one of {', '.join(map(repr, WEDGES))}")
    b0, b1, b2 = map(float, wedge_coefficients(WEDGES[wedge]))
    t = np.linspace(0, 1, STEPS_OF_CURVE + 1)
    along = np.column_stack([t, b0 * (1 - t) ** 2 + 2 * b1 * t * (1 - t) + b2 * t * t])
    now = float(b0 * (1 - height) ** 2 + 2 * b1 * height * (1 - height) + b2 * height**2)
    now = 0.0 if abs(now) < ZERO_SECTION else now
    low = np.column_stack([np.array(LOWER_TRIANGLE, dtype=float), np.zeros(3)])
    high = np.column_stack([np.array(WEDGES[wedge], dtype=float), np.full(3, WEDGE_TOP)])
    section, points = (1 - height) * low + height * high, np.vstack([low, high])
    scene = [
        item3("polygons", "muted", [[0, 1, 2], [3, 4, 5]], points, opacity=0.6),
        item3("segments", "edge", [[i, i + 3] for i in range(3)], points),
        item3("polygons", "accepted" if now > 0 else "bad", [[0, 1, 2]], section),
        item3("labels", "vertex", points, text=("a", "b", "c", "a'", "b'", "c'")),
    ]
    if now:
        scene.append(item3("labels", "vertex", [section.mean(axis=0)], text=SENSES[now > 0]))
    made = space_frame(scene, wedge, azimuth=-66.0, elevation=40.0)
    place = np.array(PLOT_AT)
    curve = place + along * [PLOT_SIZE[0], PLOT_SIZE[1] / PLOT_TOP]
    here = place + np.array([height, now]) * [PLOT_SIZE[0], PLOT_SIZE[1] / PLOT_TOP]
    ends = place + np.diag(PLOT_SIZE)
    made["items"] += [
        fr.segments("edge", [(place, end) for end in ends]),
        fr.segments("front", np.stack([curve[:-1], curve[1:]], axis=1)),
        fr.dots("inserted" if now > 0 else "bad", [here]),
        fr.labels("vertex", ends, ["height", "area"]),
    ]
    sign = "positive" if now > 0 else "negative: turned over" if now < 0 else "zero"
    made["number"] = f"area of the section: {now:.2f}, {sign}"
    made["view"] = WEDGE_WINDOW
    return made
