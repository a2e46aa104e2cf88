"""Where an advancing front puts its next point: plain versions of the rules in section 12.3.2.

AB is an edge of the front, with what is not meshed on its left; P comes before A and N after B on the front;
h is the wanted length of edges. Book: 3.2.
"""

from __future__ import annotations

from collections.abc import Callable
from math import atan2, cos, hypot, pi, sin, sqrt

from ..base.errors import InputError
from .predicates import in_sphere

Point = tuple[float, float]

__all__ = ["ahead", "angle_at", "by_angle", "equal_sides", "on_circle", "parts", "toward"]


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


def ahead(
    a: Point, b: Point, c: Point, h: float, rule: Callable[..., Point] = equal_sides
) -> tuple[str, Point]:
    """Steps 1 to 3 of a front with the triangle ABC ahead of AB: what it takes."""
    u, v, x, y = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    length = hypot(u, v)
    p, along, high = length / 2, (u * x + v * y) / length, (u * y - v * x) / length
    # the circumcenter of ABC lies q above the middle of AB
    q = ((along - p) ** 2 + high**2 - p**2) / (2 * high)
    if hypot(p, q) < 1.2 * h / sqrt(3):
        return "small enough", c
    wish = rule(a, b, h)
    d = hypot(wish[0] - (a[0] + b[0]) / 2, wish[1] - (a[1] + b[1]) / 2)
    wish = toward(a, b, min(d, max(q, p / 2)))  # moved back, but not forward
    if in_sphere([a, b, c], wish) <= 0:
        return "empty circle", c
    side = min(max(h, 0.55 * length), 2 * length)
    if hypot(wish[0] - c[0], wish[1] - c[1]) < 0.8 * min(h, side):
        return "near apex", c
    return "new point", wish
