"""Vertices of quadrilaterals and triangles move to where the angles around them are nearer to right.

See the book, chapter 6c.
"""

from __future__ import annotations

import math

import numpy as np

from ...base.jit import apart, inline, kernel
from .linked import Linked, place_of, sides_of

__all__ = ["mark_flat", "relax", "relax_everywhere", "ring_of", "sines"]

FLAT_CORNER = 1e-12  # of the squares of its sides, below which the area at a corner counts as none
LOST_AREA = 1e-290  # products of smaller numbers lose digits
EVEN_SIDES = 0.1  # the share of a corner's cost that grows if its sides are of different lengths
TRIANGLE_COST = 0.35  # a triangle beside quadrilaterals: its corners cost this much, if it is equilateral
TRIANGLE_UNIT = TRIANGLE_COST / (2.0 * math.sqrt(0.75))
NEWTON_STEPS = 2  # at a visit
LONGEST_STEP = 0.3  # in mean lengths of the edges at a vertex
STEP_HALVINGS = 4
SEARCH_HALVINGS = 6  # of a search in eight directions, where corners turn right
MOVES_A_CALL = 100_000  # vertices visited in one kernel call: Ctrl-C works between calls
LEAST_MOVE_GAIN = 1e-4  # relative; smaller ones end the search


@inline
def _costs_at(m, v, unit):
    """How many of the corners that change if v moves do not turn left, and what the others cost.

    They are v's own and those beside it, in each of its cells. A right angle between equal sides costs 1, and
    others more, as 1 / sine^2; ``unit`` is one by a length.
    """
    xy, cells = m.xy, m.cells
    turned, cost = 0, 0.0
    for i in range(m.place[v], m.place[v] + m.degree[v]):
        t = m.at[i]
        n = sides_of(cells, t)
        j = place_of(cells, t, v)
        for k in range(j + n - 1, j + n + 2):
            a, b, c = cells[t, (k + n - 1) % n], cells[t, k % n], cells[t, (k + 1) % n]
            ux, uy = (xy[c, 0] - xy[b, 0]) * unit, (xy[c, 1] - xy[b, 1]) * unit
            wx, wy = (xy[a, 0] - xy[b, 0]) * unit, (xy[a, 1] - xy[b, 1]) * unit
            area, uu, ww = ux * wy - uy * wx, ux * ux + uy * uy, wx * wx + wy * wy
            if not area > FLAT_CORNER * (uu + ww):
                turned += 1
            elif n == 4:
                p, q = uu / area, ww / area
                cost += EVEN_SIDES * 0.5 * (p + q) + (1.0 - EVEN_SIDES) * p * q
            else:
                cost += TRIANGLE_UNIT * (uu + ww - (ux * wx + uy * wy)) / area
    return turned, cost


@apart
def _cost_at(m, v, unit):
    return _costs_at(m, v, unit)


@apart
def _slopes_at(m, v, unit, found):
    """The derivatives of the cost in ``found``: by x, by y, then by xx, xy, yy. No corner may turn right.

    The area at a corner is linear in each of its three vertices, and the squares of its sides have constant
    second derivatives. A triangle has the same cost at each corner: three times that at v.
    """
    xy, cells = m.xy, m.cells
    found[:] = 0.0
    for i in range(m.place[v], m.place[v] + m.degree[v]):
        t = m.at[i]
        n = sides_of(cells, t)
        j = place_of(cells, t, v)
        for k in range(j + n - 1, j + n + 2) if n == 4 else range(j + n, j + n + 1):
            a, b, c = cells[t, (k + n - 1) % n], cells[t, k % n], cells[t, (k + 1) % n]
            ux, uy = (xy[c, 0] - xy[b, 0]) * unit, (xy[c, 1] - xy[b, 1]) * unit
            wx, wy = (xy[a, 0] - xy[b, 0]) * unit, (xy[a, 1] - xy[b, 1]) * unit
            area = ux * wy - uy * wx
            if n == 3:
                p = 3.0 * TRIANGLE_UNIT / area
                s = _square(ux, uy) + _square(wx, wy) - (ux * wx + uy * wy)
                gx, gy, ax, ay = -(ux + wx), -(uy + wy), (uy - wy) / area, (wx - ux) / area
                found[0] += p * (gx - s * ax)
                found[1] += p * (gy - s * ay)
                found[2] += p * (2.0 - 2.0 * gx * ax + 2.0 * s * ax * ax)
                found[3] += p * (-gx * ay - gy * ax + 2.0 * s * ax * ay)
                found[4] += p * (2.0 - 2.0 * gy * ay + 2.0 * s * ay * ay)
                continue
            # P and Q are squares of the sides by the area; f = e (P + Q) / 2 + (1 - e) P Q
            p, q = _square(ux, uy) / area, _square(wx, wy) / area
            moves_u, moves_w = 1.0, 1.0
            if k % n == j:
                sx, sy, zx, zy, ax, ay = -2.0 * ux, -2.0 * uy, -2.0 * wx, -2.0 * wy, uy - wy, wx - ux
            elif c == v:
                sx, sy, zx, zy, ax, ay, moves_w = 2.0 * ux, 2.0 * uy, 0.0, 0.0, wy, -wx, 0.0
            else:
                sx, sy, zx, zy, ax, ay, moves_u = 0.0, 0.0, 2.0 * wx, 2.0 * wy, -uy, ux, 0.0
            sx, sy, zx, zy, ax, ay = sx / area, sy / area, zx / area, zy / area, ax / area, ay / area
            even, right = 0.5 * EVEN_SIDES, 1.0 - EVEN_SIDES
            da = -even * (p + q) - 2.0 * right * p * q
            dp, dq = even + right * q, even + right * p
            daa = 2.0 * even * (p + q) + 6.0 * right * p * q
            dap, daq = -even - 2.0 * right * q, -even - 2.0 * right * p
            flat = 2.0 * (dp * moves_u + dq * moves_w) / area
            found[0] += da * ax + dp * sx + dq * zx
            found[1] += da * ay + dp * sy + dq * zy
            found[2] += daa * ax * ax + 2.0 * ax * (dap * sx + daq * zx) + 2.0 * right * sx * zx + flat
            found[3] += (
                daa * ax * ay + ax * (dap * sy + daq * zy) + ay * (dap * sx + daq * zx)
                + right * (sx * zy + sy * zx)
            )  # fmt: skip
            found[4] += daa * ay * ay + 2.0 * ay * (dap * sy + daq * zy) + 2.0 * right * sy * zy + flat


@inline
def _square(x, y):
    """The square of a length."""
    return x * x + y * y


@apart
def _search(m, v, unit):
    """Search in eight directions, and first in the middle of the neighbors, for a place with fewer corners
    that do not turn left."""
    xy, n = m.xy, m.degree[v]
    bx, by, cx, cy = xy[v, 0], xy[v, 1], 0.0, 0.0
    for i in range(m.place[v], m.place[v] + n):
        w = m.cells[m.at[i], (place_of(m.cells, m.at[i], v) + 1) % sides_of(m.cells, m.at[i])]
        cx += xy[w, 0] / n
        cy += xy[w, 1] / n
    turned, cost = _cost_at(m, v, unit)
    xy[v, 0], xy[v, 1] = cx, cy
    many, new = _cost_at(m, v, unit)
    if many < turned:
        turned, cost, bx, by = many, new, cx, cy
    step = LONGEST_STEP / unit
    for _ in range(SEARCH_HALVINGS):
        cx, cy, better = bx, by, False
        for direction in range(9):
            xy[v, 0], xy[v, 1] = cx + step * (direction % 3 - 1), cy + step * (direction // 3 - 1)
            many, new = _cost_at(m, v, unit)
            if many < turned or (many == turned and new < cost):
                turned, cost, bx, by, better = many, new, xy[v, 0], xy[v, 1], True
        if not better:
            step *= 0.5
    xy[v, 0], xy[v, 1] = bx, by
    return turned, cost


@apart
def _move(m, v):
    """Steps of Newton's method to a cheaper place of v; whether it moved.

    No corner turns right afterwards that did not before: signs of areas are far above their rounding.
    """
    xy, n = m.xy, m.degree[v]
    length = 0.0
    for i in range(m.place[v], m.place[v] + n):
        w = m.cells[m.at[i], (place_of(m.cells, m.at[i], v) + 1) % sides_of(m.cells, m.at[i])]
        length += math.sqrt(_square(xy[w, 0] - xy[v, 0], xy[w, 1] - xy[v, 1])) / n
    if not length > 0.0:
        return False
    unit = 1.0 / length
    first_turned, first = _cost_at(m, v, unit)
    turned, cost = first_turned, first
    if turned > 0:
        turned, cost = _search(m, v, unit)
    for _ in range(NEWTON_STEPS if turned == 0 else 0):
        d = m.slopes
        _slopes_at(m, v, unit, d)
        det = d[2] * d[4] - d[3] * d[3]
        if det > 0.0 and d[2] > 0.0:
            dx, dy = -(d[4] * d[0] - d[3] * d[1]) / det, -(d[2] * d[1] - d[3] * d[0]) / det
        else:
            dx, dy = -d[0], -d[1]
        far = math.sqrt(_square(dx, dy))
        if not far > 0.0:
            break
        share = min(1.0, LONGEST_STEP / far) * length
        x, y, new = xy[v, 0], xy[v, 1], cost
        for _ in range(STEP_HALVINGS):
            xy[v, 0], xy[v, 1] = x + share * dx, y + share * dy
            many, new = _cost_at(m, v, unit)
            if many == 0 and new < cost:
                break
            xy[v, 0], xy[v, 1] = x, y
            new = cost
            share *= 0.5
        done = not new < cost * (1.0 - LEAST_MOVE_GAIN)
        cost = new
        if done:
            break
    return turned < first_turned or cost < first * (1.0 - LEAST_MOVE_GAIN)


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
def relax_some(m, todo, start, stop):
    """Move the free vertices from ``start`` to ``stop`` that are to do, in turn.

    A move brings back those around. Returns how many moved.
    """
    moves = 0
    for v in range(start, min(stop, len(m.xy))):
        if todo[v] and m.free[v]:
            todo[v] = False
            if _move(m, v):
                moves += 1
                for i in range(m.place[v], m.place[v] + m.degree[v]):
                    t = m.at[i]
                    for k in range(sides_of(m.cells, t)):
                        todo[m.cells[t, k]] = True
    return moves


def relax_everywhere(m: Linked, rounds: int) -> int:
    """Move all free vertices, in turn, and again those beside a vertex that moved; how many moves were made.

    Parameters
    ----------
    m : Linked
    rounds : int
        The largest number of rounds.

    Returns
    -------
    int
    """
    todo, moves = np.ones(len(m.xy), dtype=bool), 0
    for _ in range(rounds):
        before = moves
        for start in range(0, len(todo), MOVES_A_CALL):
            moves += int(relax_some(m, todo, start, start + MOVES_A_CALL))
        if moves == before:
            break
    return moves


@inline
def ring_of(m, count, v):
    """Add the vertices of the cells at v to ``ring``, from ``count`` on, each once; the new count."""
    for i in range(m.place[v], m.place[v] + m.degree[v]):
        t = m.at[i]
        for k in range(sides_of(m.cells, t)):
            w, old = m.cells[t, k], False
            for j in range(count):
                old = old or m.ring[j] == w
            if not old:
                m.ring[count] = w
                count += 1
    return count


@apart
def sines(m, count, least):
    """The least sine of a corner in the cells at the first ``count`` vertices of ``ring``, and how many are
    below ``least``, counted at each of these vertices of its cell; -1 where one does not surely turn left."""
    xy, cells = m.xy, m.cells
    lowest, many = 1.0, 0
    for i in range(count):
        v = m.ring[i]
        for j in range(m.place[v], m.place[v] + m.degree[v]):
            t = m.at[j]
            n = sides_of(cells, t)
            for k in range(n):
                a, b, c = cells[t, (k + n - 1) % n], cells[t, k], cells[t, (k + 1) % n]
                ux, uy = xy[c, 0] - xy[b, 0], xy[c, 1] - xy[b, 1]
                wx, wy = xy[a, 0] - xy[b, 0], xy[a, 1] - xy[b, 1]
                area, uu, ww = ux * wy - uy * wx, _square(ux, uy), _square(wx, wy)
                flat = not area > FLAT_CORNER * (uu + ww) + LOST_AREA
                sine = -1.0 if flat else area / (math.sqrt(uu) * math.sqrt(ww))
                lowest = min(lowest, sine)
                if sine < least:
                    many += 1
    return lowest, many


@kernel
def mark_flat(m, found):
    """Mark the vertices of cells that have a corner which does not surely turn left."""
    xy, cells = m.xy, m.cells
    for t in range(len(cells)):
        if cells[t, 0] < 0:
            continue
        n = sides_of(cells, t)
        for k in range(n):
            a, b, c = cells[t, k], cells[t, (k + 1) % n], cells[t, (k + 2) % n]
            ux, uy, wx, wy = (
                xy[c, 0] - xy[b, 0],
                xy[c, 1] - xy[b, 1],
                xy[a, 0] - xy[b, 0],
                xy[a, 1] - xy[b, 1],
            )
            if not ux * wy - uy * wx > FLAT_CORNER * (_square(ux, uy) + _square(wx, wy)) + LOST_AREA:
                for i in range(n):
                    found[cells[t, i]] = True
