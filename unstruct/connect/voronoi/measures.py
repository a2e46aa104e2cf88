"""The sizes of Voronoi cells up to three dimensions: lengths, areas, volumes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .dual import Ridges

__all__ = ["cell_sizes"]

Floats = NDArray[np.float64]


def cell_sizes(
    own: Floats, heavy: Floats, ridges: Ridges, base: NDArray[np.int32], offset: Floats
) -> NDArray[Any]:
    """The sizes of bounded cells, as sums of pyramids over their ridges; those of others mean nothing.

    Parameters
    ----------
    own, heavy : (n, d) and (n,) arrays
        Sites and their weights, scaled.
    ridges : Ridges
    base, offset : arrays
        The Voronoi vertices, from `local_circumcenters`.
    """
    pairs, (n, d) = ridges.points, own.shape
    distance = np.sqrt(((own[pairs[:, 1]] - own[pairs[:, 0]]) ** 2).sum(axis=1))
    size = _ridge_sizes(own, ridges, base, offset)
    shift = heavy[pairs[:, 0]] - heavy[pairs[:, 1]]
    if not shift.any():
        return np.bincount(pairs.ravel(), np.repeat(size * (distance / 2), 2), minlength=n) / d
    heights = np.stack([distance / 2 + shift / (2 * distance), distance / 2 - shift / (2 * distance)], axis=1)
    total: NDArray[Any] = np.bincount(pairs.ravel(), (size[:, None] * heights).ravel(), minlength=n) / d
    return np.maximum(total, 0.0)  # a hidden site has nothing; rounding must not make it negative


def _ridge_sizes(own: Floats, ridges: Ridges, base: NDArray[np.int32], offset: Floats) -> NDArray[Any]:
    """Scaled lengths or areas of the bounded ridges; 0 for unbounded ones."""
    d, count = own.shape[1], np.diff(ridges.start)
    owner = np.repeat(np.arange(len(count)), count)
    bounded = ridges.vertices[ridges.start[:-1]] >= 0
    if d == 1:
        return bounded.astype(float)
    site, last = ridges.points[owner, 0], np.roll(np.arange(len(owner)), -1)
    last[ridges.start[1:] - 1] = ridges.start[:-1]
    kept = bounded[owner]
    corner = np.zeros((len(owner), d))  # relative to the first site of the ridge
    v = ridges.vertices[kept]
    corner[kept] = (own[base[v]] - own[site[kept]]) + offset[v]
    corner -= corner[np.repeat(ridges.start[:-1], count)]
    if d == 2:
        lengths: NDArray[Any] = np.sqrt((corner[ridges.start[1:] - 1] ** 2).sum(axis=1))
        return lengths
    turn = np.cross(corner, corner[last])
    sizes: NDArray[Any] = np.sqrt((np.add.reduceat(turn, ridges.start[:-1], axis=0) ** 2).sum(axis=1)) / 2
    return sizes
