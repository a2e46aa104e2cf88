"""Kernels: vertices are moved along the given surface, feature vertices along their curves."""

from __future__ import annotations

from ...base.jit import kernel, lean
from ...connect.insertion.halfedges import next_edge, prev_edge
from ...connect.surface.halfedges import ALONG_CURVE, CORNER, SMOOTH, first_corner, turned
from .shapes import MOVES_DONE, settle, star_is_near, star_least, star_normal

__all__ = ["move_pass", "put_pass", "search_at", "settle_pass"]

NEVER_REFUSED = 0.25  # sharpness of 30 degrees: a move that leaves triangles so good is never refused
ON_SURFACE_SQUARED = 2.0**-96  # the square of a distance in scaled coordinates: sixteen units of rounding
SEARCH_STEP, LAST_STEP = 0.2, 0.01  # of a pattern search, in wanted lengths


@lean
def _curve_middle(s, v, p):
    """Write the middle between the neighbors along a curve, nearer to the one of smaller size."""
    one = two = -1
    start = first_corner(s, v)
    c = start
    while True:
        if s.curve[prev_edge(c)] >= 0:
            one, two = s.vertex[next_edge(c)], one
        last = c
        c = turned(s.twin, c)
        if c < 0:
            one, two = s.vertex[prev_edge(last)], one
            break
        if c == start:
            break
    weight = s.size[one] / (s.size[one] + s.size[two])
    for k in range(3):
        p[k] = (1.0 - weight) * s.xyz[one, k] + weight * s.xyz[two, k]


@lean
def _star_middle(s, v, p, n):
    """Write the mean of the centers of the triangles around a vertex, moved into its tangent plane.

    They are weighted by their areas, in units of the wanted length.
    """
    xyz = s.xyz
    sx, sy, sz, weight = 0.0, 0.0, 0.0, 0.0
    start = first_corner(s, v)
    c = start
    while True:
        a, b = s.vertex[next_edge(c)], s.vertex[prev_edge(c)]
        ux, uy, uz = xyz[a, 0] - xyz[v, 0], xyz[a, 1] - xyz[v, 1], xyz[a, 2] - xyz[v, 2]
        vx, vy, vz = xyz[b, 0] - xyz[v, 0], xyz[b, 1] - xyz[v, 1], xyz[b, 2] - xyz[v, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        h = s.size[v] + s.size[a] + s.size[b]
        area = (nx * nx + ny * ny + nz * nz) ** 0.5 / (h * h * h)
        sx, sy, sz, weight = (
            sx + area * (ux + vx),
            sy + area * (uy + vy),
            sz + area * (uz + vz),
            weight + area,
        )
        c = turned(s.twin, c)
        if c == start or c < 0:
            break
    if weight > 0.0:
        sx, sy, sz = sx / (3.0 * weight), sy / (3.0 * weight), sz / (3.0 * weight)
    nn = n[0] * n[0] + n[1] * n[1] + n[2] * n[2]
    along = (sx * n[0] + sy * n[1] + sz * n[2]) / nn if nn > 0.0 else 0.0
    p[0] = xyz[v, 0] + sx - along * n[0]
    p[1] = xyz[v, 1] + sy - along * n[1]
    p[2] = xyz[v, 2] + sz - along * n[2]


@lean
def _put(work, v, t):
    s = work.sheets
    for k in range(3):
        s.xyz[v, k] = work.x[0, k]
    s.near[v] = t
    work.counts[MOVES_DONE] += 1


@kernel
def move_pass(work, start, stop):
    """Move each vertex to the middle of its star, or of its neighbors on a curve; else halfway."""
    s, p, ref = work.sheets, work.x[0], work.ref
    for v in range(start, stop):
        if s.at[v] < 0 or s.kind[v] == CORNER:
            continue
        star_normal(s, v, ref)
        old = star_least(s, v, s.xyz[v], ref, -2.0)
        star_normal(s, v, ref)
        if s.kind[v] == ALONG_CURVE:
            _curve_middle(s, v, p)
        else:
            _star_middle(s, v, p, ref)
        for _ in range(2):
            t = settle(work, v, s.kind[v], s.near[v])
            new = star_least(s, v, p, ref, 0.0)
            if new >= 0.0 and (new >= NEVER_REFUSED or new > old):
                _put(work, v, t)
                break
            for k in range(3):
                p[k] = 0.5 * (p[k] + s.xyz[v, k])
    return 0


@kernel
def settle_pass(work, start, stop, off):
    """Move vertices onto the surface that are beside it; ``off`` is True where a triangle would turn over.

    Splits leave vertices beside it where their triangles were too sharp; afterwards few are.
    """
    s, p, ref, moved = work.sheets, work.x[0], work.ref, 0
    for v in range(start, stop):
        off[v] = False
        if s.at[v] < 0 or s.kind[v] == CORNER:
            continue
        for k in range(3):
            p[k] = s.xyz[v, k]
        star_normal(s, v, ref)
        t = settle(work, v, s.kind[v], s.near[v])
        square = 0.0
        for k in range(3):
            square += (p[k] - s.xyz[v, k]) ** 2
        if square <= ON_SURFACE_SQUARED:
            continue
        if star_least(s, v, p, ref, 0.0) > 0.0:
            _put(work, v, t)
            moved += 1
        else:
            off[v] = True
    return moved


@kernel
def put_pass(work, start, stop, places):
    """Move vertices, but corners, to these places (n, 3) where no triangle turns over; how many stay."""
    s, ref, stay = work.sheets, work.ref, 0
    for v in range(start, stop):
        if s.at[v] < 0 or s.kind[v] == CORNER:
            continue
        star_normal(s, v, ref)
        if star_least(s, v, places[v], ref, 0.0) > 0.0:
            for k in range(3):
                s.xyz[v, k] = places[v, k]
        else:
            stay += 1
    return stay


@lean
def search_at(work, v):
    """Move a vertex, in smaller and smaller steps, to where the sharpest triangle around it is less sharp."""
    s, p, ref = work.sheets, work.x[0], work.ref
    if s.kind[v] == CORNER:
        return False
    star_normal(s, v, ref)
    old = star_least(s, v, s.xyz[v], ref, -2.0)
    before = s.xyz[v, 0], s.xyz[v, 1], s.xyz[v, 2]
    near, was_near = s.near[v], star_is_near(work, v)
    step, moved, left = SEARCH_STEP * s.size[v], False, 24
    while step > LAST_STEP * s.size[v] and left > 0:
        left -= 1
        found = False
        for i in range(6):
            for k in range(3):
                p[k] = s.xyz[v, k]
            p[i // 2] += step if i % 2 == 0 else -step
            t = settle(work, v, s.kind[v], s.near[v])
            if s.kind[v] == SMOOTH:
                star_normal(s, v, ref)
            new = star_least(s, v, p, ref, old)
            if new > old * (1.0 + 1e-6) and new > 0.0:
                _put(work, v, t)
                old, found, moved = new, True, True
                break
        if not found:
            step *= 0.5
    if moved and was_near and not star_is_near(work, v):
        s.xyz[v, 0], s.xyz[v, 1], s.xyz[v, 2] = before
        s.near[v] = near
        return False
    return moved
