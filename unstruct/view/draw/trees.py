"""Pictures of quadtrees and octrees: leaves colored by level, and the boundary of the domain on top."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from ...base.arrays import as_numbers
from ...base.errors import InputError
from .coloring import COLOR_MAP
from .colors import PAPER, line_style
from .painting import picture
from .strips import fit, flat_axes

__all__ = ["plot_tree"]

WIDE_LEAVES = 2000  # with more leaves than this, the lines between them become thinner
THIN_LINE = 0.15


def plot_tree(
    tree: Any,
    ax: Axes | None = None,
    *,
    values: Any = None,
    label: str = "",
    boundary: bool = True,
    azimuth: float | None = None,
    elevation: float | None = None,
    section: Any = None,
) -> Axes:
    """Draw the leaves of a quadtree, or those of an octree that are not outside of the body.

    Parameters
    ----------
    tree : Tree
    ax : matplotlib axes, optional
        Where to draw; by default in a new figure.
    values : array_like, shape (n,), optional
        A number for each leaf, which colors it; by default its level.
    label : str
        Of the color bar; by default "level" for levels.
    boundary : bool
        Whether to draw the boundary of a planar domain.
    azimuth, elevation, section : optional
        For octrees, as in `plot`; a section shows the leaves inside, for example ``section=("x", 0.5)``.

    Returns
    -------
    matplotlib.axes.Axes
    """
    if not (hasattr(tree, "corners") and hasattr(tree, "levels")):
        raise InputError(f"plot_tree draws a Tree, not a {type(tree).__name__}")
    number = as_numbers(tree.levels if values is None else values, "values")
    if number.shape != (len(tree),):
        raise InputError(f"values must have one entry per leaf, shape ({len(tree)},), not {number.shape}")
    label = label or ("level" if values is None else "")
    given = {"azimuth": azimuth, "elevation": elevation, "section": section}
    view = {name: value for name, value in given.items() if value is not None}
    if tree.dimension == 3:
        mesh = tree.mesh("cells")
        return picture(mesh, ax, values=number[mesh.markers["leaf"]], label=label, **view)
    if view:
        raise InputError(f"{', '.join(view)}: only for octrees")
    ax = flat_axes(ax)
    low, high = tree.corners
    x, y = np.stack([low[:, 0], high[:, 0]]), np.stack([low[:, 1], high[:, 1]])
    around = np.stack([x[[0, 1, 1, 0]], y[[0, 0, 1, 1]]], axis=-1).transpose(1, 0, 2)
    width = max(THIN_LINE, min(0.6, 0.6 * (WIDE_LEAVES / len(tree)) ** 0.5))
    squares = PolyCollection(list(around), edgecolors=PAPER, linewidths=width, cmap=COLOR_MAP, zorder=2)
    squares.set_array(number)
    ax.add_collection(squares)
    ticks = np.unique(tree.levels) if values is None else None
    ax.figure.colorbar(squares, ax=ax, shrink=0.75, label=label, pad=0.02, ticks=ticks)
    if boundary and tree.boundary is not None:
        ends = tree.boundary.points[tree.boundary.pieces] / tree.boundary.factor
        style = line_style("constrained") | {"linewidth": 1.2}
        ax.add_collection(LineCollection(list(ends), zorder=3, **style))
    fit(ax, tree.box)
    return ax
