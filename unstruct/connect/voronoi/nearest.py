"""The nearest of many sites, exactly: a search tree, and rational arithmetic where it is a near tie."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.errors import InputError
from ...predicates.batch import power_of_two

__all__ = ["NearestSite"]

Floats = NDArray[np.float64]

CLOSE = 1e-10  # relative difference of two distances above which rounding cannot exchange them
UNDERFLOWS = 1e-140  # scaled distances below which squares underflow
OVERFLOWS = 1e100  # scaled queries beyond which squares might overflow


class NearestSite:
    """A search for the nearest site.

    Parameters
    ----------
    points : (n, d) array
        Finite.
    sites : (s,) array of int
        The rows of ``points`` to choose from: distinct points, two at least.
    """

    def __init__(self, points: Floats, sites: NDArray[np.intp]):
        from scipy.spatial import cKDTree

        self.points, self.sites = points, sites
        self._scale = power_of_two(points)
        self._tree = cKDTree(points[sites] * self._scale)

    def __call__(self, x: ArrayLike) -> Any:
        """Indices of the nearest sites, shape (...), of queries (..., d): the least index in a tie."""
        query, d = np.asarray(x, dtype=np.float64), self.points.shape[1]
        if query.ndim == 0 or query.shape[-1] != d:
            raise InputError(f"x has shape {query.shape}; with sites in {d} dimensions it must be (..., {d})")
        flat = query.reshape(-1, d)
        bad = np.flatnonzero(~np.isfinite(flat).all(axis=1))
        if len(bad):
            raise InputError(f"query {bad[0]} is {flat[bad[0]].tolist()}, not finite; drop it")
        with np.errstate(over="ignore"):
            scaled = flat * self._scale
        far = np.abs(scaled).max(axis=1) >= OVERFLOWS
        distance, place = self._tree.query(np.where(far[:, None], 0.0, scaled), k=2)
        found = self.sites[place[:, 0]]
        doubtful = far | (distance[:, 1] * (1 - CLOSE) <= distance[:, 0]) | (distance[:, 1] < UNDERFLOWS)
        for q in np.flatnonzero(doubtful).tolist():
            candidates = self.sites
            if not far[q]:
                reach = distance[q, 0] * (1 + CLOSE) + UNDERFLOWS
                candidates = self.sites[self._tree.query_ball_point(scaled[q], reach)]
            found[q] = self._exactly(flat[q].tolist(), candidates.tolist())
        return int(found[0]) if query.ndim == 1 else found.reshape(query.shape[:-1])

    def _exactly(self, x: list[float], candidates: list[int]) -> int:
        exact = [Fraction(c) for c in x]
        square = {
            i: sum((Fraction(a) - b) ** 2 for a, b in zip(self.points[i].tolist(), exact)) for i in candidates
        }
        return min(square, key=lambda i: (square[i], i))
