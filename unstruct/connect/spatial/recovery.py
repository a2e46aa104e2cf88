"""Recovery of segments, then of triangles: refills that strictly lower what is in the way.

Nothing that is there is destroyed: held edges and marked faces stay in all refills. So each refill that
lowers the number of crossings is a step forward, and the loop ends. Where no cavity of few vertices can be
improved, refills of equal cost (*shakes*) lead to other cavities, as long as the budget lasts.
"""

from __future__ import annotations

from ...base.jit import apart, kernel
from ..insertion.engine import COUNT, FREE, STAMP
from .cavity import beside, commit, corner, draw, failed, grow, load, remember_failure, unwritten
from .costs import EDGE, FACE, NEVER
from .crossing import cells_around, classify, crossings, mark_face, star
from .flips import BOTH_IN_RING, RING_ROOM, flip, turn, turn_with_others
from .held import hold, holds
from .journal import EVENT_FOUND, EVENT_GIVEN_UP, EVENT_REFILL, EVENT_SHAKE, note
from .records import (
    COST_KIND,
    EVENT,
    LOCAL_ROOM,
    LOCALS,
    NODES,
    RESUMED,
    SHAKES_LEFT,
    TARGET,
    WAY_COUNT,
    WORK_DONE,
)
from .refill import refill
from .signs import ON_EDGE, meets, side

__all__ = ["MOST_WANTED", "SHAKES", "SPARE_SLOTS", "STOP", "recover_all", "survey"]

SPARE_SLOTS = 128  # slots that a refill may need
SHAKING = 8  # the noise by which cavities grow that are refilled at equal cost
MUCH_SHAKEN = 10  # so many shakes are for the last few goals, which get more effort otherwise, too
FEW_CELLS = 8  # cells that a segment crosses, for cavities around all of them
MUCH_WORK = 100_000  # nodes and the like, after which Python looks for Ctrl-C
WORK_OF_A_STEP = 20
FEWEST_CORNERS = 5  # vertices of two cells with a common face
NOT_LOWERED, LOWERED, OTHER_CELLS = 0, 1, 2  # what an attempt came to
# Entries of the options.
MOST_WANTED = 0  # vertices of the largest cavity
SHAKES = 1  # how many refills of equal cost
SEARCH_NODES = 2  # nodes of one search
TOTAL = 3  # nodes of all searches for one goal
STOP = 4  # 1 to stop at the first goal that is left


@apart
def _hopeless(solid, r, found):
    """Whether it is seen at once that no refill of the cavity has fewer faces in the way of the segment.

    Where the segment enters the cavity by one face and leaves it by another, n tetrahedra in a row have at
    most n + 3 vertices. So with one face in the way now, all vertices of both faces must be those of one
    tetrahedron; with two, they must be at most five. Where the segment begins or ends in the cavity, its end
    takes the place of a face.
    """
    stamp, inner, ends = 2 * solid.state[STAMP], 0, 0
    first = second = -1
    for i in range(r.size[WAY_COUNT]):
        face = found.faces[i]
        over = solid.across[face]
        here, there = solid.stamp[face >> 2] == stamp, solid.stamp[over >> 2] == stamp
        if here and there:
            inner += 1
        elif here or there:
            if ends == 0:
                first = face if here else over
            elif ends == 1:
                second = face if here else over
            ends += 1
    if inner > 2 or ends == 0 or ends > 2:
        return False
    corners, size = r.label, 0
    t, k = first >> 2, first & 3
    v = solid.vertex[4 * t : 4 * t + 4]
    x, y, z = v[corner(k, 0)], v[corner(k, 1)], v[corner(k, 2)]
    if ends == 1:
        if inner > 1:
            return False
        a, b, n = r.size[TARGET], r.size[TARGET + 1], r.size[LOCALS]
        has_a = has_b = False
        for i in range(n):
            has_a |= corners[i] == a
            has_b |= corners[i] == b
        if has_a == has_b:
            return False
        apex = a if has_a else b
        return side(solid.xyz, x, y, z, apex) <= 0
    t, k, apex = second >> 2, second & 3, -1
    for i in range(3):
        v = solid.vertex[4 * t + corner(k, i)]
        if v != x and v != y and v != z:
            size += 1
            apex = v
    if inner == 2:
        return size == 3
    return size != 1 or side(solid.xyz, x, y, z, apex) <= 0


@apart
def _attempt(solid, held, r, found, count, wanted, nodes, noise):
    """Refill a cavity grown from ``count`` cells at lower (or equal) cost; True if that is done."""
    r.size[WORK_DONE] += WORK_OF_A_STEP
    equal = noise == SHAKING
    if not grow(solid, r, count, wanted, noise):
        return False
    if not equal and r.size[COST_KIND] == EDGE and _hopeless(solid, r, found):
        return False
    if not equal and failed(solid, r, nodes):
        return False
    faces, cost = load(solid, held, r)
    limit, goal = (cost + 0.5, cost) if equal else (cost, 0.0)
    if cost >= NEVER or limit <= 0.0 or refill(solid.xyz, r, solid.state, faces, limit, goal, nodes) >= NEVER:
        if not equal:
            remember_failure(r)
        return False
    r.size[EVENT] = EVENT_SHAKE if equal else EVENT_REFILL
    commit(solid, r)
    return True


@apart
def _lower(solid, held, r, found, count, goal, options):
    """Try all faces in the way, with larger and larger cavities; True at the first success."""
    if r.size[COST_KIND] == EDGE:
        for j in range(count):
            r.size[WORK_DONE] += WORK_OF_A_STEP
            if flip(solid, held, r, goal, found.faces[j]):
                return True
    first = FEWEST_CORNERS + (1 if r.size[COST_KIND] == EDGE else 0)
    for wanted in range(first, options[MOST_WANTED] + 1):
        start = draw(solid.state, count)
        for j in range(count):
            if r.size[NODES] > options[TOTAL]:
                return False
            if beside(solid, r, found.faces[(start + j) % count]):
                if _attempt(solid, held, r, found, 2, wanted, options[SEARCH_NODES], 2):
                    return True
    return False


@apart
def _lower_around(solid, held, r, found, count, goal, options):
    """Try the cells around edges that the segment meets; LOWERED at the first success.

    In a plane this is a flip: if the faces at the edge are alike on both sides, four cells replace four.
    OTHER_CELLS says that other cells are there, and that the segment has to be looked at again.
    """
    for i in range(count):
        face = found.faces[i]
        t, k = face >> 2, face & 3
        u, v, w = (
            solid.vertex[4 * t + (k + 1 & 3)],
            solid.vertex[4 * t + (k + 2 & 3)],
            solid.vertex[4 * t + (k + 3 & 3)],
        )
        if meets(solid.xyz, goal[0], goal[1], u, v, w) != ON_EDGE:
            continue
        for j in range(1, 4):  # the edge without vertex k + j
            p, q = (v, w) if j == 1 else ((w, u) if j == 2 else (u, v))
            if side(solid.xyz, goal[0], goal[1], p, q) != 0:
                continue
            size = cells_around(solid, face, k + j & 3, r.cells, LOCAL_ROOM - 2)
            if 0 < size <= RING_ROOM and not holds(held, p, q):
                if turn(solid, r, goal[0], goal[1], p, q, size):
                    return LOWERED
                if r.size[LOCALS] == BOTH_IN_RING:
                    return LOWERED if turn_with_others(solid, held, r, found, goal, (p, q)) else OTHER_CELLS
                size = cells_around(solid, face, k + j & 3, r.cells, LOCAL_ROOM - 2)
            if size > 0 and _attempt(solid, held, r, found, size, size + 2, options[SEARCH_NODES], 0):
                return LOWERED
    return NOT_LOWERED


@apart
def _lower_all(solid, held, r, found, options):
    """Try cavities that contain all cells in the way, if these are few; True at the first success."""
    count = found.sizes[0]
    if count > FEW_CELLS:
        return False
    for wanted in range(6, LOCAL_ROOM + 1):
        for i in range(count):
            r.cells[i] = found.cells[i]
        if _attempt(solid, held, r, found, count, wanted, options[SEARCH_NODES], 4):
            return True
    return False


@apart
def recover_one(solid, held, r, found, kind, goal, options):
    """Recover one segment or triangle; how many faces are still in the way.

    -2 if slots or room in the record are lacking, or after some work, so that the user can stop it: to be
    called again.
    """
    size = r.size
    if not size[RESUMED]:
        size[NODES], size[SHAKES_LEFT] = 0, options[SHAKES]
    size[COST_KIND], size[RESUMED], size[TARGET + 2] = kind, 0, -1
    for k in range(kind + 1):  # two vertices of a segment, three of a triangle
        size[TARGET + k] = goal[k]
    while True:
        lacking = solid.state[COUNT] - solid.state[FREE] + SPARE_SLOTS > solid.stamp.shape[0]
        if lacking or unwritten(solid) or size[WORK_DONE] > MUCH_WORK:
            size[RESUMED], size[WORK_DONE] = 1, 0
            return -2
        count = crossings(solid, kind, goal, found)
        size[WAY_COUNT] = count
        size[WORK_DONE] += WORK_OF_A_STEP + count
        if count <= 0 or r.size[NODES] > options[TOTAL]:
            return count
        if kind == EDGE:
            how = _lower_around(solid, held, r, found, count, goal, options)
            if how == LOWERED:
                continue
            if how == OTHER_CELLS:
                count = crossings(solid, kind, goal, found)
                size[WAY_COUNT] = count
                if count <= 0:
                    return count
        if _lower(solid, held, r, found, count, goal, options):
            continue
        if options[SHAKES] >= MUCH_SHAKEN and _lower_all(solid, held, r, found, options):
            continue
        if size[SHAKES_LEFT] == 0:
            return count
        size[SHAKES_LEFT] -= 1
        for _ in range(4):
            wanted = 5 + draw(solid.state, options[MOST_WANTED] - 4)
            face = _wander(solid, found.faces[draw(solid.state, count)])
            nodes = options[SEARCH_NODES]
            if beside(solid, r, face) and _attempt(solid, held, r, found, 2, wanted, nodes, SHAKING):
                break


@apart
def _wander(solid, face):
    """A face of a cell few steps away, by chance."""
    t = face >> 2
    for _ in range(draw(solid.state, 4)):
        over = solid.across[4 * t + draw(solid.state, 4)]
        if over >= 0:
            t = over >> 2
            face = 4 * t + draw(solid.state, 4)
    return face


@apart
def _there(solid, found, size, kind, goal):
    """Whether one of the cells found has the goal; a triangle is marked then."""
    for i in range(size):
        v = solid.vertex[4 * found.cells[i] : 4 * found.cells[i] + 4]
        left = -1  # the vertex of the cell that the triangle does not have
        has = 0
        for k in range(4):
            if v[k] == goal[0] or v[k] == goal[1] or (kind == FACE and v[k] == goal[2]):
                has += 1
            else:
                left = k
        if has == 2 and kind == EDGE:
            return True
        if has == 3:
            at = 4 * found.cells[i] + left
            solid.mark[at] = goal[3]
            if solid.across[at] >= 0:
                solid.mark[solid.across[at]] = goal[3]
            return True
    return False


@kernel
def survey(solid, held, found, kind, goals, left, counts):
    """Write to ``left`` how many faces are in the way of each goal; hold or mark those that are there.

    Adds to ``counts`` how missing segments cross cells, as `classify` does. The cells at a vertex are looked
    up once for successive goals that begin there.
    """
    center, size = -1, 0
    for i in range(goals.shape[0]):
        if goals[i, 0] != center:
            center = goals[i, 0]
            size = star(solid, found, center)
        if _there(solid, found, size, kind, goals[i]):
            left[i] = 0
            if kind == EDGE:
                hold(held, goals[i, 0], goals[i, 1], 1)
            continue
        center = -1  # the search overwrites the cells
        left[i] = crossings(solid, kind, goals[i], found)
        if left[i] > 0 and kind == EDGE:
            classify(solid, goals[i], found, found.sizes[0], counts)


@apart
def _keep(solid, held, found, kind, goal):
    """From now on this segment or triangle must stay."""
    if kind == EDGE:
        hold(held, goal[0], goal[1], 1)
    else:
        mark_face(solid, found, goal, goal[3])


@kernel
def recover_all(solid, held, r, found, kind, goals, left, options):
    """Recover the goals, rows of three vertices and a number, whose entry of ``left`` is not 0.

    Writes how many faces are in the way of each. What is recovered is held or marked with its number.
    Returns the first goal that has to be tried again, see `recover_one`; or the first that is left, if the
    options say so; or the number of goals.
    """
    for i in range(goals.shape[0]):
        if left[i] == 0:
            continue
        count = recover_one(solid, held, r, found, kind, goals[i], options)
        if count == -2:
            return i
        left[i] = count
        third = goals[i, 2] if kind == FACE else -1
        note(solid, EVENT_FOUND if count == 0 else EVENT_GIVEN_UP, goals[i, 0], goals[i, 1], third, count, -1)
        if count == 0:
            _keep(solid, held, found, kind, goals[i])
        elif options[STOP] > 0:
            return i
    return goals.shape[0]
