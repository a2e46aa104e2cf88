"""What waits to be divided: subsegments, faces of facets, cells; and what is looked at after a change.

Subsegments go before faces, and faces before cells. Cells wait in a heap, the worst first.
"""

from __future__ import annotations

import numpy as np

from ...base.heap import push
from ...base.jit import apart, inline, kernel, lean
from ...connect.insertion.engine import COUNT
from ...connect.spatial.cavity import corner
from ...connect.spatial.numbered import number_of_edge
from ...connect.spatial.opening import STAR_WALLS, third
from .limits import BY_MEASURE, BY_QUALITY, wanted_in_space
from .measures import encroaches_edge, encroaches_face, face_center, face_size, judge_cell
from .narrow import gap_to_face, gap_to_segment
from .records import IN_FACES, IN_HEAP, IN_SEGMENTS, NO_MORE
from .sharp import feature_of, meet_sharply

__all__ = ["after_star", "enter_cell", "look_at_all", "look_at_segment", "push_face", "push_segment"]


@inline
def _any_shape(w):
    """Whether no limit of shape was asked for."""
    return w.limits.ratio2 == np.inf and w.limits.sliver == 1.0


@lean
def push_segment(w, s, cause):
    """Let a subsegment wait to be divided; False if it was given up."""
    if cause & ~(w.asked[s] >> NO_MORE) == 0 or (cause == BY_QUALITY and _any_shape(w)):
        return False
    if w.asked[s] & 3 == 0:
        w.segments[w.tally[IN_SEGMENTS]] = s
        w.tally[IN_SEGMENTS] += 1
    w.asked[s] |= cause
    return True


@lean
def push_face(w, face, cause):
    """Let a face of a facet wait to be divided; False if it was given up, or must stay."""
    solid = w.solid
    if (
        w.kept[solid.mark[face]]
        or (cause == BY_QUALITY and _any_shape(w))
        or cause & ~(w.flag[face] >> NO_MORE) == 0
    ):
        return False
    if w.flag[face] & 3 == 0:
        w.faces[w.tally[IN_FACES]] = face
        w.tally[IN_FACES] += 1
    set_flag(w, face, w.flag[face] | cause)
    return True


@inline
def set_flag(w, face, value):
    """Write the flag of a face on both sides."""
    w.flag[face] = value
    if w.solid.across[face] >= 0:
        w.flag[w.solid.across[face]] = value


@lean
def enter_cell(w, t, out):
    """Let a cell wait if it is bad and was not given up."""
    cause, worst, _ = judge_cell(w.solid, w.limits, t, out)
    if cause & ~w.why[t] & 3:
        w.tally[IN_HEAP] = push(w.heap, w.bad, w.tally[IN_HEAP], -worst, t)


@apart
def look_at_face(w, face, out):
    """Let a face of a facet wait if it is too large, or if a cell at it has its vertex in its sphere."""
    solid = w.solid
    t, k = face & ~3, face & 3
    a, b, c = solid.vertex[t + (k + 1 & 3)], solid.vertex[t + (k + 2 & 3)], solid.vertex[t + (k + 3 & 3)]
    square = face_center(solid.xyz, a, b, c, out)
    h = face_size(solid, w.limits, face, out)
    if square > w.limits.reach2 * h * h:
        push_face(w, face, BY_MEASURE)
        return
    over = solid.across[face]
    if _in_sphere(w, face, solid.mark[face], square, h, out) or (
        over >= 0 and _in_sphere(w, over, solid.mark[face], square, h, out)
    ):
        push_face(w, face, BY_QUALITY)


@inline
def _in_sphere(w, face, m, square, h, out):
    """Whether the cell of a face of facet m is inside and has its vertex in the sphere of the face.

    Not if only a small angle or a narrow gap is the reason.
    """
    v = w.solid.vertex[face]
    return (
        w.solid.region[face >> 2] >= 0
        and encroaches_face(w.solid.xyz, out, square, v, 0.0)
        and not meet_sharply(w.sharp, feature_of(w.sharp, w.feature, v), w.sharp.base[1] + m, 0)
        and not gap_to_face(w, v, m, out, h)
    )


@inline
def _near_segment(w, s, v, h):
    """Whether vertex v is in the sphere of subsegment s, and not only for a small angle or a narrow gap.

    Two segments that meet sharply at a vertex are not excepted: they are divided in shells about it.
    """
    if not encroaches_edge(w.solid.xyz, w.ends[s, 0], w.ends[s, 1], v, 0.0):
        return False
    least = w.sharp.base[2] if w.feature[v] >= 0 else 0
    part = w.sharp.base[0] + w.parent[s]
    return not meet_sharply(w.sharp, feature_of(w.sharp, w.feature, v), part, least) and not gap_to_segment(
        w, v, s, h
    )


@apart
def look_at_segment(w, s, t):
    """Let a subsegment wait if it is too long, or if a vertex of a cell around it is in its sphere.

    Cell t has the subsegment.
    """
    solid = w.solid
    a, b, first = w.ends[s, 0], w.ends[s, 1], t
    x = 0.5 * (solid.xyz[a, 0] + solid.xyz[b, 0])
    y = 0.5 * (solid.xyz[a, 1] + solid.xyz[b, 1])
    z = 0.5 * (solid.xyz[a, 2] + solid.xyz[b, 2])
    h, seen, v = np.inf, False, -1
    for k in range(4):
        if solid.vertex[4 * t + k] != a and solid.vertex[4 * t + k] != b:
            v = solid.vertex[4 * t + k]
    while True:
        j = 0
        while solid.vertex[4 * t + j] != v:
            j += 1
        out = 4 * t + j
        u = third(solid, out, a, b)
        if solid.region[t] >= 0:
            h = min(h, wanted_in_space(w.limits, solid.region[t], x, y, z))
            seen = seen or _near_segment(w, s, u, h) or _near_segment(w, s, v, h)
        v = u
        if solid.across[out] < 0:
            break
        t = solid.across[out] >> 2
        if t == first:
            break
    square = 0.0
    for j in range(3):
        square += (solid.xyz[a, j] - solid.xyz[b, j]) ** 2
    if square > 4.0 * w.limits.reach2 * h * h:
        push_segment(w, s, BY_MEASURE)
    elif seen:
        push_segment(w, s, BY_QUALITY)


@apart
def after_star(w, p, out):
    """Look at the new cells, and at the faces and edges of their walls that p encroaches upon."""
    solid, star = w.solid, w.star
    for i in range(star.sizes[STAR_WALLS]):
        new, k = star.fresh[i], star.walls[i] & 3
        waiting = w.flag[star.walls[i]]
        w.why[new] = 0
        for j in range(4):
            w.flag[4 * new + j] = 0
        if solid.mark[4 * new + k] >= 0:
            w.flag[4 * new + k] = waiting
            if waiting & 3:
                w.faces[w.tally[IN_FACES]] = 4 * new + k
                w.tally[IN_FACES] += 1
    for i in range(star.sizes[STAR_WALLS]):
        new, k = star.fresh[i], star.walls[i] & 3
        for j in range(4):
            if j != k and solid.mark[4 * new + j] >= 0 and w.flag[4 * new + j] == 0:
                look_at_face(w, 4 * new + j, out)
        if solid.region[new] < 0:
            continue
        enter_cell(w, new, out)
        a, b = solid.vertex[4 * new + corner(k, 0)], solid.vertex[4 * new + corner(k, 1)]
        c = solid.vertex[4 * new + corner(k, 2)]
        h = wanted_in_space(w.limits, solid.region[new], solid.xyz[p, 0], solid.xyz[p, 1], solid.xyz[p, 2])
        if solid.mark[4 * new + k] >= 0:
            square, m = face_center(solid.xyz, a, b, c, out), solid.mark[4 * new + k]
            if (
                encroaches_face(solid.xyz, out, square, p, 0.0)
                and not meet_sharply(w.sharp, feature_of(w.sharp, w.feature, p), w.sharp.base[1] + m, 0)
                and not gap_to_face(w, p, m, out, h)
            ):
                push_face(w, 4 * new + k, BY_QUALITY)
        for u, v in ((a, b), (b, c), (c, a)):
            s = number_of_edge(w.edges, u, v)
            if s >= 0 and _near_segment(w, s, p, h):
                push_segment(w, s, BY_QUALITY)


@kernel
def look_at_all(w, out, cell_of):
    """Fill the queues; ``cell_of[s]`` is a cell at each subsegment, -1 for none."""
    for s in range(cell_of.shape[0]):
        if cell_of[s] >= 0:
            look_at_segment(w, s, cell_of[s])
    for t in range(w.solid.state[COUNT]):
        if w.solid.vertex[4 * t] < 0:
            continue
        for k in range(4):
            if w.solid.mark[4 * t + k] >= 0 and w.solid.across[4 * t + k] > 4 * t + k:
                look_at_face(w, 4 * t + k, out)
    enter_all(w, out)


@kernel
def enter_all(w, out):
    """Fill the queue of cells anew."""
    w.tally[IN_HEAP] = 0
    for t in range(w.solid.state[COUNT]):
        if w.solid.vertex[4 * t] >= 0:
            enter_cell(w, t, out)
