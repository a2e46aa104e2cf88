"""The inputs of the planar suite: graphs of segments, a square with a round hole, and sizes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RADIUS = 0.25
CENTER = np.array([0.5, 0.5])
AREA = 1.0 - np.pi * RADIUS**2
FINEST, GROWTH = 0.0003, 0.1  # the graded size at the hole, and its growth per unit of distance from it


class Graph(NamedTuple):
    """Points and segments between them that do not cross; ``hole`` is a point in the hole, or None."""

    points: Array
    segments: NDArray[np.int32]
    hole: Array | None


def loop(first: int, count: int) -> NDArray[np.int32]:
    """The segments of the closed loop through vertices first, ..., first + count - 1."""
    number = np.arange(count, dtype=np.int32)
    return first + np.stack([number, (number + 1) % count], axis=1)


def hedgehog(n: int) -> Graph:
    """A closed polygon of n corners; every other one is nearer the center, so that all angles are small."""
    t = 2 * np.pi * np.arange(n) / n
    radius = np.where(np.arange(n) % 2 == 0, 1.0, 0.7 + 0.2 * np.sin(17 * t))
    return Graph(radius[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1), loop(0, n), None)


def coast(n: int) -> Graph:
    """A closed polygon of n corners along a rough shore with waves of all lengths; it does not fold over."""
    rng = np.random.default_rng(3)
    t = 2 * np.pi * np.arange(n) / n
    waves = 2 ** np.arange(2, int(np.log2(n)) - 2)
    radius = 1.0 + sum(0.7 / k**0.8 * np.sin(k * t + rng.uniform(0, 2 * np.pi)) for k in waves)
    return Graph(radius[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1), loop(0, n), None)


def matches(n: int) -> Graph:
    """About n / 2 random short segments in the unit square, each in a cell of its own, so that none touch."""
    rng = np.random.default_rng(7)
    side = int(np.sqrt(n / 2))
    corner = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 1, 2)
    ends = (corner + rng.uniform(0.02, 0.98, (side * side, 2, 2))) / side
    order = rng.permutation(2 * side * side)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return Graph(ends.reshape(-1, 2)[order], place.reshape(-1, 2).astype(np.int32), None)


GRAPHS = {"hedgehog": hedgehog, "coast": coast, "matches": matches}


def plate(sides: int = 64) -> Graph:
    """The unit square with a hole that is a regular polygon."""
    t = -2 * np.pi * np.arange(sides) / sides
    hole = CENTER + RADIUS * np.stack([np.cos(t), np.sin(t)], axis=1)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return Graph(np.concatenate([square, hole]), np.concatenate([loop(0, 4), loop(4, sides)]), CENTER)


def edge_for(triangles: int) -> float:
    """The edge length with which this number of equilateral triangles has the area of the holed square."""
    return float(np.sqrt(AREA / triangles / (np.sqrt(3) / 4)))


def graded(x: Array) -> Array:
    """The wanted edge length, which is smallest at the hole."""
    return FINEST + GROWTH * np.abs(np.hypot(x[:, 0] - 0.5, x[:, 1] - 0.5) - RADIUS)


# --- where the minimum angle is hard: corners, teeth, curves, a gap as wide as an edge ---------------------


class Outline(NamedTuple):
    """Polygons and discs, the outer one first, with a wanted edge length; the others are holes."""

    polygons: list[list[tuple[float, float]]]
    discs: list[tuple[float, float, float]]  # center and radius
    edge: float


def rhombus(degrees: float, edge: float) -> Outline:
    """A rhombus of side 1 with this acute angle."""
    t = np.radians(degrees)
    x, y = float(np.cos(t)), float(np.sin(t))
    return Outline([[(0.0, 0.0), (1.0, 0.0), (1.0 + x, y), (x, y)]], [], edge)


def comb(teeth: int, edge: float) -> Outline:
    """A bar with teeth that are four tenths of their distance wide."""
    rim = [(0.0, -0.2), (1.0, -0.2), (1.0, 0.0)]
    for i in reversed(range(teeth)):
        left, right = (i + 0.3) / teeth, (i + 0.7) / teeth
        rim += [(right, 0.0), (right, 0.5), (left, 0.5), (left, 0.0)]
    return Outline([[*rim, (0.0, 0.0)]], [], edge)


def two_holes(gap: float, edge: float) -> Outline:
    """The unit square with two round holes of radius 0.2, so far apart."""
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    return Outline([square], [(0.3 - gap / 2, 0.5, 0.2), (0.7 + gap / 2, 0.5, 0.2)], edge)


OUTLINES = {
    "rhombus 40": rhombus(40.0, 0.1),
    "rhombus 75": rhombus(75.0, 0.1),
    "comb 3": comb(3, 0.04),
    "comb 4": comb(4, 0.05),
    "annulus": Outline([], [(0.0, 0.0, 1.0), (0.0, 0.0, 0.4)], 0.1),
    "gap 0.03": two_holes(0.03, 0.02),
    "gap 0.04": two_holes(0.04, 0.02),
}


def random_outlines(count: int, seed: int = 5) -> dict[str, list[Outline]]:
    """So many outlines of each kind, with random angles, numbers, gaps and edge lengths."""
    rng = np.random.default_rng(seed)
    found: dict[str, list[Outline]] = {"comb": [], "rhombus": [], "annulus": [], "gap": []}
    for _ in range(count):
        teeth = int(rng.integers(2, 9))
        found["comb"].append(comb(teeth, float(rng.uniform(0.04, 0.29) / teeth)))
        found["rhombus"].append(rhombus(float(rng.uniform(20, 88)), float(0.2 * 0.15 ** rng.random())))
        discs = [(0.0, 0.0, 1.0), (0.0, 0.0, float(rng.uniform(0.2, 0.8)))]
        found["annulus"].append(Outline([], discs, float(0.15 * 0.27 ** rng.random())))
        found["gap"].append(two_holes(float(0.06 * 0.1 ** rng.random()), float(0.03 * 0.4 ** rng.random())))
    return found


def in_gap(x: Array) -> NDArray[np.bool_]:
    """Which points lie between the holes of `two_holes`."""
    return (np.abs(x[:, 0] - 0.5) < 0.06) & (np.abs(x[:, 1] - 0.5) < 0.08)
