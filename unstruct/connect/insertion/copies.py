"""Equal points: which one of them stands for all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["distinct_points"]


def distinct_points(
    rows: NDArray[np.float64], weights: NDArray[np.float64] | None = None
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """The rows that stand for all, increasing, and the others as pairs (copy, kept), sorted by copies.

    Of several equal points the heaviest is kept; of several such, the first.
    """
    n = len(rows)
    heavy = np.zeros(n) if weights is None else -weights
    order = np.lexsort((np.arange(n), heavy, *rows.T[::-1]))
    ordered = rows[order]
    new = np.ones(n, dtype=bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.cumsum(new) - 1
    kept = order[new]
    pairs = np.stack([order[~new], kept[group[~new]]], axis=1)
    return np.sort(kept), pairs[np.argsort(pairs[:, 0])].astype(np.int32)
