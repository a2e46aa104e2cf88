"""Single arguments: a number, a count, a mapping, checked, or an error that calls them by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError

if TYPE_CHECKING:
    pass

__all__ = ["DEFAULT_BUDGET", "MOST_VERTICES", "as_count", "as_mapping", "finite", "positive"]


DEFAULT_BUDGET = 10_000_000  # vertices of a mesh, if nothing else is said: some gigabytes


MOST_VERTICES = 2**31 // 6 - 4  # vertices of a planar mesh: half-edges are numbered by 32 bits


def finite(value: Any, name: str) -> float:
    """A finite number, or an error that calls it by ``name``."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number, not {value!r}") from None
    if not np.isfinite(number):
        raise InputError(f"{name} = {number} must be finite")
    return number


def positive(value: Any, name: str) -> float:
    """A positive finite number, or an error that calls it by ``name``."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number, not {value!r}") from None
    if not (number > 0 and np.isfinite(number)):
        raise InputError(f"{name} = {number} must be positive and finite")
    return number


def as_count(value: Any, name: str) -> int:
    """A whole number that is not negative, or an error that calls it by ``name``."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 0:
        raise InputError(f"{name} = {value!r} must be a whole number, not negative")
    return int(value)


def as_mapping(value: Any, name: str) -> Mapping[Any, Any]:
    """A mapping, or an error that calls it by ``name``."""
    if not isinstance(value, Mapping):
        raise InputError(f"{name} must be a dict, not {type(value).__name__}")
    return value
