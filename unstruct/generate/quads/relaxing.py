"""Vertices of quadrilaterals and triangles move to where the angles around them are nearer to right.

See the book, chapter 6c.
"""

from __future__ import annotations

import math

from ...base.jit import apart, inline, kernel
from ...predicates.kernels import orient2
from .linked import place_of, sides_of

__all__ = ["is_convex", "least_sine", "relax", "relax_everywhere", "ring_of", "spoiled"]

TURNED = 1e9  # what a corner that does not turn left costs: more than all others together
FLAT_SHARE = 1e-14  # of the squares of its sides, below which the area at a corner counts as none
EVEN_SIDES = 0.1  # the share of a corner's cost that grows if its sides are of different lengths
TRIANGLE_COST = 0.35  # a triangle beside quadrilaterals: its corners cost this much, times 1 if equilateral
STEP_SHARE = 0.25  # the first step, in mean lengths of the edges at a vertex
HALVINGS = 7  # rounds of search about a vertex; the step is halved where nothing is better
LEAST_GAIN = 1e-4  # relative; smaller ones end the search


@inline
def _corner_cost(ax, ay, bx, by):
    """1 at a right angle between equal sides, growing as 1 / sine^2, for the sides a and b from a corner."""
    area = ax * by - ay * bx
    a, b = ax * ax + ay * ay, bx * bx + by * by
    if area <= FLAT_SHARE * (a + b):
        return TURNED
    return EVEN_SIDES * 0.5 * (a + b) / area + (1.0 - EVEN_SIDES) * a * b / (area * area)


@inline
def _triangle_cost(ax, ay, bx, by):
    """1 for an equilateral triangle: squares of the three sides by the area."""
    area = ax * by - ay * bx
    a, b = ax * ax + ay * ay, bx * bx + by * by
    if area <= FLAT_SHARE * (a + b):
        return TURNED
    return TRIANGLE_COST * (a + b - (ax * bx + ay * by)) / (math.sqrt(0.75) * 2.0 * area)


@apart
def _cost_at(m, v):
    """The cost of the corners that change if v moves: its own and those beside it, in each of its cells."""
    xy, cells = m.xy, m.cells
    cost = 0.0
    for i in range(m.degree[v]):
        t = m.at[v, i]
        n = sides_of(cells, t)
        j = place_of(cells, t, v)
        for k in range(j + n - 1, j + n + 2):
            a, b, c = cells[t, (k + n - 1) % n], cells[t, k % n], cells[t, (k + 1) % n]
            ux, uy = xy[c, 0] - xy[b, 0], xy[c, 1] - xy[b, 1]
            vx, vy = xy[a, 0] - xy[b, 0], xy[a, 1] - xy[b, 1]
            cost += _corner_cost(ux, uy, vx, vy) if n == 4 else _triangle_cost(ux, uy, vx, vy)
    return cost


@apart
def _move(m, v):
    """Search in eight directions for a cheaper place of v; whether it moved."""
    xy, n = m.xy, m.degree[v]
    if n == 0:
        return False
    x, y = xy[v, 0], xy[v, 1]
    length, cx, cy = 0.0, 0.0, 0.0
    for i in range(n):
        t = m.at[v, i]
        w = m.cells[t, (place_of(m.cells, t, v) + 1) % sides_of(m.cells, t)]
        cx += xy[w, 0] / n
        cy += xy[w, 1] / n
        length += math.sqrt((xy[w, 0] - x) ** 2 + (xy[w, 1] - y) ** 2) / n
    cost = _cost_at(m, v)
    best, bx, by = cost, x, y
    if cost >= TURNED:  # the middle of the neighbors may be right where no step is
        xy[v, 0], xy[v, 1] = cx, cy
        new = _cost_at(m, v)
        if new < best:
            best, bx, by = new, cx, cy
    step = STEP_SHARE * length
    for _ in range(HALVINGS):
        cx, cy, better = bx, by, False
        for direction in range(9):
            xy[v, 0], xy[v, 1] = cx + step * (direction % 3 - 1), cy + step * (direction // 3 - 1)
            new = _cost_at(m, v)
            if new < best:
                best, bx, by, better = new, xy[v, 0], xy[v, 1], True
        if not better:
            step *= 0.5
    xy[v, 0], xy[v, 1] = bx, by
    return best < cost * (1.0 - LEAST_GAIN)


@apart
def relax(m, count, rounds):
    """Move the free ones of the first ``count`` vertices in ``ring``, in turn."""
    for _ in range(rounds):
        moved = False
        for i in range(count):
            v = m.ring[i]
            if m.free[v] and _move(m, v):
                moved = True
        if not moved:
            break


@kernel
def relax_everywhere(m, todo, rounds):
    """Move free vertices that are to do, in turn; a move brings back those around. Returns how many moved."""
    moves = 0
    for _ in range(rounds):
        before = moves
        for v in range(len(m.xy)):
            if not todo[v] or not m.free[v]:
                continue
            todo[v] = False
            if _move(m, v):
                moves += 1
                for i in range(m.degree[v]):
                    t = m.at[v, i]
                    for k in range(sides_of(m.cells, t)):
                        todo[m.cells[t, k]] = True
        if moves == before:
            break
    return moves


@inline
def ring_of(m, count, v):
    """Add the vertices of the cells at v to ``ring``, from ``count`` on, each once; the new count."""
    for i in range(m.degree[v]):
        t = m.at[v, i]
        for k in range(sides_of(m.cells, t)):
            w, old = m.cells[t, k], False
            for j in range(count):
                old = old or m.ring[j] == w
            if not old:
                m.ring[count] = w
                count += 1
    return count


@apart
def least_sine(m, count):
    """The least sine of a corner in the cells at the first ``count`` vertices of ``ring``; negative where
    one turns right."""
    xy, cells = m.xy, m.cells
    least = 1.0
    for i in range(count):
        v = m.ring[i]
        for j in range(m.degree[v]):
            t = m.at[v, j]
            n = sides_of(cells, t)
            for k in range(n):
                a, b, c = cells[t, (k + n - 1) % n], cells[t, k], cells[t, (k + 1) % n]
                ux, uy = xy[c, 0] - xy[b, 0], xy[c, 1] - xy[b, 1]
                wx, wy = xy[a, 0] - xy[b, 0], xy[a, 1] - xy[b, 1]
                squares = (ux * ux + uy * uy) * (wx * wx + wy * wy)
                least = min(least, (ux * wy - uy * wx) / math.sqrt(squares) if squares > 0.0 else -1.0)
    return least


@apart
def is_convex(m, t):
    """Whether every corner of cell t turns left, exactly."""
    xy, n = m.xy, sides_of(m.cells, t)
    for k in range(n):
        a, b, c = m.cells[t, k], m.cells[t, (k + 1) % n], m.cells[t, (k + 2) % n]
        if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) <= 0:
            return False
    return True


@kernel
def spoiled(m):
    """Whether a cell is not convex."""
    for t in range(len(m.cells)):
        if m.cells[t, 0] >= 0 and not is_convex(m, t):
            return True
    return False
