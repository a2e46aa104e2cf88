"""Is the envelope of the layers free: does it meet neither itself nor the rest, and leave enough room?

The layers are embedded if all their cells are positive and their outline does not meet itself: the map from
the strips, taken as abstract cells, to the plane then has degree one. What else could lie under a layer is a
part of the rest that the envelope encloses as a whole. All three are decided by exact signs. Where one fails,
the rays concerned get fewer layers. Without any layer the rest is the domain itself, so this ends.

Two more tests look after the cells of the rest. Edges of the envelope are not split, so a front that is
nearer to one than a share of its length, or a sharp angle between two ramps in a concave corner, would give
cells with small angles. There, too, the fronts step back.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.elementary import angle_of
from ...base.jit import inline, lean
from ...geometry.boxes import BoxTree
from ...geometry.parity import even_odd
from ...geometry.segment_pairs import meetings
from .facing import beside, mark_crowded
from .rays import Rays
from .scene import Scene, rest_of
from .stops import BY_EXACTNESS, BY_SHAPE, Stops, chains_of
from .strips import Numbering, last_point, numbered, positive, tops

__all__ = ["freed", "short_fans"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

LEAST_ROOM = 0.6  # of the length of an edge: how far an opposing edge must be away
LEAST_OPENING = np.radians(50.0)  # between two edges of the envelope, unless the wall's own angle is smaller
SAME_OPENING = 0.93  # ... by this factor
SHORT_FAN = 0.15  # edges of a fan are at least so long, in units of the edge beside it
WITHOUT_TREE = 64  # for so few vertices no tree is made
USUAL_BOXES = 64  # of strips around a vertex, for which there is room without one
ROUNDS_OF_ROOM = 60  # after so many the levels are lowered faster


def freed(scene: Scene, stops: Stops) -> tuple[Stops, Numbering, int]:
    """The levels lowered until the envelope is free; the points up to them; and how many rounds it took."""
    rounds = 0
    points = scene.walls.points
    stops = positive(points, scene.rays, scene.fronts, stops)
    while True:
        numbers = numbered(points, scene.rays, scene.fronts, stops.level)
        lower, reason = _faults(scene, stops.level, numbers)
        rows = np.flatnonzero(lower < stops.level)
        if not len(rows):
            return stops, numbers, rounds
        rounds += 1
        level, why = stops.level.copy(), stops.reason.copy()
        faster = np.where(reason[rows] == BY_EXACTNESS, rounds // ROUNDS_OF_ROOM, 0)
        level[rows] = np.maximum(lower[rows] - faster, 0)
        why[rows] = reason[rows]
        stops = positive(points, scene.rays, scene.fronts, Stops(level, why))


def short_fans(scene: Scene, level: Integers) -> Integers:
    """Vertices whose fans end so early that their edges are much shorter than those beside them."""
    rays = scene.rays
    side = len(scene.walls.ends)
    fan = np.arange(side, len(rays.left))
    i, j = rays.left[fan], rays.right[fan]
    x = scene.fronts.places
    length = np.hypot(*(x[i, level[i]] - x[j, level[j]]).T)
    some = np.flatnonzero(np.maximum(level[i], level[j]) > 0)
    before, after = rays.before, rays.after
    wide = np.zeros(len(scene.walls.points))
    for ray, other in ((i, before), (j, after)):
        rows = np.flatnonzero((other[ray] >= 0) & (rays.base[np.maximum(other[ray], 0)] != rays.base[ray]))
        r, o = ray[rows], other[ray[rows]]
        np.maximum.at(wide, rays.base[r], np.hypot(*(x[r, level[r]] - x[o, level[o]]).T))
    base = rays.base[i[some]]
    return np.unique(base[length[some] < SHORT_FAN * wide[base]])


def _faults(scene: Scene, level: Integers, numbers: Numbering) -> tuple[Integers, NDArray[np.int8]]:
    """The levels that rays must go down to, and why."""
    rays = scene.rays
    strip, top = tops(rays, level, numbers)
    lower, reason = level.copy(), np.full(len(level), BY_SHAPE, dtype=np.int8)
    if not len(strip):
        return lower, reason
    rest = rest_of(scene, level, numbers)
    edges, x = np.concatenate([top, rest]), numbers.points
    ends = np.stack([rays.left[strip], rays.right[strip]], axis=1)

    def down(rows: Integers, why: int) -> None:
        for r in (ends[rows, 0], ends[rows, 1]):
            r = r[level[r] > (why == BY_SHAPE)]
            lower[r] = np.minimum(lower[r], level[r] - 1)
            reason[r] = why

    pairs = meetings(x, edges)[0]
    if len(pairs):
        hit = np.unique(pairs.ravel())
        down(hit[hit < len(top)], BY_EXACTNESS)
        return lower, reason
    swallowed = _swallowed(scene, level, numbers, strip, rest)
    if len(swallowed):
        down(swallowed, BY_EXACTNESS)
        return lower, reason
    _open_angles(rays, level, x, numbers, lower)
    down(_without_room(x, top, rest), BY_SHAPE)
    return lower, reason


def _swallowed(
    scene: Scene, level: Integers, numbers: Numbering, strip: Integers, rest: Integers
) -> Integers:
    """The strips (their places in ``strip``) under which a vertex of the rest, or another front, lies.

    Nothing crosses the envelope, so that one vertex of each front tells where all of it is.
    """
    rays = scene.rays
    chain = chains_of(rays)[0]
    one = np.empty(int(chain.max()) + 1, dtype=np.int64)
    one[chain[::-1]] = rays.base[::-1]  # the base of the first ray of each chain
    asked = flagged(len(numbers.points), rest, scene.loose)
    asked[scene.walls.ends], asked[one] = False, True
    vertices = np.flatnonzero(asked[: len(scene.walls.points)])
    i, j = rays.left[strip], rays.right[strip]
    x, low, high = numbers.points[vertices], *np.empty((2, len(strip), 2))
    _enclose_strips(numbers.points, (numbers.start, rays.base, i, j), level, low, high)
    query, hit = np.empty((2, USUAL_BOXES * len(x)), dtype=np.int64)
    many = _in_boxes(x, low, high, query, hit) if len(x) <= WITHOUT_TREE else len(query) + 1
    query, hit = (query[:many], hit[:many]) if many <= len(query) else BoxTree(low, high).pairs(x, x)
    away = (vertices[query] != rays.base[i[hit]]) & (vertices[query] != rays.base[j[hit]])
    found: list[int] = []
    for q, h in zip(query[away].tolist(), hit[away].tolist()):
        up, back = np.arange(level[j[h]] + 1), np.arange(level[i[h]], -1, -1)
        ring = numbers.points[np.concatenate([
            numbers.at(np.full(len(up), j[h]), up), numbers.at(np.full(len(back), i[h]), back)
        ])]  # fmt: skip
        sides = np.column_stack([np.arange(len(ring)), np.roll(np.arange(len(ring)), -1)])
        inside, on = even_odd(ring, sides[(ring[sides[:, 0]] != ring[sides[:, 1]]).any(axis=1)], x[q : q + 1])
        if inside[0] or on[0]:
            found.append(h)
    return np.unique(np.array(found, dtype=np.int64))


@lean
def _enclose_strips(x, front, level, low, high):
    """Write the boxes of the bases and tips of strips."""
    start, base, left, right = front
    for s in range(len(left)):
        i, j = left[s], right[s]
        a, b, c, d = base[i], base[j], last_point(start, base, i, level), last_point(start, base, j, level)
        for k in range(2):
            low[s, k] = min(x[a, k], x[b, k], x[c, k], x[d, k])
            high[s, k] = max(x[a, k], x[b, k], x[c, k], x[d, k])


@lean
def _in_boxes(x, low, high, query, hit):
    """Write the pairs of a point and a box that holds it, for few points; returns how many there are."""
    many = 0
    for q in range(len(x)):
        for h in range(len(low)):
            if low[h, 0] <= x[q, 0] <= high[h, 0] and low[h, 1] <= x[q, 1] <= high[h, 1]:
                if many < len(query):
                    query[many], hit[many] = q, h
                many += 1
    return many


def _open_angles(rays: Rays, level: Integers, x: Array, numbers: Numbering, lower: Integers) -> None:
    """Lower rays beside a vertex at which two edges of the envelope open too little."""
    at = numbers.at(np.arange(len(level)), level)
    _lower_sharp(x, at, rays.base, (rays.before, rays.after), level, lower)


@inline
def _opening(x, p, v, q):
    """The angle clockwise from the edge from v to p to that from v to q."""
    ux, uy, vx, vy = x[p, 0] - x[v, 0], x[p, 1] - x[v, 1], x[q, 0] - x[v, 0], x[q, 1] - x[v, 1]
    angle = angle_of(uy * vx - ux * vy, ux * vx + uy * vy)
    return angle + 2 * math.pi if angle <= 0.0 else angle


@lean
def _lower_sharp(x, at, base, around, level, lower):
    """`_open_angles`: ``at`` are the vertices of the envelope."""
    before, after = around
    for v in range(len(level)):
        p, q = before[v], after[v]
        if p < 0 or q < 0 or max(level[v], level[p], level[q]) == 0:
            continue
        angle = _opening(x, at[p], at[v], at[q])
        if not angle < LEAST_OPENING:
            continue
        fan = base[p] == base[v] or base[q] == base[v]
        own = math.pi if fan else _opening(x, base[p], base[v], base[q])
        if not angle < SAME_OPENING * own:
            continue
        for other in (p, q):
            if level[other] > level[v]:
                lower[other] = min(lower[other], max(level[v], 1))
        if level[p] > level[v] or level[q] > level[v]:
            continue
        for row in (v, p, q):
            if level[row] > 1:
                lower[row] = min(lower[row], level[row] - 1)


def _without_room(x: Array, top: Integers, rest: Integers) -> Integers:
    """Edges of the envelope that another edge faces at less than a share of the length of either."""
    edges = np.concatenate([top, rest])
    pairs, length = beside(x, edges, len(top), LEAST_ROOM)
    crowded = np.zeros(len(edges), dtype=bool)
    mark_crowded(x, edges, pairs, length, LEAST_ROOM, len(top), crowded)
    return np.flatnonzero(crowded[: len(top)])
