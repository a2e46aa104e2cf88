"""Bowyer-Watson insertion in the plane, compiled.

The triangulation covers the whole sphere: beyond every hull edge lies a *ghost* triangle, whose third
vertex is the ghost at infinity (number -1). Triangles are two flat arrays of half-edges, three per triangle:

    vertex[e]   the vertex of the triangle opposite half-edge e        e // 3  the triangle
    twin[e]     the half-edge of the neighboring triangle on the same edge

               vertex[e]
                  /\\                 half-edge e runs from vertex[next(e)] to vertex[prev(e)],
         prev(e) /  \\ next(e)        with its triangle on the left
                /____\\
            a      e      b

Why is no mark for the cavity needed, and why can no flat triangle arise? A triangle belongs to the cavity of
p exactly when p is strictly inside its circle (ties stay outside). The power of p decreases strictly across
every edge between a triangle with p inside and one with p not inside, so p sees each edge of the boundary of
the cavity strictly from within, and no old vertex is left without a triangle. Hence the dual of the cavity is
a tree. A depth-first search runs through it counterclockwise and meets the boundary edges in the order of the
star.
The circle of a ghost is the open half-plane beyond its hull edge, and the open edge itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from .engine import BUSY, COUNT, LAST, REACHED, Compiled, grown
from .halfedges import GHOST, conflict_across, locate2, locate_all2, next_edge, prev_edge, start2
from .removal import remove2


@kernel
def insert2(xy, vertex, twin, state, stack, spare, copy_of, stop):
    """Insert the next points, while ``p < stop``; ``copy_of`` records points that equal a vertex.

    For each point: locate it, run through its cavity counterclockwise, and join every edge of the boundary of
    the cavity to p as soon as it is met. The slots of the cavity are used again at once; a star has two
    triangles more than its cavity.
    """
    count, last = state[COUNT], state[LAST]
    for p in range(state[REACHED], stop):
        px, py = xy[p, 0], xy[p, 1]
        t = locate2(xy, vertex, twin, last, px, py)
        copy = -1
        for k in range(3):
            v = vertex[3 * t + k]
            if v != GHOST and xy[v, 0] == px and xy[v, 1] == py:
                copy = v
        if copy >= 0:
            copy_of[p] = copy
            state[REACHED] = p + 1
            continue
        state[BUSY] = 1
        spare[0] = t
        spares = 1
        stack[0], stack[1], stack[2] = twin[3 * t + 2], twin[3 * t + 1], twin[3 * t]
        depth = 3
        first = before = -1
        while depth > 0:
            depth -= 1
            o = np.int64(stack[depth])
            right, left = next_edge(o), prev_edge(o)
            a, b, c = vertex[left], vertex[right], vertex[o]
            if conflict_across(xy, a, b, c, px, py):
                spare[spares] = o // 3
                spares += 1
                stack[depth], stack[depth + 1] = twin[left], twin[right]
                depth += 2
                continue
            if spares > 0:
                spares -= 1
                new = 3 * np.int64(spare[spares])
            else:
                new = 3 * count
                count += 1
            vertex[new], vertex[new + 1], vertex[new + 2] = p, a, b
            twin[new], twin[o] = o, new
            if before < 0:
                first = new
            else:
                twin[new + 2], twin[before + 1] = before + 1, new + 2
            before = new
        twin[first + 2], twin[before + 1] = before + 1, first + 2
        last = before // 3
        state[COUNT], state[LAST], state[REACHED], state[BUSY] = count, last, p + 1, 0


@kernel
def cavity2(xy, vertex, twin, t, px, py, stack, found):
    """Triangles, ghosts included, whose open disk contains p, from one of them on; return how many."""
    found[0] = t
    size = 1
    for k in range(3):
        stack[k] = twin[3 * t + k]
    depth = 3
    while depth > 0:
        depth -= 1
        o = np.int64(stack[depth])
        right, left = next_edge(o), prev_edge(o)
        if conflict_across(xy, vertex[left], vertex[right], vertex[o], px, py):
            found[size] = o // 3
            size += 1
            stack[depth], stack[depth + 1] = twin[left], twin[right]
            depth += 2
    return size


class Planar(Compiled):
    """A growing Delaunay triangulation in the plane."""

    width = 3
    chunk = 100_000

    def _reserve(self, points: int) -> None:
        # n vertices and the ghost always have 2 n - 2 triangles
        self.vertex = grown(self.vertex, 6 * points)
        self.across = grown(self.across, 6 * points)

    def _start(self) -> None:
        start2(self.rows, self.vertex, self.across, self.state)

    def advance(self) -> None:
        """Insert the next chunk of the points that were added."""
        stop = min(self.size, self.done + self.chunk)
        room = 2 * stop + 4
        stack, spare = np.empty(room, dtype=np.int32), np.empty(room, dtype=np.int32)
        insert2(self.rows, self.vertex, self.across, self.state, stack, spare, self.copy_of, stop)

    def locate_all(self, rows: NDArray[np.float64]) -> NDArray[np.int32]:
        """For each row the slot of a triangle that contains it, or of a ghost beyond whose edge it lies."""
        found = np.empty(len(rows), dtype=np.int32)
        locate_all2(self.rows, self.vertex, self.across, int(self.state[LAST]), rows, found)
        return found

    def cavity(self, x: NDArray[np.float64]) -> NDArray[np.int32]:
        """Slots of the triangles, ghosts included, whose open disk contains x."""
        (t,) = self.locate_all(x[None])
        t = int(t)
        v = self.vertex[3 * t : 3 * t + 3]
        if (self.rows[v[v >= 0]] == x).all(axis=1).any():
            return np.empty(0, dtype=np.int32)
        room = 2 * self.size + 4
        stack, found = np.empty(room, dtype=np.int32), np.empty(room, dtype=np.int32)
        size = cavity2(self.rows, self.vertex, self.across, t, x[0], x[1], stack, found)
        return found[:size]

    def remove(self, rank: int) -> bool:
        """Remove a vertex; False, without any change, if the other vertices are collinear."""
        scratch = np.empty((4, 2 * self.size + 4), dtype=np.int64)
        return bool(remove2(self.rows, self.vertex, self.across, self.state, rank, scratch))
