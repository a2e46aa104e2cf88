"""A tetrahedron whose fourth corner moves on its sphere, and becomes a sliver there."""

from __future__ import annotations

import numpy as np

from ...geometry.simplex import dihedral_angles, volume
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import space_frame

__all__ = ["SLIVER_BASE", "sliver_state"]

SLIVER_BASE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # on the equator of the sphere


def sliver_state(latitude: float = 40.0, longitude: float = 270.0, seen_from: float = -60.0) -> fr.Frame:
    """Three corners on the equator of the unit sphere, and the fourth one anywhere on this sphere.

    Parameters
    ----------
    latitude : float
        Of D, from 0 (on the equator: the cell is flat) to 90 degrees.
    longitude : float
        Of D, in degrees; A, B and C are at 0, 90 and 180.
    seen_from : float
        The direction from which the reader looks, in degrees.

    Returns
    -------
    dict
        The cell in its sphere, with its smallest dihedral angle, and circumradius by shortest edge.
    """
    across, along = np.radians([latitude, longitude])
    d = np.array([np.cos(across) * np.cos(along), np.cos(across) * np.sin(along), np.sin(across)])
    corners = np.vstack([SLIVER_BASE, d])
    lengths = np.linalg.norm(corners[:, None] - corners[None], axis=2)
    shortest = lengths[np.triu_indices(4, 1)].min()
    flat = latitude == 0
    angle = 0.0 if flat else float(np.degrees(dihedral_angles(corners)).min())
    size = 0.0 if flat else abs(float(volume(corners)))
    circle = np.linspace(0, 2 * np.pi, 49)
    equator = np.column_stack([np.cos(circle), np.sin(circle), 0 * circle])
    ring = np.column_stack([np.arange(48), np.arange(1, 49)])
    bad = angle < 5
    role = "bad" if bad else "accepted"
    scene = [
        item3("segments", "circumcircle", ring, equator, opacity=0.7),
        item3("cells", role, [[0, 1, 2, 3]], corners, opacity=0.75),
        item3("points", "vertex", SLIVER_BASE),
        item3("points", "inserted", [d]),
        item3("labels", "vertex", corners, text="ABCD"),
        item3("spheres", "circumcircle", [[0, 0, 0, 1]]),
    ]
    near = shortest < 0.5
    name = "flat" if flat else "a short edge" if near else "a sliver" if bad else "a cell"
    text = f"R/l = {1 / shortest:.2f}, smallest dihedral angle {angle:.1f}°, volume {size:.3f}"
    return space_frame(scene, f"{name} in its sphere", number=text, azimuth=seen_from, elevation=24)
