"""When a vertex encroaches on a subsegment, and where a subsegment is split; compiled.

A vertex *encroaches* on a subsegment that it sees under too large an angle. In Ruppert's rule this is more
than a right angle (the diametral disc), in Chew's rule more than 180 degrees minus twice the minimum angle
(the lens).

Where two pieces meet at a small angle, a point put on one encroaches on the other, and so on for ever. The
common end is called an *apex*. A subsegment that ends there is split at a distance from it that is a power of
two (Ruppert's concentric shells). Then both pieces are cut at equal distances, and points at equal distances
do not encroach on each other. What is left is a short edge across the wedge, between two points of one shell.
If this is the shortest edge of a triangle, a better angle would need a shorter edge, and so on for ever;
such a triangle is left alone, unless it is sharper than the angle of the input. Then it may be refined, as
long as this makes no edge shorter than the one across the wedge.

Sources: J. Ruppert, Journal of Algorithms 18 (1995) 548-585; L. P. Chew, Symposium on Computational Geometry
(1993) 274-280; J. R. Shewchuk, Computational Geometry 22 (2002) 21-74; G. L. Miller, S. E. Pav, N. J.
Walkington, When and why Ruppert's algorithm works (International Meshing Roundtable, 2003).
"""

from __future__ import annotations

import math

from ...base.elementary import arcsine, cosine, sine
from ...base.jit import inline

STRAIGHT, ARC, OTHER = 0, 1, 2  # kinds of pieces
FIRST, SECOND = 1, 2  # bits: which end of a subsegment is the apex of a small angle
NEEDLE = 1e-3  # a squared sine: triangles with an angle below 1.8 degrees
SAME_ANGLE = 0.998  # the quotient of squared sines of two angles that differ by a thousandth
# Kinds of vertices. The kind of another vertex is the number of the piece that it lies on.
FREE_VERTEX, INPUT_VERTEX, REMOVED_VERTEX = -1, -2, -3


@inline
def encroaches(ax, ay, bx, by, px, py, lens):
    """Whether p sees a-b under an angle that is too large; ``lens`` is 0 for the limit of 90 degrees."""
    ux, uy, vx, vy = ax - px, ay - py, bx - px, by - py
    dot = ux * vx + uy * vy
    if dot >= 0.0:
        return False
    return lens == 0.0 or dot * dot >= lens * (ux * ux + uy * uy) * (vx * vx + vy * vy)


@inline
def shell(length):
    """The power of two that divides a length most evenly: between a third and two thirds of it."""
    d = 1.0
    while length > 3.0 * d:
        d *= 2.0
    while length < 1.5 * d:
        d *= 0.5
    return d


@inline
def split_distance(length, apexes):
    """The distance from its first end at which a subsegment of this length is split."""
    if apexes == FIRST:
        return shell(length)
    if apexes == SECOND:
        return length - shell(length)
    return 0.5 * length


@inline
def split_straight(xy, a, b, t0, t1, apexes):
    """(x, y, t): the point where a straight subsegment is split, and its parameter."""
    dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    if apexes == FIRST or apexes == SECOND:
        length = math.sqrt(dx * dx + dy * dy)
        ratio = split_distance(length, apexes) / length if length > 0.0 else 0.5
    else:
        ratio = 0.5
    return xy[a, 0] + ratio * dx, xy[a, 1] + ratio * dy, t0 + ratio * (t1 - t0)


@inline
def split_arc(xy, a, b, t0, t1, apexes, arc):
    """The same for a part of a circular arc (center, radius, start, sweep); the point is on the circle."""
    r = arc[2]
    t = 0.5 * (t0 + t1)
    if apexes == FIRST or apexes == SECOND:
        dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
        d = shell(math.sqrt(dx * dx + dy * dy))
        step = 2.0 * arcsine(min(1.0, d / (2.0 * r))) / abs(arc[4])  # the chord from the apex has length d
        t = t0 + step if apexes == FIRST else t1 - step
    angle = arc[3] + t * arc[4]
    return arc[0] + r * cosine(angle), arc[1] + r * sine(angle), t


@inline
def across_small_angle(xy, kind, joints, u, v):
    """The apex about which u and v lie on one shell, on two pieces that meet there below 60 degrees; or -1.

    ``kind[v]`` is the piece in whose interior vertex v lies, ``joints`` (pieces, 2) the ends of the pieces.
    """
    p, q = kind[u], kind[v]
    if p < 0 or q < 0 or p == q:
        return -1
    for i in range(2):
        for j in range(2):
            w = joints[p, i]
            if w >= 0 and w == joints[q, j]:
                ux, uy, vx, vy = (
                    xy[u, 0] - xy[w, 0],
                    xy[u, 1] - xy[w, 1],
                    xy[v, 0] - xy[w, 0],
                    xy[v, 1] - xy[w, 1],
                )
                d, e = ux * ux + uy * uy, vx * vx + vy * vy
                if 0.999 * e < d < 1.001 * e and 2.0 * (ux * vx + uy * vy) > 0.999 * d:
                    return w
    return -1


@inline
def _sine_square(xy, w, a, b):
    """The squared sine of the angle a-w-b; 1 where the squares of lengths are below all doubles."""
    ux, uy, vx, vy = xy[a, 0] - xy[w, 0], xy[a, 1] - xy[w, 1], xy[b, 0] - xy[w, 0], xy[b, 1] - xy[w, 1]
    cross, product = ux * vy - uy * vx, (ux * ux + uy * uy) * (vx * vx + vy * vy)
    return cross * cross / product if product > 0.0 else 1.0


@inline
def sharper_than_input(xy, apex, a, b, c):
    """Whether c sees the edge a-b across a small angle under an angle that is smaller still.

    On equal shells this is so for the triangles beyond those at the apex, since c is farther away. A
    thousandth is no difference: below two degrees all of them would be split for nothing.
    """
    return _sine_square(xy, c, a, b) < SAME_ANGLE * _sine_square(xy, apex, a, b)


@inline
def _least_sine(ax, ay, bx, by, cx, cy):
    """The squared sine of the smallest angle of a triangle."""
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    p, q, s = ux * ux + uy * uy, vx * vx + vy * vy, (vx - ux) ** 2 + (vy - uy) ** 2
    longest = max(p, q, s)
    double, rest = ux * vy - uy * vx, longest * (p + q + s - longest - min(p, q, s))
    return double * double / rest if rest > 0.0 else 0.0


@inline
def spoils(xy, vertex, t, a, b, px, py, guarded):
    """Whether a point p in place of triangle t makes a triangle with a subsegment a-b that stays too sharp.

    Beside a ``guarded`` one no angle may be smaller than that of t. If t is a needle along a-b, whether that
    is guarded or not, its circumcenter lies in the needle, as near to a-b: the new triangle would be as
    sharp, and so on, one point for each octave of the needle. So the angle of a needle must become twice as
    large. (Both are 0 where the squares are below all doubles.)
    """
    c, d, e = vertex[3 * t], vertex[3 * t + 1], vertex[3 * t + 2]
    now = _least_sine(xy[c, 0], xy[c, 1], xy[d, 0], xy[d, 1], xy[e, 0], xy[e, 1])
    if not guarded and now >= NEEDLE:
        return False
    then = _least_sine(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py)
    return (guarded and then < now) or (now < NEEDLE and then <= 4.0 * now)


@inline
def too_short(xy, a, b, across):
    """Whether half of a-b is much shorter than an edge whose square is ``across``, 0 for no such edge."""
    return (xy[a, 0] - xy[b, 0]) ** 2 + (xy[a, 1] - xy[b, 1]) ** 2 < 3.2 * across
