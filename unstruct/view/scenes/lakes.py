"""The lake of the book under three kinds of meshes, with its area and the length of its shore (chapter 1)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...assess.check import check
from ...base.errors import InputError
from ...domain.domain import Domain
from ...examples.running import inside_polygon, island_shore, lake_shore, running_region
from ...examples.structured import ring_grid, tensor_grid
from ...generate.refinement.refine import refine
from ...mesh.mesh import Mesh
from ..draw import frames as fr
from .choices import within

__all__ = ["LAKE_MESHES", "lake_mesh", "lake_state"]

LAKE_MESHES = ("lattice", "bent grid", "triangles")
LAKE_WINDOW = [-0.05, 3.05, -0.05, 2.05]
TRUE_SPACING = 0.01  # of the polygon that stands for the true shore
SHORE_DISTANCE = 0.75  # about how far the shores of lake and island are from each other


def lake_mesh(kind: str, size: float) -> Mesh:
    """The lake in squares of a lattice, in a lattice bent between both shores, or in triangles.

    Parameters
    ----------
    kind : str
        One of `LAKE_MESHES`. Of the lattice, the squares whose centers are in the lake.
    size : float
        About the length of an edge, from 0.02 to 0.4.
    """
    within("size", size, 0.02, 0.4)
    if kind == "lattice":
        squares = tensor_grid(np.linspace(0, 3, round(3 / size) + 1), np.linspace(0, 2, round(2 / size) + 1))
        centers = squares.points[squares.cells["quad"]].mean(axis=1)
        return squares.select(inside_polygon(centers, *running_region(TRUE_SPACING)))
    if kind == "bent grid":
        turn = 2 * np.pi * np.arange(max(round(8 / size), 8)) / max(round(8 / size), 8)
        rings = np.linspace(0, 1, max(round(SHORE_DISTANCE / size), 2) + 1)
        return ring_grid(island_shore(-turn), lake_shore(turn), rings)
    if kind == "triangles":
        return refine(Domain(*running_region(size)), size)
    raise InputError(f"no kind {kind!r}; use one of {', '.join(LAKE_MESHES)}")


def lake_state(kind: str = "lattice", size: float = 0.2) -> fr.Frame:
    """A mesh of `lake_mesh` over the true shore, and what it says of the area and of the shore's length.

    Returns
    -------
    dict
        A frame. Folded cells are marked. The caption has the number of cells, the number the errors of the
        area (each cell counts as positive) and of the length of the boundary.
    """
    mesh = lake_mesh(kind, size)
    shape = "triangle" if kind == "triangles" else "quad"
    corners = mesh.points[mesh.cells[shape]]
    folded = np.unique([t for p in check(mesh).problems if p.kind == "negative cell" for t in p.cells])
    bad = np.isin(np.arange(len(corners)), folded)
    area, shore = _area_and_shore(*running_region(TRUE_SPACING))
    ends = mesh.points[mesh.boundary]
    found = np.abs(_areas(corners)).sum(), np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum()
    items: list[Any] = [fr.polygons("cell", corners[~bad])]
    if bad.any():
        items.append(fr.polygons("bad", corners[bad]))
    points, segments = running_region(TRUE_SPACING)
    items.append(fr.segments("circumcircle", points[segments]))
    items.append(fr.segments("edge", ends))
    caption = f"{kind}: {len(corners)} cells" + (f", {bad.sum()} of them folded" if bad.any() else "")
    number = f"area {found[0] / area - 1:+.1%}, shore {found[1] / shore - 1:+.1%}"
    return fr.frame(
        caption, *items, number=number.replace("-0.0%", "0.0%").replace("-", "−"), view=LAKE_WINDOW
    )


def _areas(corners: np.ndarray) -> np.ndarray:
    after = np.roll(corners, -1, axis=1)
    return (corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]).sum(axis=1) / 2


def _area_and_shore(points: np.ndarray, segments: np.ndarray) -> tuple[float, float]:
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    area = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2
    return float(area), float(np.hypot(*(b - a).T).sum())
