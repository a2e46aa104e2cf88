"""Bowyer-Watson insertion in space, compiled.

As in the plane, a *ghost* tetrahedron lies beyond every hull facet; its vertex at infinity (number -1) is
always its last one. Tetrahedra are two flat arrays, four entries each:

    vertex[4 t + k]   vertex k of tetrahedron t
    across[4 t + k]   4 u + j: beyond the face opposite vertex k lies u, which has that face opposite vertex j

A tetrahedron is in the cavity of p exactly when p is strictly inside its sphere; ties stay outside. The ball
of a ghost is the open half-space beyond its hull facet and, in the plane of the facet, the open ball of the
tetrahedron on the other side.

No flat tetrahedron can arise, not even with ties. Let F be a face of the boundary of the cavity, T the cell
within and U the cell outside. The points where the powers with respect to the two spheres are equal are the
plane of F, and the power of T is the smaller one on T's side. At p the power of T is negative and that of U
is not; so p lies strictly on T's side of F. (Ghosts are limits of cells, and the rule above is the limit of
theirs.) In other words: every tie is decided as if the newer point were lifted a little. This is one
consistent perturbation, so walks never run in circles either.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import inline, kernel, lean
from ...predicates.batch import orient_at
from ...predicates.filters import filter_balls
from ...predicates.kernels import insphere, orient3
from .engine import BUSY, COUNT, FREE, GHOST, LAST, REACHED, STAMP, Compiled, grown, number_cells
from .stars import MOST_WALLS, Cavity, Space, ridges, small_star3, star3

# Why insert3 returned.
FINISHED = 0  # all points are inserted
MORE_CELLS = 1  # there are too few slots for tetrahedra
MORE_SCRATCH = 2  # the arrays for the cavity are too short

BALLS_AT_ONCE = 32  # so many cells at most are tested at once
LANES = 8  # numbers in the longest vectors of today's processors; a power of two that divides BALLS_AT_ONCE


class Batch(NamedTuple):
    """Cells that are tested at once: their slots, and the arrays of `filter_balls`."""

    cells: NDArray[np.int64]
    corners: NDArray[np.float64]
    dets: NDArray[np.float64]
    bounds: NDArray[np.float64]


def batch() -> Batch:
    """Arrays for BALLS_AT_ONCE cells."""
    return Batch(
        np.zeros(BALLS_AT_ONCE, dtype=np.int64),
        np.zeros((12, BALLS_AT_ONCE)),
        np.zeros(BALLS_AT_ONCE),
        np.zeros(BALLS_AT_ONCE),
    )


@inline
def _face_side(xyz, vertex, t, k, px, py, pz):
    """Orientation of tetrahedron t with its vertex k replaced by p."""
    a, b, c = vertex[4 * t + (k + 1) % 4], vertex[4 * t + (k + 2) % 4], vertex[4 * t + (k + 3) % 4]
    sign = orient3(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2],
        xyz[c, 0], xyz[c, 1], xyz[c, 2], px, py, pz,
    )  # fmt: skip
    return sign if k % 2 == 1 else -sign


@inline
def _ball(xyz, vertex, t, px, py, pz):
    a, b, c, d = vertex[4 * t], vertex[4 * t + 1], vertex[4 * t + 2], vertex[4 * t + 3]
    return insphere(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2],
        xyz[c, 0], xyz[c, 1], xyz[c, 2], xyz[d, 0], xyz[d, 1], xyz[d, 2], px, py, pz,
    )  # fmt: skip


@kernel
def conflict3(xyz, vertex, across, t, px, py, pz):
    """Is p in the open ball of tetrahedron t?"""
    if vertex[4 * t + 3] != GHOST:
        return _ball(xyz, vertex, t, px, py, pz) > 0
    side = _face_side(xyz, vertex, t, 3, px, py, pz)
    if side != 0:
        return side > 0
    return _ball(xyz, vertex, across[4 * t + 3] >> 2, px, py, pz) > 0


def start3(xyz, vertex, across, state):
    """The first tetrahedron, on points 0, 1, 2, 3, and its four ghosts."""
    corners = np.ascontiguousarray(xyz[:4, :3])  # rows may end with weights
    vertex[:4] = (0, 1, 2, 3) if orient_at(corners, np.arange(4)) > 0 else (0, 1, 3, 2)
    for k in range(4):
        ghost = 4 * (1 + k)
        for j in range(3):
            vertex[ghost + j] = vertex[(k + 1 + j) % 4]
        if k % 2 == 1:  # for these k the order above turns the ghost inside out
            vertex[ghost], vertex[ghost + 1] = vertex[ghost + 1], vertex[ghost]
        vertex[ghost + 3] = GHOST
        across[ghost + 3], across[k] = k, ghost + 3
    for k in range(4):  # two ghosts share the face over an edge, opposite the vertex that the other lacks
        for i in range(3):
            v = vertex[4 * (1 + k) + i]
            u = 0
            while vertex[u] != v:
                u += 1
            for j in range(3):
                if vertex[4 * (1 + u) + j] == vertex[k]:
                    across[4 * (1 + k) + i] = 4 * (1 + u) + j
    state[COUNT], state[LAST], state[FREE], state[STAMP] = 5, 0, 0, 1


@kernel
def locate3(xyz, vertex, across, t, px, py, pz):
    """Walk from t to a tetrahedron that contains p, or to a ghost beyond whose face p strictly lies."""
    if vertex[4 * t + 3] == GHOST:
        t = across[4 * t + 3] >> 2
    t = np.int64(t)
    entered = -1
    while vertex[4 * t + 3] != GHOST:
        out = -1
        for k in range(4):
            if k != entered and _face_side(xyz, vertex, t, k, px, py, pz) < 0:
                out = k
                break
        if out < 0:
            break
        face = np.int64(across[4 * t + out])
        t, entered = face >> 2, face & 3
    return t


@kernel
def locate_all3(xyz, vertex, across, t, rows, found):
    """`locate3` for each row; every walk begins where the last one ended."""
    for i in range(len(rows)):
        t = locate3(xyz, vertex, across, t, rows[i, 0], rows[i, 1], rows[i, 2])
        found[i] = t


@inline
def _gather(space, cells, head, size, tested, stamp):
    """Collect cells beside those in the queue from head on that are not tested yet, and mark them as tested.

    Returns how many, and the new head. There are no branches, which the processor could not foresee.
    """
    across, mark = space.across, space.mark
    count = 0
    while head < size and count + 4 <= BALLS_AT_ONCE:
        t = np.int64(cells[head])
        head += 1
        for k in range(4):
            u = np.int64(across[4 * t + k]) >> 2
            old = mark[u]
            fresh = old < 2 * stamp
            tested[count] = u
            count += fresh
            mark[u] = 2 * stamp + 1 if fresh else old
    return count, head


@lean
def cavity3(space, cavity, batch, t, p, stamp):
    """Breadth-first search from t for the cells of the cavity and its boundary faces, as 4 t + k from within.

    The cells beside those in the queue are tested together. ``mark`` becomes 2 stamp in the cavity and
    2 stamp + 1 in tested cells beside it. False if there is no room. The boundary faces are called walls.
    """
    xyz, vertex, across, mark, cells = space.xyz, space.vertex, space.across, space.mark, cavity.cells
    tested, corners, dets, bounds = batch
    px, py, pz = p
    cells[0] = t
    mark[t] = 2 * stamp
    size, walls, head = 1, 0, 0
    while head < size:
        if size + BALLS_AT_ONCE > cells.shape[0]:
            return False
        count, head = _gather(space, cells, head, size, tested, stamp)
        for i in range(count):
            for j in range(4):
                v = max(vertex[4 * tested[i] + j], 0)  # ghosts are not decided here
                corners[3 * j, i] = xyz[v, 0]
                corners[3 * j + 1, i] = xyz[v, 1]
                corners[3 * j + 2, i] = xyz[v, 2]
        filter_balls(corners, (count + LANES - 1) & -LANES, px, py, pz, dets, bounds)
        for i in range(count):
            u = tested[i]
            if abs(dets[i]) > bounds[i] and vertex[4 * u + 3] != GHOST:
                hit = dets[i] < 0
            else:
                hit = conflict3(xyz, vertex, across, u, px, py, pz)
            mark[u] = 2 * stamp + 1 - hit
            cells[size] = u
            size += hit
    for i in range(size):
        t = np.int64(cells[i])
        for k in range(4):
            cavity.faces[walls] = 4 * t + k
            walls += mark[across[4 * t + k] >> 2] != 2 * stamp
    cavity.sizes[0], cavity.sizes[1] = size, walls
    return True


@lean
def insert3(space, cavity, batch, ridges, copy_of, stop):
    """Insert the next points, while ``p < stop``: locate each, find its cavity, replace it by the star.

    Returns FINISHED, or what there is not enough of; the state is consistent in each case.
    """
    xyz, vertex, across, state = space.xyz, space.vertex, space.across, space.state
    capacity = space.mark.shape[0]
    for p in range(state[REACHED], stop):
        px, py, pz = xyz[p, 0], xyz[p, 1], xyz[p, 2]
        t = locate3(xyz, vertex, across, state[LAST], px, py, pz)
        copy = -1
        for k in range(4):
            v = vertex[4 * t + k]
            if v != GHOST and xyz[v, 0] == px and xyz[v, 1] == py and xyz[v, 2] == pz:
                copy = v
        if copy >= 0:
            copy_of[p] = copy
            state[REACHED] = p + 1
            continue
        stamp = state[STAMP]
        state[STAMP] = stamp + 1
        if not cavity3(space, cavity, batch, t, (px, py, pz), stamp):
            return MORE_SCRATCH
        if state[COUNT] + cavity.sizes[1] > capacity:
            return MORE_CELLS
        state[BUSY] = 1
        if cavity.sizes[1] <= MOST_WALLS:
            state[LAST] = small_star3(space, cavity, ridges, p)
        else:
            state[LAST] = star3(space, cavity, p, stamp)
        state[REACHED], state[BUSY] = p + 1, 0
    return FINISHED


@kernel
def _link(vertex, across, labels, number, linked_vertex, linked_across):
    """Write the numbered cells and what is across their faces, -1 where that is not numbered."""
    for t in range(number.shape[0]):
        i = 4 * number[t]
        if i < 0:
            continue
        for k in range(4):
            over = across[4 * t + k]
            beyond = number[over >> 2]
            linked_vertex[i + k] = labels[vertex[4 * t + k]]
            linked_across[i + k] = 4 * beyond + (over & 3) if beyond >= 0 else -1


class Spatial(Compiled):
    """A growing Delaunay triangulation in space."""

    width = 4
    chunk = 10_000

    def _reserve(self, points: int) -> None:
        if len(self.vertex) == 0:
            self.mark = np.empty(0, dtype=np.int32)
            self.free = np.empty(0, dtype=np.int32)
            self.batch, self.ridges = batch(), ridges(0)
            self._reserve_scratch(1024)
        if points >= len(self.ridges.place):
            self.ridges = ridges(points + points // 2)
        # uniform points have 6.8 tetrahedra each; if there are more, `advance` makes room
        self._reserve_cells(7 * points + 100)

    def _reserve_cells(self, slots: int) -> None:
        old = len(self.mark)
        if slots > old:
            slots = max(slots, old + old // 2)  # as `grown` does
        if 4 * slots >= 2**31:
            raise InputError(
                f"{self.size} points need more than 5 * 10^8 tetrahedra, the 32-bit limit: use fewer points"
            )
        vertex, across = grown(self.vertex, 4 * slots), grown(self.across, 4 * slots)
        mark, free = grown(self.mark, slots), grown(self.free, slots)
        mark[old:] = 0
        self.vertex, self.across, self.mark, self.free = vertex, across, mark, free

    def _reserve_scratch(self, cells: int) -> None:
        cavity, faces = np.empty(cells, dtype=np.int32), np.empty(4 * cells, dtype=np.int32)
        self.cavity_cells, self.faces = cavity, faces

    def _space(self) -> Space:
        return Space(self.rows, self.vertex, self.across, self.mark, self.free, self.state)

    def _cavity(self) -> Cavity:
        return Cavity(self.cavity_cells, self.faces, np.zeros(2, dtype=np.int64))

    def _start(self) -> None:
        start3(self.rows, self.vertex, self.across, self.state)

    def _advance(self, stop: int) -> int:
        return int(insert3(self._space(), self._cavity(), self.batch, self.ridges, self.copy_of, stop))

    def advance(self) -> None:
        """Insert the next chunk of the points that were added."""
        stop = min(self.size, self.done + self.chunk)
        while True:
            lacking = self._advance(stop)
            if lacking == FINISHED:
                return
            if lacking == MORE_CELLS:
                self._reserve_cells(len(self.mark) + len(self.mark) // 2 + len(self.faces))
            else:
                self._reserve_scratch(2 * len(self.cavity_cells))

    def linked(self, labels: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """The cells without ghosts in slot order, as in this file, with the labels of ranks as vertices."""
        count = int(self.state[COUNT])
        number = np.empty(count, dtype=np.int32)
        m = number_cells(self.vertex, self.width, count, number)
        vertex, across = np.empty(4 * m, dtype=np.int32), np.empty(4 * m, dtype=np.int32)
        _link(self.vertex, self.across, labels, number, vertex, across)
        return vertex, across

    def locate_all(self, rows: NDArray[np.float64]) -> NDArray[np.int32]:
        """For each row the slot of a tetrahedron that contains it, or of a ghost beyond whose face it is."""
        found = np.empty(len(rows), dtype=np.int32)
        locate_all3(self.rows, self.vertex, self.across, int(self.state[LAST]), rows, found)
        return found

    def cavity(self, x: NDArray[np.float64]) -> NDArray[np.int32]:
        """Slots of the tetrahedra, ghosts included, whose open ball contains x."""
        (t,) = self.locate_all(x[None])
        t = int(t)
        v = self.vertex[4 * t : 4 * t + 4]
        if (self.rows[v[v >= 0]] == x).all(axis=1).any():
            return np.empty(0, dtype=np.int32)
        while True:
            stamp = int(self.state[STAMP])
            self.state[STAMP] = stamp + 1
            found = self._cavity()
            if cavity3(self._space(), found, self.batch, t, (x[0], x[1], x[2]), stamp):
                return found.cells[: found.sizes[0]].copy()
            self._reserve_scratch(2 * len(self.cavity_cells))
