"""What the planar suite meshes: segments to be kept, a square with a round hole, sizes uniform and graded."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RADIUS = 0.25
CENTER = np.array([0.5, 0.5])
AREA = 1.0 - np.pi * RADIUS**2
FINEST, GROWTH = 0.0003, 0.1  # the graded size: at the hole, and its increase per unit of distance from it


class Graph(NamedTuple):
    """Points and segments between them that do not cross; ``hole`` is a point in the hole, if any."""

    points: Array
    segments: NDArray[np.int32]
    hole: Array | None


def loop(first: int, count: int) -> NDArray[np.int32]:
    """Segments round the vertices first, ..., first + count - 1."""
    number = np.arange(count, dtype=np.int32)
    return first + np.stack([number, (number + 1) % count], axis=1)


def hedgehog(n: int) -> Graph:
    """A closed polygon of n corners, every other one on a much smaller circle: all its angles are small."""
    t = 2 * np.pi * np.arange(n) / n
    radius = np.where(np.arange(n) % 2 == 0, 1.0, 0.7 + 0.2 * np.sin(17 * t))
    return Graph(radius[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1), loop(0, n), None)


def coast(n: int) -> Graph:
    """A closed polygon of n corners along a rough shore: waves of all lengths, never folding over."""
    rng = np.random.default_rng(3)
    t = 2 * np.pi * np.arange(n) / n
    waves = 2 ** np.arange(2, int(np.log2(n)) - 2)
    radius = 1.0 + sum(0.7 / k**0.8 * np.sin(k * t + rng.uniform(0, 2 * np.pi)) for k in waves)
    return Graph(radius[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1), loop(0, n), None)


def matches(n: int) -> Graph:
    """n / 2 short segments at random in the unit square, each in a cell of its own, none touching another."""
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
    """The unit square with a hole of so many sides."""
    t = -2 * np.pi * np.arange(sides) / sides
    hole = CENTER + RADIUS * np.stack([np.cos(t), np.sin(t)], axis=1)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return Graph(np.concatenate([square, hole]), np.concatenate([loop(0, 4), loop(4, sides)]), CENTER)


def edge_for(triangles: int) -> float:
    """The side of equilateral triangles of which so many cover the square with the round hole."""
    return float(np.sqrt(AREA / triangles / (np.sqrt(3) / 4)))


def graded(x: Array) -> Array:
    """The wanted edge length: smallest at the hole."""
    return FINEST + GROWTH * np.abs(np.hypot(x[:, 0] - 0.5, x[:, 1] - 0.5) - RADIUS)
