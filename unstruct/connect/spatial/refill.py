"""Refilling a small cavity: depth-first branch and bound over tetrahedra on its vertices, by exact signs.

An *open* face needs a tetrahedron on its inner side. The search takes the open face that fewest vertices
fit, and sets a tetrahedron on it; the faces of the tetrahedron either cancel open ones, or open their
reverses. A face is *closed* when its inner side is occupied. When no face is open, the tetrahedra fill the
cavity:

**Theorem.** Positively oriented tetrahedra whose oriented faces cancel to the boundary of the cavity are a
triangulation of it. *Proof.* How often a point is covered changes only where a face is passed, and a face
and its reverse change nothing. So a point is covered as often as the boundary winds around it: once inside,
never outside. Tetrahedra that overlap nowhere and have faces in pairs are a triangulation. ∎

Hence no test for intersections is needed. A face inside that must be there is open in both orientations at
the beginning. An edge that must be there forbids all faces that it meets.
"""

from __future__ import annotations

from ...base.jit import apart, inline, lean
from .costs import (
    DEGREE,
    EDGE,
    FACE,
    NEVER,
    SHAPE,
    Signs,
    face_cost,
    face_number,
    local_sign,
    packed_face,
    tet_cost,
    unpacked_face,
)
from .records import (
    COST_KIND,
    GUARD_COUNT,
    HASH,
    LOCALS,
    NEW_CELLS,
    NODES,
    SEED,
    TARGET,
    TETS_ROOM,
    WORK_DONE,
)

__all__ = ["FILLED", "UNFILLED", "refill", "set_code"]

UNFILLED, FILLED = 1, 2  # a face is neither as long as nothing is at it
# Columns of `chosen`.
CHOSEN_APEX, OPENED, LENGTH, FOUND, NEXT_APEX = 3, 4, 5, 6, 7


@inline
def set_code(r, n, x, y, z, code):
    """Write whether the oriented face x, y, z is open or closed."""
    r.code[face_number(n, x, y, z)] = code
    for k in range(3):
        a, b, c = (x, y, z) if k == 0 else ((y, z, x) if k == 1 else (z, x, y))
        bit = 1 << c
        r.ajar[a * n + b] = r.ajar[a * n + b] | bit if code == UNFILLED else r.ajar[a * n + b] & ~bit
        r.shut[a * n + b] = r.shut[a * n + b] | bit if code == FILLED else r.shut[a * n + b] & ~bit


@apart
def _fitting_all(xyz, signs, x, y, z):
    """Which vertices are on the inner side of this face."""
    mask = 0
    for d in range(signs.size[LOCALS]):
        if d != x and d != y and d != z and local_sign(xyz, signs, x, y, z, d) > 0:
            mask |= 1 << d
    return mask


@inline
def _gain(xyz, r, x, y, z, d):
    """What it costs to set the apex d, which fits, on the open face x, y, z."""
    n = r.size[LOCALS]
    cost = 0.0
    for k in range(3):
        a, b = (y, z) if k == 0 else ((z, x) if k == 1 else (x, y))
        if r.code[face_number(n, b, a, d)] == 0:
            cost += face_cost(xyz, r, b, a, d)
    return cost + tet_cost(xyz, r, x, y, z, d)


@inline
def _judge(xyz, r, a, b, mask):
    """Fill the costs of the faces of the edge ab with these vertices, where they are needed."""
    pair = a * r.size[LOCALS] + b
    mask &= ~(r.judged[pair] | r.ajar[pair])
    d = 0
    while mask >> d:
        if mask >> d & 1:
            face_cost(xyz, r, a, b, d)
        d += 1


@inline
def _fitting(xyz, r, packed, total, limit):
    """The set of vertices that fit an open face: a bit for each that keeps the cost below the limit."""
    n, kind, slack = r.size[LOCALS], r.size[COST_KIND], limit - total
    face, x, y, z = unpacked_face(packed)
    if r.fits[face] < 0:
        r.fits[face] = _fitting_all(xyz, Signs(r.label, r.memo, r.sign, r.size), x, y, z)
    one, two, three = y * n + x, z * n + y, x * n + z
    mask = r.fits[face] & ~(r.shut[one] | r.shut[two] | r.shut[three])
    if mask == 0 or not (slack > 0.0 or kind == SHAPE):
        return 0
    if r.size[GUARD_COUNT] > 0 or kind == EDGE or (kind == DEGREE and r.size[TARGET + 1] >= 0):
        _judge(xyz, r, y, x, mask)
        mask &= ~(r.barred[one] & ~r.ajar[one])
        _judge(xyz, r, z, y, mask)
        mask &= ~(r.barred[two] & ~r.ajar[two])
        _judge(xyz, r, x, z, mask)
        mask &= ~(r.barred[three] & ~r.ajar[three])
    if kind == EDGE and slack <= 3.0:
        a, b, c = r.costly[one] & ~r.ajar[one], r.costly[two] & ~r.ajar[two], r.costly[three] & ~r.ajar[three]
        if slack > 2.0:
            mask &= ~(a & b & c)
        elif slack > 1.0:
            mask &= ~(a & b | b & c | c & a)
        else:
            mask &= ~(a | b | c)
    elif kind == FACE or kind == SHAPE or kind == DEGREE:
        for d in range(n):
            if mask >> d & 1:
                gain = _gain(xyz, r, x, y, z, d)
                if (max(total, gain) if kind == SHAPE else total + gain) >= limit:
                    mask &= ~(1 << d)
    return mask


@apart
def _choose(xyz, r, depth, length, limit):
    """Choose the open face that the fewest vertices fit; write them at this depth, and return how many.

    Sets of vertices are the bits of numbers, so that most faces are judged by a few operations.
    """
    n, total = r.size[LOCALS], r.total[depth]
    fewest, chosen, best = n + 1, -1, 0
    for i in range(length):
        face = r.front[i]
        if r.code[face & 4095] != UNFILLED:
            continue
        mask = _fitting(xyz, r, face, total, limit)
        found, rest = 0, mask
        while rest and found < fewest:
            rest &= rest - 1
            found += 1
        if found < fewest:
            fewest, chosen, best = found, face, mask
            if fewest <= 1:
                break
    _, x, y, z = unpacked_face(chosen)
    r.chosen[depth, 0], r.chosen[depth, 1], r.chosen[depth, 2] = x, y, z
    found = 0
    for d in range(n):
        if best >> d & 1:
            r.apex[depth, found], r.gain[depth, found] = d, _gain(xyz, r, x, y, z, d)
            found += 1
    return found


@lean
def _sort(r, state, depth, count):
    """The cheapest candidates first; of several equal ones, by chance."""
    seed = state[SEED]
    for i in range(count):
        seed = (seed * 1103515245 + 12345) & 0x7FFFFFFF
        j = (seed >> 12) % (i + 1)
        r.apex[depth, i], r.apex[depth, j] = r.apex[depth, j], r.apex[depth, i]
        r.gain[depth, i], r.gain[depth, j] = r.gain[depth, j], r.gain[depth, i]
    state[SEED] = seed
    for i in range(1, count):
        apex, gain = r.apex[depth, i], r.gain[depth, i]
        j = i
        while j > 0 and r.gain[depth, j - 1] > gain:
            r.apex[depth, j], r.gain[depth, j] = r.apex[depth, j - 1], r.gain[depth, j - 1]
            j -= 1
        r.apex[depth, j], r.gain[depth, j] = apex, gain


@lean
def _set(r, depth, length):
    """Set the chosen tetrahedron; return how many faces are in the front and by how many more are open."""
    n = r.size[LOCALS]
    x, y, z, d = r.chosen[depth, 0], r.chosen[depth, 1], r.chosen[depth, 2], r.chosen[depth, CHOSEN_APEX]
    opened, more = 0, 0
    r.chosen[depth, LENGTH] = length
    for k in range(4):
        a, b, c = (x, y, z) if k == 0 else ((y, x, d) if k == 1 else ((z, y, d) if k == 2 else (x, z, d)))
        if r.code[face_number(n, a, b, c)] == UNFILLED:
            more -= 1
        else:
            set_code(r, n, a, c, b, UNFILLED)
            r.front[length] = packed_face(n, a, c, b)
            length += 1
            more += 1
            opened |= 1 << k
        set_code(r, n, a, b, c, FILLED)
    r.chosen[depth, OPENED] = opened
    return length, more


@lean
def _unset(r, depth):
    """Take the chosen tetrahedron away; return by how many fewer faces are open."""
    n = r.size[LOCALS]
    x, y, z, d = r.chosen[depth, 0], r.chosen[depth, 1], r.chosen[depth, 2], r.chosen[depth, CHOSEN_APEX]
    fewer = 0
    for k in range(4):
        a, b, c = (x, y, z) if k == 0 else ((y, x, d) if k == 1 else ((z, y, d) if k == 2 else (x, z, d)))
        if r.chosen[depth, OPENED] >> k & 1:
            set_code(r, n, a, b, c, 0)
            set_code(r, n, a, c, b, 0)
            fewer += 1
        else:
            set_code(r, n, a, b, c, UNFILLED)
            fewer -= 1
    return fewer


@lean
def _complete(r, depth):
    """Whether the tetrahedra of depths 0 to ``depth`` use all vertices, and their hash."""
    used, mixed = 0, 0
    for i in range(depth + 1):
        mask = 0
        for k in range(4):
            mask |= 1 << int(r.chosen[i, k])
        used |= mask
        mixed += mask * mask * 2654435 + mask
    return used == (1 << r.size[LOCALS]) - 1, mixed


@apart
def refill(xyz, r, state, faces, limit, goal, budget):
    """Search the cheapest refill below ``limit``, or one of cost <= ``goal``; its cost, or NEVER.

    ``r.front`` begins with ``faces`` open faces. The search ends after ``budget`` nodes. A refill that equals
    the present one (HASH) is passed over. The tetrahedra are written to ``r.best``.
    """
    shape = r.size[COST_KIND] == SHAPE
    depth, length, still_open, nodes, found = 0, faces, faces, 0, NEVER
    r.total[0] = 0.0
    r.chosen[0, FOUND], r.chosen[0, NEXT_APEX] = _choose(xyz, r, 0, length, limit), 0
    _sort(r, state, 0, r.chosen[0, FOUND])
    while depth >= 0 and nodes < budget:
        i = r.chosen[depth, NEXT_APEX]
        if i == r.chosen[depth, FOUND] or depth >= TETS_ROOM - 2:
            depth -= 1
            if depth >= 0:
                length = r.chosen[depth, LENGTH]
                still_open -= _unset(r, depth)
            continue
        r.chosen[depth, NEXT_APEX] = i + 1
        gain = r.gain[depth, i]
        total = max(r.total[depth], gain) if shape else r.total[depth] + gain
        if total >= limit:
            continue
        nodes += 1
        r.chosen[depth, CHOSEN_APEX] = r.apex[depth, i]
        length, more = _set(r, depth, length)
        still_open += more
        r.total[depth + 1] = total
        if still_open > 0:
            depth += 1
            r.chosen[depth, FOUND], r.chosen[depth, NEXT_APEX] = _choose(xyz, r, depth, length, limit), 0
            _sort(r, state, depth, r.chosen[depth, FOUND])
            continue
        whole, mixed = _complete(r, depth)
        if whole and mixed != r.size[HASH]:
            found, limit = total, total
            r.size[NEW_CELLS] = depth + 1
            for j in range(depth + 1):
                for k in range(4):
                    r.best[j, k] = r.chosen[j, k]
            if found <= goal:
                break
        length = r.chosen[depth, LENGTH]
        still_open -= _unset(r, depth)
    r.size[NODES] += nodes
    r.size[WORK_DONE] += nodes
    return found
