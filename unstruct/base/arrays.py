"""Arrays as they come in: checked, of the right type, read-only."""

from __future__ import annotations

from typing import Any

import numpy as np

from .errors import InputError

__all__ = ["as_numbers", "as_points", "distinct", "frozen", "refrozen"]


def as_points(points: Any, name: str = "points") -> np.ndarray:
    """Return ``points`` as a finite float64 array of shape (n, d), or say which row is wrong.

    Raises
    ------
    InputError
        Wrong shape, complex or non-numeric type, masked, NaN or infinite entries.
    """
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
    if not finite.all():  # rows only now: reductions over short rows are slow
        row = int(np.argmin(finite.all(axis=1)))
        raise InputError(f"{name}[{row}] = {result[row].tolist()} is not finite; drop or mend it")
    if array.dtype.kind in "iu" and result.size and np.abs(result).max() >= 2.0**53:
        rounded = (result.astype(object) != array.astype(object)).any(axis=1)
        if rounded.any():
            row = int(np.argmax(rounded))
            raise InputError(
                f"{name}[{row}] = {array[row].tolist()} is no double; subtract an offset or scale first"
            )
    return result


def as_numbers(values: Any, name: str) -> np.ndarray:
    """A float64 array of any shape, or an error that calls it by ``name``."""
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be real numbers in an array") from None


def distinct(values: Any) -> np.ndarray:
    """All different entries, sorted; `numpy.unique` hashes integers, which took 20 to 100 times as long."""
    row = np.sort(values, axis=None)
    if len(row) == 0:
        return row
    head = np.empty(len(row), dtype=bool)
    head[0] = True
    np.not_equal(row[1:], row[:-1], out=head[1:])
    return row[head]


def frozen(array: np.ndarray) -> np.ndarray:
    """A read-only view: the caller's own array stays as it is."""
    view = array.view()
    view.flags.writeable = False
    return view


def refrozen(state: dict[str, Any]) -> dict[str, Any]:
    """The attributes of a pickled object: its arrays, which a pickle gives back writable, are read-only."""
    return {
        name: refrozen(value)
        if isinstance(value, dict)
        else frozen(value)
        if isinstance(value, np.ndarray)
        else value
        for name, value in state.items()
    }
