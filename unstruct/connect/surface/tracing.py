"""Straight lines on a surface of triangles, followed from face to face.

A face has a frame of its own: corner 0 in the origin, corner 1 on the positive x-axis, corner 2 above it.
Where the line leaves a face is decided by the corner that it passes on the left or on the right, so that it
always leaves, whatever rounding does; a line that meets a vertex up to rounding passes it on one side.

Source: N. Sharp, Y. Soliman and K. Crane, *Navigating intrinsic triangulations*, ACM Trans. Graphics 38
(2019).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import angle_of, cosine, sine
from ...base.jit import inline, lean
from .gluing import previous_side
from .lengths import Sides

__all__ = ["Ground", "Line", "follow", "frame_of", "heading"]


class Ground(NamedTuple):
    """The given surface, on which lines are followed.

    Attributes
    ----------
    sides : Sides
        Of the given triangles, with directions; never changed.
    first : (f,) int32
        The first half-edge of each given vertex, -1 for none; see `Gluing`.
    around : (f,) float64
        The whole angle at each given vertex.
    """

    sides: Sides
    first: NDArray[np.int32]
    around: NDArray[np.float64]


class Line(NamedTuple):
    """What `follow` writes: crossed half-edges and where on them, from 0 to 1; and the end.

    ``end`` holds six numbers: the weights of the last point in its face, the angle of the line in the frame
    of this face, the length that was left when it ended at a wall, and the half-edge ahead.
    """

    side: NDArray[np.int32]
    at: NDArray[np.float64]
    end: NDArray[np.float64]


@inline
def frame_of(sides, f):
    """(x1, x2, y2): the corners of a face in its frame are (0, 0), (x1, 0), (x2, y2)."""
    a, b, c = sides.length[3 * f], sides.length[3 * f + 1], sides.length[3 * f + 2]
    return a, (a * a + (c - b) * (c + b)) / (2.0 * a), sides.content[f] / (2.0 * a)


@inline
def heading(ground, v, angle):
    """(half-edge, rest): the corner of a given vertex that holds a direction, and its angle from there."""
    whole = ground.around[v]
    if angle >= whole or angle < 0.0:
        angle -= np.floor(angle / whole) * whole
    h = ground.first[v]
    while True:
        g = ground.sides.twin[previous_side(h)]
        if g < 0 or g == ground.first[v] or ground.sides.turn[g] > angle:
            return h, angle - ground.sides.turn[h]
        h = g


@inline
def _corner(k, x1, x2, y2):
    return (0.0 if k == 0 else (x1 if k == 1 else x2)), (y2 if k == 2 else 0.0)


@lean
def _exit(x, y, dx, dy, k, frame):
    """(step, place): where a line meets side k of the frame, in units of its direction and on the side."""
    x1, x2, y2 = frame
    ax, ay = _corner(k, x1, x2, y2)
    bx, by = _corner((k + 1) % 3, x1, x2, y2)
    ex, ey = bx - ax, by - ay
    across = dx * ey - dy * ex
    if across <= 0.0:  # along the side, up to rounding
        return 0.0, 0.0 if dx * ex + dy * ey < 0.0 else 1.0
    step = max(((ax - x) * ey - (ay - y) * ex) / across, 0.0)
    # along the side a quotient of rounding errors: the place must be that of the step, whatever it is
    place = ((x + step * dx - ax) * ex + (y + step * dy - ay) * ey) / (ex * ex + ey * ey)
    return step, min(max(place, 0.0), 1.0)


@lean
def _side_ahead(x, y, dx, dy, entry, frame):
    """The side through which a line leaves; ``entry`` is that through which it came, -1 for none."""
    x1, x2, y2 = frame
    if entry >= 0:
        k = (entry + 2) % 3  # the corner opposite the entry
        cx, cy = _corner(k, x1, x2, y2)
        return (entry + 1) % 3 if dx * (cy - y) - dy * (cx - x) > 0.0 else k
    best, found = np.inf, 0
    for k in range(3):
        ax, ay = _corner(k, x1, x2, y2)
        bx, by = _corner((k + 1) % 3, x1, x2, y2)
        ex, ey = bx - ax, by - ay
        across = dx * ey - dy * ex
        if across > 0.0:
            step = ((ax - x) * ey - (ay - y) * ex) / across
            if step < best:
                best, found = step, k
    return found


@lean
def follow(ground, start, weights, angle, length, line, walls):
    """Follow a line from a vertex or a point of a face; (face at the end, sides crossed or -1).

    Parameters
    ----------
    start : int
        A given vertex v as v, a face f as -1 - f.
    weights : (3,) float64
        In that face; not used for a vertex.
    angle : float
        At a vertex its direction by signposts, in a face that in its frame.
    walls : bool
        Whether the line ends at edges that are kept, too.
    """
    sides = ground.sides
    count = 0
    if start >= 0:
        h, rest = heading(ground, start, angle)
        f, k = h // 3, h % 3
        frame = frame_of(sides, f)
        x, y = _corner(k, frame[0], frame[1], frame[2])
        bx, by = _corner((k + 1) % 3, frame[0], frame[1], frame[2])
        ex, ey = (bx - x) / sides.length[h], (by - y) / sides.length[h]
        c, s = cosine(rest), sine(rest)
        dx, dy = ex * c - ey * s, ex * s + ey * c
        ahead = (k + 1) % 3
    else:
        f = -1 - start
        frame = frame_of(sides, f)
        x = weights[1] * frame[0] + weights[2] * frame[1]
        y = weights[2] * frame[2]
        dx, dy = cosine(angle), sine(angle)
        ahead = _side_ahead(x, y, dx, dy, -1, frame)
    left = length
    while True:
        step, place = _exit(x, y, dx, dy, ahead, frame)
        h = 3 * f + ahead
        g = sides.twin[h]
        if left <= step or g < 0 or (walls and sides.under[h] >= 0):
            go = min(left, step)
            _finish(x + go * dx, y + go * dy, dx, dy, frame, line)
            line.end[4], line.end[5] = left - go, h
            return f, count
        if count == line.side.shape[0]:
            return f, -1
        line.side[count], line.at[count] = h, place
        count += 1
        left -= step
        ax, ay = _corner(ahead, frame[0], frame[1], frame[2])
        bx, by = _corner((ahead + 1) % 3, frame[0], frame[1], frame[2])
        ex, ey = (bx - ax) / sides.length[h], (by - ay) / sides.length[h]
        along, across = dx * ex + dy * ey, max(dx * ey - dy * ex, 0.0)
        f, entry = g // 3, g % 3
        frame = frame_of(sides, f)
        ax, ay = _corner(entry, frame[0], frame[1], frame[2])
        bx, by = _corner((entry + 1) % 3, frame[0], frame[1], frame[2])
        ex, ey = (bx - ax) / sides.length[g], (by - ay) / sides.length[g]
        x, y = bx + place * (ax - bx), by + place * (ay - by)
        # the twin runs the other way: to the left of it lies what was to the right of the side
        dx, dy = -along * ex - across * ey, -along * ey + across * ex
        size = np.sqrt(dx * dx + dy * dy)
        dx, dy = dx / size, dy / size
        ahead = _side_ahead(x, y, dx, dy, entry, frame)


@inline
def _finish(x, y, dx, dy, frame, line):
    """Write the weights of the end, which are made positive, and the angle of the line."""
    x1, x2, y2 = frame
    c = min(max(y / y2, 0.0), 1.0)
    b = min(max((x - c * x2) / x1, 0.0), 1.0 - c)
    line.end[0], line.end[1], line.end[2] = 1.0 - b - c, b, c
    line.end[3] = angle_of(dy, dx)
    line.end[4] = line.end[5] = 0.0
