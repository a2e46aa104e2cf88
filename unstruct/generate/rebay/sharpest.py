"""The last step of finishing: the sharpest triangles, one after another, compiled.

A queue has the triangles with an angle below a goal, the sharpest first, and behind them those with an edge
of a wrong length. Around each a `Patch` is copied, and changes are tried on copies of it: none, a swap of one
of the triangle's edges, a new vertex in it, one vertex less. After each change the vertices inside are moved,
and those of the boundary slide on their pieces, until the *sharpness* of the patch decreases no longer. That
is a sum over triangles and edges in which the worst ones outweigh all others by far; contrary to a minimum it
also decreases by moves that only make room for others. Diagonals are swapped so that the patch becomes
constrained Delaunay, which never makes its minimum angle smaller. The best copy replaces the triangles that
there were, if its minimum angle is larger, and it has no more edges and triangles of a wrong size. Book: 2.6c.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.heap import pop, push
from ...base.jit import inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import VERTICES, end_of, next_edge, prev_edge, start_of
from ...connect.planar.stars import CERTAIN, COMPASS, TINY_AREA, legalize, star_of, swap_around
from ...predicates.kernels import orient2
from ...sizing.table import ROOT3
from .patch import (
    CELLS, POINTS, RIM, drop, fan_of, gather, outside_holds, put_back, put_inside, same, turn,
)  # fmt: skip
from .steps import classify, wanted

__all__ = ["Queue", "sharpen", "survey_sharp"]

SHARP = 0.44  # the squared sine of 41.6 degrees: here the sharpness of a triangle is 1
LONG = 1.9  # the squared ratio of an edge and the wanted length, or its inverse, where its sharpness is 1
FIRST_STEP, SHORTER, SWEEPS = 0.12, 0.6, 9  # moves of vertices, in edge lengths; each sweep has shorter ones
LESS = 0.995  # a move must decrease the sharpness of a star by this factor
# Stars stay where they are if they are less sharp than the sharpest by the factor CALM. If no star of a patch
# has more than the sharpness ENOUGH, its angles are above 45 degrees and its edges of the wanted length.
CALM, ENOUGH = 0.02, 0.25
GAIN = 1.004  # the least factor by which the squared sine of a minimum angle must grow
GRAVE = 0.413  # the squared sine of 40 degrees: triangles below it have a share of the trials of their own
SLIDES = (-4, 4, -2, 2, -1, 1)  # by how many places a vertex slides
CHANGES = 11  # how many changes are tried: none, three swaps, a new vertex, six removals
ROOM_NEEDED = 8  # there must be room for so many vertices
# Places in ``tally``: how many patches were looked at and replaced, and trials; and what is allowed.
SEEN, REPLACED, TRIALS, MOST_TRIALS, MOST_GRAVE, MAY_GROW, WAITING_AT_FIRST = range(7)


class Queue(NamedTuple):
    """The triangles to be treated, and scratch."""

    key: NDArray[np.float64]
    slot: NDArray[np.int64]
    place: NDArray[np.int32]  # -1 for each slot
    stack: NDArray[np.int32]


# --- the sharpness of stars ------------------------------------------------------------------------


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
        below, shorter = double * double * min(u, min(v, w)), LONG * min(u, size)
        if below <= 0.0 or shorter <= 0.0:
            return inf
        total += _eighth(SHARP * u * v * w / below) + _eighth(max(u, size) / shorter)
        ux, uy, u = vx, vy, v
    shorter = LONG * min(u, size)  # once more the first edge, or the last one of a fan
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


@lean
def _legal(patch, stars):
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
    """A better place for the vertex of a star with the sharpness ``least``: steps of this length, then half."""
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


@lean
def _settle(patch, stars, spots, swap):
    """Move the vertices of a patch until its sharpness decreases no longer; with ``swap`` swap diagonals."""
    xy, places = stars.xy, stars.places
    reach, most = FIRST_STEP, 0.0
    for _ in range(SWEEPS):
        moves, sharpest = 0, 0.0
        for v in range(patch.counters[POINTS]):
            if stars.still[v]:
                if patch.row[v] >= 0 and _slide(patch, stars, spots, v):
                    moves += 1
                    if swap:
                        _legal(patch, stars)
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
        if sharpest < ENOUGH or (moves == 0 and reach < 0.02):
            break
        reach *= SHORTER
        most = sharpest


# --- trials ----------------------------------------------------------------------------------------


@lean
def _judge(patch, stars, bound):
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


@lean
def _changed(patch, stars, kind, grow):
    """Make change ``kind`` of the first triangle of a patch; whether that is possible."""
    if kind < 4:
        return kind == 0 or turn(stars, np.int64(kind - 1))
    if kind == 4:
        if grow:
            put_inside(patch, stars, 0)
        return grow
    e = np.int64((kind - 5) % 3)
    if kind < 8:
        v = stars.vertex[e]
    elif stars.mark[e] < 0:
        v = stars.vertex[stars.twin[e]]
    else:
        return False
    return not stars.still[v] and drop(patch, stars, v)


@lean
def _try_all(plane, patches, spots, stack, goal, bound, tally):
    """Try the changes of the first patch; whether the third one now has something better."""
    (first, first_stars), (work, work_stars), (best, best_stars) = patches
    top, fewest = _judge(first, first_stars, bound)
    found = False
    for kind in range(CHANGES):
        same(first, first_stars, work, work_stars)
        if not _changed(work, work_stars, kind, tally[MAY_GROW] > 0):
            continue
        tally[TRIALS] += 1
        if 0 < kind < 4:  # otherwise the swap would be undone at once
            _settle(work, work_stars, spots, False)
        _legal(work, work_stars)
        _settle(work, work_stars, spots, True)
        _legal(work, work_stars)
        sine, wrong = _judge(work, work_stars, bound)
        sharper = sine > top * GAIN and wrong <= fewest
        fitter = wrong < fewest and sine >= min(top, SHARP)
        if (sharper or fitter) and outside_holds(plane, work, work_stars, stack) >= 0:
            top, fewest, found = sine, wrong, True
            same(work, work_stars, best, best_stars)
            if top >= goal and wrong == 0:
                break
    return found, top >= goal and fewest == 0


# --- the queue -------------------------------------------------------------------------------------


@inline
def _key(plane, front, t, goal):
    """The place of a triangle in the queue, inf for none: the squared sine of its minimum angle below the goal.

    It is above 1 if an edge that could be changed has a wrong length. A corner between two marked edges is as
    sharp as the domain is.
    """
    xy, vertex, mark = plane.xy, plane.vertex, plane.mark
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    ux, uy, vx, vy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1], xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
    wx, wy, double = vx - ux, vy - uy, ux * vy - uy * vx
    u, v, w = ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy  # opposite c, b, a
    least, most, product = min(u, min(v, w)), max(u, max(v, w)), u * v * w
    if double * double * least < goal * product:
        at = np.int64(3 * t + (0 if w == least else 1 if v == least else 2))
        if mark[3 * t + (at + 1) % 3] < 0 or mark[3 * t + (at + 2) % 3] < 0:
            return double * double * least / product
    f = wanted(front, xy[a, 0] + (ux + vx) / 3.0, xy[a, 1] + (uy + vy) / 3.0)
    h = 3.0 * f * f
    if (most > 2.0 * h or 2.0 * least < h) and least > 0.0 and h > 0.0:
        worst = 1.0
        for e, square in ((3 * t, w), (3 * t + 1, v), (3 * t + 2, u)):
            if mark[e] < 0:
                worst = max(worst, max(square, h) / min(square, h))
        if worst > 2.0:
            return 1.0 + 1.0 / worst
    return inf


@inline
def _wait(plane, front, goal, t, queue, count):
    """Put triangle t into the queue if it is sharp or of a wrong size; return the number in the queue."""
    key = _key(plane, front, t, goal)
    # the second half of a queue that is too short is for the sharpest ones
    if key < inf and count < (len(queue.key) if key < GRAVE else len(queue.key) // 2):
        return push(queue.key, queue.slot, count, key, t)
    return count


@lean
def survey_sharp(plane, front, queue, goal):
    """Put all triangles below the goal into the queue; return how many."""
    count = np.int64(0)
    for t in range(plane.state[COUNT]):
        if plane.region[t] >= 0:
            count = _wait(plane, front, goal, np.int64(t), queue, count)
    return count


@lean
def _replace(plane, front, vertices, queue, patches, spots, goal, count):
    """Put the third patch in place; classify and queue what has changed; return the number in the queue."""
    patch, stars = patches[2]
    stack = queue.stack
    depth = outside_holds(plane, patch, stars, stack)
    put_back(plane, patch, stars, vertices, spots)
    for b in range(patch.counters[RIM]):
        if patch.segment[b] < 0:
            stack[depth] = patch.outer[b]
            depth += 1
    legalize(
        plane.xy, plane.vertex, plane.twin, plane.mark, plane.where, vertices.at, stack, np.int64(depth)
    )
    for t in range(patch.counters[CELLS]):
        if patch.live[t] >= 0:
            slot = np.int64(patch.slots[t])
            classify(plane, front, slot)
            count = _wait(plane, front, goal, slot, queue, count)
    for b in range(patch.counters[RIM]):
        if patch.segment[b] < 0:
            slot = np.int64(patch.outer[b] // 3)
            classify(plane, front, slot)
            count = _wait(plane, front, goal, slot, queue, count)
    return count


@lean
def sharpen(plane, front, vertices, queue, patches, spots, goal, tally):
    """Treat the ``tally[WAITING_AT_FIRST]`` entries of the queue, and those that come of it.

    ``goal`` is a squared sine. It stops at the allowed numbers of trials, and where there is no more room for
    ``ROOM_NEEDED`` vertices. With ``spots`` only patches with a vertex that may slide are looked at. ``asked``
    is set for the vertices of patches that stay below the goal.
    """
    first, first_stars = patches[0]
    xy, state = plane.xy, plane.state
    bound = front.rule.accept * front.rule.accept / 3.0
    count = np.int64(tally[WAITING_AT_FIRST])
    while count > 0 and state[VERTICES] + ROOM_NEEDED < len(xy):
        key, seed = queue.key[0], queue.slot[0]
        if tally[TRIALS] >= (tally[MOST_GRAVE] if key < GRAVE else tally[MOST_TRIALS]):
            break
        count = pop(queue.key, queue.slot, count)
        if plane.region[seed] < 0 or _key(plane, front, seed, goal) != key:
            continue  # it has changed since
        gather(plane, vertices, queue.place, seed, first, first_stars)
        slides = len(spots) == 0
        for v in range(first.counters[POINTS]):
            h = wanted(front, first_stars.xy[v, 0], first_stars.xy[v, 1]) * ROOT3
            first.size[v] = h * h
            slides = slides or first.row[v] >= 0
        if not slides:
            continue
        tally[SEEN] += 1
        found, done = _try_all(plane, patches, spots, queue.stack, goal, bound, tally)
        if not done:
            for v in range(first.counters[POINTS]):
                vertices.asked[first.names[v]] = True
        if found:
            tally[REPLACED] += 1
            count = _replace(plane, front, vertices, queue, patches, spots, goal, count)
