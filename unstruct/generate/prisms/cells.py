"""The cells of columns: wedges, and the pyramids and tetrahedra that are left of them where rays end."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .stars import Stars

__all__ = ["Cells", "cells_of", "in_one_fan"]

Numbers = NDArray[np.int32]
# What is left of a wedge (a, b, c, a', b', c') with a = a', or with a = a' and b = b'; VTK's order.
PYRAMID_OF_WEDGE = (1, 4, 5, 2, 0)
TETRAHEDRON_OF_WEDGE = (0, 1, 2, 5)


class Cells(NamedTuple):
    """Cells by kind, and for all of them in the order of the kinds their column and layer (from 0)."""

    kinds: dict[str, Numbers]
    column: NDArray[np.int64]
    layer: Numbers


def cells_of(columns: Numbers, number: Numbers) -> Cells:
    """The cells between the levels of rays.

    Parameters
    ----------
    columns : (c, 3) int32
    number : (levels + 1, r) int32
        The vertex of each ray on each level: the same on several levels where it stays.
    """
    steps = len(number) - 1
    low, high = number[:-1][:, columns], number[1:][:, columns]
    still = low == high
    every = np.concatenate([low, high], axis=2).reshape(-1, 6)
    if not still.any():
        column = np.tile(np.arange(len(columns)), steps)
        return Cells({"wedge": every}, column, np.repeat(np.arange(steps, dtype=np.int32), len(columns)))
    still = still.reshape(-1, 3)
    many = still.sum(axis=1)
    kinds: dict[str, Numbers] = {}
    order = []
    for name, count, corners in (
        ("wedge", 0, (0, 1, 2, 3, 4, 5)),
        ("pyramid", 1, PYRAMID_OF_WEDGE),
        ("tetra", 2, TETRAHEDRON_OF_WEDGE),
    ):
        rows = np.flatnonzero(many == count)
        # Turned so that the corner that stays, or the second of two, comes first, or second.
        turn = np.zeros(len(rows), dtype=np.int64)
        if count == 1:
            turn = still[rows].argmax(axis=1)
        elif count == 2:
            turn = (still[rows].argmin(axis=1) + 1) % 3
        places = (np.arange(3) + turn[:, None]) % 3
        places = np.concatenate([places, places + 3], axis=1)[:, list(corners)]
        if len(rows):
            kinds[name] = every[rows[:, None], places]
            order.append(rows)
    rows = np.concatenate(order) if order else np.empty(0, dtype=np.int64)
    return Cells(kinds, rows % len(columns), (rows // len(columns)).astype(np.int32))


def in_one_fan(stars: Stars, triangles: Numbers, kept: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Triangles of those that are kept, without the smaller fans at vertices that have several.

    Returns
    -------
    (t,) bool
        Around each vertex they are one fan, so that the columns over them are a manifold.
    """
    kept = kept.copy()
    ask = np.unique(triangles[~kept])
    while len(ask):
        dropped = []
        for v in ask.tolist():
            around = stars.around[stars.start[v] : stars.start[v + 1]] // 3
            runs = _runs(kept[around], _closed(stars, v))
            for run in sorted(runs, key=len)[:-1]:
                dropped.extend(around[run].tolist())
        kept[dropped] = False
        ask = np.unique(triangles[dropped])
    return kept


def _closed(stars: Stars, v: int) -> bool:
    place = int(stars.around[stars.start[v]])
    return bool(stars.mates[3 * (place // 3) + (place % 3 + 2) % 3] >= 0)


def _runs(flags: NDArray[np.bool_], closed: bool) -> list[list[int]]:
    """The places of flags that follow each other; round the end if it is closed."""
    runs: list[list[int]] = []
    for i, flag in enumerate(flags.tolist()):
        if flag and i and flags[i - 1]:
            runs[-1].append(i)
        elif flag:
            runs.append([i])
    if closed and len(runs) > 1 and flags[0] and flags[-1]:
        runs[0] = runs.pop() + runs[0]
    return runs
