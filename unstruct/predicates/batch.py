"""Exact signs: on which side of a plane, inside or outside of a sphere.

There are three stages. A floating-point filter (`filters`) decides first. Where its error bound leaves the
sign open, kernels compute with doubles that have smaller errors or none (`close`). Integers (`exact`)
decide the rest. There is no tolerance, and neither overflow nor underflow can change a sign.

Kernels call ``orient2, incircle, orient3, insphere`` (see `kernels`) with scaled coordinates, at most 1 in
magnitude: the effect of underflow on a filter is then far below ``TINY``. `power_of_two` gives the factor.
Multiplying by it is exact unless an entry becomes subnormal, and `scaled` reports this. The public functions
take any finite doubles.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.errors import InputError
from ..base.jit import kernel
from .exact import exact_in_sphere, exact_incircle, exact_insphere, exact_orient, exact_orient2, exact_orient3
from .filters import (
    UNDECIDED,
    filter_in_sphere,
    filter_incircle,
    filter_insphere,
    filter_orient,
    filter_orient2,
    filter_orient3,
)
from .kernels import orient2, orient3

__all__ = ["in_sphere", "orient"]


# --- many simplices -------------------------------------------------------------------------------


@kernel
def _repeated(p):
    """Whether two corners are equal. (Vertices of a mesh are often tested against their own cells.)"""
    for k in range(p.shape[0]):
        for m in range(k):
            same = True
            for j in range(p.shape[1]):
                same = same and p[k, j] == p[m, j]
            if same:
                return True
    return False


@kernel
def _batch_orient(simplices, factors, signs):
    """Signs of many simplices: the filter takes them scaled, the exact stage takes them unscaled."""
    d = simplices.shape[2]
    s = np.empty((d + 1, d))  # one for all: an array for each simplex took most of the time
    for i in range(len(simplices)):
        p = simplices[i]
        for k in range(d + 1):
            for j in range(d):
                s[k, j] = p[k, j] * factors[i]
        if d == 2:
            sign = filter_orient2(s[0, 0], s[0, 1], s[1, 0], s[1, 1], s[2, 0], s[2, 1])
            if sign == UNDECIDED and _repeated(p):
                sign = 0
            if sign == UNDECIDED:
                sign = exact_orient2(p[0, 0], p[0, 1], p[1, 0], p[1, 1], p[2, 0], p[2, 1])
        elif d == 3:
            sign = filter_orient3(
                s[0, 0], s[0, 1], s[0, 2], s[1, 0], s[1, 1], s[1, 2], s[2, 0], s[2, 1], s[2, 2],
                s[3, 0], s[3, 1], s[3, 2],
            )  # fmt: skip
            if sign == UNDECIDED:
                x = np.empty(12)
                for k in range(12):
                    x[k] = p[k // 3, k % 3]
                sign = -exact_orient3(x)
        else:
            sign = filter_orient(s)
        signs[i] = sign


@kernel
def _batch_in_sphere(simplices, q, factors, signs):
    """Like `_batch_orient`; if d is neither 2 nor 3, the caller decides the signs left UNDECIDED."""
    d = simplices.shape[2]
    s, t = np.empty((d + 1, d)), np.empty(d)
    for i in range(len(simplices)):
        p, c = simplices[i], q[i]
        for j in range(d):
            t[j] = c[j] * factors[i]
            for k in range(d + 1):
                s[k, j] = p[k, j] * factors[i]
        if d == 2:
            sign = filter_incircle(s[0, 0], s[0, 1], s[1, 0], s[1, 1], s[2, 0], s[2, 1], t[0], t[1])
            if sign == UNDECIDED:
                sign = exact_incircle(p[0, 0], p[0, 1], p[1, 0], p[1, 1], p[2, 0], p[2, 1], c[0], c[1])
        elif d == 3:
            sign = filter_insphere(
                s[0, 0], s[0, 1], s[0, 2], s[1, 0], s[1, 1], s[1, 2], s[2, 0], s[2, 1], s[2, 2],
                s[3, 0], s[3, 1], s[3, 2], t[0], t[1], t[2],
            )  # fmt: skip
            if sign == UNDECIDED:
                x = np.empty(15)
                for k in range(12):
                    x[k] = p[k // 3, k % 3]
                for k in range(3):
                    x[12 + k] = c[k]
                sign = -exact_insphere(x)
        else:
            sign = filter_in_sphere(s, t)
        signs[i] = sign


# --- scaling --------------------------------------------------------------------------------------


def power_of_two(points: ArrayLike) -> float:
    """A power of two that brings the largest coordinate into [1/2, 1); 1.0 if all coordinates are zero.

    For very small coordinates it is the largest power of two that a double can hold. Multiplying by it is
    exact unless an entry becomes subnormal; see `scaled`.
    """
    largest = float(np.max(np.abs(points), initial=0.0))
    if largest == 0.0:
        return 1.0
    return math.ldexp(1.0, min(-math.frexp(largest)[1], 1023))


def scaled(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], bool]:
    """Scale by `power_of_two`; the second value tells whether every entry was kept exactly."""
    factor = power_of_two(points)
    # If the largest coordinate is 2**1022 or more, the factor itself is subnormal; it is exact nevertheless.
    if points.ndim == 2 and points.flags.c_contiguous and points.dtype == np.float64:
        result = np.empty_like(points)
        return result, bool(_scale(points, factor, result))
    result = points * factor
    return result, bool(np.array_equal(result / factor, points))


@kernel
def _scale(points, factor, result):
    """Write scaled points; whether every entry was kept exactly. One pass, where numpy takes four."""
    kept = True
    for i in range(points.shape[0]):
        for k in range(points.shape[1]):
            result[i, k] = points[i, k] * factor
            kept = kept and result[i, k] / factor == points[i, k]
    return kept


def unscaled(points: NDArray[np.float64], factor: float) -> NDArray[np.float64]:
    """Vertices of a mesh that was made of scaled points, in the units of the input.

    Raises
    ------
    InputError
        Where this rounds, because coordinates are below the normal doubles: the mesh with rounded vertices is
        not the one whose signs were decided.
    """
    result = points / factor
    if factor > 1.0 and not np.array_equal(result * factor, points):
        row = int(np.argmax((result * factor != points).any(axis=1)))
        raise InputError(
            f"a new vertex would be at {result[row].tolist()}, where doubles have no digits left to keep "
            "triangles apart: scale the domain and the size, for example by 1e300"
        )
    return result


def _factors(blocks: NDArray[np.float64]) -> NDArray[np.float64]:
    """`power_of_two` of each of the m arrays in ``blocks``, shape (m, ...)."""
    largest = np.zeros(len(blocks))
    columns = blocks.reshape(len(blocks), math.prod(blocks.shape[1:])).T
    for column in columns:  # numpy is slow at many maxima of short rows
        np.maximum(largest, np.abs(column), out=largest)
    return np.ldexp(1.0, np.minimum(-np.frexp(largest)[1], 1023))


# --- public ---------------------------------------------------------------------------------------


def orient_at(points: NDArray[np.float64], vertices: NDArray) -> int:
    """Sign of the simplex on the given rows of scaled ``points`` (|coordinates| <= 1), any dimension."""
    simplex = points[vertices]
    sign = filter_orient(simplex)
    return exact_orient(simplex) if sign == UNDECIDED else int(sign)


def orient(simplex: ArrayLike) -> NDArray[np.int8] | int:
    """Exact orientation of simplices.

    Parameters
    ----------
    simplex : array_like, shape (..., d + 1, d)
        Vertices of one or many simplices of full dimension d >= 1, finite.

    Returns
    -------
    int or ndarray of int8, shape (...)
        1, 0 or -1: the sign of the determinant of the rows ``p_i - p_0``. In the plane, 1 is
        counterclockwise; 0 means that the simplex is flat.

    Raises
    ------
    InputError
        For shapes other than (..., d + 1, d), and for coordinates that are not finite.

    Notes
    -----
    Exact for all finite doubles: a floating-point filter (Shewchuk, *Adaptive precision floating-point
    arithmetic and fast robust geometric predicates*, 1997) decides almost always, and integer arithmetic
    decides the rest. The cost is O(2^d d) per simplex where the filter decides. Book: 2.0, 2.4a.
    """
    array = _simplices(simplex)
    d = array.shape[-1]
    flat = np.ascontiguousarray(array.reshape(-1, d + 1, d))
    signs = np.empty(len(flat), np.int8)
    _batch_orient(flat, _factors(flat), signs)
    for i in np.flatnonzero(signs == UNDECIDED):
        signs[i] = exact_orient(flat[i])
    return int(signs[0]) if array.ndim == 2 else signs.reshape(array.shape[:-2])


def in_sphere(simplex: ArrayLike, q: ArrayLike) -> NDArray[np.int8] | int:
    """Exact position of points with respect to the circumspheres of simplices.

    Parameters
    ----------
    simplex : array_like, shape (..., d + 1, d)
        Vertices of one or many simplices of full dimension, finite and not flat.
    q : array_like, shape (..., d)
        Query points; leading axes broadcast against those of ``simplex``.

    Returns
    -------
    int or ndarray of int8, shape (...)
        For a positively oriented simplex: 1 if q is strictly inside its circumsphere, 0 if q is on it, and -1
        if q is outside. For a negatively oriented simplex the signs are exchanged.

    Raises
    ------
    InputError
        For shapes that do not fit, coordinates that are not finite, and flat simplices, which have no
        circumsphere.

    Notes
    -----
    Exact for all finite doubles, like `orient`. Book: 2.0, 2.4a.
    """
    array = _simplices(simplex)
    d = array.shape[-1]
    query = _finite(q, "q")
    if query.ndim == 0 or query.shape[-1] != d:
        raise InputError(f"q has shape {query.shape}; with simplices in {d} dimensions it must be (..., {d})")
    try:
        shape = np.broadcast_shapes(array.shape[:-2], query.shape[:-1])
    except ValueError:
        raise InputError(
            f"leading axes {array.shape[:-2]} of simplex and {query.shape[:-1]} of q do not broadcast"
        ) from None
    turned = np.atleast_1d(orient(array))
    if not turned.all():
        where = np.unravel_index(int(np.argmin(np.abs(turned))), turned.shape)
        raise InputError(f"simplex {tuple(map(int, where))} is flat: it has no circumsphere; remove it first")
    flat = np.broadcast_to(array, (*shape, d + 1, d)).reshape(-1, d + 1, d)
    points = np.broadcast_to(query, (*shape, d)).reshape(-1, d)
    flat, points = np.ascontiguousarray(flat), np.ascontiguousarray(points)
    signs = np.empty(len(flat), np.int8)
    _batch_in_sphere(flat, points, _factors(np.concatenate([flat, points[:, None]], axis=1)), signs)
    for i in np.flatnonzero(signs == UNDECIDED):
        signs[i] = exact_in_sphere(flat[i], points[i])
    return int(signs[0]) if shape == () else signs.reshape(shape)


def _finite(values: ArrayLike, name: str) -> NDArray[np.float64]:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not an array of real numbers: {error}") from None
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise InputError(f"{name} has a coordinate that is not finite at index {where}; remove it first")
    return array


def _simplices(simplex: ArrayLike) -> NDArray[np.float64]:
    array = _finite(simplex, "simplex")
    if array.ndim < 2 or array.shape[-2] != array.shape[-1] + 1 or array.shape[-1] < 1:
        raise InputError(f"simplex has shape {array.shape}; it must be (..., d + 1, d) with d >= 1")
    return array


SIGNS_AT_ONCE = 1 << 19  # simplices: bounds the memory


@kernel
def _signs_of_rows(points, rows, signs):
    """Signs of simplices in two or three dimensions, of scaled points; 0 if a vertex is there twice."""
    for i in range(rows.shape[0]):
        a, b, c = rows[i, 0], rows[i, 1], rows[i, 2]
        if points.shape[1] == 2:
            if a == b or b == c or c == a:
                signs[i] = 0
                continue
            signs[i] = orient2(
                points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]
            )
            continue
        d = rows[i, 3]
        if a == b or b == c or c == a or d == a or d == b or d == c:
            signs[i] = 0
            continue
        signs[i] = orient3(
            points[a, 0], points[a, 1], points[a, 2], points[b, 0], points[b, 1], points[b, 2],
            points[c, 0], points[c, 1], points[c, 2], points[d, 0], points[d, 1], points[d, 2],
        )  # fmt: skip


def orient_rows(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Exact orientation of many simplices given by vertex numbers, shape (r, d + 1), in chunks."""
    if points.shape[1] in (2, 3) and rows.size >= len(points):  # otherwise scaling all points is more work
        xyz, exact = scaled(np.ascontiguousarray(points))
        if exact:
            signs = np.empty(len(rows), dtype=np.int8)
            for i in range(0, len(rows), SIGNS_AT_ONCE):
                part = slice(i, i + SIGNS_AT_ONCE)
                _signs_of_rows(xyz, rows[part].astype(np.int64), signs[part])
            return signs
    parts = [orient(points[rows[i : i + SIGNS_AT_ONCE]]) for i in range(0, len(rows), SIGNS_AT_ONCE)]
    return np.concatenate([*parts, np.empty(0, dtype=np.int8)])
