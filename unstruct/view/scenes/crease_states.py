"""Layers across a sharp edge, with one ray or several at it: how good the worst cell is."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...mesh.mesh import Mesh
from ..draw import frames as fr

__all__ = ["CREASE_ANGLES", "CREASE_RAYS", "crease_state"]

CREASE_ANGLES = [10, 16, 30, 45, 60, 90, 120, 150]  # degrees between the two sides, within the body
CREASE_RAYS = list(range(1, 10))
CREASE_LEVELS = 0.15 * np.arange(5)  # where layers end, in lengths of the edge
CREASE_WINDOW = [-1.25, 0.85, -1.05, 1.05]
TELLS = 0.005  # cells that are worse than the worst one by less are marked, too


def crease_state(angle: float = 16.0, rays: int = 1) -> fr.Frame:
    """Four layers of equal heights around an edge of length 1, over an equilateral triangle on each side.

    Parameters
    ----------
    angle : float
        Of the body at the edge, in degrees: between 0 and 180.
    rays : int
        At each end of the edge: one, in the middle between the normals of the sides, or several, equally
        spaced from one normal to the other.

    Returns
    -------
    dict
        The section across the edge, with the rays; the worst cells; the smallest scaled Jacobian.
    """
    if not 0 < angle < 180:
        raise InputError(f"angle = {angle} must be between 0 and 180 degrees")
    if rays < 1:
        raise InputError(f"rays = {rays} must be at least 1")
    half = np.radians(angle) / 2
    most = np.pi / 2 - half  # from the middle to each of the normals
    turns = np.linspace(most, -most, rays) if rays > 1 else np.zeros(1)
    apexes = np.sqrt(0.75) * np.array([(-np.cos(half), np.sin(half)), (-np.cos(half), -np.sin(half))])
    upper, *at_edge, lower = map(_levels, [apexes[0], *np.zeros((rays, 2)), apexes[1]], [most, *turns, -most])
    sections, cells = [], []
    for k in range(len(CREASE_LEVELS) - 1):
        for apex, ray in ((upper, at_edge[0]), (lower, at_edge[-1])):
            sections.append([apex[k], ray[k], ray[k + 1], apex[k + 1]])
            ends = [[_at(apex[m], 0.0), _at(ray[m], -0.5), _at(ray[m], 0.5)] for m in (k, k + 1)]
            cells.append(np.array(ends[0] + ends[1]))
        for one, other in pairwise(at_edge):
            ring = [one[k], one[k + 1], other[k + 1], other[k]][: 4 if k else 3]
            sections.append(ring)
            cells.append(np.array([_at(p, y) for y in (-0.5, 0.5) for p in ring]))
    quality = np.array([_scaled_jacobian(x) for x in cells])
    worst = [ring for ring, q in zip(sections, quality) if q < quality.min() + TELLS]
    rows = [upper, *at_edge, lower]
    return fr.frame(
        f"{angle:g} degrees, {rays} ray{'s'[: rays > 1]}",
        fr.polygons("cell", [[apexes[0], (0, 0), apexes[1]]]),
        fr.polygons("layer", sections),
        fr.polygons("highlight", worst),
        fr.segments("inserted", [(row[0], row[-1]) for row in rows]),
        fr.segments("constrained", [(apexes[0], (0, 0)), ((0, 0), apexes[1])]),
        number=f"smallest scaled Jacobian {quality.min():.2f}",
        view=CREASE_WINDOW,
    )


def _levels(start: Any, turn: float) -> Any:
    """The places of a ray at all levels, in the section."""
    return np.asarray(start) + CREASE_LEVELS[:, None] * np.array([np.cos(turn), np.sin(turn)])


def _at(place: Any, along: float) -> tuple[float, float, float]:
    """A place of the section, moved along the edge."""
    return float(place[0]), along, float(place[1])


def _scaled_jacobian(x: Any) -> float:
    """Of one wedge or hexahedron, whose two ends are listed one after the other."""
    n = len(x) // 2
    kind = "wedge" if n == 3 else "hexahedron"
    if np.dot(np.cross(x[1] - x[0], x[n - 1] - x[0]), x[n] - x[0]) < 0:
        x = np.concatenate([x[:n][::-1], x[n:][::-1]])
    return float(Mesh(x, cells={kind: [range(2 * n)]}).quality("scaled_jacobian")[0])
