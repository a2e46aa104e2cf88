"""All points of the plane at once, as half-edges for further work; see the book, 2.4a."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import fill
from ...base.errors import InputError
from ...base.jit import kernel
from ...geometry.ordering import along_curve, curve, draws, random_rounds
from ...predicates.kernels import orient2
from .engine import COUNT, REACHED
from .halfedges import HalfEdges, start2
from .plane import Planar, insert2
from .triangulation import Triangulation

__all__ = ["half_edges"]

RATIO = 8  # each round is about so many times as large as all rounds before it, as in `brio`
ROUNDS = 3  # the number of rounds, as in `brio`


@kernel
def _scale(xy):
    """Multiply by the factor of `power_of_two`; return it, and whether this is exact."""
    largest = 0.0
    for i in range(xy.shape[0]):
        for k in range(xy.shape[1]):
            largest = max(largest, abs(xy[i, k]))
    factor = 1.0 if largest == 0.0 else math.ldexp(1.0, min(-math.frexp(largest)[1], 1023))
    exact = True
    for i in range(xy.shape[0]):
        for k in range(xy.shape[1]):
            x = xy[i, k]
            xy[i, k] = x * factor
            exact = exact and xy[i, k] / factor == x
    return factor, exact


@kernel
def _not_on_a_line(xy, order):
    """The place in the order of the first point beside the line through the first two; -1 for none."""
    a, b = order[0], order[1]
    for k in range(2, len(order)):
        c = order[k]
        if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) != 0:
            return k
    return -1


@kernel
def _triangulate(xy, draw, levels, tables, half):
    """Scale the points, order them, insert them, and number the vertices as the points are numbered.

    Returns the factor; 0 if it is not exact, if some points are equal, or if all are on a line.
    """
    factor, exact = _scale(xy)
    if not exact:
        return 0.0
    vertex, twin = half
    ranks, turns = tables
    n = xy.shape[0]
    order = along_curve(xy, 2, random_rounds(draw, RATIO, ROUNDS), levels, ranks, turns)
    k = _not_on_a_line(xy, order)
    if k < 0:
        return 0.0
    third = order[k]  # the first triangle is moved to the front
    for i in range(k, 2, -1):
        order[i] = order[i - 1]
    order[2] = third
    rows = np.empty((n, 2))
    for i in range(n):
        rows[i, 0], rows[i, 1] = xy[order[i], 0], xy[order[i], 1]
    state, copy_of = fill(np.empty(8, dtype=np.int64), 0), np.empty(n, dtype=np.int32)
    stack, spare = np.empty(2 * n + 4, dtype=np.int32), np.empty(2 * n + 4, dtype=np.int32)
    start2(rows, vertex, twin, state)
    state[REACHED] = 3
    insert2(rows, vertex, twin, state, stack, spare, copy_of, n)
    if 3 * state[COUNT] < vertex.shape[0]:
        return 0.0
    for e in range(vertex.shape[0]):
        if vertex[e] >= 0:
            vertex[e] = order[vertex[e]]
    return factor


def half_edges(rows: NDArray[np.float64], *, progress: bool = False) -> HalfEdges:
    """The Delaunay triangulation of points in the plane: as `Triangulation`, without its records.

    Parameters
    ----------
    rows : ndarray, shape (n, 2)
        Finite coordinates.
    progress : bool
        Show a progress bar while they are inserted.

    Returns
    -------
    HalfEdges
        Vertices are numbered as the rows.

    Raises
    ------
    InputError
        For equal points, and for coordinates whose exponents differ too much for one scale.
    DegenerateInputError
        For points on a line.
    """
    n = len(rows)
    if 3 <= n <= Planar.chunk and not progress:  # this is so short that Ctrl-C may wait
        xy = rows.copy()
        vertex, twin = np.empty(6 * n - 6, dtype=np.int32), np.empty(6 * n - 6, dtype=np.int32)
        levels, *tables = curve(n, 2)
        factor = _triangulate(xy, draws(n, RATIO ** (ROUNDS - 1)), levels, tuple(tables), (vertex, twin))
        if factor > 0.0:
            return HalfEdges(xy, vertex, twin, factor)
    return _step_by_step(rows, progress)


def _step_by_step(rows: NDArray[np.float64], progress: bool) -> HalfEdges:
    """`half_edges` by a `Triangulation`: for many points, and to report what is wrong."""
    delaunay = Triangulation(rows, progress=progress)
    if not delaunay.spans:
        delaunay.mesh()  # raises, and says which flat contains the points
    start = delaunay.half_edges()
    if start is None:
        raise InputError(
            "the exponents of the coordinates differ too much for one scale: drop or move points that are "
            "closer to each other than 1e-300 of the largest coordinate"
        )
    for copy, kept in delaunay.duplicates[:1].tolist():
        raise InputError(f"points {kept} and {copy} are equal, {rows[copy].tolist()}: merge them first")
    return start
