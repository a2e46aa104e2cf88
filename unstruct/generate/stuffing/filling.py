"""From a background with signs to the tetrahedra inside: cut points, moved vertices, stencils.

See the book, chapter 4c.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ..tree.lookup import Grid
from ..tree.vertices import Vertices, numbered
from .background import background_tetrahedra
from .rounds_of_raising import Background, Cut, poor_cells, raised_angles
from .stencils import Cuts, stenciled
from .warping import ALPHA, Edges, crossed_edges, warped

__all__ = ["Filling", "background_of", "filled_background", "lattice_vertices"]

Array = NDArray[np.float64]


GRADED_SHARE = 0.35  # of the shortest edge at a vertex where levels meet: it moves less (measured to be good)


class Filling(NamedTuple):
    """The tetrahedra inside.

    Attributes
    ----------
    points : (v, 3) float64
    cells : (k, 4) int32
    vertex : (v,) int64
        The vertex of the background, or its number of vertices plus that of the crossed edge.
    on_surface : (v,) bool
    owner : (k,) int64
        The tetrahedron of the background in which each cell lies.
    moved, cut : int
        The numbers of vertices that were moved and of cut points.
    raised : int
        The number of vertices that were moved, or moved again, because of angles.
    poor : (p,) int64
        Cells with a dihedral angle below 10 or above 165 degrees.
    """

    points: Array
    cells: NDArray[np.int32]
    vertex: NDArray[np.int64]
    on_surface: NDArray[np.bool_]
    owner: NDArray[np.int64]
    moved: int
    cut: int
    raised: int
    poor: NDArray[np.int64]


def lattice_vertices(grid: Grid) -> tuple[Array, NDArray[np.int64], Vertices]:
    """The corners and the centers of leaves: points, places, and the corners alone."""
    vertices = numbered(grid)
    first, last = vertices.corners[:, 0], vertices.corners[:, 7]
    low = vertices.points[first]
    centers = low + 0.5 * (vertices.points[last] - low)
    place = np.concatenate(
        [2 * vertices.coordinates, vertices.coordinates[first] + vertices.coordinates[last]]
    )
    return np.concatenate([vertices.points, centers]), place, vertices


def background_of(
    grid: Grid,
    vertices: tuple[Array, NDArray[np.int64], Vertices],
    sign: NDArray[np.int8],
) -> Background:
    """The background over the leaves of a tree, from `lattice_vertices` and their signs."""
    points, place, corners = vertices
    cells = background_tetrahedra(grid, corners.corners, sign)
    return Background(points, place, sign, cells, grid, corners.corners)


def filled_background(background: Background, shares: Callable[[Edges], Array]) -> Filling:
    """The tetrahedra inside.

    Parameters
    ----------
    background : Background
    shares : callable
        Where the surface cuts edges: 0 at the vertex inside, 1 at that outside.
    """
    points, place, n = background.points.copy(), background.place, len(background.points)
    sign = background.sign.copy()
    edges = crossed_edges(background.cells, sign)
    share = shares(edges)
    step = np.abs(place[edges.outer] - place[edges.inner])
    length = np.sqrt((step * step).sum(axis=1).astype(np.float64))
    alpha = np.where((step > 0).sum(axis=1) == 1, *ALPHA) * length
    least, mixed = _shortest(background)
    reach = _reach(edges, least, mixed)
    begin, end = points[edges.inner], points[edges.outer]
    places = np.where(
        (share <= 0.5)[:, None],
        begin + share[:, None] * (end - begin),
        end - (1.0 - share)[:, None] * (end - begin),
    )
    vertex, edge = warped(edges, share, length, np.minimum(alpha, reach))
    points[vertex], sign[vertex] = places[edge], 0
    raised = raised_angles(background, Cut(points, sign, edges.keys, places), least, mixed)
    whole = (sign[edges.inner] > 0) & (sign[edges.outer] < 0)
    cells, owner = stenciled(background.cells, sign, place, Cuts(edges.keys[whole], n))
    cuts = np.flatnonzero(whole)
    used, cells = _compressed(cells, n + len(cuts))
    new = used >= n
    number = np.where(new, n + cuts[np.where(new, used - n, 0)] if len(cuts) else used, used)
    found = np.concatenate([points, places[cuts]])[used]
    on_surface = np.concatenate([sign == 0, np.ones(len(cuts), dtype=bool)])[used]
    poor = poor_cells(found, cells, owner, raised.poor)
    moved = int(np.count_nonzero(sign != background.sign))
    return Filling(found, cells, number, on_surface, owner, moved, len(cuts), raised.changed, poor)


@kernel
def _look(cells, place, least, mixed):
    """The square of the shortest edge at each vertex; whether a cell there is none of a lattice of one
    level."""
    for row in range(len(cells)):
        short, long = np.int64(1) << 62, np.int64(0)
        for i in range(4):
            for j in range(i):
                p, q = cells[row, i], cells[row, j]
                square = np.int64(0)
                for a in range(3):
                    square += (np.int64(place[p, a]) - place[q, a]) ** 2
                short, long = min(short, square), max(long, square)
                least[p], least[q] = min(least[p], square), min(least[q], square)
        if 3 * long > 4 * short:
            for i in range(4):
                mixed[cells[row, i]] = True


def _shortest(background: Background) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The squares of the shortest edges at vertices, and at which vertices levels meet."""
    least = np.full(len(background.points), np.iinfo(np.int64).max)
    mixed = np.zeros(len(background.points), dtype=np.bool_)
    _look(background.cells, background.place, least, mixed)
    return least, mixed


def _reach(edges: Edges, least: NDArray[np.int64], mixed: NDArray[np.bool_]) -> Array:
    """How far the inner and the outer ends of edges may move: (2, e).

    In the lattice of one level, where the squares of long and short edges are as 4 to 3, this bounds nothing.
    Where levels meet, a long edge may begin beside a short one.
    """
    ends = np.stack([edges.inner, edges.outer])
    return np.where(mixed[ends], GRADED_SHARE * np.sqrt(least[ends].astype(np.float64)), np.inf)


@kernel
def _renumber(cells, number):
    for i in range(cells.shape[0]):
        for k in range(cells.shape[1]):
            cells[i, k] = number[cells[i, k]]


@kernel
def _use(cells, used):
    for i in range(cells.shape[0]):
        for k in range(cells.shape[1]):
            used[cells[i, k]] = True


def _compressed(cells: NDArray[np.int32], n: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """The vertices that are used, and the cells with new numbers, which are changed in place."""
    flags = np.zeros(n, dtype=np.bool_)
    _use(cells, flags)
    used = np.flatnonzero(flags)
    number = np.empty(n, dtype=np.int32)
    number[used] = np.arange(len(used))
    _renumber(cells, number)
    return used, cells
