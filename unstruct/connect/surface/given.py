"""The given surface: triangles in space, checked."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError, MeshError
from ...geometry.embedded import flat_rows
from ...mesh.mesh import Mesh

__all__ = ["refuse_flat", "surface_rows"]


def surface_rows(surface: Any, name: str = "surface") -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Points and triangles of a surface in space, or an error that says what is wrong.

    Parameters
    ----------
    surface : Mesh
        Triangles in space, none of them flat.
    name : str
        How errors call it.

    Raises
    ------
    InputError
        If it is none.
    MeshError
        If a triangle is flat or has a corner twice.
    """
    if not isinstance(surface, Mesh) or set(surface.cells) != {"triangle"} or surface.points.shape[1] != 3:
        raise InputError(f"{name} must be a Mesh of triangles in space, not {surface!r:.80}")
    rows = np.asarray(surface.simplices)
    refuse_flat(surface.points, rows, name)
    return surface.points, rows


def refuse_flat(points: NDArray[np.float64], rows: NDArray[np.int32], name: str = "surface") -> None:
    """Raise a `MeshError` if a triangle is flat or has a corner twice."""
    twice = (rows[:, 0] == rows[:, 1]) | (rows[:, 1] == rows[:, 2]) | (rows[:, 2] == rows[:, 0])
    flat = np.flatnonzero(twice)
    if len(flat) == 0:
        flat = flat_rows(points, rows)
    if len(flat):
        raise MeshError(
            f"triangle {flat[0]} of {name} = {rows[flat[0]].tolist()} is flat ({len(flat)} are): its corners "
            "lie on a line; remove it, and give the neighbor at its longest edge the point on it"
        )
