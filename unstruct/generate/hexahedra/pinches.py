"""Vertices at which cells touch without a common face. See the book, chapter 4c."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...mesh import topology
from ...mesh.manifold import bad_vertex_links, pinched_faces

__all__ = ["pinched_vertices"]


def pinched_vertices(simplices: NDArray[np.int32], border: NDArray[np.integer], n: int) -> NDArray[np.int64]:
    """The vertices whose tetrahedra do not form a half-ball, and the ends of such edges.

    Parameters
    ----------
    simplices : (t, 3 + 1) int32
        Tetrahedra that meet in whole faces.
    border : ndarray of int
        The vertices on the boundary; only cells at these are looked at.
    n : int
        The number of vertices.
    """
    at_border = np.zeros(n, dtype=bool)
    at_border[border] = True
    near = simplices[at_border[simplices].any(axis=1)]
    if len(near) == 0:
        return np.empty(0, dtype=np.int64)
    table = topology.FaceTable(near)
    neighbors = table.neighbors()
    found = [bad_vertex_links(table, topology.boundary(near, neighbors), n)]
    for faces, _ in pinched_faces(table, neighbors):
        found.append(faces[at_border[faces].all(axis=1)].ravel())
    bad = np.unique(np.concatenate(found)).astype(np.int64)
    return bad[at_border[bad]]
