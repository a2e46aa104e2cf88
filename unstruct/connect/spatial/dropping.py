"""Kernels for the star of one vertex: fewer cells, cells changed by chance, none: the vertex is removed."""

from __future__ import annotations

from ...base.jit import apart, kernel
from ..insertion.engine import COUNT, FREE, STAMP
from .cavity import (
    IN_CELL,
    beside,
    commit,
    corner,
    draw,
    failed,
    find_guards,
    grow,
    load,
    remember_failure,
    reset,
    unwritten,
    wall,
)
from .costs import ANY, DEGREE, NEVER, face_number, packed_face
from .crossing import star
from .journal import EVENT_FEWER, EVENT_REMOVED, EVENT_SHAKE
from .records import COST_KIND, EVENT, HASH, LOCAL_ROOM, LOCALS, OLD_CELLS, TARGET, WAY_COUNT
from .recovery import SPARE_SLOTS
from .refill import UNFILLED, refill, set_code

__all__ = ["drop", "lower_degree", "shake_star"]

NODES_FEWER = 200  # of the search for a refill with fewer cells at a point
NODES_DROPPED = 4000  # of the search without the point, in its star
NODES_DROPPED_WIDER = 200  # and in larger cavities
MOST_DROPPED = 60  # cells of a star


@kernel
def lower_degree(solid, held, r, found, goal, enough):
    """Refill around vertex goal[0] so that ``enough`` or fewer cells have it, as long as that is possible.

    If the point is on a segment, its ends are the other entries, and nothing gets in its way. Returns how
    many cells have the vertex in the end, which are in ``found``; -1 if the record has no room, to be called
    again.
    """
    p = goal[0]
    r.size[COST_KIND], r.size[EVENT], r.size[WAY_COUNT] = DEGREE, EVENT_FEWER, 0
    for k in range(3):
        r.size[TARGET + k] = goal[k]
    while True:
        size = star(solid, found, p)
        if size <= enough or solid.state[COUNT] - solid.state[FREE] + SPARE_SLOTS > solid.stamp.shape[0]:
            return size
        if unwritten(solid):
            return -1
        before = size
        for wanted in range(5, 9):
            for i in range(4 * size):
                face = 4 * found.cells[i >> 2] + (i & 3)
                if solid.vertex[face] == p or solid.mark[face] >= 0 or not beside(solid, r, face):
                    continue
                if not grow(solid, r, 2, wanted, 2) or failed(solid, r, NODES_FEWER):
                    continue
                faces, cost = load(solid, held, r)
                if cost < NEVER and refill(solid.xyz, r, solid.state, faces, cost, 0.0, NODES_FEWER) < NEVER:
                    commit(solid, r)
                    before = -1
                    break
                remember_failure(r)
            if before < 0:
                break
        if before >= 0:
            return size


@kernel
def shake_star(solid, held, r, found, p, count):
    """Refill ``count`` cavities by chance, whatever they cost; -1 if room is lacking.

    One half are at vertex p, the others at its neighbors: what is in the way of p is often beside its star.
    """
    r.size[COST_KIND], r.size[EVENT], r.size[WAY_COUNT] = ANY, EVENT_SHAKE, 0
    r.size[TARGET], r.size[TARGET + 1], r.size[TARGET + 2] = p, -1, -1
    for _ in range(count):
        if solid.state[COUNT] - solid.state[FREE] + SPARE_SLOTS > solid.stamp.shape[0] or unwritten(solid):
            return -1
        size = star(solid, found, p)
        face = 4 * found.cells[draw(solid.state, size)] + draw(solid.state, 4)
        if draw(solid.state, 2) == 1:
            size = star(solid, found, solid.vertex[face])
            face = 4 * found.cells[draw(solid.state, size)] + draw(solid.state, 4)
        if solid.mark[face] >= 0 or not beside(solid, r, face):
            continue
        if grow(solid, r, 2, 5 + draw(solid.state, 4), 8):
            faces, _ = load(solid, held, r)
            if refill(solid.xyz, r, solid.state, faces, 0.5, 0.0, NODES_FEWER) < NEVER:
                commit(solid, r)
    return 0


@apart
def _place(r, v):
    """The local number of a vertex."""
    for i in range(r.size[LOCALS]):
        if r.label[i] == v:
            return i
    return -1


@apart
def _load_without(solid, held, r, p):
    """Write the tables of a cavity that contains the star of p, without p; how many faces are open.

    As in `load`, marked faces and held edges stay: none has p.
    """
    n, length, stamp = r.size[LOCALS] - 1, 0, 2 * solid.state[STAMP]
    r.label[_place(r, p)] = r.label[n]
    r.size[LOCALS] = n
    reset(r)
    for i in range(r.size[OLD_CELLS]):
        t = r.cells[i]
        for k in range(4):
            v = solid.vertex[4 * t : 4 * t + 4]
            x, y, z = v[corner(k, 0)], v[corner(k, 1)], v[corner(k, 2)]
            if x == p or y == p or z == p:
                continue
            x, y, z = _place(r, x), _place(r, y), _place(r, z)
            over = solid.across[4 * t + k]
            if over < 0 or solid.stamp[over >> 2] != stamp:
                length = wall(r, length, x, y, z)
                face = face_number(n, x, y, z)
                r.beyond[face], r.number[face] = over, solid.mark[4 * t + k]
            elif solid.mark[4 * t + k] >= 0:
                set_code(r, n, x, y, z, UNFILLED)
                r.front[length] = packed_face(n, x, y, z)
                r.number[face_number(n, x, y, z)] = solid.mark[4 * t + k]
                length += 1
            r.edge[min(x, y) * n + max(x, y)] |= IN_CELL
            r.edge[min(y, z) * n + max(y, z)] |= IN_CELL
            r.edge[min(z, x) * n + max(z, x)] |= IN_CELL
    find_guards(solid, held, r)
    r.size[HASH] = -1
    return length


@kernel
def drop(solid, held, r, found, p):
    """Remove vertex p, which no marked face and no held edge has: its star, or more, is refilled without it.

    Returns whether that was possible. There must be room for SPARE_SLOTS cells, and for an event.
    """
    r.size[COST_KIND], r.size[EVENT], r.size[WAY_COUNT] = ANY, EVENT_REMOVED, 0
    r.size[TARGET], r.size[TARGET + 1], r.size[TARGET + 2] = p, -1, -1
    budget = NODES_DROPPED
    for wanted in range(5, LOCAL_ROOM + 2):
        size = star(solid, found, p)
        if size > MOST_DROPPED:
            return False
        for i in range(size):
            r.cells[i] = found.cells[i]
        if not grow(solid, r, size, wanted, 0):
            continue
        length = _load_without(solid, held, r, p)
        if refill(solid.xyz, r, solid.state, length, 0.5, 0.0, budget) < NEVER:
            commit(solid, r)
            solid.at[p] = -1
            return True
        budget = NODES_DROPPED_WIDER
    return False
