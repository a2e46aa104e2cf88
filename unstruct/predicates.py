"""Exact signs: on which side of a plane, inside or outside of a sphere.

Two stages. A *filter* evaluates the determinant in floating point together with a bound on its
rounding error (Shewchuk 1997, stage A; in four dimensions and more, an expansion by minors with the
same expansion of absolute values); where the bound does not decide, `unstruct.exact` computes with
integers. There is no third case: no tolerance, no overflow, no underflow.

Kernels call ``orient2, incircle, orient3, insphere`` with scaled coordinates, at most 1 in magnitude:
then all that underflow can do to a filter is far below ``TINY``. `power_of_two` gives the factor, and
multiplying by it is exact unless an entry becomes subnormal (`scaled` tells). The public functions take
any finite doubles.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError
from .exact import exact_in_sphere, exact_incircle, exact_insphere, exact_orient, exact_orient2, exact_orient3
from .jit import inline, kernel

__all__ = ["in_sphere", "orient"]

EPS = 2.0**-53
ORIENT2_BOUND = (3 + 16 * EPS) * EPS
INCIRCLE_BOUND = (10 + 96 * EPS) * EPS
ORIENT3_BOUND = (7 + 56 * EPS) * EPS
INSPHERE_BOUND = (16 + 224 * EPS) * EPS
TINY = 1e-300  # with |coordinates| <= 1, underflow changes no determinant by more than 2**-1060
UNDECIDED = 2


# --- kernels in two and three dimensions ----------------------------------------------------------


@inline
def orient2(ax, ay, bx, by, cx, cy):
    """Positive where a, b, c turn counterclockwise; exact for |coordinates| <= 1."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    det = left - right
    bound = ORIENT2_BOUND * (abs(left) + abs(right)) + TINY
    if det > bound:
        return 1
    if det < -bound:
        return -1
    return exact_orient2(ax, ay, bx, by, cx, cy)


@inline
def incircle(ax, ay, bx, by, cx, cy, px, py):
    """Positive where p is strictly inside the circle of counterclockwise a, b, c; |coordinates| <= 1."""
    adx, ady, bdx, bdy, cdx, cdy = ax - px, ay - py, bx - px, by - py, cx - px, cy - py
    bc, cb = bdx * cdy, cdx * bdy
    ca, ac = cdx * ady, adx * cdy
    ab, ba = adx * bdy, bdx * ady
    alift, blift, clift = adx * adx + ady * ady, bdx * bdx + bdy * bdy, cdx * cdx + cdy * cdy
    det = alift * (bc - cb) + blift * (ca - ac) + clift * (ab - ba)
    permanent = (abs(bc) + abs(cb)) * alift + (abs(ca) + abs(ac)) * blift + (abs(ab) + abs(ba)) * clift
    bound = INCIRCLE_BOUND * permanent + TINY
    if det > bound:
        return 1
    if det < -bound:
        return -1
    return exact_incircle(ax, ay, bx, by, cx, cy, px, py)


@inline
def orient3(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Sign of the determinant of rows b - a, c - a, d - a; exact for |coordinates| <= 1."""
    adx, ady, adz = ax - dx, ay - dy, az - dz
    bdx, bdy, bdz = bx - dx, by - dy, bz - dz
    cdx, cdy, cdz = cx - dx, cy - dy, cz - dz
    bc, cb = bdx * cdy, cdx * bdy
    ca, ac = cdx * ady, adx * cdy
    ab, ba = adx * bdy, bdx * ady
    det = adz * (bc - cb) + bdz * (ca - ac) + cdz * (ab - ba)
    permanent = (
        (abs(bc) + abs(cb)) * abs(adz) + (abs(ca) + abs(ac)) * abs(bdz) + (abs(ab) + abs(ba)) * abs(cdz)
    )
    bound = ORIENT3_BOUND * permanent + TINY
    if det > bound:
        return -1  # rows a - d, b - d, c - d are those of the opposite orientation
    if det < -bound:
        return 1
    return -exact_orient3(np.array([ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz]))


@inline
def insphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz):
    """Positive where p is strictly inside the sphere of a, b, c, d with orient3 > 0; |coordinates| <= 1."""
    aex, aey, aez = ax - px, ay - py, az - pz
    bex, bey, bez = bx - px, by - py, bz - pz
    cex, cey, cez = cx - px, cy - py, cz - pz
    dex, dey, dez = dx - px, dy - py, dz - pz
    aexbey, bexaey = aex * bey, bex * aey
    bexcey, cexbey = bex * cey, cex * bey
    cexdey, dexcey = cex * dey, dex * cey
    dexaey, aexdey = dex * aey, aex * dey
    aexcey, cexaey = aex * cey, cex * aey
    bexdey, dexbey = bex * dey, dex * bey
    ab, bc, cd = aexbey - bexaey, bexcey - cexbey, cexdey - dexcey
    da, ac, bd = dexaey - aexdey, aexcey - cexaey, bexdey - dexbey
    abc = aez * bc - bez * ac + cez * ab
    bcd = bez * cd - cez * bd + dez * bc
    cda = cez * da + dez * ac + aez * cd
    dab = dez * ab + aez * bd + bez * da
    alift, blift = aex * aex + aey * aey + aez * aez, bex * bex + bey * bey + bez * bez
    clift, dlift = cex * cex + cey * cey + cez * cez, dex * dex + dey * dey + dez * dez
    det = (dlift * abc - clift * dab) + (blift * cda - alift * bcd)
    aez, bez, cez, dez = abs(aez), abs(bez), abs(cez), abs(dez)
    ab, bc, cd = abs(aexbey) + abs(bexaey), abs(bexcey) + abs(cexbey), abs(cexdey) + abs(dexcey)
    da, ac, bd = abs(dexaey) + abs(aexdey), abs(aexcey) + abs(cexaey), abs(bexdey) + abs(dexbey)
    permanent = (
        (cd * bez + bd * cez + bc * dez) * alift
        + (da * cez + ac * dez + cd * aez) * blift
        + (ab * dez + bd * aez + da * bez) * clift
        + (bc * aez + ac * bez + ab * cez) * dlift
    )
    bound = INSPHERE_BOUND * permanent + TINY
    if det > bound:
        return -1
    if det < -bound:
        return 1
    return -exact_insphere(np.array([ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz]))


# --- any dimension --------------------------------------------------------------------------------


@kernel
def _determinant_and_permanent(a, size):
    """Expand a determinant by minors over subsets of columns, with the same sum of absolute values."""
    det = np.zeros(1 << size)
    permanent = np.zeros(1 << size)
    det[0] = permanent[0] = 1.0
    for subset in range(1, 1 << size):
        row = -1
        for j in range(size):
            row += (subset >> j) & 1
        above = 0  # chosen columns to the right of j: the sign of the minor
        for j in range(size - 1, -1, -1):
            if (subset >> j) & 1:
                rest = subset ^ (1 << j)
                term = a[row, j] * det[rest]
                det[subset] += -term if above & 1 else term
                permanent[subset] += abs(a[row, j]) * permanent[rest]
                above += 1
    return det[-1], permanent[-1]


@kernel
def filter_orient(simplex):
    """Sign of the determinant of rows p_i - p_0, or UNDECIDED, for any d; |coordinates| <= 1."""
    d = simplex.shape[1]
    det, permanent = _determinant_and_permanent(simplex[1:] - simplex[0], d)
    # each product of the expansion carries d differences, d multiplications, at most d(d-1)/2 additions
    bound = (d * (d + 3) + 8) * EPS * permanent + TINY
    if abs(det) > bound:
        return 1 if det > 0 else -1
    return UNDECIDED


@kernel
def filter_in_sphere(simplex, q):
    """In-sphere sign for positively oriented simplices, or UNDECIDED, for any d; |coordinates| <= 1."""
    d = simplex.shape[1]
    rows = np.empty((d + 1, d + 1))
    for i in range(d + 1):
        lift = 0.0
        for j in range(d):
            rows[i, j] = simplex[i, j] - q[j]
            lift += rows[i, j] * rows[i, j]
        rows[i, d] = lift
    det, permanent = _determinant_and_permanent(rows, d + 1)
    bound = ((d + 1) * (d + 4) + 2 * d + 12) * EPS * permanent + TINY  # as above, and the lift's own errors
    if abs(det) > bound:
        sign = 1 if det > 0 else -1
        return sign if d % 2 == 0 else -sign
    return UNDECIDED


@kernel
def _batch_orient(simplices, factors, signs):
    for i in range(len(simplices)):
        s = simplices[i] * factors[i]
        signs[i] = filter_orient(s)
        if signs[i] == UNDECIDED:
            p = simplices[i]
            if p.shape[1] == 2:
                signs[i] = exact_orient2(p[0, 0], p[0, 1], p[1, 0], p[1, 1], p[2, 0], p[2, 1])
            elif p.shape[1] == 3:
                signs[i] = -exact_orient3(p.copy().reshape(-1))


@kernel
def _batch_in_sphere(simplices, q, factors, signs):
    for i in range(len(simplices)):
        s = simplices[i] * factors[i]
        signs[i] = filter_in_sphere(s, q[i] * factors[i])
        if signs[i] == UNDECIDED:
            p, c = simplices[i], q[i]
            if p.shape[1] == 2:
                signs[i] = exact_incircle(p[0, 0], p[0, 1], p[1, 0], p[1, 1], p[2, 0], p[2, 1], c[0], c[1])
            elif p.shape[1] == 3:
                x = np.empty(15)
                x[:12] = p.copy().reshape(-1)
                x[12:] = c
                signs[i] = -exact_insphere(x)


# --- scaling --------------------------------------------------------------------------------------


def power_of_two(points: ArrayLike) -> float:
    """A power of two that brings the largest coordinate into [1/2, 1) (for very small ones, as far as
    a double reaches); 1.0 where all are zero.

    Multiplying by it is exact unless an entry becomes subnormal; see `scaled`.
    """
    largest = float(np.max(np.abs(points), initial=0.0))
    if largest == 0.0:
        return 1.0
    return math.ldexp(1.0, min(-math.frexp(largest)[1], 1023))


def scaled(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], bool]:
    """Scale by `power_of_two`; the second value tells whether every entry was kept exactly."""
    factor = power_of_two(points)
    result = points * factor
    # a power of two may itself be subnormal (largest coordinate beyond 2**1022): divide in two steps
    return result, bool(np.array_equal(result / factor, points))


def _factors(blocks: NDArray[np.float64]) -> NDArray[np.float64]:
    """`power_of_two` for each of the arrays (m, ...)."""
    largest = np.abs(blocks).reshape(len(blocks), -1).max(axis=1, initial=0.0)
    return np.ldexp(1.0, np.minimum(-np.frexp(largest)[1], 1023))


# --- public ---------------------------------------------------------------------------------------


def orient_at(points: NDArray[np.float64], vertices: NDArray) -> int:
    """Sign of the simplex on the given rows of scaled ``points`` (|coordinates| <= 1), any dimension."""
    simplex = points[vertices]
    sign = filter_orient(simplex)
    return exact_orient(simplex) if sign == UNDECIDED else int(sign)


def in_sphere_at(points: NDArray[np.float64], vertices: NDArray, q: NDArray[np.float64]) -> int:
    """In-sphere sign of ``q`` and the simplex on rows of scaled ``points``, any dimension."""
    simplex = points[vertices]
    sign = filter_in_sphere(simplex, q)
    return exact_in_sphere(simplex, q) if sign == UNDECIDED else int(sign)


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
    arithmetic and fast robust geometric predicates*, 1997) decides almost always, integer arithmetic
    the rest. Cost O(2^d d) a simplex while the filter decides. Book: 2.0, 2.4a.
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
        For a positively oriented simplex 1 where q is strictly inside its circumsphere, 0 where it is
        on it, -1 outside; for a negatively oriented one the signs are exchanged.

    Raises
    ------
    InputError
        For shapes that do not fit, coordinates that are not finite, and flat simplices, which have no
        circumsphere.

    Notes
    -----
    Exact for all finite doubles, as `orient`. Book: 2.0, 2.4a.
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
