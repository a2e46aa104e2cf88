"""Where an advancing front puts its next point: plain versions of the rules in section 12.3.2.

AB is an edge of the front, with what is not meshed on its left; P comes before A and N after B on the front;
h is the wanted length of edges. Book: 3.2.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin, sqrt

from ..base.errors import InputError

Point = tuple[float, float]

__all__ = ["angle_at", "by_angle", "equal_sides", "on_circle", "parts", "toward"]


def toward(a: Point, b: Point, distance: float) -> Point:
    """The point on the left of AB, so far from its middle, at right angles."""
    u, v = b[0] - a[0], b[1] - a[1]
    length = hypot(u, v)
    if length == 0.0:
        raise InputError(f"A and B are the same point, {a}")
    x, y = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2
    return x - distance * v / length, y + distance * u / length


def equal_sides(a: Point, b: Point, h: float) -> Point:
    """X with XA = XB = h, where h is kept between 0.55 and 2 times |AB|."""
    length = hypot(b[0] - a[0], b[1] - a[1])
    side = min(max(h, 0.55 * length), 2 * length)
    return toward(a, b, sqrt(side**2 - (length / 2) ** 2))


def on_circle(a: Point, b: Point, h: float) -> Point:
    """X such that the circle ABX has the radius h / sqrt(3), or the least one."""
    p = hypot(b[0] - a[0], b[1] - a[1]) / 2
    radius = max(h / sqrt(3), p)
    return toward(a, b, radius + sqrt(radius**2 - p**2))


def angle_at(before: Point, at: Point, after: Point) -> float:
    """The angle of what is not meshed between two edges, in radians, up to 2 pi."""
    ux, uy = after[0] - at[0], after[1] - at[1]
    vx, vy = before[0] - at[0], before[1] - at[1]
    angle = atan2(ux * vy - uy * vx, ux * vx + uy * vy)
    return angle if angle > 0 else angle + 2 * pi


def parts(angle: float) -> int:
    """The number of equal parts of an angle that are nearest to 60 degrees."""
    k = 1
    while angle / k - pi / 3 > pi / 3 - angle / (k + 1):
        k += 1
    return k


def by_angle(p: Point, a: Point, b: Point, n: Point, h: float) -> Point:
    """The angle rule at the end of AB with the smaller angle; or equal sides."""
    at_a, at_b = angle_at(p, a, b), angle_at(a, b, n)
    angle = min(at_a, at_b)
    k = parts(angle)
    if k == 1:
        return n if at_b <= at_a else p
    if k > 3:
        return equal_sides(a, b, h)
    length = hypot(b[0] - a[0], b[1] - a[1])
    side = min(max(h, 0.55 * length), 2 * length)
    start, end, turn = (b, a, -angle / k) if at_b <= at_a else (a, b, angle / k)
    u, v = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    return (
        start[0] + side * (u * cos(turn) - v * sin(turn)),
        start[1] + side * (u * sin(turn) + v * cos(turn)),
    )
