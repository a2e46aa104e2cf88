"""A metric: wanted lengths that depend on the direction.

At each place two orthogonal directions d_1, d_2 have wanted lengths h_1, h_2. The metric is the matrix
M = sum d_i d_i' / h_i^2; the length of a vector v is sqrt(v' M v), and the wanted length of an edge is 1. The
vectors of length 1 are an ellipse with the half-axes h_i d_i. See the book, chapter 3.3.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_numbers
from ..base.errors import InputError
from .any_metric import AnyMetric, asked, directions_of
from .metric_table import MetricTable, build_metric, inverted, spectrum

__all__ = ["LEAST_WANTED", "MOST_STRETCH", "InverseMetric", "Metric", "symmetric_rows"]

Array = NDArray[np.float64]
LEAST_WANTED = 1e-145  # of which, and of whose inverse, the square is a double with some room
MOST_STRETCH = 1e6  # the largest ratio of two lengths that doubles can carry through all computations


class Metric(AnyMetric):
    """Wanted lengths in two orthogonal directions at every place of the plane.

    Parameters
    ----------
    function : callable
        Takes points of shape (k, 2) and returns k symmetric positive definite matrices, shape (k, 2, 2).
    landmarks : array_like, shape (j, 2), optional
        Places where the metric has details that coarse sampling would miss; `table` evaluates it there, too.
    name : str, optional
        The name that `repr` shows.

    Attributes
    ----------
    constant : ndarray, shape (2, 2), or None
        The matrix, if it is the same everywhere; otherwise None.

    Notes
    -----
    `unstruct.sizing` makes metrics from directions and lengths (`directional`), from matrices at the vertices
    of a mesh (`metric_background`), from second derivatives (`metric_from_hessian`), and from other metrics
    (`intersection`, `gradation`). The ratio of the two lengths at a place must not exceed 10^6.

    Examples
    --------
    >>> import unstruct
    >>> metric = unstruct.sizing.Metric(lambda x: [[[4.0, 0.0], [0.0, 100.0]]] * len(x))
    >>> metric.lengths([[0, 0]])
    array([[0.5, 0.1]])
    >>> metric.along([[0, 0]], [[3, 0]])
    array([0.5])
    """

    dimension, kind, title = 2, "a metric is of the plane", "Metric"

    def inverses(self, x: ArrayLike) -> Array:
        """The inverse matrices B = sum h_i^2 d_i d_i' at points, (k, 2) -> (k, 3): rows b11, b12, b22.

        Raises
        ------
        InputError
            If the function raises an error or returns anything but k symmetric positive definite matrices;
            the message names the first point concerned.
        """
        if self.constant is None:
            return super().inverses(x)
        row = inverted(symmetric_rows(self.constant[None], "metric"))
        return np.tile(row, (len(self.places(x)), 1))

    def _inverses(self, points: Array, first: int) -> Array:
        """The inverse matrices at some points; ``points[0]`` is row ``first`` of the caller's array."""
        raw = asked(self.function, points, first, "metric")
        return inverted(symmetric_rows(raw, "metric", points, first))

    def at(self, x: ArrayLike) -> Array:
        """The matrices M at points, (k, 2) -> (k, 2, 2). For errors see `inverses`."""
        return inverted(self.inverses(x))[:, [[0, 1], [1, 2]]]

    def lengths(self, x: ArrayLike) -> Array:
        """The two wanted lengths at points, the longer one first: (k, 2) -> (k, 2)."""
        return np.sqrt(np.stack(spectrum(self.inverses(x)), axis=1))

    def directions(self, x: ArrayLike) -> Array:
        """The direction of the longer length at points, unit vectors with x >= 0: (k, 2) -> (k, 2)."""
        a, b, c = self.inverses(x).T
        angle = 0.5 * np.arctan2(2 * b, a - c)
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def along(self, x: ArrayLike, direction: ArrayLike) -> Array:
        """The wanted length in a direction: (k, 2), (k, 2) -> (k,); the length of a direction is ignored.

        Raises
        ------
        InputError
            For a direction of no length, or one that is not finite.
        """
        v, size = directions_of(direction, 2)
        v = v / size[:, None]
        return np.hypot(*v.T) / self._length(x, v)

    def length(self, x: ArrayLike, vectors: ArrayLike) -> Array:
        """The metric lengths sqrt(v' M v) of vectors at points, (k, 2), (k, 2) -> (k,)."""
        return self._length(x, as_numbers(vectors, "vectors"))

    def _length(self, x: ArrayLike, v: Array) -> Array:
        a, b, c = self.inverses(x).T
        # With B = U U', U upper triangular, the length is that of the solution of U w = v.
        with np.errstate(over="ignore"):  # what is longer than all doubles is infinite
            second = v[:, 1] / np.sqrt(c)
            first = (v[:, 0] - b / c * v[:, 1]) / np.sqrt(a - b / c * b)
            return np.hypot(first, second)

    def table(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        factor: float = 1.0,
        tolerance: float = 0.05,
        max_depth: int = 20,
        max_nodes: int = 200_000,
    ) -> MetricTable:
        """The metric over a box, as arrays that kernels read; see `MetricTable`.

        Parameters
        ----------
        lower, upper : array_like, shape (2,)
            Opposite corners of the box.
        factor : float
            Coordinates and lengths of the table are multiplied by it.
        tolerance : float
            A leaf is divided while a length in some direction differs by more than this, relatively, from
            that of the interpolant at one of nine points, or at a landmark.
        max_depth, max_nodes : int
            Limits beyond which no leaf is divided.

        Raises
        ------
        InputError
            For an empty or infinite box, and for lengths whose squares leave the range of doubles.
        """
        constant = None if self.constant is None else inverted(symmetric_rows(self.constant[None], "metric"))
        return build_metric(
            self.inverses, lower, upper, constant=constant, landmarks=self.landmarks, factor=factor,
            tolerance=tolerance, max_depth=max_depth, max_nodes=max_nodes,
        )  # fmt: skip


class InverseMetric(Metric):
    """A metric whose function returns the inverse matrices, rows (k, 3), which are known to be valid."""

    def _inverses(self, points: Array, first: int) -> Array:
        return self.function(points)


def symmetric_rows(matrices: Any, what: str, points: Array | None = None, first: int = 0) -> Array:
    """Symmetric positive definite matrices as rows (k, 3); an `InputError` names the first that is not.

    Parameters
    ----------
    matrices : array_like, shape (k, 2, 2)
    what : str
        What they are, for the message.
    points : ndarray, shape (k, 2), optional
        Where they are; without it the message has their row only.
    first : int
        The number of the first row.
    """
    raw = np.asarray(matrices)
    count = len(raw) if points is None and raw.ndim else len(points) if points is not None else 0
    if raw.shape != (count, 2, 2):
        raise InputError(f"{what} must give matrices of shape ({count}, 2, 2), not {raw.shape}")
    if raw.dtype.kind not in "fiu" or np.ma.isMaskedArray(matrices):
        raise InputError(f"{what} must give plain real numbers, not {type(matrices)} of {raw.dtype}")
    array = raw.astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore", under="ignore"):
        rows = np.stack([array[:, 0, 0], 0.5 * (array[:, 0, 1] + array[:, 1, 0]), array[:, 1, 1]], axis=1)
        large, small = spectrum(rows)
        even = np.abs(array[:, 0, 1] - array[:, 1, 0]) <= 1e-12 * large
        positive = np.isfinite(array).all(axis=(1, 2)) & (rows[:, 0] > 0) & (rows[:, 2] > 0) & (small > 0)
        positive &= (large < LEAST_WANTED**-2.0) & (small > LEAST_WANTED**2.0)
        near = small >= large / (MOST_STRETCH * MOST_STRETCH) * (1 - 1e-3)
    bad = ~(even & positive & near)
    if bad.any():
        row = int(np.argmax(bad))
        where = f"row {first + row}" if points is None else f"x[{first + row}] = {points[row].tolist()}"
        wrong = "symmetric" if positive[row] and not even[row] else "positive definite and finite"
        remedy = f"it must be {wrong}"
        if positive[row] and even[row]:
            remedy = f"the ratio of its lengths must not exceed {MOST_STRETCH:g}; bound it"
        raise InputError(f"{what} is {array[row].tolist()} at {where}: {remedy}")
    return rows
