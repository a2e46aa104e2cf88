"""Segments, triangles and rays in space in rational arithmetic: what the tests compare kernels with.

Nothing of the library is used. Everything follows from one dot product, one cross product, and clipping of
a segment's parameter at half-spaces.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import count
from random import Random

__all__ = ["cross", "dot", "in_triangle", "minus", "on_segment", "parity", "rational", "share_in_triangle"]

Vector = tuple[Fraction, ...]


def rational(row) -> Vector:
    return tuple(map(Fraction, row))


def minus(a: Vector, b: Vector) -> Vector:
    return tuple(x - y for x, y in zip(a, b))


def dot(a: Vector, b: Vector) -> Fraction:
    return sum((x * y for x, y in zip(a, b)), Fraction(0))


def cross(a: Vector, b: Vector) -> Vector:
    return tuple(a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3))


def share_in_triangle(p: Vector, q: Vector, a: Vector, b: Vector, c: Vector):
    """The interval of r for which p + r (q - p), 0 <= r <= 1, is in the closed triangle; None if empty."""
    normal = cross(minus(b, a), minus(c, a))
    limits = [(normal, a), (tuple(-x for x in normal), a)]
    limits += [(cross(normal, minus(v, u)), u) for u, v in ((a, b), (b, c), (c, a))]
    low, high = Fraction(0), Fraction(1)
    for inward, start in limits:  # each says: inward . (x - start) >= 0
        at, per = dot(inward, minus(p, start)), dot(inward, minus(q, p))
        if per == 0:
            if at < 0:
                return None
        elif per > 0:
            low = max(low, -at / per)
        else:
            high = min(high, -at / per)
    return (low, high) if low <= high else None


def in_triangle(x: Vector, a: Vector, b: Vector, c: Vector) -> str:
    """ "" outside, "inside", "edge" or "vertex": where x is in the closed triangle."""
    if share_in_triangle(x, x, a, b, c) is None:
        return ""
    if x in (a, b, c):
        return "vertex"
    return "edge" if any(on_segment(x, u, v) for u, v in ((a, b), (b, c), (c, a))) else "inside"


def on_segment(x: Vector, u: Vector, v: Vector) -> bool:
    """Whether x lies between u and v, and is neither."""
    return not any(cross(minus(v, u), minus(x, u))) and dot(minus(u, x), minus(v, x)) < 0


def parity(x: Vector, triangles: list[tuple[Vector, Vector, Vector]]) -> bool:
    """Whether a ray from x, which is on none of the triangles, meets an odd number of them.

    Its direction is drawn again until the ray meets no edge and lies in no plane.
    """
    random = Random(0)
    for _ in count():
        d = tuple(Fraction(random.randint(-(10**6), 10**6)) for _ in range(3))
        odd, general = False, True
        for a, b, c in triangles:
            normal = cross(minus(b, a), minus(c, a))
            along, above = dot(normal, d), dot(normal, minus(a, x))
            sides = [dot(d, cross(minus(u, x), minus(v, x))) for u, v in ((a, b), (b, c), (c, a))]
            if above == 0:  # the ray leaves the plane at once, and x is not on the triangle
                general = general and along != 0
            elif along == 0 or 0 in sides:
                general = False
            elif (min(sides) > 0 or max(sides) < 0) and above / along > 0:
                odd = not odd
        if general:
            return odd
    raise AssertionError
