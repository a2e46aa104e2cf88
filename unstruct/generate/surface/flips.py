"""Kernels: edges are flipped, for less sharp triangles or for vertices of six edges."""

from __future__ import annotations

import numpy as np

from ...base.jit import inline, kernel, lean
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.halfedges import SMOOTH, can_flip, flip_edge
from .shapes import FLIPS_DONE, TOO_FAR, add_normal, degree_of, middle_distance, nearest_to, sharpness

__all__ = ["count_degrees", "flip_if_better", "flip_pass"]

FLIPS_WAITING = 256  # edges beyond are left for the next pass
BETTER = 1.0 + 1e-9
SHARPEST_BY_DEGREE = (
    0.11  # sharpness of twenty degrees: flips for the sake of degrees make no sharper triangles
)


@lean
def _apart(s, e):
    """The square of the distance between the lines of edge u w and of p q, which would replace it."""
    xyz = s.xyz
    u, w, p, q = s.vertex[next_edge(e)], s.vertex[prev_edge(e)], s.vertex[e], s.vertex[s.twin[e]]
    ax, ay, az = xyz[w, 0] - xyz[u, 0], xyz[w, 1] - xyz[u, 1], xyz[w, 2] - xyz[u, 2]
    bx, by, bz = xyz[q, 0] - xyz[p, 0], xyz[q, 1] - xyz[p, 1], xyz[q, 2] - xyz[p, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    nn = nx * nx + ny * ny + nz * nz
    if nn == 0.0:
        return 0.0
    along = nx * (xyz[p, 0] - xyz[u, 0]) + ny * (xyz[p, 1] - xyz[u, 1]) + nz * (xyz[p, 2] - xyz[u, 2])
    return along * along / nn


@lean
def _too_far(work, e):
    """Whether what would replace edge e and its triangles is farther from the given surface than allowed.

    In rounds, where the end will mend what is left, only the new edge is looked at, and not if it is very
    near the old one.
    """
    s, p = work.sheets, work.x[0]
    a, b = s.vertex[e], s.vertex[s.twin[e]]
    allowed = min(s.allowed[a], s.allowed[b])
    within = allowed * allowed
    if work.slack > 1.0 and 4.0 * _apart(s, e) <= within:
        return False
    if middle_distance(work, a, b, -1, within) > within:
        return True
    if work.slack > 1.0:
        return False
    for v in (s.vertex[next_edge(e)], s.vertex[prev_edge(e)]):
        for k in range(3):
            p[k] = (s.xyz[a, k] + s.xyz[b, k] + s.xyz[v, k]) / 3.0
        if nearest_to(work, s.near[a], within)[1] > within:
            return True
    return False


@inline
def _excess(s, v, change):
    """How much the squared difference of a vertex from six edges would change; features may have any."""
    if s.kind[v] != SMOOTH:
        return 0
    more = s.mark[v] - 6
    return (more + change) * (more + change) - more * more


@lean
def _is_obtuse(s, u, w, p):
    """Whether the angle at p, opposite edge u w, is more than 90 degrees."""
    xyz, product = s.xyz, 0.0
    for k in range(3):
        product += (xyz[u, k] - xyz[p, k]) * (xyz[w, k] - xyz[p, k])
    return product < 0.0


@lean
def flip_if_better(work, e, by_degree):
    """Flip an edge if the sharper one of its triangles becomes less sharp, or if degrees get nearer to 6.

    Never where a triangle would turn over, or the surface leave the given one. By degree, the numbers of
    edges at vertices are in ``mark``. Otherwise one of the angles opposite the edge must be obtuse, as it is
    in the plane if a flip helps.
    """
    s = work.sheets
    f = s.twin[e]
    if f < 0 or s.curve[e] >= 0:
        return False
    xyz, ref = s.xyz, work.ref
    u, w, p, q = s.vertex[next_edge(e)], s.vertex[prev_edge(e)], s.vertex[e], s.vertex[f]
    if by_degree:
        if _excess(s, u, -1) + _excess(s, w, -1) + _excess(s, p, 1) + _excess(s, q, 1) >= 0:
            return False
    elif not (_is_obtuse(s, u, w, p) or _is_obtuse(s, u, w, q)):
        return False
    ref[0] = ref[1] = ref[2] = 0.0
    add_normal(xyz, p, u, w, ref)
    add_normal(xyz, q, w, u, ref)
    new = min(sharpness(xyz[p], xyz, u, q, ref), sharpness(xyz[q], xyz, w, p, ref))
    if new <= 0.0:
        return False
    if by_degree:
        if new < SHARPEST_BY_DEGREE:
            return False
    elif new <= BETTER * min(sharpness(xyz[p], xyz, u, w, ref), sharpness(xyz[q], xyz, w, u, ref)):
        return False
    if not can_flip(s, e):
        return False
    if _too_far(work, e):
        work.counts[TOO_FAR] += 1
        return False
    flip_edge(s, e)
    if by_degree:
        s.mark[u], s.mark[w], s.mark[p], s.mark[q] = (
            s.mark[u] - 1,
            s.mark[w] - 1,
            s.mark[p] + 1,
            s.mark[q] + 1,
        )
    work.counts[FLIPS_DONE] += 1
    return True


@lean
def _flip_near(work, e, by_degree, waiting):
    """Flip edge e, and then those around it, as long as that helps; how many."""
    s, done = work.sheets, 0
    waiting[0], size = e, 1
    while size > 0:
        size -= 1
        e = waiting[size]
        if not flip_if_better(work, e, by_degree):
            continue
        done += 1
        f = s.twin[next_edge(e)]  # the new edge is opposite next_edge(e): it is between the two triangles
        for t in (e // 3, f // 3):
            for g in range(3 * t, 3 * t + 3):
                if g != next_edge(e) and g != f and size < waiting.shape[0]:
                    waiting[size] = g
                    size += 1
    return done


@kernel
def count_degrees(work, start, stop, used):
    """Write the numbers of edges at vertices to ``mark``, if used; else zeros, as `can_collapse` wants."""
    s = work.sheets
    for v in range(start, stop):
        s.mark[v] = degree_of(s, v) if used and s.at[v] >= 0 else 0
    return 0


@kernel
def flip_pass(work, start, stop, by_degree):
    """Flip edges until no flip helps; how many there were."""
    s, done = work.sheets, 0
    waiting = np.empty(FLIPS_WAITING, dtype=np.int64)
    for e in range(start, stop):
        if s.vertex[e - e % 3] != UNUSED and s.twin[e] < e:
            done += _flip_near(work, e, by_degree, waiting)
    return done
