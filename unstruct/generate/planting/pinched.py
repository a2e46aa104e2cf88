"""Where leaves meet at corners or edges only, so that a mesh of them touches itself. See the book, 4a."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...mesh import topology
from ..hexahedra.pinches import pinched_vertices

__all__ = ["pinches"]

TOUCHES_ITSELF = "leaves meet here at {} only, and the mesh touches itself, near ({})"


def pinches(points: NDArray[np.float64], cells: NDArray[np.int32]) -> dict[int, str]:
    """The cells at which a mesh of simplices touches itself, and the reason, with the place: by cell."""
    neighbors = topology.neighbors(cells)
    border = topology.boundary(cells, neighbors)
    if points.shape[1] == 2:
        count = np.bincount(border.ravel(), minlength=len(points))  # two sides end at any other vertex
        bad = np.flatnonzero(count > 2)
    else:
        bad = pinched_vertices(cells, border, len(points))
    what = "a corner" if points.shape[1] == 2 else "a corner or an edge"
    at = np.isin(cells, bad)
    rows = np.flatnonzero(at.any(axis=1))
    vertex = cells[rows, at[rows].argmax(axis=1)]
    return {
        row: TOUCHES_ITSELF.format(what, ", ".join(f"{x:.6g}" for x in points[v]))
        for row, v in zip(rows.tolist(), vertex.tolist(), strict=True)
    }
