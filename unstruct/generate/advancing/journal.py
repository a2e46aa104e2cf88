"""The record of a classical front: a row for each cell, in order, and the candidates that were tried."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline
from ...connect.insertion.engine import grown

__all__ = ["Journal", "columns_of", "empty_journal", "larger_journal", "note_tried"]


class Journal(NamedTuple):
    """The record."""

    log: NDArray[np.int32]  # (., 2) the reason, and how many rows of ``tried`` there were before
    numbers: NDArray[np.float64]  # (., d + 2) the ideal point, the wanted length, the radius of the search
    tried: NDArray[np.int32]  # (., 2) the vertex (-1: the ideal point) and the verdict; (0, 2) if not wanted


def empty_journal(dimension: int) -> Journal:
    """A record of nothing."""
    none = np.empty((0, 2), dtype=np.int32)
    return Journal(none, np.empty((0, dimension + 2)), none)


def larger_journal(old: Journal, cells: int, recorded: int, vertices: int) -> Journal:
    """The record with room for so many cells, and for the candidates of one more step."""
    tried = 2 * recorded + 4 * vertices + 64
    return Journal(grown(old.log, cells), grown(old.numbers, cells), grown(old.tried, tried))


@inline
def note_tried(journal, row, v, verdict):
    """Record a candidate, -1 for the ideal point, and what was found about it, if a record is wanted."""
    if len(journal.tried) > 0:
        journal.tried[row, 0], journal.tried[row, 1] = v, verdict


def columns_of(
    journal: Journal,
    cells: int,
    recorded: int,
    factor: float,
    reasons: Sequence[str],
    verdicts: Sequence[str],
) -> dict[str, NDArray]:
    """The record by columns, with the names of reasons and verdicts; lengths are divided by the factor."""
    log, tried, numbers = journal.log[:cells], journal.tried[:recorded], journal.numbers[:cells] / factor
    return {
        "reason": np.array(reasons)[log[:, 0]],
        "ideal": numbers[:, :-2].copy(),
        "size": numbers[:, -2].copy(),
        "radius": numbers[:, -1].copy(),
        "start": np.append(log[:, 1], len(tried)),
        "vertex": tried[:, 0].copy(),
        "verdict": np.array(verdicts)[tried[:, 1]],
    }
