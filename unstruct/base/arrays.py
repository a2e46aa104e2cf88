"""Arrays given by callers: checked, converted to the right type, made read-only."""

from __future__ import annotations

from typing import Any

import numpy as np

from .checked import CheckedDict
from .errors import InputError
from .jit import kernel

__all__ = [
    "FLOAT64",
    "INT32",
    "all_finite",
    "all_positive",
    "as_numbers",
    "as_points",
    "as_weights",
    "counted_off",
    "distinct",
    "fill",
    "flagged",
    "frozen",
    "refrozen",
    "surely_different",
    "within",
]

FLOAT64, INT32 = np.dtype(np.float64), np.dtype(np.int32)  # the one object that arrays of the type share
GREATEST = float(np.finfo(np.float64).max)
COUNTED_ONCE = 1 << 14  # numbers that are counted off once


@kernel
def fill(array, value):
    """Set all entries of a flat array, and return it: numba compiles `numpy.full` ten times as long."""
    for i in range(array.shape[0]):
        array[i] = value
    return array


@kernel
def all_finite(rows):
    """Whether all entries are finite: one call, where a ufunc and its reduction take ten times as long."""
    for i in range(rows.shape[0]):
        for k in range(rows.shape[1]):
            if not abs(rows[i, k]) <= GREATEST:
                return False
    return True


@kernel
def all_positive(values):
    """Whether all entries of a flat array are positive and finite."""
    for i in range(values.shape[0]):
        if not 0.0 < values[i] <= GREATEST:
            return False
    return True


@kernel
def _within(rows, low, limit):
    for i in range(rows.shape[0]):
        for k in range(rows.shape[1]):
            if rows[i, k] < low or rows[i, k] >= limit:
                return False
    return True


def within(rows: np.ndarray, limit: int, low: int = 0) -> bool:
    """Whether all entries of rows of integers are low, low + 1, ..., limit - 1."""
    if rows.dtype is INT32 and rows.flags.c_contiguous:  # the kernel is compiled for no other type
        return bool(_within(rows, low, limit))
    return not rows.size or bool(low <= rows.min() <= rows.max() < limit)


def flagged(n: int, *rows: Any) -> np.ndarray:
    """An array of n flags that are set in these rows: what `numpy.isin` tells, more quickly."""
    flags = np.zeros(n, dtype=bool)
    for some in rows:
        flags[some] = True
    return flags


def counted_off(n: int) -> np.ndarray:
    """0, 1, ..., n - 1 as read-only int32; for small n a part of one array that is there already."""
    return _FIRST[:n] if n <= COUNTED_ONCE else frozen(np.arange(n, dtype=np.int32))


def as_points(points: Any, name: str = "points") -> np.ndarray:
    """Return ``points`` as a finite float64 array of shape (n, d), or name the first row that is wrong.

    Raises
    ------
    InputError
        Wrong shape, complex or non-numeric type, masked, NaN or infinite entries.
    """
    if (
        type(points) is np.ndarray
        and points.dtype is FLOAT64
        and points.ndim == 2
        and points.shape[1] > 0
        and points.flags.c_contiguous
        and all_finite(points)
    ):
        return points
    if np.ma.isMaskedArray(points) and np.ma.getmaskarray(points).any():
        row = int(np.argwhere(np.ma.getmaskarray(points))[0][0])
        raise InputError(f"{name}[{row}] is masked; drop masked rows first")
    try:
        array = np.asarray(points)
    except ValueError as error:  # ragged lists
        raise InputError(f"{name} must be an array of shape (n, d): {error}") from None
    if array.ndim != 2 or array.shape[1] == 0:
        raise InputError(f"{name} must have shape (n, d) with d >= 1, not {array.shape}")
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} must be real numbers, not {array.dtype}")
    result = np.ascontiguousarray(array, dtype=np.float64)
    finite = np.isfinite(result)
    if not finite.all():  # look for the row only now, because reductions over short rows are slow
        row = int(np.argmin(finite.all(axis=1)))
        raise InputError(f"{name}[{row}] = {result[row].tolist()} is not finite; drop or mend it")
    if array.dtype.kind in "iu" and result.size and np.abs(result).max() >= 2.0**53:
        rounded = (result.astype(object) != array.astype(object)).any(axis=1)
        if rounded.any():
            row = int(np.argmax(rounded))
            raise InputError(
                f"{name}[{row}] = {array[row].tolist()} cannot be stored exactly in double precision; "
                "subtract an offset or scale first"
            )
    return result


def as_weights(weights: Any, count: int) -> np.ndarray:
    """Return ``weights`` as a finite float64 array of shape (count,), or name the first that is wrong.

    Raises
    ------
    InputError
        Wrong shape, non-numeric type, masked, NaN or infinite entries.
    """
    try:
        array = np.asanyarray(weights)
    except ValueError as error:  # ragged lists
        raise InputError(f"weights must be an array of shape ({count},): {error}") from None
    if array.shape != (count,):
        raise InputError(f"weights must have shape ({count},), one for each point, not {array.shape}")
    return as_points(array[:, None], "weights")[:, 0]


def as_numbers(values: Any, name: str) -> np.ndarray:
    """Return ``values`` as a float64 array of any shape; otherwise raise an error that names it ``name``."""
    try:
        array = np.asanyarray(values)
        if array.dtype.kind in "USMmc" or (array.dtype == object and _holds_text(array)):
            raise TypeError
        result = np.array(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be real numbers in an array") from None
    if np.ma.isMaskedArray(array) and np.ma.getmaskarray(array).any():
        raise InputError(f"{name} has masked entries; fill or drop them first")
    return result


def _holds_text(array: np.ndarray) -> bool:
    return any(isinstance(entry, str | bytes) for entry in array.ravel().tolist())


def distinct(values: Any) -> np.ndarray:
    """The sorted distinct entries. (`numpy.unique` hashes integers, which took 20 to 100 times as long.)"""
    row = np.sort(values, axis=None)
    if len(row) == 0:
        return row
    head = np.empty(len(row), dtype=bool)
    head[0] = True
    np.not_equal(row[1:], row[:-1], out=head[1:])
    return row[head]


def _mixed(numbers: np.ndarray) -> np.ndarray:
    """64-bit numbers to others, all different for different ones, in which each bit depends on all."""
    numbers = (numbers ^ (numbers >> np.uint64(32))) * np.uint64(0xD6E8FEB86659FD93)
    numbers = (numbers ^ (numbers >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return numbers ^ (numbers >> np.uint64(32))


def surely_different(rows: np.ndarray, *, as_sets: bool = False) -> bool:
    """Whether it is certain that no two rows of numbers are equal: by keys that equal rows have in common.

    Parameters
    ----------
    rows : (n, k) float64 or int32
        0.0 equals -0.0.
    as_sets : bool
        Whether rows with the same entries in another order are equal, too.
    """
    keys = np.zeros(len(rows), dtype=np.uint64)
    for k in range(rows.shape[1]):
        column = rows[:, k] + 0.0 if rows.dtype.kind == "f" else rows[:, k].astype(np.int64)
        keys += _mixed(column.view(np.uint64) + np.uint64(0 if as_sets else 0x9E3779B97F4A7C15 * k % 2**64))
    keys.sort()
    return not (keys[1:] == keys[:-1]).any()


def frozen(array: np.ndarray) -> np.ndarray:
    """A read-only view of ``array``; the array itself stays writable."""
    view = array.view()
    view.setflags(write=False)
    return view


_FIRST = frozen(np.arange(COUNTED_ONCE, dtype=np.int32))


def refrozen(state: dict[str, Any]) -> dict[str, Any]:
    """The attributes of an unpickled object, its arrays read-only again: pickle restores them writable."""
    return {name: _refrozen(value) for name, value in state.items()}


def _refrozen(value: Any) -> Any:
    if isinstance(value, CheckedDict):
        return value.of(refrozen(value))
    if isinstance(value, dict):
        return refrozen(value)
    if isinstance(value, tuple):  # named tuples take their entries one by one
        entries = map(_refrozen, value)
        return type(value)(*entries) if hasattr(value, "_fields") else tuple(entries)
    return frozen(value) if isinstance(value, np.ndarray) else value
