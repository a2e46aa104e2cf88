"""Advancing layers told plainly: one closed polygon, rays, layer by layer, and a stop where a front is near.

Tuples and lists, no arrays; the oracle for `unstruct.generate.layers`. Book: 3.3.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import dist, hypot

Point = tuple[float, float]

__all__ = ["advance", "layer_cells", "least_force", "march", "spring_force", "wall_rays"]


def wall_rays(ring: Sequence[Point], rounds: int = 0) -> list[Point]:
    """Unit vectors at the corners of a ring, to its left: the mean of both normals, then smoothed."""
    n = len(ring)
    normals = []
    for i in range(n):
        (ax, ay), (bx, by) = ring[i], ring[(i + 1) % n]
        normals.append(unit((ay - by, bx - ax)))
    rays = [unit(plus(normals[i - 1], normals[i])) for i in range(n)]
    for _ in range(rounds):
        rays = [unit(plus(plus(rays[i - 1], rays[(i + 1) % n]), plus(rays[i], rays[i]))) for i in range(n)]
    return rays


def plus(u: Point, v: Point) -> Point:
    """The sum of two vectors."""
    return u[0] + v[0], u[1] + v[1]


def unit(u: Point) -> Point:
    """The vector at length 1."""
    length = hypot(*u)
    return u[0] / length, u[1] / length


def advance(ring: Sequence[Point], rays: Sequence[Point], height: float) -> list[Point]:
    """The points so far along each ray."""
    return [(x + height * u, y + height * v) for (x, y), (u, v) in zip(ring, rays)]


def spring_force(x: Point, a: Point, b: Point, rest: float) -> float:
    """The forces of two springs from x to the ends of the edge ab, added up."""
    return sum(abs(dist(x, p) - rest) for p in (a, b))


def least_force(candidates: Sequence[Point], a: Point, b: Point) -> int:
    """The candidate with the least force for the front edge ab; the rest length is that of the edge."""
    force = [spring_force(x, a, b, dist(a, b)) for x in candidates]
    return force.index(min(force))


def near(
    a: Point,
    b: Point,
    new: tuple[Point, Point],
    others: Sequence[Point],
) -> bool:
    """Whether an existing point that ab faces takes less force than both new ones.

    Or whether it stretches neither spring: in a very narrow gap compressed springs
    would push it away.
    """
    u, v = b[0] - a[0], b[1] - a[1]
    facing = [q for q in others if u * (q[1] - a[1]) > v * (q[0] - a[0])]
    slack = any(max(dist(q, a), dist(q, b)) <= dist(a, b) for q in facing)
    return slack or least_force([*new, *facing], a, b) > 1


def march(
    ring: Sequence[Point],
    heights: Sequence[float],
    others: Sequence[Point],
    wanted: Callable[[Point], float],
) -> list[int]:
    """How many layers each corner gets.

    Heights are totals along the rays, after 1, 2, ... layers. A corner stops before
    a step that is as long as the front beside it or as the wanted size, before an
    opposing front, and one layer after a neighbor.
    """
    n, rays = len(ring), wall_rays(ring)
    level, live = [0] * n, [True] * n
    totals = [0.0, *heights]
    for k in range(len(heights)):
        old = advance(ring, rays, totals[k])
        new = advance(ring, rays, totals[k + 1])
        step = totals[k + 1] - totals[k]
        for i in range(n):
            edges = [(i - 1, i), (i, (i + 1) % n)]
            beside = [dist(old[u], old[v]) for u, v in edges]
            if step >= sum(beside) / 2 or step >= wanted(old[i]):
                live[i] = False
            for u, v in edges:
                if near(old[u], old[v], (new[u], new[v]), others):
                    live[i] = False
        for i in range(n):
            live[i] = live[i] and min(level[i - 1], level[(i + 1) % n]) >= k
        level = [level[i] + live[i] for i in range(n)]
    return level


def layer_cells(level: Sequence[int]) -> list[list[tuple[int, int]]]:
    """The cells between rays i and i + 1, as corners (ray, layer): quadrilaterals, then one triangle."""
    cells: list[list[tuple[int, int]]] = []
    for i in range(len(level)):
        j = (i + 1) % len(level)
        low = min(level[i], level[j])
        cells += [[(i, k), (j, k), (j, k + 1), (i, k + 1)] for k in range(low)]
        if level[i] != level[j]:
            cells.append([(i, low), (j, low), (i if level[i] > low else j, low + 1)])
    return cells
