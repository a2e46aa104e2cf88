"""What functions of the caller's return for layers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError

__all__ = ["asked_for_shares"]

Array = NDArray[np.float64]


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
