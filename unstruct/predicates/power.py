"""The power test: is a weighted point below the hyperplane through the lifted vertices of a cell? Exact.

A point p of weight w is lifted to the height |p|^2 - w. For equal weights this is the in-sphere test. The
stages are those of `batch`: a floating-point filter, and integers where it leaves the sign open. Kernels take
rows (x, y, w) or (x, y, z, w), scaled: coordinates and weights are at most 1 in magnitude.

Book: 2.1. Source: F. Aurenhammer, SIAM Journal on Computing 16 (1987) 78-96.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.jit import kernel, lean
from .exact import (
    BITS,
    add,
    decompose,
    determinant_sign,
    integers,
    load,
    minor_of,
    multiply,
    sign,
    subtract,
)
from .filters import EPS, TINY, UNDECIDED

__all__ = ["power2", "power3", "power_factor", "power_signs"]

Floats = NDArray[np.float64]

# Each term of the determinant has the errors of at most 12 (in space 17) operations.
POWER2_BOUND, POWER3_BOUND = 16 * EPS, 24 * EPS


@kernel
def _weighted_differences(x, d, slots):
    """Differences to the last row and their lifts, as limbs; rows of ``x`` end with their weights.

    Slot d i + k gets coordinate k of row i, and slot d (d + 1) + i its lift, in units of one power of two and
    of its square. Returns ``(w, n)`` with ``slots`` numbers more.
    """
    count = d + 1
    place, weight = np.ascontiguousarray(x[:, :d]).ravel(), x[:, d].copy()
    mantissa, exponent = np.empty(len(place), np.int64), np.empty(len(place), np.int64)
    heavy, power = np.empty(len(weight), np.int64), np.empty(len(weight), np.int64)
    least, greatest = decompose(place, mantissa, exponent)
    low, high = decompose(weight, heavy, power)
    least = min(least, low // 2)
    span = max(greatest - least, 0)
    square = max(2 * span, high - 2 * least)
    width = square // BITS + 8 + d * (span // BITS + 4) + 8
    size = count * d + count + slots
    w, n = np.empty((size, width), np.int64), np.zeros(size, np.int64)
    t = size - 1
    for i in range(count):
        lift = count * d + i
        for k in range(d):
            load(w, n, d * i + k, mantissa, exponent, least, d * i + k, d * count + k)
            multiply(w, n, d * i + k, d * i + k, t)
            add(w, n, lift, t, lift)
        load(w, n, t, heavy, power, 2 * least, i, count)
        subtract(w, n, lift, t, lift)
    return w, n


@kernel
def exact_power2(x):
    """Sign of the determinant of rows (p_i - q, |p_i - q|^2 - w_i + w_q); rows (x, y, w), q last."""
    w, n = _weighted_differences(x, 2, 4)
    cross, t, total = 9, 10, 11
    for k in range(3):
        u, v = (2 * k + 2) % 6, (2 * k + 4) % 6
        minor_of(w, n, u, u + 1, v, v + 1, t, cross)
        multiply(w, n, 6 + k, cross, t)
        add(w, n, total, t, total)
    return sign(w, n, total)


@kernel
def exact_power3(x):
    """Like `exact_power2`, in space: negative for a q below the hyperplane of a positive tetrahedron."""
    w, n = _weighted_differences(x, 3, 5)
    cross, t, minor, total = 16, 17, 18, 19
    for k in range(4):
        a, b, c = 0 if k > 0 else 3, 3 if k > 1 else 6, 6 if k > 2 else 9
        n[minor] = 0
        for i in range(3):
            u, v = (i + 1) % 3, (i + 2) % 3
            minor_of(w, n, b + u, b + v, c + u, c + v, t, cross)
            multiply(w, n, a + i, cross, t)
            add(w, n, minor, t, minor)
        multiply(w, n, minor, 12 + k, t)
        if k % 2 == 1:
            add(w, n, total, t, total)
        else:
            subtract(w, n, total, t, total)
    return sign(w, n, total)


@kernel
def _exact2(rows, a, b, c, p):
    x = np.empty((4, 3))
    x[0], x[1], x[2], x[3] = rows[a], rows[b], rows[c], rows[p]
    return exact_power2(x)


@kernel
def _exact3(rows, a, b, c, d, p):
    x = np.empty((5, 4))
    x[0], x[1], x[2], x[3], x[4] = rows[a], rows[b], rows[c], rows[d], rows[p]
    return -exact_power3(x)


@lean
def filter_power2(rows, a, b, c, p):
    """`power2` if floating point decides it, otherwise UNDECIDED."""
    px, py, pw = rows[p, 0], rows[p, 1], rows[p, 2]
    ax, ay, bx, by, cx, cy = (
        rows[a, 0] - px, rows[a, 1] - py, rows[b, 0] - px, rows[b, 1] - py, rows[c, 0] - px, rows[c, 1] - py,
    )  # fmt: skip
    aw, bw, cw = rows[a, 2] - pw, rows[b, 2] - pw, rows[c, 2] - pw
    bc, cb, ca, ac, ab, ba = bx * cy, cx * by, cx * ay, ax * cy, ax * by, bx * ay
    alift, blift, clift = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    det = (alift - aw) * (bc - cb) + (blift - bw) * (ca - ac) + (clift - cw) * (ab - ba)
    permanent = (
        (abs(bc) + abs(cb)) * (alift + abs(aw))
        + (abs(ca) + abs(ac)) * (blift + abs(bw))
        + (abs(ab) + abs(ba)) * (clift + abs(cw))
    )
    bound = POWER2_BOUND * permanent + TINY
    return 1 if det > bound else (-1 if det < -bound else UNDECIDED)


@kernel
def power2(rows, a, b, c, p):
    """Positive if p is strictly below the plane of counterclockwise a, b, c, lifted; zero in it; exact."""
    decided = filter_power2(rows, a, b, c, p)
    return decided if decided != UNDECIDED else _exact2(rows, a, b, c, p)


@lean
def filter_power3(rows, i, j, m, n, p):
    """`power3` if floating point decides it, otherwise UNDECIDED."""
    cell, det, permanent = (i, j, m, n), 0.0, 0.0
    px, py, pz, pw = rows[p, 0], rows[p, 1], rows[p, 2], rows[p, 3]
    for k in range(4):
        a, b, c = cell[0 if k > 0 else 1], cell[1 if k > 1 else 2], cell[2 if k > 2 else 3]
        ax, ay, az = rows[a, 0] - px, rows[a, 1] - py, rows[a, 2] - pz
        bx, by, bz = rows[b, 0] - px, rows[b, 1] - py, rows[b, 2] - pz
        cx, cy, cz = rows[c, 0] - px, rows[c, 1] - py, rows[c, 2] - pz
        bc, cb, ca, ac, ab, ba = bx * cy, cx * by, cx * ay, ax * cy, ax * by, bx * ay
        minor = az * (bc - cb) + bz * (ca - ac) + cz * (ab - ba)
        size = abs(az) * (abs(bc) + abs(cb)) + abs(bz) * (abs(ca) + abs(ac)) + abs(cz) * (abs(ab) + abs(ba))
        v = cell[k]
        x, y, z, w = rows[v, 0] - px, rows[v, 1] - py, rows[v, 2] - pz, rows[v, 3] - pw
        lift = x * x + y * y + z * z
        det += (lift - w) * minor if k % 2 == 1 else -(lift - w) * minor
        permanent += (lift + abs(w)) * size
    bound = POWER3_BOUND * permanent + TINY
    return -1 if det > bound else (1 if det < -bound else UNDECIDED)


@kernel
def power3(rows, a, b, c, d, p):
    """Positive if p is strictly below the hyperplane of a, b, c, d with orient3 > 0, lifted; exact."""
    decided = filter_power3(rows, a, b, c, d, p)
    return decided if decided != UNDECIDED else _exact3(rows, a, b, c, d, p)


# --- many cells -----------------------------------------------------------------------------------


@kernel
def _batch(blocks, factors, signs):
    """Signs of blocks of d + 2 rows with weights, the query last, in the plane and in space."""
    for i in range(len(blocks)):
        block, f = blocks[i], factors[i]
        scaled = block * f
        scaled[:, -1] *= f
        if block.shape[1] == 3:
            found = filter_power2(scaled, 0, 1, 2, 3)
            signs[i] = found if found != UNDECIDED else exact_power2(block.copy())
        else:
            found = filter_power3(scaled, 0, 1, 2, 3, 4)
            signs[i] = found if found != UNDECIDED else -exact_power3(block.copy())


def power_factor(points: Floats, weights: Floats) -> float:
    """A power of two that takes coordinates, and by its square also weights, to at most 1 in magnitude."""
    most, heaviest = float(np.abs(points).max(initial=0.0)), float(np.abs(weights).max(initial=0.0))
    power = -math.frexp(most)[1] if most else 1023
    if heaviest:
        power = min(power, -((math.frexp(heaviest)[1] + 1) // 2))
    return math.ldexp(1.0, min(power, 1023)) if most or heaviest else 1.0


def power_signs(points: Floats, weights: Floats, simplices: NDArray[Any], queries: NDArray[Any]) -> Any:
    """The power test of many cells, each with one point.

    Parameters
    ----------
    points : (n, d) array
        Finite coordinates, unscaled.
    weights : (n,) array
    simplices : (m, d + 1) array of int
        Positively oriented cells.
    queries : (m,) array of int
        The vertex that is tested against each.

    Returns
    -------
    ndarray of int8, shape (m,)
        1 if the lifted point is strictly below the hyperplane through the lifted corners, 0 if it is in it,
        and -1 if it is above. Exact.
    """
    d = points.shape[1]
    rows = np.column_stack([simplices, queries])
    signs = np.empty(len(rows), dtype=np.int8)
    if d not in (2, 3):
        lifted = np.column_stack([points, weights])
        signs[:] = [_exact_power(lifted[row]) for row in rows]
        return signs
    blocks = np.concatenate([points[rows], weights[rows][..., None]], axis=2)
    most = np.frexp(np.abs(blocks[..., :-1]).max(axis=(1, 2), initial=0.0))
    heaviest = np.frexp(np.abs(blocks[..., -1]).max(axis=1, initial=0.0))
    none = 2000
    power = np.where(most[0] > 0, -most[1], none)
    power = np.minimum(power, np.where(heaviest[0] > 0, -((heaviest[1] + 1) // 2), none))
    with np.errstate(over="ignore", under="ignore"):
        _batch(blocks, np.ldexp(1.0, np.minimum(power, 1023)), signs)
    return signs


def _exact_power(rows: Floats) -> int:
    """The power test of a positive cell in any dimension, by integers; rows end with weights, q last."""
    d = rows.shape[1] - 1
    place = integers(rows[:, :-1])
    unit = _bits(rows[:, :-1])
    heavy, shift = integers(rows[:, -1:]), _bits(rows[:, -1:])
    up = max(0, shift - 2 * unit)  # lifts times 2**up are integers, and so are weights times 2**down
    down = 2 * unit + up - shift
    *cells, (q, (weight,)) = list(zip(place, heavy))
    matrix = []
    for p, (w,) in cells:
        row = [x - y for x, y in zip(p, q)]
        matrix.append([*row, (sum(x * x for x in row) << up) - ((w - weight) << down)])
    found = determinant_sign(matrix)
    return found if d % 2 == 0 else -found


def _bits(values: Floats) -> int:
    """The power of two by which `integers` multiplies."""
    return max(float(x).as_integer_ratio()[1].bit_length() - 1 for x in values.ravel())
