"""The levels of a table of the size matched to an envelope, in few calls of kernels.

Between two of them the given size is asked, in Python: a kernel writes at which places it matters, and the
next one takes what was found there.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...geometry.segment_search import search
from ...sizing.table import CHILD, CORNERS, FIRST_LEVELS, FRESH, RESOLVED

__all__ = [
    "Asked",
    "Level",
    "Limits",
    "divide",
    "is_behind",
    "judge",
    "lattice",
    "lay_out",
    "measure",
    "probe",
    "room_for_level",
    "room_to_ask",
]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
BROADEST = 2.0  # wanted edge lengths: larger leaves are divided in any case
WITHIN_ROUNDING = 1.0 - 1e-9  # far more than rounding
SPREAD = 73856093, 19349663  # numbers that spread places over a table


class Limits(NamedTuple):
    """What is the same for all levels.

    Attributes
    ----------
    most : float
        The given size is nowhere larger.
    growth, tolerance : float
        Of the matched size, and of its table.
    far : float
        How much both sizes may change along the diagonal of the box.
    """

    most: float
    growth: float
    tolerance: float
    far: float


class Level(NamedTuple):
    """The leaves of one depth.

    Attributes
    ----------
    place : (m, 2) int64
        Integer coordinates of the lower corner, in units of the side of a leaf.
    values : (m, 4) float64
        Sizes at the corners.
    middle, bound : (m,) float64
        The size at the middle, and what the given size is at least there. The first is 0 where it is not
        known because the leaf stays whatever it is.
    edge : (m,) int64
        The edge that the middle has its size from; -1 if all give more than the given size can be.
    """

    place: Integers
    values: Array
    middle: Array
    bound: Array
    edge: Integers


class Asked(NamedTuple):
    """Places where sizes are wanted, k of them at most.

    Attributes
    ----------
    x : (k, 2) float64
    found, bound : (k,) float64
        The sizes of the envelope there, and what the given size is at least.
    edge : (k,) int64
        The edges that give the former.
    same : (k,) int64
        Of sides of leaves: the row of each side's middle.
    places, enough : (k, 2) float64 and (k,) float64
        The first of these are where the given size is wanted, and up to which size it matters.
    rows : (k,) int64
        Which of the rows they are, or which leaves.
    """

    x: Array
    found: Array
    bound: Array
    edge: Integers
    same: Integers
    places: Array
    enough: Array
    rows: Integers


def room_for_level(many: int) -> Level:
    """Room for so many leaves."""
    numbers, whole = np.empty((6, many)), np.empty((3, many), dtype=np.int64)
    return Level(
        whole[:2].reshape(many, 2), numbers[:4].reshape(many, 4), numbers[4], numbers[5], whole[2]
    )  # fmt: skip


def room_to_ask(many: int) -> Asked:
    """Room for so many places."""
    numbers, whole = np.empty((7, many)), np.empty((3, many), dtype=np.int64)
    x, places = numbers[:2].reshape(many, 2), numbers[2:4].reshape(many, 2)
    return Asked(x, numbers[4], numbers[5], whole[0], whole[1], places, numbers[6], whole[2])


@lean
def measure(ends, length, middles):
    """Write the lengths of edges and their middles."""
    for i in range(len(ends)):
        length[i] = math.hypot(ends[i, 1, 0] - ends[i, 0, 0], ends[i, 1, 1] - ends[i, 0, 1])
        for k in range(2):
            middles[i, k] = (ends[i, 0, k] + ends[i, 1, k]) / 2


@inline
def _look_for(asked, many, searched, most):
    """Find the sizes of the envelope at the first places, up to what the given size is at most."""
    for i in range(many):
        asked.found[i] = most
    search(
        asked.x[:many], searched.factor, searched.packed, searched.growth, searched.waiting,
        asked.found[:many], asked.edge[:many],
    )  # fmt: skip


@inline
def _want(asked, many, i, row, far):
    """Ask for the given size at place i, unless it is known not to matter; returns how many are asked.

    It matters where it may be less than the size of the envelope; where it is more by ``far``, which is
    enough for all of a leaf, it is not needed exactly.
    """
    if not asked.bound[i] < asked.found[i]:
        return many
    asked.rows[many], asked.enough[many] = row, asked.found[i] + far
    asked.places[many, 0], asked.places[many, 1] = asked.x[i, 0], asked.x[i, 1]
    return many + 1


@lean
def lattice(box, searched, limits, asked):
    """Write a lattice of places in a box, and find the sizes of the envelope there; how many are asked."""
    many = (1 << FIRST_LEVELS) + 1
    for i in range(many):
        for k in range(many):
            row, u, v = i * many + k, i / (many - 1), k / (many - 1)
            asked.x[row, 0] = min(box[0, 0] + u * (box[1, 0] - box[0, 0]), box[1, 0])
            asked.x[row, 1] = min(box[0, 1] + v * (box[1, 1] - box[0, 1]), box[1, 1])
            asked.bound[row] = 0.0
    _look_for(asked, many * many, searched, limits.most)
    wanted = 0
    for i in range(many * many):
        wanted = _want(asked, wanted, i, i, 0.0)
    return wanted


@lean
def lay_out(corners, given, box, searched, limits, above, level, middles):
    """Fill the first levels from a lattice of corners; how many middles are asked, as by `divide`.

    ``corners`` are the places of `lattice`, ``given`` the sizes that were asked there. Of all levels but the
    last one only the sizes are written, to ``above``.
    """
    for i in range(len(given)):
        corners.bound[corners.rows[i]] = given[i]
    side, start = 1 << FIRST_LEVELS, 0
    for depth in range(FIRST_LEVELS + 1):
        shift = FIRST_LEVELS - depth
        values = level.values if shift == 0 else above[start : start + (1 << 2 * depth)]
        for i in range(1 << 2 * depth):
            u, v = 0, 0
            for bit in range(depth):
                u, v = u | (i >> 2 * bit & 1) << bit, v | (i >> 2 * bit + 1 & 1) << bit
            for k in range(4):
                row = (u + (k & 1) << shift) * (side + 1) + (v + (k >> 1) << shift)
                values[i, k] = min(corners.found[row], corners.bound[row])
            if shift == 0:
                level.place[i, 0], level.place[i, 1], level.bound[i] = u, v, 0.0
        start += 1 << 2 * depth
    return _ask_middles(level, box, 1.0 / side, searched, limits, middles)


@inline
def is_behind(ends, edge, x, y, far):
    """Whether a point is on the right of an edge, opposite it, and so far away; no edge is -1."""
    if edge < 0:
        return False
    ux, uy = ends[edge, 1, 0] - ends[edge, 0, 0], ends[edge, 1, 1] - ends[edge, 0, 1]
    vx, vy = x - ends[edge, 0, 0], y - ends[edge, 0, 1]
    along, square = ux * vx + uy * vy, ux * ux + uy * uy
    return 0.0 <= along <= square and ux * vy - uy * vx < -far * math.sqrt(square)


@inline
def _error(level, i):
    """The relative error of a leaf at its middle."""
    values = level.values
    total = 0.0 + values[i, 0] + values[i, 1] + values[i, 2] + values[i, 3]
    return abs(total / 4 / level.middle[i] - 1.0)


@inline
def _must_divide(level, i, box, side, ends, tolerance):
    """Whether a leaf is to be divided."""
    if level.middle[i] == 0.0:
        return False
    wide, tall = box[1, 0] - box[0, 0], box[1, 1] - box[0, 1]
    length, far, middle = side * max(wide, tall), side / 2 * math.hypot(wide, tall), level.middle[i]
    if not (length > BROADEST * middle or _error(level, i) > tolerance):
        return False
    least = middle
    for k in range(4):
        least = min(least, level.values[i, k])
    if not length > RESOLVED * least:
        return False
    x = box[0, 0] + (level.place[i, 0] + 0.5) * side * wide
    y = box[0, 1] + (level.place[i, 1] + 0.5) * side * tall
    return not is_behind(ends, level.edge[i], x, y, far)


@lean
def judge(level, given, frame, found):
    """Write which leaves are to be divided, and the first children of all; returns how many are divided.

    ``given`` are leaves and the given sizes that were asked at their middles. ``frame`` is the box, the side
    of the leaves, the edges, the tolerance, and two numbers: of the next node, and how many leaves may be
    divided: if there are more, none is. ``found`` gets the first children, the rows of leaves to be divided
    and, in one entry, the largest error of those that stay. Where the edge of some of these rows is not
    known, nothing else is written, and their number is returned as a negative one.
    """
    box, side, ends, tolerance, (count, most) = frame
    child, rows, worst = found
    for i in range(len(given[0])):
        row, size = given[0][i], given[1][i]
        level.bound[row], level.middle[row] = size, min(level.middle[row], size)
    many, known = 0, True
    for i in range(len(child)):
        if _must_divide(level, i, box, side, ends, tolerance):
            rows[many], known = i, known and level.edge[i] >= 0
            many += 1
    if not known:
        return -many
    if many > most:
        many = 0
    next_row = 0
    for i in range(len(child)):
        if next_row < many and rows[next_row] == i:
            child[i] = count + 4 * next_row
            next_row += 1
        else:
            child[i] = -1
            if level.middle[i] > 0.0:
                worst[0] = max(worst[0], _error(level, i))
    return many


@inline
def _in_doubt(level, i, length, reach, tolerance):
    """Whether some middle would divide a leaf."""
    values = level.values
    mean = (0.0 + values[i, 0] + values[i, 1] + values[i, 2] + values[i, 3]) / 4
    low = min(values[i, 0], values[i, 1], values[i, 2], values[i, 3])
    least, most = max(values[i, 0], values[i, 1], values[i, 2], values[i, 3]) - reach, low + reach
    even = (
        length <= WITHIN_ROUNDING * BROADEST * least and mean <= WITHIN_ROUNDING * (1.0 + tolerance) * least
    )
    small = length <= WITHIN_ROUNDING * RESOLVED * min(low, least)
    return not (small or (even and WITHIN_ROUNDING * mean >= (1.0 - tolerance) * most))


@inline
def _ask_middles(level, box, side, searched, limits, middles):
    """Find the sizes of the envelope at the middles of leaves, but for those that stay whatever they are.

    These get the size 0 there. Writes where the given size is wanted, too; returns how many these are.
    """
    wide, tall = box[1, 0] - box[0, 0], box[1, 1] - box[0, 1]
    length, reach = side * max(wide, tall), limits.growth * side / 2 * math.hypot(wide, tall)
    many, wanted = 0, 0
    for i in range(len(level.place)):
        if not _in_doubt(level, i, length, reach, limits.tolerance):
            level.middle[i] = 0.0
            continue
        for j in range(2):
            place = (level.place[i, j] + 0.5) * side
            middles.x[many, j] = min(box[0, j] + place * (box[1, j] - box[0, j]), box[1, j])
        middles.same[many], middles.bound[many] = i, level.bound[i]
        many += 1
    _look_for(middles, many, searched, limits.most)
    for n in range(many):
        i = middles.same[n]
        level.middle[i], level.edge[i] = middles.found[n], middles.edge[n]
        wanted = _want(middles, wanted, n, i, limits.far * side / 2)
    return wanted


@lean
def probe(level, leaves, ways, searched, limits, sides):
    """Find the sizes of the envelope at the middles of the sides of leaves that are divided.

    ``leaves`` are their rows, and room to look middles up: a side that two of them have is written once.
    ``ways`` is the box, the side of the leaves, and how much the given size may change from their middles to
    the places `FRESH`, in units of the side. Returns how many middles there are, and how many are asked.
    """
    rows, seen = leaves
    box, side, away = ways
    x, bound, many, last = sides.x, sides.bound, 0, len(seen) - 1
    for i in range(len(seen)):
        seen[i] = -1
    for r in range(len(rows)):
        i = rows[r]
        for k in range(4):
            u, v = level.place[i, 0] + FRESH[k, 0], level.place[i, 1] + FRESH[k, 1]
            u_at = min(box[0, 0] + u * side * (box[1, 0] - box[0, 0]), box[1, 0])
            v_at = min(box[0, 1] + v * side * (box[1, 1] - box[0, 1]), box[1, 1])
            at = (int(2.0 * u) * SPREAD[0] ^ int(2.0 * v) * SPREAD[1]) & last
            while seen[at] >= 0 and (x[seen[at], 0] != u_at or x[seen[at], 1] != v_at):
                at = (at + 1) & last
            least = level.bound[i] - side * away[k]
            if seen[at] < 0:
                seen[at] = many
                x[many, 0], x[many, 1], bound[many] = u_at, v_at, least
                many += 1
            sides.same[4 * r + k] = seen[at]
            bound[seen[at]] = max(bound[seen[at]], least)
    _look_for(sides, many, searched, limits.most)
    wanted = 0
    for i in range(many):
        wanted = _want(sides, wanted, i, i, 0.0)
    return wanted


@lean
def divide(level, rows, ways, searched, limits, probed, made, middles):
    """Fill the leaves that some leaves are divided into; how many of their middles are asked.

    ``ways`` is as for `probe`; ``probed`` is what that has written, and the given sizes that it asked for.
    ``middles`` has room for the middles of the new leaves, and gets where the given size is asked, too.
    """
    box, side, away = ways
    sides, given = probed
    for i in range(len(given)):
        sides.bound[sides.rows[i]] = given[i]
    for r in range(len(rows)):
        i = rows[r]
        for c in range(4):
            child = 4 * r + c
            made.bound[child], made.edge[child] = level.bound[i] - side * away[4 + c], -1
            for k in range(4):
                corner = CHILD[c, k]
                if corner < 4:
                    made.values[child, k] = level.values[i, corner]
                elif corner == 4:
                    made.values[child, k] = level.middle[i]
                else:
                    j = sides.same[4 * r + corner - 5]
                    made.values[child, k] = min(sides.found[j], sides.bound[j])
            for j in range(2):
                made.place[child, j] = 2 * level.place[i, j] + CORNERS[c, j]
    return _ask_middles(made, box, side / 2, searched, limits, middles)
