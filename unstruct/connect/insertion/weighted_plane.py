"""Regular triangulations of the plane by insertion, compiled; triangles and ghosts are as in `plane`.

A weighted point p is lifted to the height |p|^2 - w. The triangulation is the lower hull of the lifted
points. A triangle is in the cavity of p exactly when p is strictly below its lifted plane. What differs from
equal weights:

* A point that is not below the plane of the triangle that contains it is *hidden*: nothing changes.
* All triangles around a vertex may be in the cavity. Then the vertex is hidden from now on.
* A vertex may lie in the lifted plane of others without being a corner of the hull there: its power cell has
  no interior. So that such points are hidden, too, in any order of insertion, ties are decided as if all
  lifted points were lowered by a tiny multiple of |p|^2: a point in the plane is below it if it is outside of
  the circle. What is left, cocircular points in one plane, is decided by the order of insertion.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import kernel
from ...predicates.kernels import incircle, orientation
from ...predicates.power import power2
from .engine import BUSY, COUNT, FREE, GHOST, LAST, REACHED, STAMP, grown
from .halfedges import UNUSED, locate2, next_edge, prev_edge
from .plane import Planar
from .stars import Space

__all__ = ["WeightedPlanar"]


@kernel
def conflict_weighted2(xyw, vertex, twin, t, p):
    """Is p below the lifted plane of triangle t? For a ghost: beyond its hull edge, or below that."""
    for e in range(3 * t, 3 * t + 3):
        if vertex[e] == GHOST:
            side = orientation(xyw, vertex[next_edge(e)], vertex[prev_edge(e)], p)
            if side != 0:
                return side > 0
            t = np.int64(twin[e]) // 3
            break
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    side = power2(xyw, a, b, c, p)
    if side != 0:
        return side > 0
    return (
        incircle(xyw[a, 0], xyw[a, 1], xyw[b, 0], xyw[b, 1], xyw[c, 0], xyw[c, 1], xyw[p, 0], xyw[p, 1]) < 0
    )


@kernel
def insert_weighted2(plane, cells, walls, at, stop):
    """Insert the next points, while ``p < stop``, or find that they are hidden.

    ``walls`` receives the edges of the boundary of a cavity: start, end, and the half-edge outside. ``at``
    has the new half-edge that leads from p to each vertex.
    """
    xyw, vertex, twin, mark, free, state = plane
    for p in range(state[REACHED], stop):
        t = np.int64(locate2(xyw, vertex, twin, state[LAST], xyw[p, 0], xyw[p, 1]))
        if not conflict_weighted2(xyw, vertex, twin, t, p):
            state[REACHED] = p + 1
            continue
        state[BUSY] = 1
        inside = 2 * state[STAMP]
        state[STAMP] += 1
        cells[0], mark[t] = t, inside
        size, count, head = 1, 0, 0
        while head < size:
            first = 3 * np.int64(cells[head])
            head += 1
            for e in range(first, first + 3):
                u = np.int64(twin[e]) // 3
                if mark[u] == inside:
                    continue
                if mark[u] != inside + 1:
                    if conflict_weighted2(xyw, vertex, twin, u, p):
                        cells[size], mark[u] = u, inside
                        size += 1
                        continue
                    mark[u] = inside + 1
                walls[count, 0], walls[count, 1] = vertex[next_edge(e)], vertex[prev_edge(e)]
                walls[count, 2] = twin[e]
                count += 1
        for i in range(size):
            free[state[FREE] + i] = cells[i]
            vertex[3 * np.int64(cells[i])] = UNUSED
        state[FREE] += size
        for i in range(count):
            if state[FREE] > 0:
                state[FREE] -= 1
                new = 3 * np.int64(free[state[FREE]])
            else:
                new = 3 * state[COUNT]
                state[COUNT] += 1
            mark[new // 3] = 0
            a, b, o = walls[i, 0], walls[i, 1], walls[i, 2]
            vertex[new], vertex[new + 1], vertex[new + 2] = p, a, b
            twin[new], twin[o] = o, new
            at[a] = new + 2  # at the ghost this is the last entry
            walls[i, 0] = new
        for i in range(count):
            e = walls[i, 0] + 1
            other = np.int64(at[walls[i, 1]])
            twin[e], twin[other] = other, e
            state[LAST] = e // 3
        state[REACHED], state[BUSY] = p + 1, 0


class WeightedPlanar(Planar):
    """A growing regular triangulation of the plane; rows are (x, y, w)."""

    def _reserve(self, points: int) -> None:
        if len(self.vertex) == 0:
            self.mark, self.free = np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)
        super()._reserve(points)
        before, slots = len(self.mark), len(self.vertex) // 3
        self.mark, self.free = grown(self.mark, slots), grown(self.free, slots)
        self.mark[before:] = 0

    def _start(self) -> None:
        super()._start()
        self.state[STAMP] = 1

    def advance(self) -> None:
        """Insert the next chunk of the points that were added."""
        stop = min(self.size, self.done + self.chunk)
        room = 2 * stop + 8
        cells, walls = np.empty(room, dtype=np.int32), np.empty((room, 3), dtype=np.int64)
        plane = Space(self.rows, self.vertex, self.across, self.mark, self.free, self.state)
        insert_weighted2(plane, cells, walls, np.empty(self.size + 1, dtype=np.int32), stop)
