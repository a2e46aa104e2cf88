"""Rudin's tetrahedralization, from which no cell can be removed so that the rest is a solid ball.

M. E. Rudin (1958) divided a tetrahedron into 41 cells whose 14 vertices all lie on its boundary. It has the
symmetry (x, y, z) -> (-y, x, -z) of order four, so that one point and one cell of each orbit say it all. The
integer coordinates were found by trying the places of two points in a face. See the book, chapter 1.
"""

from __future__ import annotations

import numpy as np

from ..mesh.mesh import Mesh

__all__ = ["rudin_tetrahedron"]

QUARTER_TURN = np.array([(0, -1, 0), (1, 0, 0), (0, 0, -1)])
# A corner, two points in a face, and the middle of an edge, which a half turn moves onto itself.
FIRST_POINTS = [(13, 0, 13), (7, -2, 1), (1, 8, -11)]
MIDDLES = [(0, 0, 13), (0, 0, -13)]
# Vertex 4 k + i is point k, turned i times; 12 and 13 are the middles.
FIRST_CELLS = [
    (0, 1, 4, 11), (0, 1, 5, 11), (0, 4, 7, 10), (0, 4, 7, 11), (0, 5, 6, 9), (0, 5, 6, 11), (0, 6, 9, 12),
    (0, 6, 11, 12), (4, 5, 6, 7), (4, 5, 6, 11), (4, 6, 9, 12),
]  # fmt: skip


def rudin_tetrahedron() -> Mesh:
    """A tetrahedron divided into 41 cells, none of which can be removed without spoiling the solid ball.

    Returns
    -------
    Mesh
        14 vertices with integer coordinates, all on the boundary: four corners (the first four), two points
        in each face, and the middles of two edges. It is not Delaunay.

    Notes
    -----
    The smallest cell has a quarter of the mean volume. Source: M. E. Rudin, An unshellable triangulation of a
    tetrahedron, Bulletin of the American Mathematical Society 64 (1958) 90-91. Book: chapter 1.
    """
    turns = [np.linalg.matrix_power(QUARTER_TURN, i) for i in range(4)]
    points = [*((turn * p).sum(axis=1) for p in FIRST_POINTS for turn in turns), *MIDDLES]
    cells = {tuple(sorted(_turned(v, i) for v in cell)) for cell in FIRST_CELLS for i in range(4)}
    return Mesh(np.array(points, dtype=float), np.array(sorted(cells))).oriented()


def _turned(v: int, times: int) -> int:
    return v // 4 * 4 + (v + times) % 4 if v < 12 else 12 + (v + times) % 2
