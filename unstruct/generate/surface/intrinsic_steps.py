"""Kernels of intrinsic Delaunay refinement: circumcenters of bad triangles, and kept edges in their way.

The circumcenter of a triangle is reached by a straight line along the surface. If the line meets an edge that
is kept, or the circumcenter lies in the diametral circle of one, that edge is halved instead.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import angle_of
from ...base.jit import inline, kernel, lean
from ...connect.surface.gluing import next_side, previous_side
from ...connect.surface.lengths import legalize
from ...connect.surface.points import split_side, split_triangle
from ...connect.surface.tracing import Ground, Line, follow, frame_of

__all__ = ["Bounds", "Queues", "halve_sides", "refine_triangles", "worst_triangles"]

FAULT_LARGE, FAULT_SHARP, LEFT_ALONE = 1, 2, 0
BESIDE_EDGE = 1e-6  # circumcenters that are as near to an edge, in units of heights, are put on it
LONGEST_LOOK = 256  # triangles whose circle holds a circumcenter that are looked at for kept edges
NO_ROOM, SKIPPED = -1, -2


class Bounds(NamedTuple):
    """What triangles must be like.

    Attributes
    ----------
    wanted : (v,) float64
        The edge length at each vertex.
    sine : float
        Twice the sine of the least angle; 0 for none.
    floor : float
        Triangles with a shorter circumradius, and kept edges not twice as long, are not divided for angles.
    sharp : (v,) bool
        Given vertices at which angles cannot be large: none of their corners counts.
    """

    wanted: NDArray[np.float64]
    sine: float
    floor: float
    sharp: NDArray[np.bool_]


class Queues(NamedTuple):
    """Scratch: the stack of edges to be examined, and lines on the intrinsic triangles."""

    queued: NDArray[np.bool_]
    stack: NDArray[np.int64]
    events: NDArray[np.int64]
    walk: NDArray[np.float64]
    line: Line


@inline
def _radius(sides, t):
    return sides.length[3 * t] * sides.length[3 * t + 1] * sides.length[3 * t + 2] / sides.content[t]


@lean
def _fault(sides, bounds, t):
    """(fault, circumradius) of a triangle."""
    radius = _radius(sides, t)
    least, size = np.inf, np.inf
    short = 3 * t
    for k in range(3):
        h = 3 * t + k
        size = min(size, bounds.wanted[sides.vertex[h]])
        if sides.length[h] < least:
            least, short = sides.length[h], h
    if radius > size * np.sqrt(0.5):
        return FAULT_LARGE, radius
    apex = sides.vertex[previous_side(short)]
    if least < bounds.sine * radius and radius > bounds.floor and not bounds.sharp[apex]:
        one, two = sides.under[next_side(short)], sides.under[previous_side(short)]
        if one < 0 or two < 0:  # between two kept edges the angle is given
            return FAULT_SHARP, radius
    return LEFT_ALONE, radius


@kernel
def worst_triangles(sides, bounds, many, rows, radii):
    """Write the triangles that are to be divided and their circumradii; how many."""
    count = 0
    for t in range(many):
        fault, radius = _fault(sides, bounds, t)
        if fault != LEFT_ALONE:
            rows[count], radii[count] = t, radius
            count += 1
    return count


@lean
def _settle_edges(sides, queues, p_side):
    """Flip edges around a new vertex until they are legal; ``p_side`` begins at it."""
    top = 0
    h = p_side
    while True:  # the sides opposite the vertex, counterclockwise, and back from the boundary
        top = _suspect(sides, queues, next_side(h), top)
        top = _suspect(sides, queues, h, top)
        top = _suspect(sides, queues, previous_side(h), top)
        h = sides.twin[previous_side(h)]
        if h < 0 or h == p_side:
            break
    if h < 0:
        h = p_side
        while sides.twin[h] >= 0:
            h = next_side(sides.twin[h])
            top = _suspect(sides, queues, next_side(h), top)
            top = _suspect(sides, queues, h, top)
    while top > 0:
        top, _, _ = legalize(sides, queues.queued, queues.stack, top, queues.events)


@inline
def _suspect(sides, queues, h, top):
    g = sides.twin[h]
    if g < 0 or sides.under[h] >= 0 or queues.queued[h] or queues.queued[g]:
        return top
    queues.queued[h] = True
    queues.stack[top] = h
    return top + 1


@lean
def _in_circle(ax, ay, bx, by, cx, cy):
    """Whether the origin lies inside the circle of counterclockwise a, b, c."""
    a, b, c = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    return a * (bx * cy - cx * by) + b * (cx * ay - ax * cy) + c * (ax * by - bx * ay) > 0.0


@lean
def _wall_near(sides, queues, t, one, two):
    """A kept edge whose diametral circle holds a point of triangle t, seen from there; -1 for none.

    Triangles whose circle holds the point are laid into its plane one after the other.
    """
    walk = queues.walk
    x1, x2, y2 = frame_of(sides, t)
    x, y = one * x1 + two * x2, two * y2
    ax, ay, bx, by, cx, cy = -x, -y, x1 - x, -y, x2 - x, y2 - y
    top = 0
    for k in range(3):
        walk[top, 0], walk[top, 1], walk[top, 2], walk[top, 3], walk[top, 4] = 3 * t + k, ax, ay, bx, by
        top += 1
        ax, ay, bx, by, cx, cy = bx, by, cx, cy, ax, ay
    seen = 0
    while top > 0 and seen < LONGEST_LOOK:
        top -= 1
        seen += 1
        h = int(walk[top, 0])
        ax, ay, bx, by = walk[top, 1], walk[top, 2], walk[top, 3], walk[top, 4]
        if sides.under[h] >= 0:
            if ax * bx + ay * by < 0.0:
                return h
            continue
        g = sides.twin[h]
        if g < 0:
            continue
        # the corner beyond, in the frame of the edge from b to a
        length, left, right = sides.length[g], sides.length[previous_side(g)], sides.length[next_side(g)]
        along = (length * length + (left - right) * (left + right)) / (2.0 * length)
        across = sides.content[g // 3] / (2.0 * length)
        ex, ey = (ax - bx) / length, (ay - by) / length
        cx, cy = bx + along * ex - across * ey, by + along * ey + across * ex
        if _in_circle(bx, by, ax, ay, cx, cy) and top + 2 < walk.shape[0]:
            walk[top, 0], walk[top, 1], walk[top, 2], walk[top, 3], walk[top, 4] = (
                next_side(g),
                ax,
                ay,
                cx,
                cy,
            )
            top += 1
            walk[top, 0], walk[top, 1] = previous_side(g), cx
            walk[top, 2], walk[top, 3], walk[top, 4] = cy, bx, by
            top += 1
    return -1


@lean
def _halve(shape, bounds, queues, h, forced):
    """Put a vertex in the middle of an edge; its number, NO_ROOM, or SKIPPED for edges that are too short."""
    sides = shape.sides
    if not forced and sides.under[h] >= 0 and sides.length[h] < 2.0 * bounds.floor:
        return SKIPPED
    g = sides.twin[h]
    if g >= 0 and g // 3 == h // 3:
        return SKIPPED
    a, b = sides.vertex[h], sides.vertex[next_side(h)]
    p = split_side(shape, h, 0.5)
    if p < 0:
        return NO_ROOM
    bounds.wanted[p] = 0.5 * (bounds.wanted[a] + bounds.wanted[b])
    bounds.sharp[p] = False
    _settle_edges(sides, queues, next_side(h))
    return p


@lean
def _toward_center(shape, bounds, queues, t):
    """Put a vertex at the circumcenter of a triangle, or on a kept edge; its number, NO_ROOM or SKIPPED."""
    sides, line = shape.sides, queues.line
    x1, x2, y2 = frame_of(sides, t)
    ca = sides.length[3 * t + 2]
    cx = x1 / 2.0
    cy = (ca * ca - x1 * x2) / (2.0 * y2)
    mx, my = (x1 + x2) / 3.0, y2 / 3.0
    dx, dy = cx - mx, cy - my
    away = np.sqrt(dx * dx + dy * dy)
    third = queues.walk[0]
    third[0] = third[1] = third[2] = 1.0 / 3.0
    ground = Ground(sides, shape.ground.first, shape.ground.around)  # from a face: only its sides are used
    face, crossed = follow(ground, -1 - t, third, angle_of(dy, dx), away, line, True)
    if crossed < 0:
        return NO_ROOM
    ahead = int(line.end[5])
    if line.end[4] > 0.0:
        return _halve(shape, bounds, queues, ahead, _fault(sides, bounds, t)[0] == FAULT_LARGE)
    zero, one, two = line.end[0], line.end[1], line.end[2]
    wall = _wall_near(sides, queues, face, one, two)
    if wall >= 0:
        return _halve(shape, bounds, queues, wall, False)
    least = min(zero, min(one, two))
    if least < BESIDE_EDGE:  # weight k is that of the corner opposite side k + 1
        k = 1 if zero == least else (2 if one == least else 0)
        h = 3 * face + k
        part = one if k == 0 else (two if k == 1 else zero)
        if part < BESIDE_EDGE or part > 1.0 - BESIDE_EDGE:
            return SKIPPED
        g = sides.twin[h]
        if sides.under[h] >= 0 or g < 0:
            return _halve(shape, bounds, queues, h, False)
        if g // 3 == face:
            return SKIPPED
        a, b = sides.vertex[h], sides.vertex[next_side(h)]
        p = split_side(shape, h, part)
        if p >= 0:
            bounds.wanted[p] = (1.0 - part) * bounds.wanted[a] + part * bounds.wanted[b]
            bounds.sharp[p] = False
            _settle_edges(sides, queues, next_side(h))
        return p if p >= 0 else NO_ROOM
    a, b, c = sides.vertex[3 * face], sides.vertex[3 * face + 1], sides.vertex[3 * face + 2]
    size = zero * bounds.wanted[a] + one * bounds.wanted[b] + two * bounds.wanted[c]
    p = split_triangle(shape, face, one, two)
    if p < 0:
        return NO_ROOM
    bounds.wanted[p] = size
    bounds.sharp[p] = False
    _settle_edges(sides, queues, 3 * face + 2)
    return p


@kernel
def refine_triangles(shape, bounds, queues, rows, first, tally):
    """Divide triangles that are still bad, from row ``first`` on; the row to go on with.

    It stops where there is no more room for triangles, vertices or crossings; ``tally`` counts new vertices
    and triangles that were skipped.
    """
    sides = shape.sides
    for i in range(first, rows.shape[0]):
        if shape.numbers[0] + 2 > sides.content.shape[0] or shape.numbers[1] + 1 > bounds.wanted.shape[0]:
            return i
        t = rows[i]
        if _fault(sides, bounds, t)[0] == LEFT_ALONE:
            continue
        p = _toward_center(shape, bounds, queues, t)
        if p == NO_ROOM:
            return i
        if p == SKIPPED:
            tally[1] += 1
        else:
            tally[0] += 1
    return rows.shape[0]


@kernel
def halve_sides(shape, bounds, queues, rows, first, tally):
    """Halve edges, from row ``first`` on; the row to go on with, as `refine_triangles`.

    Those of an edge that is gone by then are what is there instead.
    """
    for i in range(first, rows.shape[0]):
        if (
            shape.numbers[0] + 2 > shape.sides.content.shape[0]
            or shape.numbers[1] + 1 > bounds.wanted.shape[0]
        ):
            return i
        p = _halve(shape, bounds, queues, rows[i], True)
        if p == NO_ROOM:
            return i
        if p == SKIPPED:
            tally[1] += 1
        else:
            tally[0] += 1
    return rows.shape[0]
