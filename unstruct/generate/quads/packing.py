"""Points packed as the corners of squares: from each point four steps of the wanted length along its cross.

See the book, chapter 6c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, kernel
from .crosses import arm_of

__all__ = ["Guide", "packed"]

NEAREST_POINT = 0.7  # of the wanted length, in the norm whose unit ball is the square along the cross
NEAREST_SIDE = 0.6  # of the wanted length, from a side of the boundary
WALK_LIMIT = 10_000  # triangles
STEPS_A_CALL = 50_000  # Ctrl-C works between calls
MOST_AT_FIRST = 1e7  # points that there is room for


class Guide(NamedTuple):
    """A triangulation at whose vertices crosses (as pairs) and wanted lengths are known.

    ``closed[t, i]`` are sides that no step crosses; ``given[v]`` are vertices that points keep away from.
    ``start`` and ``ends`` have the triangles of each vertex as rows.
    """

    xy: NDArray[np.float64]
    triangles: NDArray[np.int32]
    neighbors: NDArray[np.int32]
    closed: NDArray[np.bool_]
    given: NDArray[np.bool_]
    pair: NDArray[np.float64]
    length: NDArray[np.float64]
    start: NDArray[np.int64]
    ends: NDArray[np.int64]


class Packed(NamedTuple):
    """Points as they are placed: where, an arm, the wanted length, the triangle of the guide, -1 at its
    vertices, and the vertex; in each triangle a list of its points, from ``first`` by ``following``."""

    xy: NDArray[np.float64]
    arm: NDArray[np.float64]
    length: NDArray[np.float64]
    triangle: NDArray[np.int64]
    vertex: NDArray[np.int64]
    first: NDArray[np.int64]
    following: NDArray[np.int64]
    seen: NDArray[np.int64]
    stack: NDArray[np.int64]


@inline
def _side(xy, a, b, x, y):
    """Twice the area of a, b and (x, y)."""
    return (xy[b, 0] - xy[a, 0]) * (y - xy[a, 1]) - (xy[b, 1] - xy[a, 1]) * (x - xy[a, 0])


@apart
def _walk(g, t, x, y):
    """The triangle of (x, y), by a walk from t that crosses no closed side; -1 if it ends elsewhere."""
    for _ in range(WALK_LIMIT):
        blocked, then = False, np.int64(-1)
        for i in range(3):
            if _side(g.xy, g.triangles[t, (i + 1) % 3], g.triangles[t, (i + 2) % 3], x, y) < 0.0:
                if g.neighbors[t, i] < 0 or g.closed[t, i]:
                    blocked = True
                else:
                    then = np.int64(g.neighbors[t, i])
        if then < 0:
            return np.int64(-1) if blocked else t
        t = then
    return np.int64(-1)


@apart
def _towards(g, v, x, y):
    """The triangle at vertex v in which the way to (x, y) begins; -1 if it leaves the region."""
    for k in range(g.start[v], g.start[v + 1]):
        t = g.ends[k]
        i = 0
        while g.triangles[t, i] != v:
            i += 1
        b, c = g.triangles[t, (i + 1) % 3], g.triangles[t, (i + 2) % 3]
        if _side(g.xy, v, b, x, y) >= 0.0 and _side(g.xy, c, v, x, y) >= 0.0:
            return t
    return np.int64(-1)


@apart
def _at(g, t, x, y):
    """The pair and the wanted length at (x, y) in triangle t: linear between its corners."""
    a, b, c = g.triangles[t, 0], g.triangles[t, 1], g.triangles[t, 2]
    # By rounding, weights may be negative, and in a flat triangle all zero: no length may be.
    wa, wb = max(0.0, _side(g.xy, b, c, x, y)), max(0.0, _side(g.xy, c, a, x, y))
    wc = max(0.0, _side(g.xy, a, b, x, y))
    total = wa + wb + wc
    if total > 0.0:
        wa, wb, wc = wa / total, wb / total, wc / total
    else:
        wa, wb, wc = 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0
    return (
        wa * g.pair[a, 0] + wb * g.pair[b, 0] + wc * g.pair[c, 0],
        wa * g.pair[a, 1] + wb * g.pair[b, 1] + wc * g.pair[c, 1],
        wa * g.length[a] + wb * g.length[b] + wc * g.length[c],
    )


@inline
def _to_side(xy, a, b, x, y):
    """The square of the distance of (x, y) from the segment ab."""
    dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    square, s = dx * dx + dy * dy, 0.0
    if square > 0.0:
        s = min(1.0, max(0.0, ((x - xy[a, 0]) * dx + (y - xy[a, 1]) * dy) / square))
    ex, ey = x - xy[a, 0] - s * dx, y - xy[a, 1] - s * dy
    return ex * ex + ey * ey


@inline
def _in_square(x, y, c, s, half):
    """Whether the square about the origin with an arm (c, s) and this half side has (x, y) inside."""
    return max(abs(x * c + y * s), abs(y * c - x * s)) < half


@apart
def _is_free(g, p, n, t, x, y, c, s, length):
    """Whether no point or given vertex is in the square about (x, y), and no closed side is near.

    The search spreads over the triangles that the square's circle meets, across sides that are open.
    """
    half = NEAREST_POINT * length
    radius = 2.0 * half * half
    near = (NEAREST_SIDE * length) ** 2
    p.stack[0], depth = t, 1
    p.seen[t] = n
    while depth > 0:
        depth -= 1
        t = p.stack[depth]
        for i in range(3):
            v = g.triangles[t, i]
            if g.given[v] and _in_square(g.xy[v, 0] - x, g.xy[v, 1] - y, c, s, half):
                return False
            a, b = g.triangles[t, (i + 1) % 3], g.triangles[t, (i + 2) % 3]
            away = _to_side(g.xy, a, b, x, y)
            o = np.int64(g.neighbors[t, i])
            if o < 0 or g.closed[t, i]:
                if away < near:
                    return False
            elif away < radius and p.seen[o] != n:
                p.seen[o] = n
                p.stack[depth] = o
                depth += 1
        w = p.first[t]
        while w >= 0:
            if _in_square(p.xy[w, 0] - x, p.xy[w, 1] - y, c, s, half):
                return False
            w = p.following[w]
    return True


@inline
def _nearest_arm(c, s, x, y):
    """Of the four arms of the cross with arm (c, s) the one nearest to the direction (x, y)."""
    if abs(c * x + s * y) < abs(c * y - s * x):
        c, s = -s, c
    return (c, s) if c * x + s * y >= 0.0 else (-c, -s)


@kernel
def _pack(g, p, v, count, tried):
    """Four steps from each point in turn, from v on, and from those that are placed on the way.

    A step follows the cross in its middle. ``count`` of the points are there; stop if there is no more room,
    or after so many points of origin. Returns the point to go on from, how many there are, and how many
    places were tried.
    """
    last, limit = v + STEPS_A_CALL, len(p.xy)
    while v < min(count, last):
        for k in range(4):
            if count == limit:
                return v, count, tried
            ux, uy = p.arm[v, 0], p.arm[v, 1]
            if k == 1:
                ux, uy = -uy, ux
            elif k == 2:
                ux, uy = -ux, -uy
            elif k == 3:
                ux, uy = uy, -ux
            h = 0.5 * p.length[v]
            x, y = p.xy[v, 0] + h * ux, p.xy[v, 1] + h * uy
            t = p.triangle[v] if p.vertex[v] < 0 else _towards(g, p.vertex[v], x, y)
            if t >= 0:
                t = _walk(g, t, x, y)
            if t < 0:
                continue
            c, s, h = _at(g, t, x, y)
            c, s = arm_of(c, s)
            ux, uy = _nearest_arm(c, s, ux, uy)
            x, y = p.xy[v, 0] + h * ux, p.xy[v, 1] + h * uy
            t = _walk(g, t, x, y)
            if t < 0:
                continue
            c, s, h = _at(g, t, x, y)
            c, s = arm_of(c, s)
            tried += 1
            if not _is_free(g, p, tried, t, x, y, c, s, h):
                continue
            p.xy[count, 0], p.xy[count, 1] = x, y
            p.arm[count, 0], p.arm[count, 1] = c, s
            p.length[count], p.triangle[count], p.vertex[count] = h, t, -1
            p.following[count], p.first[t] = p.first[t], count
            count += 1
        v += 1
    return v, count, tried


def packed(g: Guide, budget: int) -> NDArray[np.float64]:
    """Points in the region of a guide.

    Parameters
    ----------
    g : Guide
    budget : int
        The largest number of points.

    Returns
    -------
    (k, 2) float64
        In the order in which they were placed: from the given vertices, in breadth.

    Notes
    -----
    No point is in the square about a later one, whose half side is 0.7 of the wanted length there and whose
    sides are along the cross there; so there are at most as many as squares fit, and it takes O(n).
    Source: J.-F. Remacle and others, Int. J. Numer. Methods Eng. 94 (2013) 494-512.
    """
    given = np.flatnonzero(g.given & (g.start[1:] > g.start[:-1]))
    area = _areas(g.xy, g.triangles)
    squares = (area / (g.length[g.triangles].min(axis=1) * g.length[g.triangles].max(axis=1))).sum()
    most = len(given) + budget
    n = min(most, len(given) + int(min(MOST_AT_FIRST, 1.5 * squares / NEAREST_POINT)) + 64)
    p = Packed(
        np.empty((n, 2)), np.empty((n, 2)), np.empty(n), np.full(n, -1), np.full(n, -1),
        np.full(len(area), -1), np.full(n, -1), np.zeros(len(area), dtype=np.int64),
        np.empty(len(area) + 4, dtype=np.int64),
    )  # fmt: skip
    p.xy[: len(given)], p.length[: len(given)], p.vertex[: len(given)] = g.xy[given], g.length[given], given
    p.arm[: len(given)] = [arm_of(c, s) for c, s in g.pair[given].tolist()] if len(given) else 0.0
    v, count, tried = 0, len(given), 0
    while v < count:
        v, count, tried = _pack(g, p, v, count, tried)
        if count == len(p.xy):
            if count == most:
                break
            p = _with_room(p, min(most, 2 * count + 64))
    return p.xy[len(given) : count].copy()


@kernel
def _areas(xy, triangles):
    areas = np.empty(len(triangles))
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        areas[t] = 0.5 * max(0.0, _side(xy, a, b, xy[c, 0], xy[c, 1]))
    return areas


def _with_room(p: Packed, n: int) -> Packed:
    """The same points, and room for so many."""
    larger = []
    for name in ("xy", "arm", "length", "triangle", "vertex", "following"):
        old = getattr(p, name)
        new = np.empty((n, *old.shape[1:]), dtype=old.dtype)
        new[: len(old)] = old
        larger.append(new)
    xy, arm, length, triangle, vertex, following = larger
    return p._replace(
        xy=xy, arm=arm, length=length, triangle=triangle, vertex=vertex, following=following
    )  # fmt: skip
