"""The colors of cells: by a field, by a quality, or by the region that they belong to."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_hex
from matplotlib.patches import Patch

from ...base.errors import InputError
from ...mesh.cells import cell_rows
from .sections import Shown

__all__ = ["COLOR_MAP", "Coloring", "cell_coloring", "legend", "value_scale"]

COLOR_MAP = "cividis"
REGION_COLORS = ("#56b4e9", "#e69f00", "#009e73", "#cc79a7", "#f0e442", "#0072b2", "#d55e00", "#bbbbbb")
NO_COLOR = "#000000"  # where a value is not a number
MOST_IN_LEGEND = 12  # in a legend


class Coloring(NamedTuple):
    """What gives the cells of a mesh their colors.

    Attributes
    ----------
    values : ndarray, shape (m,) or (n,)
        One number per cell, or one per vertex.
    by_vertex : bool
        Which of both.
    scale : Normalize
        From values to the color map; for regions, not used.
    regions : dict of int to str
        The names of regions; empty if the values are no regions.
    label : str
        What the values are.
    """

    values: np.ndarray
    by_vertex: bool
    scale: Normalize
    regions: dict[int, str]
    label: str

    def colors(self, values: np.ndarray) -> list[str]:
        """The colors of values, as ``#rrggbb``."""
        if self.regions:
            places = {value: k for k, value in enumerate(self.regions)}
            return [REGION_COLORS[places[int(v)] % len(REGION_COLORS)] for v in values.tolist()]
        chart = matplotlib.colormaps[COLOR_MAP]
        table = [to_hex(color) for color in chart(np.arange(chart.N))] + [NO_COLOR]
        lost = ~np.isfinite(values)
        share = np.ma.getdata(self.scale(np.where(lost, self.scale.vmin or 0.0, values)))
        step = np.clip((np.asarray(share) * chart.N).astype(int), 0, chart.N - 1)
        return [table[k] for k in np.where(lost, chart.N, step).tolist()]

    def of_cells(self, cells: Mapping[str, Any]) -> list[str]:
        """The color of each cell; from values at vertices, that of their mean."""
        if not self.by_vertex:
            return self.colors(self.values)
        if "" in cells:
            return self.colors(self.values[cells[""]].mean(axis=1))
        indptr, corners = cell_rows(cells)
        return self.colors(np.add.reduceat(self.values[corners], indptr[:-1]) / np.diff(indptr))

    def of_faces(self, shown: Shown) -> list[str]:
        """The color of each face: that of its cell, or of the mean of the values at its corners."""
        if not self.by_vertex:
            return self.colors(self.values[shown.owner])
        given = shown.rows >= 0
        values = shown.extended(self.values)[np.maximum(shown.rows, 0)]
        return self.colors(np.where(given, values, 0.0).sum(axis=1) / np.maximum(given.sum(axis=1), 1))


def cell_coloring(mesh: Any, values: Any, label: str = "", *, count: int | None = None) -> Coloring:
    """What ``values`` says: one number per cell or per vertex, or the name of a marker or of a quality.

    Parameters
    ----------
    mesh : Mesh
    values : array_like or str
        If there are as many cells as vertices, one number per cell.
    label : str
        By default the name.
    count : int, optional
        The number of cells that are shown, if these are not all.

    Raises
    ------
    InputError
        For a name that the mesh does not know, and for arrays of another shape.
    """
    size = len(mesh.simplices) if not hasattr(mesh, "size") else mesh.size
    size = size if count is None else count
    regions: dict[int, str] = {}
    if isinstance(values, str):
        label = label or values.replace("_", " ")
        marker = getattr(mesh, "markers", {}).get(values)
        if marker is not None and np.ndim(marker) == 1:
            given = np.asarray(marker)
            if given.dtype.kind in "iu":
                names = {number: name for name, number in mesh.regions.items()} if values == "region" else {}
                regions = {v: names.get(v, f"{values} {v}") for v in np.unique(given).tolist()}
        elif marker is not None or values == "region":
            cells = [name for name, array in mesh.markers.items() if np.ndim(array) == 1]
            raise InputError(f"the mesh has no marker {values!r} of cells; there are {cells}")
        else:
            given = mesh.quality(values)
        values = given
    array = np.asarray(values, dtype=float)
    by_vertex = array.shape == (len(mesh.points),) != (size,)
    if array.shape != (size,) and not by_vertex:
        raise InputError(
            f"values must have one entry per cell, shape ({size},), or per vertex, "
            f"shape ({len(mesh.points)},), not {array.shape}"
        )
    return Coloring(array, by_vertex, value_scale(array), regions, label)


def value_scale(values: np.ndarray) -> Normalize:
    """From the smallest to the largest finite value."""
    finite = values[np.isfinite(values)]
    return Normalize(float(finite.min()), float(finite.max())) if len(finite) else Normalize(0, 1)


def legend(ax: Axes, coloring: Coloring) -> None:
    """A color bar beside the picture, or the names of the regions."""
    if coloring.regions:
        colors = coloring.colors(np.array(list(coloring.regions)))
        pairs = list(zip(colors, coloring.regions.values()))[:MOST_IN_LEGEND]
        patches = [Patch(facecolor=color, edgecolor="#1a1a1a", label=name) for color, name in pairs]
        ax.legend(handles=patches, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        return
    scale = ScalarMappable(coloring.scale, COLOR_MAP)
    ax.figure.colorbar(scale, ax=ax, shrink=0.75, label=coloring.label, pad=0.02)
