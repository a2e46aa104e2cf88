"""Cells of several corners cut into simplices, so that neighbors cut their common facet in the same way.

A quadrilateral is cut along the diagonal through its lowest vertex number, which is the same seen from both
sides. The faces that contain the lowest vertex of a cell are then cut through that vertex, and the cell is
the cone from it over the triangles of its other faces: two tetrahedra for a pyramid, three for a wedge, six
for a hexahedron (J. Dompierre, P. Labbe, M.-G. Vallet, R. Camarero, *How to subdivide pyramids, prisms, and
hexahedra into tetrahedra*, 8th International Meshing Roundtable, 1999). See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .cells import CELL_TYPES, cell_dimension, equal_rows

__all__ = ["simplices_of_cells", "surface_triangles"]


def _from_lowest(rows: np.ndarray) -> np.ndarray:
    """Cyclic rows of vertices, turned until the lowest stands first."""
    first = rows.argmin(axis=1)
    places = (first[:, None] + np.arange(rows.shape[1])) % rows.shape[1]
    return np.take_along_axis(rows, places, axis=1)


def surface_triangles(kind: str, block: np.ndarray) -> np.ndarray:
    """The surface of solids as triangles, outward for positive cells: int, shape (m, t, 3)."""
    parts = []
    for facet in CELL_TYPES[kind][3]:
        rows = block[:, facet]
        if len(facet) == 4:
            rows = _from_lowest(rows)
            parts += [rows[:, [0, 1, 2]], rows[:, [0, 2, 3]]]
        else:
            parts.append(rows)
    return np.stack(parts, axis=1)


def simplices_of_cells(cells: Mapping) -> tuple[np.ndarray, np.ndarray]:
    """Cells of the plane or of space as simplices.

    Parameters
    ----------
    cells : dict of str to array
        Of dimension 2 or 3.

    Returns
    -------
    simplices : ndarray of int32, shape (s, k + 1)
        Triangles or tetrahedra, positive where the cells are convex with plane faces; polygons are fans
        from their lowest vertex. They meet in common faces wherever the cells do.
    owner : ndarray of int64, shape (s,)
        The cell that each is a part of, increasing.
    """
    parts, owners, start = [], [], 0
    for name, block in cells.items():
        number = start + np.arange(len(block))
        start += len(block)
        if name in ("triangle", "tetra"):
            parts.append(np.asarray(block))
            owners.append(number)
        elif cell_dimension(name) == 2:
            triangles, row = _fans(block)
            parts.append(triangles)
            owners.append(number[row])
        else:
            lowest = block.min(axis=1)
            triangles = surface_triangles(name, block)
            cell, which = np.nonzero((triangles != lowest[:, None, None]).all(axis=2))
            parts.append(np.column_stack([lowest[cell], triangles[cell, which]]))
            owners.append(number[cell])
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(parts).astype(np.int32)[order], owner[order]


def _fans(block: Any) -> tuple[np.ndarray, np.ndarray]:
    """Quadrilaterals or polygons as fans from their lowest vertices."""
    parts, rows = [np.empty((0, 3), dtype=np.int32)], [np.empty(0, dtype=np.int64)]
    for which, chosen in equal_rows(block):
        turned = _from_lowest(chosen)
        for i in range(1, chosen.shape[1] - 1):
            parts.append(turned[:, [0, i, i + 1]])
            rows.append(which)
    return np.concatenate(parts), np.concatenate(rows)
