"""Columns of wedges cut into tetrahedra that fit, all of them exactly positive.

A quadrilateral is cut along the diagonal through its vertex of lowest number (`unstruct.mesh.split`), so
that both of its cells agree. The numbers grow from level to level, and in each level with the rays. So a
wedge over rays i < j < k is cut into

    i j k k'      i j k' j'      i k' j' i'        (in the order that makes them positive)

where a dash marks the level above. The first has the determinant of the Jacobian of the wedge at the corner
k, the last that at the corner i': both are positive where the wedge is. The tetrahedron between them need
not be: its determinant is one of the two terms whose *sum* is the middle coefficient of the wedge over j. A
prism that is twisted by 90 degrees is positive everywhere, and three of its six divisions have a negative
tetrahedron; of one twisted by 130 degrees all six do (see the tests). But as the heights of a column go to
zero, its upper triangles go to the lower ones, and the determinant, over the height, to that of the
Jacobian. So lower heights always help, and nothing else is needed. Pyramids, whose four determinants at the
base decide, are positive only if all tetrahedra of both divisions are.

Source: J. Dompierre, P. Labbe, M.-G. Vallet, R. Camarero, *How to subdivide pyramids, prisms, and hexahedra
into tetrahedra*, 8th International Meshing Roundtable (1999) 195-204. See the book, chapter 5.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...mesh.split import simplices_of_cells
from ...predicates.batch import orient_rows

__all__ = ["negative_parts", "tetrahedra", "twisted"]

LEVELS_AT_ONCE = 1 << 21  # of tetrahedra whose signs are decided together, to bound the memory


def tetrahedra(
    cells: Mapping[str, NDArray[np.integer]], rank: NDArray[np.integer] | None = None
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Cells of several kinds as tetrahedra that meet in common faces wherever the cells do.

    Parameters
    ----------
    cells : dict of str to (k, corners) array
        "tetra", "pyramid", "wedge", "hexahedron".
    rank : (n,) array of int, optional
        A number of its own for each vertex: diagonals start at the corner with the lowest. By default the
        numbers of vertices themselves.

    Returns
    -------
    simplices : (s, 4) int32
    owner : (s,) int64
        The cell that each is a part of, increasing; cells are counted through the kinds in their order.
    """
    if rank is None:
        return simplices_of_cells(cells)
    place = np.empty(int(rank.max(initial=-1)) + 1, dtype=np.int32)
    place[rank] = np.arange(len(rank))
    rows, owner = simplices_of_cells({kind: rank[block] for kind, block in cells.items()})
    return place[rows], owner


def negative_parts(
    points: NDArray[np.float64], cells: Mapping[str, NDArray[np.integer]], rank: NDArray | None = None
) -> NDArray[np.int64]:
    """The cells of whose tetrahedra not all are exactly positive, counted as `tetrahedra` does."""
    rows, owner = tetrahedra(cells, rank)
    return np.unique(owner[orient_rows(points, rows) <= 0])


def twisted(
    places: NDArray[np.float64],
    columns: NDArray[np.int32],
    stops: NDArray[np.integer] | None = None,
    base: NDArray[np.integer] | None = None,
) -> NDArray[np.bool_]:
    """Whether a wedge of a column has a tetrahedron that is not positive, although the wedge is.

    Parameters
    ----------
    places : (levels + 1, r, 3) float64
        Of the vertices, by level and ray.
    columns : (c, 3) int32
        Rows of rays, counterclockwise seen from above.
    stops : (r,) int, optional
        How many layers each ray has; all by default. Pyramids and tetrahedra above need not be asked.
    base : (r,) int, optional
        The number of the vertex of the wall at which each ray begins, where these are in another order than
        the rays: there are several at a vertex.

    Returns
    -------
    (c,) bool
        Exact. O(c levels).

    Notes
    -----
    Only the tetrahedron in the middle is looked at, i j k' j' for rays i < j < k.
    """
    levels, rays = len(places) - 1, places.shape[1]
    every = np.ascontiguousarray(places.reshape(-1, 3))
    wrong = np.zeros(len(columns), dtype=bool)
    lowest = np.full(len(columns), levels) if stops is None else stops[columns].min(axis=1)
    step = max(LEVELS_AT_ONCE // max(len(columns), 1), 1)
    ranges = [(0, levels, columns)] if base is None else [(0, 1, base[columns]), (1, levels, columns)]
    for begin, end, number in ranges:
        order = np.argsort(number, axis=1)
        low, middle, high = np.take_along_axis(columns, order, axis=1).astype(np.int64).T
        even = (order[:, 1] - order[:, 0]) % 3 == 1
        for first in range(begin, end, step):
            level = np.arange(first, min(first + step, end))[:, None] * rays
            i, j, up_j, up_k = level + low, level + middle, level + rays + middle, level + rays + high
            rows = np.stack([i, np.where(even, j, up_k), np.where(even, up_k, j), up_j], axis=-1)
            three = np.broadcast_to(level < lowest * rays, rows.shape[:2])
            chosen = np.flatnonzero(three.ravel())
            signs = orient_rows(every, rows.astype(np.int32).reshape(-1, 4)[chosen])
            wrong[chosen[signs <= 0] % len(columns)] = True
    return wrong
