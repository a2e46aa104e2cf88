"""Which cells are positive, which are turned inside out, and which are neither: exact, for all kinds.

The Jacobians are those of `unstruct.geometry.jacobians`. Here they are applied kind by kind, polygons are
tested for being simple, and negative cells are turned. See the book, chapters 1 and 12.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..base.errors import MeshError
from ..geometry.jacobians import content_signs, hexahedron_signs, pyramid_signs, wedge_signs
from ..predicates.batch import orient_rows
from .cells import cell_rows, equal_rows, simplex_dimension
from .complex import CellComplex
from .embedding import crossing_facets, segments_meet

__all__ = ["cell_signs", "jacobian_signs", "polygon_signs", "turned_cells"]

FEW_CORNERS = 64  # all pairs of sides are compared in polygons of at most this many corners
SIDES_PER_PART = 1 << 19  # pairs of sides at a time

# How the corners of a negative cell are listed to make it positive; simplices swap their first two.
MIRRORED = {
    "quad": [0, 3, 2, 1],
    "pyramid": [0, 3, 2, 1, 4],
    "wedge": [0, 2, 1, 3, 5, 4],
    "hexahedron": [0, 3, 2, 1, 4, 7, 6, 5],
}


def _full(mesh: CellComplex) -> None:
    d = mesh.points.shape[1]
    if mesh.dimension != d:
        raise MeshError(
            f"cells of dimension {mesh.dimension} have no sign in {d} dimensions: give cells of dimension {d}"
        )


def jacobian_signs(mesh: CellComplex) -> tuple[np.ndarray, np.ndarray]:
    """As `Mesh.jacobian_signs`, and the cells that the budget left undecided.

    Returns
    -------
    signs : ndarray of int8, shape (m,)
    undecided : ndarray of int64, shape (u,)
        Hexahedra whose Jacobian comes too close to zero to be decided within the budget; their sign is 0.
    """
    _full(mesh)
    signs, undecided, start = [np.empty(0, dtype=np.int8)], [np.empty(0, dtype=np.int64)], 0
    for name, block in mesh.cells.items():
        if name == "polygon":
            signs.append(polygon_signs(mesh.points, block))
        elif name == "quad":
            corners = np.concatenate([np.roll(block, -i, axis=1)[:, :3] for i in range(4)])
            every = orient_rows(mesh.points, corners).reshape(4, -1)
            signs.append(np.where(every.min(axis=0) == 1, 1, np.where(every.max(axis=0) == -1, -1, 0)))
        elif name == "pyramid":
            signs.append(pyramid_signs(mesh.points[block]))
        elif name == "wedge":
            signs.append(wedge_signs(mesh.points[block]))
        elif name == "hexahedron":
            found, left = hexahedron_signs(mesh.points[block])
            signs.append(found)
            undecided.append(start + np.nonzero(left)[0])
        else:
            signs.append(orient_rows(mesh.points, block))
        start += len(block)
    return np.concatenate(signs).astype(np.int8), np.concatenate(undecided)


def cell_signs(mesh: CellComplex) -> np.ndarray:
    """The exact sign of each cell's area or volume, that is, of the integral of its Jacobian: int8, (m,)."""
    _full(mesh)
    signs = [np.empty(0, dtype=np.int8)]
    for name, block in mesh.cells.items():
        if name == "polygon":
            signs.append(_area_signs(mesh.points, block))
        elif simplex_dimension(name) is not None:
            signs.append(orient_rows(mesh.points, block))
        else:
            signs.append(content_signs(name, mesh.points[block]))
    return np.concatenate(signs)


def turned_cells(mesh: CellComplex) -> dict[str, Any]:
    """The cells, where those of negative area or volume are turned: see `Mesh.oriented`."""
    negative = cell_signs(mesh) < 0
    result: dict[str, Any] = {}
    start = 0
    for name, block in mesh.cells.items():
        rows = np.nonzero(negative[start : start + len(block)])[0]
        start += len(block)
        if name == "polygon":
            polygons = list(block)
            for i in rows.tolist():
                polygons[i] = np.concatenate([block[i][:1], block[i][:0:-1]])
            result[name] = polygons
            continue
        result[name] = block.copy()
        if name in MIRRORED:
            result[name][rows] = block[rows][:, MIRRORED[name]]
        else:
            result[name][rows, :2] = block[rows, 1::-1]
    return result


# ---------------------------------------------------------------------- polygons


def polygon_signs(points: np.ndarray, polygons: Sequence[np.ndarray]) -> np.ndarray:
    """Whether polygons in the plane are simple, and their direction.

    Returns
    -------
    ndarray of int8, shape (m,)
        1 for simple counterclockwise polygons, -1 for simple clockwise ones, 0 where two sides meet in more
        than a common end, or where two corners are equal.

    Notes
    -----
    A polygon that turns the same way at every corner and has one lowest corner is convex: O(k). The sides
    of others are compared in pairs, or, with more than 64 corners, by a tree of boxes.
    """
    indptr, corners = cell_rows({"polygon": polygons})
    signs = np.zeros(len(polygons), dtype=np.int8)
    if len(polygons) == 0:
        return signs
    before, after = _around(indptr)
    turns = orient_rows(points, np.column_stack([corners[before], corners, corners[after]]))
    firsts = indptr[:-1]
    x, other_x, previous_x = points[corners], points[corners[after]], points[corners[before]]
    lowest = np.add.reduceat((_less(x, other_x) & _less(x, previous_x)).astype(np.int64), firsts)
    least, most = np.minimum.reduceat(turns, firsts), np.maximum.reduceat(turns, firsts)
    convex = (least == most) & (least != 0) & (lowest == 1)
    signs[convex] = least[convex]
    equal = np.logical_or.reduceat((x == other_x).all(axis=1), firsts)
    rest = np.nonzero(~convex & ~equal)[0]
    simple = rest[~_crossed(points, [polygons[i] for i in rest.tolist()])]
    signs[simple] = _area_signs(points, [polygons[i] for i in simple.tolist()])
    return signs


def _around(indptr: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each corner of a polygon the place of the one before and of the one after."""
    place = np.arange(indptr[-1])
    before, after = place - 1, place + 1
    before[indptr[:-1]] = indptr[1:] - 1
    after[indptr[1:] - 1] = indptr[:-1]
    return before, after


def _less(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a[:, 0] < b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] < b[:, 1]))


def _crossed(points: np.ndarray, polygons: list[np.ndarray]) -> np.ndarray:
    """Polygons with two sides that meet in more than a common end."""
    crossed = np.zeros(len(polygons), dtype=bool)
    for which, block in equal_rows(polygons):
        size = block.shape[1]
        if size > FEW_CORNERS:
            for i, row in zip(which.tolist(), block):
                crossed[i] = len(crossing_facets(points, np.column_stack([row, np.roll(row, -1)]))) > 0
            continue
        first, second = np.triu_indices(size, 1)
        step = max(1, SIDES_PER_PART // len(first))
        for k in range(0, len(block), step):
            part = block[k : k + step]
            sides = np.stack([part, np.roll(part, -1, axis=1)], axis=2)
            s, t = sides[:, first].reshape(-1, 2), sides[:, second].reshape(-1, 2)
            meet = segments_meet(points, s, t).reshape(len(part), -1)
            crossed[which[k : k + step]] = meet.any(axis=1)
    return crossed


def _area_signs(points: np.ndarray, polygons: Sequence[np.ndarray]) -> np.ndarray:
    signs = np.zeros(len(polygons), dtype=np.int8)
    for which, block in equal_rows(polygons):
        signs[which] = content_signs("polygon", points[block])
    return signs
