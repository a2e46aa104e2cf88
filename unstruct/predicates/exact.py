"""Exact stage of the predicates: every double is an integer times a power of two.

A finite double is ``m * 2**e`` with an integer ``m`` of at most 53 bits. In units of two to the smallest
exponent among the coordinates of a simplex, all of them are integers. The sign of a determinant is then
computed in integer arithmetic, without rounding, underflow or overflow. There are two forms:

* Compiled, in two and three dimensions. If the differences of coordinates are small integers (lattices
  and other exact data), 64-bit integers suffice. Otherwise a number is a row of *limbs*, which are its digits
  in base ``2**26``, the lowest first. Limbs lie between ``-2**25`` and ``2**25``, so that the sign of a
  number is that of its top limb, and a small number taken from a large one leaves zeros between them, which
  products skip: where exponents are wide, nearly all limbs are zero. A product of two limbs is at most
  ``2**50``, so eight thousand of them can be added in 64 bits before carries are taken.
* In any dimension, Python's own integers and Bareiss' fraction-free elimination.
"""

from __future__ import annotations

import math

import numpy as np

from ..base.jit import kernel

BITS = 26
BASE = 1 << BITS
MASK = BASE - 1
HALF_BASE = BASE >> 1


# --- limbs: number s has the limbs w[s, :n[s]]; zero has none -------------------------------------


@kernel
def _carry(w, n, s, length):
    """Bring the limbs of ``s`` into [-HALF_BASE, HALF_BASE) after additions."""
    carry = 0
    for i in range(length):
        value = w[s, i] + carry
        carry = (value + HALF_BASE) >> BITS
        w[s, i] = value - carry * BASE
    while carry != 0:
        value = carry
        carry = (value + HALF_BASE) >> BITS
        w[s, length] = value - carry * BASE
        length += 1
    while length > 0 and w[s, length - 1] == 0:
        length -= 1
    n[s] = length


@kernel
def add(w, n, a, b, c):
    """Number ``c`` becomes ``a + b`` (``c`` may be ``a``)."""
    length = max(n[a], n[b])
    for i in range(length):
        value = w[a, i] if i < n[a] else 0
        w[c, i] = value + w[b, i] if i < n[b] else value
    _carry(w, n, c, length)


@kernel
def subtract(w, n, a, b, c):
    """Number ``c`` becomes ``a - b`` (``c`` may be ``a``)."""
    length = max(n[a], n[b])
    for i in range(length):
        value = w[a, i] if i < n[a] else 0
        w[c, i] = value - w[b, i] if i < n[b] else value
    _carry(w, n, c, length)


@kernel
def multiply(w, n, a, b, c):
    """Number ``c`` becomes ``a * b`` (``c`` is another slot)."""
    length = n[a] + n[b]
    for i in range(length):
        w[c, i] = 0
    for i in range(n[a]):
        limb = w[a, i]
        if limb != 0:
            for j in range(n[b]):
                w[c, i + j] += limb * w[b, j]
    _carry(w, n, c, length)


@kernel
def sign(w, n, s):
    if n[s] == 0:
        return 0
    return 1 if w[s, n[s] - 1] > 0 else -1


# --- doubles as integers --------------------------------------------------------------------------


@kernel
def decompose(x, mantissa, exponent):
    """Write ``x[i] = mantissa[i] * 2**exponent[i]``; return the smallest exponent and the highest bit."""
    least, greatest = 1 << 20, -(1 << 20)
    for i in range(len(x)):
        if x[i] == 0.0:
            mantissa[i] = 0
            exponent[i] = 0
            continue
        fraction, power = math.frexp(x[i])
        m = int(fraction * 9007199254740992.0)  # 2**53
        _, zeros = math.frexp(float(m & -m))  # the lowest set bit, so that short numbers stay short
        zeros -= 1
        mantissa[i] = m >> zeros
        exponent[i] = power - 53 + zeros
        least = min(least, exponent[i])
        greatest = max(greatest, power)
    if greatest < least:  # all zero
        return 0, 0
    return least, greatest


@kernel
def load(w, n, s, mantissa, exponent, least, i, j):
    """Number ``s`` becomes ``x[i] - x[j]`` in units of ``2**least``."""
    length = 0
    for k, sign in ((i, 1), (j, -1)):
        if mantissa[k] == 0:
            continue
        shift = exponent[k] - least
        first = shift // BITS
        while length < first + 2:
            w[s, length] = 0
            length += 1
        low = (mantissa[k] & MASK) << (shift % BITS)
        high = (mantissa[k] >> BITS) << (shift % BITS)
        w[s, first] += sign * low
        w[s, first + 1] += sign * high
    _carry(w, n, s, length)


@kernel
def differences(x, dimension, degree, slots):
    """Differences of the points ``x`` (a flat array) to the last point, as 64-bit integers or as limbs.

    ``degree`` is the degree of the polynomial that the caller evaluates, ``slots`` how many numbers it needs.
    Returns ``(fits, small, w, n)``. If ``fits``, the differences are in ``small``, and a polynomial of this
    degree in them can be evaluated with 64-bit integers. Otherwise they are in the first slots of ``w``.
    """
    count = len(x) // dimension
    mantissa = np.empty(len(x), np.int64)
    exponent = np.empty(len(x), np.int64)
    least, greatest = decompose(x, mantissa, exponent)
    span = greatest - least
    small = np.empty(len(x) - dimension, np.int64)
    if span <= 61:
        largest = 0
        for i in range(len(small)):
            j = len(small) + i % dimension
            a = 0 if mantissa[i] == 0 else mantissa[i] << (exponent[i] - least)
            b = 0 if mantissa[j] == 0 else mantissa[j] << (exponent[j] - least)
            small[i] = a - b
            largest = max(largest, abs(small[i]))
        _, bits = math.frexp(float(largest))
        limit = (0, 30, 29, 20, 14, 11)[degree]  # see the sums that the callers form
        if bits <= limit:
            return True, small, np.empty((0, 0), np.int64), np.empty(0, np.int64)
    width = (span // BITS + 4) * degree + 4
    w = np.empty((slots, width), np.int64)
    n = np.empty(slots, np.int64)
    for i in range(slots):
        n[i] = 0
    for i in range((count - 1) * dimension):
        load(w, n, i, mantissa, exponent, least, i, (count - 1) * dimension + i % dimension)
    return False, small, w, n


# --- determinants ---------------------------------------------------------------------------------
# Slots after the differences are counted from len(s), because numba would compile a helper for each literal.


@kernel
def minor_of(w, n, a, b, c, d, t, out):
    """Number ``out`` becomes ``a * d - b * c``; ``t`` is scratch."""
    multiply(w, n, a, d, out)
    multiply(w, n, b, c, t)
    subtract(w, n, out, t, out)


@kernel
def exact_orient2(ax, ay, bx, by, cx, cy):
    """Sign of the determinant of rows a - c, b - c."""
    fits, s, w, n = differences(np.array([ax, ay, bx, by, cx, cy]), 2, 2, 6)
    if fits:
        value = s[0] * s[3] - s[1] * s[2]
        return int(value > 0) - int(value < 0)
    free = len(s)
    minor_of(w, n, free - 4, free - 3, free - 2, free - 1, free, free + 1)
    return sign(w, n, free + 1)


@kernel
def exact_incircle(ax, ay, bx, by, cx, cy, px, py):
    """Sign of the determinant of rows (a - p, |a - p|^2), (b - p, ...), (c - p, ...)."""
    fits, s, w, n = differences(np.array([ax, ay, bx, by, cx, cy, px, py]), 2, 4, 12)
    if fits:
        value = (
            (s[0] * s[0] + s[1] * s[1]) * (s[2] * s[5] - s[3] * s[4])
            + (s[2] * s[2] + s[3] * s[3]) * (s[4] * s[1] - s[5] * s[0])
            + (s[4] * s[4] + s[5] * s[5]) * (s[0] * s[3] - s[1] * s[2])
        )
        return int(value > 0) - int(value < 0)
    free = len(s)
    lift, cross, t, total = free, free + 1, free + 2, free + 3
    n[total] = 0
    for k in range(3):
        u, v = (2 * k + 2) % 6, (2 * k + 4) % 6  # the two other rows, in cyclic order
        multiply(w, n, 2 * k, 2 * k, lift)
        multiply(w, n, 2 * k + 1, 2 * k + 1, t)
        add(w, n, lift, t, lift)
        minor_of(w, n, u, u + 1, v, v + 1, t, cross)
        multiply(w, n, lift, cross, t)
        add(w, n, total, t, total)
    return sign(w, n, total)


@kernel
def exact_orient3(x):
    """Sign of the determinant of rows a - d, b - d, c - d; ``x`` has the twelve coordinates."""
    fits, s, w, n = differences(x, 3, 3, 13)
    if fits:
        value = (
            s[0] * (s[4] * s[8] - s[5] * s[7])
            - s[1] * (s[3] * s[8] - s[5] * s[6])
            + s[2] * (s[3] * s[7] - s[4] * s[6])
        )
        return int(value > 0) - int(value < 0)
    free = len(s)
    cross, t, total = free, free + 1, free + 2
    n[total] = 0
    for k in range(3):
        u, v = (k + 1) % 3, (k + 2) % 3
        minor_of(w, n, 3 + u, 3 + v, 6 + u, 6 + v, t, cross)
        multiply(w, n, k, cross, t)
        add(w, n, total, t, total)
    return sign(w, n, total)


@kernel
def exact_insphere(x):
    """Sign of the determinant of rows (p_i - p, |p_i - p|^2), i = 0..3; ``x`` has fifteen coordinates."""
    fits, s, w, n = differences(x, 3, 5, 20)
    rows = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
    if fits:
        value = 0
        for k in range(4):
            a, b, c = 3 * rows[k][0], 3 * rows[k][1], 3 * rows[k][2]
            minor = (
                s[a] * (s[b + 1] * s[c + 2] - s[b + 2] * s[c + 1])
                - s[a + 1] * (s[b] * s[c + 2] - s[b + 2] * s[c])
                + s[a + 2] * (s[b] * s[c + 1] - s[b + 1] * s[c])
            )
            lift = s[3 * k] * s[3 * k] + s[3 * k + 1] * s[3 * k + 1] + s[3 * k + 2] * s[3 * k + 2]
            value += minor * lift if k % 2 == 1 else -minor * lift
        return int(value > 0) - int(value < 0)
    free = len(s)
    cross, t, minor, lift, total = free, free + 1, free + 2, free + 3, free + 4
    n[total] = 0
    for k in range(4):
        a, b, c = 3 * rows[k][0], 3 * rows[k][1], 3 * rows[k][2]
        n[minor] = 0
        n[lift] = 0
        for i in range(3):
            u, v = (i + 1) % 3, (i + 2) % 3
            minor_of(w, n, b + u, b + v, c + u, c + v, t, cross)
            multiply(w, n, a + i, cross, t)
            add(w, n, minor, t, minor)
            multiply(w, n, 3 * k + i, 3 * k + i, t)
            add(w, n, lift, t, lift)
        multiply(w, n, minor, lift, t)
        if k % 2 == 1:
            add(w, n, total, t, total)
        else:
            subtract(w, n, total, t, total)
    return sign(w, n, total)


# --- any dimension, Python's integers -------------------------------------------------------------


def integers(coordinates: np.ndarray) -> list[list[int]]:
    """The rows of an (m, d) array of finite doubles as integers over one power of two."""
    ratios = [[float(x).as_integer_ratio() for x in row] for row in coordinates]
    common = max((q for row in ratios for _, q in row), default=1)  # all denominators are powers of two
    return [[p * (common // q) for p, q in row] for row in ratios]


def determinant_sign(matrix: list[list[int]]) -> int:
    """Sign of an integer determinant by Bareiss' elimination, in which all divisions are exact."""
    a = [row[:] for row in matrix]
    size, sign, previous = len(a), 1, 1
    for k in range(size - 1):
        pivot = next((i for i in range(k, size) if a[i][k] != 0), None)
        if pivot is None:
            return 0
        if pivot != k:
            a[k], a[pivot] = a[pivot], a[k]
            sign = -sign
        for i in range(k + 1, size):
            for j in range(k + 1, size):
                a[i][j] = (a[i][j] * a[k][k] - a[i][k] * a[k][j]) // previous
        previous = a[k][k]
    value = a[-1][-1]
    return sign * ((value > 0) - (value < 0))


def exact_orient(simplex: np.ndarray) -> int:
    """Sign of the determinant of rows p_i - p_0 in any dimension."""
    p = integers(simplex)
    return determinant_sign([[x - y for x, y in zip(row, p[0])] for row in p[1:]])


def exact_in_sphere(simplex: np.ndarray, q: np.ndarray) -> int:
    """Positive if q is strictly inside the sphere of a positively oriented simplex, in any dimension."""
    *p, center = integers(np.vstack([simplex, np.asarray(q)[None]]))
    rows = [[x - y for x, y in zip(row, center)] for row in p]
    sign = determinant_sign([[*row, sum(x * x for x in row)] for row in rows])
    return sign if len(center) % 2 == 0 else -sign
