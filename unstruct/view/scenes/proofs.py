"""Two proofs of section 2.4a as pictures with sliders: pure functions from numbers to frames.

Both use the pencil of circles through two points, here (-1, 0) and (1, 0). The circle with center (0, c) has
the equation x^2 + y^2 - 2 c y = 1. With growing c, its disk grows above the segment and shrinks below it.
"""

from __future__ import annotations

import numpy as np

from ...predicates.batch import in_sphere
from ..draw import frames as fr
from .choices import within

__all__ = ["cavity_proof_state", "star_proof_state"]

LEFT, RIGHT = np.array([-1.0, 0.0]), np.array([1.0, 0.0])
ANGLE_B = 70.0  # the angle of triangle ABC at B, in degrees
CENTER_E, CENTER_F = 0.95, -0.55  # the centers of the old circles on both sides of the edge AB


def cavity_proof_state(angle_p: float = 135.0, angle_d: float = 80.0, place: float = 0.3) -> fr.Frame:
    """Figure 12.4: P in circle ABC beyond the edge AC, and the triangle ACD that might hide it.

    Parameters
    ----------
    angle_p : float
        The angle APC in degrees, between 1 and 179. If it is more than 110, P lies inside circle ABC.
    angle_d : float
        The angle ADC in degrees, between 1 and 179. If it is at most 110, D is not inside circle ABC.
    place : float
        The place of P along its arc, from 0 (near C) to 1 (near A).

    Returns
    -------
    dict
        A frame; its number compares the two angles, and its caption states the consequence, by exact signs.
    """
    within("angle_p", angle_p, 1, 179)
    within("angle_d", angle_d, 1, 179)
    within("place", place, 0, 1)
    a, b, c = LEFT, _on_lower_arc(180.0 - ANGLE_B, 0.56), RIGHT
    p = _on_upper_arc(angle_p, 0.1 + 0.8 * place)
    d = _on_upper_arc(angle_d, 0.52)
    p_in_abc = in_sphere(np.array([a, b, c]), p) > 0
    d_in_abc = in_sphere(np.array([a, b, c]), d) > 0
    p_in_acd = in_sphere(np.array([a, c, d]), p) > 0
    if not p_in_abc:
        caption = "P is not in circle ABC: the triangle ABC stays"
    elif d_in_abc:
        caption = "D is inside circle ABC: the start is not Delaunay, and " + (
            "P happens to be in circle ACD" if p_in_acd else "ACD stays and hides P"
        )
    else:
        caption = "ABC goes, and D is not in its circle: " + ("ACD goes too" if p_in_acd else "IMPOSSIBLE")
    items = [
        fr.polygons("cavity" if p_in_abc else "cell", [[a, b, c]]),
        fr.polygons("cavity" if p_in_acd else "cell", [[a, c, d]]),
        _circle("circumcircle", 180.0 - ANGLE_B),
        _circle("circumcircle", angle_d),
        fr.segments("inserted", [[p, a], [p, c]]),
        fr.segments("edge", [[d, a], [d, c]]),
        fr.dots("vertex", [a, b, c]),
        fr.dots("vertex", d, handles=["D"]),
        fr.dots("inserted", p, handles=["P"]),
        fr.labels("vertex", [a, b, c, d, p], "ABCDP"),
    ]
    number = f"∠APC − ∠ADC = {angle_p - angle_d:.0f}°"
    return fr.frame(caption, *items, number=number, view=[-1.8, 1.8, -1.6, 1.9])


def star_proof_state(p: float = 0.5, turn: float = 60.0, hull: bool = False) -> fr.Frame:
    """Figure 12.5: a point D inside the circle of the new triangle ABP, on either side of AB.

    If AB is on the hull, the cell beyond it is a ghost, whose circle is the half-plane below.

    Parameters
    ----------
    p : float
        The circle ABP, from 0 (the circle of the outer triangle ABF, with P on it) to 1 (that of ABE).
    turn : float
        The direction, in degrees, from the center of circle ABP to D.
    hull : bool
        Whether AB is an edge of the hull, so that there is no triangle beyond it.

    Returns
    -------
    dict
        A frame; its number is the power of D in the old circle on D's side. It is negative, so that D would
        have been inside that circle.
    """
    within("p", p, 0, 1)
    center = CENTER_F + p * (CENTER_E - CENTER_F)
    radius = np.hypot(1.0, center)
    direction = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    d = np.array([0.0, center]) + 0.88 * radius * direction
    new = np.array([0.3, center + np.sqrt(radius**2 - 0.09)])
    above = d[1] > 0
    power = d @ d - 2 * (CENTER_E if above else CENTER_F) * d[1] - 1
    e, f = _at(CENTER_E, 118.0), _at(CENTER_F, -62.0)
    if above:
        caption = "D on P's side: then D was inside circle ABE, which was empty"
    elif hull:
        caption = "D beyond a hull edge: in the half-plane of the ghost, which is empty"
    else:
        caption = "D beyond AB: then D was inside circle ABF, which was empty"
    items = [
        fr.polygons("cavity", [[LEFT, RIGHT, e]]),
        fr.polygons("accepted", [[LEFT, RIGHT, new]]),
        fr.circles("circumcircle", [[0.0, CENTER_E]], [np.hypot(1.0, CENTER_E)]),
        fr.circles("inserted", [[0.0, center]], [radius]),
        fr.segments("constrained" if hull else "edge", [[LEFT, RIGHT]]),
        fr.dots("inserted", new),
        fr.dots("bad", d, handles=["D"]),
        fr.labels("vertex", [LEFT, RIGHT, new, d, e], "ABPDE"),
        fr.dots("vertex", [LEFT, RIGHT, e]),
    ]
    if not hull:
        beyond = [fr.polygons("cell", [[LEFT, f, RIGHT]]), fr.dots("vertex", f), fr.labels("vertex", f, "F")]
        items = [*beyond, fr.circles("circumcircle", [[0.0, CENTER_F]], [np.hypot(1.0, CENTER_F)]), *items]
    missing = hull and not above
    number = "" if missing else f"power of D in circle AB{'E' if above else 'F'} = {power:.2f}"
    return fr.frame(caption, *items, number=number, view=[-1.8, 1.8, -1.9, 2.5])


def _on_upper_arc(angle: float, share: float) -> np.ndarray:
    """The point above the segment that sees it under ``angle``, at a fraction of its arc from the right."""
    center = 1.0 / np.tan(np.radians(angle))
    right = np.arctan2(-center, 1.0)
    turn = right + share * (np.pi - 2 * right)
    return np.array([0.0, center]) + np.hypot(1.0, center) * np.array([np.cos(turn), np.sin(turn)])


def _on_lower_arc(angle: float, share: float) -> np.ndarray:
    """A point below the segment on the circle whose upper points see the segment under ``angle``."""
    return _on_upper_arc(180.0 - angle, share) * np.array([1.0, -1.0])


def _circle(role: str, angle: float) -> fr.Item:
    """The circle whose upper points see the segment under ``angle``."""
    center = 1.0 / np.tan(np.radians(angle))
    return fr.circles(role, [[0.0, center]], [np.hypot(1.0, center)])


def _at(center: float, turn: float) -> np.ndarray:
    """The point at direction ``turn``, in degrees, on the circle of the pencil with this center."""
    return np.array([0.0, center]) + np.hypot(1.0, center) * np.array(
        [np.cos(np.radians(turn)), np.sin(np.radians(turn))]
    )
