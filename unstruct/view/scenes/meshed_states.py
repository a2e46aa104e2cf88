"""One region by one method at one size, and the triangle with the largest circumradius (section 2.6d)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...domain.domain import Domain
from ...examples.regions import plate, running_domain, word
from ...generate.centers.circumcenters import circumcenter_insertion
from ...generate.rebay.voronoi_segment import voronoi_segment
from ...generate.refinement.refine import refine
from ...geometry.simplex import angles, circumcenter, circumradius
from ..draw import frames as fr
from .choices import preset_named

__all__ = ["MESHED_METHODS", "MESHED_REGIONS", "MESHED_SIZES", "meshed_state"]


def _star() -> Domain:
    """A five-pointed star in one line; its middle is outside."""
    turn = np.pi / 2 + 4 * np.pi / 5 * np.arange(5)
    tips = np.column_stack([np.cos(turn), np.sin(turn)]).round(12)
    return Domain(tips, [(k, (k + 1) % 5) for k in range(5)], resolve=True)


MESHED_REGIONS = {"the lake": running_domain, "letters": word, "a plate": plate, "nasty: a star": _star}
MESHED_METHODS = {
    "Delaunay refinement": lambda domain, size: refine(domain, size, min_angle=25),
    "circumcenters": circumcenter_insertion,
    "Voronoi segments": voronoi_segment,
}
MESHED_SIZES = {"coarse": 5, "medium": 8, "fine": 11}  # the root of the area over the size
MESHED_EXTENT = np.array([3.0, 2.0])
MESHED_WINDOW = (-1.6, 1.6, -1.1, 1.1)


@lru_cache
def _region(name: str) -> Domain:
    return preset_named(MESHED_REGIONS, name)()


def meshed_state(
    region: str = "the lake", method: str = "Delaunay refinement", size: str = "medium"
) -> fr.Frame:
    """A mesh of a region by a method, with its triangle of the largest circumradius.

    Parameters
    ----------
    region : str
        One of `MESHED_REGIONS`.
    method : str
        One of `MESHED_METHODS`.
    size : str
        One of `MESHED_SIZES`: the size h is the root of the area over 5, 8 or 11.

    Returns
    -------
    dict
        The mesh, the worst triangle and its circle. The number has the count of triangles, the smallest and
        the largest angle, and the largest circumradius over h.
    """
    domain = _region(region)
    wanted = float(np.sqrt(domain.area)) / preset_named(MESHED_SIZES, size)
    mesh = preset_named(MESHED_METHODS, method)(domain, wanted)
    radii, found = circumradius(mesh.corners), np.degrees(angles(mesh.corners))
    worst = int(radii.argmax())
    low, high = np.array(domain.bounds)
    scale = ((high - low) / MESHED_EXTENT).max()  # all regions fit into one window
    points = (mesh.points - (low + high) / 2) / scale
    corners = points[mesh.simplices]
    items = [
        fr.polygons("cell", np.delete(corners, worst, axis=0)),
        fr.polygons("highlight", corners[[worst]]),
        fr.segments("constrained", points[mesh.segments]),
        fr.circles("circumcircle", [circumcenter(corners[worst])], [radii[worst] / scale]),
    ]
    number = f"{mesh.size} triangles, angles {found.min():.0f}° to {found.max():.0f}°, "
    number += f"largest R = {radii[worst] / wanted:.2f} h"
    return fr.frame(f"{region}, {method}, h = {wanted:.3f}", *items, number=number, view=MESHED_WINDOW)
