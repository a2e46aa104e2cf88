"""The state of a run of Delaunay refinement besides its triangulation, and how it follows each change.

The subsegments that must be split are on a stack. The triangles that miss a limit are in a queue. First come
those that are too large, the last one first. Then come those with too small an angle, in the order of their
shortest edges, shortest first, in buckets of half an octave. (If the angle is the reason for refinement, this
order saves a third of the vertices, together with the rule that triangles leave the queue when they vanish.)
After each change only the new triangles are looked at, and the subsegments that they see.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, lean, lending
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import SEGMENTS, VERTICES
from ...connect.planar.records import Plane, Scratch
from .acute import apexes
from .encroachment import INPUT_VERTEX, encroaches
from .limits import ANGLE, BY_ANGLE, BY_SIZE, largest_radius2, misses, misses_of

# The status of a triangle. It is OPEN if nothing is known of it, or LARGE if it is too large. A number
# between these is the bucket in which it waits because of its angle.
OPEN, LARGE = 0, 249
# Otherwise the status is the reason why the triangle was given up. Subsegments have the same reasons.
KEPT, SMALL_ANGLE, FLOOR, PRECISION, CURVE, NARROW = 250, 251, 252, 253, 254, 255
GUARDED = 249  # a lock like KEPT, but no point for the angle comes so near that it would make the angle worse
STACKED = 256  # a bit besides: the slot has an entry on the stack of triangles that are too large
CURVES, BUDGET = 8, 9  # results of `advance`, besides DONE, MORE and ROOM
# Entries of the tally: first the state of stacks and queue (heights, numbers of waiting ones, the highest
# bucket), the limit of vertices and the number of events; then the numbers of what happened.
SEGMENT_TOP, WANTED, STACK_TOP, LARGE_ONES, LINKED, BUCKET, VERTEX_LIMIT, EVENTS = 0, 1, 2, 3, 4, 5, 6, 7
REMOVED, CIRCUMCENTERS, SPLITS, SHELLS, REJECTED, LOCKED, REFUSALS, BEGUN = 8, 9, 10, 11, 12, 13, 14, 15
BY_FUNCTION = 16  # 1 if a function asks for refinement, so that no limit says how near splits may come
UNKNOWN = -9  # not a kind of vertex
HALF_OCTAVE = math.sqrt(0.5)
# Refinement for the angle makes no edges shorter than a part of the input's edges nearby (`FRACTION`), nor
# shorter than about eight units of rounding of the coordinates (here squared), which would bend all angles.
ROUNDING_SQUARE = 4.0**-50
# How many splits the angle may cost a piece if no budget is given: within wedges and in all; so many, and so
# many more for each subsegment that the input or the size makes.
MOST_IN_WEDGES, WEDGE_EACH = 256, 4
MOST_SPLITS, SPLITS_EACH = 8192, 64
UNLIMITED = 2**40
FINEST_SPAN = 2.0**-50  # of the parameter of a piece: halves that have less could not be told apart


class Work(NamedTuple):
    """All arrays of a run: those of the `PlanarComplex`, then what refinement adds."""

    xy: NDArray[np.float64]
    vertex: NDArray[np.int32]
    twin: NDArray[np.int32]
    mark: NDArray[np.int32]
    region: NDArray[np.int32]
    where: NDArray[np.int32]
    ends: NDArray[np.int32]
    piece: NDArray[np.int32]
    span: NDArray[np.float64]
    state: NDArray[np.int64]
    # per vertex
    kind: NDArray[np.int32]  # the piece in whose interior it lies, or FREE_VERTEX, INPUT_VERTEX, ...
    floor: NDArray[np.float64]  # new points for the angle keep this distance, squared
    # per subsegment
    apexes: NDArray[np.uint8]
    lock: NDArray[np.uint8]  # why it cannot be split, or OPEN
    asked: NDArray[np.uint8]  # bits: why it is on the stack; 0 if it is not
    need: NDArray[np.float64]  # the smallest floor of the vertices and triangles that asked for the split
    given: NDArray[np.float64]  # (., 3) x, y and parameter of a split computed in Python; nan: none
    segments: NDArray[np.int32]  # the stack
    wanted: NDArray[np.int32]  # those that wait for a point of a curve
    # per slot of a triangle
    status: NDArray[np.uint16]  # OPEN, a bucket, LARGE, or why it was given up; and the bit STACKED
    large: NDArray[np.int32]  # the stack of triangles that are too large; some entries are out of date
    ahead: NDArray[np.int32]  # the triangle before it in the same bucket
    behind: NDArray[np.int32]  # the triangle after it
    gates: NDArray[np.int32]  # (LARGE, 2) the first and the last triangle of each bucket
    # per piece
    curve: NDArray[np.int8]
    arc: NDArray[np.float64]
    joints: NDArray[np.int32]
    allowed: NDArray[np.int64]  # (., 2) splits for the angle that are still allowed: in wedges, in all
    # scratch
    stack: NDArray[np.int32]
    cells: NDArray[np.int32]
    rim: NDArray[np.int32]
    hold: NDArray[np.int64]
    fresh: NDArray[np.int32]
    polygon: NDArray[np.int64]
    # the record: (what, vertex, three more) and the place; of length 0 if none is kept
    event: NDArray[np.int32]
    place: NDArray[np.float64]


@lending
def plane_of(w):
    """The arrays of the triangulation alone, for kernels of `connect.planar.cavity` that are not inlined."""
    return Plane(w.xy, w.vertex, w.twin, w.mark, w.region, w.where, w.ends, w.piece, w.span, w.state)


@lending
def scratch_of(w):
    """The work arrays for cavities alone."""
    return Scratch(w.stack, w.cells, w.rim, w.hold, w.fresh)


@inline
def ask(w, tally, s, by, floor):
    """Put subsegment s on the stack, unless it is there or locked; return whether it is there now.

    ``floor`` is that of the vertex or triangle that asks: the squared distance to which the split may come.
    """
    if w.lock[s] != OPEN:
        return False
    if w.asked[s] == 0:
        w.segments[tally[SEGMENT_TOP]] = s
        tally[SEGMENT_TOP] += 1
    w.asked[s] |= by
    w.need[s] = min(w.need[s], floor)
    return True


@inline
def bucket_of(w, t):
    """The bucket of triangle t, which misses only the angle: two an octave of its shortest squared edge."""
    a, b, c = w.vertex[3 * t], w.vertex[3 * t + 1], w.vertex[3 * t + 2]
    p = (w.xy[a, 0] - w.xy[b, 0]) ** 2 + (w.xy[a, 1] - w.xy[b, 1]) ** 2
    q = (w.xy[b, 0] - w.xy[c, 0]) ** 2 + (w.xy[b, 1] - w.xy[c, 1]) ** 2
    s = (w.xy[c, 0] - w.xy[a, 0]) ** 2 + (w.xy[c, 1] - w.xy[a, 1]) ** 2
    f, e = math.frexp(min(p, q, s))
    return min(max(1, 20 - 2 * e - (f > HALF_OCTAVE)), LARGE - 1)


@inline
def unlink(w, tally, t, k):
    """Take triangle t out of bucket k."""
    before, after = w.ahead[t], w.behind[t]
    if before >= 0:
        w.behind[before] = after
    else:
        w.gates[k, 0] = after
    if after >= 0:
        w.ahead[after] = before
    else:
        w.gates[k, 1] = before
    tally[LINKED] -= 1


@inline
def give_up(w, tally, t, why):
    """Note why triangle t, which does not wait any longer, was not refined."""
    w.status[t] = (w.status[t] & STACKED) | why
    tally[REFUSALS] += 1


@inline
def link(w, tally, t):
    """Put triangle t at the end of the bucket of its shortest edge."""
    k = bucket_of(w, t)
    w.status[t] |= k
    tally[LINKED] += 1
    tally[BUCKET] = max(tally[BUCKET], k)
    last = w.gates[k, 1]
    w.ahead[t], w.behind[t] = last, -1
    w.gates[k, 1] = t
    if last >= 0:
        w.behind[last] = t
    else:
        w.gates[k, 0] = t


@inline
def settle(w, tally, t, bits):
    """Queue the new triangle in slot t, which misses the limits ``bits``: on the stack, in a bucket, or not.

    There are no branches unless a bucket is concerned, for the reason that `misses_of` gives. So the entry on
    the stack is always written, but counted only if it is needed. An older entry of the slot stays there.
    """
    before = np.int64(w.status[t])
    known, stacked = before & 255, before & STACKED
    if 0 < known < LARGE:
        unlink(w, tally, t, known)
    is_large = np.int64(bits > ANGLE)
    top = tally[STACK_TOP]
    w.large[top] = t
    tally[STACK_TOP] = top + (is_large & (stacked == 0))
    tally[LARGE_ONES] += is_large - (known == LARGE)
    w.status[t] = stacked | is_large * (STACKED | LARGE)
    if bits == ANGLE:
        link(w, tally, t)


@inline
def next_triangle(w, tally):
    """Take the last triangle that is too large, or the first of the highest bucket: (t, why it waits)."""
    while tally[LARGE_ONES] > 0:
        tally[STACK_TOP] -= 1
        t = np.int64(w.large[tally[STACK_TOP]])
        k = w.status[t] & 255
        if k == LARGE:
            w.status[t] = OPEN
            tally[LARGE_ONES] -= 1
            return t, BY_SIZE
        w.status[t] = k  # the entry was out of date
    k = tally[BUCKET]
    while w.gates[k, 0] < 0:
        k -= 1
    tally[BUCKET] = k
    t = np.int64(w.gates[k, 0])
    unlink(w, tally, t, k)
    w.status[t] &= STACKED
    return t, BY_ANGLE


@inline
def look_at_segment(w, tally, limits, s):
    """Ask for a split of subsegment s if it is too long, or if a vertex opposite it encroaches on it."""
    e = np.int64(w.where[s])
    a, b = w.ends[s, 0], w.ends[s, 1]
    ax, ay, bx, by = w.xy[a, 0], w.xy[a, 1], w.xy[b, 0], w.xy[b, 1]
    square = (ax - bx) * (ax - bx) + (ay - by) * (ay - by)
    for side in range(2):
        o = e if side == 0 else np.int64(w.twin[e])
        r = w.region[o // 3]
        if r < 0:
            continue
        p = w.vertex[o]
        if square > 4.0 * largest_radius2(limits, r, 0.5 * (ax + bx), 0.5 * (ay + by)):
            ask(w, tally, s, BY_SIZE, w.floor[p])
        elif encroaches(ax, ay, bx, by, w.xy[p, 0], w.xy[p, 1], limits.lens):
            ask(w, tally, s, BY_ANGLE, w.floor[p])


@inline
def look_at_star(w, tally, limits, k):
    """Queue the bad ones of the k new triangles, and the subsegments on which their apex encroaches."""
    for i in range(k):
        t = w.fresh[i]
        bits = 0
        if w.region[t] >= 0:
            p, a, b = w.vertex[3 * t], w.vertex[3 * t + 1], w.vertex[3 * t + 2]
            s = w.mark[3 * t]
            if s >= 0 and encroaches(
                w.xy[a, 0], w.xy[a, 1], w.xy[b, 0], w.xy[b, 1], w.xy[p, 0], w.xy[p, 1], limits.lens
            ):
                ask(w, tally, s, BY_ANGLE, w.floor[p])
            bits = misses(w.xy, p, a, b, w.region[t], limits)
        settle(w, tally, t, bits)


@inline
def look_at_fan(w, tally, limits, p, r, k):
    """`look_at_star` within one region, by the data that `commit_here` left in ``hold``.

    It takes a fifth of the whole time.
    """
    px, py = w.xy[p, 0], w.xy[p, 1]
    a = w.hold[0, 0]
    ax, ay = w.xy[a, 0], w.xy[a, 1]
    ux, uy = ax - px, ay - py
    near = ux * ux + uy * uy
    for i in range(k):
        b, s, t = w.hold[i, 1], w.hold[i, 3], w.fresh[i]
        bx, by = w.xy[b, 0], w.xy[b, 1]
        vx, vy = bx - px, by - py
        far = vx * vx + vy * vy
        if s >= 0 and encroaches(ax, ay, bx, by, px, py, limits.lens):
            ask(w, tally, s, BY_ANGLE, w.floor[p])
        outer = (bx - ax) * (bx - ax) + (by - ay) * (by - ay)
        x, y = (px + ax + bx) / 3.0, (py + ay + by) / 3.0
        bits = misses_of(ux * vy - uy * vx, near, far, outer, x, y, r, limits)
        settle(w, tally, t, bits)
        ax, ay, ux, uy, near = bx, by, vx, vy, far


@lean
def look_at_all(w, tally, limits):
    """Look at every subsegment and every triangle at the beginning."""
    for s in range(w.state[SEGMENTS] - 1, -1, -1):
        look_at_segment(w, tally, limits, s)
    for t in range(w.state[COUNT] - 1, -1, -1):
        r = w.region[t]
        if r >= 0:
            bits = misses(w.xy, w.vertex[3 * t], w.vertex[3 * t + 1], w.vertex[3 * t + 2], r, limits)
            settle(w, tally, t, bits)


@inline
def record(w, tally, what, p, corners, px, py):
    """Note an event if a record is kept; ``corners`` are three vertices, or other numbers (the "cause")."""
    if len(w.event) > 0:
        i = tally[EVENTS]
        w.event[i, 0], w.event[i, 1] = what, p
        w.event[i, 2], w.event[i, 3], w.event[i, 4] = corners
        w.place[i, 0], w.place[i, 1] = px, py
        tally[EVENTS] = i + 1


# --- before the first step -------------------------------------------------------------------------


@lean
def set_kinds(inputs, ends, piece, kind):
    """Set the kind of each vertex: the piece that it cuts, or INPUT_VERTEX for the input and all others."""
    for v in range(kind.shape[0]):
        kind[v] = UNKNOWN
    for i in range(inputs.shape[0]):
        kind[inputs[i]] = INPUT_VERTEX
    for s in range(ends.shape[0]):
        for k in range(2):
            v = ends[s, k]
            if kind[v] != INPUT_VERTEX:
                kind[v] = piece[s]
    for v in range(kind.shape[0]):
        if kind[v] == UNKNOWN:
            kind[v] = INPUT_VERTEX


@lean
def expected(plane, limits):
    """About how many vertices the limits will lead to, as far as they are constant.

    In test runs there were 1.6 triangles for each largest area, and 3 for each squared wanted edge length.
    """
    xy, vertex, region = plane.xy, plane.vertex, plane.region
    number = 0.0
    for t in range(plane.state[COUNT]):
        r = region[t]
        if r >= 0:
            a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
            ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
            vx, vy = xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
            twice = ux * vy - uy * vx
            number += max(1.6 * twice / limits.twice_area[r], 0.75 * twice / limits.radius2[r])
    return 0.52 * number


@lean
def set_floors(xy, vertex, mark, region, count, fraction, floor):
    """Set the floors: ``floor[v]`` is the fraction of a squared distance.

    This is the length of the shortest edge at v within the domain or, if that is less, the distance from v to
    a subsegment opposite it.
    """
    for v in range(floor.shape[0]):
        floor[v] = np.inf
    for t in range(count):
        if region[t] < 0:
            continue
        for i in range(3):
            a, b, c = vertex[3 * t + i], vertex[3 * t + (i + 1) % 3], vertex[3 * t + (i + 2) % 3]
            ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
            vx, vy = xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
            side = ux * ux + uy * uy
            floor[a], floor[b] = min(floor[a], side), min(floor[b], side)
            wx, wy = vx - ux, vy - uy
            if mark[3 * t + i] >= 0 and ux * wx + uy * wy < 0.0 < vx * wx + vy * wy:
                height = (ux * vy - uy * vx) ** 2 / (wx * wx + wy * wy)
                floor[a] = min(floor[a], height)
    for v in range(floor.shape[0]):
        floor[v] *= fraction


@apart
def begin(w, inputs, fraction, thrifty):
    """Set the initial values of a run; a ``thrifty`` one limits what the angle may cost a piece."""
    n, s = w.state[VERTICES], w.state[SEGMENTS]
    set_kinds(inputs, w.ends[:s], w.piece, w.kind[:n])
    set_floors(w.xy, w.vertex, w.mark, w.region, w.state[COUNT], fraction, w.floor[:n])
    apexes(w, w.curve, w.apexes[:s])
    for i in range(s):  # no split has been asked for yet
        w.lock[i], w.asked[i], w.need[i] = 0, 0, np.inf
        w.given[i, 0] = w.given[i, 1] = w.given[i, 2] = np.nan
    for k in range(w.allowed.shape[0]):
        w.allowed[k, 0] = MOST_IN_WEDGES if thrifty else UNLIMITED
        w.allowed[k, 1] = MOST_SPLITS if thrifty else UNLIMITED
    for i in range(s):
        w.allowed[w.piece[i], 0] += WEDGE_EACH
        w.allowed[w.piece[i], 1] += SPLITS_EACH
