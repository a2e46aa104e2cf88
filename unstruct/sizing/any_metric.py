"""What metrics of the plane and of space have in common: a function, landmarks, and what is asked of them.

A symmetric matrix is a row of its entries, 3 in the plane and 6 in space. Book: 3.3, 3.5.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_numbers, as_points
from ..base.asking import asked_at
from ..base.errors import InputError
from .field import ASKED_AT_ONCE

__all__ = ["AnyMetric", "asked", "directions_of", "frozen", "landmarks_of"]

Array = NDArray[np.float64]


def directions_of(direction: ArrayLike, dimension: int) -> tuple[Array, Array]:
    """Finite directions (k, d) that are not zero, and their largest entries (k,); an error for others."""
    v = as_numbers(direction, "direction")
    if v.ndim != 2 or v.shape[1] != dimension:
        raise InputError(f"direction must have shape (k, {dimension}), not {v.shape}")
    size = np.abs(v).max(axis=1, initial=0.0)
    wrong = np.flatnonzero(~((size > 0) & np.isfinite(size)))
    if len(wrong):
        k = int(wrong[0])
        raise InputError(f"direction[{k}] = {v[k].tolist()} must be finite, and not zero")
    return v, size


class AnyMetric(ABC):
    """Wanted lengths that depend on the direction, at every place; `Metric` and `SpaceMetric` are such.

    Parameters
    ----------
    function, landmarks, name
        As for these.
    """

    dimension: int  # of a place
    kind: str  # what messages say of such a metric
    title: str  # what `repr` calls it

    def __init__(
        self,
        function: Callable[[Array], Any],
        *,
        landmarks: ArrayLike | None = None,
        name: str = "function",
    ):
        if not callable(function):
            raise InputError(f"a metric needs a function of points, not {type(function).__name__}")
        self.function, self.name = function, name
        marks = np.empty((0, self.dimension)) if landmarks is None else as_points(landmarks, "landmarks")
        if marks.shape[1] != self.dimension:
            raise InputError(f"landmarks must have shape (j, {self.dimension}), not {marks.shape}")
        self.landmarks: Array = marks
        self.constant: Array | None = None

    def places(self, x: ArrayLike) -> Array:
        """Places as an array (k, d), or an `InputError`."""
        points = as_points(x, "x")
        if points.shape[1] != self.dimension:
            raise InputError(f"{self.kind}: x must have shape (k, {self.dimension}), not {points.shape}")
        return points

    def inverses(self, x: ArrayLike) -> Array:
        """The inverse matrices B = sum h_i^2 d_i d_i' at points, (k, d) -> rows (k, d (d + 1) / 2).

        Rows are b11, b12, b22 in the plane, and b11, b21, b22, b31, b32, b33 in space.

        Raises
        ------
        InputError
            If the function raises an error or returns anything but k symmetric positive definite matrices;
            the message names the first point concerned.
        """
        points, d = self.places(x), self.dimension
        result = np.empty((len(points), d * (d + 1) // 2))
        for i in range(0, len(points), ASKED_AT_ONCE):
            result[i : i + ASKED_AT_ONCE] = self._inverses(points[i : i + ASKED_AT_ONCE], i)
        return result

    @abstractmethod
    def _inverses(self, points: Array, first: int) -> Array:
        """The inverse matrices at some points; ``points[0]`` is row ``first`` of the caller's array."""

    @abstractmethod
    def at(self, x: ArrayLike) -> Array:
        """The matrices M at points, (k, d) -> (k, d, d). For errors see `inverses`."""

    def __repr__(self) -> str:
        if self.constant is not None:
            return f"<{self.title}: constant {self.constant.tolist()}>"
        return f"<{self.title}: {self.name}>"


def landmarks_of(parts: Sequence[Any], dimension: int) -> Array:
    """The landmarks of sizes or metrics, so far as they are places with so many coordinates."""
    marks = [one.landmarks for one in parts if one.landmarks.shape[1:] == (dimension,)]
    return np.concatenate([np.empty((0, dimension)), *marks])


def frozen(metric: Any, parts: Sequence[Any]) -> Any:
    """The metric, which is said to be constant if all that it is made of is."""
    if all(one.constant is not None for one in parts):
        metric.constant = metric.at(np.zeros((1, metric.dimension)))[0]
    return metric


def asked(function: Callable[[Array], Any], points: Array, first: int, what: str) -> Any:
    """What a function returns at some points; ``points[0]`` is row ``first`` of the caller's array."""
    takes = f"points (k, {points.shape[1]})"
    return asked_at(function, points, f"the function of the {what}", takes, first=first)
