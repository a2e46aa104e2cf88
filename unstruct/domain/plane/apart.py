"""A floating-point proof that chords are safe, in one kernel call; what it leaves open, `sample` decides.

A stretch of a curve is looked at as a chain of samples, with its chord. All of it is nearer to the chord than
its *depth*, and is seen from either end under at most some angle from the chord. So two stretches are apart
if their chords are farther from each other than the sum of their depths; if they share a vertex, if the angle
between their chords is larger than the sum of those angles.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...geometry.boxes import BOXES_IN_LEAF, BoxTree
from ...geometry.outline import Outline
from ...geometry.segment_filter import may_meet

__all__ = ["surely_apart"]

FAR_ROUNDING = 2.0**-43  # of the largest coordinate: far above what tests of points on chords call rounding
APART_MARGIN = 1e-9  # of angles
STEEPEST_VIEW = 0.9  # the tangent of an angle beside a chord: two such angles are less than a right angle
LEAST_APART, MOST_APART = 1e-70, 1e70  # of coordinates: products of four are doubles


class Chords(NamedTuple):
    """Subsegments, then points that lie alone, as segments of length zero.

    Attributes
    ----------
    ends : (m, 2) int32
        Vertices; different negative numbers for points alone.
    sides : (m, 4) float64
        The coordinates of both ends.
    bent : (m,) bool
        Which are chords of curves.
    whole : (m,) bool
        Which are points, or straight pieces as a whole: these are known to be apart.
    depth : (m,) float64
    spread : (m, 2) float64
        The tangents of the angles under which the stretch is seen from either end.
    low, high : (m, 2) float64
        Boxes of the stretches.
    """

    ends: NDArray[np.int32]
    sides: NDArray[np.float64]
    bent: NDArray[np.bool_]
    whole: NDArray[np.bool_]
    depth: NDArray[np.float64]
    spread: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


@inline
def _from_side(sides, i, x, y):
    """The distance from a point to chord i."""
    ax, ay = sides[i, 0], sides[i, 1]
    ux, uy = sides[i, 2] - ax, sides[i, 3] - ay
    square = ux * ux + uy * uy
    t = min(max((ux * (x - ax) + uy * (y - ay)) / square, 0.0), 1.0) if square > 0.0 else 0.0
    return math.hypot(x - (ax + t * ux), y - (ay + t * uy))


@inline
def _tangent(x, y, ux, uy):
    """The tangent of the angle between two vectors; infinite from a right angle on, 0 for a zero vector."""
    dot, cross = x * ux + y * uy, abs(x * uy - y * ux)
    if dot > 0.0:
        return cross / dot
    return 0.0 if x == 0.0 and y == 0.0 else np.inf


@kernel
def _measure(points, given, ends, rows, chains, alone, chords):
    """Fill `Chords` from subsegments, chains of the curved ones, and points that lie alone.

    The first ``given`` points are vertices, the others cut pieces.
    """
    sides, many = chords.sides, ends.shape[0]
    for i in range(sides.shape[0]):
        chords.bent[i], chords.depth[i], chords.spread[i, 0], chords.spread[i, 1] = False, 0.0, 0.0, 0.0
        chords.whole[i] = i >= many or max(ends[i, 0], ends[i, 1]) < given
        for k in range(2):
            chords.ends[i, k] = ends[i, k] if i < many else many - i - 1
            for j in range(2):
                sides[i, 2 * k + j] = points[ends[i, k], j] if i < many else alone[i - many, j]
    for r in range(rows.shape[0]):
        i = rows[r]
        ax, ay, bx, by = sides[i, 0], sides[i, 1], sides[i, 2], sides[i, 3]
        chords.bent[i], chords.whole[i] = True, False
        for k in range(1, chains.shape[1] - 1):
            x, y = chains[r, k, 0], chains[r, k, 1]
            chords.depth[i] = max(chords.depth[i], _from_side(sides, i, x, y))
            chords.spread[i, 0] = max(chords.spread[i, 0], _tangent(x - ax, y - ay, bx - ax, by - ay))
            chords.spread[i, 1] = max(chords.spread[i, 1], _tangent(x - bx, y - by, ax - bx, ay - by))
    for i in range(sides.shape[0]):
        for j in range(2):
            chords.low[i, j] = min(sides[i, j], sides[i, 2 + j]) - chords.depth[i]
            chords.high[i, j] = max(sides[i, j], sides[i, 2 + j]) + chords.depth[i]


@inline
def _fan_out(chords, i, j, a, b, slack):
    """Whether the stretches i and j, whose ends a and b are one vertex, surely share nothing else."""
    sides = chords.sides
    ux, uy = sides[i, 2 - 2 * a] - sides[i, 2 * a], sides[i, 3 - 2 * a] - sides[i, 2 * a + 1]
    vx, vy = sides[j, 2 - 2 * b] - sides[j, 2 * b], sides[j, 3 - 2 * b] - sides[j, 2 * b + 1]
    one, two = chords.spread[i, a], chords.spread[j, b]
    length, other = math.hypot(ux, uy), math.hypot(vx, vy)
    if max(one, two) > STEEPEST_VIEW or min(length, other) < 64.0 * slack:
        return False
    dot, cross = ux * vx + uy * vy, abs(ux * vy - uy * vx)
    if dot <= 0.0:
        return True
    # Between the angles there must be room for the far end of one beside the other.
    room = APART_MARGIN + 2.0 * slack / min(length, other)
    return cross * (1.0 - one * two) > (one + two) * dot + 2.0 * room * length * other


@inline
def _two_apart(chords, i, j, slack):
    """Whether two chords with their stretches surely are in no conflict."""
    ends, sides, bent = chords.ends, chords.sides, chords.bent
    if not (bent[i] or bent[j]):
        return ends[i, 0] < 0 or ends[j, 0] < 0 or not may_meet(sides, ends, i, j)
    common, a, b = 0, 0, 0
    for k in range(2):
        for m in range(2):
            if ends[i, k] == ends[j, m]:
                common, a, b = common + 1, k, m
    if common > 0:
        return common == 1 and _fan_out(chords, i, j, a, b, slack)
    if may_meet(sides, ends, i, j):
        return False
    least = chords.depth[i] + chords.depth[j] + slack
    for k in range(2):
        if _from_side(sides, i, sides[j, 2 * k], sides[j, 2 * k + 1]) <= least:
            return False
        if _from_side(sides, j, sides[i, 2 * k], sides[i, 2 * k + 1]) <= least:
            return False
    return True


@kernel
def _all_apart(chords, tree_low, tree_high, order, slack):
    """Whether no two chords may be in conflict, apart from two whole ones.

    The tree is that of the others, in this order; its boxes are wider than theirs by the slack.
    """
    low, high, whole = chords.low, chords.high, chords.whole
    leaves = tree_low.shape[0] // 2
    stack = np.empty(128, dtype=np.int64)
    for i in range(low.shape[0]):
        stack[0], top = 1, 1
        while top > 0:
            top -= 1
            node = stack[top]
            if low[i, 0] > tree_high[node, 0] or high[i, 0] < tree_low[node, 0]:
                continue
            if low[i, 1] > tree_high[node, 1] or high[i, 1] < tree_low[node, 1]:
                continue
            if node < leaves:
                stack[top], stack[top + 1] = 2 * node, 2 * node + 1
                top += 2
                continue
            first = (node - leaves) * BOXES_IN_LEAF
            for k in range(first, min(first + BOXES_IN_LEAF, order.shape[0])):
                j = order[k]
                if j <= i and not whole[i]:
                    continue
                if low[i, 0] > high[j, 0] + slack or high[i, 0] < low[j, 0] - slack:
                    continue
                if low[i, 1] > high[j, 1] + slack or high[i, 1] < low[j, 1] - slack:
                    continue
                if not _two_apart(chords, i, j, slack):
                    return False
    return True


def surely_apart(
    outline: Outline, points: np.ndarray, ends: np.ndarray, rows: np.ndarray, chains: np.ndarray
) -> bool:
    """Whether it is certain that no two subsegments are in conflict, as `sample.conflicts` defines it.

    Parameters
    ----------
    outline : Outline
        Its straight pieces have been validated: none crosses another one or holds a vertex or a seed.
    points, ends : ndarray
        Of the subsegments, as in `Sampled`.
    rows : (r,) int64
        The curved subsegments.
    chains : (r, k, 2) float64
        Samples along each of their stretches, both ends included.
    """
    scale = float(np.abs(points).max())
    if not LEAST_APART < scale < MOST_APART:
        return False
    alone = np.concatenate([points[outline.loose], *outline.regions.values()])
    m, slack = len(ends) + len(alone), FAR_ROUNDING * scale
    chords = Chords(
        np.empty((m, 2), dtype=np.int32), np.empty((m, 4)), np.empty(m, dtype=bool), np.empty(m, dtype=bool),
        np.empty(m), np.empty((m, 2)), *np.empty((2, m, 2)),
    )  # fmt: skip
    _measure(points, len(outline.points), ends, rows, chains, alone, chords)
    parts = np.flatnonzero(~chords.whole)
    if not len(parts):
        return True
    tree = BoxTree(chords.low[parts] - slack, chords.high[parts] + slack)
    return bool(_all_apart(chords, tree.low, tree.high, parts[tree.order], slack))
