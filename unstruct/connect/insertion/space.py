"""Bowyer-Watson insertion in space, compiled.

As in the plane, a *ghost* tetrahedron lies beyond every hull facet; its vertex at infinity (number -1) is
always its last one. Tetrahedra are two flat arrays, four entries each:

    vertex[4 t + k]   vertex k of tetrahedron t
    across[4 t + k]   4 u + j: beyond the face opposite vertex k lies u, which has that face opposite vertex j

A tetrahedron is in the cavity of p if p is strictly inside its sphere; ties stay outside. The ball of a
ghost is the open half-space beyond its hull facet and, in the plane of the facet, the open ball of the
tetrahedron on the other side.

No flat tetrahedron can arise, ties or not. Let F be a face of the cavity's boundary, T within, U outside. The
points where the powers with respect to the two spheres are equal are the plane of F, and the power of T is
the smaller one on T's side. At p the power of T is negative and that of U is not; so p lies strictly on T's
side of F. (Ghosts are limits of cells, and the rule above is the limit of theirs.) In other words: every
tie is decided as if the newer point were lifted a little, which is one consistent perturbation, so
that walks never run in circles either.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import inline, kernel
from ...predicates.batch import orient_at
from ...predicates.kernels import insphere, orient3
from .engine import BUSY, COUNT, FREE, GHOST, LAST, REACHED, STAMP, Compiled, grown

WELL, MORE_CELLS, MORE_SCRATCH = 0, 1, 2  # why insert3 returned


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
    vertex[:4] = (0, 1, 2, 3) if orient_at(xyz, np.arange(4)) > 0 else (0, 1, 3, 2)
    for k in range(4):
        ghost = 4 * (1 + k)
        for j in range(3):
            vertex[ghost + j] = vertex[(k + 1 + j) % 4]
        if k % 2 == 1:  # then this order of the face turns the ghost inside out
            vertex[ghost], vertex[ghost + 1] = vertex[ghost + 1], vertex[ghost]
        vertex[ghost + 3] = GHOST
        across[ghost + 3], across[k] = k, ghost + 3
    for k in range(4):  # two ghosts share the face over an edge: opposite what the other one lacks
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
    """Walk from t to a tetrahedron that contains p, or to a ghost that p sees strictly."""
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
    """`locate3` for one row after the other, each walk from where the last one ended."""
    for i in range(len(rows)):
        t = locate3(xyz, vertex, across, t, rows[i, 0], rows[i, 1], rows[i, 2])
        found[i] = t


@kernel
def cavity3(xyz, vertex, across, t, px, py, pz, mark, stamp, cells, faces, sizes):
    """Breadth-first search from t: the cells of the cavity, and its faces as 4 t + k seen from within.

    ``mark`` becomes 2 stamp in the cavity and 2 stamp + 1 in tested cells beside it. False: no room.
    """
    inside, outside = 2 * stamp, 2 * stamp + 1
    cells[0] = t
    mark[t] = inside
    size, walls, head = 1, 0, 0
    while head < size:
        if size + 4 > cells.shape[0]:
            return False
        t = np.int64(cells[head])
        head += 1
        for k in range(4):
            u = across[4 * t + k] >> 2
            if mark[u] == inside:
                continue
            if mark[u] != outside:
                if conflict3(xyz, vertex, across, u, px, py, pz):
                    mark[u] = inside
                    cells[size] = u
                    size += 1
                    continue
                mark[u] = outside
            faces[walls] = 4 * t + k
            walls += 1
    sizes[0], sizes[1] = size, walls
    return True


@inline
def _turn(vertex, across, mark, inside, t, k, j):
    """Turn about the ridge common to faces k (a wall) and j of t, through the cavity, to the next wall.

    Returns the wall as 4 u + i, and which vertex of u, other than i, is not on the ridge.
    """
    enter, out = k, j
    beyond = np.int64(across[4 * t + out])
    while mark[beyond >> 2] == inside:
        x = vertex[4 * t + enter]
        t, enter = beyond >> 2, beyond & 3
        out = 0
        while vertex[4 * t + out] != x:
            out += 1
        beyond = np.int64(across[4 * t + out])
    return beyond, enter


@kernel
def star3(vertex, across, mark, stamp, faces, walls, cells, size, free, state, p):
    """Replace the cavity by the tetrahedra that join p to its walls."""
    count, unused, inside = state[COUNT], state[FREE], 2 * stamp
    for i in range(walls):  # one tetrahedron on each wall: its inner cell with p in place of a vertex
        face = np.int64(faces[i])
        if unused > 0:
            unused -= 1
            new = np.int64(free[unused])
        else:
            new = count
            count += 1
        t, k = face >> 2, face & 3
        for j in range(4):
            vertex[4 * new + j] = vertex[4 * t + j]
            across[4 * new + j] = -1
        vertex[4 * new + k] = p
        beyond = across[face]
        across[4 * new + k] = beyond
        across[beyond] = 4 * new + k
    for i in range(walls):
        face = np.int64(faces[i])
        t, k = face >> 2, face & 3
        new = np.int64(across[across[face]]) >> 2
        for j in range(4):
            if across[4 * new + j] < 0:
                wall, apex = _turn(vertex, across, mark, inside, t, k, j)
                other = 4 * (np.int64(across[wall]) >> 2) + apex
                across[4 * new + j] = other
                across[other] = 4 * new + j
    for i in range(size):
        vertex[4 * np.int64(cells[i])] = -2  # not in use
        free[unused + i] = cells[i]
    state[COUNT], state[FREE] = count, unused + size
    return new


@kernel
def insert3(xyz, vertex, across, mark, free, cells, faces, state, copy_of, start, stop):
    """Insert the points ``start <= p < stop``: locate, cavity, star.

    Returns WELL, or what there is not enough of; the state is consistent in each case.
    """
    sizes = np.zeros(2, dtype=np.int64)
    capacity = mark.shape[0]
    for p in range(start, stop):
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
        if not cavity3(xyz, vertex, across, t, px, py, pz, mark, stamp, cells, faces, sizes):
            return MORE_SCRATCH
        if state[COUNT] + sizes[1] > capacity:
            return MORE_CELLS
        state[BUSY] = 1
        state[LAST] = star3(vertex, across, mark, stamp, faces, sizes[1], cells, sizes[0], free, state, p)
        state[REACHED], state[BUSY] = p + 1, 0
    return WELL


class Spatial(Compiled):
    """A growing Delaunay triangulation in space."""

    width = 4
    chunk = 10_000

    def _reserve(self, points: int) -> None:
        if len(self.vertex) == 0:
            self.mark = np.empty(0, dtype=np.int32)
            self.free = np.empty(0, dtype=np.int32)
            self._reserve_scratch(1024)
        # uniform points have 6.8 tetrahedra each; where there are more, `advance` makes room
        self._reserve_cells(7 * points + 100)

    def _reserve_cells(self, slots: int) -> None:
        old = len(self.mark)
        if slots > old:
            slots = max(slots, old + old // 2)  # as `grown` does
        if 4 * slots >= 2**31:
            raise InputError(f"{self.size} points make more tetrahedra than 32-bit numbers serve: 5 * 10^8")
        vertex, across = grown(self.vertex, 4 * slots), grown(self.across, 4 * slots)
        mark, free = grown(self.mark, slots), grown(self.free, slots)
        mark[old:] = 0
        self.vertex, self.across, self.mark, self.free = vertex, across, mark, free

    def _reserve_scratch(self, cells: int) -> None:
        cavity, faces = np.empty(cells, dtype=np.int32), np.empty(4 * cells, dtype=np.int32)
        self.cavity_cells, self.faces = cavity, faces

    def _start(self) -> None:
        start3(self.rows, self.vertex, self.across, self.state)

    def advance(self) -> None:
        """Insert the next chunk of the points that were added."""
        stop = min(self.size, self.done + self.chunk)
        while True:
            lacking = insert3(
                self.rows, self.vertex, self.across, self.mark, self.free, self.cavity_cells, self.faces,
                self.state, self.copy_of, self.done, stop,
            )  # fmt: skip
            if lacking == WELL:
                return
            if lacking == MORE_CELLS:
                self._reserve_cells(len(self.mark) + len(self.mark) // 2 + len(self.faces))
            else:
                self._reserve_scratch(2 * len(self.cavity_cells))

    def locate_all(self, rows: NDArray[np.float64]) -> NDArray[np.int32]:
        """For each row the slot of a tetrahedron that contains it, or of a ghost that it sees."""
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
        sizes = np.zeros(2, dtype=np.int64)
        while True:
            stamp = int(self.state[STAMP])
            self.state[STAMP] = stamp + 1
            if cavity3(
                self.rows, self.vertex, self.across, t, x[0], x[1], x[2],
                self.mark, stamp, self.cavity_cells, self.faces, sizes,
            ):  # fmt: skip
                return self.cavity_cells[: sizes[0]].copy()
            self._reserve_scratch(2 * len(self.cavity_cells))
