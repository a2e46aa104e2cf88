"""Kernels: edges are flipped, for less sharp triangles or for vertices of six edges."""

from __future__ import annotations

from ...base.jit import kernel, lean
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.halfedges import SMOOTH, SURFACE_SLOTS, can_flip, flip_edge
from .shapes import FLIPPED, TOO_FAR, add_normal, degree_of, off_surface, sharpness

__all__ = ["flip_if_better", "flip_pass"]

BETTER = 1.0 + 1e-9
SHARPEST_BY_DEGREE = 0.11  # sharpness of twenty degrees: flips for the sake of degrees make no sharper triangles


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
    """Whether the edge that would replace e is farther from the given surface than allowed, and than e is."""
    s, p = work.sheets, work.x[0]
    a, b = s.vertex[e], s.vertex[s.twin[e]]
    allowed = min(s.allowed[a], s.allowed[b])
    if 4.0 * _apart(s, e) <= allowed * allowed:
        return False
    for k in range(3):
        p[k] = 0.5 * (s.xyz[a, k] + s.xyz[b, k])
    _, square = off_surface(work, s.near[a])
    return square > allowed * allowed


@lean
def _excess(s, v, change):
    """How much the square of the difference of a vertex from the degree of a regular one would change."""
    more = degree_of(s, v) - 6
    if s.kind[v] != SMOOTH:
        more = 0 if s.twin[s.at[v]] >= 0 else more  # features may have any degree
        return 0
    return (more + change) * (more + change) - more * more


@lean
def flip_if_better(work, e, by_degree):
    """Flip an edge if the sharper one of its triangles becomes less sharp, or, by degree, if degrees get nearer 6.

    Never where a triangle would turn over, or the surface leave the given one.
    """
    s = work.sheets
    f = s.twin[e]
    if f < 0 or s.curve[e] >= 0:
        return False
    xyz, ref = s.xyz, work.ref
    u, w, p, q = s.vertex[next_edge(e)], s.vertex[prev_edge(e)], s.vertex[e], s.vertex[f]
    ref[0] = ref[1] = ref[2] = 0.0
    add_normal(xyz, p, u, w, ref)
    add_normal(xyz, q, w, u, ref)
    new = min(sharpness(xyz[p], xyz, u, q, ref), sharpness(xyz[q], xyz, w, p, ref))
    if new <= 0.0:
        return False
    if by_degree:
        if new < SHARPEST_BY_DEGREE:
            return False
        if _excess(s, u, -1) + _excess(s, w, -1) + _excess(s, p, 1) + _excess(s, q, 1) >= 0:
            return False
    elif new <= BETTER * min(sharpness(xyz[p], xyz, u, w, ref), sharpness(xyz[q], xyz, w, u, ref)):
        return False
    if not can_flip(s, e):
        return False
    if _too_far(work, e):
        work.counts[TOO_FAR] += 1
        return False
    flip_edge(s, e)
    work.counts[FLIPPED] += 1
    return True


@kernel
def flip_pass(work, by_degree):
    """One sweep of flips; how many there were."""
    s, done = work.sheets, 0
    for e in range(3 * s.state[SURFACE_SLOTS]):
        if s.vertex[e - e % 3] != UNUSED and s.twin[e] < e:
            done += flip_if_better(work, e, by_degree)
    return done
