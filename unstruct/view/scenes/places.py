"""A new point at any place among given ones: its nearest points and its new triangles (section 2.3)."""

from __future__ import annotations

import numpy as np

from ...connect.insertion.delaunay import delaunay
from ...geometry.simplex import quality
from ...predicates.batch import orient
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["PLACE_POINTS", "PLACE_WINDOW", "is_peak", "nearest_points", "new_point_frame", "place_state"]

_AROUND = [(-3, 5), (3, 5), (-8, -5), (8, -4), (-3, -10), (4, -10)]
# A and B have the distance 8; it is C that makes the difference. All coordinates are integers.
PLACE_POINTS: dict[str, list[tuple[float, float]]] = {
    "an obtuse triangle": [(-4, 0), (4, 0), (0, 2), *_AROUND],
    "an acute triangle": [(-4, 0), (4, 0), (0, -8), *_AROUND],
    "nasty: a right angle": [(-4, 0), (4, 0), (0, 4), *_AROUND],
    "nasty: a lattice": [(x, y) for y in (4, -2, -8) for x in (-6, 0, 6)],
}
PLACE_WINDOW = [-10.5, 10.5, -12.0, 7.0]
PLACE_RANGES = {"x": (-8.0, 8.0), "y": (-10.0, 5.0)}


def nearest_points(points: np.ndarray, x: np.ndarray) -> tuple[float, np.ndarray]:
    """The smallest distance from x to the points, and the rows of all points that have it (exact ties)."""
    square = ((points - x) ** 2).sum(axis=1)
    return float(np.sqrt(square.min())), np.flatnonzero(square == square.min())


def is_peak(points: np.ndarray, x: np.ndarray) -> bool:
    """Whether the distance to the nearest point has a local maximum at x.

    It has one exactly when x lies in the interior of the convex hull of its nearest points: there is no line
    through x that leaves all of them in one closed half plane.
    """
    around = points[nearest_points(points, x)[1]]
    if len(around) < 3:
        return False
    # A line through x with all points on one closed side can be turned until it contains one of them.
    side = np.array([[int(orient(np.array([x, p, q]))) for q in around] for p in around])
    return bool(((side > 0).any(axis=1) & (side < 0).any(axis=1)).all())


def new_point_frame(points: np.ndarray, x: np.ndarray, name: str = "X", caption: str = "") -> fr.Frame:
    """The triangles after the insertion of x, its empty disk, and its shortest edges (bold).

    The number says how long they are, and what the smallest angle of the new triangles is.
    """
    rho, near = nearest_points(points, x)
    letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"[: len(points)]
    if rho == 0:
        known = [*fr.mesh_items(points, delaunay(points).simplices), fr.labels("vertex", points, letters)]
        number = f"{name} is the vertex {letters[near[0]]}: nothing to insert"
        return fr.frame(caption, *known, fr.dots("inserted", [x], handles=[name]), number=number)
    after = delaunay(np.vstack([points, x]))
    away = np.sqrt(((points - x) ** 2).sum(axis=1))  # x may be rounded: to the eye these are ties
    corners = after.corners[(after.simplices == len(points)).any(axis=1)]
    angle = float(quality("min_angle", corners).min())
    items = [
        fr.polygons("cell", after.corners),
        fr.polygons("accepted", corners),
        fr.circles("circumcircle", [x], [rho]),
        fr.segments("highlight", [[x, p] for p in points[away <= rho * (1.0 + 1e-9)]]),
        fr.dots("vertex", points),
        fr.labels("vertex", points, letters),
        fr.dots("inserted", [x], handles=[name]),
        fr.labels("inserted", [x], [name]),
    ]
    number = f"shortest new edge {rho:.2f}, minimum angle {angle:.1f}°"
    return fr.frame(caption, *items, number=number)


def place_state(preset: str = "an obtuse triangle", x: float = 0.0, y: float = -3.0) -> fr.Frame:
    """The insertion of X at (x, y), which of the points are nearest, and whether they could be farther.

    Parameters
    ----------
    preset : str
        A key of `PLACE_POINTS`.
    x, y : float
        Between -8 and 8, and between -10 and 5. Multiples of 1/8 are computed without rounding, so that ties
        are seen exactly.

    Returns
    -------
    dict
        A frame; the caption lists the nearest points.
    """
    points = np.array(preset_named(PLACE_POINTS, preset), dtype=float)
    within("x", x, *PLACE_RANGES["x"])
    within("y", y, *PLACE_RANGES["y"])
    place = np.array([x, y], dtype=float)
    near = nearest_points(points, place)[1]
    caption = "nearest: " + ", ".join("ABCDEFGHI"[k] for k in near)
    caption += "; a local maximum of the distance" if is_peak(points, place) else ""
    return new_point_frame(points, place, caption=caption) | {"view": PLACE_WINDOW}
