"""Fortune's sweep for the Delaunay triangulation, with exact arithmetic (source chapter, 12.6).

A horizontal line sweeps the plane from above to below. What is nearer to some site above it than to the line
is done with. It ends below at the *beach line*, a chain of arcs of parabolas, each with a site as its focus.
The chain changes in two ways. At a *site event* the line meets a site, which splits the arc above it. At a
*circle event* an arc shrinks to a point, as far from its site and the two neighbors' as from the line: that
point is the center of an empty circle through three sites, and they are a triangle.

The state is the list of sites along the beach line, and nothing else. Of its consecutive triples, those that
turn clockwise have a circle event, at the lowest point of their circle; so there is no queue of events to be
kept valid. All comparisons are exact: which arc is above a site needs rational numbers only (`is_left_of`),
the order of events square roots of rational numbers, whose signs are found by squaring (`sign_of_roots`).

Ties. Circle events go before site events at the same height. A site on the lowest point of a known circle is
then below a breakpoint, where either arc may be split: the piece of no width between two breakpoints at one
place has its circle event at once. So k sites on an empty circle give k - 2 triangles that fit. Sites as high
as the first one have no arc above them; they stand side by side.

Source: S. Fortune, A sweepline algorithm for Voronoi diagrams, Algorithmica 2 (1987) 153-174.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import sqrt
from typing import Any

from unstruct.base.errors import DegenerateInputError
from unstruct.plain.bowyer_watson import planar_sites
from unstruct.plain.lawson import triangle
from unstruct.plain.predicates import orient

__all__ = [
    "CircleEvent", "Event", "arc_above", "breakpoint", "circle_event", "fortune", "is_left_of", "is_lower",
    "next_circle", "sign_of_roots", "sweep",
]  # fmt: skip

Point = tuple[Fraction, ...]
Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]


@dataclass(frozen=True)
class CircleEvent:
    """Where an arc shrinks to a point: at the height ``center[1] - sqrt(squared_radius)``."""

    arc: int  # its place along the beach line
    center: Point
    squared_radius: Fraction

    @property
    def height(self) -> float:
        """The height of the line, rounded, for pictures."""
        return float(self.center[1]) - sqrt(self.squared_radius)


@dataclass(frozen=True)
class Event:
    """One event, and the state after it."""

    site: int | None  # the new site, or None at a circle event
    circle: CircleEvent | None
    triangle: Triangle | None  # that of the circle event
    height: float  # of the sweep line, rounded at circle events
    beach: tuple[int, ...]  # the sites of the arcs from left to right
    triangles: tuple[Triangle, ...]  # so far


def fortune(points: Points) -> set[Triangle]:
    """The triangles of a Delaunay triangulation, counterclockwise, least vertex first.

    Raises
    ------
    InputError
        Where the points are not pairs of finite numbers, or two of them are equal.
    DegenerateInputError
        Where all points lie on a line.

    Notes
    -----
    O(n) sign tests an event, O(n^2) in all: made to be read. With the beach line in a balanced tree and the
    events in a queue it is O(n log n).
    """
    *_, last = sweep(points)
    if not last.triangles:
        flat = min(len(points) - 1, 1)
        raise DegenerateInputError(f"all {len(points)} points lie in a flat of dimension {flat}", flat)
    return set(last.triangles)


def sweep(points: Points) -> Iterator[Event]:
    """All events from above to below: n site events and as many circle events as there are triangles."""
    sites = planar_sites(points)
    waiting = sorted(range(len(sites)), key=lambda v: (-sites[v][1], sites[v][0]))
    beach: tuple[int, ...] = ()
    triangles: tuple[Triangle, ...] = ()
    while True:
        circle = next_circle(sites, beach)
        if circle is not None and not (waiting and is_lower(circle, sites[waiting[0]][1])):
            k = circle.arc
            a, b, c = beach[k - 1 : k + 2]
            beach = (*beach[:k], *beach[k + 1 :])
            triangles = (*triangles, triangle(a, c, b))
            yield Event(None, circle, triangles[-1], circle.height, beach, triangles)
        elif waiting:
            v = waiting.pop(0)
            beach = _with_site(sites, beach, v)
            yield Event(v, None, None, float(sites[v][1]), beach, triangles)
        else:
            return


def _with_site(sites: Sequence[Point], beach: tuple[int, ...], v: int) -> tuple[int, ...]:
    """The beach line with the new arc: in the middle of the one above it."""
    if not beach:
        return (v,)
    k = arc_above(sites, beach, v)
    if sites[beach[k]][1] == sites[v][1]:  # only in the first row: nothing is above it
        return (*beach[: k + 1], v, *beach[k + 1 :])
    return (*beach[: k + 1], v, *beach[k:])


def arc_above(sites: Sequence[Point], beach: Sequence[int], v: int) -> int:
    """The place of the arc above a site on the sweep line; at a breakpoint, the one on its left."""
    return next(
        k
        for k in range(len(beach))
        if k == len(beach) - 1 or is_left_of(sites[v], sites[beach[k]], sites[beach[k + 1]])
    )


def is_left_of(s: Point, p: Point, q: Point) -> bool:
    """Whether a site s, on the sweep line, is not right of the breakpoint from the arc of p to that of q.

    The arc of the lower site is the narrower one and contains the place below which its own site is. So if p
    is the higher one, the breakpoint is left of q; and left of q the lower parabola tells on which side of it
    s is. The same with sides exchanged if q is higher. Level sites have one breakpoint, in their middle.
    """
    x, y = s
    if p[1] == q[1]:
        return 2 * x <= p[0] + q[0]
    p_over, p_under = (x - p[0]) ** 2 + p[1] ** 2 - y**2, p[1] - y  # twice the height of the parabola at x
    q_over, q_under = (x - q[0]) ** 2 + q[1] ** 2 - y**2, q[1] - y  # is over / under; under = 0 is infinity
    if p[1] > q[1]:
        return x < q[0] and p_over * q_under <= q_over * p_under
    return x <= p[0] or p_over * q_under <= q_over * p_under


def next_circle(sites: Sequence[Point], beach: Sequence[int]) -> CircleEvent | None:
    """The highest circle event of the beach line, the leftmost one of equals."""
    best = None
    for k in range(1, len(beach) - 1):
        event = circle_event(sites, beach, k)
        if event is not None and (best is None or _is_first(event, best)):
            best = event
    return best


def circle_event(sites: Sequence[Point], beach: Sequence[int], k: int) -> CircleEvent | None:
    """The circle event of an arc; None where its breakpoints do not come together."""
    a, b, c = (sites[v] for v in beach[k - 1 : k + 2])
    if orient([a, b, c]) >= 0:
        return None
    bx, by, cx, cy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    twice = 2 * (bx * cy - by * cx)
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    x, y = (cy * b2 - by * c2) / twice, (bx * c2 - cx * b2) / twice
    return CircleEvent(k, (a[0] + x, a[1] + y), x * x + y * y)


def is_lower(circle: CircleEvent, height: Fraction) -> bool:
    """Whether a circle event is strictly below a height."""
    return sign_of_roots(circle.center[1] - height, Fraction(0), circle.squared_radius) < 0


def _is_first(one: CircleEvent, other: CircleEvent) -> bool:
    """Whether a circle event is strictly higher than another, or as high and further to the left."""
    rise = one.center[1] - other.center[1]
    sign = sign_of_roots(rise, other.squared_radius, one.squared_radius)
    return sign > 0 or (sign == 0 and one.center[0] < other.center[0])


def sign_of_roots(a: Fraction, b: Fraction, c: Fraction) -> int:
    """The sign of a + sqrt(b) - sqrt(c), for b and c that are not negative.

    Two numbers that are not negative compare as their squares do. First a + sqrt(b) is compared with 0 in
    that way; if it is not negative, its square a^2 + b + 2 a sqrt(b) is compared with c.
    """
    if a < 0 and a * a > b:
        return -1
    rest, root = a * a + b - c, 4 * a * a * b  # the sign of rest + sign(a) sqrt(root)
    if a >= 0:
        return 1 if rest > 0 else _sign(root - rest * rest)
    return -1 if rest < 0 else _sign(rest * rest - root)


def breakpoint(p: Point, q: Point, height: float) -> float:
    """Where the arc of p on the left meets that of q, for pictures: rounded, the line below one of them."""
    (px, py), (qx, qy) = ((float(x), float(y) - height) for x, y in (p, q))
    if py == qy:
        return (px + qx) / 2
    root = sqrt(py * qy * ((px - qx) ** 2 + (py - qy) ** 2))
    return (qx * py - px * qy - root) / (py - qy)


def _sign(x: Fraction) -> int:
    return (x > 0) - (x < 0)
