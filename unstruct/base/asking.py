"""Functions of the caller's: an error that they raise is reported with the first point concerned."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

__all__ = ["asked_at", "first_to_raise"]

Array = NDArray[np.float64]


def asked_at(
    function: Callable[[Array], Any],
    points: Array,
    called: str,
    takes: str,
    *,
    first: int = 0,
    name: str = "x",
) -> Any:
    """What a function returns at some points.

    Parameters
    ----------
    function : callable
        It takes an array (k, d).
    points : array (k, d)
        ``points[0]`` is row ``first`` of the array that the caller gave.
    called, takes, name : str
        What the function is called in a message, what it takes and returns, and what the array is called.

    Raises
    ------
    InputError
        If the function raises an error. One of this package is passed on: its message says what is wrong.
    """
    try:
        return function(points)
    except InputError:
        raise
    except Exception as error:
        place = "for no points"
        if len(points):
            row = first_to_raise(function, points)
            place = f"at {name}[{first + row}] = {points[row].tolist()}"
        raise InputError(
            f"{called} raised {type(error).__name__} ({error}) {place}; it takes {takes}"
        ) from error


def first_to_raise(function: Callable[[Array], Any], points: Array) -> int:
    """The last row of the shortest prefix for which the function raises, by bisection."""
    low, high = 0, len(points)  # the function raises an error for the first `high` rows
    while high - low > 1:
        middle = (low + high) // 2
        try:
            function(points[:middle])
            low = middle
        except Exception:
            high = middle
    return max(high - 1, 0)
