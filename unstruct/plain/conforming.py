"""Midpoints until every segment is a Delaunay edge, and why that may never end (section 2.4b of the book).

A segment uv is an edge of some Delaunay triangulation exactly if a circle through u and v has no point
inside. Each point on the left of uv leaves, of these circles, those that see uv from it under too small an
angle; so does each point on the right. Something is left unless two of the angles, one from each side, add
up to more than 180 degrees; or unless a point lies on uv. Angles are irrational, their cotangents are not.

More points never bring a missing segment back. So whatever is split once must be split in any order: the
result, if there is one, depends on the points and segments only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from math import frexp, hypot
from typing import Any

from unstruct.plain.predicates import orient

__all__ = ["cotangent", "encroached", "fan", "halve", "missing", "period", "rounds", "shell_point"]

Point = tuple[Any, Any]
Segment = tuple[int, int]
Test = Callable[[Sequence[Point], Point, Point], bool]


def cotangent(p: Point, u: Point, v: Point) -> Fraction:
    """Cotangent of the angle under which p sees uv: smaller for larger angles, negative beyond 90 degrees."""
    (ax, ay), (bx, by) = ((Fraction(q[0]) - Fraction(p[0]), Fraction(q[1]) - Fraction(p[1])) for q in (u, v))
    return (ax * bx + ay * by) / abs(ax * by - ay * bx)


def missing(points: Sequence[Point], u: Point, v: Point) -> bool:
    """Is uv in no Delaunay triangulation of the points (not all on a line)?"""
    seen: dict[int, list[Fraction]] = {1: [], -1: []}
    for p in points:
        side = orient([u, v, p])
        if side != 0:
            seen[side].append(cotangent(p, u, v))
        elif min(u, v) < p < max(u, v):
            return True
    left, right = seen[1], seen[-1]
    return bool(left and right) and min(left) + min(right) < 0


def encroached(points: Sequence[Point], u: Point, v: Point) -> bool:
    """Is a point strictly inside the circle with diameter uv? Then uv may be missing, and need not be."""
    return any(
        sum((Fraction(a) - Fraction(x)) * (Fraction(b) - Fraction(x)) for a, b, x in zip(u, v, p)) < 0
        for p in points
    )


def rounds(
    points: Sequence[Point], segments: Sequence[Segment], test: Test = missing
) -> Iterator[tuple[list[Point], list[Segment], list[Segment]]]:
    """Split all missing segments at their midpoints, look again, and so on.

    Yields
    ------
    points, segments, bad : lists
        Before each round, with the segments to be split; and at the end, without.
    """
    points, segments = [tuple(p) for p in points], list(segments)
    while True:
        bad = [s for s in segments if test(points, points[s[0]], points[s[1]])]
        yield points, segments, bad
        if not bad:
            return
        points, segments = halve(points, segments, bad)


def halve(
    points: Sequence[Point], segments: Sequence[Segment], bad: Sequence[Segment]
) -> tuple[list[Point], list[Segment]]:
    """The points with midpoints of bad segments; all segments, these in halves."""
    points, new = list(points), []
    for u, v in segments:
        if (u, v) in bad:
            x, y = ((a + b) / 2 for a, b in zip(points[u], points[v]))
            new += [(u, len(points)), (len(points), v)]
            points.append((x, y))
        else:
            new.append((u, v))
    return points, new


def fan(
    spokes: Sequence[Point],
    test: Test = missing,
    limit: int = 1000,
) -> list[tuple[int, ...]]:
    """How often each segment from (0, 0) to an end must be halved, round by round.

    Only the half next to the center is looked at, and only the ends of such halves as
    obstacles. All other points can only force more splits. The list ends where nothing
    is missing, or where a state repeats an earlier one on a smaller scale (`period`).
    """
    states: list[tuple[int, ...]] = []
    k, center = [0] * len(spokes), (Fraction(0), Fraction(0))
    while len(states) < limit:
        states.append(tuple(k))
        ends = zip(spokes, k)
        tips = [(Fraction(x) / 2**h, Fraction(y) / 2**h) for (x, y), h in ends]
        bad = [i for i, tip in enumerate(tips) if test(tips, center, tip)]
        if not bad or period(states):
            break
        for i in bad:
            k[i] += 1
    return states


def period(states: Sequence[tuple[int, ...]]) -> int:
    """By how many halvings of *every* spoke the last state exceeds an earlier one, or 0.

    The two are then similar figures. What was forced from the first to the second will
    be forced again, on half the scale, and again: there is no end.
    """
    last = states[-1]
    for earlier in states[:-1]:
        gaps = {a - b for a, b in zip(last, earlier)}
        if len(gaps) == 1:
            return gaps.pop()
    return 0


def shell_point(apex: Sequence[float], end: Sequence[float]) -> tuple[float, float]:
    """Where to split a segment at an apex: at a distance 2**k from it, between 1/3 and 2/3 of the length."""
    dx, dy = end[0] - apex[0], end[1] - apex[1]
    length = hypot(dx, dy)
    radius = 2.0 ** (frexp(2 * length / 3)[1] - 1)
    return apex[0] + dx * (radius / length), apex[1] + dy * (radius / length)
