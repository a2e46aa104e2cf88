"""Kernels: how far the mesh is from the given surface, which sizes follow from that, and what is wrong."""

from __future__ import annotations

from ...base.jit import inline, kernel, lean
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.halfedges import SMOOTH
from .shapes import add_normal, distance_squared, middle_distance, nearest_facing, sharpness

__all__ = [
    "FLAT_TRIANGLE",
    "INVERTED",
    "TOO_FAR_OFF",
    "crease_pass",
    "faults_pass",
    "grade_pass",
    "lower_pass",
]

FLAT_TRIANGLE, INVERTED, TOO_FAR_OFF = 1, 2, 4  # what may be wrong with a triangle
FLAT_SHARPNESS = 1e-16  # sharpness of a triangle that counts as flat: 6e-7 degrees
NEAR_CREASES = 0.3  # of the size: a strip between creases that is narrower has sharp triangles
ACROSS_STRIP = 0.4  # the width of a strip in sizes to which these are lowered: angles of 38 degrees
AIM = 0.6  # sizes are lowered so that the distance is this part of what is allowed


@inline
def _of_middle(work, e, trust):
    """The square of the distance of the middle of an edge from the given surface, or from its curve."""
    s = work.sheets
    u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
    return middle_distance(work, u, w, s.curve[e], trust * s.allowed[u] * s.allowed[u])


@lean
def _center_distance(work, t, n, trust):
    """The triangle of the given surface near the center of a triangle, and the square of the distance.

    Only those count that face a direction, if that is not zero and there are any.
    """
    s, p = work.sheets, work.x[0]
    a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
    for k in range(3):
        p[k] = (s.xyz[a, k] + s.xyz[b, k] + s.xyz[c, k]) / 3.0
    return nearest_facing(work, n, s.near[a], trust * s.allowed[a] * s.allowed[a])


@lean
def _lower(s, v, length, square, bound):
    """Lower the bound of the size at a vertex, as a distance asks for that grows as the length squared."""
    within = AIM * s.allowed[v]
    if square > within * within:
        bound[v] = min(bound[v], length * (within / square**0.5) ** 0.5)


@kernel
def lower_pass(work, start, stop, bound):
    """Write to ``bound`` (n,), infinite before, the sizes for which the surface would be near enough."""
    s = work.sheets
    for t in range(start, stop):
        if s.vertex[3 * t] == UNUSED:
            continue
        total = 0.0
        for k in range(3):
            e = 3 * t + k
            length = distance_squared(s.xyz, s.vertex[next_edge(e)], s.vertex[prev_edge(e)]) ** 0.5
            total += length
            if s.twin[e] < e:
                square = _of_middle(work, e, AIM * AIM)
                for v in (s.vertex[next_edge(e)], s.vertex[prev_edge(e)], s.vertex[e]):
                    _lower(s, v, length, square, bound)
                if s.twin[e] >= 0:
                    _lower(s, s.vertex[s.twin[e]], length, square, bound)
        _, square = _center_distance(work, t, work.zero, AIM * AIM)
        for k in range(3):
            _lower(s, s.vertex[3 * t + k], total / 3.0, square, bound)
    return 0


@kernel
def crease_pass(work, start, stop, bound, least):
    """Lower bounds of sizes where two creases are near each other, if no less than a part of the size helps.

    There are triangles between them then, with one side along a crease and the other corner on another one.
    """
    s, ref = work.sheets, work.ref
    for t in range(start, stop):
        a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
        if a == UNUSED or s.kind[a] == SMOOTH or s.kind[b] == SMOOTH or s.kind[c] == SMOOTH:
            continue
        side, sides = -1, 0
        for e in range(3 * t, 3 * t + 3):
            if s.curve[e] >= 0:
                side, sides = e, sides + 1
        if sides != 1:
            continue
        ref[0] = ref[1] = ref[2] = 0.0
        add_normal(s.xyz, a, b, c, ref)
        square = distance_squared(s.xyz, s.vertex[next_edge(side)], s.vertex[prev_edge(side)])
        width = ((ref[0] * ref[0] + ref[1] * ref[1] + ref[2] * ref[2]) / square) ** 0.5
        size = min(s.size[a], min(s.size[b], s.size[c]))
        if width < NEAR_CREASES * size and width >= least * ACROSS_STRIP * size:
            for v in (a, b, c):
                bound[v] = min(bound[v], width / ACROSS_STRIP)
    return 0


@kernel
def grade_pass(work, start, stop, growth):
    """Let bounds of sizes grow by no more than this along edges; how many were lowered."""
    s, lowered = work.sheets, 0
    for e in range(start, stop):
        if s.vertex[e - e % 3] == UNUSED:
            continue
        u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
        most = s.cap[u] + growth * distance_squared(s.xyz, u, w) ** 0.5
        if most < s.cap[w]:
            s.cap[w], lowered = most, lowered + 1
    return lowered


@inline
def _most_allowed(s, t):
    """The square of the distance that is allowed for a triangle: where it is not the same, the largest one.

    Collapses and moves keep to what is allowed at the vertex that they concern.
    """
    within = max(
        s.allowed[s.vertex[3 * t]], max(s.allowed[s.vertex[3 * t + 1]], s.allowed[s.vertex[3 * t + 2]])
    )
    return within * within


@inline
def _along(work, t):
    """The product of the reference and the normal of a triangle of the given surface."""
    n = work.held.normals
    return work.ref[0] * n[t, 0] + work.ref[1] * n[t, 1] + work.ref[2] * n[t, 2]


@kernel
def faults_pass(work, start, stop, fault):
    """Write to ``fault`` (m,), which is 0 before, what is wrong with each triangle."""
    s, ref = work.sheets, work.ref
    for t in range(start, stop):
        if s.vertex[3 * t] == UNUSED:
            continue
        a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
        near, square = _center_distance(work, t, work.zero, 1.0)
        ref[0] = ref[1] = ref[2] = 0.0
        add_normal(s.xyz, a, b, c, ref)
        if _along(work, near) < 0.0:  # another sheet that is as near may face as the triangle does
            facing, square_facing = _center_distance(work, t, ref, 1.0)
            if square_facing > _most_allowed(s, t) or _along(work, facing) < 0.0:
                fault[t] |= INVERTED
        if square > _most_allowed(s, t):
            fault[t] |= TOO_FAR_OFF
        for e in range(3 * t, 3 * t + 3):
            f = s.twin[e]
            if f < e:
                away = _of_middle(work, e, 1.0)
                if away > _most_allowed(s, t):
                    fault[t] |= TOO_FAR_OFF
                if f >= 0 and away > _most_allowed(s, f // 3):
                    fault[f // 3] |= TOO_FAR_OFF
        ref[0] = ref[1] = ref[2] = 0.0
        if sharpness(s.xyz[a], s.xyz, b, c, ref) < FLAT_SHARPNESS:
            fault[t] |= FLAT_TRIANGLE
    return 0
