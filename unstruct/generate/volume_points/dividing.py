"""Points on subsegments and on faces of facets, compiled. Each is put only if nothing is too near to it.

A point that is wanted for a face but is in the sphere of a subsegment is not put: the subsegment is divided
first. See the book, 2.8d.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import HIDDEN, INSERTED, ROOM, ROUNDED
from ...base.jit import apart, inline
from ...connect.spatial.cavity import corner
from ...connect.spatial.crossing import ring
from ...connect.spatial.numbered import forget_edge, number_edge, number_of_edge
from ...connect.spatial.opening import (
    FACES_OPEN,
    MAY_GO,
    RIM_EDGES,
    STAR_CELLS,
    STAR_FIRST,
    STAR_SEEDS,
    STAR_WALLS,
    close_faces,
    next_face,
    open_face,
    third,
)
from ...connect.spatial.star import add_star, commit_star, room_for_star, search_star
from .limits import BY_MEASURE, BY_QUALITY, wanted_in_space
from .measures import encroaches_edge, encroaches_face, face_center
from .queues import after_star, look_at_segment, push_segment
from .reasons import NEAR_VERTEX, OFTEN_DIVIDED, WAITS, why_not_more
from .records import (
    FACET_POINTS,
    IN_FACES,
    IN_HEAP,
    MAY_BY,
    NEAREST,
    SEGMENT_POINTS,
    SUBSEGMENTS_NOW,
    VERTICES_NOW,
)

__all__ = ["divide_face", "divide_segment", "far_enough", "has_room"]

FLOOR_SHARE = 2.0**-8  # points for the shape's sake keep this share of the lengths nearby in the beginning
SIZE_SHARE = 0.25  # points for the size's sake keep this share of it
SHARE_BACK = 16  # points for the shape's sake that each point for the size's sake allows further
VERY_NEAR = 2.0**-30  # of the largest coordinate: a vertex that may go must go
MOST_GONE = 4  # searches for one point, each without a further vertex that may go
LEAST_DISTANCE = 2.0**-44  # of the largest coordinate: halves of shorter subsegments would bend


@inline
def _nearest(w, p, lenient):
    """The squared distance of p to the nearest vertex of its walls, and that vertex.

    With ``lenient`` those that may go do not count, if they are not very near.
    """
    best, where = np.inf, np.int64(-1)
    for i in range(w.star.sizes[STAR_WALLS]):
        face = w.star.walls[i]
        for k in range(4):
            if k == face & 3:
                continue
            v = w.solid.vertex[(face & ~3) + k]
            square = 0.0
            for j in range(3):
                square += (w.solid.xyz[v, j] - w.solid.xyz[p, j]) ** 2
            if lenient and w.star.met[v] == MAY_GO and square > VERY_NEAR**2:
                continue
            if square < best:
                best, where = square, np.int64(v)
    return best, where


@apart
def far_enough(w, p, cause, near, lenient):
    """Why p may be put so near to its nearest vertex (beyond ``near``), 0 for not at all; sets its floor.

    The answer is BY_MEASURE if the size alone allows it, and BY_QUALITY if only the shape does.
    """
    square, v = _nearest(w, p, lenient)
    xyz, h = w.solid.xyz, np.inf
    w.floor[p] = w.floor[v]
    w.tally[NEAREST] = v
    if square < max(near, LEAST_DISTANCE) ** 2:
        return 0
    if cause & BY_MEASURE:
        for i in range(w.star.sizes[STAR_CELLS]):
            r = w.solid.region[w.star.cells[i]]
            if r >= 0:
                h = min(h, wanted_in_space(w.limits, r, xyz[p, 0], xyz[p, 1], xyz[p, 2]))
        if square >= ((SIZE_SHARE * h) if h < np.inf else (FLOOR_SHARE * w.floor[v])) ** 2:
            return BY_MEASURE
    return BY_QUALITY if cause & BY_QUALITY and square >= (FLOOR_SHARE * w.floor[v]) ** 2 else 0


@apart
def _open_facets(w, p, out):
    """Open further faces of the facets of those that are open, as far as p is in their spheres."""
    solid, star, head = w.solid, w.star, 0
    while head < star.sizes[FACES_OPEN]:
        face = star.opened[head]
        head += 1
        t, k = face & ~3, face & 3
        for j in range(3):
            a, b = solid.vertex[t + corner(k, j)], solid.vertex[t + corner(k, (j + 1) % 3)]
            if number_of_edge(w.edges, a, b) >= 0:
                continue
            other = next_face(solid, face, a, b)
            if other < 0 or solid.mark[other] < 0:
                continue
            square = face_center(solid.xyz, a, b, third(solid, other, a, b), out)
            if encroaches_face(solid.xyz, out, square, p, 0.0) and not open_face(solid, star, other):
                return


@apart
def _seed(w, size):
    """Begin with the first ``size`` cells, as seeds, and the cells at opened faces.

    Without any the cells at the first face are the seeds.
    """
    star = w.star
    star.sizes[STAR_SEEDS] = size
    for i in range(star.sizes[FACES_OPEN]):
        star.cells[size] = star.opened[i] >> 2
        size += 1
        if w.solid.across[star.opened[i]] >= 0:
            star.cells[size] = w.solid.across[star.opened[i]] >> 2
            size += 1
        if star.sizes[STAR_SEEDS] == 0:
            star.sizes[STAR_SEEDS] = size
    star.sizes[STAR_FIRST] = size


@inline
def has_room(w):
    solid = w.solid
    walls = 4 * w.star.sizes[STAR_WALLS]
    return (
        room_for_star(solid, w.star)
        and w.tally[IN_HEAP] + walls < w.heap.shape[0]
        and w.tally[IN_FACES] + walls < w.faces.shape[0]
    )


@inline
def _count_down(left, part, cause):
    """One point less for the shape's sake, or some more for each for the size's sake."""
    if cause == BY_QUALITY:
        left[part] -= 1
    elif left[part] >= 0:
        left[part] += SHARE_BACK


# ---------------------------------------------------------------------- subsegments


@apart
def _search_at_edge(w, s, p, wide, gone, out):
    """Find the star of p on subsegment s; with ``wide`` further faces of the facets are opened.

    Cells at the vertex ``gone`` are looked at, too; -1 for none.
    """
    solid, star, a, b = w.solid, w.star, w.ends[s, 0], w.ends[s, 1]
    star.sizes[FACES_OPEN] = 0
    size = ring(solid, star, a, b)
    for i in range(size):
        t = star.cells[i]
        for k in range(4):
            v = solid.vertex[4 * t + k]
            if v != a and v != b and solid.mark[4 * t + k] >= 0 and not open_face(solid, star, 4 * t + k):
                return False
    if wide:
        _open_facets(w, p, out)
    _seed(w, size)
    if gone >= 0:
        add_star(solid, star, gone)
    return size > 0 and search_star(solid, star, w.edges, p, s)


@apart
def _place_on_edge(w, s, p):
    """Write a point on a subsegment; returns the parameter there.

    It is the middle, or, if one end is sharp, at a power of two from there, so that points on other segments
    there have equal distances.
    """
    a, b = w.ends[s, 0], w.ends[s, 1]
    n, share = w.sharp_vertex.shape[0], 0.5
    from_a, from_b = a < n and w.sharp_vertex[a], b < n and w.sharp_vertex[b]
    if from_a != from_b:
        square = 0.0
        for j in range(3):
            square += (w.solid.xyz[a, j] - w.solid.xyz[b, j]) ** 2
        length = np.sqrt(square)
        share = 2.0 ** np.round(np.log2(0.5 * length)) / length
        if from_b:
            share = 1.0 - share
    for j in range(3):
        w.solid.xyz[p, j] = w.solid.xyz[a, j] + share * (w.solid.xyz[b, j] - w.solid.xyz[a, j])
    return w.span[s, 0] + share * (w.span[s, 1] - w.span[s, 0])


@apart
def _find_at_edge(w, s, p, cause, out):
    """Find a star of p on subsegment s in which no vertex is too near; vertices that may go are left out."""
    gone = np.int64(-1)
    for _ in range(MOST_GONE):
        if not _search_at_edge(w, s, p, True, gone, out):
            close_faces(w.solid, w.star)
            if not _search_at_edge(w, s, p, False, gone, out):
                return ROUNDED
        may = far_enough(w, p, cause, 0.0, gone >= 0)
        w.tally[MAY_BY] = may
        if may == BY_MEASURE or (may == BY_QUALITY and w.left[w.parent[s]] > 0):
            return INSERTED
        if may == BY_QUALITY:
            return OFTEN_DIVIDED
        near = w.tally[NEAREST]
        if w.star.met[near] != MAY_GO or near == gone:
            return NEAR_VERTEX
        gone = near
        close_faces(w.solid, w.star)
    return NEAR_VERTEX


@apart
def divide_segment(w, s, cause, out):
    """Put a point on subsegment s."""
    solid, star, p = w.solid, w.star, w.tally[VERTICES_NOW]
    if cause == BY_QUALITY and w.left[w.parent[s]] <= 0:
        return OFTEN_DIVIDED
    where = _place_on_edge(w, s, p)
    code = _find_at_edge(w, s, p, cause, out)
    if code == INSERTED and not has_room(w):
        code = ROOM
    if code != INSERTED:
        close_faces(solid, star)
        return code
    _count_down(w.left, w.parent[s], w.tally[MAY_BY])
    new, a, b = w.tally[SUBSEGMENTS_NOW], w.ends[s, 0], w.ends[s, 1]
    commit_star(solid, star, p)
    forget_edge(w.edges, a, b)
    w.ends[s, 1], w.ends[new, 0], w.ends[new, 1] = p, p, b
    w.parent[new], w.asked[new] = w.parent[s], w.asked[s] & ~3
    w.span[new, 0], w.span[new, 1], w.span[s, 1] = where, w.span[s, 1], where
    number_edge(w.edges, a, p, s)
    number_edge(w.edges, p, b, new)
    w.feature[p] = w.parent[s]
    w.tally[VERTICES_NOW], w.tally[SUBSEGMENTS_NOW] = p + 1, new + 1
    after_star(w, p, out)
    look_at_segment(w, s, solid.at[a])  # cells that vertices remember are new, and have p
    look_at_segment(w, new, solid.at[b])
    w.tally[SEGMENT_POINTS] += 1
    return INSERTED


# ---------------------------------------------------------------------- facets


@apart
def _walk_on_facet(w, face, p):
    """The face of the facet that contains p, from a face; -1 - s if subsegment s is in the way."""
    solid, xyz = w.solid, w.solid.xyz
    m = solid.mark[face]
    nx, ny, nz = w.plane[m, 3], w.plane[m, 4], w.plane[m, 5]
    for _ in range(10_000):
        t, k = face & ~3, face & 3
        least, chosen = 0.0, -1
        for j in range(3):
            a, b = solid.vertex[t + corner(k, j)], solid.vertex[t + corner(k, (j + 1) % 3)]
            c = solid.vertex[t + corner(k, (j + 2) % 3)]
            ex, ey, ez = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
            ix, iy, iz = ny * ez - nz * ey, nz * ex - nx * ez, nx * ey - ny * ex
            dot = ix * (xyz[p, 0] - xyz[a, 0]) + iy * (xyz[p, 1] - xyz[a, 1]) + iz * (xyz[p, 2] - xyz[a, 2])
            own = ix * (xyz[c, 0] - xyz[a, 0]) + iy * (xyz[c, 1] - xyz[a, 1]) + iz * (xyz[c, 2] - xyz[a, 2])
            away = dot / own if own != 0.0 else 0.0
            if away < least - 1e-12:
                least, chosen = away, j
        if chosen < 0:
            return face
        a, b = solid.vertex[t + corner(k, chosen)], solid.vertex[t + corner(k, (chosen + 1) % 3)]
        s = number_of_edge(w.edges, a, b)
        if s >= 0:
            return -1 - s
        other = next_face(solid, face, a, b)
        if other < 0 or solid.mark[other] != m:
            return face
        face = other
    return face


@apart
def _find_on_facet(w, face, found, p, cause, gone, out):
    """Find the star of p, which is in face ``found``, so that ``face`` goes; the code says if it may be made.

    Cells at the vertex ``gone`` are looked at, too; -1 for none.
    """
    solid, star, m = w.solid, w.star, w.solid.mark[face]
    star.sizes[FACES_OPEN] = 0
    open_face(solid, star, found)
    _open_facets(w, p, out)
    _seed(w, 0)
    if gone >= 0:
        add_star(solid, star, gone)
    if not search_star(solid, star, w.edges, p, -1):
        return ROUNDED
    if solid.mark[face] >= 0:  # it would stay
        return HIDDEN
    waits, stays = False, INSERTED
    for i in range(star.sizes[RIM_EDGES]):
        u, v = star.rim[i, 0], star.rim[i, 1]
        s = number_of_edge(w.edges, u, v)
        if s >= 0 and encroaches_edge(solid.xyz, u, v, p, 0.0):
            if push_segment(w, s, cause):
                waits = True
            else:
                stays = why_not_more(w.asked[s])
    code = WAITS if waits else stays
    may = far_enough(w, p, cause, 0.0, gone >= 0) if code == INSERTED else 0
    w.tally[MAY_BY] = may
    if code == INSERTED and may == 0:
        code = NEAR_VERTEX
    if code == INSERTED and may == BY_QUALITY and w.left_facet[m] <= 0:
        code = OFTEN_DIVIDED
    if code == INSERTED and not has_room(w):
        code = ROOM
    return code


@apart
def divide_face(w, face, cause, out):
    """Put a point at the circumcenter of a face of a facet."""
    solid, star, p = w.solid, w.star, w.tally[VERTICES_NOW]
    t, k, m = face & ~3, face & 3, solid.mark[face]
    if cause == BY_QUALITY and w.left_facet[m] <= 0:
        return OFTEN_DIVIDED
    a, b, c = solid.vertex[t + (k + 1 & 3)], solid.vertex[t + (k + 2 & 3)], solid.vertex[t + (k + 3 & 3)]
    square = face_center(solid.xyz, a, b, c, out)
    if not square < 64.0:
        return ROUNDED
    off = 0.0
    for j in range(3):
        off += (out[j] - w.plane[m, j]) * w.plane[m, 3 + j]
    for j in range(3):
        solid.xyz[p, j] = out[j] - off * w.plane[m, 3 + j]
    found = _walk_on_facet(w, face, p)
    if found < 0:
        return WAITS if push_segment(w, -1 - found, cause) else why_not_more(w.asked[-1 - found])
    gone = np.int64(-1)
    for _ in range(MOST_GONE):
        code = _find_on_facet(w, face, found, p, cause, gone, out)
        near = w.tally[NEAREST]
        if code != NEAR_VERTEX or w.star.met[near] != MAY_GO or near == gone:
            break
        gone = near
        close_faces(solid, star)
    if code != INSERTED:
        close_faces(solid, star)
        return code
    commit_star(solid, star, p)
    w.feature[p] = -3 - m
    w.tally[VERTICES_NOW] = p + 1
    after_star(w, p, out)
    w.tally[FACET_POINTS] += 1
    _count_down(w.left_facet, m, w.tally[MAY_BY])
    return INSERTED
