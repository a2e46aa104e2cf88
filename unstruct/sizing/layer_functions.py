"""What functions of the caller's return for layers; errors that they raise are told with the place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from .field import first_to_raise

__all__ = ["asked_at", "asked_for_shares"]

Array = NDArray[np.float64]


def asked_at(function: Callable[[Array], Any], name: str, places: Array) -> Any:
    """What a function of places returns; an error that it raises is told with the first place concerned."""
    try:
        return function(places)
    except InputError:  # its message tells what is wrong
        raise
    except Exception as error:
        row = first_to_raise(function, places)
        raise InputError(
            f"the function for {name} raised {type(error).__name__} ({error}) at place {row} = "
            f"{places[row].tolist()}; it takes places (k, d) and returns k positive numbers"
        ) from error


def asked_for_shares(function: Callable[[Array], Any], n: int) -> Array:
    """What a function of shares 0, 1 / n, ..., 1 returns: n + 1 increasing numbers."""
    try:
        shares = np.asarray(function(np.arange(n + 1) / n), dtype=np.float64)
    except Exception as error:
        raise InputError(
            f"the function of shares raised {type(error).__name__} ({error}) for the shares 0, 1 / {n}, "
            f"..., 1; it takes these {n + 1} numbers as an array and returns as many"
        ) from error
    if shares.shape != (n + 1,) or not np.isfinite(shares).all() or not (np.diff(shares) > 0).all():
        raise InputError(
            f"the function of shares must return {n + 1} finite, increasing values for the shares 0, "
            f"1 / {n}, ..., 1; lambda s: s**2 does"
        )
    return shares
