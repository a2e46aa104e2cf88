"""Point sets on which Delaunay triangulations are timed; each is the same at every call."""

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
