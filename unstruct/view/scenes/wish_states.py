"""Where a front wants its next point, by the angle at a corner and by the triangle ahead, as frames."""

from __future__ import annotations

from functools import lru_cache
from math import cos, radians, sin, sqrt

from ...geometry.simplex import circumcenter, circumradius
from ...plain import front_points as rules
from ..draw import frames as fr

__all__ = ["AHEAD_X", "AHEAD_Y", "RULE_ANGLES", "RULE_WINDOW", "ahead_state", "angle_rule_state"]

AHEAD_X = [round(-0.6 + 0.2 * k, 1) for k in range(12)]  # where the corner ahead may be
AHEAD_Y = [round(0.2 + 0.2 * k, 1) for k in range(12)]
RULE_ANGLES = list(range(40, 230, 5))
RULE_WINDOW = (-2.8, 1.9, -1.5, 2.0)
BASE_ENDS = (0.0, 0.0), (1.0, 0.0)
RULE_START = (-1.6, -0.8), (-1.0, 0.0), (0.0, 0.0)  # P, A, B: at A the angle is 233 degrees
PARTS_SAID = {1: "the front is closed", 2: "two parts", 3: "three parts"}
TAKEN_SAID = {
    "small enough": "ABC is small enough: it is accepted",
    "empty circle": "X is not inside the circle of ABC: C is taken",
    "near apex": "X is too near to C: C is taken",
    "new point": "X has room: it is inserted",
}


def angle_rule_state(angle: int = 100, size: float = 1.0) -> fr.Frame:
    """The angle rule at a corner ABN of the front.

    Parameters
    ----------
    angle : int
        That of what is not meshed at B, in degrees; it is smaller than the one at A.
    size : float
        The wanted length; AB has the length 1.

    Returns
    -------
    dict
        The corner, the rays that divide it, and the triangle; how far the parts are from 60 degrees. N can
        be dragged.
    """
    p, a, b = RULE_START
    t = radians(angle)
    n = -cos(t), sin(t)
    k, x = rules.parts(t), rules.by_angle(p, a, b, n, size)
    cuts = [(b, (-cos(t * i / k), sin(t * i / k))) for i in range(1, k)] if k <= 3 else []
    items = [
        fr.segments("front", [(p, a), (a, b), (b, n)]),
        fr.segments("voronoi", cuts),
        fr.polygons("highlight", [(a, b, x)]),
        fr.dots("vertex", [p, a, b]),
        fr.dots("vertex", [n], handles=["N"]),
        fr.labels("vertex", [p, a, b, n], "PABN"),
    ]
    items += [fr.dots("inserted", [x])] if k > 1 else []
    what = f"{PARTS_SAID[k]} of {angle / k:.0f} degrees" if k in PARTS_SAID else "too wide: equal sides"
    off = ", ".join(f"{abs(angle / j - 60):.0f}" for j in (1, 2, 3, 4))
    return fr.frame(f"{angle} degrees: {what}", *items, number=f"1, 2, 3, 4 parts are {off} off 60")


def ahead_state(x: float = 0.6, y: float = 1.4, size: float = 1.0) -> fr.Frame:
    """What the edge from (0, 0) to (1, 0) takes, with the triangle ABC ahead of it: steps 1 to 3 of 3.2.

    Parameters
    ----------
    x, y : float
        The corner C, which the reader can drag; above the edge.
    size : float
        The wanted length.

    Returns
    -------
    dict
        The triangle ahead with its circle, where *equal sides* wants the point, and what is taken. Dots are
        the places of C in the grid of `AHEAD_X` and `AHEAD_Y` for which a new point is made.
    """
    (a, b), c = BASE_ENDS, (x, y)
    corners = [a, b, c]
    reason, taken = rules.ahead(a, b, c, size)
    wish = rules.equal_sides(a, b, size)
    radius, center = float(circumradius(corners)), circumcenter(corners)
    items = [
        fr.dots("edge", roomy_places(size)),
        fr.polygons("waiting", [corners]),
        fr.circles("circumcircle", [center], [radius]),
        fr.polygons("highlight", [(a, b, taken)]),
        fr.segments("front", [(a, b)]),
        fr.dots("vertex", [a, b]),
        fr.dots("vertex", [c], handles=["C"]),
        fr.labels("vertex", corners, "ABC"),
        fr.dots("voronoi", [center]),
        fr.dots("inserted" if reason == "new point" else "bad", [taken if reason == "new point" else wish]),
    ]
    text = TAKEN_SAID[reason]
    if reason == "new point" and taken[1] < wish[1]:
        text = "X was moved back to the center of the circle; it has room: it is inserted"
    limit = 1.2 * size / sqrt(3)
    return fr.frame(text, *items, number=f"R = {radius:.2f}; small enough below {limit:.2f}")


@lru_cache(maxsize=16)
def roomy_places(size: float) -> list[tuple[float, float]]:
    """The places of the corner ahead for which a new point is made."""
    a, b = BASE_ENDS
    return [(x, y) for y in AHEAD_Y for x in AHEAD_X if rules.ahead(a, b, (x, y), size)[0] == "new point"]
