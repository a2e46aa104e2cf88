"""DistMesh, told plainly: a truss of bars that push, in a region given by its signed distance.

The region is where a function d is negative, its boundary where d = 0; elsewhere |d| is the distance from the
boundary. A second function h gives the wanted lengths up to a factor. Points start on a lattice of
equilateral triangles, thinned out where h is large. Their Delaunay triangles with centroids inside are kept;
each edge is a bar that pushes its ends apart if it is shorter than its wanted length, and never pulls. The
wanted lengths are h at the middles, scaled so that the sum of their squares is 1.44 times that of the present
lengths: most bars are under pressure, and the points spread to the boundary. Points move with their forces;
those that leave the region are put back along the gradient of d. When a point has moved far, there is a new
triangulation.

Nothing is proved: not that it ends (so there is a limit, and `Truss.settled` tells), nor that the triangles
fill the region or have good angles. They always are triangles of a Delaunay triangulation at the last places
that were triangulated; in between, points move with the triangles as they are. Corners of the region are met
only if they are among the fixed points. Points that come to lie on each other, as two that were put back to
one corner, are made one, and told.

Moves are in floats: forces and distances need roots, and nothing depends on the last digit but the figure.
Triangles come from an exact method: `unstruct.plain.divide_and_conquer`, or another one that is given.

Source: P.-O. Persson, G. Strang, A simple mesh generator in MATLAB, SIAM Review 46 (2004) 329-345, from the
description there. The parameters are the paper's; ours are the merging, a last triangulation at the end, and
random numbers from a seed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import dist, hypot, inf, sqrt
from random import Random
from typing import Any

from unstruct.base.errors import InputError
from unstruct.plain.divide_and_conquer import divide_and_conquer

__all__ = [
    "Region", "Truss", "bars_of", "circle", "difference", "distmesh", "forces", "lattice", "moves", "polygon",
    "put_back", "triangulated",
]  # fmt: skip

Point = tuple[float, float]
Triangle = tuple[int, int, int]
Bar = tuple[int, int]
Field = Callable[[Sequence[float]], float]
Delaunay = Callable[[Sequence[Point]], Iterable[Triangle]]

PUSH = 1.2  # how much longer than they are the bars want to be, on the whole
STEP = 0.2  # how far a unit of force moves a point
FAR = 0.1  # of the first spacing: a move that asks for a new triangulation
STILL = 0.001  # of the first spacing: moves inside that are the end
THIN = 0.001  # of the first spacing: what counts as on the boundary


@dataclass(frozen=True)
class Region:
    """What is to be meshed, and how."""

    d: Field  # the signed distance
    h: Field  # wanted lengths up to a factor
    spacing: float
    fixed: int  # so many points, which come first, stay
    delaunay: Delaunay


@dataclass(frozen=True)
class Truss:
    """The state after one round of moves."""

    points: tuple[Point, ...]
    triangles: tuple[Triangle, ...]
    bars: tuple[Bar, ...]
    pushes: tuple[Point, ...]  # the forces of this round (on points before the last merging)
    fresh: bool  # the triangulation is new
    merged: int  # how many points were dropped, since they lay on others
    returned: frozenset[int]  # points that were put back on the boundary
    largest: float  # move of an inside point, over the first spacing
    settled: bool  # that is below `STILL`; the last state, settled or not, has a new triangulation


def distmesh(
    d: Field, h: Field, spacing: float, box: tuple[Point, Point], fixed: Sequence[Point] = (), *,
    delaunay: Delaunay = divide_and_conquer, seed: int = 0, limit: int = 300,
) -> Iterator[Truss]:  # fmt: skip
    """Round by round until the points inside rest, or for ``limit`` rounds.

    Parameters
    ----------
    d : function of a point
        The signed distance from the boundary, negative inside.
    h : function of a point
        Wanted lengths up to a common factor, positive.
    spacing : float
        Of the first lattice: the shortest edges are about as long.
    box : two points
        The lowest and the highest corner of a box around the region.
    fixed : points
        They stay; put all corners of the region here.
    delaunay : function of points
        Their Delaunay triangles.
    seed : int
        Of the random numbers that thin the lattice out.
    limit : int
        At most so many rounds.

    Raises
    ------
    InputError
        Where a wanted length, the spacing or the limit is not positive; where no triangle is inside.
    """
    stays = list(dict.fromkeys((float(x), float(y)) for x, y in fixed))
    region = Region(d, h, _positive(spacing, "the spacing"), len(stays), delaunay)
    have = stays + [p for p in lattice(region, box, Random(seed)) if p not in set(stays)]
    triangles: tuple[Triangle, ...] = ()
    at: list[Point] = []  # where the points were at the last triangulation
    for left in reversed(range(int(_positive(limit, "the limit")))):
        merged, fresh = 0, not at or max(map(dist, have, at)) > FAR * spacing
        if fresh:
            have, merged, triangles = triangulated(region, have)
            at = have
        pushes = forces(have, bars_of(triangles), h)
        have, out, largest = moves(region, have, pushes)
        settled = largest < STILL
        if settled or left == 0:
            have, more, triangles = triangulated(region, have)
            merged, fresh = merged + more, True
        state = tuple(have), triangles, bars_of(triangles), tuple(pushes)
        yield Truss(*state, fresh, merged, out, largest, settled)
        if settled:
            return


def lattice(region: Region, box: tuple[Point, Point], random: Random) -> list[Point]:
    """Equilateral triangles over the box: points inside, each kept with a chance that falls like 1 / h^2."""
    (low_x, low_y), (high_x, high_y) = box
    height = region.spacing * sqrt(3) / 2
    found = []
    for row in range(int((high_y - low_y) / height) + 1):
        for k in range(int((high_x - low_x) / region.spacing) + 1):
            p = low_x + (k + row % 2 / 2) * region.spacing, low_y + row * height
            if region.d(p) < THIN * region.spacing:
                found.append((p, _positive(region.h(p), f"the wanted length at {p}")))
    least = min((h for _, h in found), default=1.0)
    return [p for p, h in found if random.random() < (least / h) ** 2]


def triangulated(region: Region, points: Sequence[Point]) -> tuple[list[Point], int, tuple[Triangle, ...]]:
    """The points without copies, how many those were, and the Delaunay triangles with centroids inside."""
    have = list(dict.fromkeys(points))
    inside = []
    for t in region.delaunay(have) if len(have) > 2 else ():
        x, y = (sum(have[v][k] for v in t) / 3 for k in (0, 1))
        if region.d((x, y)) < -THIN * region.spacing:
            inside.append(t)
    if not inside:
        raise InputError(
            f"no triangle of {len(have)} points is inside: take a smaller spacing, or another box"
        )
    return have, len(points) - len(have), tuple(sorted(inside))


def bars_of(triangles: Iterable[Triangle]) -> tuple[Bar, ...]:
    """All edges, each once."""
    return tuple(sorted({(min(t[k - 1], t[k]), max(t[k - 1], t[k])) for t in triangles for k in range(3)}))


def forces(points: Sequence[Point], bars: Sequence[Bar], h: Field) -> list[Point]:
    """The sum of the pushes on each point: bars that are shorter than they want to be."""
    lengths = [dist(points[u], points[v]) for u, v in bars]
    wanted = []
    for u, v in bars:
        middle = (points[u][0] + points[v][0]) / 2, (points[u][1] + points[v][1]) / 2
        wanted.append(_positive(h(middle), f"the wanted length at {middle}"))
    scale = PUSH * sqrt(sum(x * x for x in lengths) / sum(x * x for x in wanted))
    total = [(0.0, 0.0)] * len(points)
    for (u, v), length, want in zip(bars, lengths, wanted, strict=True):
        push = max(scale * want - length, 0.0) / length
        x, y = push * (points[u][0] - points[v][0]), push * (points[u][1] - points[v][1])
        total[u] = total[u][0] + x, total[u][1] + y
        total[v] = total[v][0] - x, total[v][1] - y
    return total


def moves(
    region: Region, points: Sequence[Point], pushes: Sequence[Point]
) -> tuple[list[Point], frozenset[int], float]:
    """The points afterwards, which were put back, and the largest move inside over the spacing."""
    have, out, largest = list(points), set(), 0.0
    for v in range(region.fixed, len(points)):
        (x, y), (fx, fy) = points[v], pushes[v]
        have[v] = x + STEP * fx, y + STEP * fy
        if region.d(have[v]) > 0:
            out.add(v)
            have[v] = put_back(region, have[v])
        if region.d(have[v]) < -THIN * region.spacing:
            largest = max(largest, STEP * hypot(fx, fy) / region.spacing)
    return have, frozenset(out), largest


def put_back(region: Region, p: Point) -> Point:
    """A point outside, moved by its distance against the gradient of d, which is found by differences."""
    d, far, tiny = region.d, region.d(p), 1e-8 * region.spacing
    gx, gy = (d((p[0] + tiny, p[1])) - far) / tiny, (d((p[0], p[1] + tiny)) - far) / tiny
    return p[0] - far * gx, p[1] - far * gy


# --- signed distances -----------------------------------------------------------------------------


def circle(center: Point, radius: float) -> Field:
    """A disk."""
    return lambda p: dist(p, center) - radius


def polygon(points: Sequence[Sequence[Any]], segments: Iterable[Bar]) -> Field:
    """The region that closed chains of segments bound, even-odd."""
    sides = [(points[a], points[b]) for a, b in segments]

    def signed(p: Sequence[float]) -> float:
        nearest, odd = inf, False
        for (ax, ay), (bx, by) in sides:
            ux, uy, vx, vy = bx - ax, by - ay, p[0] - ax, p[1] - ay
            s = min(1.0, max(0.0, (ux * vx + uy * vy) / (ux * ux + uy * uy)))
            nearest = min(nearest, hypot(vx - s * ux, vy - s * uy))
            if (ay <= p[1]) != (by <= p[1]) and (vx * uy < ux * vy) == (uy < 0):
                odd = not odd
        return -nearest if odd else nearest

    return signed


def difference(one: Field, other: Field) -> Field:
    """What is in one region and not in another; the distance is exact if their boundaries are far apart."""
    return lambda p: max(one(p), -other(p))


def _positive(x: float, what: str) -> float:
    if not 0 < x < inf:
        raise InputError(f"{what} must be positive and finite, not {x}")
    return x
