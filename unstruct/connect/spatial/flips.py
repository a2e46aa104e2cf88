"""Plain flips: two cells at a face, three cells around an edge, and edges that cross in a plane.

What `refill` finds in a cavity of five vertices, or around an edge, without tables: most segments need
nothing else.
"""

from __future__ import annotations

from ...base.jit import apart, inline, lean
from .cavity import NOWHERE, commit, corner, draw
from .costs import face_number
from .crossing import cells_around, star
from .held import holds
from .journal import EVENT_REFILL
from .records import EVENT, LOCALS, NEW_CELLS, NODES, OLD_CELLS
from .signs import DISJOINT, meets, side

__all__ = ["BOTH_IN_RING", "RING_ROOM", "flip", "turn", "turn_with_others"]

FLIPPED = 5  # vertices of two cells with a common face
RING_ROOM = 8  # cells around an edge that is turned
MOST_TURNS = 40  # edges that are tried for one goal
DEEPEST_TURN = 6  # edges each of which is in the way of the one before
BOTH_IN_RING = -1  # in place of a number of vertices, after a turn that has failed


@inline
def _in_the_way(solid, goal, u, v, w):
    return 1 if meets(solid.xyz, goal[0], goal[1], u, v, w) != DISJOINT else 0


@lean
def _place(r, v):
    """The local number of a vertex."""
    for i in range(r.size[LOCALS]):
        if r.label[i] == v:
            return i
    return -1


@lean
def _replace(solid, r, old, new):
    """Replace the first ``old`` cells by the first ``new`` rows of ``r.best``, on vertices in ``r.label``."""
    n = r.size[LOCALS]
    for i in range(n**3):
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
                face = face_number(n, x, y, z)
                r.beyond[face], r.number[face] = over, solid.mark[4 * t + k]
    r.size[OLD_CELLS], r.size[NEW_CELLS], r.size[EVENT] = old, new, EVENT_REFILL
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
    r.size[LOCALS] = FLIPPED
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


@lean
def _ring_vertices(solid, r, count, p, q):
    """Write the vertices of the ring around the edge pq to ``r.label``: i and i + 1 are those of cell i."""
    for i in range(count):
        t, u = r.cells[i], r.cells[(i + 1) % count]
        for j in range(4):
            v = solid.vertex[4 * t + j]
            if v != p and v != q:
                shared = False
                for k in range(4):
                    shared |= solid.vertex[4 * u + k] == v
                if shared:
                    r.label[(i + 1) % count] = v


@lean
def _marked_around(solid, r, count, p, q):
    """Whether one of the faces at the edge pq is marked."""
    for i in range(count):
        for k in range(4):
            at = 4 * r.cells[i] + k
            if solid.vertex[at] != p and solid.vertex[at] != q and solid.mark[at] >= 0:
                return True
    return False


@lean
def _rotate(r, count, first):
    """Let the ring begin with its entry ``first``."""
    for _ in range(first):
        v, t = r.label[0], r.cells[0]
        for i in range(count - 1):
            r.label[i], r.cells[i] = r.label[i + 1], r.cells[i + 1]
        r.label[count - 1], r.cells[count - 1] = v, t


@lean
def _positive(solid, t, a, b, c, d):
    """Whether these are the vertices of cell t in an even permutation."""
    odd = False
    row = (a, b, c, d)
    for i in range(4):
        for j in range(i):
            k = m = 0
            while solid.vertex[4 * t + k] != row[i]:
                k += 1
            while solid.vertex[4 * t + m] != row[j]:
                m += 1
            odd ^= k < m
    return not odd


@lean
def _divide(solid, r, count, low, high):
    """Divide the polygon of ring vertices ``low`` to ``high`` into triangles; False if that is impossible.

    A triangle stands for two tetrahedra, with the ends of the edge (after the ring in ``r.label``). Entry
    i n + j of ``r.fits`` becomes the third vertex of the triangle at the side from i to j.
    """
    xyz, label, p, q = solid.xyz, r.label, r.label[count], r.label[count + 1]
    for span in range(2, high - low + 1):
        for i in range(low, high - span + 1):
            j = i + span
            r.fits[i * (count + 1) + j] = -1
            u, w = label[i], label[j % count]
            for k in range(i + 1, j):
                if k > i + 1 and r.fits[i * (count + 1) + k] < 0:
                    continue
                if j > k + 1 and r.fits[k * (count + 1) + j] < 0:
                    continue
                if side(xyz, u, label[k], w, q) > 0 and side(xyz, u, w, label[k], p) > 0:
                    r.fits[i * (count + 1) + j] = k
                    break
    return r.fits[low * (count + 1) + high] >= 0


@lean
def _write_divided(r, count, low, high, new):
    """Write the tetrahedra of a divided polygon; how many there are in all."""
    r.front[0], top = low * (count + 1) + high, 1
    while top > 0:
        top -= 1
        i, j = r.front[top] // (count + 1), r.front[top] % (count + 1)
        if j - i < 2:
            continue
        k = r.fits[i * (count + 1) + j]
        _write(r, new, i, k, j % count, count + 1)
        _write(r, new + 1, i, j % count, k, count)
        new += 2
        r.front[top], r.front[top + 1] = i * (count + 1) + k, k * (count + 1) + j
        top += 2
    return new


@apart
def turn(solid, r, first, last, p, q, count):
    """Replace the edge pq, which is not held, by one from ``first`` to ``last``, both in the ring around it.

    ``r.cells`` lists the cells around pq in order, at most RING_ROOM. Segment and edge cross in a plane, so
    that the faces at the edge are flipped in the plane, and on either side of it what is between is divided
    in the first way that is found. Returns whether there is one.
    """
    _ring_vertices(solid, r, count, p, q)
    a = b = -1
    for i in range(count):
        if r.label[i] == first:
            a = i
        if r.label[i] == last:
            b = i
    r.size[LOCALS] = 0
    if a < 0 or b < 0 or _marked_around(solid, r, count, p, q):
        return False
    r.size[NODES] += 1
    r.size[LOCALS] = BOTH_IN_RING
    _rotate(r, count, a)
    b = (b - a) % count
    if not _positive(solid, r.cells[0], p, q, r.label[0], r.label[1]):
        p, q = q, p
    r.label[count], r.label[count + 1] = p, q
    if not (_divide(solid, r, count, 0, b) and _divide(solid, r, count, b, count)):
        return False
    new = _write_divided(r, count, 0, b, 0)
    new = _write_divided(r, count, b, count, new)
    r.size[LOCALS] = count + 2
    _replace(solid, r, count, new)
    return True


@lean
def _around(solid, found, r, v, e):
    """Write the cells around the edge ve to ``r.cells`` in order; how many, -1 for many or on the hull."""
    for i in range(star(solid, found, v)):
        t, out, other, has = found.cells[i], -1, -1, False
        for k in range(4):
            if solid.vertex[4 * t + k] == e:
                has = True
            elif solid.vertex[4 * t + k] != v:
                out, other = k, out
        if has:
            return cells_around(solid, 4 * t + out, other, r.cells, RING_ROOM)
    return -1


@lean
def _flat_beside(solid, held, r, depth, count):
    """Choose an edge from the ring around another to one of its ends, with flat faces; False for none.

    It is written behind the first ``depth`` pairs of rows of ``r.guard``: the ends of the other diagonal of
    its faces, then its own.
    """
    pairs, found = r.guard, 0
    for i in range(count):
        u, v, w = r.label[i - 1 if i > 0 else count - 1], r.label[i], r.label[(i + 1) % count]
        for k in range(2):
            e = r.label[count + k]
            if side(solid.xyz, u, v, w, e) != 0 or holds(held, v, e):
                continue
            known = False
            for d in range(1, depth):
                known |= pairs[2 * d + 1, 0] == v and pairs[2 * d + 1, 1] == e
                known |= pairs[2 * d + 1, 0] == e and pairs[2 * d + 1, 1] == v
            if known:
                continue
            found += 1
            if draw(solid.state, found) == 0:
                pairs[2 * depth, 0], pairs[2 * depth, 1] = u, w
                pairs[2 * depth + 1, 0], pairs[2 * depth + 1, 1] = v, e
    return found > 0


@apart
def turn_with_others(solid, held, r, found, goal, crossed):
    """After `turn` has failed: turn edges in planes that are in its way, and those in theirs, by chance.

    The diagonals of a prism's three sides may be such that it has no tetrahedra. Where one of the sides is
    not given, its diagonal is turned first, unless it is in the same way of the prism beyond. Returns whether
    the edge ``crossed`` could be replaced by the segment in the end; others may have been turned.
    """
    pairs, depth = r.guard, 0
    pairs[0, 0], pairs[0, 1], pairs[1, 0], pairs[1, 1] = goal[0], goal[1], crossed[0], crossed[1]
    for _ in range(MOST_TURNS):
        u, w, v, e = (
            pairs[2 * depth, 0],
            pairs[2 * depth, 1],
            pairs[2 * depth + 1, 0],
            pairs[2 * depth + 1, 1],
        )
        count = _around(solid, found, r, v, e)
        if count > 0 and turn(solid, r, u, w, v, e, count):
            if depth == 0:
                return True
            depth -= 1
        elif count > 0 and r.size[LOCALS] == BOTH_IN_RING and depth < DEEPEST_TURN:
            if _flat_beside(solid, held, r, depth + 1, count):
                depth += 1
            elif depth == 0:
                return False
            else:
                depth = 0
        elif depth == 0:
            return False
        else:
            depth = 0
    return False
