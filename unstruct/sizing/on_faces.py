"""Sizes and metrics in space, as edges and flat faces see them. Book: 3.3, 3.5."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .field import SizeField
from .metric import Metric
from .space_metric import SpaceMetric

__all__ = ["on_plane", "wanted_along", "wanted_triangles"]

Array = NDArray[np.float64]


def wanted_along(wanted: SizeField | SpaceMetric, x: Array, direction: Array) -> Array:
    """The wanted lengths at points in directions, (k, 3), (k, 3) -> (k,); a size has them in all alike.

    Sides without length, as at the pole of a ball, have any direction.
    """
    if not isinstance(wanted, SpaceMetric):
        return wanted(x)
    return wanted.along(
        x, np.where((direction == 0.0).all(axis=1, keepdims=True), [1.0, 0.0, 0.0], direction)
    )


def wanted_triangles(wanted: SizeField | SpaceMetric, corners: Array, factor: float) -> Array:
    """The areas of triangles (k, 3, 3) in wanted lengths; with ``factor`` no product leaves the doubles."""
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    middle = corners.mean(axis=1)
    if not isinstance(wanted, SpaceMetric):
        area = np.linalg.norm(np.cross(one * factor, two * factor), axis=1) / 2
        return area / (factor * wanted(middle)) ** 2
    a, b, c = (wanted.length(middle, side) for side in (one, two, two - one))
    dot = (a * a + b * b - c * c) / 2
    return np.sqrt(np.maximum(a * a * b * b - dot * dot, 0.0)) / 2


def on_plane(wanted: SizeField | SpaceMetric, origin: Array, frame: Array) -> Any:
    """A size or a metric of the plane whose point y is ``origin + y[0] frame[0] + y[1] frame[1]`` in space.

    Parameters
    ----------
    wanted : SizeField or SpaceMetric
    origin : (3,) float64
    frame : (2, 3) float64
        Orthogonal unit vectors.

    Returns
    -------
    number, SizeField or Metric
        The metric has the wanted lengths of vectors in the plane.
    """
    if isinstance(wanted, SizeField) and wanted.constant is not None:
        return wanted.constant
    marks = wanted.landmarks if wanted.landmarks.shape[1] == 3 else np.empty((0, 3))
    flat = ((marks - origin)[:, None] * frame).sum(axis=2)
    if isinstance(wanted, SizeField):
        return SizeField(partial(_at_plane, wanted, origin, frame), landmarks=flat)
    metric = Metric(partial(_metric_at_plane, wanted, origin, frame), landmarks=flat, name=wanted.name)
    if wanted.constant is not None:
        metric.constant = metric.at(np.zeros((1, 2)))[0]
    return metric


def _at_plane(wanted: Any, origin: Array, frame: Array, y: Array) -> Array:
    # A product of matrices would be rounded differently from processor to processor.
    return wanted(origin + y[:, :1] * frame[0] + y[:, 1:] * frame[1])


def _metric_at_plane(wanted: SpaceMetric, origin: Array, frame: Array, y: Array) -> Array:
    """The matrices (k, 2, 2) of the metric in the plane."""
    rows = np.asarray(_at_plane(wanted.at, origin, frame, y))
    result = np.zeros((len(y), 2, 2))
    for i, j in ((0, 0), (0, 1), (1, 1)):
        for k in range(3):
            for n in range(3):
                result[:, i, j] += frame[i, k] * frame[j, n] * rows[:, k, n]
    result[:, 1, 0] = result[:, 0, 1]
    return result
