"""Kernels that make tetrahedra rounder: refills around bad cells, and better places for inner vertices.

A refill (`connect.spatial.refill`) is made only if its worst cell is better than the worst of the cavity; a
vertex moves only if the worst cell at it becomes better, and all of them stay positive by exact signs. So
the worst cells never become worse, and the loops end. See the book, 2.8c.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, kernel
from ...connect.insertion.engine import COUNT, FREE
from ...connect.spatial.cavity import beside, commit, corner, grow, load
from ...connect.spatial.costs import NEVER, SHAPE, badness
from ...connect.spatial.crossing import star
from ...connect.spatial.records import COST_KIND, LOCALS
from ...connect.spatial.recovery import SPARE_SLOTS
from ...connect.spatial.refill import refill
from ...connect.spatial.signs import side
from ...geometry.stretched import METRIC_COLUMNS, metric_gradient

__all__ = ["REFILLED", "SMOOTHED", "cell_badness", "refill_bad", "smooth_bad"]

REFILLED, SMOOTHED = 0, 1  # entries of the counts
LEAST_GAIN = 1e-3  # by how much a change must be better to be made
HALVINGS_OF_STEP = 5
CLIMBS = 3  # steps along gradients at one visit


@kernel
def cell_badness(solid, count, bad):
    """The badness of each slot below ``count``; -1 where there is no cell."""
    for t in range(count):
        v = solid.vertex[4 * t : 4 * t + 4]
        bad[t] = badness(solid.xyz, v[0], v[1], v[2], v[3]) if v[0] >= 0 else -1.0


@apart
def _refilled(solid, held, r, count, wanted, noise, budget):
    """Refill a cavity grown from ``count`` cells if that makes its worst cell better."""
    if not grow(solid, r, count, wanted, noise):
        return False
    r.size[COST_KIND] = SHAPE
    faces, cost = load(solid, held, r)
    if cost >= NEVER:
        return False
    if refill(solid.xyz, r, solid.state, faces, cost - LEAST_GAIN, 0.0, budget) >= NEVER:
        return False
    commit(solid, r)
    return True


@kernel
def refill_bad(solid, held, r, cells, touched, limits, counts):
    """Refill around these cells, one after the other; returns the first for which slots are lacking.

    Cells that are better than ``limits[0]`` by now are passed over, and so are those at whose vertices
    nothing has changed since the last round. Cavities have up to ``limits[1]`` vertices; a search visits
    up to ``limits[2]`` nodes.
    """
    most, budget, now = int(limits[1]), int(limits[2]), int(limits[3])
    for i in range(cells.shape[0]):
        if solid.state[COUNT] - solid.state[FREE] + SPARE_SLOTS > solid.stamp.shape[0]:
            return i
        t = cells[i]
        if solid.vertex[4 * t] < 0:
            continue
        v = solid.vertex[4 * t : 4 * t + 4]
        if max(touched[v[0]], touched[v[1]], touched[v[2]], touched[v[3]]) < now - 1:
            continue
        if badness(solid.xyz, v[0], v[1], v[2], v[3]) < limits[0]:
            continue
        done = False
        for wanted in range(5, most + 1):
            for k in range(4):
                if solid.mark[4 * t + k] >= 0 or not beside(solid, r, 4 * t + k):
                    continue
                if _refilled(solid, held, r, 2, wanted, 0 if wanted < 7 else 2, budget):
                    done = True
                    break
            if done:
                break
        if done:
            counts[REFILLED] += 1
            for j in range(r.size[LOCALS]):
                touched[r.label[j]] = now
    return cells.shape[0]


@apart
def _worst(solid, found, size):
    """The worst badness of the cells found, and which it is."""
    worst, where = -1.0, 0
    for i in range(size):
        v = solid.vertex[4 * found.cells[i] : 4 * found.cells[i] + 4]
        bad = badness(solid.xyz, v[0], v[1], v[2], v[3])
        if bad > worst:
            worst, where = bad, i
    return worst, where


@apart
def _positive(solid, found, size):
    """Whether all cells found are positive, exactly."""
    for i in range(size):
        v = solid.vertex[4 * found.cells[i] : 4 * found.cells[i] + 4]
        if side(solid.xyz, v[0], v[1], v[2], v[3]) <= 0:
            return False
    return True


@apart
def _worst_below(solid, found, size, limit):
    """The worst badness of the cells found if it is below a limit; otherwise that of the first which is not.

    That cell is then put first: places that are tried for a vertex mostly fail at the same one.
    """
    worst = -1.0
    for i in range(size):
        v = solid.vertex[4 * found.cells[i] : 4 * found.cells[i] + 4]
        bad = badness(solid.xyz, v[0], v[1], v[2], v[3])
        if bad >= limit:
            found.cells[0], found.cells[i] = found.cells[i], found.cells[0]
            return bad
        worst = max(worst, bad)
    return worst


@apart
def _try(solid, found, size, p, place, worst):
    """Move vertex p to a place if that is better; returns the worst badness then."""
    xyz = solid.xyz
    x, y, z = xyz[p, 0], xyz[p, 1], xyz[p, 2]
    xyz[p, 0], xyz[p, 1], xyz[p, 2] = place[0], place[1], place[2]
    now = _worst_below(solid, found, size, worst - LEAST_GAIN)
    if now < worst - LEAST_GAIN and _positive(solid, found, size):
        return now
    xyz[p, 0], xyz[p, 1], xyz[p, 2] = x, y, z
    return worst


@apart
def _mean(solid, found, size, p, place):
    """The mean of the neighbors, each weighted by its cells."""
    place[0] = place[1] = place[2] = 0.0
    for i in range(size):
        for k in range(4):
            v = solid.vertex[4 * found.cells[i] + k]
            if v != p:
                for j in range(3):
                    place[j] += solid.xyz[v, j]
    for j in range(3):
        place[j] /= 3 * size


@apart
def _gradient(solid, t, p, step):
    """The direction in which a move of p helps the cell most, as long as its mean edge."""
    xyz, k = solid.xyz, 0
    while solid.vertex[4 * t + k] != p:
        k += 1
    a, b = solid.vertex[4 * t + corner(k, 0)], solid.vertex[4 * t + corner(k, 1)]
    c = solid.vertex[4 * t + corner(k, 2)]
    if xyz.shape[1] == METRIC_COLUMNS:
        return metric_gradient(xyz, p, a, b, c, step)
    total = six = 0.0
    for j in range(3):
        i, h = (j + 1) % 3, (j + 2) % 3
        normal = (xyz[b, i] - xyz[a, i]) * (xyz[c, h] - xyz[a, h]) - (xyz[b, h] - xyz[a, h]) * (
            xyz[c, i] - xyz[a, i]
        )
        step[j] = normal
        six += normal * (xyz[p, j] - xyz[a, j])
        total += (xyz[p, j] - xyz[a, j]) ** 2 + (xyz[p, j] - xyz[b, j]) ** 2 + (xyz[p, j] - xyz[c, j]) ** 2
        total += (xyz[a, j] - xyz[b, j]) ** 2 + (xyz[b, j] - xyz[c, j]) ** 2 + (xyz[c, j] - xyz[a, j]) ** 2
    mean, length = total / 6.0, 0.0
    if mean <= 0.0:
        return False
    for j in range(3):
        step[j] -= six / mean * 0.5 * (3.0 * xyz[p, j] - xyz[a, j] - xyz[b, j] - xyz[c, j])
        length += step[j] * step[j]
    if length <= 0.0:
        return False
    for j in range(3):
        step[j] *= np.sqrt(mean / length)
    return True


@kernel
def smooth_bad(solid, found, vertices, touched, limits, counts):
    """Move each of these vertices whose worst cell is worse than ``limits[0]`` if there is a better place.

    ``touched`` is the round in which something has changed at each vertex; ``limits[3]`` is this round.
    """
    now = int(limits[3])
    place, step = np.empty(3), np.empty(3)
    for i in range(vertices.shape[0]):
        p = vertices[i]
        if touched[p] < now - 1:
            continue
        size = star(solid, found, p)
        worst, where = _worst(solid, found, size)
        if size == 0 or worst < limits[0]:
            continue
        before = worst
        _mean(solid, found, size, p, place)
        worst = _try(solid, found, size, p, place, worst)
        for _ in range(CLIMBS):
            _, where = _worst(solid, found, size)
            if not _gradient(solid, found.cells[where], p, step):
                break
            length, last = 0.3, worst
            for _ in range(HALVINGS_OF_STEP):
                for j in range(3):
                    place[j] = solid.xyz[p, j] + length * step[j]
                worst = _try(solid, found, size, p, place, last)
                if worst < last:
                    break
                length *= 0.5
            if worst >= last:
                break
        if worst < before:
            counts[SMOOTHED] += 1
            for j in range(size):
                for k in range(4):
                    touched[solid.vertex[4 * found.cells[j] + k]] = now
