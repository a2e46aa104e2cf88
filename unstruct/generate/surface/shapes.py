"""Kernels: the shapes of triangles of a surface, and of the star of a vertex if it were moved.

The *sharpness* of a triangle is the square of the sine of its smallest angle: 3/4 for an equilateral
triangle, 1/4 for 30 degrees. It is negative for one that faces away from a direction of reference.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...connect.insertion.halfedges import next_edge, prev_edge
from ...connect.surface.halfedges import ALONG_CURVE, SEAM_CURVES, SMOOTH, Sheets, first_corner, turned
from ...geometry.support_walk import Held, nearest_from, nearest_on_chain, walked

__all__ = [
    "COLLAPSES",
    "FLIPS_DONE",
    "MOVES_DONE",
    "SPLITS_DONE",
    "TOO_FAR",
    "TURNED",
    "RemeshWork",
    "add_normal",
    "degree_of",
    "distance_squared",
    "middle_distance",
    "nearest_to",
    "settle",
    "sharpness",
    "star_is_near",
    "star_least",
    "star_normal",
    "wanted_squared",
]

LEAST_COSINE_SQUARED = (
    0.04  # of the angle between a new triangle and the direction that it should have: 78 degrees
)
TINY_SQUARED = 1e-24  # a squared distance between points that are equal but for rounding
SPLITS_DONE, COLLAPSES, FLIPS_DONE, MOVES_DONE, TOO_FAR, TURNED = 0, 1, 2, 3, 4, 5  # places in the counts


class RemeshWork(NamedTuple):
    """What kernels of remeshing work on.

    Attributes
    ----------
    sheets : Sheets
        The mesh.
    held : Held
        The given surface.
    x : (4, 3) float64
        Points that are looked at; the first is the candidate.
    ref : (3,) float64
        The direction that triangles should face.
    zero : (3,) float64
        No direction.
    place : (6,) float64
        As of `walked`.
    stack : int64
        As of `nearest_on_chain`.
    counts : (6,) int64
        How many splits, collapses, flips and moves there were, and how many changes were refused because they
        would have been too far from the surface, or turned a triangle over.
    slack : float
        Collapses may leave the surface as far as the square root of this, in allowed distances.
    """

    sheets: Sheets
    held: Held
    x: NDArray[np.float64]
    ref: NDArray[np.float64]
    zero: NDArray[np.float64]
    place: NDArray[np.float64]
    stack: NDArray[np.int64]
    counts: NDArray[np.int64]
    slack: float


# ---------------------------------------------------------------------- triangles


@inline
def distance_squared(xyz, u, w):
    x, y, z = xyz[w, 0] - xyz[u, 0], xyz[w, 1] - xyz[u, 1], xyz[w, 2] - xyz[u, 2]
    return x * x + y * y + z * z


@inline
def wanted_squared(s, u, w):
    """The square of the wanted length of an edge."""
    length = 0.5 * (s.size[u] + s.size[w])
    return length * length


@inline
def add_normal(xyz, a, b, c, ref):
    """Add the cross product of the sides of a triangle to a direction."""
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    ref[0] += uy * vz - uz * vy
    ref[1] += uz * vx - ux * vz
    ref[2] += ux * vy - uy * vx


@inline
def sharpness(p, xyz, a, b, ref):
    """The sharpness of triangle p, a, b; -1 if it faces away from the reference, 0 if it is flat.

    A reference of zero admits every direction.
    """
    ux, uy, uz = xyz[a, 0] - p[0], xyz[a, 1] - p[1], xyz[a, 2] - p[2]
    vx, vy, vz = xyz[b, 0] - p[0], xyz[b, 1] - p[1], xyz[b, 2] - p[2]
    wx, wy, wz = vx - ux, vy - uy, vz - uz
    uu, vv, ww = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    nn = nx * nx + ny * ny + nz * nz
    if nn == 0.0:
        return 0.0
    along = nx * ref[0] + ny * ref[1] + nz * ref[2]
    rr = ref[0] * ref[0] + ref[1] * ref[1] + ref[2] * ref[2]
    if rr > 0.0 and (along <= 0.0 or along * along < LEAST_COSINE_SQUARED * nn * rr):
        return -1.0
    least, most = min(uu, min(vv, ww)), max(uu, max(vv, ww))
    return nn / (most * (uu + vv + ww - least - most))


@lean
def star_normal(s, v, ref):
    """Write the sum of the cross products of the triangles around a vertex."""
    ref[0] = ref[1] = ref[2] = 0.0
    start = first_corner(s, v)
    c = start
    while True:
        add_normal(s.xyz, v, s.vertex[next_edge(c)], s.vertex[prev_edge(c)], ref)
        c = turned(s.twin, c)
        if c < 0 or c == start:
            return


@lean
def star_least(s, v, p, ref, floor):
    """The least sharpness around a vertex if it were at p; it ends at one below the floor.

    Triangles around a smooth vertex should face ``ref``, which is given; others each the direction that they
    face now, and ``ref`` is scratch.
    """
    least = 1.0
    start = first_corner(s, v)
    c = start
    while True:
        a, b = s.vertex[next_edge(c)], s.vertex[prev_edge(c)]
        if s.kind[v] != SMOOTH:
            ref[0] = ref[1] = ref[2] = 0.0
            add_normal(s.xyz, v, a, b, ref)
        least = min(least, sharpness(p, s.xyz, a, b, ref))
        if least < floor:
            return least
        c = turned(s.twin, c)
        if c < 0 or c == start:
            return least


@lean
def degree_of(s, v):
    """The number of edges at a vertex; one more on the boundary than triangles."""
    start = first_corner(s, v)
    c, count = start, 0
    while True:
        count += 1
        c = turned(s.twin, c)
        if c < 0:
            return count + 1
        if c == start:
            return count


# ---------------------------------------------------------------------- the given surface


@lean
def nearest_to(work, guess, within):
    """The triangle of the given surface nearest to the candidate, and the square of the distance.

    A walk from the guess is good enough if it ends at no more than this distance squared.
    """
    p, held, place = work.x[0], work.held, work.place
    t = walked(held, p, work.zero, guess, place)
    square = _away(work, t)
    if square > within:
        t = nearest_from(held, work.x, 0, work.zero, t, place, work.stack)
        square = _away(work, t)
    return t, square


@inline
def _away(work, t):
    """The square of the distance of the candidate from the place in triangle t."""
    square = 0.0
    for k in range(3):
        away = work.x[0, k]
        for j in range(3):
            away -= work.place[j] * work.held.corners[t, j, k]
        square += away * away
    return square


@lean
def settle(work, v, kind, guess):
    """Move the candidate to the nearest point of the given surface, or of its curve; the triangle there.

    ``v`` is the vertex for which it is.
    """
    p, held, place, s = work.x[0], work.held, work.place, work.sheets
    if kind == ALONG_CURVE:
        e = nearest_on_chain(held, work.x, 0, s.on[v], place, work.stack)
        share = place[1]
        for k in range(3):
            a, b = held.edges[e, 0, k], held.edges[e, 1, k]
            p[k] = a + share * (b - a) if share < 1.0 else b
        return nearest_to(work, guess, TINY_SQUARED)[0]
    t = nearest_to(work, guess, s.allowed[v] * s.allowed[v])[0]
    for k in range(3):
        a, b, c = held.corners[t, 0, k], held.corners[t, 1, k], held.corners[t, 2, k]
        p[k] = a + (
            place[1] * (b - a) + place[2] * (c - a)
        )  # in a plane of constant x, y or z it stays there
        if place[1] == 1.0 or place[2] == 1.0:
            p[k] = b if place[1] == 1.0 else c
    return t


@lean
def middle_distance(work, u, w, curve, within):
    """The square of the distance of the middle between two vertices from the surface, or from a curve.

    From the surface, a walk is good enough if it ends at no more than this distance squared.
    """
    s, p, held, place = work.sheets, work.x[0], work.held, work.place
    if curve >= SEAM_CURVES:  # it is a part of a given edge
        return 0.0
    for k in range(3):
        p[k] = 0.5 * (s.xyz[u, k] + s.xyz[w, k])
    if curve < 0:
        return nearest_to(work, s.near[u], within)[1]
    f = nearest_on_chain(held, work.x, 0, curve, place, work.stack)
    square = 0.0
    for k in range(3):
        away = p[k] - place[0] * held.edges[f, 0, k] - place[1] * held.edges[f, 1, k]
        square += away * away
    return square


@lean
def star_is_near(work, v):
    """Whether the centers and edges of the triangles around a vertex are as near the surface as allowed."""
    s, p = work.sheets, work.x[0]
    within = s.allowed[v] * s.allowed[v]
    start = first_corner(s, v)
    c = start
    while True:
        a, b = s.vertex[next_edge(c)], s.vertex[prev_edge(c)]
        if middle_distance(work, v, a, s.curve[prev_edge(c)], within) > within:
            return False
        for k in range(3):
            p[k] = (s.xyz[v, k] + s.xyz[a, k] + s.xyz[b, k]) / 3.0
        if nearest_to(work, s.near[v], within)[1] > within:
            return False
        c = turned(s.twin, c)
        if c < 0 or c == start:
            return True
