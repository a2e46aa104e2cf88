"""The angle rule at the edges of a front in space, told plainly (section 3.5 of the book).

Two faces of the front with a common edge have an angle t between them, ahead, where nothing is meshed. With k
cells around the edge each has the dihedral angle t / k there. In a regular tetrahedron it is
b = arccos(1/3) = 70.53 degrees: the height sqrt(2/3) a stands over the center of the opposite face, which is
a / sqrt(12) away from the edges, so that tan b = sqrt(2/3) sqrt(12) = 2 sqrt(2), and cos b = 1/3.

*When k + 1 cells are better than k.* The parts t / k are too large and the parts t / (k + 1) too small by the
same angle, t / k - b = b - t / (k + 1), if t (2 k + 1) = 2 b k (k + 1). So the rule changes at

    t = 2 b k (k + 1) / (2 k + 1), the harmonic mean of k b and (k + 1) b:

94.0, 169.3, 241.8 and 313.5 degrees, where the plane has 80, 144, 205.7 and 266.7 (b = 60). Up to 94 degrees
the two faces are connected, to one cell; up to 169 degrees their angle is halved. In the plane six regular
triangles fill the angle around a vertex. Five regular tetrahedra leave 7.4 degrees around an edge, so that
there is no mesh of regular tetrahedra. Source: the source chapter, 12.3.2.
"""

from __future__ import annotations

from math import acos, atan2, cos, degrees, radians, sin, sqrt

from unstruct.base.errors import InputError
from unstruct.plain.advancing_front_space import FrontInSpace, Size
from unstruct.plain.space_places import Face, Place, away, minus

__all__ = ["angle_ahead", "cells_around", "changes_at", "point_by_angle"]

REGULAR_ANGLE = degrees(acos(1 / 3))


def cells_around(angle: float, best: float = REGULAR_ANGLE) -> int:
    """The number k of cells around an edge for which angle / k is the nearest to the best; fewer if equal."""
    if not 0 < angle <= 360:
        raise InputError(f"angle must be above 0 and at most 360 degrees, not {angle!r}")
    return min(range(1, 361), key=lambda k: (abs(angle / k - best), k))


def changes_at(k: int, best: float = REGULAR_ANGLE) -> float:
    """The angle at which k and k + 1 cells are as good as each other, in degrees."""
    return 2 * best * k * (k + 1) / (2 * k + 1)


def angle_ahead(front: FrontInSpace, face: Face, corner: int) -> tuple[float, int]:
    """The angle between a face and the next one at the edge opposite a corner, and the third vertex of that.

    The next one is met first if the face is turned ahead about the edge: the angle is in degrees, above 0 and
    at most 360, and 360 at the edge of an inner facet that ends.
    """
    a, b, c = face[(corner + 1) % 3], face[(corner + 2) % 3], face[corner]
    others = [one for one in front.faces if {a, b} <= set(one) and one in turned(one, b, a)]
    found = []
    for one in others:
        (v,) = set(one) - {a, b}
        found.append((360.0 if v == c else turn_about(front, a, b, c, v), v))
    return min(found)


def turned(face: Face, u: int, v: int) -> tuple[Face, ...]:
    """The face if it has the directed edge uv, else nothing."""
    i = face.index(u)
    return (face,) if face[(i + 1) % 3] == v else ()


def turn_about(front: FrontInSpace, a: int, b: int, c: int, v: int) -> float:
    """The angle by which the half-plane of ab and c is turned ahead of abc until it holds v, in degrees."""
    _, side, ahead = frame(front, a, b, c)
    w = minus(front.points[v], front.points[a])
    x, y = (sum(p * q for p, q in zip(w, axis)) for axis in (side, ahead))
    return degrees(atan2(y, x)) % 360.0 or 360.0


def frame(front: FrontInSpace, a: int, b: int, c: int) -> tuple[Place, Place, Place]:
    """Unit vectors along ab, from ab to c at right angles, and ahead of abc."""
    u, w = minus(front.points[b], front.points[a]), minus(front.points[c], front.points[a])
    along = unit(u)
    part = sum(p * q for p, q in zip(w, along))
    side = unit(tuple(p - part * q for p, q in zip(w, along)))
    return along, side, cross(along, side)


def point_by_angle(front: FrontInSpace, face: Face, size: Size) -> tuple[Place | None, int | None]:
    """The ideal point of a face by the least of the angles at its edges, or the vertex to be connected.

    With k cells it lies in the first of the half-planes that divide the angle, at the wanted distance from
    the ends of the edge. If more than two are best, the edge has room, and the other rule is as good: both
    are None.
    """
    (angle, v), corner = min((angle_ahead(front, face, i), i) for i in range(3))
    k = cells_around(angle)
    if k == 1:
        return None, v
    if k > 2:
        return None, None
    a, b, c = face[(corner + 1) % 3], face[(corner + 2) % 3], face[corner]
    _, side, ahead = frame(front, a, b, c)
    p, q = front.points[a], front.points[b]
    m = tuple(0.5 * (x + y) for x, y in zip(p, q))
    half, h = 0.5 * away(p, q), size(m)
    reach, t = sqrt(max(h * h - half * half, 0.25 * half * half)), radians(angle / 2)
    x = tuple(o + reach * (cos(t) * s + sin(t) * n) for o, s, n in zip(m, side, ahead))
    return x, None


def unit(v: Place) -> Place:
    """The vector of length 1 in the same direction."""
    length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return v[0] / length, v[1] / length, v[2] / length


def cross(u: Place, v: Place) -> Place:
    """The vector product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
