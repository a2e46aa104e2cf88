"""Where triangles meet that should not, and whether two surfaces do so in the same places."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .edge_vectors import cross, lengths
from .triangle_tree import TriangleTree

__all__ = ["crossing_places", "near_places"]

Array = NDArray[np.float64]
PARALLEL_SINE = 1e-9  # of the angle of two planes: below it their common line is not to be had in numbers


def _product(u: Array, v: Array) -> Array:
    return u[..., 0] * v[..., 0] + u[..., 1] * v[..., 1] + u[..., 2] * v[..., 2]


def _heights(normal: Array, start: Array, x: Array) -> Array:
    """The products of normals (k, 3) with the corners of triangles (k, 3, 3), from a point of each plane."""
    return _product(x - start[:, None], normal[:, None])


def _span(x: Array, height: Array, line: Array) -> tuple[Array, Array]:
    """The two ends, along a line, of what a plane cuts out of triangles: points (k, 2, 3), parameters."""
    found = np.repeat(x.mean(axis=1)[:, None], 3, axis=1)
    at = np.full((len(x), 3), np.nan)
    for k in range(3):
        a, b = height[:, k], height[:, k - 2]
        cut = (a > 0.0) != (b > 0.0)
        share = np.where(cut, a / np.where(cut, a - b, 1.0), 0.0)[:, None]
        place = x[:, k] + share * (x[:, k - 2] - x[:, k])
        found[cut, k] = place[cut]
        at[cut, k] = _product(place, line)[cut]
    low, high = np.where(np.isnan(at), np.inf, at), np.where(np.isnan(at), -np.inf, at)
    rows = np.arange(len(x))
    first, last = low.argmin(axis=1), high.argmax(axis=1)
    ends = np.stack([found[rows, first], found[rows, last]], axis=1)
    return ends, np.stack([low.min(axis=1), high.max(axis=1)], axis=1)


def crossing_places(points: Array, triangles: np.ndarray, pairs: NDArray[np.int64]) -> Array:
    """The common part of each pair of triangles, rounded: (k, 3, 3).

    A segment is a triangle whose last two corners are equal. Of two triangles in one plane, or nearly so, it
    is the smaller one: what they have in common lies in it.

    Parameters
    ----------
    points : (n, 3)
        At most about 1 in magnitude.
    triangles : (m, 3) int
    pairs : (k, 2) int
        Of triangles that meet.
    """
    one, two = points[triangles[pairs[:, 0]]], points[triangles[pairs[:, 1]]]
    normals = [cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) for x in (one, two)]
    areas = [lengths(n) for n in normals]
    line = cross(*normals)
    result = np.where((areas[0] <= areas[1])[:, None, None], one, two)
    heights = _heights(normals[1], two[:, 0], one), _heights(normals[0], one[:, 0], two)
    plain = lengths(line) > PARALLEL_SINE * areas[0] * areas[1]
    for height in heights:
        plain &= (height > 0.0).any(axis=1) & (height <= 0.0).any(axis=1)
    rows = np.flatnonzero(plain)
    if len(rows):
        sides = [_span(x[rows], h[rows], line[rows]) for x, h in zip((one, two), heights)]
        ends, at = (np.concatenate([side[i] for side in sides], axis=1) for i in (0, 1))
        order = np.argsort(at, axis=1)[:, 1:3]  # the middle ones of four bound what both have
        middle = np.take_along_axis(ends, order[:, :, None], axis=1)
        result[rows] = middle[:, [0, 1, 1]]
    return result


def near_places(places: Array, others: Array, within: Array) -> NDArray[np.bool_]:
    """Whether the middle of each of ``others`` (q, 3, 3) is within a distance (q,) of some of ``places``."""
    if not len(places) or not len(others):
        return np.zeros(len(others), dtype=bool)
    middle = others.mean(axis=1)
    which, weights = TriangleTree(places).nearest(middle)
    feet = (places[which] * weights[:, :, None]).sum(axis=1)
    return lengths(feet - middle) <= within
