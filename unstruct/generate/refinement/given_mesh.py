"""What a mesh that is refined has: vertices in use, groups of cells with equal markers, names of regions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...mesh.mesh import Mesh
from ...mesh.naming import names_by_number

__all__ = ["OWN_MARKERS", "by_name", "groups_of_cells", "used_vertices"]

OWN_MARKERS = ("facets", "inner")  # made anew by `PlanarComplex.mesh`


def by_name(mesh: Mesh, value: Any) -> Any:
    """A limit by region with the names of regions instead of their numbers, where they have names."""
    if not isinstance(value, Mapping):
        return value
    called = names_by_number(mesh.regions)
    found = {called.get(key, key): limit for key, limit in value.items()}
    if len(found) < len(value):
        twice = next(key for key in value if called.get(key, key) != key)
        raise InputError(f"region {called[twice]!r} is named twice: by its name, and by its number {twice}")
    return found


def used_vertices(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """The vertices that cells use, and the place of each vertex among them."""
    mask = np.zeros(len(mesh.points), dtype=bool)
    mask[mesh.simplices.ravel()] = True
    return np.flatnonzero(mask), np.cumsum(mask, dtype=np.int32) - np.int32(1)


def groups_of_cells(mesh: Mesh) -> tuple[list[dict[str, Any]], NDArray[np.int64]]:
    """The different combinations of values of cell markers, and the number of that of each cell."""
    names = [name for name, rows in mesh.markers.items() if rows.ndim == 1]
    columns = [np.unique(mesh.markers[name], return_inverse=True)[1] for name in names]
    table = np.stack(columns, axis=1) if columns else np.zeros((mesh.size, 1), dtype=np.int64)
    _, first, group = np.unique(table, axis=0, return_index=True, return_inverse=True)
    rows = [{name: mesh.markers[name][t].item() for name in names} for t in first]
    return rows, group.reshape(-1)
