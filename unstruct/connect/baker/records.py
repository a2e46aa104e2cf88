"""Records of Baker's insertion: the triangulation that grows, and the star of a new vertex."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Growing", "Star"]


class Growing(NamedTuple):
    """The arrays of a triangulation that grows, and what an insertion notes of its cells."""

    cells: NDArray[np.int64]
    neighbors: NDArray[np.int64]
    source: NDArray[np.int64]  # the cell of the beginning that each comes from
    state: NDArray[np.int8]
    sides: NDArray[np.int8]
    place: NDArray[np.int64]
    free: NDArray[np.int64]  # rows that are free
    counters: NDArray[np.int64]


class Star(NamedTuple):
    """The new cells, written aside: which facet has which, their rows, and what they have beyond them."""

    slot: NDArray[np.int64]
    number: NDArray[np.int64]
    rows: NDArray[np.int64]
    links: NDArray[np.int64]
    back: NDArray[np.int64]
