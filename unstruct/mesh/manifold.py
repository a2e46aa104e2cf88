"""Is a complex a manifold, and coherently oriented? Pure combinatorics, for `unstruct.check`."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..base.jit import kernel
from .topology import FaceTable

__all__ = ["bad_vertex_links", "crowded_facets", "fans_of_faces", "incoherent_facets", "pinched_faces"]


def crowded_facets(faces: FaceTable) -> tuple[np.ndarray, np.ndarray]:
    """Facets shared by more than two cells, and those cells."""
    found, number = faces.facets()
    crowded = np.bincount(number.ravel(), minlength=len(found)) > 2
    return found[crowded], np.nonzero(crowded[number].any(axis=1))[0]


def incoherent_facets(faces: FaceTable) -> tuple[np.ndarray, np.ndarray]:
    """Facets on which their two cells induce the *same* orientation, and those cells.

    Two positively oriented cells induce opposite orientations exactly when they lie on opposite sides.
    """
    simplices = faces.simplices
    found, number = faces.facets()
    width = simplices.shape[1]
    signs = np.empty(simplices.shape)
    for i in range(width):
        others = [c for c in range(width) if c != i]
        inversions = sum(
            ((simplices[:, p] > simplices[:, q]).astype(int) for p, q in combinations(others, 2)),
            np.zeros(len(simplices), dtype=int),
        )
        signs[:, i] = 1 - 2 * ((inversions + i) % 2)
    total = np.bincount(number.ravel(), weights=signs.ravel(), minlength=len(found))
    bad = np.abs(total) > 1
    return found[bad], np.nonzero(bad[number].any(axis=1))[0]


@kernel
def _join(neighbors, number, contains, parent):
    """Union-find over pairs (cell, face): join those of neighboring cells with a face on their facet."""
    width, faces = number.shape[1], number.shape[1]
    for t in range(neighbors.shape[0]):
        for i in range(neighbors.shape[1]):
            s = neighbors[t, i]
            if s <= t:
                continue
            for c in range(faces):
                if contains[c, i]:
                    continue  # the face has the vertex opposite the facet, so it is not on the facet
                for e in range(faces):
                    if number[s, e] == number[t, c]:
                        a = _root(parent, t * width + c)
                        b = _root(parent, s * width + e)
                        if a < b:
                            parent[b] = a
                        else:
                            parent[a] = b
                        break


@kernel
def _root(parent, x):
    while parent[x] != x:
        parent[x] = parent[parent[x]]
        x = parent[x]
    return x


def pinched_faces(table: FaceTable, neighbors: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Faces (vertices, edges, ...) whose cells are not connected through the facets around them.

    Returns
    -------
    list of (faces, fans)
        For each dimension 0, ..., k - 2: the pinched faces (f, j + 1), and how many fans each has.

    Notes
    -----
    On a surface, a vertex is valid exactly when its link is one path or one cycle; this is what is tested. In
    higher dimensions the condition is necessary; `bad_vertex_links` completes it for k = 3.
    """
    width = table.simplices.shape[1]
    result = []
    for j in range(width - 2):
        found, number = table(j)
        contains = np.array(
            [[i in columns for i in range(width)] for columns in combinations(range(width), j + 1)]
        )
        parent = np.arange(number.size, dtype=np.int64)
        _join(neighbors, number, contains, parent)
        roots = np.nonzero(parent == np.arange(number.size))[0]
        fans = np.bincount(number.ravel()[roots], minlength=len(found))
        result.append((found[fans > 1], fans[fans > 1]))
    return result


def bad_vertex_links(table: FaceTable, boundary: np.ndarray, n: int) -> np.ndarray:
    """Vertices of a three-dimensional complex whose link is no disk (on the boundary) or sphere (inside).

    The link of a vertex in a complex without pinched edges or vertices is a connected surface; by the
    classification of surfaces its Euler characteristic, f_1 - f_2 + f_3 of the faces at the vertex, decides.
    """
    link = np.zeros(n, dtype=np.int64)
    for j in (1, 2, 3):
        found = table(j)[0] if j < 3 else table.simplices
        link += (1 if j != 2 else -1) * np.bincount(found.ravel(), minlength=n)
    wanted = np.full(n, 2)
    wanted[boundary.ravel()] = 1
    used = np.zeros(n, dtype=bool)
    used[table.simplices.ravel()] = True
    return np.nonzero(used & (link != wanted))[0]


def fans_of_faces(
    incident: tuple[np.ndarray, np.ndarray], cells: np.ndarray, faces: np.ndarray, count: int
) -> np.ndarray:
    """The number of fans that the cells around each face form, for cells of any kinds.

    Parameters
    ----------
    incident : (cells, faces), two ndarrays of int, shape (i,)
        All pairs of a cell and a face of it; a pair may occur several times.
    cells : ndarray of int, shape (p, 2)
        Pairs of cells that share a facet.
    faces : ndarray of int, shape (p,)
        For each pair a face that lies on the shared facet; the two cells are in the same fan around it.
    count : int
        The number of faces.

    Returns
    -------
    ndarray of int64, shape (count,)
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    keys = np.unique(incident[0].astype(np.int64) * count + incident[1])
    ends = [np.searchsorted(keys, cells[:, i].astype(np.int64) * count + faces) for i in (0, 1)]
    graph = csr_array((np.ones(len(faces), dtype=np.int32), (ends[0], ends[1])), shape=(len(keys), len(keys)))
    fans, label = connected_components(graph, directed=False)
    first = np.empty(fans, dtype=np.int64)
    first[label] = keys % count
    return np.bincount(first, minlength=count)
