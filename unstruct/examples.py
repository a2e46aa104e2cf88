"""The book's running region, its size field and its points; bad triangulations to be mended.

The region is a lake in [0, 3] x [0, 2] with one island and a peninsula that bends along the shore.
Its outline is smooth and given by formulas, so that it can be sampled at any spacing. The strait
beside the peninsula is narrow: where the spacing is coarse (0.15 and above) the Delaunay triangulation
of the boundary points misses boundary edges, which is what later chapters mend.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

__all__ = ["running_points", "running_region", "running_size"]

Array = NDArray[np.float64]

ISLAND_CENTER = np.array([2.1, 0.82])
ISLAND_RADIUS = 0.2
COARSEST = 0.4  # above this spacing the polygon no longer resembles the lake


def lake_shore(t: ArrayLike) -> Array:
    """The outer shore, counterclockwise, for parameters t in [0, 2 pi); shape (..., 2)."""
    t = np.asarray(t, dtype=float)
    radius = 0.93 + 0.04 * np.cos(3.0 * t + 0.4) + 0.02 * np.sin(5.0 * t)
    x = 1.5 + 1.48 * radius * np.cos(t)
    y = 1.0 + 0.99 * radius * np.sin(t)
    land = np.exp(-((np.abs(np.cos(t) - np.cos(1.95)) / 0.05) ** 4)) * (np.sin(t) > 0)  # 1 on the peninsula
    return np.stack([x - 0.05 * land + land**4, y - 2.1 * land + 0.42 * land**3], axis=-1)


def island_shore(t: ArrayLike) -> Array:
    """The shore of the island, clockwise (water on its left), for t in [0, 2 pi); shape (..., 2)."""
    t = -np.asarray(t, dtype=float)
    radius = ISLAND_RADIUS * (1.15 + 0.15 * np.cos(2.0 * t + 0.7))
    return ISLAND_CENTER + radius[..., None] * np.stack([1.15 * np.cos(t), 1.0 * np.sin(t)], axis=-1)


def running_size(x: ArrayLike) -> Array:
    """The book's size field: 0.03 at the island, growing by 0.12 per unit of distance from it.

    Parameters
    ----------
    x : (..., 2) array

    Returns
    -------
    (...) array
        The wanted edge length, 0.03 + 0.12 * (distance to the disk of radius 0.2 in the island).
    """
    away = np.linalg.norm(np.asarray(x, dtype=float) - ISLAND_CENTER, axis=-1) - ISLAND_RADIUS
    return 0.03 + 0.12 * np.maximum(away, 0.0)


def running_region(spacing: float | Callable[[Array], Array]) -> tuple[Array, NDArray[np.int32]]:
    """The running region as a polygon with one hole.

    Parameters
    ----------
    spacing : float or function (k, 2) -> (k,)
        The wanted length of the boundary segments; `running_size` gives the graded boundary.

    Returns
    -------
    points : (n, 2) float64
        The outer shore counterclockwise, then the shore of the island clockwise.
    segments : (n, 2) int32
        The boundary edges as pairs of indices; the lake is on their left.

    Raises
    ------
    InputError
        Where the spacing is not a positive number or exceeds 0.4.
    """
    points, segments = [], []
    start = 0
    for shore in (lake_shore, island_shore):
        ring = np.round(shore(_equal_steps(shore, spacing)) * 2.0**30) / 2.0**30  # the same on any machine
        index = np.arange(start, start + len(ring))
        start += len(ring)
        points.append(ring)
        segments.append(np.stack([index, np.roll(index, -1)], axis=1))
    return np.concatenate(points), np.concatenate(segments).astype(np.int32)


def _equal_steps(shore: Callable[[ArrayLike], Array], spacing: float | Callable[[Array], Array]) -> Array:
    """Parameters on a closed curve at equal steps of the integral of ds / spacing."""
    t = np.linspace(0.0, 2.0 * np.pi, 32769)
    fine = shore(t)
    middle = (fine[1:] + fine[:-1]) / 2
    wanted = np.asarray(spacing(middle) if callable(spacing) else spacing, dtype=float)
    bad = ~((wanted > 0) & (wanted <= COARSEST))
    if bad.any():
        raise InputError(
            f"spacing {wanted[bad].flat[0]} must be in (0, {COARSEST}]: the region is about 3 by 2 long"
        )
    steps = np.linalg.norm(np.diff(fine, axis=0), axis=1) / wanted
    length = np.concatenate([[0.0], np.cumsum(steps)])
    n = max(round(length[-1]), 5)
    return np.interp(np.arange(n) * (length[-1] / n), length, t)


def running_points(seed: int = 0, *, scale: float = 1.0) -> Array:
    """Points for the running region: its graded boundary and blue noise inside.

    Parameters
    ----------
    seed : int
        Seed of the random numbers; the same seed gives the same points.
    scale : float
        Factor on `running_size`.

    Returns
    -------
    (n, 2) float64
        First the points of ``running_region(running_size)`` (with the size scaled), then the interior
        points: no two closer than about 0.75 times the wanted size, no gap much wider than it.
    """
    if not scale > 0:
        raise InputError(f"scale {scale} must be a positive number")
    boundary, segments = running_region(lambda x: scale * running_size(x))
    rng = np.random.default_rng(seed)
    total = int(60_000 / scale**2) + 1000
    candidates = rng.random((total, 2)) * [3.0, 2.0]
    keep = rng.random(total) * (running_size(candidates) / 0.03) ** 2 < 1.0  # denser where h is smaller
    candidates = candidates[keep & inside_polygon(candidates, boundary, segments)]
    distance = 0.75 * scale * running_size(candidates)
    points = np.empty((len(boundary) + len(candidates), 2))
    n = len(boundary)
    points[:n] = boundary
    for x, d in zip(candidates, distance):
        if ((points[:n] - x) ** 2).sum(axis=1).min() >= d * d:
            points[n] = x
            n += 1
    return points[:n].copy()


def inside_polygon(x: Array, points: Array, segments: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Even-odd rule in floating point, for samples that are kept away from the boundary anyway."""
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    inside = np.zeros(len(x), dtype=bool)
    for (ax, ay), (bx, by) in zip(a, b):
        crosses = (ay > x[:, 1]) != (by > x[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            inside ^= crosses & (x[:, 0] < ax + (x[:, 1] - ay) * (bx - ax) / (by - ay))
    return inside
