"""Checks of single arguments (a number, a count, a mapping); the error messages name the argument."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .errors import InputError

__all__ = [
    "DEFAULT_BUDGET",
    "MOST_VERTICES",
    "as_count",
    "as_flag",
    "as_flags",
    "as_mapping",
    "as_number",
    "as_seed",
    "finite",
    "positive",
]


DEFAULT_BUDGET = 10_000_000  # the largest number of vertices unless the caller gives one; some gigabytes


MOST_VERTICES = 2**31 // 6 - 4  # the largest number of vertices of a planar mesh with 32-bit half-edges


def finite(value: Any, name: str) -> float:
    """Return ``value`` as a finite float; otherwise raise an error that names it ``name``."""
    number = as_number(value, name)
    if not np.isfinite(number):
        raise InputError(f"{name} = {number} must be finite")
    return number


def positive(value: Any, name: str) -> float:
    """Return ``value`` as a positive finite float; otherwise raise an error that names it ``name``."""
    number = as_number(value, name)
    if not (number > 0 and np.isfinite(number)):
        raise InputError(f"{name} = {number} must be positive and finite")
    return number


def as_number(value: Any, name: str) -> float:
    """Return ``value`` as a float; texts and truth values, which `float` would take, are no numbers."""
    try:
        if isinstance(value, str | bytes | bytearray | bool | np.bool_):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number, not {value!r}") from None


def as_flag(value: Any, name: str) -> bool:
    """Return ``value`` if it is True or False; otherwise raise an error that names it ``name``."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} must be True or False, not {value!r}")
    return bool(value)


def as_flags(**values: Any) -> None:
    """Raise an error that names the first of several options that is not True or False."""
    for name, value in values.items():
        as_flag(value, name)


def as_count(value: Any, name: str) -> int:
    """Return ``value`` as an int that is not negative; otherwise raise an error that names it ``name``."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 0:
        raise InputError(f"{name} = {value!r} must be a whole number that is not negative")
    return int(value)


def as_seed(value: Any) -> int:
    """Return the seed of a generator of random numbers, a count of any size, as one of 62 bits."""
    return as_count(value, "seed") & ((1 << 62) - 1)


def as_mapping(value: Any, name: str) -> Mapping[Any, Any]:
    """Return ``value`` if it is a mapping; otherwise raise an error that names it ``name``."""
    if not isinstance(value, Mapping):
        raise InputError(f"{name} must be a dict, not {type(value).__name__}")
    return value
