"""The quality of the shape of cells of any kind: the measures that all kinds have, cell by cell.

Simplices are measured by `unstruct.simplex`. For a triangle that is given as a polygon, the measures of
quadrilaterals, polygons and solids here agree with it. See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.errors import InputError
from ..geometry import simplex
from ..geometry.scaled_jacobian import frame_jacobians, ring_angles, ring_jacobian, unit_scaled
from ..geometry.triangle_shapes import planar_shapes
from .cells import CELL_TYPES, cell_dimension, equal_rows, simplex_dimension
from .complex import CellComplex

__all__ = ["COMMON", "cell_quality"]

COMMON = ("scaled_jacobian", "min_angle", "max_angle")  # the qualities of all kinds of cells

# Corners of solids with the three edges that leave them, positive in a good cell: rows (v, a, b, c).
FRAMES = {
    "wedge": [(0, 1, 2, 3), (1, 2, 0, 4), (2, 0, 1, 5), (3, 5, 4, 0), (4, 3, 5, 1), (5, 4, 3, 2)],
    "hexahedron": [
        *((0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7)),
        *((4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3)),
    ],
    # A frame at each corner of the base, then for each of the same tetrahedra a frame at the apex.
    "pyramid": [
        *((0, 1, 3, 4), (1, 2, 0, 4), (2, 3, 1, 4), (3, 0, 2, 4)),
        *((4, 3, 1, 0), (4, 0, 2, 1), (4, 1, 3, 2), (4, 2, 0, 3)),
    ],
}
IDEAL_JACOBIAN = {"wedge": np.sqrt(3) / 2, "hexahedron": 1.0, "pyramid": np.sqrt(0.5)}


def cell_quality(mesh: CellComplex, name: str) -> np.ndarray:
    """One number for the shape of each cell, in the order of ``mesh.cells``: see `Mesh.quality`.

    Raises
    ------
    InputError
        For a name that is unknown, or that some kind of cell in the mesh does not have.
    """
    if not isinstance(name, str):
        raise InputError(f"the name of a quality must be a string, not {name!r:.60}")
    others = [kind for kind in mesh.cells if simplex_dimension(kind) is None]
    if list(mesh.cells) == ["triangle"]:
        found = planar_shapes(name, mesh.points, mesh.cells["triangle"])
        if found is not None:
            return found
    if name not in simplex.QUALITIES or not others:
        return simplex.quality(name, mesh.corners)
    if name not in COMMON:
        raise InputError(
            f"{name!r} is a quality of simplices, and this mesh has cells of kind {', '.join(others)}; "
            f"all kinds have {', '.join(map(repr, COMMON))}"
        )
    result = np.empty(mesh.size)
    start = 0
    for kind, block in mesh.cells.items():
        part = result[start : start + len(block)]
        start += len(block)
        if simplex_dimension(kind) is not None:
            part[:] = simplex.quality(name, mesh.points[block]) if len(block) else 0
        elif cell_dimension(kind) == 2:
            for which, rows in equal_rows(block):
                part[which] = _of_rings(name, unit_scaled(mesh.points[rows]))
        else:
            part[:] = _of_solids(name, kind, unit_scaled(mesh.points[block])) if len(block) else 0
    return result


def _of_rings(name: str, x: np.ndarray) -> np.ndarray:
    if name == "scaled_jacobian":
        return ring_jacobian(x)
    return np.degrees(_extreme(name)(ring_angles(x), axis=1))


def _of_solids(name: str, kind: str, x: np.ndarray) -> np.ndarray:
    if name == "scaled_jacobian":
        found = frame_jacobians(x, np.array(FRAMES[kind]))
        return found.min(axis=1) / IDEAL_JACOBIAN[kind]
    faces = [x[:, facet] for facet in CELL_TYPES[kind][3]]
    angles = [np.minimum(found, 2 * np.pi - found) for found in map(ring_angles, faces)]
    return np.degrees(_extreme(name)(np.concatenate(angles, axis=1), axis=1))


def _extreme(name: str) -> Callable[..., np.ndarray]:
    return np.min if name == "min_angle" else np.max
