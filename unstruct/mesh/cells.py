"""Kinds of cells, by meshio's names, and their edges and facets in mixed meshes.

A mesh of one kind of simplex needs none of this: see `unstruct.topology`. See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ..base.arrays import frozen
from ..base.errors import InputError
from .grouping import group_rows
from .topology import as_simplices

__all__ = [
    "CELL_TYPES",
    "as_cells",
    "cell_dimension",
    "cell_rows",
    "counted",
    "equal_rows",
    "incident_edges",
    "incident_facets",
    "simplex_type",
]

# name -> (dimension, number of corners, edges, facets). Corners are in VTK's order; facets point outward.
CELL_TYPES: dict[str, tuple[int, int, list[list[int]], list[list[int]]]] = {
    "line": (1, 2, [[0, 1]], [[1], [0]]),
    "triangle": (2, 3, [[1, 2], [2, 0], [0, 1]], [[1, 2], [2, 0], [0, 1]]),
    "quad": (2, 4, [[0, 1], [1, 2], [2, 3], [3, 0]], [[0, 1], [1, 2], [2, 3], [3, 0]]),
    "tetra": (
        3,
        4,
        [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]],
        [[1, 2, 3], [2, 0, 3], [0, 1, 3], [1, 0, 2]],
    ),
    "pyramid": (
        3,
        5,
        [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]],
        [[0, 3, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    ),
    "wedge": (
        3,
        6,
        [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
        [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
    ),
    "hexahedron": (
        3,
        8,
        [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]],
        [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    ),
}
SIMPLEX_NAMES = {1: "line", 2: "triangle", 3: "tetra"}


def simplex_type(k: int) -> str:
    """The name of the simplex of dimension k: "line", "triangle", "tetra", "simplex4", "simplex5", ..."""
    return SIMPLEX_NAMES.get(k, f"simplex{k}")


def counted(count: int, name: str) -> str:
    """A number of cells in words: "1 triangle", "12 triangles", "5 tetrahedra", "3 4-simplices"."""
    if name.startswith("simplex"):
        return f"{count} {name[7:]}-simplex" if count == 1 else f"{count} {name[7:]}-simplices"
    word = {"tetra": "tetrahedron"}.get(name, name)
    if count == 1:
        return f"1 {word}"
    return f"{count} {word.removesuffix('on') + 'a' if word.endswith('hedron') else word + 's'}"


def simplex_dimension(name: str) -> int | None:
    """The dimension of a kind of simplex; None for kinds that are not simplices."""
    for k, known in SIMPLEX_NAMES.items():
        if name == known:
            return k
    return int(name[7:]) if name.startswith("simplex") and name[7:].isdigit() else None


def cell_dimension(name: str) -> int:
    """The dimension of a kind of cell, or an error that lists the known kinds."""
    simplex = simplex_dimension(name)
    if simplex is not None:
        return simplex
    if name == "polygon":
        return 2
    if name in CELL_TYPES:
        return CELL_TYPES[name][0]
    raise InputError(
        f"no kind of cell is called {name!r}; there are {', '.join(CELL_TYPES)}, polygon, simplex4, ..."
    )


def as_cells(cells: Mapping[str, Any], vertices: int) -> dict[str, Any]:
    """Validate a dictionary kind -> rows of vertex numbers; "polygon" may be ragged (a list of arrays)."""
    if not isinstance(cells, Mapping):
        raise InputError(
            f"cells must be a dictionary, for example {{'triangle': array}}, not {type(cells).__name__}"
        )
    if not cells:
        raise InputError("cells is empty: give at least one kind, for example {'triangle': array}")
    result: dict[str, Any] = {}
    for name, block in cells.items():
        cell_dimension(name)
        simplex = simplex_dimension(name)
        try:
            if name == "polygon":
                result[name] = _polygons(block, vertices)
                continue
            corners = CELL_TYPES[name][1] if simplex is None else simplex + 1
            rows = np.asanyarray(block)
            rows = rows.reshape(0, corners) if rows.shape == (0,) else rows  # an empty list
            rows = as_simplices(rows, vertices=vertices)
        except InputError as error:
            raise InputError(f"cells[{name!r}]: {error}") from None
        if rows.shape[1] != corners:
            raise InputError(f"cells[{name!r}] must have {corners} vertices per row, not {rows.shape[1]}")
        result[name] = frozen(rows)
    dimensions = {name: cell_dimension(name) for name in result}
    if len(set(dimensions.values())) > 1:
        raise InputError(f"cells of different dimensions, {dimensions}: keep lower ones as markers")
    return result


def _polygons(block: Any, vertices: int) -> tuple[np.ndarray, ...]:
    """Read-only rows of int32. All are tested together, and one by one only if something is wrong."""
    if not isinstance(block, Iterable):
        raise InputError(f"polygons must be a list of rows, not {block!r}")
    rows = [np.asarray(row) for row in block]
    for i, row in enumerate(block):
        if np.ma.isMaskedArray(row) and np.ma.getmaskarray(row).any():
            raise InputError(f"polygon {i} has masked entries; fill or drop it")
    if any(row.ndim != 1 or len(row) < 3 or row.dtype.kind not in "iu" for row in rows):
        return tuple(_polygon(row, i, vertices) for i, row in enumerate(rows))
    ends = np.cumsum(np.array([len(row) for row in rows], dtype=np.int64))
    flat = np.concatenate([np.empty(0, dtype=np.int64), *rows])
    owner = np.repeat(np.arange(len(rows)), np.diff(ends, prepend=0))
    order = np.lexsort((flat, owner))
    twice = (np.diff(flat[order]) == 0) & (np.diff(owner[order]) == 0)
    if flat.size and (flat.min() < 0 or flat.max() >= vertices or twice.any()):
        return tuple(_polygon(row, i, vertices) for i, row in enumerate(rows))
    flat = flat.astype(np.int32)
    flat.flags.writeable = False
    return tuple(flat[a:b] for a, b in zip([0, *ends.tolist()], ends.tolist()))


def _polygon(row: np.ndarray, index: int, vertices: int) -> np.ndarray:
    polygon = row
    if polygon.ndim != 1 or len(polygon) < 3 or polygon.dtype.kind not in "iu":
        raise InputError(f"polygon {index} must be at least three integers, not {polygon.tolist()}")
    if polygon.min() < 0 or polygon.max() >= vertices:
        raise InputError(f"polygon {index} = {polygon.tolist()} refers to vertices outside 0..{vertices - 1}")
    if len(np.unique(polygon)) < len(polygon):
        raise InputError(f"polygon {index} = {polygon.tolist()} repeats a vertex")
    polygon = polygon.astype(np.int32)
    polygon.flags.writeable = False
    return polygon


def cell_rows(cells: Mapping) -> tuple[np.ndarray, np.ndarray]:
    """The corners of all cells as compressed rows, numbered through the kinds in their order.

    Returns
    -------
    indptr : ndarray of int64, shape (m + 1,)
    corners : ndarray of int32, shape (indptr[-1],)
        Cell t has the corners ``corners[indptr[t]:indptr[t + 1]]``, in the order of its kind.
    """
    pieces, sizes = [np.empty(0, dtype=np.int32)], [np.zeros(1, dtype=np.int64)]
    for name, block in cells.items():
        if name == "polygon":
            pieces += block
            sizes.append(np.array([len(row) for row in block], dtype=np.int64))
        else:
            pieces.append(np.ravel(block))
            sizes.append(np.full(len(block), block.shape[1], dtype=np.int64))
    return np.cumsum(np.concatenate(sizes)), np.concatenate(pieces)


def equal_rows(block: Any) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The rows of one kind, grouped by length: pairs (numbers of the rows, the rows as an array)."""
    if isinstance(block, np.ndarray):
        if len(block):
            yield np.arange(len(block)), block
        return
    sizes = np.array([len(row) for row in block], dtype=np.int64)
    for size in np.unique(sizes).tolist():
        which = np.nonzero(sizes == size)[0]
        yield which, np.array([block[i] for i in which.tolist()])


def _incident(cells: Mapping, *, facets: bool) -> tuple[np.ndarray, np.ndarray]:
    """Rows of vertices (padded by -1) of the edges or the facets, and their cells."""
    pieces, owners, start = [], [], 0
    for name, block in cells.items():
        if name == "polygon":
            indptr, corners = cell_rows({name: block})
            following = np.arange(1, len(corners) + 1)
            following[indptr[1:] - 1] = indptr[:-1]
            pieces.append(np.column_stack([corners, corners[following]]))
            owners.append(start + np.repeat(np.arange(len(block)), np.diff(indptr)))
        else:
            for face in CELL_TYPES[name][3] if facets else CELL_TYPES[name][2]:
                pieces.append(block[:, face])
                owners.append(np.arange(start, start + len(block)))
        start += len(block)
    width = max((piece.shape[1] for piece in pieces), default=2)
    padded = [np.pad(p, ((0, 0), (0, width - p.shape[1])), constant_values=-1) for p in pieces]
    if not padded:
        return np.empty((0, width), dtype=np.int32), np.empty(0, dtype=np.int64)
    return np.concatenate(padded).astype(np.int32), np.concatenate(owners)


def _number(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    # Adding 1 keeps the padding non-negative, which hashing needs.
    group, first = group_rows(np.sort(rows, axis=1) + 1)
    return group, first


def incident_edges(cells: Mapping) -> np.ndarray:
    """The edges (i, j), i < j, of mixed cells, in lexicographic order: int32, shape (e, 2)."""
    rows, _ = _incident(cells, facets=False)
    _, first = _number(rows)
    found = np.sort(rows[first], axis=1)
    return found[np.lexsort(found.T[::-1])]


def incident_facets(cells: Mapping) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The facets of mixed cells as their cells see them.

    Returns
    -------
    rows : ndarray of int32, shape (r, w)
        One row for each cell and facet, outward for positively oriented cells, padded by -1 at the end.
    owner : ndarray of int, shape (r,)
        The cell (numbered through all kinds, in the order of the dictionary).
    group : ndarray of int64, shape (r,)
        Equal numbers for equal sets of vertices.
    """
    rows, owner = _incident(cells, facets=True)
    return rows, owner, _number(rows)[0]
