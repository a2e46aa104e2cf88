"""Flips of straight edges on the vertices of a given surface, where it is flat or may be changed.

An edge is flipped if the far corner of one of its triangles lies inside the plane-centered sphere of the
other, if the surface stays where it is up to a tolerance, if both new triangles face as the old ones do, if
there is no such edge yet, and if the sum of the cotangents of the angles of the two triangles becomes less.
The last makes it end: the sum over all triangles is a number that decreases, and there are finitely many
triangulations of finitely many vertices.

Needles that fan out from a point, as CAD systems write disks, are Delaunay, too: all their corners may lie on
a circle. For searches in a tree of boxes they are bad, since the boxes overlap. `flip_needles` flips edges
for shorter ones; it ends, because the sum of all lengths decreases.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel, lean
from ...connect.surface.gluing import glued, next_side, previous_side
from ...connect.surface.lengths import four_areas
from ...connect.surface.sphere_signs import filter_ball

__all__ = ["Flipped", "flip_given", "flip_needles"]

FACING_FLIP = 1e-9  # the least cosine between new triangles and the mean of the old ones
SHORTER_FLIP = 0.999  # an edge is shorter if it is this part of the other's length
SOUND_NEEDLE = 1e-6  # the least height of triangles that flips for shorter edges make, in longest sides


class Given(NamedTuple):
    """Half-edges of straight triangles; ``kept`` ones stay, and no edge comes to ``pinched`` vertices."""

    xyz: NDArray[np.float64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    kept: NDArray[np.bool_]
    pinched: NDArray[np.bool_]


class Flipped(NamedTuple):
    """What came of it: triangles, and the number of flips."""

    triangles: NDArray[np.int32]
    flips: int


@inline
def _distance(xyz, a, b):
    return np.sqrt((xyz[a, 0] - xyz[b, 0]) ** 2 + (xyz[a, 1] - xyz[b, 1]) ** 2 + (xyz[a, 2] - xyz[b, 2]) ** 2)


@lean
def _cotangent_sum(xyz, a, b, c):
    """The sum of the cotangents of a triangle, the same in whatever order its corners are given."""
    one, two, three = _distance(xyz, b, c), _distance(xyz, c, a), _distance(xyz, a, b)
    if one > two:
        one, two = two, one
    if two > three:
        two, three = three, two
    if one > two:
        one, two = two, one
    return (one * one + two * two + three * three) / four_areas(one, two, three)


@inline
def _normal(xyz, a, b, c):
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    size = np.sqrt(x * x + y * y + z * z)
    scale = 1.0 / size if size > 0.0 else 0.0
    return x * scale, y * scale, z * scale


@lean
def _moves(xyz, a, b, c, d, tolerance):
    """Whether the other diagonal would move the surface too far, or turn a triangle over."""
    px, py, pz = _normal(xyz, a, b, c)
    qx, qy, qz = _normal(xyz, b, a, d)
    nx, ny, nz = px + qx, py + qy, pz + qz
    for k in range(2):
        x, y, z = _normal(xyz, a, d, c) if k == 0 else _normal(xyz, b, c, d)
        if not x * nx + y * ny + z * nz > FACING_FLIP:
            return True
    ex, ey, ez = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    fx, fy, fz = xyz[d, 0] - xyz[c, 0], xyz[d, 1] - xyz[c, 1], xyz[d, 2] - xyz[c, 2]
    x, y, z = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    size = np.sqrt(x * x + y * y + z * z)
    wx, wy, wz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    return not abs(wx * x + wy * y + wz * z) <= tolerance * size


@lean
def _joined(given, h, d):
    """Whether an edge joins the beginning of half-edge h to d already; the fan is walked both ways."""
    g = h
    while True:
        if given.vertex[next_side(g)] == d or given.vertex[previous_side(g)] == d:
            return True
        g = given.twin[previous_side(g)]
        if g == h:
            return False
        if g < 0:
            break
    g = h
    while given.twin[g] >= 0:
        g = next_side(given.twin[g])
        if given.vertex[next_side(g)] == d or given.vertex[previous_side(g)] == d:
            return True
    return False


@lean
def _flip(given, h):
    """Replace an edge by the other diagonal, as `flip_side` does."""
    vertex, twin, kept = given.vertex, given.twin, given.kept
    g = twin[h]
    h2, g2 = previous_side(h), previous_side(g)
    c, d = vertex[h2], vertex[g2]
    beyond_h, beyond_g = twin[h2], twin[g2]
    vertex[h], vertex[g] = d, c
    kept[h], kept[g] = kept[g2], kept[h2]
    twin[h], twin[g] = beyond_g, beyond_h
    if beyond_g >= 0:
        twin[beyond_g] = h
    if beyond_h >= 0:
        twin[beyond_h] = g
    twin[h2], twin[g2] = g2, h2
    kept[h2] = kept[g2] = False


@lean
def _wanted(given, h, tolerance):
    """Whether an edge is to be flipped."""
    xyz, vertex = given.xyz, given.vertex
    g = given.twin[h]
    if g < 0 or given.kept[h]:
        return False
    a, b, c, d = vertex[h], vertex[g], vertex[previous_side(h)], vertex[previous_side(g)]
    if c == d or given.pinched[c] or given.pinched[d]:
        return False
    if filter_ball(xyz, a, b, c, d) >= 0 and filter_ball(xyz, b, a, d, c) >= 0:
        return False
    before = _cotangent_sum(xyz, a, b, c) + _cotangent_sum(xyz, b, a, d)
    if not _cotangent_sum(xyz, a, d, c) + _cotangent_sum(xyz, b, c, d) < before:
        return False
    return not (_moves(xyz, a, b, c, d, tolerance) or _joined(given, previous_side(h), d))


@inline
def _is_sound(xyz, a, b, c):
    one, two, three = _distance(xyz, b, c), _distance(xyz, c, a), _distance(xyz, a, b)
    longest = max(one, max(two, three))
    return four_areas(one, two, three) >= 2.0 * SOUND_NEEDLE * longest * longest


@lean
def _wanted_shorter(given, h, tolerance):
    """Whether an edge is to be flipped for a shorter one."""
    xyz, vertex = given.xyz, given.vertex
    g = given.twin[h]
    if g < 0 or given.kept[h]:
        return False
    a, b, c, d = vertex[h], vertex[g], vertex[previous_side(h)], vertex[previous_side(g)]
    if c == d or given.pinched[c] or given.pinched[d]:
        return False
    if not _distance(xyz, c, d) < SHORTER_FLIP * _distance(xyz, a, b):
        return False
    if not (_is_sound(xyz, a, d, c) and _is_sound(xyz, b, c, d)):
        return False
    return not (_moves(xyz, a, b, c, d, tolerance) or _joined(given, previous_side(h), d))


@kernel
def _run(given, tolerance, shorter, queued, stack):
    """Flip until no edge is to be flipped, for one reason or for shorter edges; how many flips."""
    top = count = 0
    for h in range(given.twin.shape[0]):
        if given.twin[h] > h:
            queued[h] = True
            stack[top] = h
            top += 1
    while top > 0:
        top -= 1
        h = stack[top]
        queued[h] = False
        if shorter:
            if not _wanted_shorter(given, h, tolerance):
                continue
        elif not _wanted(given, h, tolerance):
            continue
        g = given.twin[h]
        _flip(given, h)
        count += 1
        for k in range(4):
            e = h if k < 2 else np.int64(g)
            e = next_side(e) if k % 2 else e
            other = given.twin[e]
            if other >= 0 and not (queued[e] or queued[other]):
                queued[e] = True
                stack[top] = e
                top += 1
    return count


def flip_given(
    xyz: NDArray[np.float64], rows: NDArray[np.int32], kept: NDArray[np.int64], tolerance: float
) -> Flipped:
    """Flip edges of triangles; the slot of each triangle stays on the same side of all kept edges.

    Parameters
    ----------
    xyz : (n, 3)
        At most 1 in magnitude.
    rows : (m, 3)
        None of them flat.
    kept : (k, 2)
        Edges that stay, besides those without two triangles of the same orientation.
    tolerance : float
        How far the surface may move at a flip: the distance of the two diagonals.
    """
    return _flipped(xyz, rows, kept, tolerance, False)


def flip_needles(
    xyz: NDArray[np.float64], rows: NDArray[np.int32], kept: NDArray[np.int64], tolerance: float
) -> Flipped:
    """The same for shorter edges, whatever the spheres."""
    return _flipped(xyz, rows, kept, tolerance, True)


def _flipped(
    xyz: NDArray[np.float64],
    rows: NDArray[np.int32],
    kept: NDArray[np.int64],
    tolerance: float,
    shorter: bool,
) -> Flipped:
    gluing = glued(rows, len(xyz))
    flat, after = rows.ravel().astype(np.int64), rows[:, [1, 2, 0]].ravel().astype(np.int64)
    keys = np.minimum(flat, after) * len(xyz) + np.maximum(flat, after)
    stay = (
        np.isin(keys, kept.min(axis=1) * len(xyz) + kept.max(axis=1))
        if len(kept)
        else np.zeros(len(keys), bool)
    )
    pinched = np.bincount(gluing.origin, minlength=len(xyz)) > 1
    given = Given(np.ascontiguousarray(xyz), flat.astype(np.int32), gluing.twin.copy(), stay, pinched)
    count = _run(given, tolerance, shorter, np.zeros(len(flat), np.bool_), np.empty(len(flat), np.int64))
    return Flipped(given.vertex.reshape(-1, 3), int(count))
