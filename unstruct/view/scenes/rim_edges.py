"""An edge on the rim of a cavity, the triangles on both sides of it, and the new one (section 2.6a)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["RIM_BEYOND", "rim_edge_state"]

# The edge is from A = (-1, 0) to B = (1, 0); all coordinates are dyadic, so that the signs are exact.
RIM_BEYOND: dict[str, tuple[float, float] | None] = {
    "a near corner D": (0.25, -1.25),
    "a far corner D": (-0.5, -3.0),
    "nothing: AB is a boundary edge": None,
}
RIM_ENDS = np.array([(-1.0, 0.0), (1.0, 0.0)])
RIM_CORNER = np.array([0.25, 1.75])  # C
RIM_WINDOW = [-2.5, 2.5, -3.2, 2.2]


def rim_edge_state(x: float = 0.0, y: float = 0.5, beyond: str = "a near corner D") -> fr.Frame:
    """The triangles ABC and ABD of a Delaunay triangulation, a new point P, and the triangle ABP.

    Parameters
    ----------
    x, y : float
        The place of P: x between -1 and 1, y between 1/16 and 2; multiples of 1/16 are computed exactly.
    beyond : str
        A key of `RIM_BEYOND`: what is on the other side of AB.

    Returns
    -------
    dict
        A frame. Its caption says whether AB is on the rim of the cavity of P and, if so, which circle bounds
        that of ABP; the number has the radii.
    """
    within("x", x, -1.0, 1.0)
    within("y", y, 0.0625, 2.0)
    far = preset_named(RIM_BEYOND, beyond)
    place = np.array([x, y])
    given = [("C", RIM_CORNER)] if far is None else [("C", RIM_CORNER), ("D", np.array(far))]
    radii = {f"AB{name}": _radius(corner) for name, corner in [*given, ("P", place)]}
    items = [fr.polygons("cell", [[*RIM_ENDS, corner] for _, corner in given])]
    items.append(fr.circles("circumcircle", *_circles([corner for _, corner in given])))
    on_rim = _inside(place, RIM_CORNER) and not (far is not None and _inside(place, np.array(far)))
    if on_rim:
        items.append(fr.polygons("accepted", [[*RIM_ENDS, place]]))
        items.append(fr.circles("inserted", *_circles([place])))
    items.append(fr.circles("muted", [[0.0, 0.0]], [1.0]))
    items.append(fr.segments("constrained" if far is None else "front", [RIM_ENDS]))
    corners = [*RIM_ENDS, *(corner for _, corner in given)]
    items += [fr.dots("vertex", corners), fr.labels("vertex", corners, "ABCD"[: len(corners)])]
    items += [fr.dots("inserted", [place], handles=["P"]), fr.labels("inserted", [place], "P")]
    number = ", ".join(f"{name} {radius:.2f}" for name, radius in radii.items())
    return fr.frame(_caption(place, far, radii), *items, number=number, view=RIM_WINDOW)


def _caption(place: np.ndarray, far: Any, radii: dict[str, float]) -> str:
    if not _inside(place, RIM_CORNER):
        return "P is not inside circle ABC: the triangle ABC stays"
    if far is not None and _inside(place, np.array(far)):
        return "P is inside circle ABD, too: AB is deleted"
    if _square(place) >= 0:
        return "the angle at P is at most 90°: ABP is below ABC"
    if far is not None:
        return "the angle at P is obtuse: ABP is at most ABD"
    grown = radii["ABP"] > radii["ABC"]
    return "P is in the diametral disk" + (": ABP is larger than ABC" if grown else ", yet ABP is not larger")


def _square(point: np.ndarray) -> float:
    """Negative inside the disk with the diameter AB: x^2 + y^2 - 1."""
    return float(point[0] * point[0] + point[1] * point[1] - 1.0)


def _inside(place: np.ndarray, corner: np.ndarray) -> bool:
    """Whether ``place`` is strictly inside the circle through A, B and ``corner``."""
    power = _square(place) * corner[1] - _square(corner) * place[1]
    return bool(power < 0 if corner[1] > 0 else power > 0)


def _radius(corner: np.ndarray) -> float:
    height = _square(corner) / (2.0 * corner[1])
    return float(np.sqrt(1.0 + height * height))


def _circles(corners: list[np.ndarray]) -> tuple[list[list[float]], list[float]]:
    """Centers and radii of the circles through A, B and each of the corners."""
    heights = [_square(corner) / (2.0 * corner[1]) for corner in corners]
    return [[0.0, float(h)] for h in heights], [_radius(corner) for corner in corners]
