"""Where an advancing front wants its next point, compiled.

AB is an edge of the front, what is unfinished on its left, and h the wanted length at the center of the
equilateral triangle on AB. Three rules are built in:

- *equal sides*: XA = XB = h, with h kept between 0.55 and 2 times |AB|. X lies on the line through the
  circumcenter of AB, its middle, at right angles to it;
- *angle*: the smaller of the two angles of what is unfinished, at A and at B, is divided into the number of
  equal parts that are nearest to 60 degrees. For one part the front is closed there;
- *circle*: the circle through A, B and X has the radius h / sqrt(3), as in Voronoi-segment insertion.

Book: 3.2.
"""

from __future__ import annotations

from math import atan2, cos, inf, pi, sin, sqrt

from ...base.jit import inline
from ...connect.insertion.halfedges import end_of, next_edge, prev_edge, start_of
from ...sizing.table import ROOT3
from ..rebay.steps import wanted

__all__ = ["AS_ASKED", "AT_ANGLE", "EQUAL_SIDES", "ON_CIRCLE", "ideal"]

EQUAL_SIDES, AT_ANGLE, ON_CIRCLE, AS_ASKED = range(4)
SHORTEST_SIDE, LONGEST_SIDE = (
    0.55,
    2.0,
)  # times |AB|: the shortest and the longest sides of the ideal triangle
# The number of equal angles nearest to 60 degrees changes from k to k + 1 at 120 k (k + 1) / (2 k + 1).
CONNECTS, BISECTS, TRISECTS = 80 * pi / 180, 144 * pi / 180, 1440 / 7 * pi / 180


@inline
def turned(plane, e, forward):
    """The next edge of the front at the end of e (or the last one at its start), and the angle between them.

    The angle is that of what is unfinished, between 0 and 2 pi.
    """
    xy, vertex, twin, mark = plane.xy, plane.vertex, plane.twin, plane.mark
    n = next_edge(e) if forward else prev_edge(e)
    while mark[n] < 0:
        n = next_edge(twin[n]) if forward else prev_edge(twin[n])
    a, b = start_of(vertex, e), end_of(vertex, e)
    if forward:
        at, one, two = b, end_of(vertex, n), a
    else:
        at, one, two = a, b, start_of(vertex, n)
    ux, uy = xy[one, 0] - xy[at, 0], xy[one, 1] - xy[at, 1]
    vx, vy = xy[two, 0] - xy[at, 0], xy[two, 1] - xy[at, 1]
    angle = atan2(ux * vy - uy * vx, ux * vx + uy * vy)
    return n, angle if angle > 0.0 else angle + 2.0 * pi


@inline
def by_angle(plane, e, side, x, y):
    """The ideal point by the angle rule, and 1 if the front should be closed there: (x, y, whether to close).

    The smaller of the two angles at the ends of AB is divided into the number of equal angles that are
    nearest to 60 degrees.
    """
    xy, vertex = plane.xy, plane.vertex
    a, b = start_of(vertex, e), end_of(vertex, e)
    after, at_b = turned(plane, e, True)
    before, at_a = turned(plane, e, False)
    angle = min(at_a, at_b)
    if angle < CONNECTS:
        other = end_of(vertex, after) if at_b <= at_a else start_of(vertex, before)
        return xy[other, 0], xy[other, 1], vertex[e] == other
    if angle >= TRISECTS:
        return x, y, False
    part = angle / 2.0 if angle < BISECTS else angle / 3.0
    if at_b <= at_a:  # from BA clockwise
        u, v, s, t = xy[a, 0] - xy[b, 0], xy[a, 1] - xy[b, 1], b, -part
    else:  # from AB counterclockwise
        u, v, s, t = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1], a, part
    length = sqrt(u * u + v * v)
    u, v = u / length, v / length
    return (
        xy[s, 0] + side * (u * cos(t) - v * sin(t)),
        xy[s, 1] + side * (u * sin(t) + v * cos(t)),
        False,
    )


@inline
def ideal(plane, march, e):
    """The ideal point for the front edge e: (x, y, f, side, whether the triangle ahead is the ideal one)."""
    xy, vertex, rule = plane.xy, plane.vertex, march.rule
    a, b, c = start_of(vertex, e), end_of(vertex, e), vertex[e]
    ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    mx, my = xy[a, 0] + ux / 2.0, xy[a, 1] + uy / 2.0
    length = sqrt(ux * ux + uy * uy)
    if length == 0.0:  # the square is below all doubles
        return mx, my, wanted(march, mx, my), 0.0, True
    nx, ny, p = -uy / length, ux / length, length / 2.0
    f = wanted(march, mx + nx * length / (2.0 * ROOT3), my + ny * length / (2.0 * ROOT3))
    side = min(max(ROOT3 * f, SHORTEST_SIDE * length), LONGEST_SIDE * length)
    if rule.constant == 0.0:  # once more, where the center of the wanted triangle is
        d = sqrt(side * side - p * p) / 3.0
        f = wanted(march, mx + nx * d, my + ny * d)
        side = min(max(ROOT3 * f, SHORTEST_SIDE * length), LONGEST_SIDE * length)
    wx, wy = xy[c, 0] - mx, xy[c, 1] - my
    high = wx * nx + wy * ny
    q = (wx * wx + wy * wy - p * p) / (2.0 * high) if high > 0.0 else inf
    if rule.placement == ON_CIRCLE:
        r = max(f, p)
        d = min(r + sqrt(max(r * r - p * p, 0.0)), max(q, p / 2.0))
    else:
        d = min(sqrt(side * side - p * p), max(q, p / 2.0))
    x, y = mx + d * nx, my + d * ny
    if rule.placement == AT_ANGLE:
        x, y, close = by_angle(plane, e, side, x, y)
        return x, y, f, side, close
    return x, y, f, side, False
