"""Adjacency of simplices as plain index arrays, without coordinates.

A complex is an array ``simplices`` of shape (m, k + 1): one row of vertex numbers for each cell. All work for
every k >= 1, in O(m) expected time (one hash table of faces) plus sorting. See the book, chapter 1.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..base.arrays import INT32
from ..base.errors import InputError, MeshError
from ..base.jit import kernel
from .grouping import group_rows, sort_rows

__all__ = [
    "as_simplices",
    "boundary",
    "components",
    "edges",
    "euler",
    "face_counts",
    "faces",
    "facets",
    "neighbors",
    "stars",
    "twins",
    "vertex_neighbors",
]


def as_simplices(simplices: np.ndarray, *, vertices: int | None = None) -> np.ndarray:
    """Return ``simplices`` as a C-contiguous int32 array of shape (m, k + 1), or say what is wrong.

    Parameters
    ----------
    simplices : array_like of int, shape (m, k + 1)
    vertices : int, optional
        The number of vertices; indices must then lie below it.

    Raises
    ------
    InputError
        Wrong shape or type, an index out of range, or a vertex repeated within a cell.
    """
    limit = 2**31 if vertices is None else vertices
    fits = type(simplices) is np.ndarray and simplices.dtype is INT32 and simplices.flags.c_contiguous
    if fits and simplices.ndim == 2 and simplices.shape[1] > 1 and _first_wrong(simplices, limit)[0] < 0:
        return simplices
    rows = np.asarray(simplices)
    if rows.ndim != 2 or rows.shape[1] < 2:
        raise InputError(f"simplices must have shape (m, k + 1) with k >= 1, not {rows.shape}")
    if rows.size and rows.dtype.kind not in "iu":
        raise InputError(f"simplices must be integers (vertex numbers), not {rows.dtype}")
    if np.ma.isMaskedArray(simplices) and np.ma.getmaskarray(simplices).any():
        row = int(np.nonzero(np.ma.getmaskarray(simplices).any(axis=1))[0][0])
        raise InputError(f"simplices[{row}] has masked entries; fill or drop it")
    table = np.ascontiguousarray(rows, dtype=np.int32 if rows.dtype == np.int32 else np.int64)
    row, twice = _first_wrong(table, limit)
    if row >= 0:
        wrong = "repeats a vertex; drop the cell" if twice else f"refers to vertices outside 0..{limit - 1}"
        raise InputError(f"simplices[{row}] = {rows[row].tolist()} {wrong}")
    return np.ascontiguousarray(table, dtype=np.int32)


@kernel
def _first_wrong(rows, limit):
    """The first row with a number out of range (and False) or with a number twice (and True); -1 if none."""
    for r in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            if rows[r, i] < 0 or rows[r, i] >= limit:
                return r, False
            for j in range(i):
                if rows[r, i] == rows[r, j]:
                    return r, True
    return -1, False


def incident_faces(simplices: np.ndarray, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """All faces of one dimension, and the faces of each cell.

    Returns
    -------
    faces : ndarray of int32, shape (f, dimension + 1)
        Each row sorted; rows in order of first appearance.
    number : ndarray of int64, shape (m, C(k + 1, dimension + 1))
        ``number[t, c]`` is the face on the c-th combination (in the order of `itertools.combinations`)
        of the columns of ``simplices[t]``.
    """
    m, width = simplices.shape
    columns = list(combinations(range(width), dimension + 1))
    rows = np.ascontiguousarray(simplices[:, columns].reshape(m * len(columns), dimension + 1))
    sort_rows(rows)
    group, first = group_rows(rows)
    return rows[first], group.reshape(m, len(columns))


def faces(simplices: np.ndarray, dimension: int) -> np.ndarray:
    """Faces of one dimension (0: used vertices, 1: edges, ...), rows sorted, in lexicographic order.

    Returns
    -------
    ndarray of int32, shape (f, dimension + 1)
    """
    simplices = as_simplices(simplices)
    if not 0 <= dimension < simplices.shape[1]:
        raise InputError(
            f"cells of dimension {simplices.shape[1] - 1} have no faces of dimension {dimension}"
        )
    if dimension == 0:
        return np.unique(simplices).astype(np.int32)[:, None]
    found, _ = incident_faces(simplices, dimension)
    if dimension == 1:  # one key is sorted faster than two
        return found[np.argsort(found[:, 0] * np.int64(2**31) + found[:, 1])]
    return found[np.lexsort(found.T[::-1])]


def edges(simplices: np.ndarray) -> np.ndarray:
    """Edges (i, j) with i < j, in lexicographic order: int32, shape (e, 2)."""
    return faces(simplices, 1)


def facets(simplices: np.ndarray) -> np.ndarray:
    """Faces of codimension one, rows sorted, in lexicographic order: int32, shape (f, k)."""
    return faces(simplices, np.shape(simplices)[1] - 2)


class FaceTable:
    """The faces of a complex in every dimension, each computed once: see `incident_faces`."""

    def __init__(self, simplices: np.ndarray):
        self.simplices = simplices
        self._known: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def __call__(self, dimension: int) -> tuple[np.ndarray, np.ndarray]:
        """(faces, number) as `incident_faces`; for dimension 0 face v is vertex v, used or not."""
        if dimension == 0:
            return np.arange(self.simplices.max(initial=-1) + 1, dtype=np.int32)[:, None], self.simplices
        if dimension not in self._known:
            self._known[dimension] = incident_faces(self.simplices, dimension)
        return self._known[dimension]

    def facets(self) -> tuple[np.ndarray, np.ndarray]:
        """(facets, number) as `incident_faces`, but ``number[t, i]`` is the facet opposite vertex i."""
        found, number = self(self.simplices.shape[1] - 2)
        return found, number[:, ::-1]  # the combination that leaves out column i comes i-th from the end

    def counts(self) -> tuple[int, ...]:
        """(f_0, ..., f_k)."""
        k = self.simplices.shape[1] - 1
        middle = [len(self(j)[0]) for j in range(1, k)]
        return (_count_used(self.simplices), *middle, len(self.simplices))

    def neighbors(self) -> np.ndarray:
        """As `neighbors`."""
        found, number = self.facets()
        result = np.full(self.simplices.shape, -1, dtype=np.int32)
        f, _ = _link(number, np.full(len(found), -1, dtype=np.int64), result)
        if f >= 0:
            cells = np.nonzero((number == f).any(axis=1))[0]
            raise MeshError(
                f"the facet {found[f].tolist()} is shared by {len(cells)} cells, {cells.tolist()[:6]}: "
                "neighbors exist only where at most two cells meet; drop some (unstruct.check lists all)"
            )
        return result


def _count_used(simplices: np.ndarray) -> int:
    """The number of different vertices."""
    top = int(simplices.max(initial=-1)) + 1
    if top > 8 * simplices.size:  # the numbers are far apart: avoid an array of that length
        return len(np.unique(simplices))
    used = np.zeros(top, dtype=bool)
    used[simplices] = True
    return int(np.count_nonzero(used))


@kernel
def _link(number, partner, result):
    """Join the two cells of each facet; return (-1, -1), or a facet with more cells and its third cell.

    ``partner[f]`` is -1 at first, then the corner t (k + 1) + i that saw facet f first, then -2.
    """
    width = number.shape[1]
    for t in range(number.shape[0]):
        for i in range(width):
            f = number[t, i]
            c = partner[f]
            if c == -1:
                partner[f] = t * width + i
            elif c == -2:
                return f, t
            else:
                s = c // width
                result[t, i] = s
                result[s, c - s * width] = t
                partner[f] = -2
    return -1, -1


def neighbors(simplices: np.ndarray) -> np.ndarray:
    """Neighbors across facets.

    Parameters
    ----------
    simplices : array_like of int, shape (m, k + 1)

    Returns
    -------
    ndarray of int32, shape (m, k + 1)
        ``neighbors[t, i]`` is the cell that shares the facet opposite vertex i of cell t, or -1.

    Raises
    ------
    MeshError
        Where more than two cells share a facet; the message names the facet and its cells.
    """
    return FaceTable(as_simplices(simplices)).neighbors()


def twins(neighbors: np.ndarray) -> np.ndarray:
    """The number of each facet in its other cell; facet i of cell t has the number t (k + 1) + i.

    In the plane these are half-edges.

    Parameters
    ----------
    neighbors : ndarray of int32, shape (m, k + 1)
        No two cells share more than one facet.

    Returns
    -------
    ndarray of int32, shape (m (k + 1),)
        For each facet its number in the cell beyond, or -1 on the boundary.
    """
    m, width = neighbors.shape
    back = (neighbors[neighbors] == np.arange(m)[:, None, None]).argmax(axis=2)
    return np.where(neighbors >= 0, width * neighbors + back, -1).astype(np.int32).ravel()


def oriented_facet(simplices: np.ndarray, cells: np.ndarray, corner: np.ndarray) -> np.ndarray:
    """The facets opposite ``corner`` of ``cells``, with the orientation that the cell induces.

    For a positively oriented cell this is outward: in 2D the cell lies to the left of the edge, in 3D
    the facet is counterclockwise seen from outside.
    """
    width = simplices.shape[1]
    keep = np.array([[j for j in range(width) if j != i] for i in range(width)])
    result = simplices[cells[:, None], keep[corner]]
    if width > 2:
        odd = corner % 2 == 1
        result[odd, :2] = result[odd, 1::-1]
    return result


def boundary(simplices: np.ndarray, neighbors: np.ndarray) -> np.ndarray:
    """Facets with a cell on one side only, outward-oriented where the cells are positively oriented.

    Parameters
    ----------
    simplices, neighbors : ndarray of int, shape (m, k + 1)

    Returns
    -------
    ndarray of int32, shape (b, k)
        In the order of (cell, opposite vertex).
    """
    cells, corner = np.nonzero(np.asarray(neighbors) < 0)
    return np.ascontiguousarray(oriented_facet(np.asarray(simplices), cells, corner), dtype=np.int32)


def rows_by_value(values: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Counting sort: (indptr, order) such that order[indptr[v]:indptr[v + 1]] are the places of v."""
    from scipy.sparse import csr_array

    places = np.arange(values.size, dtype=np.int32)
    by_value = csr_array((places, values, np.arange(values.size + 1)), shape=(values.size, n)).tocsc()
    return by_value.indptr, by_value.data


def vertex_neighbors(simplices: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices joined to each vertex by an edge, as compressed rows.

    Returns
    -------
    indptr, indices : ndarray of int32, shapes (n + 1,), (2 e,)
        Vertex v is joined to ``indices[indptr[v]:indptr[v + 1]]``, in increasing order.
    """
    pairs = edges(as_simplices(simplices, vertices=n))
    tails, heads = np.concatenate([pairs[:, 1], pairs[:, 0]]), np.concatenate([pairs[:, 0], pairs[:, 1]])
    # The first half has the smaller partners, the second the larger ones. Both are sorted, so every row is.
    indptr, order = rows_by_value(tails, n)
    return indptr.astype(np.int32), heads[order].astype(np.int32)


def stars(simplices: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Cells around each vertex, as compressed rows.

    Returns
    -------
    indptr, cells : ndarray of int32, shapes (n + 1,), (m (k + 1),)
        Vertex v belongs to ``cells[indptr[v]:indptr[v + 1]]``, in increasing order.
    """
    simplices = as_simplices(simplices, vertices=n)
    indptr, order = rows_by_value(simplices.ravel(), n)
    return indptr.astype(np.int32), (order // simplices.shape[1]).astype(np.int32)


def components(neighbors: np.ndarray) -> tuple[int, np.ndarray]:
    """The pieces that are connected through facets.

    Returns
    -------
    count : int
    label : ndarray of int32, shape (m,)
        The piece of each cell, numbered in order of appearance.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    neighbors = np.asarray(neighbors)
    cells, corner = np.nonzero(neighbors >= 0)
    shape = (len(neighbors), len(neighbors))
    graph = csr_array((np.ones(len(cells), dtype=np.int8), (cells, neighbors[cells, corner])), shape=shape)
    count, label = connected_components(graph, directed=False)
    return int(count), label.astype(np.int32)


def face_counts(simplices: np.ndarray) -> tuple[int, ...]:
    """(f_0, ..., f_k): the numbers of used vertices, edges, ..., cells."""
    return FaceTable(as_simplices(simplices)).counts()


def euler(simplices: np.ndarray) -> int:
    """Euler characteristic f_0 - f_1 + f_2 - ...; 1 for a ball, in every dimension."""
    return sum((-1) ** j * f for j, f in enumerate(face_counts(simplices)))
