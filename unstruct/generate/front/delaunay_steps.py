"""The advancing front of 12.3.4, compiled: cell by cell by the empty circle, and new points ahead of the
front.

`wrap` makes the constrained Delaunay triangulation of the vertices at the front. `place_ahead` makes
points: where the circumradius of the cell ahead is larger than wanted, it puts the ideal point X into its
circle, which makes ABX the cell. X is not made where a vertex is nearer than `POINTS_APART` times the
wanted length, or an edge of the front nearer than `OFF_EDGES`. Then the edge is put aside, since the front
may reach it from elsewhere. If it comes back, the circumcenter is tried, and in the end the cell is taken
as it is. Source: the source chapter, 12.3.4. Book: 3.4.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np

from ...base.codes import DONE, MORE, ROOM
from ...base.jit import inline, lean
from ...predicates.kernels import incircle
from ...sizing.table import ROOT3
from ..advancing.digital_tree import gather
from ..advancing.rows import CELLS_MADE, VERTEX_COUNT, in_turn, next_in_turn
from .classical_steps import (
    LATER,
    NONE_FITS,
    OCTAVE,
    between,
    ideal_point,
    is_near,
    length_wanted,
    level_of,
)
from .empty_circle import apex_ahead, apex_within, cap_of
from .open_front import (
    advance_over,
    blocking_edge,
    enter_vertex,
    has_room,
    turn,
)

__all__ = [
    "AT_CENTERS",
    "FORCED_CELLS",
    "HIDDEN_TIMES",
    "PLACED",
    "SET_ASIDE",
    "TIES",
    "WRAP_COUNTS",
    "place_ahead",
    "start_in_turn",
    "start_widest",
    "wrap",
]

PLACED, AT_CENTERS, FORCED_CELLS, SET_ASIDE, TIES, HIDDEN_TIMES, WRAP_COUNTS = range(7)
NODES_A_CALL = 10_000_000  # visited nodes, a fraction of a second: Ctrl-C works between calls
SMALL_ENOUGH = 1.2  # times the wanted circumradius
POINTS_APART, OFF_EDGES = 0.8, 0.35  # times the sides
ASIDE_AFTER = 2.0**46  # edges that were put aside come after all others
WIDE_CELL = 4.0
WIDEST_LEVEL = 3 * OCTAVE  # that of `WIDE_CELL`


@lean
def start_in_turn(front, waiting):
    """Put all edges into the queue, the oldest first."""
    for row in range(len(front.ends)):
        if front.ends[row, 0] >= 0:
            in_turn(waiting, front.stamp, np.int64(row), float(front.stamp[row]))


@inline
def is_full(front, waiting):
    """Whether one more step needs larger arrays."""
    return not has_room(front) or waiting.many[0] + 4 >= len(waiting.keys)


@lean
def wrap(front, ahead, waiting, ties, counts, limit):
    """Make up to ``limit`` cells by the empty circle; return DONE, MORE, ROOM, or NONE_FITS.

    The caller sets the number of visited nodes to zero. ``ties`` gets 1 for cells whose circle has another
    visible vertex on it.
    """
    for _ in range(limit):
        if is_full(front, waiting) or front.state[CELLS_MADE] >= len(ties):
            return ROOM
        if ahead.found[3] > NODES_A_CALL:
            break
        row, _ = next_in_turn(waiting, front.stamp)
        if row < 0:
            return DONE
        c = apex_ahead(front, ahead, row)
        if c < 0:
            in_turn(waiting, front.stamp, row, -1.0)
            return NONE_FITS
        ties[front.state[CELLS_MADE]] = ahead.found[1]
        counts[TIES] += ahead.found[1]
        counts[HIDDEN_TIMES] += ahead.found[2]
        one, two = advance_over(front, row, c)
        if one >= 0:
            in_turn(waiting, front.stamp, one, float(front.stamp[one]))
        if two >= 0:
            in_turn(waiting, front.stamp, two, float(front.stamp[two]))
    return MORE


# --- new points -----------------------------------------------------------------------------------


@lean
def has_place(front, row, c, x, side):
    """Whether the unused vertex x ahead of an edge has room: 1, 0, or -1 if the apex c is too near to it."""
    xy, found = front.xy, front.vertices.found
    a, b = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1])
    px, py, least = xy[x, 0], xy[x, 1], POINTS_APART * side
    if not (abs(px) <= 1.0 and abs(py) <= 1.0):
        return 0
    nearest, near = np.int64(-1), least
    for i in range(gather(front.vertices, (px - least, py - least, px + least, py + least))):
        v = np.int64(found[i])
        if v != a and v != b and between(xy, v, x) < near:
            nearest, near = v, between(xy, v, x)
    if nearest >= 0:
        return -1 if nearest == c else 0
    found, least = front.edges.found, OFF_EDGES * side
    for i in range(gather(front.edges, (px - least, py - least, px + least, py + least))):
        other = np.int64(found[i])
        if other != row and is_near(
            xy, x, np.int64(front.ends[other, 0]), np.int64(front.ends[other, 1]), least
        ):
            return 0
    return 1 if blocking_edge(front, a, b, x) < 0 else 0


@inline
def in_circle(xy, a, b, c, x):
    """Whether vertex x is inside the circle of abc."""
    return incircle(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], xy[x, 0], xy[x, 1]) > 0


@inline
def width_of(front, choices, a, b, c):
    """The circumradius of abc over the wanted one at the centroid."""
    xy = front.xy
    x, y = (xy[a, 0] + xy[b, 0] + xy[c, 0]) / 3.0, (xy[a, 1] + xy[b, 1] + xy[c, 1]) / 3.0
    twice = (xy[b, 0] - xy[a, 0]) * (xy[c, 1] - xy[a, 1]) - (xy[b, 1] - xy[a, 1]) * (xy[c, 0] - xy[a, 0])
    below = 2.0 * twice * length_wanted(choices, x, y)
    if not below > 0.0:
        return inf
    return between(xy, a, b) * between(xy, b, c) * between(xy, c, a) * ROOT3 / below


@inline
def pulled_back(xy, a, b, x, y, cx, cy):
    """The ideal point, no farther from the middle of ab than the center of the circle, or |ab| / 4."""
    mx, my = 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1])
    ux, uy, vx, vy = x - mx, y - my, cx - mx, cy - my
    q = sqrt(vx * vx + vy * vy) if ux * vx + uy * vy > 0.0 else 0.0
    part = min(1.0, max(q, 0.25 * between(xy, a, b)) / sqrt(ux * ux + uy * uy))
    return mx + part * ux, my + part * uy


@inline
def center_at(front, choices, row, width):
    """How far the center of a circle through the ends of an edge is on its left, in units of its length.

    The circle has the radius ``width`` times the wanted one, or, if that is too small, half the length.
    """
    xy, a, b = front.xy, np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1])
    length = between(xy, a, b)
    h = length_wanted(choices, 0.5 * (xy[a, 0] + xy[b, 0]), 0.5 * (xy[a, 1] + xy[b, 1]))
    r = width * h / (ROOT3 * length) if length > 0.0 else 0.0
    return sqrt(max(r * r - 0.25, 0.0))


@lean
def try_ideal(front, counts, row, c, x, y, side):
    """Make the ideal point (x, y) if it has room and is in the circle of the apex c (-1: far away).

    Returns the vertex to be taken, c itself if the point is not in its circle or too near to it, or -1.
    """
    xy, n = front.xy, front.state[VERTEX_COUNT]
    a, b = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1])
    if c >= 0:
        cx, cy, r2 = cap_of(xy, a, b, c)
        if r2 < inf:
            x, y = pulled_back(xy, a, b, x, y, cx, cy)
    xy[n, 0], xy[n, 1] = x, y
    if c >= 0 and (turn(xy, a, b, n) <= 0 or not in_circle(xy, a, b, c, n)):
        return c
    place = has_place(front, row, c, n, side)
    if place == 1:
        counts[PLACED] += 1
        front.state[VERTEX_COUNT] += 1
        enter_vertex(front, n)
        return n
    return c if place < 0 else np.int64(-1)


@lean
def choose_ahead(front, choices, ahead, counts, row, aside):
    """The vertex to be taken; -1: put the edge aside, -2: a circumcenter was made, -3: no apex."""
    xy, n = front.xy, front.state[VERTEX_COUNT]
    a, b = np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1])
    x, y, side, _ = ideal_point(front, choices, a, b)
    dx, dy = x - 0.5 * (xy[a, 0] + xy[b, 0]), y - 0.5 * (xy[a, 1] + xy[b, 1])
    d, length = sqrt(dx * dx + dy * dy), between(xy, a, b)
    room = side > 0.0 and d * length > 0.0 and n < choices.most  # d may be lost to rounding
    if room:  # usually no larger circles need be searched
        k = (d * d - 0.25 * length * length) / (2.0 * d * length)
        c = apex_within(front, ahead, row, max(center_at(front, choices, row, 1.1 * SMALL_ENOUGH), k + 0.1))
        if c < 0:
            v = try_ideal(front, counts, row, c, x, y, side)
            if v >= 0:
                return v
    c = apex_ahead(front, ahead, row)
    if c < 0:
        return np.int64(-3)
    if not room or width_of(front, choices, a, b, c) < SMALL_ENOUGH:
        return c
    v = try_ideal(front, counts, row, c, x, y, side)
    if v >= 0 or not aside:
        return v
    xy[n, 0], xy[n, 1], r2 = cap_of(xy, a, b, c)
    if r2 < inf and turn(xy, a, b, n) > 0 and has_place(front, row, np.int64(-1), n, side) == 1:
        counts[AT_CENTERS] += 1
        front.state[VERTEX_COUNT] += 1
        enter_vertex(front, n)
        return np.int64(-2)
    counts[FORCED_CELLS] += 1
    return c


@lean
def push_ahead(front, choices, ahead, waiting, row):
    """Put an edge into the queue by the width of the cell ahead of it, the widest first.

    All widths above `WIDE_CELL` are equal, so that no wide circles are searched.
    """
    c, key = apex_within(front, ahead, row, center_at(front, choices, row, WIDE_CELL)), 0.0
    if c >= 0:
        width = width_of(front, choices, np.int64(front.ends[row, 0]), np.int64(front.ends[row, 1]), c)
        key = float(max(WIDEST_LEVEL - level_of(max(width, 1e-3)), 0))
    in_turn(waiting, front.stamp, row, key * LATER + float(front.stamp[row]))


@lean
def start_widest(front, choices, ahead, waiting):
    """Put all edges into the queue by the cells ahead of them."""
    for row in range(len(front.ends)):
        if front.ends[row, 0] >= 0:
            push_ahead(front, choices, ahead, waiting, np.int64(row))


@lean
def place_ahead(front, choices, ahead, waiting, counts, limit):
    """Make up to ``limit`` cells, and points ahead of the front; return as `wrap` does."""
    for _ in range(limit):
        if is_full(front, waiting):
            return ROOM
        if waiting.many[0] == 0:
            return DONE
        row, key = next_in_turn(waiting, front.stamp)
        if row < 0:
            return DONE
        aside = key >= ASIDE_AFTER
        c = choose_ahead(front, choices, ahead, counts, row, aside)
        if c == -3:
            in_turn(waiting, front.stamp, row, -1.0)
            return NONE_FITS
        if c == -1:
            counts[SET_ASIDE] += 1
            in_turn(waiting, front.stamp, row, ASIDE_AFTER + float(front.stamp[row]))
        elif c == -2:
            push_ahead(front, choices, ahead, waiting, row)
        else:
            one, two = advance_over(front, row, c)
            if one >= 0:
                push_ahead(front, choices, ahead, waiting, one)
            if two >= 0:
                push_ahead(front, choices, ahead, waiting, two)
    return MORE
