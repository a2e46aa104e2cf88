"""New vertices of an intrinsic triangulation, in triangles and on edges, and where they lie on the surface.

The place of a new vertex is found by following the line to it from a corner; the direction in which the line
arrives gives the directions of all edges at the new vertex. Its directions are angles in the frame of the
given face in which it lies.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import angle_of
from ...base.jit import inline, lean
from .gluing import next_side, previous_side
from .lengths import Sides, corner_angle, four_areas
from .tracing import Ground, Line, follow, frame_of

__all__ = ["Places", "Shape", "line_start", "split_side", "split_triangle"]


class Places(NamedTuple):
    """Where the vertices lie; arrays may be longer than what is in use.

    Attributes
    ----------
    origin : (v,) int32
        The given vertex, -1 for a new one.
    face : (v,) int32
        A given face in which it lies; -1 for given vertices.
    weights : (v, 3) float64
        The weights of the corners of this face.
    side : (v,) int32
        The given half-edge that a vertex on a kept edge lies on, -1 otherwise.
    at : (v,) float64
        Where on it, from 0 to 1.
    """

    origin: NDArray[np.int32]
    face: NDArray[np.int32]
    weights: NDArray[np.float64]
    side: NDArray[np.int32]
    at: NDArray[np.float64]


class Shape(NamedTuple):
    """Everything that an insertion needs; ``numbers`` holds how many triangles and vertices are in use."""

    sides: Sides
    places: Places
    ground: Ground
    line: Line
    numbers: NDArray[np.int64]


@inline
def line_start(places, v):
    """How `follow` names a vertex: itself if it is given, -1 minus its face if it is new."""
    return v if places.face[v] < 0 else -1 - places.face[v]


@inline
def _moved(h, old, new, second, third):
    """The new slot of a half-edge of which two may have been moved."""
    return new if h == old else (third if h == second else h)


@inline
def _connect(sides, h, g):
    sides.twin[h] = g
    if g >= 0:
        sides.twin[g] = h


@inline
def _copy(sides, source, target):
    sides.vertex[target], sides.turn[target] = sides.vertex[source], sides.turn[source]
    sides.length[target], sides.under[target] = sides.length[source], sides.under[source]


@inline
def _spoke(sides, out, back, v, p, length):
    """The two halves of a new edge from v to p."""
    sides.vertex[out], sides.vertex[back] = v, p
    sides.length[out] = sides.length[back] = length
    sides.under[out] = sides.under[back] = -1
    _connect(sides, out, back)


@inline
def _child(sides, t, m):
    """Triangle m becomes a part of triangle t."""
    sides.label[m] = sides.label[t]


@inline
def _contents(sides, t):
    sides.content[t] = four_areas(sides.length[3 * t], sides.length[3 * t + 1], sides.length[3 * t + 2])


@inline
def _angle(sides, h):
    """The angle of its triangle where a half-edge begins."""
    p = previous_side(h)
    return corner_angle(sides.length[h], sides.length[p], sides.length[next_side(h)], sides.content[h // 3])


@inline
def _settle(shape, p, face, side, at):
    """Note where a new vertex lies, as it is written in the line."""
    places, line = shape.places, shape.line
    places.origin[p], places.face[p], places.side[p], places.at[p] = -1, face, side, at
    for k in range(3):
        places.weights[p, k] = line.end[k]
    shape.numbers[1] += 1


@lean
def split_triangle(shape, t, one, two):
    """Put a vertex into a triangle, at these weights of corners 1 and 2; its number, -1 without room.

    ::

               c              Triangle t becomes a b p; the two triangles after the last
              /|\\            one in use become b c p and c a p.
             / p \\
            a-----b
    """
    sides, places, count = shape.sides, shape.places, shape.numbers
    h0, h1, h2 = 3 * t, 3 * t + 1, 3 * t + 2
    a, b, c = sides.vertex[h0], sides.vertex[h1], sides.vertex[h2]
    x1, x2, y2 = frame_of(sides, t)
    x, y = one * x1 + two * x2, two * y2
    to_a = np.sqrt(x * x + y * y)
    to_b = np.sqrt((x - x1) ** 2 + y * y)
    to_c = np.sqrt((x - x2) ** 2 + (y - y2) ** 2)
    # from the nearest corner, where rounding of the direction matters least
    k = 0 if to_a <= min(to_b, to_c) else (1 if to_b <= to_c else 2)
    near = min(to_a, min(to_b, to_c))
    left = corner_angle(sides.length[h0], to_a, to_b, four_areas(sides.length[h0], to_a, to_b))
    if k == 1:
        left = corner_angle(sides.length[h1], to_b, to_c, four_areas(sides.length[h1], to_b, to_c))
    elif k == 2:
        left = corner_angle(sides.length[h2], to_c, to_a, four_areas(sides.length[h2], to_c, to_a))
    v = sides.vertex[3 * t + k]
    start, angle = line_start(places, v), sides.turn[3 * t + k] + left
    face, crossed = follow(shape.ground, start, places.weights[v], angle, near, shape.line, False)
    if crossed < 0:
        return -1
    m, p = count[0], count[1]
    count[0] += 2
    n0, n1 = 3 * m, 3 * m + 3
    _child(sides, t, m)
    _child(sides, t, m + 1)
    beyond_1, beyond_2 = sides.twin[h1], sides.twin[h2]
    turn_1, turn_2 = sides.turn[h1], sides.turn[h2]
    _copy(sides, h1, n0)
    _copy(sides, h2, n1)
    _connect(sides, n0, _moved(beyond_1, h1, n0, h2, n1))
    _connect(sides, n1, _moved(beyond_2, h1, n0, h2, n1))
    _spoke(sides, h1, n0 + 2, b, p, to_b)
    _spoke(sides, n0 + 1, n1 + 2, c, p, to_c)
    _spoke(sides, n1 + 1, h2, a, p, to_a)
    _contents(sides, t)
    _contents(sides, m)
    _contents(sides, m + 1)
    sides.turn[n1 + 1] = sides.turn[h0] + _angle(sides, h0)
    sides.turn[h1] = turn_1 + _angle(sides, n0)
    sides.turn[n0 + 1] = turn_2 + _angle(sides, n1)
    back = h2 if k == 0 else (n0 + 2 if k == 1 else n1 + 2)
    _fan(sides, back, shape.line.end[3] + np.pi)
    _settle(shape, p, face, -1, 0.0)
    return p


@lean
def _fan(sides, h, angle):
    """Write the directions at a new vertex, counterclockwise from half-edge h on."""
    g = h
    while True:
        sides.turn[g] = angle
        angle += _angle(sides, g)
        g = sides.twin[previous_side(g)]
        if g < 0 or g == h:
            break


@inline
def _along(places, v, s, given):
    """Where a vertex lies on given half-edge s, from 0 to 1; ``given`` for its ends."""
    if places.face[v] < 0:
        return given
    return places.at[v] if places.side[v] == s else 1.0 - places.at[v]


@lean
def _on_kept(shape, h, part):
    """Write the place of a point on a half-edge along a given one to the line; its parameter there."""
    sides, places, base = shape.sides, shape.places, shape.ground.sides
    s = sides.under[h]
    first = _along(places, sides.vertex[h], s, 0.0)
    at = first + part * (_along(places, sides.vertex[next_side(h)], s, 1.0) - first)
    k = s % 3
    end = shape.line.end
    end[0] = end[1] = end[2] = 0.0
    end[k], end[(k + 1) % 3] = 1.0 - at, at
    x1, x2, y2 = frame_of(base, s // 3)
    end[3] = 0.0 if k == 0 else (angle_of(y2, x2 - x1) if k == 1 else angle_of(-y2, -x2))
    return at


@lean
def split_side(shape, h, part):
    """Put a vertex on an edge whose two triangles differ; the vertex, -1 without room in the line.

    ::

             c            h runs from a to b. The triangles a p c and b p d stay; p b c and p a d are new,
           / | \\         d p b only if there is a triangle on the right.
          a--p--b
           \\ | /
             d
    """
    sides, places, count = shape.sides, shape.places, shape.numbers
    g = sides.twin[h]
    a, side, at = sides.vertex[h], sides.under[h], 0.0
    whole = sides.length[h]
    if side >= 0:
        at = _on_kept(shape, h, part)
        face = side // 3
    else:
        start = line_start(places, a)
        face, crossed = follow(
            shape.ground, start, places.weights[a], sides.turn[h], part * whole, shape.line, False
        )
        if crossed < 0:
            return -1
    m, p = count[0], count[1]
    count[0] += 2 if g >= 0 else 1
    h1, n = next_side(h), 3 * m
    _child(sides, h // 3, m)
    if g >= 0:
        _child(sides, g // 3, m + 1)
    g1, n2 = (next_side(g), n + 3) if g >= 0 else (-2, -2)
    beyond_h, beyond_g = sides.twin[h1], sides.twin[g1] if g >= 0 else -1
    square = _foot(sides, h, part)
    low = _foot(sides, g, 1.0 - part) if g >= 0 else 0.0
    _copy(sides, h1, n + 1)
    if g >= 0:
        _copy(sides, g1, n2 + 1)
        _connect(sides, n2 + 1, _moved(beyond_g, g1, n2 + 1, h1, n + 1))
    _connect(sides, n + 1, _moved(beyond_h, g1, n2 + 1, h1, n + 1))
    _spoke(sides, n + 2, h1, sides.vertex[previous_side(h)], p, square)
    sides.vertex[n], sides.length[n], sides.under[n] = p, (1.0 - part) * whole, side
    sides.length[h] = part * whole
    _connect(sides, n, g)
    sides.twin[h] = -1
    if g >= 0:
        _spoke(sides, n2 + 2, g1, sides.vertex[previous_side(g)], p, low)
        sides.vertex[n2], sides.length[n2], sides.under[n2] = p, part * whole, sides.under[g]
        sides.length[g] = (1.0 - part) * whole
        _connect(sides, h, n2)
        _contents(sides, g // 3)
        _contents(sides, m + 1)
        sides.turn[n2 + 2] = sides.turn[previous_side(g)] + _angle(sides, previous_side(g))
    _contents(sides, h // 3)
    _contents(sides, m)
    sides.turn[n + 2] = sides.turn[previous_side(h)] + _angle(sides, previous_side(h))
    _fan(sides, n, shape.line.end[3])
    _settle(shape, p, face, side, at)
    return p


@inline
def _foot(sides, h, part):
    """The distance from a point on a side of a triangle to the opposite corner."""
    base, bc, ca = sides.length[h], sides.length[next_side(h)], sides.length[previous_side(h)]
    x = (base * base + (ca - bc) * (ca + bc)) / (2.0 * base) - part * base
    y = sides.content[h // 3] / (2.0 * base)
    return np.sqrt(x * x + y * y)
