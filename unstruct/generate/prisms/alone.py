"""Layers without anything beyond them, as a mesh: some of their columns, and names.

Where a ray has no layers, its vertex is in the base and in the cap. With tetrahedra beyond this does no harm;
alone, the cells around it would be pinched, so that columns beside such rays are left out.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from .beyond import sides_of_layers, whole_faces
from .remainder import Grown
from .walls import Base

__all__ = ["Alone", "layers_of_columns"]

Rows = NDArray[np.int64]


class Alone(NamedTuple):
    """The arrays of a mesh of layers.

    Attributes
    ----------
    grown : Grown
        The columns that are kept, and their vertices.
    origin : (n,) int32
    markers : dict of str to array
    faces : (f, 3) int32
    face_piece : (f,) int32
    vertex : (v,) int64
        For each vertex of a wall the vertex of the mesh; -1 where no cell is left.
    """

    grown: Grown
    origin: NDArray[np.int32]
    markers: dict[str, NDArray[Any]]
    faces: NDArray[np.int32]
    face_piece: NDArray[np.int32]
    vertex: Rows


def _chosen(grown: Grown, kept: NDArray[np.bool_]) -> tuple[Grown, Rows]:
    """Some columns, and for each vertex its new number, -1 for those that no cell has."""
    chosen = kept[grown.column]
    cells, start = {}, 0
    for kind, rows in grown.cells.items():
        part = rows[chosen[start : start + len(rows)]]
        start += len(rows)
        if len(part):
            cells[kind] = part
    used = flagged(len(grown.points), *cells.values())
    place = np.where(used, np.cumsum(used) - 1, -1)
    some = Grown(
        grown.points[used],
        {kind: place[rows].astype(np.int32) for kind, rows in cells.items()},
        (np.cumsum(kept) - 1)[grown.column[chosen]],
        grown.layer[chosen],
        grown.stem[used],
        grown.level[used],
        place[grown.base[kept]],
        grown.piece[kept],
        np.where(grown.cap[kept] < 0, -1, place[grown.cap[kept]]),
    )
    return some, place


def layers_of_columns(base: Base, grown: Grown, kept: NDArray[np.bool_]) -> Alone:
    """The mesh of some columns.

    Parameters
    ----------
    base : Base
    grown : Grown
    kept : (c,) bool
        Which columns there are.
    """
    some, place = (grown, np.arange(len(grown.points))) if kept.all() else _chosen(grown, kept)
    faces, whole, pieces = sides_of_layers(base.domain, some, base.walls.piece, exposed=True)
    markers = {
        name: whole_faces(whole[np.isin(pieces[1], rows)]) for name, rows in base.markers.items() if len(rows)
    }
    return Alone(
        some,
        np.where(some.level == 0, base.origin[some.stem], -1).astype(np.int32),
        {name: rows for name, rows in markers.items() if len(rows)} | {"cap": some.cap},
        faces.astype(np.int32),
        pieces[0].astype(np.int32),
        place[: len(base.walls.points)],
    )
