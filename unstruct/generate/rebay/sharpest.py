"""The last step of finishing: the sharpest triangles, one after another, compiled.

A queue has the triangles with an angle below a goal, the sharpest first. Around each a `Patch` is copied, and
changes are tried on copies of it: none, a swap of one of the triangle's edges, a new vertex in it, one vertex
less. After each change the vertices inside are moved until the *sharpness* of the patch decreases no longer.
That is a sum over triangles and edges in which the worst ones outweigh all others by far; contrary to a
minimum it also decreases by moves that only make room for others. Diagonals are swapped so that the patch
becomes constrained Delaunay, which never makes its minimum angle smaller. The best copy replaces the
triangles that there were, if its minimum angle is larger and it has no more edges and triangles of a wrong
size. Book: 2.6c.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np

from ...base.heap import pop, push
from ...base.jit import inline, lean
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import UNUSED, VERTICES, end_of, start_of
from ...connect.planar.stars import CERTAIN, COMPASS, TINY_AREA, legalize, measures, star_of, swap_around
from ...predicates.kernels import orient2
from ...sizing.table import ROOT3
from .patch import CELLS, POINTS, drop, fan_of, gather, outside_holds, put_back, put_inside, same, turn
from .steps import classify, wanted

__all__ = ["sharpen"]

SHARP = 0.44  # squared sine of 41.6 degrees: here the sharpness of a triangle is 1
LONG = 1.9  # squared ratio of an edge to the wanted length, or its inverse, where the sharpness is 1
FIRST_STEP, SHRINK, SWEEPS = 0.12, 0.7, 12  # moves of vertices, in edge lengths
GAIN = 1.004  # the least factor by which the squared sine must grow
TRIED, CHANGED, SPENT = range(3)  # places in ``tally``


@inline
def _eighth(x):
    x *= x
    x *= x
    return x * x


@inline
def _sharpness(places, k, x, y, size):
    """The sharpness of a star with its vertex at x, y; inf if a triangle is not counterclockwise."""
    total = 0.0
    ux, uy = places[0, 0] - x, places[0, 1] - y
    u = ux * ux + uy * uy
    for i in range(k):
        vx, vy = places[i + 1, 0] - x, places[i + 1, 1] - y
        wx, wy = vx - ux, vy - uy
        v, w, double = vx * vx + vy * vy, wx * wx + wy * wy, ux * vy - uy * vx
        if double <= CERTAIN * (u + v + w) + TINY_AREA and (
            double <= 0.0
            or orient2(places[i, 0], places[i, 1], places[i + 1, 0], places[i + 1, 1], x, y) <= 0
        ):
            return inf
        below = double * double * min(u, min(v, w))
        if below == 0.0 or size == 0.0 or u == 0.0:
            return inf
        ratio = u / size
        total += _eighth(SHARP * u * v * w / below) + _eighth(max(ratio, 1.0 / ratio) / LONG)
        ux, uy, u = vx, vy, v
    ratio = u / size  # once more the first edge, or the last one of a fan
    return total + _eighth(max(ratio, 1.0 / ratio) / LONG)


@inline
def _slide(patch, stars, spots, v):
    """Move a vertex of the boundary to another place of its piece, if that decreases the sharpness."""
    s, places, row = stars, stars.places, patch.row[v]
    k = fan_of(s.xy, s.vertex, s.twin, s.mark, s.at[v], places)
    here, size = patch.spot[v], patch.size[v]
    least = _sharpness(places, k, s.xy[v, 0], s.xy[v, 1], size)
    best = here
    for step in (-4, 4, -2, 2, -1, 1):
        other = here + step
        if 0 <= other < spots.shape[1]:
            new = _sharpness(places, k, spots[row, other, 0], spots[row, other, 1], size)
            if new < 0.9999 * least:
                best, least = other, new
    if best == here:
        return False
    patch.spot[v] = best
    s.xy[v, 0], s.xy[v, 1] = spots[row, best, 0], spots[row, best, 1]
    return True


@lean
def _legal(patch, stars):
    """Swap diagonals until the patch is constrained Delaunay."""
    depth = 0
    for t in range(patch.counters[CELLS]):
        if patch.live[t] >= 0:
            for e in range(3 * t, 3 * t + 3):
                if stars.twin[e] > e:
                    stars.stack[depth] = e
                    depth += 1
    s = stars
    legalize(s.xy, s.vertex, s.twin, s.mark, s.where, s.at, s.stack, depth)


@lean
def _settle(patch, stars, spots, swap):
    """Move the vertices of a patch until its sharpness decreases no longer; with ``swap`` swap diagonals."""
    xy, places = stars.xy, stars.places
    reach = FIRST_STEP
    for _ in range(SWEEPS):
        moves = 0
        for v in range(patch.counters[POINTS]):
            if stars.still[v]:
                if patch.row[v] >= 0 and _slide(patch, stars, spots, v):
                    moves += 1
                    if swap:
                        _legal(patch, stars)
                continue
            k = star_of(xy, stars.vertex, stars.twin, stars.at[v], stars.ring, places)
            x, y, size = xy[v, 0], xy[v, 1], patch.size[v]
            least = _sharpness(places, k, x, y, size)
            step, again = reach * sqrt(size), 2
            moved = False
            while again > 0:
                found = False
                for dx, dy in COMPASS:
                    new = _sharpness(places, k, x + step * dx, y + step * dy, size)
                    if new < 0.9999 * least:
                        x, y, least, found = x + step * dx, y + step * dy, new, True
                        break
                moved = moved or found
                if not found:
                    step, again = step / 2.0, again - 1
            if moved:
                xy[v, 0], xy[v, 1] = x, y
                moves += 1
                if swap:
                    swap_around(stars, k)
        if moves == 0 and reach < 0.02:
            break
        reach *= SHRINK


@lean
def _judge(patch, stars, bound):
    """The smallest squared sine, the number of edges and triangles of a wrong size: (sine, wrong)."""
    xy, vertex, size = stars.xy, stars.vertex, patch.size
    sine, wrong = 1.0, 0
    for t in range(patch.counters[CELLS]):
        if patch.live[t] < 0:
            continue
        a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
        if orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) <= 0:
            return 0.0, 1 << 20
        _, s = measures(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])
        sine = min(sine, s)
        product = 1.0
        for e in range(3 * t, 3 * t + 3):
            p, q = start_of(vertex, e), end_of(vertex, e)
            ux, uy = xy[q, 0] - xy[p, 0], xy[q, 1] - xy[p, 1]
            u, h = ux * ux + uy * uy, (size[p] + size[q]) / 2.0
            product *= u / h
            if (stars.mark[e] >= 0 or stars.twin[e] > e) and (u > 2.0 * h or 2.0 * u < h):
                wrong += 1
        # R^2 = product / (4 double^2); accepted below (delta f)^2 = bound h
        ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
        double = ux * (xy[c, 1] - xy[a, 1]) - uy * (xy[c, 0] - xy[a, 0])
        h = (size[a] + size[b] + size[c]) / 3.0
        if product * h * h >= 4.0 * double * double * bound:
            wrong += 1
    return sine, wrong


@lean
def _change(patch, stars, kind, grow):
    """Make change number ``kind`` of the first triangle of a patch: 1 if made, 0 if not, -1 beyond the last."""
    if kind == 0:
        return 1
    if kind < 4:
        return 1 if turn(stars, np.int64(kind - 1)) else 0
    if kind == 4:
        if grow:
            put_inside(patch, stars, 0)
        return 1 if grow else 0
    if kind < 11:
        e = np.int64((kind - 5) % 3)
        if kind < 8:
            v = stars.vertex[e]
        elif stars.mark[e] < 0:
            v = stars.vertex[stars.twin[e]]
        else:
            return 0
        return 1 if not stars.still[v] and drop(patch, stars, v) else 0
    return -1


@inline
def _sine(xy, vertex, t):
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    return measures(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1])[1]


@inline
def _key(plane, front, t, goal):
    """The place in the queue: the squared sine of a sharp triangle; 1 and more where an edge is of wrong size."""
    xy, vertex = plane.xy, plane.vertex
    s = _sine(xy, vertex, t)
    if s < goal:
        return s
    a, b, c = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    h = wanted(front, (xy[a, 0] + xy[b, 0] + xy[c, 0]) / 3.0, (xy[a, 1] + xy[b, 1] + xy[c, 1]) / 3.0) * ROOT3
    most = 0.0
    for e in range(3 * t, 3 * t + 3):
        p, q = start_of(vertex, e), end_of(vertex, e)
        ux, uy = xy[q, 0] - xy[p, 0], xy[q, 1] - xy[p, 1]
        r = (ux * ux + uy * uy) / (h * h)
        if r > 0.0 and plane.mark[e] < 0:
            most = max(most, max(r, 1.0 / r))
    return 1.0 + 1.0 / most if most > 2.0 else inf


@inline
def _wake(plane, front, goal, t, queue, count):
    """Classify a triangle that has changed, and put it into the queue if it is sharp."""
    classify(plane, front, t)
    key = _key(plane, front, t, goal)
    if key < inf and count < len(queue[0]):
        return push(queue[0], queue[1], count, key, t)
    return count


@lean
def sharpen(plane, front, vertices, queue, patches, spots, goal, tally):
    """Treat the triangles whose squared sine is below ``goal``, at most ``limit`` trials in all.

    ``vertices`` are the arrays (still, at, name), ``queue`` (heap, what, place, stack); there must be room for
    eight vertices: it stops when less room is left.
    """
    still, name, row, spot, at, asked = vertices
    heap, what, place, stack = queue
    (first, first_stars), (work, work_stars), (best, best_stars) = patches
    xy, vertex, state = plane.xy, plane.vertex, plane.state
    count, limit, sliding = np.int64(0), tally[15], len(spots) > 0
    for t in range(state[COUNT]):
        if plane.region[t] >= 0:
            s = _key(plane, front, np.int64(t), goal)
            if s < inf and count < len(heap):
                count = push(heap, what, count, s, np.int64(t))
    while count > 0 and tally[SPENT] < limit and state[VERTICES] + 8 < len(xy):
        least, seed = heap[0], what[0]
        count = pop(heap, what, count)
        if plane.region[seed] < 0 or vertex[3 * seed] == UNUSED or _key(plane, front, seed, goal) != least:
            continue
        gather(plane, (still, name, row, spot), place, seed, first, first_stars)
        slides = False
        for v in range(first.counters[POINTS]):
            h = wanted(front, first_stars.xy[v, 0], first_stars.xy[v, 1]) * ROOT3
            first.size[v] = h * h
            slides = slides or first.row[v] >= 0
        if sliding and not slides:
            continue
        bound = front.rule.accept * front.rule.accept / 3.0
        old, wrong = _judge(first, first_stars, bound)
        tally[TRIED] += 1
        top, top_wrong = old, wrong
        found = False
        outside = 0
        for kind in range(11):
            same(first, first_stars, work, work_stars)
            if _change(work, work_stars, kind, tally[3] > 0) <= 0:
                continue
            tally[SPENT] += 1
            if 0 < kind < 4:
                _settle(work, work_stars, spots, False)
            else:
                _legal(work, work_stars)
            _settle(work, work_stars, spots, True)
            _legal(work, work_stars)
            sine, bad = _judge(work, work_stars, bound)
            sharper = sine > top * GAIN and bad <= top_wrong
            fitter = bad < top_wrong and sine >= min(top, SHARP)
            if sharper or fitter:
                if outside_holds(plane, work, work_stars, stack) < 0:
                    continue
                top, top_wrong, found = sine, bad, True
                tally[4 + kind] += 1
                same(work, work_stars, best, best_stars)
                if top > goal and bad == 0:
                    break
        if top < goal or top_wrong > 0:
            for v in range(first.counters[POINTS]):
                asked[first.names[v]] = True
        if not found:
            continue
        tally[CHANGED] += 1
        depth = outside_holds(plane, best, best_stars, stack)
        put_back(plane, best, best_stars, still, spot, spots)
        for k in range(best.counters[2]):
            if best.segment[k] < 0:
                stack[depth] = best.outer[k]
                depth += 1
        legalize(xy, vertex, plane.twin, plane.mark, plane.where, at, stack, np.int64(depth))
        for t in range(best.counters[CELLS]):
            if best.live[t] >= 0:
                count = _wake(plane, front, goal, np.int64(best.slots[t]), (heap, what), count)
        for k in range(best.counters[2]):
            if best.segment[k] < 0:
                count = _wake(plane, front, goal, np.int64(best.outer[k] // 3), (heap, what), count)
