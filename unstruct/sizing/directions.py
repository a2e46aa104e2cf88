"""Metrics from directions and lengths, and the intersection of metrics.

See the book, chapter 3.3.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_numbers
from ..base.errors import InputError
from ..base.jit import inline, kernel
from .any_metric import asked, frozen, landmarks_of
from .field import SizeField, as_size
from .metric import LEAST_WANTED, MOST_STRETCH, InverseMetric, Metric
from .metric_table import inverted, larger_eigenvalue

__all__ = ["as_metric", "directional", "intersect_rows", "intersected", "intersection"]

Array = NDArray[np.float64]


def directional(direction: ArrayLike | Callable[[Array], Any], along: Any, across: Any) -> Metric:
    """A metric from a direction and two lengths.

    Parameters
    ----------
    direction : array_like, shape (2,), or function (k, 2) -> (k, 2)
        A vector, or one for each point; its length and its sign do not matter.
    along, across : number, function (k, 2) -> (k,), or SizeField
        The wanted lengths in this direction, and at right angles to it.

    Returns
    -------
    Metric

    Raises
    ------
    InputError
        For directions that are zero or not finite, for lengths that are not positive and finite, and for a
        ratio of lengths above 10^6; the message names the first point concerned.

    Examples
    --------
    >>> import unstruct
    >>> metric = unstruct.sizing.directional([1, 1], 0.5, 0.1)
    >>> metric.along([[0, 0], [0, 0]], [[1, 1], [1, -1]])
    array([0.5, 0.1])
    """
    one, two = as_size(along), as_size(across)
    if callable(direction):
        given: Any = direction
    else:
        vector = as_numbers(direction, "direction")
        if vector.shape != (2,):
            raise InputError(f"direction must have shape (2,), not {vector.shape}")
        given = partial(_same, vector)
    metric = InverseMetric(
        partial(_directed, given, one, two),
        landmarks=landmarks_of([one, two], 2),
        name="directions and two lengths",
    )
    return metric if callable(direction) else frozen(metric, [one, two])


def _same(vector: Array, x: Array) -> Array:
    return np.tile(vector, (len(x), 1))


def _directed(direction: Callable[[Array], Any], along: SizeField, across: SizeField, x: Array) -> Array:
    """The rows of the inverse metric."""
    d = np.asarray(asked(direction, x, 0, "direction"), dtype=np.float64)
    if d.shape != x.shape:
        raise InputError(f"the direction must return shape {x.shape} for {len(x)} points, not {d.shape}")
    size = np.abs(d).max(axis=1, initial=0.0)
    bad = ~(np.isfinite(size) & (size > 0))
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(
            f"direction is {d[row].tolist()} at x[{row}] = {x[row].tolist()}; it must be finite and not zero"
        )
    d = d / size[:, None]
    d /= np.hypot(*d.T)[:, None]
    h, g = along(x), across(x)
    far = ~((h <= MOST_STRETCH * g) & (g <= MOST_STRETCH * h))
    if far.any():
        row = int(np.argmax(far))
        raise InputError(
            f"the lengths are {h[row]:g} and {g[row]:g} at x[{row}] = {x[row].tolist()}: their ratio must "
            f"not exceed {MOST_STRETCH:g}; bound it"
        )
    lost = (np.minimum(h, g) < LEAST_WANTED) | (np.maximum(h, g) > 1 / LEAST_WANTED)
    if lost.any():
        row = int(np.argmax(lost))
        raise InputError(
            f"the lengths are {h[row]:g} and {g[row]:g} at x[{row}] = {x[row].tolist()}: their squares leave "
            "the range of doubles; scale the domain"
        )
    c, s = d.T
    h, g = h * h, g * g
    return np.stack([h * c * c + g * s * s, (h - g) * c * s, h * s * s + g * c * c], axis=1)


def as_metric(size: Any) -> Metric:
    """Make a metric of a size, with the same length in all directions; a metric is returned as it is.

    Parameters
    ----------
    size : number, function (k, 2) -> (k,), SizeField, or Metric

    Returns
    -------
    Metric
    """
    if isinstance(size, Metric):
        return size
    field = as_size(size)
    metric = directional([1.0, 0.0], field, field)
    metric.name = f"the same in all directions: {field.name}"
    return metric


def intersection(*metrics: Any) -> Metric:
    """The metric that asks for what each of several metrics asks for: the largest ellipse within all of them.

    Parameters
    ----------
    *metrics : Metric, or any size
        Sizes count as metrics with the same length in all directions.

    Returns
    -------
    Metric
        Exact for two metrics. Three or more are intersected one after the other, and the result depends a
        little on their order.

    Notes
    -----
    Two matrices M, N are reduced simultaneously: in the basis in which M is the identity and N is diagonal,
    the larger one of the two numbers in each direction is taken. Source: P. L. George, H. Borouchaki,
    Delaunay Triangulation and Meshing (1998); F. Alauzet, Finite Elements in Analysis and Design 46 (2010)
    181-202. Book: 3.3.
    """
    if not metrics:
        raise InputError("intersection needs at least one metric")
    every = [as_metric(one) for one in metrics]
    if len(every) == 1:
        return every[0]
    metric = InverseMetric(
        partial(_intersected, every),
        landmarks=landmarks_of(every, 2),
        name=f"intersection of {len(every)}",
    )
    return frozen(metric, every)


def _intersected(metrics: list[Metric], x: Array) -> Array:
    result = inverted(metrics[0].inverses(x))
    for one in metrics[1:]:
        intersect_rows(result, inverted(one.inverses(x)))
    return inverted(result)


@kernel
def intersect_rows(into, other):
    """Replace each matrix of ``into``, rows (k, 3), by its intersection with that of ``other``."""
    for i in range(len(into)):
        a, b, c = intersected(into[i, 0], into[i, 1], into[i, 2], other[i, 0], other[i, 1], other[i, 2])
        into[i, 0], into[i, 1], into[i, 2] = a, b, c


@inline
def intersected(a, b, c, p, q, r):
    """The intersection of the metrics (a, b, c) and (p, q, r).

    With the first one as L L', the second one becomes N = L^-1 . L^-T. If its larger eigenvalue m > 1 has the
    eigenvector e, and the smaller one is below 1, the result is L L' + (m - 1) L e (L e)'. It is positive
    definite also with rounding errors.
    """
    l11 = np.sqrt(a)
    l21 = b / l11
    l22 = np.sqrt(max(c - l21 * l21, 1e-15 * c))
    n11 = p / (l11 * l11)
    n12 = (q - l21 / l11 * p) / (l11 * l22)
    n22 = (r - 2.0 * l21 / l11 * q + (l21 / l11) * (l21 / l11) * p) / (l22 * l22)
    most = larger_eigenvalue(n11, n12, n22)
    if most <= 1.0:
        return a, b, c
    if n11 + n22 - most >= 1.0:
        return p, q, r
    ex, ey = most - n22, n12
    if n11 < n22:
        ex, ey = n12, most - n11
    size = np.hypot(ex, ey)
    ex, ey = (ex / size, ey / size) if size > 0.0 else (1.0, 0.0)
    ux, uy = l11 * ex, l21 * ex + l22 * ey
    return a + (most - 1.0) * ux * ux, b + (most - 1.0) * ux * uy, c + (most - 1.0) * uy * uy
