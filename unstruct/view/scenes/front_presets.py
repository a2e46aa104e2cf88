"""The classical front on small regions, most of them nasty: each shows how a step can be difficult."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import islice
from math import cos, pi, radians, sin
from typing import Any, NamedTuple

import numpy as np

from ...base.errors import InputError
from ...geometry.simplex import angles
from ...plain import advancing_front as front
from ..draw import frames as fr
from .fronts import candidate_frames

__all__ = ["FRONT_PRESETS", "FRONT_WINDOW", "front_state"]

FRONT_WINDOW = (-0.75, 5.25, -0.35, 3.35)  # contains all presets
STEPS_SHOWN = 60
COVERED_TWICE = 1 + 1e-9  # a larger part of the region than this is wrong, not rounded
FRONT_KEYS = {"oldest": front.oldest, "shortest": front.shortest, "smallest": front.smallest}


class Preset(NamedTuple):
    """Points, the edges of the boundary, lines inside, the wanted length, and the tests."""

    points: Sequence[tuple[float, float]]
    facets: Sequence[tuple[int, int]]
    size: Callable[[Any], float] = lambda x: 1.0
    inner: Sequence[tuple[int, int]] = ()
    tests: Mapping[str, Any] = front.TESTS


def ring(count: int, first: int = 0) -> list[tuple[int, int]]:
    """The edges of a closed path through consecutive vertices."""
    return [(first + k, first + (k + 1) % count) for k in range(count)]


def widening() -> Preset:
    """A rectangle whose upper and lower sides are cut by a length that grows to the right."""
    x = [0.0]
    while x[-1] < 4.6:
        x.append(x[-1] + 0.6 + 0.3 * x[-1])
    x[-1] = 5.0
    points = [(v, 0.0) for v in x] + [(v, 3.0) for v in x[::-1]] + [(0.0, 3 - 0.6 * k) for k in range(1, 5)]
    return Preset(points, ring(len(points)), lambda p: 0.6 + 0.3 * p[0])


def cross(p: Sequence[float], q: Sequence[float], r: Sequence[float]) -> float:
    """Twice the area of a triangle."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])


TEN_POINTS = [
    (0, 0), (1, -0.1), (2, 0), (2.9, 0.4), (3.2, 1.35), (2.7, 2.2), (1.8, 2.5), (0.8, 2.6), (-0.1, 2.1),
    (-0.6, 1.1),
]  # fmt: skip
HOLE_POINTS = [(0.3 * x, 0.3 * y) for x, y in [(0, 0), (10, 0), (5, 9), (4, 2), (6, 2), (5, 4)]]
FLOOR_POINTS = [(x, 0.0) for x in range(6)]
GRID_POINTS = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (2, 2), (1, 2), (0, 2), (0, 1)]
FRAME_POINTS = [
    (0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (3, 3), (2, 3), (1, 3), (0, 3), (0, 2),
    (0, 1),
]  # fmt: skip
TOUCHING_RING = [(2 + sin(k * pi / 3), 1 - cos(k * pi / 3)) for k in range(1, 6)]
ACUTE_RAY = [(r * cos(radians(1)), r * sin(radians(1))) for r in (4, 3, 2, 1)]
FRONT_PRESETS: dict[str, Preset] = {
    "ten points": Preset(TEN_POINTS, ring(10)),
    "a hole": Preset(HOLE_POINTS, [*ring(3), *ring(3, 3)], lambda x: 30.0),
    "a hole, without the third test": Preset(
        HOLE_POINTS, [*ring(3), *ring(3, 3)], lambda x: 30.0,
        tests={name: front.TESTS[name] for name in ("behind", "crosses")},
    ),
    "no vertex in the circle": Preset([*FLOOR_POINTS, (5, 1.1), (0, 1.1)], ring(8)),
    "X beyond the opposite front": Preset([*FLOOR_POINTS, (5, 0.4), (0, 0.4)], ring(8)),
    "ties on a grid": Preset([*FLOOR_POINTS, *((5 - x, 1.0) for x in range(6))], ring(12), lambda x: 1.3),
    "sizes that grow": widening(),
    "a line and a loose vertex": Preset(
        [*GRID_POINTS, (1, 1), (2, 1), (1.5, 1.5)], ring(10), inner=[(10, 11)]
    ),
    "fronts that touch": Preset(
        [*FRAME_POINTS, *TOUCHING_RING], [*ring(14), (2, 14), *ring(5, 14)[:4], (18, 2)]
    ),
    "a corner of 1 degree": Preset([*FLOOR_POINTS[:5], *ACUTE_RAY], ring(9)),
}  # fmt: skip


def front_state(preset: str = "ten points", order: str = "oldest") -> list[fr.Frame]:
    """The plain classical front on one of ten small regions, step by step.

    Parameters
    ----------
    preset : str
        A name in `FRONT_PRESETS`.
    order : "oldest", "shortest" or "smallest"
        Which edge is next; "smallest" is the one where the smallest length is wanted.

    Returns
    -------
    list of dict
        One frame for each step, with the candidates, the reason and the choice, and one for the result: how
        much of the region is covered, and the smallest angle. All lie in `FRONT_WINDOW`.

    Raises
    ------
    InputError
        For an unknown preset or order.
    """
    if preset not in FRONT_PRESETS:
        raise InputError(f"preset = {preset!r} must be one of {', '.join(map(repr, FRONT_PRESETS))}")
    if order not in FRONT_KEYS:
        raise InputError(f"order = {order!r} must be one of {', '.join(map(repr, FRONT_KEYS))}")
    points, facets, size, inner, tests = FRONT_PRESETS[preset]
    march = front.advancing_front(points, facets, size, inner=inner, key=FRONT_KEYS[order], tests=tests)
    first = front.boundary_front(points, facets, inner)
    region = sum(cross((0, 0), points[a], points[b]) for a, b in first.edges)
    x, made, steps = [(float(p[0]), float(p[1])) for p in points], [], []
    covered, ended = 0.0, "the front is empty"
    for step in islice(march, STEPS_SHOWN):
        steps.append(step)
        x += [step.ideal] if step.reason == "new point" else []
        made.append([x[v] for v in (*step.edge, step.chosen)])
        covered += cross(*made[-1]) / region
        if covered > COVERED_TWICE:
            ended = "the triangles cover more than the region: the hole is swallowed"
            break
    frames = candidate_frames(points, list(first.edges), steps)
    least = np.degrees(angles(np.array(made)).min())
    frames[-1]["caption"] = ended
    frames[-1]["number"] = (
        f"{len(steps)} triangles on {covered:.0%} of the region; smallest angle {least:.1f} degrees"
    )
    frames[0]["view"] = list(FRONT_WINDOW)
    return frames
