"""The two ways to fill five vertices: two cells at a face, or three cells around an edge.

What `refill` finds in a cavity of five vertices, without tables: most segments need nothing else.
"""

from __future__ import annotations

from ...base.jit import apart, inline, lean
from .cavity import NOWHERE, commit, corner
from .costs import face_number
from .held import holds
from .journal import EVENT_REFILL
from .records import EVENT, LOCALS, NEW_CELLS, NODES, OLD_CELLS
from .signs import DISJOINT, meets, side

__all__ = ["flip"]

FLIPPED = 5


@inline
def _in_the_way(solid, goal, u, v, w):
    return 1 if meets(solid.xyz, goal[0], goal[1], u, v, w) != DISJOINT else 0


@lean
def _place(r, v):
    """The local number of a vertex."""
    for i in range(FLIPPED):
        if r.label[i] == v:
            return i
    return -1


@lean
def _replace(solid, r, old, new):
    """Replace the first ``old`` cells by the first ``new`` rows of ``r.best``, on vertices in ``r.label``."""
    for i in range(FLIPPED**3):
        r.beyond[i] = NOWHERE
        r.number[i] = -1
    for i in range(old):
        t = r.cells[i]
        for k in range(4):
            over = solid.across[4 * t + k]
            inner = False
            for j in range(old):
                inner |= over >> 2 == r.cells[j]
            if over < 0 or not inner:
                x = _place(r, solid.vertex[4 * t + corner(k, 0)])
                y = _place(r, solid.vertex[4 * t + corner(k, 1)])
                z = _place(r, solid.vertex[4 * t + corner(k, 2)])
                face = face_number(FLIPPED, x, y, z)
                r.beyond[face], r.number[face] = over, solid.mark[4 * t + k]
    r.size[LOCALS], r.size[OLD_CELLS], r.size[NEW_CELLS], r.size[EVENT] = FLIPPED, old, new, EVENT_REFILL
    commit(solid, r)


@lean
def _write(r, i, a, b, c, d):
    r.best[i, 0], r.best[i, 1], r.best[i, 2], r.best[i, 3] = a, b, c, d


@apart
def flip(solid, held, r, goal, face):
    """Flip two cells at a face to three, or three around an edge of it to two, if fewer are in the way.

    ``goal`` is a segment that meets the face. Returns whether that was possible.
    """
    over = solid.across[face]
    if over < 0 or solid.mark[face] >= 0:
        return False
    r.size[NODES] += 1
    t, k, u = face >> 2, face & 3, over >> 2
    v = solid.vertex[4 * t : 4 * t + 4]
    x, y, z = v[corner(k, 0)], v[corner(k, 1)], v[corner(k, 2)]
    d, e = solid.vertex[face], solid.vertex[over]
    for _ in range(3):  # a negative sign, if there is one, comes first: at the edge xy
        if side(solid.xyz, x, y, e, d) <= 0:
            break
        x, y, z = y, z, x
    first = side(solid.xyz, x, y, e, d)
    if first == 0 or side(solid.xyz, e, y, z, d) <= 0 or side(solid.xyz, x, e, z, d) <= 0:
        return False
    r.label[0], r.label[1], r.label[2], r.label[3], r.label[4] = x, y, z, d, e
    r.cells[0], r.cells[1] = t, u
    if first > 0:
        if (
            _in_the_way(solid, goal, d, e, x)
            or _in_the_way(solid, goal, d, e, y)
            or _in_the_way(solid, goal, d, e, z)
        ):
            return False
        _write(r, 0, 0, 1, 4, 3)
        _write(r, 1, 4, 1, 2, 3)
        _write(r, 2, 0, 4, 2, 3)
        _replace(solid, r, 2, 3)
        return True
    i = 0
    while solid.vertex[4 * t + i] != z:
        i += 1
    third = solid.across[4 * t + i]
    if third < 0 or solid.vertex[third] != e or solid.mark[4 * t + i] >= 0 or holds(held, x, y):
        return False
    j = 0
    while solid.vertex[4 * u + j] != z:
        j += 1
    if solid.across[4 * u + j] >> 2 != third >> 2 or solid.mark[4 * u + j] >= 0:
        return False
    if _in_the_way(solid, goal, z, d, e):
        if not (_in_the_way(solid, goal, x, y, d) or _in_the_way(solid, goal, x, y, e)):
            return False
    r.cells[2] = third >> 2
    _write(r, 0, 4, 1, 2, 3)
    _write(r, 1, 0, 4, 2, 3)
    _replace(solid, r, 3, 2)
    return True
