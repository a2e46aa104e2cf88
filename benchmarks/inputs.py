"""Point sets on which Delaunay triangulations are timed, and a coast; each is the same at every call."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def uniform(n: int, d: int) -> Points:
    """Random points of the unit square or cube."""
    return np.random.default_rng(1).random((n, d))


def clustered(n: int, d: int) -> Points:
    """A hundred normally distributed clouds of width 1/1000 around random centers."""
    rng = np.random.default_rng(2)
    centers = rng.random((100, d))
    return centers[rng.integers(0, len(centers), n)] + 1e-3 * rng.standard_normal((n, d))


def lattice(n: int, d: int) -> Points:
    """Integer points in random order: every square is cocircular, and every cube cospherical."""
    side = round(n ** (1 / d))
    points = np.stack(np.meshgrid(*[np.arange(side, dtype=float)] * d), axis=-1).reshape(-1, d)
    return np.random.default_rng(3).permutation(points)


def sphere(n: int, d: int) -> Points:
    """Random points on the unit circle or sphere, up to rounding; all are on the hull."""
    points = np.random.default_rng(4).standard_normal((n, d))
    return points / np.linalg.norm(points, axis=1)[:, None]


KINDS: dict[str, Callable[[int, int], Points]] = {
    "uniform": uniform,
    "clustered": clustered,
    "lattice": lattice,
    "circle": sphere,
    "sphere": sphere,
}


# ---------------------------------------------------------------------- a coast with islands

# An edge owns the rhombus about it whose angles at the ends are twice 30 degrees. The four edges that take
# its place have their rhombi within it, and these touch only in common vertices; so rings never meet. A bump
# is at most 0.2 high: then its edges rise by at most 50.2 degrees, and 50.2 + 30 < 90.
BUMP = 0.2
REACH = 0.38  # the radius of an island's first hexagon, in sides of its square; with its rhombi 0.44


def fractal_coast(n: int = 720_000, islands: int = 9_139) -> list[Points]:
    """Rings of n corners together: a fractal shore, then the islands within it, of very different sizes.

    The rings are simple and do not meet, by construction (Koch's, with bumps of random height and side). The
    longest edges are replaced first, each by four. Islands lie in the squares of a random quadtree.
    """
    if (islands - 1) % 3 or (n - 6 * (islands + 1)) % 3 or n < 6 * (islands + 1):
        raise ValueError("islands - 1 and n must be multiples of 3, with n >= 6 (islands + 1)")
    rng = np.random.default_rng(10)
    squares = np.array([[-0.5, -0.5, 1.0]])  # left, bottom, side; it is free of the rhombi of the shore
    while len(squares) < islands:
        chosen = rng.permutation(len(squares))[
            : max(1, min(len(squares) // 2, (islands - len(squares)) // 3))
        ]
        x, y, side = squares[chosen].T
        half = side / 2
        parts = [np.column_stack([x + i * half, y + j * half, half]) for i in (0, 1) for j in (0, 1)]
        squares = np.concatenate([np.delete(squares, chosen, axis=0), *parts])
    centers = np.concatenate([[[0.0, 0.0]], squares[:, :2] + squares[:, 2:] / 2])
    radii = np.concatenate([[1.0], REACH * squares[:, 2] * rng.uniform(0.3, 1.0, islands)])
    angle = np.arange(6) * np.pi / 3
    start = centers[:, None] + radii[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    ring = np.repeat(np.arange(islands + 1), 6)
    a, b = start.reshape(-1, 2), np.roll(start, -1, axis=1).reshape(-1, 2)
    while len(a) < n:
        length = np.hypot(*(b - a).T)
        order = np.argsort(-length, kind="stable")
        longest = int((length > 0.6 * length[order[0]]).sum())
        a, b, ring = _bumps(a, b, ring, order[: min(longest, (n - len(a)) // 3)], rng)
    return np.split(a, np.nonzero(np.diff(ring))[0] + 1)


def _bumps(
    a: Points, b: Points, ring: NDArray[np.int64], rows: NDArray[np.int64], rng: np.random.Generator
) -> tuple[Points, Points, NDArray[np.int64]]:
    """Edges from a to b, in order along their rings; four edges with a bump replace each of some rows."""
    times = np.ones(len(a), dtype=np.int64)
    times[rows] = 4
    along = b[rows] - a[rows]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    height = BUMP * rng.choice([-1.0, 1.0], (len(rows), 1)) * rng.uniform(0.3, 1.0, (len(rows), 1))
    first, last = a[rows] + along / 3, b[rows] - along / 3
    top = a[rows] + along / 2 + height * across
    place = (np.cumsum(times) - times)[rows]
    start, end = np.repeat(a, times, axis=0), np.repeat(b, times, axis=0)
    for k, (p, q) in enumerate(((a[rows], first), (first, top), (top, last), (last, b[rows]))):
        start[place + k], end[place + k] = p, q
    return start, end, np.repeat(ring, times)
