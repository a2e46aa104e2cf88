"""Which sides of triangles are among given edges, found without sorting the sides that are not marked.

A mesh of millions of triangles has a few thousand marked edges; `numpy.isin` would sort, or hash, all sides.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..base.arrays import distinct
from . import topology
from .adjacency import chosen_cells, remaining_faces
from .cells import cell_rows
from .complex import CellComplex
from .grouping import group_rows
from .periodic import renumbered

__all__ = ["marked_facets", "marked_sides", "parts", "remaining", "remaining_of", "selected"]


def marked_sides(simplices: np.ndarray, edges: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Look up edges among the sides of triangles.

    Parameters
    ----------
    simplices : ndarray of int, shape (m, 3)
    edges : ndarray of int, shape (c, 2)
        In either direction; an edge may occur twice.
    n : int
        The number of vertices.

    Returns
    -------
    sides : ndarray of bool, shape (m, 3)
        Whether the side opposite each corner is among ``edges``.
    found : ndarray of bool, shape (c,)
        Whether each edge is a side of some triangle.

    Notes
    -----
    O(m + k log c), where k sides have two ends that belong to edges, not necessarily to the same one.
    """
    sides = np.zeros(simplices.shape, dtype=bool)
    if len(edges) == 0:
        return sides, np.zeros(0, dtype=bool)
    low, high = np.sort(edges, axis=1).astype(np.int64).T
    wanted, row_of = np.unique(low * n + high, return_inverse=True)
    hit = np.zeros(len(wanted), dtype=bool)
    marked = np.zeros(n, dtype=bool)
    marked[edges.ravel()] = True
    for i in range(3):
        a, b = simplices[:, (i + 1) % 3], simplices[:, (i + 2) % 3]
        cells = np.flatnonzero(marked[a] & marked[b])
        a, b = a[cells].astype(np.int64), b[cells].astype(np.int64)
        keys = np.minimum(a, b) * n + np.maximum(a, b)
        place = np.minimum(np.searchsorted(wanted, keys), len(wanted) - 1)
        same = wanted[place] == keys
        sides[cells[same], i] = True
        hit[place[same]] = True
    return sides, hit[row_of.ravel()]


def marked_facets(facets: np.ndarray, named: np.ndarray, n: int) -> np.ndarray:
    """Whether each of the rows of vertices ``facets`` (f, k), in any order, is a row of ``named`` (c, k)."""
    marked = np.zeros(n, dtype=bool)
    marked[named.ravel()] = True
    rows = np.flatnonzero(marked[facets].all(axis=1))
    group, _ = group_rows(np.sort(np.concatenate([named, facets[rows]]), axis=1))
    among = np.zeros(len(named) + len(rows), dtype=bool)
    among[group[: len(named)]] = True
    result = np.zeros(len(facets), dtype=bool)
    result[rows] = among[group[len(named) :]]
    return result


def parts(mesh: CellComplex, edges: Iterable) -> np.ndarray:
    """The part of each cell, if marked edges divide the mesh; parts are numbered by their first cells."""
    neighbors = np.array(mesh.neighbors)
    neighbors[marked_sides(mesh.simplices, np.asarray(edges), len(mesh.points))[0]] = -1
    label = topology.components(neighbors)[1]
    first = np.unique(label, return_index=True)[1]
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[label]


def remaining(faces: np.ndarray, simplices: np.ndarray) -> np.ndarray:
    """The rows of vertices that are still faces of some cell; -1 is a vertex that is gone."""
    return faces[_there(faces, simplices)]


def _there(faces: np.ndarray, simplices: np.ndarray) -> np.ndarray:
    """Which rows of vertices are faces of some cell."""
    there: np.ndarray = np.asarray((faces >= 0).all(axis=1))
    width = faces.shape[1]
    if not there.any() or width > simplices.shape[1]:
        return np.zeros(len(faces), dtype=bool)
    present = (
        topology.faces(simplices, width - 1) if width < simplices.shape[1] else np.sort(simplices, axis=1)
    )
    group, _ = topology.group_rows(np.concatenate([present, np.sort(faces[there], axis=1)]))
    known = np.zeros(len(group), dtype=bool)
    known[group[: len(present)]] = True
    there[there] = known[group[len(present) :]]
    return there


def remaining_of(markers: Mapping[str, np.ndarray], simplices: np.ndarray) -> dict[str, np.ndarray]:
    """`remaining` for the faces of many markers, those of equal width at once."""
    result = dict(markers)
    for width in {faces.shape[1] for faces in markers.values()}:
        some = {name: faces for name, faces in markers.items() if faces.shape[1] == width}
        every = np.concatenate(list(some.values()))
        there = _there(every, simplices)
        ends = np.cumsum([len(faces) for faces in some.values()])[:-1]
        result |= {n: rows[kept] for (n, rows), kept in zip(some.items(), np.split(there, ends))}
    return result


def selected(mesh: CellComplex, chosen: np.ndarray) -> dict[str, Any]:
    """The arguments of a mesh of some cells (numbers), on the vertices that they use; see `Mesh.select`.

    O(m + n) and, for kinds other than simplices, a hash table of all faces if markers name faces.
    """
    parts, order = chosen_cells(mesh.cells, chosen)
    cells: dict[str, Any] = {}
    for name, rows in parts.items():
        block = mesh.cells[name]
        cells[name] = [block[i] for i in rows.tolist()] if name == "polygon" else block[rows]
    used = distinct(cell_rows(cells)[1])
    number = np.full(len(mesh.points) + 1, -1, dtype=np.int32)  # the last entry belongs to -1, no vertex
    number[used] = np.arange(len(used))
    cells = {
        name: [number[row] for row in block] if name == "polygon" else number[block]
        for name, block in cells.items()
    }
    markers = {}
    faces = {name: number[rows] for name, rows in mesh.markers.items() if rows.ndim > 1}
    if mesh.is_simplicial:
        faces = remaining_of(faces, next(iter(cells.values())))
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            markers[name] = values[order]
        elif mesh.is_simplicial:
            markers[name] = faces[name]
        else:
            whole = ((number[values] >= 0) | (values < 0)).all(axis=1)
            markers[name] = remaining_faces(number[values[whole]], cells)
    return {
        "points": mesh.points[used],
        "cells": cells,
        "origin": mesh.origin[used],
        "markers": markers,
        "regions": mesh.regions,
        "weights": None if mesh.weights is None else mesh.weights[used],
        "periodic": renumbered(mesh.periodic, number),
    }
