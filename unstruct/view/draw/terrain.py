"""Terrains drawn as shaded surfaces."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from ...base.errors import InputError
from .colors import PAPER
from .plots import fit
from .strips import flat_axes

__all__ = ["plot_terrain"]

LIGHT = np.array([-0.6, -0.6, 0.53])  # from the upper left of the grid, 32 degrees above the horizon
AMBIENT = 0.5  # the light on a slope that is turned away


def plot_terrain(
    terrain: Any, ax: Axes | None = None, *, edges: bool = False, exaggeration: float = 2.0
) -> Axes:
    """Draw a terrain from above, with each triangle colored by its height and shaded by its slope.

    Parameters
    ----------
    terrain : Terrain
        See `unstruct.studies.greedy_terrain`. Row 0 of its grid is drawn at the top.
    ax : matplotlib axes, optional
        Where to draw; by default in a new figure.
    edges : bool
        Whether to draw the edges of the triangles.
    exaggeration : float
        A factor for the heights, used only for the shading.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        If the exaggeration is not a positive number.
    """
    if not 0 < exaggeration < np.inf:
        raise InputError(f"exaggeration = {exaggeration} must be a positive number")
    flat, heights = terrain.mesh.points[terrain.mesh.simplices], terrain.heights[terrain.mesh.simplices]
    corners = np.concatenate([flat, exaggeration * heights[..., None]], axis=2)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    shade = np.clip(normal @ (LIGHT / np.linalg.norm(LIGHT)), 0.0, 1.0)
    span = max(float(np.ptp(terrain.heights)), 1e-300)
    rgb = matplotlib.colormaps["cividis"]((heights.mean(axis=1) - terrain.heights.min()) / span)[:, :3]
    rgb = np.clip(rgb * (AMBIENT + (1.2 - AMBIENT) * shade[:, None] / 0.75), 0.0, 1.0)
    rgb = np.round(rgb * 20) / 20  # few colors, small files
    ax = flat_axes(ax)
    look: dict[str, Any] = {"edgecolors": rgb, "linewidths": 0.0, "antialiaseds": False}  # without seams
    if edges:
        look = {"edgecolors": PAPER, "linewidths": 0.3}
    ax.add_collection(PolyCollection(flat, facecolors=rgb, **look))
    fit(ax, terrain.mesh.points, 0.02)
    ax.invert_yaxis()
    return ax
