"""Dividing triangles into connected parts of equal weight with a short cut between them.

The first division grows one half along the principal axis. Then single triangles change sides, best gain
first, and the best state on the way is kept (C. M. Fiduccia, R. M. Mattheyses, 1982). All sums are taken in
the order of the triangles, so that the parts are the same on every processor.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.candidate_heap import put, take
from ...base.jit import kernel

__all__ = ["divided"]

UNEVEN_HALVES = 0.01  # by how much a half may miss its weight, as a part of it
CUT_PASSES = 8  # of changing sides; the last ones rarely find anything
MOVES_IN_VAIN = 400  # a pass ends after so many moves without a better state


def divided(
    centers: NDArray[np.float64],
    graph: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]],
    weight: NDArray[np.float64],
    parts: int,
) -> NDArray[np.int32]:
    """The part, 0 to ``parts`` - 1, of each triangle.

    Parameters
    ----------
    centers : ndarray, shape (t, 2)
    graph : tuple of ndarray, shape (t, 3)
        The vertices of the triangles, their neighbors opposite to them (-1 for none), the lengths of the
        edges between.
    weight : ndarray, shape (t,)
        Positive.
    parts : int
        At most t.
    """
    part = np.zeros(len(weight), dtype=np.int32)
    waiting = [(0, parts)]  # the first number of some parts that are still one, and how many they will be
    while waiting:
        first, many = waiting.pop()
        if many == 1:
            continue
        low = many // 2
        rows = np.flatnonzero(part == first)
        axis = _axis(centers, weight, rows)
        along = centers[:, 0] * axis[0] + centers[:, 1] * axis[1]
        order = rows[np.lexsort((rows, along[rows]))]
        total, heaviest = _total(weight, rows)
        wanted = total * low / many
        side = np.full(len(part), -1, dtype=np.int8)
        side[rows] = 1
        _grow(graph[1], along, weight, order, (wanted, low, many - low), side)
        _gather(graph[1], weight, rows, side)
        slack = max(UNEVEN_HALVES * min(wanted, total - wanted), heaviest / 2)
        _change_sides(graph, weight, rows, side, (wanted, slack), (low, many - low))
        part[rows[side[rows] == 1]] = first + low
        waiting += [(first, low), (first + low, many - low)]
    return part


@kernel
def _total(weight, rows):
    total = heaviest = 0.0
    for t in rows:
        total += weight[t]
        heaviest = max(heaviest, weight[t])
    return total, heaviest


@kernel
def _axis(centers, weight, rows):
    """The direction in which weighted points extend most: a vector of any length."""
    sum_ = x = y = 0.0
    for t in rows:
        sum_ += weight[t]
        x += weight[t] * centers[t, 0]
        y += weight[t] * centers[t, 1]
    x, y = x / sum_, y / sum_
    xx = xy = yy = 0.0
    for t in rows:
        dx, dy = centers[t, 0] - x, centers[t, 1] - y
        xx += weight[t] * dx * dx
        xy += weight[t] * dx * dy
        yy += weight[t] * dy * dy
    half = (xx - yy) / 2
    most = np.sqrt(half * half + xy * xy)
    if half >= 0.0:
        return (half + most, xy) if most > 0.0 else (1.0, 0.0)
    return xy, most - half


@kernel
def _grow(neighbors, along, weight, order, wanted, side):
    """Give side 0 to triangles that hang together, the least along the axis first, up to a weight.

    ``wanted`` has the weight, and the least numbers of triangles on each side.
    """
    aim, least, left = wanted
    keys, values = np.empty(3 * len(order) + 1), np.empty(3 * len(order) + 1, dtype=np.int64)
    sum_, count, taken, next_ = 0.0, 0, 0, 0
    while taken < len(order) - left and (taken < least or sum_ < aim):
        if count == 0:
            while side[order[next_]] == 0:
                next_ += 1
            count = put(keys, values, count, along[order[next_]], order[next_])
        t = values[0]
        count = take(keys, values, count)
        if side[t] != 1:
            continue
        if taken >= least and sum_ + weight[t] / 2 > aim:
            break
        side[t] = 0
        sum_ += weight[t]
        taken += 1
        for k in range(3):
            u = neighbors[t, k]
            if u >= 0 and side[u] == 1:
                count = put(keys, values, count, along[u], u)


@kernel
def _gather(neighbors, weight, rows, side):
    """Give to side 0 what hangs together on side 1 and touches side 0, but for the heaviest such piece."""
    label = np.full(len(side), -1, dtype=np.int64)
    stack = np.empty(len(rows), dtype=np.int64)
    sums, touches = np.zeros(len(rows)), np.zeros(len(rows), dtype=np.bool_)
    many, best = 0, -1
    for first in rows:
        if side[first] != 1 or label[first] >= 0:
            continue
        stack[0], depth, label[first] = first, 1, many
        while depth > 0:
            depth -= 1
            t = stack[depth]
            sums[many] += weight[t]
            for k in range(3):
                u = neighbors[t, k]
                if u < 0:
                    continue
                if side[u] == 0:
                    touches[many] = True
                elif side[u] == 1 and label[u] < 0:
                    label[u] = many
                    stack[depth] = u
                    depth += 1
        if touches[many] and (best < 0 or sums[many] > sums[best]):
            best = many
        many += 1
    for t in rows:
        if side[t] == 1 and touches[label[t]] and label[t] != best:
            side[t] = 0


@kernel
def _gain(graph, side, t):
    """By how much the cut becomes shorter if triangle t changes sides; and whether it is beside the cut."""
    gain, beside = 0.0, False
    for k in range(3):
        u = graph[1][t, k]
        if u >= 0 and side[u] >= 0:
            if side[u] == side[t]:
                gain -= graph[2][t, k]
            else:
                gain += graph[2][t, k]
                beside = True
    return gain, beside


@kernel
def _stays_whole(graph, side, t):
    """Whether the side of triangle t hangs together without it, as seen around t; that is sufficient."""
    vertices, neighbors, _ = graph
    same, apart = 0, -1
    for k in range(3):
        u = neighbors[t, k]
        if u >= 0 and side[u] == side[t]:
            same += 1
        else:
            apart = k
    if same != 2:
        return same < 2
    pivot = vertices[t, apart]
    before, now = t, neighbors[t, (apart + 1) % 3]
    goal = neighbors[t, (apart + 2) % 3]
    while now != goal:
        if now < 0 or side[now] != side[t]:
            return False
        for k in range(3):
            if vertices[now, k] != pivot and neighbors[now, k] != before:
                before, now = now, neighbors[now, k]
                break
    return True


@kernel
def _change_sides(graph, weight, rows, side, aim, least):
    """Let triangles change sides while the state of the best moment becomes better.

    ``aim`` has the weight of side 0 and by how much it may be missed, ``least`` the least numbers of
    triangles on each side. States are compared by what is missed beyond that, then by the cut.
    """
    wanted, slack = aim
    neighbors, many = graph[1], np.zeros(2, dtype=np.int64)
    sum_, cut = 0.0, 0.0
    for t in rows:
        many[side[t]] += 1
        if side[t] == 0:
            sum_ += weight[t]
    keys, values = np.empty(8 * len(rows) + 8), np.empty(8 * len(rows) + 8, dtype=np.int64)
    known = np.empty(len(side))
    locked, moved = np.zeros(len(side), dtype=np.bool_), np.empty(len(rows), dtype=np.int64)
    for _ in range(CUT_PASSES):
        count = moves = kept = 0
        locked[rows] = False
        for t in rows:
            known[t], beside = _gain(graph, side, t)
            if beside:
                count = put(keys, values, count, -known[t], t)
        cut, best_cut, best_off = 0.0, 0.0, max(abs(sum_ - wanted) - slack, 0.0)
        while count > 0 and moves - kept < MOVES_IN_VAIN:
            key, t = keys[0], values[0]
            count = take(keys, values, count)
            if locked[t] or -key != known[t]:
                continue
            after = sum_ - weight[t] if side[t] == 0 else sum_ + weight[t]
            nearer = abs(after - wanted) < abs(sum_ - wanted)
            if many[side[t]] <= least[side[t]] or (abs(after - wanted) > slack and not nearer):
                continue
            if not _stays_whole(graph, side, t):
                continue
            cut -= known[t]
            many[side[t]] -= 1
            side[t] = 1 - side[t]
            many[side[t]] += 1
            sum_, locked[t] = after, True
            moved[moves] = t
            moves += 1
            off = max(abs(sum_ - wanted) - slack, 0.0)
            if off < best_off or (off == best_off and cut < best_cut):
                best_off, best_cut, kept = off, cut, moves
            for k in range(3):
                u = neighbors[t, k]
                if u >= 0 and side[u] >= 0 and not locked[u]:
                    known[u], beside = _gain(graph, side, u)
                    if beside:
                        count = put(keys, values, count, -known[u], u)
        for i in range(moves - 1, kept - 1, -1):
            t = moved[i]
            many[side[t]] -= 1
            sum_ += weight[t] if side[t] == 1 else -weight[t]
            side[t] = 1 - side[t]
            many[side[t]] += 1
        if kept == 0:
            break
