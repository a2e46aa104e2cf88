"""Simplices as edge vectors from one corner, scaled so that nothing overflows. Used by `unstruct.simplex`."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps

import numpy as np

from ..base.errors import InputError

__all__ = [
    "angle_between",
    "as_corners",
    "careful_radius",
    "content",
    "cross",
    "determinant",
    "exponents",
    "lengths",
    "local_edges",
    "quiet",
]

FINE = 2.0**-20  # of the longest edge of a triangle: a shorter edge is not taken from the other two
LEAST_LENGTH = 1e-140  # squares of shorter lengths are lost, in part or all, below the smallest doubles


def quiet(function: Callable) -> Callable:
    """Suppress the warnings of ``function``: a division by zero has a meaning here (a flat simplex)."""

    @wraps(function)
    def silent(*args, **kwargs):
        with np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore"):
            return function(*args, **kwargs)

    return silent


def as_corners(simplices: np.ndarray) -> np.ndarray:
    """The corners as a float array of shape (..., k + 1, d), or an error that gives the right shape."""
    points = np.asarray(simplices, dtype=np.float64)
    if points.ndim < 2 or not 2 <= points.shape[-2] <= points.shape[-1] + 1:
        raise InputError(
            f"simplices must have shape (..., k + 1, d) with 1 <= k <= d, not {points.shape}: "
            "index the points by the cells, points[cells]"
        )
    return points


def exponents(values: np.ndarray) -> np.ndarray:
    """The e with max|values| over the last two axes in [2^(e-1), 2^e); 0 for zeros and non-finite values."""
    return np.frexp(np.abs(values).max(axis=(-2, -1)))[1]


def lengths(vectors: np.ndarray) -> np.ndarray:
    """The lengths of vectors (..., d), also of those whose squares are below or above all doubles."""
    with np.errstate(over="ignore", under="ignore"):
        result = np.asarray(np.sqrt((vectors**2).sum(axis=-1)))
        lost = ~((result >= LEAST_LENGTH) & (result < np.inf))
        if lost.any():
            rows = vectors[lost]
            exponent = np.frexp(np.abs(rows).max(axis=-1))[1]
            rows = np.ldexp(rows, -exponent[..., None])
            result[lost] = np.ldexp(np.sqrt((rows**2).sum(axis=-1)), exponent)
    return result


def local_edges(simplices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edge vectors (..., k, d) from corner 0, scaled to at most 1, and the exponents of the scaling."""
    points = as_corners(simplices)
    half = np.ldexp(points, -1)  # because differences of the largest doubles would overflow
    rows = half[..., 1:, :] - half[..., :1, :]
    exponent = exponents(rows)
    return np.ldexp(rows, -exponent[..., None, None]), exponent + 1


def _gram_content(rows: np.ndarray) -> np.ndarray:
    """sqrt(det(rows rows^T)) by QR, without squaring the condition number."""
    r = np.linalg.qr(np.swapaxes(rows, -1, -2), mode="r")
    return np.abs(np.diagonal(r, axis1=-2, axis2=-1)).prod(axis=-1)


def determinant(rows: np.ndarray) -> np.ndarray:
    """Determinants of matrices (..., k, k), written out for k <= 3."""
    k = rows.shape[-1]
    if k == 1:
        return rows[..., 0, 0]
    a, b = rows[..., 0, :], rows[..., 1, :]
    if k == 2:
        return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    if k == 3:
        return (a * cross(b, rows[..., 2, :])).sum(axis=-1)
    return np.linalg.det(rows)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products in space (several times faster than numpy's, which handles more cases)."""
    x = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    y = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    return np.stack([x, y, a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]], axis=-1)


def content(rows: np.ndarray) -> np.ndarray:
    """k! times the measure of the simplices with these edge vectors, without sign."""
    k, d = rows.shape[-2:]
    if k == 1:
        return lengths(rows[..., 0, :])
    if k == d:
        return np.abs(determinant(rows))
    if k == 2 and d == 3:
        return np.sqrt((cross(rows[..., 0, :], rows[..., 1, :]) ** 2).sum(axis=-1))
    return _gram_content(rows)


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The angle between vectors of any dimension, accurate also near 0 and pi (Kahan).

    For unit vectors a and b it is 2 atan2(|a - b|, |a + b|).
    """
    a, b = a / lengths(a)[..., None], b / lengths(b)[..., None]
    return 2 * np.arctan2(np.sqrt(((a - b) ** 2).sum(axis=-1)), np.sqrt(((a + b) ** 2).sum(axis=-1)))


def careful_radius(corners: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Circumradii; those of triangles (..., 3, d) anew where one edge is very short beside the others.

    There it is the longest edge over twice the sine of the opposite angle. This needs no common unit of the
    edges, and finds the edge between two corners that are one for the third.
    """
    if corners.shape[-2] != 3:
        return radius
    half = np.ldexp(corners, -1)
    edges = np.roll(half, -2, axis=-2) - np.roll(half, -1, axis=-2)  # opposite corners 0, 1, 2
    size = np.sort(lengths(edges), axis=-1)
    lost = size[..., 0] < FINE * size[..., 2]
    if not lost.any():
        return radius
    radius, edges = np.array(radius), edges[lost]
    order = np.argsort(lengths(edges), axis=1, kind="stable")
    edges = np.take_along_axis(edges, order[..., None], axis=1)
    unit = np.ldexp(edges, -np.frexp(np.abs(edges).max(axis=2, keepdims=True))[1])
    sine = content(unit[:, :2]) / (lengths(unit[:, 0]) * lengths(unit[:, 1]))
    radius[lost] = np.where(sine > 0, lengths(edges[:, 2]) / sine, np.inf)
    return radius[()]
