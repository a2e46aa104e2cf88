"""Histograms of the shape of cells, for one mesh or for several ones side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import ScaledTranslation

from ...base.errors import InputError
from ...geometry.simplex import dihedral_angles
from .colors import line_style
from .colors import role as style_of
from .strips import axes_for

__all__ = ["plot_dihedrals", "plot_quality"]

ROLE_ORDER = ("circumcircle", "inserted", "voronoi", "layer", "front")


def plot_quality(meshes: Any, name: str = "min_angle", ax: Axes | None = None, *, bins: int = 36) -> Axes:
    """Histogram of a quality over the cells, for one mesh or for several named ones.

    Parameters
    ----------
    meshes : Mesh or dict of str to Mesh
        The meshes to compare; the legend shows the minimum and the mean of each.
    name : str
        One of `unstruct.simplex.QUALITIES`.
    bins : int
        Number of bins, common to all meshes.
    """
    values = {key: np.asarray(mesh.quality(name), dtype=float) for key, mesh in _named(meshes).items()}
    finite = [v[np.isfinite(v)] for v in values.values()]
    edges = np.histogram_bin_edges(np.concatenate(finite), bins)
    ax = _stairs(ax, values, edges)
    degrees = " (degrees)" if "angle" in name or "dihedral" in name else ""
    ax.set(xlabel=name.replace("_", " ") + degrees, ylabel="share of cells")
    return ax


def plot_dihedrals(meshes: Any, ax: Axes | None = None, *, bins: int = 36) -> Axes:
    """Histogram of all dihedral angles, six of each tetrahedron, for one mesh or for several named ones.

    Parameters
    ----------
    meshes : Mesh or dict of str to Mesh
        Tetrahedra; the legend shows the smallest and the largest angle of each mesh.
    bins : int
        Number of bins between 0 and 180 degrees.

    Raises
    ------
    InputError
        For meshes with other cells than tetrahedra.
    """
    values = {}
    for key, mesh in _named(meshes).items():
        if list(mesh.cells) != ["tetra"]:
            raise InputError(
                f"meshes: {key or 'this'} has the cells {list(mesh.cells)}, not tetrahedra alone"
            )
        values[key] = np.degrees(dihedral_angles(mesh.points[mesh.simplices])).ravel()
    ax = _stairs(ax, values, np.linspace(0, 180, bins + 1), largest=True)
    ax.set(xlabel="dihedral angle (degrees)", ylabel="share of angles", xlim=(0, 180))
    ax.set_xticks(range(0, 181, 30))
    return ax


def _named(meshes: Any) -> dict[str, Any]:
    """Meshes by name; a single one has none."""
    named = dict(meshes) if isinstance(meshes, Mapping) else {"": meshes}
    for key, mesh in named.items():
        if not hasattr(mesh, "quality"):
            raise InputError(f"meshes: {key or 'this'} is no Mesh but a {type(mesh).__name__}")
    return named


def _stairs(
    ax: Axes | None, values: Mapping[str, np.ndarray], edges: np.ndarray, *, largest: bool = False
) -> Axes:
    """Histograms over common bins, and a legend below with the extremes or the mean."""
    finite = {key: v[np.isfinite(v)] for key, v in values.items()}
    ax = axes_for(ax, (5.2, 3.0))
    for number, (key, v) in enumerate(finite.items()):
        style = ROLE_ORDER[number % len(ROLE_ORDER)]
        text = f"{key + ': ' if key else ''}minimum {v.min():.3g}, "
        text += f"maximum {v.max():.4g}" if largest else f"mean {v.mean():.3g}"
        lost = len(values[key]) - len(v)
        ax.stairs(
            np.histogram(v, edges)[0] / max(len(values[key]), 1),
            edges,
            fill=False,
            zorder=3,
            label=text + (f", {lost} not finite" if lost else ""),
            **line_style(style),
        )
        ax.stairs(
            np.histogram(v, edges)[0] / max(len(values[key]), 1),
            edges,
            fill=True,
            color=style_of(style).fill,
            alpha=0.25,
        )
    below = ax.transAxes + ScaledTranslation(0, -0.52, ax.figure.dpi_scale_trans)  # in inches
    ax.legend(loc="upper left", bbox_to_anchor=(0, 0), bbox_transform=below, borderaxespad=0)
    return ax
