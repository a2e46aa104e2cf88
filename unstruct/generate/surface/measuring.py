"""Kernels: how far the mesh is from the given surface, which sizes follow from that, and what is wrong."""

from __future__ import annotations

from ...base.jit import kernel, lean
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.halfedges import SURFACE_SLOTS
from ...geometry.support_walk import nearest_on_chain
from .shapes import add_normal, distance_squared, off_surface, sharpness

__all__ = ["FAR", "FLAT", "INVERTED", "faults_pass", "grade_pass", "lower_pass"]

FLAT, INVERTED, FAR = 1, 2, 4  # what may be wrong with a triangle
FLATTEST = 1e-16  # sharpness of a triangle that counts as flat: 6e-7 degrees
AIM = 0.7  # sizes are lowered so that the distance is this part of what is allowed


@lean
def _middle_distance(work, e):
    """The square of the distance of the middle of an edge from the given surface, or from its curve."""
    s, p, held = work.sheets, work.x[0], work.held
    u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
    for k in range(3):
        p[k] = 0.5 * (s.xyz[u, k] + s.xyz[w, k])
    if s.curve[e] < 0:
        return off_surface(work, s.near[u])[1]
    f = nearest_on_chain(held, work.x, 0, s.curve[e], work.place, work.stack)
    square = 0.0
    for k in range(3):
        away = p[k] - work.place[0] * held.edges[f, 0, k] - work.place[1] * held.edges[f, 1, k]
        square += away * away
    return square


@lean
def _center_distance(work, t):
    """The triangle of the given surface near the center of a triangle, and the square of the distance."""
    s, p = work.sheets, work.x[0]
    a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
    for k in range(3):
        p[k] = (s.xyz[a, k] + s.xyz[b, k] + s.xyz[c, k]) / 3.0
    return off_surface(work, s.near[a])


@lean
def _lower(s, v, length, square, bound):
    """Lower the bound of the size at a vertex, as a distance asks for that grows as the length squared."""
    within = AIM * s.allowed[v]
    if square > within * within:
        bound[v] = min(bound[v], length * (within / square**0.5) ** 0.5)


@kernel
def lower_pass(work, bound):
    """Write to ``bound`` (n,), which is infinite before, the sizes for which the surface would be near enough."""
    s = work.sheets
    for t in range(s.state[SURFACE_SLOTS]):
        if s.vertex[3 * t] == UNUSED:
            continue
        total = 0.0
        for k in range(3):
            e = 3 * t + k
            length = distance_squared(s.xyz, s.vertex[next_edge(e)], s.vertex[prev_edge(e)]) ** 0.5
            total += length
            if s.twin[e] < e:
                square = _middle_distance(work, e)
                for v in (s.vertex[next_edge(e)], s.vertex[prev_edge(e)], s.vertex[e]):
                    _lower(s, v, length, square, bound)
                if s.twin[e] >= 0:
                    _lower(s, s.vertex[s.twin[e]], length, square, bound)
        _, square = _center_distance(work, t)
        for k in range(3):
            _lower(s, s.vertex[3 * t + k], total / 3.0, square, bound)


@kernel
def grade_pass(work, growth):
    """Let bounds of sizes grow by no more than this along edges; whether one was lowered."""
    s, lowered = work.sheets, False
    for e in range(3 * s.state[SURFACE_SLOTS]):
        if s.vertex[e - e % 3] == UNUSED:
            continue
        u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
        most = s.cap[u] + growth * distance_squared(s.xyz, u, w) ** 0.5
        if most < s.cap[w]:
            s.cap[w], lowered = most, True
    return lowered


@kernel
def faults_pass(work, fault):
    """Write to ``fault`` (m,) what is wrong with each triangle; returns the squared largest distance."""
    s, ref, worst = work.sheets, work.ref, 0.0
    for t in range(s.state[SURFACE_SLOTS]):
        fault[t] = 0
        if s.vertex[3 * t] == UNUSED:
            continue
        a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
        near, square = _center_distance(work, t)
        for e in range(3 * t, 3 * t + 3):
            square = max(square, _middle_distance(work, e))
        worst = max(worst, square)
        within = min(s.allowed[a], min(s.allowed[b], s.allowed[c]))
        if square > within * within:
            fault[t] |= FAR
        ref[0] = ref[1] = ref[2] = 0.0
        add_normal(s.xyz, a, b, c, ref)
        facing = 0.0
        for k in range(3):
            facing += ref[k] * work.held.normals[near, k]
        if facing < 0.0:
            fault[t] |= INVERTED
        ref[0] = ref[1] = ref[2] = 0.0
        if sharpness(s.xyz[a], s.xyz, b, c, ref) < FLATTEST:
            fault[t] |= FLAT
    return worst
