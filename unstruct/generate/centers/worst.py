"""The worst triangle: measures of a triangle for kernels, and a tournament that always knows the largest.

A tournament is a flat binary tree over the slots of the triangles: ``tree[leaves + slot]`` is the value of
a slot, ``tree[i]`` the larger of ``tree[2 i]`` and ``tree[2 i + 1]``, so that ``tree[1]`` is the largest of
all. A slot without a triangle, or whose triangle is not bad, has the value `NONE`. Unlike a heap with lazy
deletion a tournament has no old entries and no stamps, and the order of ties does not depend on the past.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import finite
from ...base.elementary import arcsine
from ...base.errors import InputError
from ...base.jit import inline, lean
from ...connect.insertion.engine import grown
from ...sizing import as_size
from ...sizing.table import ROOT3, Nodes, size_at

NONE = -np.inf
CENTERS_A_CALL = 20_000  # insertions in one kernel call, a fraction of a second: Ctrl-C works between calls
# The measures that define the worst triangle, and their numbers in kernels. A greater value is worse; the
# minimum angle is therefore negated.
PRIORITIES = {"circumradius": 0, "alpha": 1, "radius_edge": 2, "min_angle": 3, "radius_ratio": 4, "area": 5}
KIND, HAS_SIZE, HAS_LIMIT, LIMIT_ENTRY = 0, 1, 2, 3  # entries of ``Rule.test``
LEAST_PRODUCT = 1e-290  # of products of lengths: smaller ones have lost digits, or are 0
FINE2 = 2.0**-40  # of the square of the longest edge: a shorter edge is not taken from the other two
WATCHED = ("R", "l", "L", "mu", "angle")  # what a record follows; l and angle are negated: minima are maxima


class Rule(NamedTuple):
    """Which triangles are bad, and which of them is the worst. `judge` uses it.

    Attributes
    ----------
    test : ndarray, shape (4,)
        The number of the measure, whether there is a size, whether there is a limit, and the limit.
    size, order : Nodes
        Tables of the size, and of the field by which the priority alpha is computed.
    """

    test: NDArray[np.float64]
    size: Nodes
    order: Nodes


class Entries(NamedTuple):
    """The arrays of a `Contest` that kernels work on."""

    rule: Rule
    tree: NDArray[np.float64]
    watch: NDArray[np.float64]
    rows: NDArray[np.float64]
    events: NDArray[np.float64]


@lean
def put(tree, slot, value):
    """Give a slot a value."""
    i = len(tree) // 2 + slot
    tree[i] = value
    i //= 2
    while i > 0:
        best = max(tree[2 * i], tree[2 * i + 1])
        if tree[i] == best:
            break
        tree[i] = best
        i //= 2


@lean
def top(tree):
    """The slot with the largest value, the lowest of several."""
    i, half = 1, len(tree) // 2
    while i < half:
        i = 2 * i if tree[2 * i] == tree[i] else 2 * i + 1
    return i - half


def grown_tree(tree: NDArray[np.float64], slots: int) -> NDArray[np.float64]:
    """The tournament with room for at least so many slots; the same one if it has the room already."""
    half = len(tree) // 2
    if slots <= half:
        return tree
    leaves = 1 << (slots - 1).bit_length()
    larger = np.full(2 * leaves, NONE)
    larger[leaves : leaves + half] = tree[half:]
    level = leaves
    while level > 1:
        larger[level // 2 : level] = larger[level : 2 * level].reshape(-1, 2).max(axis=1)
        level //= 2
    return larger


@inline
def _unit(x, y):
    """The length of a vector, also where its square is below all doubles, and its direction."""
    largest = max(abs(x), abs(y))
    if largest == 0.0:
        return 0.0, 0.0, 0.0
    x, y = x / largest, y / largest
    length = math.sqrt(x * x + y * y)
    return length * largest, x / length, y / length


@lean
def careful_measures(ax, ay, bx, by, cx, cy):
    """`measures` relative to the corner opposite the longest edge, by lengths and directions of edges."""
    for _ in range(2):  # to make ab the longest edge
        ab, _, _ = _unit(bx - ax, by - ay)
        bc, _, _ = _unit(cx - bx, cy - by)
        ca, _, _ = _unit(ax - cx, ay - cy)
        if ab < max(bc, ca):
            ax, ay, bx, by, cx, cy = bx, by, cx, cy, ax, ay
    u, ux, uy = _unit(ax - cx, ay - cy)
    v, vx, vy = _unit(bx - cx, by - cy)
    w, _, _ = _unit(bx - ax, by - ay)
    sine = ux * vy - uy * vx
    short, long = min(u, v, w), max(u, v, w)
    if not sine > 0.0:
        return np.inf, 0.0, short, long, 0.0, np.inf, np.inf
    qx, qy = cx + (vy * u - uy * v) / (2.0 * sine), cy + (ux * v - vx * u) / (2.0 * sine)
    return w / (2.0 * sine), u * (v / (u + v + w)) * sine, short, long, 0.5 * u * v * sine, qx, qy


@inline
def measures(ax, ay, bx, by, cx, cy):
    """R, r, the shortest and the longest edge, the area, and the circumcenter of a counterclockwise triangle.

    They are computed in doubles, relative to a. They decide where points are put, never what is connected. R
    is infinite if rounding leaves no area. Where one edge is so short that the other two cannot tell it, or
    where squares are below all doubles, `careful_measures` looks again.
    """
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    wx, wy = vx - ux, vy - uy
    u2, v2, w2 = ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy
    twice = ux * vy - uy * vx
    u, v, w = math.sqrt(u2), math.sqrt(v2), math.sqrt(w2)
    short, long = min(u, v, w), max(u, v, w)
    product = u * v * w
    least = min(u2, v2, w2)
    if twice <= 0.0 or product < LEAST_PRODUCT or least < LEAST_PRODUCT or least < FINE2 * max(u2, v2, w2):
        return careful_measures(ax, ay, bx, by, cx, cy)
    qx = ax + (vy * u2 - uy * v2) / (2.0 * twice)
    qy = ay + (ux * v2 - vx * u2) / (2.0 * twice)
    return product / (2.0 * twice), twice / (u + v + w), short, long, 0.5 * twice, qx, qy


@lean
def judge(rule, ax, ay, bx, by, cx, cy):
    """How bad a triangle is by the rule; `NONE` if it is not bad.

    A triangle is bad if alpha = sqrt(3) R / size(Q) >= 1 (``HAS_SIZE``), or if its measure exceeds the limit
    (``HAS_LIMIT``). Without a size and a limit every triangle is bad.
    """
    big, small, short, _, area, qx, qy = measures(ax, ay, bx, by, cx, cy)
    kind = int(rule.test[KIND])
    if kind == 0 or big == np.inf:
        value = big
    elif kind == 1:
        value = ROOT3 * big / size_at(rule.order.child, rule.order.values, rule.order.box, qx, qy)
    elif kind == 2:
        value = big / short
    elif kind == 3:
        value = -math.degrees(arcsine(min(1.0, 0.5 * short / big)))
    elif kind == 4:
        value = big / small if small > 0.0 else np.inf
    else:
        value = area
    if rule.test[HAS_LIMIT] > 0.0 and value > rule.test[LIMIT_ENTRY]:
        return value
    if rule.test[HAS_SIZE] > 0.0:
        if big == np.inf or ROOT3 * big >= size_at(rule.size.child, rule.size.values, rule.size.box, qx, qy):
            return value
        return NONE
    return NONE if rule.test[HAS_LIMIT] > 0.0 else value


@lean
def is_large(rule, radius, qx, qy):
    """Whether a triangle with this circumradius and circumcenter is larger than the size of the rule."""
    size = rule.size
    return rule.test[HAS_SIZE] > 0.0 and ROOT3 * radius >= size_at(size.child, size.values, size.box, qx, qy)


@lean
def is_small(rule, square, x, y):
    """Whether no bad triangle can be so small that its center lies in the disk of an edge at (x, y).

    The edge has length L, ``square`` is L^2. A center is at least R from all vertices that it sees, so that
    L > sqrt(2) R if it lies in the disk. Edges that are shorter are halved only because a triangle is so thin
    that its center lies beyond the edge.
    """
    test = rule.test
    if test[HAS_SIZE] > 0.0:
        h = size_at(rule.size.child, rule.size.values, rule.size.box, x, y)
        if square * 1.5 >= h * h:
            return False
    if test[HAS_LIMIT] > 0.0:
        kind, most = int(test[KIND]), test[LIMIT_ENTRY]
        if kind == 0:
            return square < 2.0 * most * most
        if kind == 1:
            h = most * size_at(rule.order.child, rule.order.values, rule.order.box, x, y)
            return square * 1.5 < h * h
        return kind != 5
    return True


@lean
def watch_triangle(watch, slot, ax, ay, bx, by, cx, cy):
    """Enter a triangle into the tournaments of a record."""
    big, small, short, long, _, _, _ = measures(ax, ay, bx, by, cx, cy)
    put(watch[0], slot, big)
    put(watch[1], slot, -short)
    put(watch[2], slot, long)
    put(watch[3], slot, big / small if small > 0.0 else np.inf)
    put(watch[4], slot, -math.degrees(arcsine(min(1.0, 0.5 * short / big))))


@inline
def enter(contest, slot, ax, ay, bx, by, cx, cy):
    """Judge the triangle in a slot, and put it into the tournaments."""
    put(contest.tree, slot, judge(contest.rule, ax, ay, bx, by, cx, cy))
    if len(contest.watch) > 0:
        watch_triangle(contest.watch, slot, ax, ay, bx, by, cx, cy)


@lean
def unwatch(watch, slot):
    """Take a slot out of the tournaments of a record."""
    for k in range(len(watch)):
        put(watch[k], slot, NONE)


@lean
def record(contest, vertex, t, i, radius):
    """Write row i of a record: the state before a step; circumradius, value and vertices of triangle t."""
    watch, events = contest.watch, contest.events
    for k in range(len(watch)):
        contest.rows[i, k] = watch[k][1]
    events[i, 0], events[i, 1] = radius, contest.tree[1]
    for k in range(3):
        events[i, 2 + k] = vertex[3 * t + k]


def watched(rows: NDArray[np.float64], factor: float) -> dict[str, NDArray[np.float64]]:
    """The record by name, in the units of the input; ``rows`` (k, 5) are the tops of the tournaments."""
    scale = {"R": 1 / factor, "l": -1 / factor, "L": 1 / factor, "mu": 1.0, "angle": -1.0}
    return {name: rows[:, k] * scale[name] for k, name in enumerate(WATCHED)}


def make_rule(
    size: Any,
    priority: Any,
    limit: float | None,
    box: tuple[ArrayLike, ArrayLike],
    factor: float = 1.0,
) -> Rule:
    """The rule of a call; coordinates of kernels are those of the caller times ``factor``.

    Raises
    ------
    InputError
        For an unknown name, a limit that no triangle meets or that is not finite, or "alpha" without a size.
    """
    if priority is None:
        priority = "circumradius" if size is None else "alpha"
    name = priority if isinstance(priority, str) else "alpha"
    if name not in PRIORITIES:
        known = ", ".join(PRIORITIES)
        raise InputError(f"no priority {name!r}; use one of {known}, or a size to compare circumradii with")
    field = size if isinstance(priority, str) else priority
    if name == "alpha" and field is None:
        raise InputError("the priority 'alpha' compares circumradii with a size: give a size")
    test = np.zeros(4)
    test[KIND], test[HAS_SIZE], test[HAS_LIMIT] = PRIORITIES[name], size is not None, limit is not None
    if limit is not None:
        most = finite(limit, "limit")
        if not 0.0 < most < (60.0 if name == "min_angle" else np.inf):
            below = " and below 60 degrees" if name == "min_angle" else ""
            raise InputError(f"limit = {limit!r} must be positive{below}: no triangle is better")
        scale = {"circumradius": factor, "area": factor * factor, "min_angle": -1.0}
        test[LIMIT_ENTRY] = most * scale.get(name, 1.0)
    tables = [as_size(1.0 if f is None else f).table(*box, factor=factor).nodes for f in (size, field)]
    return Rule(test, *tables)


def unscaled(priority: int, value: NDArray[np.float64], factor: float) -> NDArray[np.float64]:
    """Values of `judge` in the units of the input, the minimum angle as a positive number."""
    return value * {0: 1 / factor, 3: -1.0, 5: 1 / factor**2}.get(priority, 1.0)


class Contest:
    """What a run keeps to know its worst triangle: rule, tournaments, and a record if it is wanted.

    Attributes
    ----------
    rule : Rule
    tree : ndarray
        The tournament of all bad triangles.
    watch : ndarray, shape (5 or 0, nodes)
        The tournaments of the record.
    rows, events : ndarray, shapes (steps, 5), (steps, columns)
        For each step the tops of the tournaments before it; and the circumradius, the value and the vertices
        of its triangle, with further columns that a run may add.
    """

    def __init__(self, rule: Rule, history: bool, columns: int = 5):
        self.rule, self.tree = rule, np.full(2, NONE)
        self.watch = np.full((len(WATCHED) if history else 0, 2), NONE)
        self.rows, self.events = np.empty((0, len(WATCHED))), np.empty((0, columns))

    def entries(self) -> Entries:
        """The arrays as they are now, in one record for the kernels."""
        return Entries(self.rule, self.tree, self.watch, self.rows, self.events)

    def make_room(self, slots: int, steps: int) -> None:
        """Make room for triangles in so many slots, and for so many steps of the record."""
        self.tree = grown_tree(self.tree, slots)
        if len(self.watch):
            if self.watch.shape[1] < len(self.tree):
                self.watch = np.stack([grown_tree(tree, slots) for tree in self.watch])
            self.rows, self.events = grown(self.rows, steps), grown(self.events, steps)

    def waiting(self, slots: int) -> NDArray[np.bool_]:
        """Which of the first slots contain a bad triangle."""
        half = len(self.tree) // 2
        return self.tree[half : half + slots] > NONE

    def story(self, first: int, last: int, factor: float) -> dict[str, NDArray[np.float64]]:
        """The record of these steps, and of the state after them, in the units of the input."""
        events, rows = self.events[first:last], np.vstack([self.rows[first:last], self.watch[:, 1]])
        value = unscaled(int(self.rule.test[KIND]), events[:, 1], factor)
        return {**watched(rows, factor), "chosen": events[:, 0] / factor, "value": value}
