"""A sliver and its orthogonal sphere, whose center moves away as one corner gets a weight."""

from __future__ import annotations

import numpy as np

from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import space_frame

__all__ = ["POLE", "weight_state"]

POLE = 1.6  # E and F are this far above and below the plane of A, B and C
WEIGHT_BASE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # A, B, C on the unit circle


def weight_state(height: float = 0.1, weight: float = 0.0, seen_from: float = -60.0) -> fr.Frame:
    """Three corners on a unit circle; the fourth one, D, is a little above the circle and has a weight.

    Parameters
    ----------
    height : float
        Of D above the plane of the circle; positive.
    weight : float
        Of D, in the unit of a squared length; A, B, C and the poles E, F have none.
    seen_from : float
        The direction from which the reader looks, in degrees.

    Returns
    -------
    dict
        The cell with its orthogonal sphere, the height of the sphere's center, and whether the cell is still
        in the weighted Delaunay triangulation of the six points.
    """
    d = np.array([0.0, -1.0, height])
    center = (height**2 - weight) / (2 * height)
    square = 1 + center**2
    poles = np.array([[0.0, 0.0, POLE], [0.0, 0.0, -POLE]])
    hit = [(pole[2] - center) ** 2 < square for pole in poles]
    circle = np.linspace(0, 2 * np.pi, 49)
    ring = np.column_stack([np.cos(circle), np.sin(circle), 0 * circle])
    role = "muted" if any(hit) else "bad"
    scene = [
        item3(
            "segments", "circumcircle", np.column_stack([np.arange(48), np.arange(1, 49)]), ring, opacity=0.7
        ),
        item3("cells", role, [[0, 1, 2, 3]], np.vstack([WEIGHT_BASE, d]), opacity=0.75),
        item3("points", "vertex", WEIGHT_BASE),
        item3("points", "inserted", [d]),
        item3("points", "waiting", poles),
        item3("labels", "vertex", np.vstack([WEIGHT_BASE, d, poles]), text="ABCDEF"),
        item3("spheres", "circumcircle", [[0, 0, center, square**0.5]]),
    ]
    where = f"center at height {center:+.2f}"
    if any(hit):
        said, inside = "the sliver is gone", f"{'E' if hit[0] else 'F'} is inside"
    else:
        said, inside = "the sliver stays", "E and F are outside"
    return space_frame(scene, said, number=f"{where}; {inside}", azimuth=seen_from, elevation=16)
