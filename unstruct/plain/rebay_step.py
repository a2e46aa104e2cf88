"""One step of Rebay's insertion: where on the Voronoi segment the new point goes (section 2.6c).

::

                 C                 ABC   accepted, its circumcenter is E
               / | \\               ADB   not accepted, its circumcenter is F
              /  E  \\              M     midpoint of AB;  p = |AM|
             A---M---B             q     from M to F, positive on the side of D
              \\  X  /              X     the new point, at the distance d from M
               \\ F /               f     the wanted circumradius (wanted edge length over sqrt(3))
                 D

Then the same step as a map of the one number p / f, by which the shape of all later triangles can be
foretold. Source: S. Rebay, Journal of Computational Physics 106 (1993) 125-138. Equation numbers are those of
the book: (2.6c.1) for the radius and (2.6c.2) for the distance, which are (12.4) and (12.5) in the source
chapter; (2.6c.4) for the deviation, there (12.6).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, hypot, inf, pi, sqrt
from typing import Any

from unstruct.base.errors import InputError

__all__ = ["Step", "apex", "cap", "distance", "epsilon", "next_apex", "next_ratio", "radius", "step"]

Point = tuple[float, float]
IDEAL = 2 / sqrt(3)  # f / p of the equilateral triangle


@dataclass(frozen=True)
class Step:
    """What one step computes; the letters are those of the picture above."""

    middle: Point  # M
    center: Point  # F
    accepted_center: Point | None  # E; None where no accepted triangle was given
    p: float
    q: float
    radius: float  # of circle AXB, by (2.6c.1)
    distance: float  # from M to X
    point: Point | None  # X; None where F is not beyond M
    capped: bool  # the smaller one in (2.6c.1) was the radius of the circle through A, B and F
    beyond: bool  # (2.6c.2) led beyond F


def radius(f: float, p: float, q: float) -> float:
    """The radius (2.6c.1) of the circle AXB: f, not below p and not above the cap."""
    return min(max(f, p), cap(p, q))


def cap(p: float, q: float) -> float:
    """The radius of the circle through A, B and F."""
    return (p * p + q * q) / (2 * q)


def distance(r: float, p: float) -> float:
    """The distance (2.6c.2) from M of the farther point on the circle."""
    return r + sqrt(max(r * r - p * p, 0.0))


def step(
    a: Any, b: Any, d: Any, f: float, c: Any = None, *, clamp: bool = True
) -> Step:  # fmt: skip
    """The new point for the edge AB, the triangle ADB, and the wanted radius f.

    Parameters
    ----------
    a, b, d : two numbers each
        The edge and the far corner of the waiting triangle, on either side of AB.
    f : float
        The wanted circumradius, positive.
    c : two numbers, optional
        The far corner of the accepted triangle, needed only for its circumcenter.
    clamp : bool
        Stop at F. Without it X is at the distance d, for q < p beyond F.

    Raises
    ------
    InputError
        Where a triangle is flat or f is not positive.
    """
    if not 0 < f < inf:
        raise InputError(f"the wanted circumradius {f} must be positive and finite")
    middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    center = _circumcenter(a, b, d)
    p = hypot(b[0] - a[0], b[1] - a[1]) / 2
    normal = _normal(a, b, d)
    q = (center[0] - middle[0]) * normal[0] + (center[1] - middle[1]) * normal[1]
    accepted = None if c is None else _circumcenter(a, b, c)
    if q <= 0:
        return Step(middle, center, accepted, p, q, inf, 0.0, None, False, False)
    r = radius(f, p, q)
    far = distance(r, p)
    beyond, capped = far > q * (1 + 1e-12), max(f, p) > cap(p, q)
    way = q if clamp and (capped or beyond) else far
    x = (middle[0] + way * normal[0], middle[1] + way * normal[1])
    return Step(middle, center, accepted, p, q, r, way, x, capped, beyond)


def _normal(a: Any, b: Any, d: Any) -> Point:
    """The unit normal of AB on the side of D."""
    x, y = b[0] - a[0], b[1] - a[1]
    side = x * (d[1] - a[1]) - y * (d[0] - a[0])
    length = hypot(x, y) if side > 0 else -hypot(x, y)
    return (-y / length, x / length)


def _circumcenter(a: Any, b: Any, c: Any) -> Point:
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    twice = 2 * (ux * vy - uy * vx)
    if twice == 0:
        raise InputError(f"the triangle {a}, {b}, {c} is flat and has no circumcenter")
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    return (a[0] + (u * vy - v * uy) / twice, a[1] + (ux * v - vx * u) / twice)


# ---- the map of x = p / f, for edges on which the cap is not active ---------------------------------


def next_ratio(x: float, growth: float = 1.0) -> float:
    """p / f of the new edges AX and XB from that of AB, where f is ``growth`` times larger there.

    From (2.6c.1), (2.6c.2) and |AX|^2 = p^2 + d^2, without the cap: the far triangle is large.
    """
    if not (x > 0 and growth > 0):
        raise InputError(f"p / f = {x} and the growth {growth} must be positive")
    return hypot(x, distance(max(1.0, x), x)) / (2 * growth)


def apex(x: float) -> float:
    """The angle AXB of the new triangle for x = p / f, in radians: p = f sin(AXB) up to the right angle."""
    return asin(min(x, 1.0))


def next_apex(a: float) -> float:
    """The law of the apex for constant f: the next triangle stands on AX = 2 f sin(pi/2 - a/2)."""
    return pi / 2 - a / 2


def epsilon(p: float, f: float) -> float:
    """The deviation (2.6c.4) of an edge of half length p from the ideal one: f / p - 2 / sqrt(3)."""
    return f / p - IDEAL
