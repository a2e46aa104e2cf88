"""Layers without anything beyond them, as a mesh: which columns it has so that it is a manifold, and names.

Where rays have no layers, cells of several columns may touch in a vertex or an edge only. With tetrahedra beyond
this does no harm; alone, such a mesh is none, and columns are left out.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from .beyond import sides_of_layers, whole_faces
from .remainder import Grown
from .stars import Stars
from .walls import Base

__all__ = ["Alone", "layers_of_columns", "manifold_columns"]

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


def manifold_columns(
    stars: Stars, columns: NDArray[np.integer], level: NDArray[np.integer]
) -> NDArray[np.bool_]:
    """Columns whose cells form one fan around each vertex and each edge.

    Parameters
    ----------
    stars : Stars
        Of the columns.
    columns : (c, 3) int
        Rows of rays.
    level : (r,) int
        The number of layers of each ray.

    Returns
    -------
    (c,) bool
        All columns with cells but those of smaller fans.
    """
    rises = level > 0
    kept = rises[columns].any(axis=1)
    ask = np.unique(columns[~rises[columns].all(axis=1)])
    while len(ask):
        dropped = _second_at_edges(stars, columns, kept, rises)
        for v in ask.tolist():
            fans = _fans(stars, columns, kept, rises, v)
            for fan in sorted(fans, key=len)[:-1]:
                dropped.extend(fan)
        kept[dropped] = False
        ask = np.unique(columns[dropped])
    return kept


def _second_at_edges(
    stars: Stars, columns: NDArray[np.integer], kept: NDArray[np.bool_], rises: NDArray[np.bool_]
) -> list[int]:
    """One of the two columns at each edge of two rays without layers, which have no face in common."""
    side = np.arange(len(stars.mates))
    t, k = side // 3, side % 3
    other = stars.mates // 3
    low = ~rises[columns[t, (k + 1) % 3]] & ~rises[columns[t, (k + 2) % 3]]
    wrong = low & (stars.mates >= 0) & (other < t) & kept[t] & kept[other]
    return t[wrong].tolist()


def _fans(
    stars: Stars, columns: NDArray[np.integer], kept: NDArray[np.bool_], rises: NDArray[np.bool_], v: int
) -> list[list[int]]:
    """The columns around a vertex that follow each other across faces.

    A vertex without layers of its own, with columns all around, is on the base and on the cap, which would
    touch there: one column is taken for a fan of its own, and so left out.
    """
    places = stars.around[stars.start[v] : stars.start[v + 1]].tolist()
    fans: list[list[int]] = []
    joined = False  # to the column before
    for place in places:
        t, k = divmod(place, 3)
        if kept[t]:
            if joined:
                fans[-1].append(t)
            else:
                fans.append([t])
        joined = bool(kept[t] and (rises[v] or rises[columns[t, (k + 2) % 3]]))
    first, last = places[0], places[-1]
    closed = stars.mates[3 * (last // 3) + (last % 3 + 1) % 3] >= 0
    if closed and joined and len(fans) > 1 and kept[first // 3]:
        fans[0] = fans.pop() + fans[0]
    elif closed and joined and not rises[v] and len(fans[0]) == len(places):
        fans.append([fans[0].pop()])
    return fans


def layers_of_columns(base: Base, grown: Grown, kept: NDArray[np.bool_]) -> Alone:
    """The mesh of some columns.

    Parameters
    ----------
    base : Base
    grown : Grown
    kept : (c,) bool
        Which triangles of the whole cap have columns.
    """
    chosen = kept[grown.column]
    cells, start = {}, 0
    for kind, rows in grown.cells.items():
        part = rows[chosen[start : start + len(rows)]]
        start += len(rows)
        if len(part):
            cells[kind] = part
    used = flagged(len(grown.points), *cells.values())
    place = np.where(used, np.cumsum(used) - 1, -1)
    t = len(grown.base)
    some = Grown(
        grown.points[used],
        {kind: place[rows].astype(np.int32) for kind, rows in cells.items()},
        (np.cumsum(kept) - 1)[grown.column[chosen]],
        grown.layer[chosen],
        grown.stem[used],
        grown.level[used],
        place[grown.base[kept[:t]]],
        grown.piece[kept[:t]],
        place[grown.cap[kept[:t]]],
        place[grown.fans[kept[t:]]],
    )
    faces, whole, pieces = sides_of_layers(base.domain, some, exposed=True)
    markers = {
        name: whole_faces(whole[np.isin(pieces[1], rows)]) for name, rows in base.markers.items() if len(rows)
    }
    return Alone(
        some,
        np.where(some.level == 0, base.origin[some.stem], -1).astype(np.int32),
        {name: rows for name, rows in markers.items() if len(rows)} | {"cap": some.whole_cap},
        faces.astype(np.int32),
        pieces[0].astype(np.int32),
        place[: len(base.walls.points)],
    )
