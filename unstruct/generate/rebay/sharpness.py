"""The sharpness of a patch: what its vertices move for, and how it is judged afterwards; compiled.

The sharpness of a triangle is the sixteenth power of the inverse sine of its minimum angle, up to a factor;
that of an edge the sixteenth power of its ratio to the wanted length, or of the inverse. In the sum over a
star or a patch the worst ones outweigh all others by far. Contrary to a minimum, a sum also decreases by
moves that only make room for others. Book: 2.6c.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np

from ...base.jit import apart, inline
from ...connect.insertion.halfedges import end_of, next_edge, prev_edge, start_of
from ...connect.planar.stars import CERTAIN, COMPASS, TINY_AREA, legalize, star_of, swap_around
from ...predicates.kernels import orient2
from .patch import CELLS, PATCH_VERTICES, fan_of

__all__ = ["UNIT_SHARP", "judge_patch", "make_legal", "settle_patch"]

UNIT_SHARP = 0.44  # the squared sine of 41.6 degrees: here the sharpness of a triangle is 1
UNFIT = 1.9  # the squared ratio of an edge and the wanted length, or its inverse, where its sharpness is 1
FIRST_STEP, SHORTER, SWEEPS = 0.12, 0.6, 9  # moves of vertices, in edge lengths; each sweep has shorter ones
LESS = 0.995  # a move must decrease the sharpness of a star by this factor
# Stars stay where they are if they are less sharp than the sharpest by the factor CALM. If no star of a patch
# is sharper than SHARP_ENOUGH, its angles are above 45 degrees and its edges of the wanted length.
CALM, SHARP_ENOUGH = 0.02, 0.25
# A patch is given up after so many sweeps if it is sharper by the factor HOPE than the best trial so far.
HOPE_ENDS, HOPE = 2, 3.0
SLIDES = (-4, 4, -2, 2, -1, 1)  # by how many places a vertex slides


@inline
def _eighth(x):
    x *= x
    x *= x
    return x * x


@inline
def _sharpness(places, k, x, y, size):
    """The sharpness of a star with its vertex at x, y; inf if a triangle is not counterclockwise."""
    total = 0.0
    ux, uy = places[0, 0] - x, places[0, 1] - y
    u = ux * ux + uy * uy
    for i in range(k):
        vx, vy = places[i + 1, 0] - x, places[i + 1, 1] - y
        wx, wy = vx - ux, vy - uy
        v, w, double = vx * vx + vy * vy, wx * wx + wy * wy, ux * vy - uy * vx
        if double <= CERTAIN * (u + v + w) + TINY_AREA and (  # otherwise the sign is certain
            double <= 0.0
            or orient2(places[i, 0], places[i, 1], places[i + 1, 0], places[i + 1, 1], x, y) <= 0
        ):
            return inf
        below, shorter = double * double * min(u, min(v, w)), UNFIT * min(u, size)
        if below <= 0.0 or shorter <= 0.0:
            return inf
        total += _eighth(UNIT_SHARP * u * v * w / below) + _eighth(max(u, size) / shorter)
        ux, uy, u = vx, vy, v
    shorter = UNFIT * min(u, size)  # once more the first edge, or the last one of a fan
    return total + _eighth(max(u, size) / shorter) if shorter > 0.0 else inf


@inline
def _slide(patch, stars, spots, v):
    """Let a vertex of the boundary slide to another place of its piece, if that decreases the sharpness."""
    s, places, row = stars, stars.places, patch.row[v]
    k = fan_of(s.xy, s.vertex, s.twin, s.mark, s.at[v], places)
    here, size = patch.spot[v], patch.size[v]
    least, best = _sharpness(places, k, s.xy[v, 0], s.xy[v, 1], size), here
    for step in SLIDES:
        other = here + step
        if 0 <= other < spots.shape[1]:
            new = _sharpness(places, k, spots[row, other, 0], spots[row, other, 1], size)
            if new < LESS * least:
                best, least = other, new
    patch.spot[v] = best
    s.xy[v, 0], s.xy[v, 1] = spots[row, best, 0], spots[row, best, 1]
    return best != here


@apart
def make_legal(patch, stars):
    """Swap diagonals until the patch is constrained Delaunay."""
    s, depth = stars, 0
    for t in range(patch.counters[CELLS]):
        if patch.live[t] >= 0:
            for e in range(3 * t, 3 * t + 3):
                if s.twin[e] > e:
                    s.stack[depth] = e
                    depth += 1
    legalize(s.xy, s.vertex, s.twin, s.mark, s.where, s.at, s.stack, np.int64(depth))


@inline
def _shift(places, k, x, y, size, least, step):
    """A better place for the vertex of a star with the sharpness ``least``; steps are halved twice."""
    halvings = 2
    while halvings > 0:
        found = False
        for dx, dy in COMPASS:
            new = _sharpness(places, k, x + step * dx, y + step * dy, size)
            if new < LESS * least:
                x, y, least, found = x + step * dx, y + step * dy, new, True
                break
        if not found:
            step, halvings = step / 2.0, halvings - 1
    return x, y


@apart
def settle_patch(patch, stars, spots, swap, bar):
    """Move the vertices of a patch until its sharpness decreases no longer; with ``swap`` swap diagonals.

    Returns the sharpness of the sharpest star. It ends early if that stays far above ``bar``.
    """
    xy, places = stars.xy, stars.places
    reach, most = FIRST_STEP, 0.0
    for sweep in range(SWEEPS):
        moves, sharpest = 0, 0.0
        for v in range(patch.counters[PATCH_VERTICES]):
            if stars.still[v]:
                if patch.row[v] >= 0 and _slide(patch, stars, spots, v):
                    moves += 1
                    if swap:
                        make_legal(patch, stars)
                continue
            k = star_of(xy, stars.vertex, stars.twin, stars.at[v], stars.ring, places)
            x, y, size = xy[v, 0], xy[v, 1], patch.size[v]
            least = _sharpness(places, k, x, y, size)
            sharpest = max(sharpest, least)
            if least < CALM * most:
                continue
            xy[v, 0], xy[v, 1] = _shift(places, k, x, y, size, least, reach * sqrt(size))
            if xy[v, 0] != x or xy[v, 1] != y:
                moves += 1
                if swap:
                    swap_around(stars, k)
        most = sharpest
        if sharpest < SHARP_ENOUGH or moves == 0 or (sweep >= HOPE_ENDS and sharpest > HOPE * bar):
            break
        reach *= SHORTER
    return most


@apart
def judge_patch(patch, stars, bound):
    """The smallest squared sine in a patch, and how many edges and triangles have a wrong size.

    Edges must have the wanted length up to the factor sqrt(2), and triangles must be accepted: R < delta f,
    with ``bound`` = delta^2 / 3.
    """
    xy, vertex, size = stars.xy, stars.vertex, patch.size
    sine, wrong = 1.0, 0
    for t in range(patch.counters[CELLS]):
        if patch.live[t] < 0:
            continue
        a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
        if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) <= 0:
            return 0.0, 1 << 20
        product, shortest, corner = 1.0, inf, np.int64(0)
        for e in range(3 * t, 3 * t + 3):
            p, q = start_of(vertex, e), end_of(vertex, e)
            ux, uy = xy[q, 0] - xy[p, 0], xy[q, 1] - xy[p, 1]
            u, h = ux * ux + uy * uy, (size[p] + size[q]) / 2.0
            product *= u
            if u < shortest:
                shortest, corner = u, np.int64(e)
            if (stars.mark[e] >= 0 or stars.twin[e] > e) and (u > 2.0 * h or 2.0 * u < h):
                wrong += 1
        ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
        double = ux * (xy[c, 1] - xy[a, 1]) - uy * (xy[c, 0] - xy[a, 0])
        if product >= 4.0 * double * double * bound * (size[a] + size[b] + size[c]) / 3.0:
            wrong += 1
        one, other = stars.mark[next_edge(corner)], stars.mark[prev_edge(corner)]
        given = min(one, other) >= 0 and min(patch.segment[one], patch.segment[other]) >= 0
        if not given:  # else the angle between these two segments, as sharp as the domain is
            sine = min(sine, double * double * shortest / product if product > 0.0 else 0.0)
    return sine, wrong
