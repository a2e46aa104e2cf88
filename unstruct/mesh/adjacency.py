"""Adjacency of cells of any kinds: facets and their two cells, stars, and faces that remain in a selection.

Cells are numbered through the kinds, in the order of the kinds. Further functions, for meshes of one kind of
simplex, are in `unstruct.topology`. See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..base.errors import MeshError
from ..base.jit import kernel
from .cells import cell_rows, incident_edges, incident_facets, simplex_dimension
from .grouping import group_rows
from .topology import incident_faces, rows_by_value

__all__ = ["chosen_cells", "facet_pairs", "remaining_faces", "same_rows", "stars_of_cells", "two_cells"]


def facet_pairs(cells: Mapping) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The facets of cells of any kinds, with the cells on both sides.

    Parameters
    ----------
    cells : dict of str to array
        As `CellComplex.cells`.

    Returns
    -------
    facets : ndarray of int32, shape (f, w)
        Rows in lexicographic order, each increasing and then padded by -1 up to the largest facet.
    pairs : ndarray of int32, shape (f, 2)
        The two cells with the lowest numbers, the lower first; -1 for none.
    count : ndarray of int64, shape (f,)
        How many cells each facet has.

    Notes
    -----
    O(n) expected for n incidences, by one hash table, and a sort of the facets.
    """
    name, block = next(iter(cells.items()))
    dimension = simplex_dimension(name)
    if len(cells) == 1 and dimension is not None:
        found, number = incident_faces(block, dimension - 1)
        owner = np.repeat(np.arange(len(block)), dimension + 1)
        group = number.ravel()
    else:
        rows, owner, group = incident_facets(cells)
        first = np.unique(group, return_index=True)[1]
        found = _increasing(rows[first])
    order = np.lexsort(found.T[::-1])
    rank = np.empty(len(found), dtype=np.int64)
    rank[order] = np.arange(len(found))
    pairs, count = np.full((len(found), 2), -1, dtype=np.int32), np.zeros(len(found), dtype=np.int64)
    _pair(rank[group], owner, pairs, count)
    return found[order], pairs, count


def _increasing(rows: np.ndarray) -> np.ndarray:
    """Each row sorted; the padding of -1 stays at the end."""
    last = np.iinfo(np.int32).max
    rows = np.sort(np.where(rows < 0, last, rows), axis=1)
    return np.where(rows == last, -1, rows).astype(np.int32)


@kernel
def _pair(number, owner, pairs, count):
    """Record the two lowest-numbered cells of each facet, in whatever order the cells come."""
    for r in range(number.shape[0]):
        f, t = number[r], owner[r]
        if count[f] == 0:
            pairs[f, 0] = t
        elif t < pairs[f, 0]:
            pairs[f, 1] = pairs[f, 0]
            pairs[f, 0] = t
        elif count[f] == 1 or t < pairs[f, 1]:
            pairs[f, 1] = t
        count[f] += 1


def two_cells(cells: Mapping) -> tuple[np.ndarray, np.ndarray]:
    """``facets`` and ``pairs`` of `facet_pairs`, for meshes with at most two cells at each facet.

    Raises
    ------
    MeshError
        If more than two cells share a facet; the message names the facets and the cells of the first.
    """
    facets, pairs, count = facet_pairs(cells)
    crowded = np.nonzero(count > 2)[0]
    if len(crowded):
        first = facets[crowded[0]]
        first = first[first >= 0]
        who = np.unique(_cells_at(cells, first)).tolist()
        others = [[v for v in row if v >= 0] for row in facets[crowded[1:7]].tolist()]
        also = f"; so are {', '.join(map(str, others))}" if others else ""
        more = "" if len(crowded) <= 7 else f", ... ({len(crowded)} in all)"
        raise MeshError(
            f"the facet {first.tolist()} is shared by {count[crowded[0]]} cells, {who[:6]}{also}{more}: "
            "facet_cells exist only where at most two cells meet; drop some (unstruct.check lists all)"
        )
    return facets, pairs


def _cells_at(cells: Mapping, facet: np.ndarray) -> np.ndarray:
    """The cells that have a facet with these vertices."""
    name, block = next(iter(cells.items()))
    if len(cells) == 1 and simplex_dimension(name) is not None:
        return np.nonzero(np.isin(block, facet).sum(axis=1) == len(facet))[0]
    rows, owner, _ = incident_facets(cells)
    return owner[same_rows(rows, [facet[None]])]


def stars_of_cells(cells: Mapping, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Cells around each vertex, as compressed rows: as `unstruct.topology.stars`, for any kinds.

    Returns
    -------
    indptr, cells : ndarray of int32, shapes (n + 1,), (corners of all cells,)
        Vertex v belongs to ``cells[indptr[v]:indptr[v + 1]]``, in increasing order.
    """
    indptr, corners = cell_rows(cells)
    start, order = rows_by_value(corners, n)
    owner = np.repeat(np.arange(len(indptr) - 1, dtype=np.int32), np.diff(indptr))
    return start.astype(np.int32), owner[order]


def chosen_cells(cells: Mapping, chosen: np.ndarray) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Some of the cells, by kind.

    Parameters
    ----------
    cells : dict of str to array
    chosen : ndarray of int, shape (c,)
        Numbers of cells, in any order.

    Returns
    -------
    parts : dict of str to ndarray
        For each kind the chosen rows, as numbers within the kind, in the order asked for. Kinds without a
        chosen cell are left out, unless no kind would remain.
    order : ndarray of int64, shape (c,)
        The numbers of the chosen cells, ordered by kinds, and within a kind in the order asked for.
    """
    ends = np.cumsum([len(block) for block in cells.values()])
    kind = np.searchsorted(ends, chosen, side="right")
    starts = ends - [len(block) for block in cells.values()]
    parts = {name: chosen[kind == i] - starts[i] for i, name in enumerate(cells)}
    order = chosen[np.argsort(kind, kind="stable")]
    kept = {name: rows for name, rows in parts.items() if len(rows)}
    return kept or parts, order


def remaining_faces(faces: np.ndarray, cells: Mapping) -> np.ndarray:
    """The rows of vertices that are still faces of some cell: as `marked.remaining`, for any kinds.

    Parameters
    ----------
    faces : ndarray of int, shape (c, j)
        Vertices, edges, facets or whole cells; rows of fewer vertices are padded by -1.
    cells : dict of str to array

    Returns
    -------
    ndarray of int, shape (r, j)
    """
    if len(faces) == 0:
        return faces
    width = faces.shape[1]
    facets, _, _ = incident_facets(cells)
    facets = facets[(facets[:, width:] < 0).all(axis=1), :width]
    present = [np.unique(cell_rows(cells)[1])[:, None], incident_edges(cells), facets]
    present += [np.asarray(block) for name, block in cells.items() if name != "polygon"]
    return faces[same_rows(faces, [rows for rows in present if rows.shape[1] <= width])]


def same_rows(rows: np.ndarray, others: list[np.ndarray]) -> np.ndarray:
    """Whether each row, as a set of vertices, is among the rows of ``others`` (-1 is no vertex)."""
    width = rows.shape[1]
    padded = [np.pad(part, ((0, 0), (0, width - part.shape[1])), constant_values=-1) for part in others]
    group, _ = group_rows(np.sort(np.concatenate([rows, *padded]), axis=1) + 1)
    known = np.zeros(len(group), dtype=bool)
    known[group[len(rows) :]] = True
    return known[group[: len(rows)]]
