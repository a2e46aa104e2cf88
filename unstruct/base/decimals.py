"""Rows of numbers as text, and text as rows of numbers: millions a second, every double restored exactly.

Doubles get the fewest digits that restore them, as Python's ``repr`` gives them; the kernel follows
R. Giulietti, *The Schubfach way to render doubles* (2020). Few rows are written by Python itself, with the
same result.
"""

from __future__ import annotations

import warnings
from functools import cache

import numpy as np

from .jit import inline, kernel

__all__ = ["numbers_of", "rows_as_text"]

FEW_ROWS = 20_000  # below this the kernel is not worth its compilation
LONGEST_REAL = 25  # "-1.2345678901234567e-308" and a space
LONGEST_INTEGER = 21
ZERO_DIGIT, MINUS, POINT, SPACE, LINE_END = 48, 45, 46, 32, 10
LETTER_E, PLUS = 101, 43
LEAST_POWER, MOST_POWER = -292, 324  # decimal exponents of the table
HALF_BITS, LOW_HALF = np.uint64(32), np.uint64(0xFFFFFFFF)
FRACTION_BITS, HIDDEN_BIT = np.uint64(52), np.uint64(1 << 52)
U0, U1, U2, U4, U10 = (np.uint64(i) for i in (0, 1, 2, 4, 10))


# ---------------------------------------------------------------------- writing


@cache
def _powers() -> tuple[np.ndarray, np.ndarray]:
    """The first 128 bits of powers of ten, rounded up: high and low words."""
    words = []
    for k in range(LEAST_POWER, MOST_POWER + 1):
        if k >= 0:
            shift = 128 - (10**k).bit_length()
            word = 10**k << shift if shift >= 0 else -(-(10**k) >> -shift)
        else:
            bits = (10**-k).bit_length() + 127
            word = -(-(1 << bits) // 10**-k)
            if word >= 1 << 128:
                word = -(-(1 << (bits - 1)) // 10**-k)
        words.append(word)
    return (
        np.array([word >> 64 for word in words], dtype=np.uint64),
        np.array([word & (2**64 - 1) for word in words], dtype=np.uint64),
    )


@inline
def _product(a, b):
    """The high and the low word of a product of two words."""
    a0, a1, b0, b1 = a & LOW_HALF, a >> HALF_BITS, b & LOW_HALF, b >> HALF_BITS
    low, mid, high = a0 * b0, a1 * b0, a1 * b1
    mid += low >> HALF_BITS
    other = (mid & LOW_HALF) + a0 * b1
    return high + (mid >> HALF_BITS) + (other >> HALF_BITS), (other << HALF_BITS) | (low & LOW_HALF)


@kernel
def _round_to_odd(high, low, factor):
    """The upper word of (high, low) times factor, its last bit set where something is cut off."""
    carry, _ = _product(low, factor)
    top, middle = _product(high, factor)
    total = middle + carry
    if total < middle:
        top += U1
    if total > U1:
        top |= U1
    return top


@kernel
def _shortest(bits, high, low):
    """The fewest decimal digits that restore a positive double: (digits, decimal exponent)."""
    fraction, exponent = bits & (HIDDEN_BIT - U1), np.int64(bits >> FRACTION_BITS)
    closer = fraction == U0 and exponent > 1  # the double below is at half the distance
    c, q = (fraction | HIDDEN_BIT, exponent - 1075) if exponent else (fraction, np.int64(-1074))
    odd = c & U1
    k = (q * 1262611 - (524031 if closer else 0)) >> 22
    shift = np.uint64(q + ((-k * 1741647) >> 19) + 1)
    h, l = high[-k - LEAST_POWER], low[-k - LEAST_POWER]
    below = U4 * c - (U1 if closer else U2)
    lower = _round_to_odd(h, l, below << shift) + odd
    middle = _round_to_odd(h, l, (U4 * c) << shift)
    upper = _round_to_odd(h, l, (U4 * c + U2) << shift) - odd
    s = middle >> U2
    if s >= U10:
        tens = s // U10
        down, up = lower <= U4 * U10 * tens, U4 * U10 * (tens + U1) <= upper
        if down != up:
            return tens + (U1 if up else U0), k + 1
    down, up = lower <= U4 * s, U4 * s + U4 <= upper
    if down != up:
        return s + (U1 if up else U0), k
    half = U4 * s + U2
    if middle > half or (middle == half and s & U1):
        return s + U1, k
    return s, k


@kernel
def _put_integer(value, out, at):
    """Write an integer; return the place behind it."""
    if value < 0:
        out[at] = MINUS
        at += 1
        value = -value
    size, rest = 1, value
    while rest >= 10:
        rest //= 10
        size += 1
    for i in range(at + size - 1, at - 1, -1):
        out[i] = ZERO_DIGIT + value % 10
        value //= 10
    return at + size


@kernel
def _put_real(bits, high, low, out, at):
    """Write a double as ``repr`` does; return the place behind it."""
    if bits >> np.uint64(63):
        out[at] = MINUS
        at += 1
        bits &= (U1 << np.uint64(63)) - U1
    digits, power = (U0, np.int64(0)) if bits == U0 else _shortest(bits, high, low)
    while digits and digits % U10 == U0:
        digits //= U10
        power += 1
    size, rest = 1, digits
    while rest >= U10:
        rest //= U10
        size += 1
    point = size + power if digits else 1  # the number of digits before the decimal point
    if not digits:
        power = 0
    if -4 < point <= 16:
        return _put_plain(digits, size, point, out, at)
    value = np.int64(digits)
    if size > 1:
        end = _put_integer(value, out, at + 1)
        out[at] = out[at + 1]
        out[at + 1] = POINT
        at = end
    else:
        at = _put_integer(value, out, at)
    out[at] = LETTER_E
    out[at + 1] = MINUS if point < 1 else PLUS
    power = abs(point - 1)
    if power < 10:
        out[at + 2] = ZERO_DIGIT
        return _put_integer(power, out, at + 3)
    return _put_integer(power, out, at + 2)


@kernel
def _put_plain(digits, size, point, out, at):
    """Write digits without an exponent, ``point`` of them before the decimal point."""
    value = np.int64(digits)
    if point <= 0:
        out[at] = ZERO_DIGIT
        out[at + 1] = POINT
        at += 2
        for _ in range(-point):
            out[at] = ZERO_DIGIT
            at += 1
        return _put_integer(value, out, at)
    if point >= size:
        at = _put_integer(value, out, at)
        for _ in range(point - size):
            out[at] = ZERO_DIGIT
            at += 1
        out[at] = POINT
        out[at + 1] = ZERO_DIGIT
        return at + 2
    end = _put_integer(value, out, at) + 1
    for i in range(end - 1, at + point, -1):
        out[i] = out[i - 1]
    out[at + point] = POINT
    return end


@kernel
def _put_rows(integers, reals, high, low, out):
    """Write a line for each row, integers first; return the number of bytes."""
    at = 0
    for i in range(len(integers)):
        for j in range(integers.shape[1]):
            at = _put_integer(integers[i, j], out, at)
            out[at] = SPACE
            at += 1
        for j in range(reals.shape[1]):
            at = _put_real(reals[i, j], high, low, out, at)
            out[at] = SPACE
            at += 1
        out[at - 1] = LINE_END
    return at


def rows_as_text(integers: np.ndarray | None, reals: np.ndarray | None = None) -> bytes:
    """A line for each row: its integers, then its doubles, with spaces between.

    Parameters
    ----------
    integers : array_like of int, shape (n, a), optional
    reals : array_like, shape (n, b), optional
        Finite. Each is written with the fewest digits that restore it, as by ``repr``.

    Notes
    -----
    O(n (a + b)): about 20 ns an integer, 100 ns a double, in blocks of little memory.
    """
    n = len(integers) if integers is not None else len(reals)  # type: ignore[arg-type]
    whole = np.asarray(np.empty((n, 0)) if integers is None else integers, dtype=np.int64)
    parts = np.asarray(np.empty((n, 0)) if reals is None else reals, dtype=np.float64)
    if whole.shape[1] + parts.shape[1] == 0:
        return b""
    if n < FEW_ROWS or not hasattr(_put_rows, "py_func"):
        lines = zip(
            *(map(str, column) for column in whole.T.tolist()),
            *(map(repr, column) for column in parts.T.tolist()),
        )
        return "".join(f"{' '.join(line)}\n" for line in lines).encode()
    high, low = _powers()
    found = []
    for start in range(0, n, 100_000):
        some, others = whole[start : start + 100_000], parts[start : start + 100_000]
        longest = LONGEST_INTEGER * some.shape[1] + LONGEST_REAL * others.shape[1]
        out = np.empty(len(some) * longest, dtype=np.uint8)
        bits = np.ascontiguousarray(others).view(np.uint64)
        end = _put_rows(np.ascontiguousarray(some), bits, high, low, out)
        found.append(out[:end].tobytes())
    return b"".join(found)


# ---------------------------------------------------------------------- reading


def numbers_of(text: str | bytes, kind: type = float) -> np.ndarray | None:
    """All numbers in a text, one-dimensional; None if there is something else in it."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return np.fromstring(text, dtype=np.float64 if kind is float else np.int64, sep=" ")
        except (ValueError, DeprecationWarning):
            return None
