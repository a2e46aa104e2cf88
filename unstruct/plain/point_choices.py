"""Four choices of points for one incremental refinement of a polygon (cited by the source chapter, 12.6).

The constrained Delaunay triangles inside a region are kept; the boundary stays as it is. A *choice* says how
bad a triangle is (it waits if that is above 1) and where its new point goes. The worst waiting triangle comes
first. Its point is inserted unless it is hidden behind the boundary, or nearer to a vertex than ``SPARE``
times the choice's wanted length there; then the triangle is set aside and not tried again.

**It ends.** Around each new vertex there is a disk of radius ``SPARE`` times the least wanted length in which
no earlier vertex lies. Disks of half that radius are disjoint, so there are finitely many vertices, and
between two insertions each triangle is set aside at most once. At the end each triangle is good, or was set
aside for one of the two reasons.

**What is known.** The source chapter has one sentence on each work, and no description of the four papers
was found besides. From those sentences:

- `holmes_snyder`: aspect ratio and area of triangles decide; the point is the worst one's circumcenter.
- `hamann`: points go into a first Delaunay mesh by curvature of the boundary and distance from it.
- `anderson`: aspect ratio and nearness to the boundary decide.
- `baker`: a modification of Rebay's insertion on Voronoi segments.

All else is **our reading**: that the larger one of two excesses counts (aspect ratio is circumradius over two
inradii); that lengths grow linearly away from the boundary; that curvature is the turn at a vertex over the
mean of its two edges; that `hamann` and `anderson` also take circumcenters; that `baker` needs no front but
takes Rebay's point over the shortest side of the worst triangle, at most at its circumcenter; the refusals.

The measures are floats; what is in a circle, and on which side of a line, is decided exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import atan2, dist, inf, pi, sqrt
from typing import Any

from unstruct.base.errors import InputError
from unstruct.plain.lawson import triangle
from unstruct.plain.predicates import orient
from unstruct.plain.rebay import cavity, centroid, circumradius, start
from unstruct.plain.rebay_step import step

__all__ = [
    "Choice", "Chosen", "anderson", "aspect", "baker", "circumcenter", "curvatures", "cut", "hamann",
    "holmes_snyder", "point_choices",
]  # fmt: skip

Point = tuple[float, float]
Points = Sequence[Sequence[Any]]
Triangle = tuple[int, int, int]
Edge = tuple[int, int]
Corners = Sequence[Sequence[Any]]  # three points
SPARE = 0.5


@dataclass(frozen=True)
class Choice:
    """Which triangles wait, where their points go, and the length that is wanted at a place."""

    badness: Callable[[Corners], float]
    place: Callable[[Corners], Point | None]
    wanted: Callable[[Sequence[float]], float]


@dataclass(frozen=True)
class Chosen:
    """One triangle treated: it got its point, or was set aside."""

    worst: Triangle
    badness: float
    point: Point | None  # where the choice wants it
    refusal: str  # "" (it was inserted), "hidden", "near"
    cavity: frozenset[Triangle]
    star: frozenset[Triangle]
    points: tuple[Point, ...]  # afterwards
    cells: frozenset[Triangle]  # afterwards


def point_choices(points: Points, segments: Iterable[Edge], choice: Choice) -> Iterator[Chosen]:
    """Treat the worst waiting triangle, until none waits.

    Parameters
    ----------
    points : n points of two numbers
    segments : pairs of indices
        The boundary, not crossing; even-odd. `cut` divides its pieces.
    choice : Choice
        One of `holmes_snyder`, `hamann`, `anderson`, `baker`, or another one.
    """
    have = tuple((float(x), float(y)) for x, y in points)
    cells, fixed = start(have, segments)
    aside: set[Triangle] = set()
    while True:
        bad = {cell: choice.badness([have[v] for v in cell]) for cell in cells - aside}
        worst = max((cell for cell in bad if bad[cell] > 1), key=lambda c: (bad[c], c), default=None)
        if worst is None:
            return
        x = choice.place([have[v] for v in worst])
        gone, rim = (frozenset(), []) if x is None else cavity(have, cells, fixed, worst, x)
        if x is None or any(orient([have[u], have[v], x]) <= 0 for u, v in rim):
            refusal = "hidden"
        else:
            refusal = "near" if min(dist(x, p) for p in have) < SPARE * choice.wanted(x) else ""
        star: frozenset[Triangle] = frozenset()
        if refusal or x is None:
            aside.add(worst)
            gone = frozenset()
        else:
            star = frozenset(triangle(u, v, len(have)) for u, v in rim)
            have, cells = (*have, x), cells - gone | star
        yield Chosen(worst, bad[worst], x, refusal, gone, star, have, cells)


def holmes_snyder(length: float, most: float = 1.6) -> Choice:
    """Wait above an aspect ratio, or above the area of the equilateral triangle with sides of that length."""
    area = sqrt(3) / 4 * _positive(length) ** 2
    _positive(most - 1)

    def badness(t: Corners) -> float:
        return max(aspect(t) / most, _area(t) / area)

    return Choice(badness, circumcenter, lambda x: length)


def hamann(
    points: Points, segments: Iterable[Edge], most: float, turn: float = 0.5, growth: float = 0.3
) -> Choice:
    """Wanted at a vertex of the boundary: ``turn`` over its curvature, within limits; off it, more.

    It is not below the mean of the two edges, which stay as they are, and at most ``most``. The wanted length
    at x is the least, over all vertices of the boundary, of theirs plus ``growth`` times the distance. A
    triangle waits if its circumradius times the square root of 3 is larger: if equilateral, that is its side.
    """
    _positive(most), _positive(turn)
    found = curvatures(points, segments)
    near = {v: min(most, max(mean, turn / k if k else inf)) for v, (k, mean) in found.items()}

    def wanted(x: Sequence[float]) -> float:
        return min(most, min(h + growth * dist(x, points[v]) for v, h in near.items()))

    return Choice(lambda t: _side(t) / wanted(_middle(t)), circumcenter, wanted)


def anderson(
    points: Points, segments: Iterable[Edge], least: float, most: float = 1.6, growth: float = 0.3
) -> Choice:
    """Wait above an aspect ratio, or above a length that grows with the distance from the boundary."""
    edges = [(points[a], points[b]) for a, b in segments]
    _positive(least), _positive(most - 1)

    def wanted(x: Sequence[float]) -> float:
        return least + growth * min(_to_segment(x, a, b) for a, b in edges)

    return Choice(lambda t: max(aspect(t) / most, _side(t) / wanted(_middle(t))), circumcenter, wanted)


def baker(length: float, accept: float = 1.35) -> Choice:
    """Rebay's point over the shortest side of the triangle with the largest circumradius."""
    f = _positive(length) / sqrt(3)

    def place(t: Corners) -> Point | None:
        k = min(range(3), key=lambda k: dist(t[k - 2], t[k - 1]))  # the corner that the shortest side faces
        return step(t[k - 2], t[k - 1], t[k], f).point

    return Choice(lambda t: circumradius(t, (0, 1, 2)) / (accept * f), place, lambda x: length)


def curvatures(points: Points, segments: Iterable[Edge]) -> dict[int, tuple[float, float]]:
    """At each vertex of the boundary: the angle by which it turns over the mean of its two edges, and that.

    Raises
    ------
    InputError
        Where a vertex does not have two edges.
    """
    ends: dict[int, list[int]] = {}
    for a, b in segments:
        ends.setdefault(a, []).append(b)
        ends.setdefault(b, []).append(a)
    found = {}
    for v, others in ends.items():
        if len(others) != 2:
            raise InputError(f"vertex {v} has {len(others)} boundary edges: give closed loops")
        (ux, uy), (vx, vy) = ((points[w][0] - points[v][0], points[w][1] - points[v][1]) for w in others)
        turn = pi - abs(atan2(ux * vy - uy * vx, ux * vx + uy * vy))
        mean = (dist(points[v], points[others[0]]) + dist(points[v], points[others[1]])) / 2
        found[v] = turn / mean, mean
    return found


def cut(points: Points, segments: Iterable[Edge], length: float) -> tuple[list[Point], list[Edge]]:
    """Divide each segment into equal parts of at most a length; new points come after the old ones."""
    have: list[Point] = [(float(x), float(y)) for x, y in points]
    parts = []
    for a, b in segments:
        (ax, ay), (bx, by) = have[a], have[b]
        n = max(1, int(-(-dist(have[a], have[b]) // _positive(length))))
        chain = [a, *range(len(have), len(have) + n - 1), b]
        have += [(ax + (bx - ax) * k / n, ay + (by - ay) * k / n) for k in range(1, n)]
        parts += [(chain[k], chain[k + 1]) for k in range(n)]
    return have, parts


def aspect(t: Corners) -> float:
    """The circumradius over two inradii: 1 if equilateral."""
    around = sum(dist(t[k - 1], t[k]) for k in range(3))
    return circumradius(t, (0, 1, 2)) * around / (4 * _area(t))


def circumcenter(t: Corners) -> Point:
    """The center of the circle through three points."""
    (ax, ay), (bx, by), (cx, cy) = t
    bx, by, cx, cy = bx - ax, by - ay, cx - ax, cy - ay
    twice, b2, c2 = 2 * (bx * cy - by * cx), bx * bx + by * by, cx * cx + cy * cy
    return ax + (cy * b2 - by * c2) / twice, ay + (bx * c2 - cx * b2) / twice


def _area(t: Corners) -> float:
    (ax, ay), (bx, by), (cx, cy) = t
    return ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2


def _middle(t: Corners) -> Point:
    return centroid(t, (0, 1, 2))


def _side(t: Corners) -> float:
    return sqrt(3) * circumradius(t, (0, 1, 2))


def _to_segment(x: Sequence[float], a: Sequence[Any], b: Sequence[Any]) -> float:
    """The distance from a point to a segment."""
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], x[0] - a[0], x[1] - a[1]
    s = min(1.0, max(0.0, (ux * vx + uy * vy) / (ux * ux + uy * uy)))
    return dist(x, (a[0] + s * ux, a[1] + s * uy))


def _positive(x: float) -> float:
    if not 0 < x < inf:
        raise InputError(f"a length must be positive and finite, and an aspect ratio above 1; {x} is not")
    return x
