"""Small cavities of a complex: grown from a face, given local numbers, and replaced by their refill."""

from __future__ import annotations

from ...base.jit import inline, kernel
from ..insertion.engine import COUNT, FREE, STAMP
from .held import holds
from .records import BEST, CELLS, CELLS_ROOM, CORNERS, GUARDS, HASH, KIND, ROOM, SEED
from .refill import OPEN, SHAPE, face_cost, face_number, tet_cost

__all__ = ["commit", "corner", "grow", "load", "new_slot", "reset", "wall"]

NOTHING = -2  # in the table `beyond`: this face is not on the boundary, and no new cell has it yet


@inline
def corner(k, i):
    """Vertex i of the face opposite vertex k, so that the face, followed by vertex k, is positive."""
    if i == 0:
        return 1 if k == 0 else 0
    if i == 1:
        return 3 if k == 0 else (2 if k == 1 else (3 if k == 2 else 1))
    return 2 if k == 0 else (3 if k == 1 else (1 if k == 2 else 2))


@kernel
def draw(state, n):
    """A random number below n."""
    state[SEED] = (state[SEED] * 1103515245 + 12345) & 0x7FFFFFFF
    return (state[SEED] >> 12) % n


@kernel
def _local(r, n, v):
    """The local number of a vertex; -1 if it is not in the cavity."""
    for i in range(n):
        if r.label[i] == v:
            return i
    return -1


@kernel
def _absorb(solid, r, stamp):
    """Take in all cells beyond unmarked faces whose vertices are all in the cavity; False if too many are."""
    head, n, size = 0, r.size[CORNERS], r.size[CELLS]
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
    r.size[CELLS] = size
    return True


@kernel
def _widen(solid, r, stamp, noise):
    """Choose the next vertex: beyond as many faces as possible, plus up to ``noise`` by chance; -1 for none."""
    n, best, chosen = r.size[CORNERS], -1, -1
    for i in range(r.size[CELLS]):
        t = r.cells[i]
        for k in range(4):
            over = solid.across[4 * t + k]
            if over < 0 or solid.mark[4 * t + k] >= 0 or solid.stamp[over >> 2] == stamp:
                continue
            apex = solid.vertex[over]
            score = draw(solid.state, noise + 1)
            for j in range(r.size[CELLS]):
                for m in range(4):
                    beyond = solid.across[4 * r.cells[j] + m]
                    score += 2 * (beyond >= 0 and solid.vertex[beyond] == apex)
            if score > best:
                best, chosen = score, apex
    if chosen >= 0:
        r.label[n] = chosen
        r.size[CORNERS] = n + 1
    return chosen


@kernel
def grow(solid, r, face, wanted, noise):
    """Grow a cavity of ``wanted`` vertices from the two cells at a face; False if there is none."""
    over = solid.across[face]
    if over < 0 or wanted > ROOM:
        return False
    state = solid.state
    state[STAMP] += 1
    stamp = 2 * state[STAMP]
    t = face >> 2
    for k in range(4):
        r.label[k] = solid.vertex[4 * t + k]
    r.label[4] = solid.vertex[over]
    r.cells[0], r.cells[1] = t, over >> 2
    solid.stamp[t] = solid.stamp[over >> 2] = stamp
    r.size[CORNERS], r.size[CELLS] = 5, 2
    if not _absorb(solid, r, stamp):
        return False
    while r.size[CORNERS] < wanted:
        if _widen(solid, r, stamp, noise) < 0 or not _absorb(solid, r, stamp):
            return False
    return True


@kernel
def reset(r):
    """Empty the tables for ``r.size[CORNERS]`` vertices."""
    n = r.size[CORNERS]
    for i in range(n**4):
        r.sign[i] = 2
    for i in range(n**3):
        r.cost[i] = -1.0
        r.code[i] = 0
        r.beyond[i] = NOTHING
        r.number[i] = -1
    for i in range(n * n):
        r.edge[i] = 0
    r.size[GUARDS] = r.size[HASH] = 0


@kernel
def wall(r, length, x, y, z):
    """Open a face of the boundary; return how many faces are in the front."""
    n = r.size[CORNERS]
    face = face_number(n, x, y, z)
    r.code[face] = OPEN
    r.code[face_number(n, x, z, y)] = 2 * OPEN  # closed: the outside is there
    r.front[length] = face
    for i, j in ((x, y), (y, z), (z, x)):
        r.edge[min(i, j) * n + max(i, j)] |= 1
    return length + 1


@kernel
def load(solid, held, r):
    """Write the tables of the cavity; returns how many faces are open, and what the present cells cost.

    Marked faces inside must stay, so they are open in both orientations. Held edges inside must stay.
    """
    reset(r)
    n, stamp, length, cost, mixed = r.size[CORNERS], 2 * solid.state[STAMP], 0, 0.0, 0
    for i in range(r.size[CELLS]):
        t = r.cells[i]
        mask = 0
        for k in range(4):
            x = _local(r, n, solid.vertex[4 * t + corner(k, 0)])
            y = _local(r, n, solid.vertex[4 * t + corner(k, 1)])
            z = _local(r, n, solid.vertex[4 * t + corner(k, 2)])
            mask |= 1 << int(x) | 1 << int(y) | 1 << int(z)
            over, face = solid.across[4 * t + k], face_number(n, x, y, z)
            if over < 0 or solid.stamp[over >> 2] != stamp:
                length = wall(r, length, x, y, z)
                r.beyond[face], r.number[face] = over, solid.mark[4 * t + k]
            elif solid.mark[4 * t + k] >= 0:
                r.code[face] = OPEN
                r.front[length] = face
                length += 1
                r.number[face] = solid.mark[4 * t + k]
        mixed += mask * mask * 2654435 + mask
    _find_guards(solid, held, r)
    for i in range(r.size[CELLS]):
        t = r.cells[i]
        a, b = _local(r, n, solid.vertex[4 * t]), _local(r, n, solid.vertex[4 * t + 1])
        c, d = _local(r, n, solid.vertex[4 * t + 2]), _local(r, n, solid.vertex[4 * t + 3])
        here = tet_cost(solid.xyz, r, a, b, c, d)
        cost = max(cost, here) if r.size[KIND] == SHAPE else cost + here
        for k in range(4):
            over = solid.across[4 * t + k]
            if over > 4 * t + k and solid.stamp[over >> 2] == stamp and solid.mark[4 * t + k] < 0:
                x, y, z = (b, c, d) if k == 0 else ((a, c, d) if k == 1 else ((a, b, d) if k == 2 else (a, b, c)))
                cost += face_cost(solid.xyz, r, x, y, z)
    r.size[HASH] = mixed
    return length, cost


@kernel
def _find_guards(solid, held, r):
    """List the held edges inside the cavity."""
    n, count = r.size[CORNERS], 0
    for i in range(n):
        for j in range(i + 1, n):
            if r.edge[i * n + j] & 1 == 0 and holds(held, r.label[i], r.label[j]):
                # an edge between vertices of the cavity, held and thus somewhere: inside, unless no cell has it
                r.guard[count, 0], r.guard[count, 1] = i, j
                count += 1
    r.size[GUARDS] = count


@kernel
def new_slot(solid):
    """A free slot for a cell. There must be room."""
    state = solid.state
    if state[FREE] > 0:
        state[FREE] -= 1
        return solid.free[state[FREE]]
    state[COUNT] += 1
    return state[COUNT] - 1


@kernel
def commit(solid, r):
    """Replace the cells of the cavity by the best refill; ``r.cells`` then lists the new cells."""
    n, vertex, across, mark, state = r.size[CORNERS], solid.vertex, solid.across, solid.mark, solid.state
    old, new, region = r.size[CELLS], r.size[BEST], solid.region[r.cells[0]]
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
            if r.beyond[face] > NOTHING:  # on the boundary
                over = r.beyond[face]
                across[place] = over
                if over >= 0:
                    across[over] = place
            elif r.beyond[reverse] < NOTHING:  # the tetrahedron on the other side was here already
                other = NOTHING - 1 - r.beyond[reverse]
                across[place], across[other] = other, place
            else:
                r.beyond[face] = NOTHING - 1 - place
    r.size[CELLS] = new
