"""A metric in space: three directions and three wanted lengths at every place.

At each place three orthogonal directions d_i have wanted lengths h_i. The metric is the matrix
M = sum d_i d_i' / h_i^2; the length of a vector v is sqrt(v' M v), and the wanted length of an edge is 1. The
vectors of length 1 are an ellipsoid with the half-axes h_i d_i. Book: 3.3, 3.5.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_numbers
from ..base.errors import InputError
from .any_metric import AnyMetric, asked, directions_of, frozen, landmarks_of
from .field import SizeField, as_size
from .space_metric_table import SpaceMetricNodes, cholesky_rows, space_metric_nodes
from .space_spectrum import ENTRY_OF_MATRIX, IN_ROW, intersect_in_space, inverted_in_space, spectrum_in_space

__all__ = [
    "MOST_SPACE_STRETCH", "InverseSpaceMetric", "SpaceMetric", "directional_space", "intersection_space",
    "matrix_rows",
]  # fmt: skip

Array = NDArray[np.float64]
MOST_SPACE_STRETCH = 1e5  # the largest ratio of two lengths: of its square, doubles keep six digits
LEAST_IN_SPACE = 1e-90  # least length, and the inverse of the largest: cubes of squares are doubles
SYMMETRIC_UP_TO = 1e-9  # relative difference of two entries that count as equal
RIGHT_ANGLE = 1e-6  # largest cosine between two directions that count as orthogonal


class SpaceMetric(AnyMetric):
    """Wanted lengths in three orthogonal directions at every place of space.

    Parameters
    ----------
    function : callable
        Takes points of shape (k, 3) and returns k symmetric positive definite matrices, shape (k, 3, 3).
    landmarks : array_like, shape (j, 3), optional
        Places where the metric has details that coarse sampling would miss.
    name : str, optional
        The name that `repr` shows.

    Attributes
    ----------
    constant : ndarray, shape (3, 3), or None
        The matrix, if it is the same everywhere; otherwise None.

    Notes
    -----
    `unstruct.sizing` makes metrics in space from directions and lengths (`directional_space`), from matrices
    at the vertices of tetrahedra (`metric_background`), from second derivatives (`metric_from_hessian`), and
    from other metrics (`intersection_space`, `gradation`). `unstruct.advancing_front` meshes bodies by them.
    The ratio of two lengths at a place must not exceed 10^5.

    Examples
    --------
    >>> import unstruct
    >>> metric = unstruct.sizing.SpaceMetric(lambda x: [[[4.0, 0, 0], [0, 4, 0], [0, 0, 100]]] * len(x))
    >>> metric.lengths([[0, 0, 0]])
    array([[0.5, 0.5, 0.1]])
    >>> metric.length([[0, 0, 0]], [[0, 0, 3]])
    array([30.])
    """

    dimension, kind, title = 3, "a metric in space", "SpaceMetric"

    def _inverses(self, points: Array, first: int) -> Array:
        return inverted_in_space(matrix_rows(asked(self.function, points, first, "metric"), points, first))

    def at(self, x: ArrayLike) -> Array:
        """The matrices M at points, (k, 3) -> (k, 3, 3). For errors see `inverses`."""
        return inverted_in_space(self.inverses(x))[:, ENTRY_OF_MATRIX]

    def lengths(self, x: ArrayLike) -> Array:
        """The three wanted lengths at points, the longest first: (k, 3) -> (k, 3)."""
        return np.sqrt(spectrum_in_space(self.inverses(x))[0])

    def directions(self, x: ArrayLike) -> Array:
        """The directions of the `lengths`, unit vectors as rows: (k, 3) -> (k, 3, 3)."""
        return spectrum_in_space(self.inverses(x))[1]

    def length(self, x: ArrayLike, vectors: ArrayLike) -> Array:
        """The metric lengths sqrt(v' M v) of vectors at points, (k, 3), (k, 3) -> (k,)."""
        v = as_numbers(vectors, "vectors")
        rows = self.inverses(x)
        if v.shape != (len(rows), 3):
            raise InputError(f"vectors must have shape ({len(rows)}, 3), not {v.shape}")
        a, b, c, d, e, f = cholesky_rows(rows).T
        exponent = np.frexp(np.abs(v).max(axis=1, initial=0.0))[1]
        v = np.ldexp(v, -exponent[:, None])  # squares of long and short vectors may be no doubles
        one = v[:, 0] / a
        two = (v[:, 1] - b * one) / c
        three = (v[:, 2] - d * one - e * two) / f
        with np.errstate(over="ignore"):
            return np.ldexp(np.sqrt(one * one + two * two + three * three), exponent)

    def along(self, x: ArrayLike, direction: ArrayLike) -> Array:
        """The wanted length in a direction: (k, 3), (k, 3) -> (k,); the length of a direction is ignored.

        Raises
        ------
        InputError
            For a direction of no length, or one that is not finite.
        """
        v, size = directions_of(direction, 3)
        v = np.ldexp(v, -np.frexp(size)[1][:, None])  # squares of long and short vectors may be no doubles
        return np.sqrt(np.square(v).sum(axis=1)) / self.length(x, v)

    def table(self, lower: ArrayLike, upper: ArrayLike, factor: float = 1.0) -> SpaceMetricNodes:
        """The metric over a box, as arrays that kernels read; see `space_metric_nodes`."""
        box = np.array([as_numbers(lower, "lower"), as_numbers(upper, "upper")])
        if box.shape != (2, 3) or not (np.isfinite(box).all() and (box[0] < box[1]).all()):
            raise InputError("lower and upper must be opposite corners (x, y, z) of a box, lower < upper")
        marks = self.landmarks
        marks = marks[((marks >= box[0]) & (marks <= box[1])).all(axis=1)]
        return space_metric_nodes(self.inverses, box, factor, marks, self.constant is not None)


class InverseSpaceMetric(SpaceMetric):
    """A metric whose function returns the inverse matrices, rows (k, 6), which are known to be valid."""

    def _inverses(self, points: Array, first: int) -> Array:
        return self.function(points)


def directional_space(directions: ArrayLike | Callable[[Array], Any], lengths: Any) -> SpaceMetric:
    """A metric in space from three directions and three lengths.

    Parameters
    ----------
    directions : array_like, shape (3, 3), or function (k, 3) -> (k, 3, 3)
        Three orthogonal vectors as rows; their lengths and their signs do not matter.
    lengths : sequence of three of: number, function (k, 3) -> (k,), or SizeField
        The wanted lengths in these directions.

    Returns
    -------
    SpaceMetric

    Raises
    ------
    InputError
        For directions that are zero, not finite or not orthogonal, for lengths that are not positive and
        finite, and for a ratio of lengths above 10^5; the message names the first point concerned.

    Notes
    -----
    O(k) for k points. Source: P. L. George, H. Borouchaki, Delaunay Triangulation and Meshing (1998).
    Book: 3.3, 3.5.

    Examples
    --------
    >>> import unstruct
    >>> layer = unstruct.sizing.directional_space(
    ...     [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0.5, 0.5, lambda x: 0.01 + 0.2 * x[:, 2]]
    ... )
    >>> layer.lengths([[0, 0, 0], [0, 0, 1]]).round(6)
    array([[0.5 , 0.5 , 0.01],
           [0.5 , 0.5 , 0.21]])
    """
    try:
        three = list(lengths)
    except TypeError:
        three = []
    if len(three) != 3 or isinstance(lengths, (str, bytes, dict)):
        raise InputError("lengths must be three sizes, one for each direction")
    sizes = [as_size(one) for one in three]
    if callable(directions):
        given: Any = directions
    else:
        frame = as_numbers(directions, "directions")
        if frame.shape != (3, 3):
            raise InputError(f"directions must have shape (3, 3), not {frame.shape}")
        given = partial(_repeated, frame)
    metric = InverseSpaceMetric(
        partial(_framed, given, sizes),
        landmarks=landmarks_of(sizes, 3),
        name="three directions and lengths",
    )
    return metric if callable(directions) else frozen(metric, sizes)


def _repeated(frame: Array, x: Array) -> Array:
    return np.tile(frame, (len(x), 1, 1))


def _framed(directions: Callable[[Array], Any], sizes: list[SizeField], x: Array) -> Array:
    """The rows of the inverse metric."""
    d = np.array(asked(directions, x, 0, "directions"), dtype=np.float64)
    if d.shape != (len(x), 3, 3):
        raise InputError(
            f"the directions must have shape {(len(x), 3, 3)} for {len(x)} points, not {d.shape}"
        )
    size = np.abs(d).max(axis=2, initial=0.0)
    bad = ~(np.isfinite(size) & (size > 0)).all(axis=1)
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(
            f"directions are {d[row].tolist()} at x[{row}] = {x[row].tolist()}; they must be finite, "
            "and none zero"
        )
    d /= size[:, :, None]
    d /= np.sqrt(np.square(d).sum(axis=2))[:, :, None]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        dot = (d[:, i] * d[:, j]).sum(axis=1)
        if (np.abs(dot) > RIGHT_ANGLE).any():
            row = int(np.argmax(np.abs(dot)))
            raise InputError(
                f"directions {i} and {j} have the cosine {dot[row]:g} at x[{row}] = {x[row].tolist()}; they "
                "must be orthogonal"
            )
        d[:, j] -= dot[:, None] * d[:, i]
    h = np.stack([one(x) for one in sizes], axis=1)
    _check_lengths(h, x)
    h *= h
    rows = np.zeros((len(x), 6))
    for k in range(3):
        rows += h[:, k, None] * d[:, k, IN_ROW[0]] * d[:, k, IN_ROW[1]]
    return rows


def _check_lengths(h: Array, x: Array) -> None:
    """Refuse lengths with which doubles do not get along."""
    low, high = h.min(axis=1, initial=np.inf), h.max(axis=1, initial=0.0)
    bad = (
        (high > MOST_SPACE_STRETCH * low * (1 + 1e-9)) | (low < LEAST_IN_SPACE) | (high > 1 / LEAST_IN_SPACE)
    )
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(
            f"the lengths are {h[row].tolist()} at x[{row}] = {x[row].tolist()}: their ratio must not exceed "
            f"{MOST_SPACE_STRETCH:g}, and they must be in the range of doubles; bound them"
        )


def intersection_space(*metrics: Any) -> SpaceMetric:
    """The metric in space that asks for what each of several asks for: the largest ellipsoid within them all.

    Parameters
    ----------
    *metrics : SpaceMetric, or any size
        Sizes count as metrics with the same length in all directions.

    Returns
    -------
    SpaceMetric
        Largest for two metrics. Three or more are intersected one after the other, and the result depends a
        little on their order.

    Raises
    ------
    InputError
        Without a metric, and as `SpaceMetric.inverses` does; also if the result has a ratio above 10^5.

    Notes
    -----
    In the coordinates in which the first matrix is the identity the second one is N; of the eigenvalues of N
    those below 1 are replaced by 1. O(k) for k points. Source: F. Alauzet, Finite Elements in Analysis and
    Design 46 (2010) 181-202. Book: 3.3.

    Examples
    --------
    >>> import unstruct
    >>> flat = unstruct.sizing.directional_space([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [1, 1, 0.1])
    >>> unstruct.sizing.intersection_space(flat, 0.5).lengths([[0, 0, 0]]).round(6)
    array([[0.5, 0.5, 0.1]])
    """
    if not metrics:
        raise InputError("intersection_space needs at least one metric")
    frame = np.eye(3)
    every = [
        one if isinstance(one, SpaceMetric) else directional_space(frame, [as_size(one)] * 3)
        for one in metrics
    ]
    if len(every) == 1:
        return every[0]
    metric = InverseSpaceMetric(
        partial(_met, every),
        landmarks=landmarks_of(every, 3),
        name=f"intersection of {len(every)}",
    )
    return frozen(metric, every)


def _met(metrics: list[SpaceMetric], x: Array) -> Array:
    """The inverse matrices of the intersection: B = L L', and of L^-1 B2 L^-T no eigenvalue above 1 stays."""
    rows = metrics[0].inverses(x)
    for one in metrics[1:]:
        intersect_in_space(rows, cholesky_rows(rows), one.inverses(x))
    _check_lengths(np.sqrt(spectrum_in_space(rows)[0]), x)
    return rows


def matrix_rows(matrices: Any, points: Array, first: int = 0) -> Array:
    """Rows (k, 6) of matrices (k, 3, 3), which are checked; ``points[0]`` is row ``first`` for messages."""
    array = as_numbers(matrices, "metric")
    if array.shape != (len(points), 3, 3):
        raise InputError(
            f"metric must have shape {(len(points), 3, 3)} for {len(points)} points, not {array.shape}"
        )
    rows = 0.5 * array[:, IN_ROW[0], IN_ROW[1]] + 0.5 * array[:, IN_ROW[1], IN_ROW[0]]
    size = np.abs(array).max(axis=(1, 2), initial=0.0)
    finite = np.isfinite(size) & (size > 0)
    half = 0.5 * array
    apart = np.abs(half - half.swapaxes(1, 2)).max(axis=(1, 2), initial=0.0)
    even = apart <= 0.5 * SYMMETRIC_UP_TO * size
    values = spectrum_in_space(np.where(finite[:, None], rows, [1.0, 0, 1, 0, 0, 1]))[0]
    positive = finite & (values[:, 2] > 0)
    near = values[:, 0] / (MOST_SPACE_STRETCH**2 * (1 + 1e-3)) <= values[:, 2]
    near &= (values[:, 2] > LEAST_IN_SPACE**2) & (values[:, 0] < LEAST_IN_SPACE**-2)
    bad = ~(even & positive & near)
    if bad.any():
        row = int(np.argmax(bad))
        wrong = "symmetric" if positive[row] and not even[row] else "positive definite and finite"
        if positive[row] and even[row]:
            wrong = f"such that the ratio of its lengths is at most {MOST_SPACE_STRETCH:g}; bound it"
        where = f"x[{first + row}] = {points[row].tolist()}"
        raise InputError(f"metric is {array[row].tolist()} at {where}: it must be {wrong}")
    return rows
