"""Edges of an intrinsic triangulation as polylines on the given surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...mesh.mesh import Mesh
from .points import Shape, line_start
from .tracing import Line, follow

__all__ = ["polylines"]

SPENT_LINE = 1e-11  # crossings so near the end of a line, in units of its length, are the end itself


@kernel
def _crossings(shape, edges, first, side, at, start):
    """Write crossings of edges from number ``first`` on; the next edge to be done when the room is full."""
    sides, places, line = shape.sides, shape.places, shape.line
    total = start[first]
    for i in range(first, edges.shape[0]):
        h = edges[i]
        v = sides.vertex[h]
        count = 0
        if sides.under[h] < 0:
            _, count = follow(
                shape.ground, line_start(places, v), places.weights[v], sides.turn[h],
                (1.0 - SPENT_LINE) * sides.length[h], line, False,
            )  # fmt: skip
        if count < 0 or total + count > side.shape[0]:
            return i
        for k in range(count):
            side[total + k], at[total + k] = line.side[k], line.at[k]
        total += count
        start[i + 1] = total
    return edges.shape[0]


def polylines(
    shape: Shape, edges: NDArray[np.int64], points: NDArray[np.float64], surface: Mesh
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points and starts of the polylines of half-edges; see `IntrinsicTriangulation.polylines`.

    Parameters
    ----------
    shape : Shape
    edges : (e,) int64
        Half-edges.
    points : (n, 3)
        Of the vertices.
    surface : Mesh
        The given one.
    """
    room = 4 * len(edges) + len(shape.line.side)
    start = np.zeros(len(edges) + 1, dtype=np.int64)
    side, at, done = np.empty(room, np.int32), np.empty(room), 0
    while (done := _crossings(shape, edges, done, side, at, start)) < len(edges):
        more, used = 2 * len(side), len(shape.line.side)
        side, at = np.resize(side, more), np.resize(at, more)
        shape = shape._replace(line=Line(np.empty(2 * used, np.int32), np.empty(2 * used), np.zeros(6)))
    total = int(start[-1])
    side, at = side[:total], at[:total]
    rows = np.asarray(surface.simplices).ravel()
    ends = surface.points[rows[side]], surface.points[rows[np.where(side % 3 == 2, side - 2, side + 1)]]
    inner = ends[0] + at[:, None] * (ends[1] - ends[0])
    after = np.where(edges % 3 == 2, edges - 2, edges + 1)
    vertex, count = shape.sides.vertex, np.diff(start)
    begin = start[:-1] + 2 * np.arange(len(edges))
    result = np.empty((total + 2 * len(edges), 3))
    result[begin], result[begin + count + 1] = points[vertex[edges]], points[vertex[after]]
    place = np.arange(total) + 2 * np.repeat(np.arange(len(edges)), count) + 1
    result[place] = inner
    return result, np.append(begin, len(result))
