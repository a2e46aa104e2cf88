"""The last step of finishing: the sharpest triangles, one after another, compiled.

A queue has the triangles with an angle below a goal, the sharpest first, and behind them those with an edge
of a wrong length. Around each a `Patch` is copied, and changes are tried on copies of it: none, a swap of one
of the triangle's edges, a new vertex in it, one vertex less. After each change the vertices inside are moved,
and those of the boundary slide on their pieces, until the *sharpness* of the patch decreases no longer (see
`sharpness`). Diagonals are swapped so that the patch becomes constrained Delaunay, which never makes its
minimum angle smaller. The best copy replaces the triangles that there were, if its minimum angle is larger,
and no more edges and triangles have a wrong size. Book: 2.6c.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.heap import pop, push
from ...base.jit import apart, inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import VERTICES
from ...connect.planar.stars import legalize
from ...sizing.table import ROOT3
from .patch import (
    CELLS,
    PATCH_VERTICES,
    RIM,
    drop,
    gather,
    outside_holds,
    put_back,
    put_inside,
    same,
    turn,
)
from .sharpness import UNIT_SHARP, judge_patch, make_legal, settle_patch
from .steps import classify, wanted

__all__ = ["CHANGES", "Queue", "change_patch", "sharpen", "survey_sharp"]

GAIN = 1.004  # the least factor by which the squared sine of a minimum angle must grow
EVEN = 1.5  # a ratio of the squares of edges
ASKED = 0.465  # the squared sine of 43 degrees: where a patch stays below it, vertices may slide
GRAVE = 0.413  # the squared sine of 40 degrees: triangles below it have a share of the trials of their own
# Changes that are tried: none, three swaps, a new vertex; and six removals, which seldom help.
USUAL_CHANGES, CHANGES = 5, 11
ROOM_NEEDED = 8  # there must be room for so many vertices
# Places in ``tally``: how many patches were looked at and replaced, and trials; and what is allowed.
PATCHES_SEEN, REPLACED, TRIALS, MOST_TRIALS, MOST_GRAVE, MAY_GROW, WAITING_AT_FIRST = range(7)


class Queue(NamedTuple):
    """The triangles to be treated, and scratch."""

    key: NDArray[np.float64]
    slot: NDArray[np.int64]
    place: NDArray[np.int32]  # -1 for each slot
    stuck: NDArray[np.bool_]  # for each slot whether a trial to make its triangle less sharp has failed
    stack: NDArray[np.int32]


@lean
def change_patch(patch, stars, kind, grow):
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


@apart
def _try_all(plane, patches, spots, stack, goal, bound, tally):
    """Try the changes of the first patch: whether the third is now better, and whether it is still sharp."""
    (first, first_stars), (work, work_stars), (best, best_stars) = patches
    top, fewest = judge_patch(first, first_stars, bound)
    found, bar = False, inf
    for kind in range(CHANGES if top < GRAVE else USUAL_CHANGES):
        same(first, first_stars, work, work_stars)
        if not change_patch(work, work_stars, kind, tally[MAY_GROW] > 0):
            continue
        tally[TRIALS] += 1
        if 0 < kind < 4:  # otherwise the swap would be undone at once
            settle_patch(work, work_stars, spots, False, bar)
        make_legal(work, work_stars)
        sharpest = settle_patch(work, work_stars, spots, True, bar)
        bar = min(bar, sharpest)
        make_legal(work, work_stars)
        sine, wrong = judge_patch(work, work_stars, bound)
        sharper = sine > top * GAIN and wrong <= fewest
        fitter = wrong < fewest and sine >= min(top, UNIT_SHARP)
        if (sharper or fitter) and outside_holds(plane, work, work_stars, stack) >= 0:
            top, fewest, found = sine, wrong, True
            same(work, work_stars, best, best_stars)
            if top >= goal and wrong == 0:
                break
    return found, top < ASKED or fewest > 0


# --- the queue -------------------------------------------------------------------------------------


@inline
def _key(plane, front, t, goal):
    """The place of a triangle in the queue: the squared sine of its minimum angle, if below the goal.

    It is above 1 if only an edge that could be changed has a wrong length, and inf if the triangle is not to
    be treated. A corner between two marked edges is as sharp as the domain is.
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
    if most < EVEN * least:  # an accepted triangle with such edges has none that is too long
        return inf
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


@apart
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
    p = plane
    legalize(p.xy, p.vertex, p.twin, p.mark, p.where, vertices.at, stack, np.int64(depth))
    for t in range(patch.counters[CELLS]):
        if patch.live[t] >= 0:
            slot = np.int64(patch.slots[t])
            queue.stuck[slot] = False
            classify(plane, front, slot)
            count = _wait(plane, front, goal, slot, queue, count)
    for b in range(patch.counters[RIM]):
        if patch.segment[b] < 0:
            slot = np.int64(patch.outer[b] // 3)
            classify(plane, front, slot)
            count = _wait(plane, front, goal, slot, queue, count)
    return count


@inline
def _in_the_way(plane, front, queue, patch, goal, key):
    """Whether a sharper triangle of the patch has been tried in vain: it would decide again."""
    for t in range(patch.counters[CELLS]):
        slot = np.int64(patch.slots[t])
        if queue.stuck[slot] and _key(plane, front, slot, goal) < key:
            return True
    return False


@lean
def sharpen(plane, front, vertices, queue, patches, spots, goal, tally):
    """Treat the ``tally[WAITING_AT_FIRST]`` entries of the queue, and those that come of it.

    ``goal`` is a squared sine. It stops at the allowed numbers of trials, and where there is no more room for
    new vertices. With ``spots`` only patches with a vertex that may slide are looked at. ``asked`` is set for
    the vertices of patches that stay sharp.
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
        for v in range(first.counters[PATCH_VERTICES]):
            h = wanted(front, first_stars.xy[v, 0], first_stars.xy[v, 1]) * ROOT3
            first.size[v] = h * h
            slides = slides or first.row[v] >= 0
        if not slides or _in_the_way(plane, front, queue, first, goal, key):
            continue
        tally[PATCHES_SEEN] += 1
        found, sharp = _try_all(plane, patches, spots, queue.stack, goal, bound, tally)
        if sharp:
            for v in range(first.counters[PATCH_VERTICES]):
                vertices.asked[first.names[v]] = True
        if not found:
            queue.stuck[seed] = True
        else:
            tally[REPLACED] += 1
            count = _replace(plane, front, vertices, queue, patches, spots, goal, count)
