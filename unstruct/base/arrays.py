"""Arrays given by callers: checked, converted to the right type, made read-only."""

from __future__ import annotations

from typing import Any

import numpy as np

from .errors import InputError

__all__ = ["as_numbers", "as_points", "distinct", "frozen", "refrozen"]


def as_points(points: Any, name: str = "points") -> np.ndarray:
    """Return ``points`` as a finite float64 array of shape (n, d), or name the first row that is wrong.

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


def as_numbers(values: Any, name: str) -> np.ndarray:
    """Return ``values`` as a float64 array of any shape; otherwise raise an error that names it ``name``."""
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be real numbers in an array") from None


def distinct(values: Any) -> np.ndarray:
    """The sorted distinct entries. (`numpy.unique` hashes integers, which took 20 to 100 times as long.)"""
    row = np.sort(values, axis=None)
    if len(row) == 0:
        return row
    head = np.empty(len(row), dtype=bool)
    head[0] = True
    np.not_equal(row[1:], row[:-1], out=head[1:])
    return row[head]


def frozen(array: np.ndarray) -> np.ndarray:
    """A read-only view of ``array``; the array itself stays writable."""
    view = array.view()
    view.flags.writeable = False
    return view


def refrozen(state: dict[str, Any]) -> dict[str, Any]:
    """The attributes of an unpickled object, its arrays read-only again: pickle restores them writable."""
    return {
        name: refrozen(value)
        if isinstance(value, dict)
        else frozen(value)
        if isinstance(value, np.ndarray)
        else value
        for name, value in state.items()
    }
