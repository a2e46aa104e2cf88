"""Regular triangulations of space by insertion, compiled: `space` with the rules of `weighted_plane`."""

from __future__ import annotations

import numpy as np

from ...base.jit import kernel
from ...predicates.kernels import insphere, orient3
from ...predicates.power import power3
from .engine import BUSY, COUNT, GHOST, LAST, REACHED, STAMP
from .space import FINISHED, MORE_CELLS, MORE_SCRATCH, Spatial, locate3
from .stars import MOST_WALLS, small_star3, star3

__all__ = ["WeightedSpatial"]


@kernel
def conflict_weighted3(xyzw, vertex, across, t, p):
    """Is p below the lifted hyperplane of tetrahedron t? For a ghost: beyond its hull face, or below it."""
    x, y, z = xyzw[p, 0], xyzw[p, 1], xyzw[p, 2]
    if vertex[4 * t + 3] == GHOST:
        a, b, c = vertex[4 * t], vertex[4 * t + 1], vertex[4 * t + 2]
        side = orient3(
            xyzw[a, 0], xyzw[a, 1], xyzw[a, 2], xyzw[b, 0], xyzw[b, 1], xyzw[b, 2],
            xyzw[c, 0], xyzw[c, 1], xyzw[c, 2], x, y, z,
        )  # fmt: skip
        if side != 0:
            return side > 0
        t = np.int64(across[4 * t + 3]) >> 2
    a, b, c, d = vertex[4 * t], vertex[4 * t + 1], vertex[4 * t + 2], vertex[4 * t + 3]
    side = power3(xyzw, a, b, c, d, p)
    if side != 0:
        return side > 0
    ball = insphere(
        xyzw[a, 0], xyzw[a, 1], xyzw[a, 2], xyzw[b, 0], xyzw[b, 1], xyzw[b, 2],
        xyzw[c, 0], xyzw[c, 1], xyzw[c, 2], xyzw[d, 0], xyzw[d, 1], xyzw[d, 2], x, y, z,
    )  # fmt: skip
    return ball < 0


@kernel
def _cavity(space, cavity, t, p, stamp):
    """`cavity3` for a weighted point; False if there is no room."""
    xyzw, vertex, across, mark, cells, faces = (
        space.xyz, space.vertex, space.across, space.mark, cavity.cells, cavity.faces,
    )  # fmt: skip
    inside, outside = 2 * stamp, 2 * stamp + 1
    cells[0], mark[t] = t, inside
    size, walls, head = 1, 0, 0
    while head < size:
        if size + 4 > cells.shape[0]:
            return False
        t = np.int64(cells[head])
        head += 1
        for k in range(4):
            u = np.int64(across[4 * t + k]) >> 2
            if mark[u] == inside:
                continue
            if mark[u] != outside:
                if conflict_weighted3(xyzw, vertex, across, u, p):
                    cells[size], mark[u] = u, inside
                    size += 1
                    continue
                mark[u] = outside
            faces[walls] = 4 * t + k
            walls += 1
    cavity.sizes[0], cavity.sizes[1] = size, walls
    return True


@kernel
def insert_weighted3(space, cavity, ridges, stop):
    """Insert the next points, while ``p < stop``, or find them hidden; returns what `insert3` does."""
    xyzw, vertex, across, state = space.xyz, space.vertex, space.across, space.state
    for p in range(state[REACHED], stop):
        t = np.int64(locate3(xyzw, vertex, across, state[LAST], xyzw[p, 0], xyzw[p, 1], xyzw[p, 2]))
        if not conflict_weighted3(xyzw, vertex, across, t, p):
            state[REACHED] = p + 1
            continue
        stamp = state[STAMP]
        state[STAMP] = stamp + 1
        if not _cavity(space, cavity, t, p, stamp):
            return MORE_SCRATCH
        if state[COUNT] + cavity.sizes[1] > space.mark.shape[0]:
            return MORE_CELLS
        state[BUSY] = 1
        if cavity.sizes[1] <= MOST_WALLS:
            state[LAST] = small_star3(space, cavity, ridges, p)
        else:
            state[LAST] = star3(space, cavity, p, stamp)
        state[REACHED], state[BUSY] = p + 1, 0
    return FINISHED


class WeightedSpatial(Spatial):
    """A growing regular triangulation of space; rows are (x, y, z, w)."""

    def _advance(self, stop: int) -> int:
        return int(insert_weighted3(self._space(), self._cavity(), self.ridges, stop))
