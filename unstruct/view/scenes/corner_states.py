"""What a sharp corner of a region does to its mesh, as a frame (section 2.6d)."""

from __future__ import annotations

import numpy as np

from ...domain.domain import Domain
from ...generate.centers.circumcenters import circumcenter_insertion
from ...generate.rebay.voronoi_segment import voronoi_segment
from ...generate.refinement.refine import refine
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["CORNER_ANGLES", "CORNER_METHODS", "corner_state"]

CORNER_ANGLES = (90.0, 60.0, 45.0, 30.0, 20.0, 10.0, 5.0, 2.0)
CORNER_SIZE = 0.3
CORNER_LENGTH, CORNER_HEIGHT, CORNER_WIDTH = 2.2, 2.4, 3.6
CORNER_WINDOW = (-0.2, 3.8, -0.25, 2.65)
CORNER_METHODS = {
    "Delaunay refinement": lambda domain: refine(domain, CORNER_SIZE, min_angle=25),
    "circumcenters": lambda domain: circumcenter_insertion(domain, CORNER_SIZE),
    "Voronoi segments": lambda domain: voronoi_segment(domain, CORNER_SIZE),
}


def corner_state(method: str = "Delaunay refinement", angle: float = 20.0) -> fr.Frame:
    """A region with one corner of the given angle, meshed.

    Parameters
    ----------
    method : str
        One of `CORNER_METHODS`.
    angle : float
        Of the corner, in degrees.

    Returns
    -------
    dict
        The mesh; cells that could not be made good are marked. The number has the smallest angle of these and
        that of all others.
    """
    make = preset_named(CORNER_METHODS, method)
    within("angle", angle, 1, 90)
    slope = np.tan(np.radians(angle))
    start, top = CORNER_LENGTH * min(1.0, 1 / slope), CORNER_LENGTH * min(1.0, slope)
    roof = [(CORNER_WIDTH, CORNER_HEIGHT), (start, CORNER_HEIGHT), (start, top)]
    corners = [(0.0, 0.0), (CORNER_WIDTH, 0.0), *roof]
    domain = Domain.polygon(corners)
    mesh = make(domain)
    smallest = mesh.quality("min_angle")
    left = np.zeros(mesh.size, dtype=bool)
    left[mesh.unrefined] = True
    items = [
        fr.polygons("cell", mesh.corners[~left]),
        fr.polygons("bad", mesh.corners[left]),
        fr.segments("constrained", domain.points[domain.facets]),
        fr.dots("bad", mesh.corners[left].mean(axis=1)),
    ]
    worst = f"{smallest[left].min():.1f}°" if left.any() else "none"
    number = f"{mesh.size} cells; smallest angle: given up {worst}, others {smallest[~left].min():.1f}°"
    many = int(left.sum())
    text = f"{many} cell{'s' * (many != 1)} given up at the corner of {angle:g}°"
    return fr.frame(text, *items, number=number, view=CORNER_WINDOW)
