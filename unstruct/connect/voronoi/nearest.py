"""The nearest of many sites, exactly: by a search tree, and by rational arithmetic for near ties."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.errors import InputError
from ...predicates.batch import power_of_two
from ...predicates.power import power_factor

__all__ = ["NearestSite"]

Floats = NDArray[np.float64]

CLOSE = 1e-10  # rounding cannot change the order of two distances with a larger relative difference
UNDERFLOWS = 1e-140  # the squares of smaller scaled distances underflow
OVERFLOWS = 1e100  # the squares of larger scaled coordinates might overflow


class NearestSite:
    """A search for the nearest site.

    Parameters
    ----------
    points : (n, d) array
        Finite coordinates.
    sites : (s,) array of int
        The rows of ``points`` that are searched: distinct points.
    weights : (n,) array, optional
        Then the least ``|x - p|^2 - w`` is sought. The tree has a coordinate more, sqrt(greatest w - w),
        which is zero for queries.
    """

    def __init__(self, points: Floats, sites: NDArray[np.intp], weights: Floats | None = None):
        from scipy.spatial import cKDTree

        self.points, self.sites = points, sites
        self._scale = power_of_two(points)
        self._weights = np.zeros(len(points)) if weights is None else weights
        self._lifts = weights is not None
        rows = points[sites]
        if weights is not None:
            self._scale = min(self._scale, power_factor(points, weights))
            heavy = weights[sites] * self._scale * self._scale
            rows = np.column_stack([rows, np.sqrt(heavy.max() - heavy) / self._scale])
        self._tree = cKDTree(rows * self._scale)

    def __call__(self, x: ArrayLike) -> Any:
        """Indices of the nearest sites, shape (...), for queries (..., d); in a tie, the smallest index."""
        query, d = np.asarray(x, dtype=np.float64), self.points.shape[1]
        if query.ndim == 0 or query.shape[-1] != d:
            raise InputError(f"x has shape {query.shape}; with sites in {d} dimensions it must be (..., {d})")
        flat = query.reshape(-1, d)
        bad = np.flatnonzero(~np.isfinite(flat).all(axis=1))
        if len(bad):
            raise InputError(f"query {bad[0]} = {flat[bad[0]].tolist()} is not finite; remove it first")
        with np.errstate(over="ignore"):
            scaled = flat * self._scale
        far = np.abs(scaled).max(axis=1) >= OVERFLOWS
        if self._lifts:
            scaled = np.column_stack([scaled, np.zeros(len(scaled))])
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
            i: sum((Fraction(a) - b) ** 2 for a, b in zip(self.points[i].tolist(), exact))
            - Fraction(float(self._weights[i]))
            for i in candidates
        }
        return min(square, key=lambda i: (square[i], i))
