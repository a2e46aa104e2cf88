"""Rows of numbers as text, and text as rows of numbers; every double is restored exactly.

Doubles are written by Python's ``repr``, which gives them the fewest digits that restore them. Tables of
integers alone, the larger part of a mesh, are written by a kernel.
"""

from __future__ import annotations

import warnings

import numpy as np

from .jit import kernel

__all__ = ["numbers_of", "rows_as_text"]

FEW_ROWS = 20_000  # below this the kernel is not worth its compilation
LONGEST_INTEGER = 21  # with its sign and a space
ZERO_DIGIT, MINUS, SPACE, LINE_END = 48, 45, 32, 10


# ---------------------------------------------------------------------- writing


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
def _put_rows(integers, out):
    """Write a line for each row; return the number of bytes."""
    at = 0
    for i in range(integers.shape[0]):
        for j in range(integers.shape[1]):
            at = _put_integer(integers[i, j], out, at)
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
    O(n (a + b)): in tables of integers about 20 ns each, else about half a microsecond a number.
    """
    n = len(integers) if integers is not None else len(reals)  # type: ignore[arg-type]
    whole = np.asarray(np.empty((n, 0)) if integers is None else integers, dtype=np.int64)
    parts = np.asarray(np.empty((n, 0)) if reals is None else reals, dtype=np.float64)
    if whole.shape[1] + parts.shape[1] == 0:
        return b""
    if n < FEW_ROWS or parts.shape[1] > 0:
        lines = zip(
            *(map(str, column) for column in whole.T.tolist()),
            *(map(repr, column) for column in parts.T.tolist()),
        )
        return "".join(f"{' '.join(line)}\n" for line in lines).encode()
    found = []
    for start in range(0, n, 100_000):
        some = np.ascontiguousarray(whole[start : start + 100_000])
        out = np.empty(len(some) * LONGEST_INTEGER * some.shape[1], dtype=np.uint8)
        found.append(out[: _put_rows(some, out)].tobytes())
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
