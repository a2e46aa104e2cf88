"""Small cavities of a complex: grown from a face, given local numbers, and replaced by their refill."""

from __future__ import annotations

from ...base.jit import apart, inline, lean
from ..insertion.engine import COUNT, FREE, STAMP
from .costs import DEGREE, EDGE, FACE, SHAPE, UNSEEN, face_cost, face_number, packed_face, tet_cost
from .held import holds
from .journal import EVENT_ROOM, close_event, note_refill
from .records import (
    CAVITY_KEY,
    CELLS_ROOM,
    COST_KIND,
    GUARD_COUNT,
    HASH,
    LOCALS,
    NEW_CELLS,
    NOTED,
    NUMBERED,
    OLD_CELLS,
    SEED,
    TARGET,
)
from .refill import FILLED, UNFILLED, set_code

__all__ = [
    "IN_CELL",
    "beside",
    "commit",
    "corner",
    "draw",
    "failed",
    "find_guards",
    "grow",
    "load",
    "new_slot",
    "remember_failure",
    "reset",
    "unwritten",
    "wall",
]

IN_CELL = 8  # in the table `edge`: it is one of a cell
NOWHERE = -2  # in the table `beyond`: this face is not on the boundary, and no new cell has it yet


@inline
def corner(k, i):
    """Vertex i of the face opposite vertex k, so that the face, followed by vertex k, is positive."""
    if i == 0:
        return 1 if k == 0 else 0
    if i == 1:
        return 3 if k == 0 else (2 if k == 1 else (3 if k == 2 else 1))
    return 2 if k == 0 else (3 if k == 1 else (1 if k == 2 else 2))


@inline
def draw(state, n):
    """A random number below n."""
    state[SEED] = (state[SEED] * 1103515245 + 12345) & 0x7FFFFFFF
    return (state[SEED] >> 12) % n


@inline
def _local(r, n, v):
    """The local number of a vertex; -1 if it is not in the cavity."""
    for i in range(n):
        if r.label[i] == v:
            return i
    return -1


@lean
def _absorb(solid, r, stamp):
    """Take in all cells beyond unmarked faces whose vertices are all in the cavity; False if too many are."""
    head, n, size = 0, r.size[LOCALS], r.size[OLD_CELLS]
    while head < size:
        t = r.cells[head]
        head += 1
        for k in range(4):
            over = solid.across[4 * t + k]
            if over < 0 or solid.mark[4 * t + k] >= 0 or solid.stamp[over >> 2] == stamp:
                continue
            if _local(r, n, solid.vertex[over]) >= 0:
                if size == CELLS_ROOM:
                    return False
                r.cells[size] = over >> 2
                size += 1
                solid.stamp[over >> 2] = stamp
    r.size[OLD_CELLS] = size
    return True


@lean
def _widen(solid, r, stamp, noise):
    """Take in the vertex beyond most faces, plus up to ``noise`` by chance; False if there is none."""
    found = 0  # distinct vertices, in `guard` with their numbers of faces
    for i in range(r.size[OLD_CELLS]):
        t = r.cells[i]
        for k in range(4):
            over = solid.across[4 * t + k]
            if over < 0 or solid.mark[4 * t + k] >= 0 or solid.stamp[over >> 2] == stamp:
                continue
            apex, j = solid.vertex[over], 0
            while j < found and r.guard[j, 0] != apex:
                j += 1
            if j == found:
                if found == r.guard.shape[0]:
                    continue
                r.guard[j, 0], r.guard[j, 1] = apex, 0
                found += 1
            r.guard[j, 1] += 2
    best, chosen = -1, -1
    for j in range(found):
        score = r.guard[j, 1] + draw(solid.state, noise + 1)
        if score > best:
            best, chosen = score, j
    if chosen >= 0:
        r.label[r.size[LOCALS]] = r.guard[chosen, 0]
        r.size[LOCALS] += 1
    return chosen >= 0


@apart
def grow(solid, r, count, wanted, noise):
    """Grow a cavity of ``wanted`` vertices from the first ``count`` cells; False if there is none."""
    state, n = solid.state, 0
    state[STAMP] += 1
    stamp = 2 * state[STAMP]
    for i in range(count):
        t = r.cells[i]
        solid.stamp[t] = stamp
        for k in range(4):
            if _local(r, n, solid.vertex[4 * t + k]) < 0:
                if n == wanted:
                    return False
                r.label[n] = solid.vertex[4 * t + k]
                n += 1
    r.size[LOCALS], r.size[OLD_CELLS] = n, count
    if not _absorb(solid, r, stamp):
        return False
    while r.size[LOCALS] < wanted:
        if not _widen(solid, r, stamp, noise) or not _absorb(solid, r, stamp):
            return False
    return True


@lean
def beside(solid, r, face):
    """Write the two cells at a face; False on the hull."""
    over = solid.across[face]
    if over < 0:
        return False
    r.cells[0], r.cells[1] = face >> 2, over >> 2
    return True


@lean
def failed(solid, r, nodes):
    """Whether this cavity is known to have no cheaper refill that a search of so many nodes finds.

    The key is made of the vertices of the cells, the target and the number of nodes. The cavity is forgotten
    when another one takes its place; if two had the same key, one of them would not be tried. What is held
    may have become less since: then a refill is missed, too. Neither does harm.
    """
    size = r.size
    key = size[COST_KIND] + 8 * nodes
    for k in range(3):
        key = key * 1000003 + size[TARGET + k]
    for i in range(size[OLD_CELLS]):
        t = 4 * r.cells[i]
        mixed = ((solid.vertex[t] * 40503 + solid.vertex[t + 1]) * 30011 + solid.vertex[t + 2]) * 65599
        mixed += solid.vertex[t + 3]
        key += (mixed ^ (mixed >> 15)) * 2654435761
    key ^= key >> 29
    size[CAVITY_KEY] = key
    return r.failures[key & (r.failures.shape[0] - 1)] == key


@lean
def remember_failure(r):
    """Remember that the cavity whose key was asked for last has no cheaper refill."""
    r.failures[r.size[CAVITY_KEY] & (r.failures.shape[0] - 1)] = r.size[CAVITY_KEY]


@lean
def reset(r):
    """Empty the tables for ``r.size[LOCALS]`` vertices, and number other vertices of the target."""
    n = r.size[LOCALS]
    m, kind = n, r.size[COST_KIND]
    wanted = 2 if kind == EDGE else (3 if kind == FACE or (kind == DEGREE and r.size[TARGET + 1] >= 0) else 0)
    for k in range(wanted):
        r.goal[k] = _local(r, m, r.size[TARGET + k])
        if r.goal[k] < 0:
            r.goal[k], r.label[m] = m, r.size[TARGET + k]
            m += 1
    r.size[NUMBERED] = m
    for i in range(m**4):
        r.sign[i] = UNSEEN
    for i in range(n**3):  # one array after the other: each loop becomes one operation
        r.cost[i] = -1.0
    for i in range(n**3):
        r.code[i] = 0
    for i in range(n**3):
        r.beyond[i] = NOWHERE
    for i in range(n**3):
        r.number[i] = -1
    for i in range(n**3):
        r.fits[i] = -1
    for i in range(n * n):
        r.edge[i] = r.ajar[i] = r.shut[i] = r.judged[i] = r.costly[i] = r.barred[i] = 0
    r.size[GUARD_COUNT] = r.size[HASH] = 0


@lean
def wall(r, length, x, y, z):
    """Open a face of the boundary; return how many faces are in the front."""
    n = r.size[LOCALS]
    set_code(r, n, x, y, z, UNFILLED)
    set_code(r, n, x, z, y, FILLED)  # the outside is there
    r.front[length] = packed_face(n, x, y, z)
    for i, j in ((x, y), (y, z), (z, x)):
        r.edge[min(i, j) * n + max(i, j)] |= 1
    return length + 1


@apart
def load(solid, held, r):
    """Write the tables of the cavity; returns how many faces are open, and what the present cells cost.

    Marked faces inside must stay, so they are open in both orientations. Held edges inside must stay.
    """
    reset(r)
    n, stamp, length, cost, mixed = r.size[LOCALS], 2 * solid.state[STAMP], 0, 0.0, 0
    for i in range(r.size[OLD_CELLS]):
        t = r.cells[i]
        a, b = _local(r, n, solid.vertex[4 * t]), _local(r, n, solid.vertex[4 * t + 1])
        c, d = _local(r, n, solid.vertex[4 * t + 2]), _local(r, n, solid.vertex[4 * t + 3])
        mask = 1 << a | 1 << b | 1 << c | 1 << d
        mixed += mask * mask * 2654435 + mask
        for k in range(4):  # the faces as `corner` gives them
            x, y, z = (b, d, c) if k == 0 else ((a, c, d) if k == 1 else ((a, d, b) if k == 2 else (a, b, c)))
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
    for i in range(r.size[OLD_CELLS]):
        t = r.cells[i]
        a, b = _local(r, n, solid.vertex[4 * t]), _local(r, n, solid.vertex[4 * t + 1])
        c, d = _local(r, n, solid.vertex[4 * t + 2]), _local(r, n, solid.vertex[4 * t + 3])
        here = tet_cost(solid.xyz, r, a, b, c, d)
        cost = max(cost, here) if r.size[COST_KIND] == SHAPE else cost + here
        for k in range(4):
            over = solid.across[4 * t + k]
            if over > 4 * t + k and solid.stamp[over >> 2] == stamp and solid.mark[4 * t + k] < 0:
                x, y, z = (
                    (b, c, d) if k == 0 else ((a, c, d) if k == 1 else ((a, b, d) if k == 2 else (a, b, c)))
                )
                cost += face_cost(solid.xyz, r, x, y, z)
    r.size[HASH] = mixed
    return length, cost


@lean
def find_guards(solid, held, r):
    """List the held edges inside the cavity."""
    n, count = r.size[LOCALS], 0
    for i in range(n):
        for j in range(i + 1, n):
            if r.edge[i * n + j] == IN_CELL and holds(held, r.label[i], r.label[j]):
                r.guard[count, 0], r.guard[count, 1] = i, j
                count += 1
    r.size[GUARD_COUNT] = count


@lean
def unwritten(solid):
    """Whether the record, if there is one, has no room for another refill."""
    room = solid.journal.shape[0]
    return room > 0 and solid.state[NOTED] + 2 * EVENT_ROOM > room


@lean
def new_slot(solid):
    """A free slot for a cell. There must be room."""
    state = solid.state
    if state[FREE] > 0:
        state[FREE] -= 1
        return solid.free[state[FREE]]
    state[COUNT] += 1
    return state[COUNT] - 1


@apart
def commit(solid, r):
    """Replace the cells of the cavity by the best refill; ``r.cells`` then lists the new cells."""
    n, vertex, across, mark, state = r.size[LOCALS], solid.vertex, solid.across, solid.mark, solid.state
    old, new, region = r.size[OLD_CELLS], r.size[NEW_CELLS], solid.region[r.cells[0]]
    noting = solid.journal.shape[0] > 0
    if noting:
        note_refill(solid, r)
    for i in range(new, old):
        vertex[4 * r.cells[i]] = -2
        solid.free[state[FREE]] = r.cells[i]
        state[FREE] += 1
    for i in range(old, new):
        r.cells[i] = new_slot(solid)
    for i in range(new):
        t = r.cells[i]
        solid.region[t] = region
        for k in range(4):
            vertex[4 * t + k] = r.label[r.best[i, k]]
            across[4 * t + k] = -1
            solid.at[vertex[4 * t + k]] = t
    for i in range(new):
        for k in range(4):
            place = 4 * r.cells[i] + k
            x, y, z = r.best[i, corner(k, 0)], r.best[i, corner(k, 1)], r.best[i, corner(k, 2)]
            face, reverse = face_number(n, x, y, z), face_number(n, x, z, y)
            mark[place] = r.number[face]
            if r.beyond[face] > NOWHERE:  # on the boundary
                over = r.beyond[face]
                across[place] = over
                if over >= 0:
                    across[over] = place
            elif r.beyond[reverse] < NOWHERE:  # the tetrahedron on the other side was here already
                other = NOWHERE - 1 - r.beyond[reverse]
                across[place], across[other] = other, place
            else:
                r.beyond[face] = NOWHERE - 1 - place
    r.size[OLD_CELLS] = new
    if noting:
        close_event(solid, r.cells, new)
