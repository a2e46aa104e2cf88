"""Where the mesh ends: its boundary, and where that touches itself.

See the book, chapter 4c.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.triangle_tree import onto
from ...mesh.embedding import RidgeFans
from ...mesh.grouping import group_rows, sort_rows
from ...mesh.manifold import fans_of_faces
from ...mesh.topology import neighbors
from ...predicates.batch import power_of_two

__all__ = ["boundary_faces", "nearest_on", "overlapping_cells", "pinched_vertices"]

Array = NDArray[np.float64]
OPPOSITE = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # the faces of a tetrahedron, seen from outside


def boundary_faces(
    cells: NDArray[np.int32], on_surface: NDArray[np.bool_]
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """The faces of one cell only, seen from outside, and their cells: all their vertices are on the
    surface."""
    flags = on_surface[cells]
    rows = np.flatnonzero(flags.sum(axis=1) >= 3)
    faces, owner = [], []
    for face in OPPOSITE:
        whole = flags[rows[:, None], face].all(axis=1)
        faces.append(cells[rows[whole]][:, face])
        owner.append(rows[whole])
    found, cell = np.concatenate(faces), np.concatenate(owner)
    ordered = found.copy()
    sort_rows(ordered)
    group, first = group_rows(ordered)
    once = np.bincount(group, minlength=len(first))[group] == 1
    order = np.flatnonzero(once)
    order = order[np.argsort(cell[order], kind="stable")]
    return found[order], cell[order]


def pinched_vertices(faces: NDArray[np.int32], count: int) -> NDArray[np.int64]:
    """The vertices whose boundary faces form several fans, of `count` vertices."""
    ends = np.concatenate([faces[:, pair] for pair in combinations(range(3), 2)])
    sort_rows(ends)
    triangle = np.tile(np.arange(len(faces)), 3)
    group, first = group_rows(ends)
    order = np.argsort(group, kind="stable")
    start = np.searchsorted(group[order], np.arange(len(first)))
    two = np.bincount(group, minlength=len(first)) == 2
    one, other = triangle[order[start[two]]], triangle[order[start[two] + 1]]
    edge = ends[order[start[two]]]
    fans = fans_of_faces(
        (np.repeat(np.arange(len(faces)), 3), faces.ravel().astype(np.int64)),
        np.concatenate([np.stack([one, other], axis=1)] * 2),
        np.concatenate([edge[:, 0], edge[:, 1]]).astype(np.int64),
        count,
    )
    return np.flatnonzero(fans > 1)


@kernel
def _nearest_places(x, corners, which, places):
    """The point of triangle ``which[i]`` that is nearest to x[i]."""
    weight = np.empty(3)
    for i in range(len(x)):
        onto(x[i], corners[which[i]], weight)
        for a in range(3):
            places[i, a] = 0.0
            for k in range(3):
                places[i, a] += weight[k] * corners[which[i], k, a]


def nearest_on(x: Array, corners: Array, which: NDArray[np.int64]) -> Array:
    """The points of given triangles that are nearest to x (k, 3)."""
    places, factor = np.empty(x.shape), power_of_two(np.concatenate([x, corners.reshape(-1, 3)]))
    _nearest_places(x * factor, corners * factor, which, places)  # products of lengths may be no doubles
    return places / factor


def overlapping_cells(
    points: Array, cells: NDArray[np.int32], on_surface: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """The cells that wind more than once around an edge of the surface, by exact signs.

    A tetrahedron of the lattice whose four vertices have moved has no cell, and may turn over; then the cells
    beside it overlap. It happens at bubbles and gaps that are thinner than a cell (book, Proposition 4c.5).
    """
    rows = np.flatnonzero(on_surface[cells].sum(axis=1) >= 2)
    part = cells[rows]
    fans = RidgeFans(points, part, neighbors(part))
    found = fans.overlaps()
    found = found[on_surface[fans.ridges[found]].all(axis=1)]
    return np.unique(rows[fans.cells[found]])
