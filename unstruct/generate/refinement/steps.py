"""Delaunay refinement, compiled: split encroached subsegments, then insert circumcenters of bad triangles.

One step takes a subsegment from its stack, if there is one, or else a triangle:

    subsegment  split it at its middle (on a shell at small angles; on the true curve), from both sides at
                once;
    triangle    find the cavity of its circumcenter, from the triangle as the seed, without a change. If
                subsegments of the cavity's boundary hide the point, or the point encroaches on them, they go
                on the stack and the triangle waits. Otherwise the star of the point replaces the cavity.

After each change only the new triangles are looked at, and the subsegments that they see. If a split is
impossible, the subsegment is locked with the reason; in the end the triangles that need the split are given
up with the same reason.

The loop always ends. A point that the angle asks for must keep the distance ``floor`` from the vertices
around it, a small part of the input's edges there, and more than a few units of rounding. A point that size
or area asks for keeps a part of the wanted length. So all vertices keep a minimum distance, and there is room
only for a finite number of them.
"""

from __future__ import annotations

import math

import numpy as np

from ...base.codes import DONE, MORE, ROOM
from ...base.jit import apart, inline, lean
from ...connect.insertion.halfedges import SEGMENTS, VERTICES, end_of, start_of
from ...connect.planar.cavity import blocked_by, commit_here, commit_split, find_cavity_here, find_split
from ...predicates.kernels import incircle, orient2
from .encroachment import (
    FIRST,
    FREE_VERTEX,
    OTHER,
    SECOND,
    STRAIGHT,
    across_small_angle,
    encroaches,
    sharper_than_input,
    split_arc,
    split_straight,
    spoils,
    too_short,
)
from .free_vertices import MOST_CORNERS, clear_disc
from .limits import ANGLE, BY_ANGLE, BY_SIZE, FRACTION, SIZE, largest_radius2
from .narrow import charge, grown_floor
from .state import (
    BEGUN,
    BUDGET,
    BY_FUNCTION,
    CIRCUMCENTERS,
    CURVE,
    CURVES,
    EVENTS,
    FINEST_SPAN,
    FLOOR,
    GUARDED,
    KEPT,
    LARGE_ONES,
    LINKED,
    LOCKED,
    NARROW,
    OPEN,
    PRECISION,
    REJECTED,
    REMOVED,
    ROUNDING_SQUARE,
    SEGMENT_TOP,
    SHELLS,
    SMALL_ANGLE,
    SPLITS,
    VERTEX_LIMIT,
    WANTED,
    ask,
    give_up,
    look_at_all,
    look_at_fan,
    look_at_segment,
    look_at_star,
    next_triangle,
    plane_of,
    record,
    scratch_of,
    settle,
)

FAR_FROM_ALL = 1e30  # a circumcenter beyond this cannot be judged


# --- subsegments -----------------------------------------------------------------------------------


@inline
def _split_point(w, s):
    """(x, y, t) of the next split of subsegment s; nan if it must be computed in Python."""
    a, b, k = w.ends[s, 0], w.ends[s, 1], w.piece[s]
    if w.curve[k] == STRAIGHT:
        return split_straight(w.xy, a, b, w.span[s, 0], w.span[s, 1], w.apexes[s])
    if w.curve[k] == OTHER:
        return w.given[s, 0], w.given[s, 1], w.given[s, 2]
    return split_arc(w.xy, a, b, w.span[s, 0], w.span[s, 1], w.apexes[s], w.arc[k])


@inline
def _lock(w, tally, s, why):
    w.lock[s] = why
    tally[LOCKED] += 1


@inline
def _wanted(w, limits, s, px, py):
    """The smallest limit, as a squared length, on the two sides of subsegment s at (px, py)."""
    smallest = np.inf
    for side in range(2):
        o = w.where[s] if side == 0 else w.twin[w.where[s]]
        r = w.region[o // 3]
        if r >= 0:
            smallest = min(smallest, limits.twice_area[r], largest_radius2(limits, r, px, py))
    return smallest


@inline
def _find(w, s, px, py):
    """The cavity of a split of subsegment s: (m, k, h); k < 0 if p does not see its whole boundary."""
    m, k, h = find_split(plane_of(w), scratch_of(w), np.int64(w.where[s]), px, py)
    if k >= 0 and blocked_by(w.xy, w.vertex, w.rim, k, px, py) >= 0:
        k = -1
    return m, k, h


@apart
def split_next(w, tally, limits):
    """Split the subsegment on top of the stack, or write into ``lock`` why this is impossible."""
    tally[SEGMENT_TOP] -= 1
    s = w.segments[tally[SEGMENT_TOP]]
    px, py, t = _split_point(w, s)
    if math.isnan(px):
        w.wanted[tally[WANTED]] = s
        tally[WANTED] += 1
        return
    by, w.asked[s] = w.asked[s], 0
    w.given[s, 0] = np.nan
    a, b, piece = w.ends[s, 0], w.ends[s, 1], w.piece[s]
    square = min(
        (px - w.xy[a, 0]) ** 2 + (py - w.xy[a, 1]) ** 2, (px - w.xy[b, 0]) ** 2 + (py - w.xy[b, 1]) ** 2
    )
    # where a subsegment is short, size asks for a split only because the triangle beside it is very flat
    wanted = _wanted(w, limits, s, px, py)
    if by & BY_SIZE and tally[BY_FUNCTION] > 0:  # no limit says what is short
        wanted = 0.0
    thin = square < 0.25 * wanted
    if thin and min(w.allowed[piece, 0], w.allowed[piece, 1]) <= 0:
        _lock(w, tally, s, NARROW)
        return
    rounding = ROUNDING_SQUARE * max(px * px, py * py)
    floor = max(min(w.floor[a], w.floor[b], w.need[s]), rounding)
    w.need[s] = np.inf
    smallest = floor
    if by & BY_SIZE:
        smallest = max(FRACTION * wanted, rounding * (tally[BY_FUNCTION] > 0))
        floor = min(floor, max(limits.fraction * square, rounding))
    step = min(t - w.span[s, 0], w.span[s, 1] - t)
    if square < smallest or step < FINEST_SPAN:
        _lock(w, tally, s, FLOOR)
        return
    if limits.lens > 0.0 and w.apexes[s] == 0:
        clear_disc(w, tally, limits, s)
    m, k, h = _find(w, s, px, py)
    if k < 0 and clear_disc(w, tally, limits, s) > 0:
        m, k, h = _find(w, s, px, py)
    if k < 0:
        _lock(w, tally, s, PRECISION if w.curve[piece] == STRAIGHT else CURVE)
        return
    p = w.state[VERTICES]
    w.xy[p, 0], w.xy[p, 1] = px, py
    charge(w, limits, s, thin)
    w.kind[p], w.floor[p] = piece, grown_floor(limits, floor, square)
    record(w, tally, SPLITS, p, (a, b, s), px, py)
    new = commit_split(plane_of(w), scratch_of(w), np.int64(w.where[s]), m, k, h, p, t)
    tally[SPLITS] += 1
    if w.apexes[s] == FIRST or w.apexes[s] == SECOND:
        tally[SHELLS] += 1
    w.apexes[new], w.apexes[s] = w.apexes[s] & SECOND, w.apexes[s] & FIRST
    w.lock[new], w.asked[new], w.need[new] = OPEN, 0, np.inf
    w.given[new, 0] = np.nan
    look_at_star(w, tally, limits, k)
    for i in range(2):
        look_at_segment(w, tally, limits, s if i == 0 else new)


# --- triangles -------------------------------------------------------------------------------------


@inline
def _center(xy, a, b, c, offset):
    """(x, y, R², sure): the circumcenter, or with ``offset`` an off-center, if that is nearer to edge a-b.

    ``sure`` says that it is strictly inside the circle in spite of rounding. (If the longest edge is L and
    the shortest l, its error is at most R (4 eps L / l + 4 eps L² / D), with D = 2 area and l >= D / L.)
    """
    ax, ay = xy[a, 0], xy[a, 1]
    bx, by, cx, cy = xy[b, 0] - ax, xy[b, 1] - ay, xy[c, 0] - ax, xy[c, 1] - ay
    twice = 2.0 * (bx * cy - by * cx)
    if not twice > 0.0:
        return ax, ay, 0.0, False
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    ux, uy = (cy * b2 - by * c2) / twice, (bx * c2 - cx * b2) / twice
    square = ux * ux + uy * uy
    sure = twice > 1e-9 * (b2 + c2) and square > 1e-20
    if offset > 0.0:  # take the point that sees a-b under the wanted angle, if it is nearer
        mx, my = 0.5 * bx - offset * by, 0.5 * by + offset * bx
        if mx * mx + my * my < square:
            return ax + mx, ay + my, mx * mx + my * my, sure
    return ax + ux, ay + uy, square, sure


@inline
def shortest_first(xy, vertex, t):
    """The corners of triangle t, counterclockwise, so that the first two bound its shortest edge."""
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    p = (xy[a, 0] - xy[b, 0]) ** 2 + (xy[a, 1] - xy[b, 1]) ** 2
    q = (xy[b, 0] - xy[c, 0]) ** 2 + (xy[b, 1] - xy[c, 1]) ** 2
    s = (xy[c, 0] - xy[a, 0]) ** 2 + (xy[c, 1] - xy[a, 1]) ** 2
    if p <= q and p <= s:
        return a, b, c
    if q <= s:
        return b, c, a
    return c, a, b


@inline
def _in_the_way(w, tally, limits, t, k, center, by, floor):
    """Ask for splits of the subsegments of the cavity's boundary on which p encroaches.

    Those that are not twice as long as the edge across a small angle, if it is about one, are left alone.

    Returned are the number of subsegments, how many of them are encroached, how many of these are on the
    stack, and why one is not.
    """
    px, py, _, across = center
    marked = found = asked = 0
    why = OPEN
    for i in range(k):
        e = np.int64(w.rim[i])
        s = w.mark[e]
        if s >= 0:
            marked += 1
            a, b = start_of(w.vertex, e), end_of(w.vertex, e)
            # These stay whether they are encroached or not, so that p may come near them, within limits.
            if w.lock[s] == KEPT or w.lock[s] == GUARDED:
                if by == BY_ANGLE and spoils(w.xy, w.vertex, t, a, b, px, py, w.lock[s] == GUARDED):
                    found += 1
                    why = KEPT
                continue
            if encroaches(w.xy[a, 0], w.xy[a, 1], w.xy[b, 0], w.xy[b, 1], px, py, limits.lens):
                found += 1
                if too_short(w.xy, a, b, across):
                    why = SMALL_ANGLE
                elif ask(w, tally, s, by, floor):
                    asked += 1
                else:
                    why = w.lock[s]
    return marked, found, asked, why


@lean
def _hidden_by(plane, rim, k, t, px, py):
    """The subsegment of the cavity's boundary between the centroid of triangle t and p; -1 for none."""
    xy, vertex, mark = plane.xy, plane.vertex, plane.mark
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    gx, gy = (xy[a, 0] + xy[b, 0] + xy[c, 0]) / 3.0, (xy[a, 1] + xy[b, 1] + xy[c, 1]) / 3.0
    for i in range(k):
        e = np.int64(rim[i])
        if mark[e] >= 0:
            a, b = start_of(vertex, e), end_of(vertex, e)
            ax, ay, bx, by = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1]
            if (
                orient2(ax, ay, bx, by, px, py) <= 0
                and orient2(gx, gy, px, py, ax, ay) <= 0
                and orient2(gx, gy, px, py, bx, by) >= 0
            ):
                return mark[e]
    return -1


@inline
def _step_aside(w, tally, limits, t, k, center, by, floor):
    """Whether p can be inserted: it sees the cavity's boundary and encroaches on no subsegment of it.

    If not, ask for splits of the subsegments in the way, or give the triangle up. In a constrained Delaunay
    triangulation a point in the circle of the seed sees each edge of the boundary that is not marked; this
    need not be tested.
    """
    px, py, sure, across = center
    marked, found, asked, why = _in_the_way(w, tally, limits, t, k, center, by, floor)
    if found == 0:
        if (marked == 0 and sure) or blocked_by(w.xy, w.vertex, w.rim, k, px, py) < 0:
            return True
        s = _hidden_by(plane_of(w), w.rim, k, t, px, py)
        why = PRECISION
        if s >= 0:
            if too_short(w.xy, w.ends[s, 0], w.ends[s, 1], across):
                why = SMALL_ANGLE
            elif ask(w, tally, s, by, floor):
                asked = 1
            else:
                why = max(w.lock[s], KEPT)
    if asked > 0:
        tally[REJECTED] += 1
        corners = (w.vertex[3 * t], w.vertex[3 * t + 1], w.vertex[3 * t + 2])
        record(w, tally, REJECTED, -1, corners, px, py)
        settle(w, tally, t, SIZE if by == BY_SIZE else ANGLE)
    else:
        give_up(w, tally, t, why)
    return False


@lean
def _in_circle(xy, a, b, c, px, py):
    return incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], px, py) > 0


@inline
def improve_next(w, tally, limits, offset):
    """Insert the circumcenter of the next triangle, or ask for splits of the subsegments in the way."""
    t, by = next_triangle(w, tally)
    if by == BY_ANGLE:
        a, b, c = shortest_first(w.xy, w.vertex, t)
    else:  # off-centers are used only for the angle
        a, b, c = w.vertex[3 * t], w.vertex[3 * t + 1], w.vertex[3 * t + 2]
        offset = 0.0
    px, py, square, sure = _center(w.xy, a, b, c, offset)
    rounding = ROUNDING_SQUARE * max(px * px, py * py)
    floor = max(min(w.floor[a], w.floor[b], w.floor[c]), rounding)
    across = 0.0
    if by == BY_ANGLE:
        apex = across_small_angle(w.xy, w.kind, w.joints, a, b)
        if apex >= 0:
            if not sharper_than_input(w.xy, apex, a, b, c):
                give_up(w, tally, t, SMALL_ANGLE)
                return
            across = (w.xy[a, 0] - w.xy[b, 0]) ** 2 + (w.xy[a, 1] - w.xy[b, 1]) ** 2
        if square < floor:
            give_up(w, tally, t, FLOOR)
            return
    else:
        if square < rounding:
            give_up(w, tally, t, PRECISION)
            return
        floor = min(floor, max(limits.fraction * square, rounding))
    if not (abs(px) < FAR_FROM_ALL and abs(py) < FAR_FROM_ALL):
        give_up(w, tally, t, PRECISION)
        return
    if not sure and not _in_circle(w.xy, a, b, c, px, py):
        give_up(w, tally, t, PRECISION)
        return
    m, k = find_cavity_here(w, w, t, px, py)
    if k < 0:
        give_up(w, tally, t, PRECISION)
        return
    if not _step_aside(w, tally, limits, t, k, (px, py, sure, across), by, floor):
        return
    p = w.state[VERTICES]
    w.xy[p, 0], w.xy[p, 1] = px, py
    w.kind[p], w.floor[p] = FREE_VERTEX, grown_floor(limits, floor, square)
    record(w, tally, CIRCUMCENTERS, p, (a, b, c), px, py)
    commit_here(w, w, m, k, p)
    tally[CIRCUMCENTERS] += 1
    look_at_fan(w, tally, limits, p, w.region[w.fresh[0]], k)


# --- the loop --------------------------------------------------------------------------------------


@apart
def advance(w, tally, limits, offset, steps):
    """Take up to ``steps`` steps and return why it stopped; the first call first looks at everything."""
    if tally[BEGUN] == 0:
        tally[BEGUN] = 1
        look_at_all(w, tally, limits)
    for _ in range(steps):
        if w.state[VERTICES] + 1 > len(w.xy) or w.state[SEGMENTS] + 1 > len(w.where):
            return ROOM
        if len(w.event) > 0 and tally[EVENTS] + 2 * MOST_CORNERS + 8 > len(w.event):
            return ROOM
        if tally[SEGMENT_TOP] + tally[WANTED] + tally[LARGE_ONES] + tally[LINKED] == 0:
            return DONE
        if w.state[VERTICES] - tally[REMOVED] >= tally[VERTEX_LIMIT]:
            return BUDGET
        if tally[SEGMENT_TOP] > 0:
            split_next(w, tally, limits)
        elif tally[WANTED] > 0:
            return CURVES
        else:
            improve_next(w, tally, limits, offset)
    return MORE
