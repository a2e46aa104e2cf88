"""Sines, arctangents, exponentials and logarithms that are equal, bit for bit, on every processor.

The rounding of the functions of the C library depends on whether multiplications are fused, and that of numpy
also on the width of its vectors. A mesh of a region with arcs would then depend on the machine. The functions
here consist of single additions, multiplications, divisions and square roots in a fixed order. Each of these
is rounded according to IEEE 754, compiled or not. The error of sines, cosines and exponentials is below one
unit in the last place, and that of arctangents, arcsines and logarithms is below two.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .jit import inline, kernel, lean

__all__ = [
    "angle_of", "arcsine", "cosine", "cosines", "exponential", "exponentials", "logarithm", "sine", "sines",
    "turns",
]  # fmt: skip

Array = NDArray[np.float64]

# Constants as sums of doubles. The parts of pi / 2 have 33 bits, so that their multiples by integers below
# 2^19 are exact.
TWO_OVER_PI = 0.6366197723675814
HALF_PI_1, HALF_PI_2, HALF_PI_3 = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
HALF_PI, HALF_PI_REST = 1.5707963267948966, 6.123233995736766e-17
LN2_HIGH, LN2_LOW, INVERSE_LN2 = 0.6931471803691238, 1.9082149292705877e-10, 1.4426950408889634
HALF_ROOT = 0.7071067811865476
FAR = 524288.0  # larger angles, in right angles, are first reduced by the remainder of a division
STEPS = 16  # the table contains the arctangents of k / 16, and their rests beyond double precision
TANGENTS = np.arange(STEPS + 1) / STEPS
ARCTANGENTS = np.array([
    0.0, 0.06241880999595735, 0.12435499454676144, 0.18534794999569476,
    0.24497866312686414, 0.3028848683749714, 0.35877067027057225, 0.4124104415973873,
    0.4636476090008061, 0.5123894603107377, 0.5585993153435624, 0.6022873461349642,
    0.6435011087932844, 0.6823165548747481, 0.7188299996216245, 0.7531512809621944,
    0.7853981633974483,
])  # fmt: skip
RESTS = np.array([
    0.0, -1.5490756308295046e-18, -3.1253241424539383e-18, 4.180692268843079e-18,
    1.0698755618734451e-17, -1.1010827903001369e-17, -2.4623815582638635e-17, -1.587652227770689e-17,
    2.2698777452961687e-17, -2.5462781472855804e-17, -5.4556305485916264e-18, 2.950430737228402e-17,
    1.5834785051444286e-17, 6.943223671560008e-18, -2.1478388444456983e-17, -2.4256934659182068e-17,
    3.061616997868383e-17,
])  # fmt: skip


@inline
def _sine_near(x, rest):
    """sin(x + rest) for |x| up to a little above pi / 4, by its Taylor polynomial of degree 17."""
    z = x * x
    p = -1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0)
    p = -1.0 / 39916800.0 + z * (1.0 / 6227020800.0 + z * p)
    p = 1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0 + z * p))
    return x + (x * z * (-1.0 / 6.0 + z * p) + rest * (1.0 - 0.5 * z))


@inline
def _cosine_near(x, rest):
    """cos(x + rest) for |x| up to a little above pi / 4, by its Taylor polynomial of degree 18."""
    z = x * x
    p = 1.0 / 20922789888000.0 + z * (-1.0 / 6402373705728000.0)
    p = 1.0 / 479001600.0 + z * (-1.0 / 87178291200.0 + z * p)
    p = 1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0 + z * (-1.0 / 3628800.0 + z * p)))
    half = 0.5 * z
    most = 1.0 - half
    return most + (((1.0 - most) - half) + (z * z * p - x * rest))


@inline
def _reduced(x):
    """(quarter, y, rest): x minus a whole number of right angles is y + rest, at most about pi / 4."""
    turns = np.floor(x * TWO_OVER_PI + 0.5)
    if abs(turns) > FAR:  # for such angles the error is within the rounding of the angle itself
        x = np.fmod(x, 4.0 * HALF_PI)
        turns = np.floor(x * TWO_OVER_PI + 0.5)
    first = x - turns * HALF_PI_1
    second = turns * HALF_PI_2
    y = first - second
    rest = ((first - y) - second) - turns * HALF_PI_3
    high = y + rest
    return int(turns) & 3, high, (y - high) + rest


@lean
def sine(x):
    """The sine of a finite number."""
    quarter, y, rest = _reduced(x)
    value = _cosine_near(y, rest) if quarter & 1 else _sine_near(y, rest)
    return -value if quarter & 2 else value


@lean
def cosine(x):
    """The cosine of a finite number."""
    quarter, y, rest = _reduced(x)
    value = _sine_near(y, rest) if quarter & 1 else _cosine_near(y, rest)
    return -value if quarter == 1 or quarter == 2 else value


@inline
def _arctangent(y, x):
    """The angle of (x, y) for 0 <= y <= x, 0 < x: the nearest entry of the table plus a Taylor series."""
    k = int(STEPS * (y / x) + 0.5)
    if k == 0:
        t = y / x
        z = t * t
        p = -1.0 / 11.0 + z * (1.0 / 13.0 + z * (-1.0 / 15.0))
        p = -1.0 / 3.0 + z * (1.0 / 5.0 + z * (-1.0 / 7.0 + z * (1.0 / 9.0 + z * p)))
        return t + t * z * p
    c = TANGENTS[k]  # it has few bits, so that products with it have small errors
    t = (y - c * x) / (x + c * y)
    z = t * t
    p = -1.0 / 3.0 + z * (1.0 / 5.0 + z * (-1.0 / 7.0 + z * (1.0 / 9.0 + z * (-1.0 / 11.0 + z / 13.0))))
    return ARCTANGENTS[k] + (t + (t * z * p + RESTS[k]))


@lean
def angle_of(y, x):
    """The angle of the vector (x, y), between -pi and pi, like `math.atan2`."""
    a, b = abs(x), abs(y)
    most = max(a, b)
    if most == 0.0:
        angle = 0.0
    else:
        shrink = 1.0 if 1e-150 < most < 1e150 else 1.0 / most  # so that sums of two do not overflow
        if most == math.inf:
            a, b, shrink = 1.0 if a == most else 0.0, 1.0 if b == most else 0.0, 1.0
        if shrink == math.inf:
            a, b, shrink = a * 2.0**600, b * 2.0**600, 1.0
        a, b = a * shrink, b * shrink
        angle = _arctangent(b, a) if b <= a else HALF_PI - (_arctangent(a, b) - HALF_PI_REST)
    if math.copysign(1.0, x) < 0.0:
        angle = 2.0 * HALF_PI - (angle - 2.0 * HALF_PI_REST)
    return math.copysign(angle, y)


@lean
def arcsine(x):
    """The arcsine of a number between -1 and 1."""
    return angle_of(x, math.sqrt((1.0 - x) * (1.0 + x)))


@inline
def exponential(x):
    """e to the power of x: a power of two times e^r, with e^r by its Taylor series."""
    if x > 709.782712893384:
        return math.inf
    if x < -750.0:
        return 0.0
    k = np.floor(x * INVERSE_LN2 + 0.5)
    high, low = x - k * LN2_HIGH, k * LN2_LOW
    r = high - low
    rest = (high - r) - low
    p = 1.0 / 362880.0 + r * (1.0 / 3628800.0 + r * (1.0 / 39916800.0 + r * (1.0 / 479001600.0 + r * (
        1.0 / 6227020800.0 + r * (1.0 / 87178291200.0)))))  # fmt: skip
    p = 1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0 + r * (1.0 / 40320.0 + r * p))))
    p = r * r * (0.5 + r * (1.0 / 6.0 + r * p))
    return math.ldexp(1.0 + (r + (p + rest)), int(k))


@lean
def logarithm(x):
    """The natural logarithm of a positive finite number.

    With x = 2^k (1 + f), 1 / sqrt(2) < 1 + f < sqrt(2), and s = f / (2 + f), it is k ln 2 + 2 artanh(s).
    """
    m, k = math.frexp(x)
    if m < HALF_ROOT:
        m, k = 2.0 * m, k - 1
    f = m - 1.0
    s = f / (2.0 + f)
    z = s * s
    p = 2.0 / 15.0 + z * (2.0 / 17.0 + z * (2.0 / 19.0 + z * (2.0 / 21.0 + z * (2.0 / 23.0))))
    p = 2.0 / 7.0 + z * (2.0 / 9.0 + z * (2.0 / 11.0 + z * (2.0 / 13.0 + z * p)))
    p = z * (2.0 / 3.0 + z * (2.0 / 5.0 + z * p))
    half = 0.5 * f * f  # 2 s = f - s f, and s f = f^2 / 2 - s f^2 / 2
    return k * LN2_HIGH - ((half - (s * (half + p) + k * LN2_LOW)) - f)


# ---------------------------------------------------------------------- arrays


@kernel
def _sines(x, result):
    for i in range(x.shape[0]):
        result[i] = sine(x[i]) if math.isfinite(x[i]) else math.nan


@kernel
def _cosines(x, result):
    for i in range(x.shape[0]):
        result[i] = cosine(x[i]) if math.isfinite(x[i]) else math.nan


@kernel
def _turns(y, x, result):
    for i in range(x.shape[0]):
        result[i] = math.nan if math.isnan(x[i]) or math.isnan(y[i]) else angle_of(y[i], x[i])


@kernel
def _exponentials(x, result):
    for i in range(x.shape[0]):
        result[i] = math.nan if math.isnan(x[i]) else exponential(x[i])


def _each(compiled: Any, *arrays: ArrayLike) -> Array:
    first, *rest = (np.asarray(array, dtype=np.float64) for array in arrays)
    result = np.empty(first.size)
    compiled(*(np.ascontiguousarray(array).ravel() for array in (first, *rest)), result)
    return result.reshape(first.shape)


def sines(x: ArrayLike) -> Array:
    """The sines of an array of any shape."""
    return _each(_sines, x)


def cosines(x: ArrayLike) -> Array:
    """The cosines of an array of any shape."""
    return _each(_cosines, x)


def turns(y: ArrayLike, x: ArrayLike) -> Array:
    """The angles of vectors (x, y), between -pi and pi, like `numpy.arctan2`, for arrays of equal shapes."""
    return _each(_turns, y, x)


def exponentials(x: ArrayLike) -> Array:
    """e to the powers of an array of any shape."""
    return _each(_exponentials, x)
