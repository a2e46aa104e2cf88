"""Steps of an insertion in space: what waits is divided, subsegments first, then faces, then cells.

A point that is wanted for a cell but is in the sphere of a subsegment or a face, or beyond one, is not put:
that is divided first. See `dividing` for points on these, and the book, 2.8d.
"""

from __future__ import annotations

from ...base.codes import DONE, HIDDEN, INSERTED, MORE, ROOM, ROUNDED
from ...base.heap import pop, push
from ...base.jit import apart, kernel
from ...connect.insertion.engine import COUNT, FREE
from ...connect.spatial.cavity import corner
from ...connect.spatial.numbered import number_of_edge
from ...connect.spatial.opening import FACES_OPEN, STAR_FIRST, STAR_SEEDS, STAR_WALLS, walk_within
from ...connect.spatial.star import commit_star, in_star, search_star
from .dividing import divide_face, divide_segment, far_enough, has_room
from .limits import BY_MEASURE, BY_QUALITY, SEGMENT_RULE
from .measures import across_input, encroaches_edge, encroaches_face, face_center, judge_cell
from .narrow import flat_in_gap
from .queues import after_star, enter_cell, push_face, push_segment, set_flag
from .reasons import (
    AT_INPUT_ANGLE,
    BEYOND_THE_BOX,
    FLAT_TETRAHEDRON,
    IN_NARROW_GAP,
    NEAR_VERTEX,
    WAITS,
    given_up,
    why_not_more,
)
from .records import (
    CELLS_WAIT,
    CENTER_POINTS,
    FREE_POINT,
    IN_FACES,
    IN_HEAP,
    IN_SEGMENTS,
    NO_MORE,
    REFUSED_POINTS,
    VERTICES_NOW,
    VORONOI_POINTS,
)
from .segment_rule import active_face, after_giving_up, place_on_voronoi

__all__ = ["SPARE_QUEUE", "divide"]

NEAREST_SHARE = 0.7  # of f: no point on a Voronoi segment is nearer to a vertex
SPARE_QUEUE = 4096  # entries of queues that one step may add; larger stars wait for room


# ---------------------------------------------------------------------- cells


@apart
def _in_the_way(w, p, cause, out):
    """Let the subsegments, or else the faces, wait in whose spheres p is; INSERTED if there are none."""
    solid, star = w.solid, w.star
    waits, stays = False, INSERTED
    for i in range(star.sizes[STAR_WALLS]):
        face = star.walls[i]
        t, k = face & ~3, face & 3
        for j in range(3):
            u, v = solid.vertex[t + corner(k, j)], solid.vertex[t + corner(k, (j + 1) % 3)]
            s = number_of_edge(w.edges, u, v)
            if s >= 0 and encroaches_edge(solid.xyz, u, v, p, w.limits.lens):
                if push_segment(w, s, cause):
                    waits = True
                else:
                    stays = why_not_more(w.asked[s])
    if waits:
        return WAITS
    for i in range(star.sizes[STAR_WALLS]):
        face = star.walls[i]
        if solid.mark[face] < 0:
            continue
        t, k = face & ~3, face & 3
        a, b, c = solid.vertex[t + (k + 1 & 3)], solid.vertex[t + (k + 2 & 3)], solid.vertex[t + (k + 3 & 3)]
        square = face_center(solid.xyz, a, b, c, out)
        if encroaches_face(solid.xyz, out, square, p, w.limits.lens):
            if push_face(w, face, cause):
                waits = True
            else:
                stays = why_not_more(w.flag[face])
    return WAITS if waits else stays


@apart
def _beyond(w, face, p, cause, out):
    """Let a face of a facet wait that is before p, if p is in its sphere, or for the size's sake alone."""
    solid = w.solid
    if solid.mark[face] < 0:
        return HIDDEN
    t, k = face & ~3, face & 3
    a, b, c = solid.vertex[t + (k + 1 & 3)], solid.vertex[t + (k + 2 & 3)], solid.vertex[t + (k + 3 & 3)]
    square = face_center(solid.xyz, a, b, c, out)
    if not encroaches_face(solid.xyz, out, square, p, 0.0):
        cause &= BY_MEASURE
        if cause == 0:
            return HIDDEN
    return WAITS if push_face(w, face, cause) else why_not_more(w.flag[face])


@apart
def _put(w, t, cause, near, out):
    """Put the point that is written in the place of the next vertex, into a cavity with cell t.

    No vertex must be nearer than ``near``.
    """
    solid, star, p = w.solid, w.star, w.tally[VERTICES_NOW]
    for j in range(3):
        if not abs(solid.xyz[p, j]) < 0.9:
            return BEYOND_THE_BOX
    found = walk_within(solid, t, p)
    if found < 0:
        return _beyond(w, -1 - found, p, cause, out)
    star.cells[0] = found
    star.sizes[STAR_SEEDS], star.sizes[STAR_FIRST], star.sizes[FACES_OPEN] = 1, 1, 0
    if not search_star(solid, star, w.edges, p, -1):
        return ROUNDED
    if not in_star(solid, t):
        return HIDDEN
    code = _in_the_way(w, p, cause, out)
    if code == WAITS or (code != INSERTED and w.limits.bold == 0):
        return code
    if far_enough(w, p, cause, near, False) == 0:
        return NEAR_VERTEX
    if not has_room(w):
        return ROOM
    commit_star(solid, star, p)
    w.feature[p] = FREE_POINT
    w.tally[VERTICES_NOW] = p + 1
    after_star(w, p, out)
    if w.limits.rule == SEGMENT_RULE:
        for i in range(star.sizes[STAR_WALLS]):
            over = solid.across[4 * star.fresh[i] + (star.walls[i] & 3)]
            if over >= 0 and solid.mark[over] < 0:
                enter_cell(w, over >> 2, out)
    return INSERTED


@apart
def _at_flat_segment(w, t, cause):
    """Let a subsegment wait at which two faces of facets are sides of cell t; False if there is none.

    Where facets lie in one plane, such a cell may be flat up to rounding: it has no center, and only a point
    on the edge between the facets takes it away.
    """
    waits = False
    for i in range(1, 4):
        for j in range(i):
            if w.solid.mark[4 * t + i] < 0 or w.solid.mark[4 * t + j] < 0:
                continue
            k = 0
            while k == i or k == j:
                k += 1
            s = number_of_edge(w.edges, w.solid.vertex[4 * t + k], w.solid.vertex[4 * t + 6 - i - j - k])
            waits = (s >= 0 and push_segment(w, s, cause)) or waits
    return waits


@apart
def _center(w, t, cause, out):
    """Put a point at the circumcenter of cell t, which ``out`` has."""
    for j in range(3):
        w.solid.xyz[w.tally[VERTICES_NOW], j] = out[j]
    code = _put(w, t, cause, 0.0, out)
    w.tally[CENTER_POINTS] += code == INSERTED
    return code


@apart
def _on_segment(w, t, cause, out):
    """Put a point on the Voronoi segment of an active face of cell t; INSERTED also if there is none."""
    face = active_face(w, t, out)
    if face < 0:
        return INSERTED
    f = place_on_voronoi(w, t, face, w.tally[VERTICES_NOW], out)
    code = _put(w, t, cause, NEAREST_SHARE * f, out) if f > 0.0 else HIDDEN
    if code == INSERTED:
        w.tally[VORONOI_POINTS] += 1
    elif code != ROOM and code != WAITS:
        judge_cell(w.solid, w.limits, t, out)
        code = _center(w, t, cause, out)
    return code


# ---------------------------------------------------------------------- the loop


@apart
def _next_segment(w, out):
    s = w.segments[w.tally[IN_SEGMENTS] - 1]
    w.tally[IN_SEGMENTS] -= 1
    cause = w.asked[s] & 3
    w.asked[s] &= ~3
    code = divide_segment(w, s, cause, out)
    if code == ROOM:
        push_segment(w, s, cause)
    elif code != INSERTED:
        w.asked[s] = given_up(w.asked[s], cause, NO_MORE, code)
    return code


@apart
def _next_face(w, out):
    face = w.faces[w.tally[IN_FACES] - 1]
    w.tally[IN_FACES] -= 1
    if w.solid.vertex[face & ~3] < 0 or w.solid.mark[face] < 0 or w.flag[face] & 3 == 0:
        return INSERTED
    cause = w.flag[face] & 3
    set_flag(w, face, w.flag[face] & ~3)
    code = divide_face(w, face, cause, out)
    if code == ROOM or code == WAITS:
        push_face(w, face, cause)
    elif code != INSERTED:
        set_flag(w, face, given_up(w.flag[face], cause, NO_MORE, code))
    return code


@apart
def _next_cell(w, out):
    t, key = w.bad[0], w.heap[0]
    w.tally[IN_HEAP] = pop(w.heap, w.bad, w.tally[IN_HEAP])
    if w.solid.vertex[4 * t] < 0:
        return INSERTED
    cause, worst, square = judge_cell(w.solid, w.limits, t, out)
    cause &= ~w.why[t] & 3
    if cause == 0 or worst != -key:
        return INSERTED
    meets = across_input(w, t) if cause == BY_QUALITY else 0
    if meets == 1:
        code = AT_INPUT_ANGLE
    elif meets == 2 or flat_in_gap(w, t):
        code = IN_NARROW_GAP
    elif cause == BY_QUALITY and worst == 0.5 and square < out[18]:
        code = FLAT_TETRAHEDRON
    elif w.limits.rule == SEGMENT_RULE:
        code = _on_segment(w, t, cause, out)
    else:
        code = _center(w, t, cause, out)
    if (code == ROUNDED or code == BEYOND_THE_BOX) and _at_flat_segment(w, t, cause):
        code = WAITS
    if code == ROOM or code == WAITS:
        w.tally[IN_HEAP] = push(w.heap, w.bad, w.tally[IN_HEAP], key, t)
    elif code != INSERTED:
        w.why[t] = (w.why[t] & 3) | cause | code << 2
        if w.limits.rule == SEGMENT_RULE:
            after_giving_up(w, t, out)
    return code


@kernel
def divide(w, out, stop, steps):
    """Divide what waits until nothing does, ``stop`` vertices are there, or so many steps are done.

    Returns DONE, MORE, or ROOM if arrays must grow first.
    """
    for _ in range(steps):
        if w.tally[VERTICES_NOW] >= stop:
            return MORE
        if (
            w.solid.stamp.shape[0] - w.solid.state[COUNT] + w.solid.state[FREE] < SPARE_QUEUE
            or w.tally[IN_HEAP] + SPARE_QUEUE > w.heap.shape[0]
            or w.tally[IN_FACES] + SPARE_QUEUE > w.faces.shape[0]
            or w.tally[VERTICES_NOW] + 2 > w.solid.xyz.shape[0]
        ):
            return ROOM
        if w.tally[IN_SEGMENTS] > 0:
            code = _next_segment(w, out)
        elif w.tally[IN_FACES] > 0:
            code = _next_face(w, out)
        elif w.tally[IN_HEAP] > 0 and w.tally[CELLS_WAIT] == 0:
            code = _next_cell(w, out)
        else:
            return DONE
        if code == ROOM:
            return ROOM
        if code > INSERTED and code != WAITS:
            w.tally[REFUSED_POINTS] += 1
    return MORE
