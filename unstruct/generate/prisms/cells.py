"""The cells of columns: wedges, and the pyramids and tetrahedra that are left of them where rays end."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from .stars import Stars

__all__ = ["Cells", "cells_of", "in_one_fan"]

Numbers = NDArray[np.int32]


class Cells(NamedTuple):
    """Cells by kind, and for all of them in the order of the kinds their column and layer (from 0)."""

    kinds: dict[str, Numbers]
    column: NDArray[np.int64]
    layer: Numbers


@kernel
def _count(columns, number, many):
    """Count wedges, pyramids, tetrahedra, and what is nothing at all."""
    for step in range(len(number) - 1):
        low, high = number[step], number[step + 1]
        for i in range(len(columns)):
            a, b, c = columns[i, 0], columns[i, 1], columns[i, 2]
            many[int(low[a] == high[a]) + int(low[b] == high[b]) + int(low[c] == high[c])] += 1


@kernel
def _fill(columns, number, wedges, pyramids, tetrahedra, column, layer):
    """Write the cells, in VTK's order, layer by layer.

    What is left of a wedge (a, b, c, a', b', c') with a = a' is the pyramid (b, b', c', c; a), and with
    a = a' and b = b' the tetrahedron (a, b, c, c').
    """
    first, second = len(wedges), len(wedges) + len(pyramids)
    i_wedge = i_pyramid = i_tetra = 0
    for step in range(len(number) - 1):
        low, high = number[step], number[step + 1]
        for i in range(len(columns)):
            a, b, c = columns[i, 0], columns[i, 1], columns[i, 2]
            at_a, at_b, at_c = low[a] == high[a], low[b] == high[b], low[c] == high[c]
            still = int(at_a) + int(at_b) + int(at_c)
            if still == 0:
                w = wedges[i_wedge]
                w[0], w[1], w[2], w[3], w[4], w[5] = low[a], low[b], low[c], high[a], high[b], high[c]
                column[i_wedge], layer[i_wedge] = i, step
                i_wedge += 1
            elif still == 1:
                if at_b:
                    a, b, c = b, c, a
                elif at_c:
                    a, b, c = c, a, b
                p = pyramids[i_pyramid]
                p[0], p[1], p[2], p[3], p[4] = low[b], high[b], high[c], low[c], low[a]
                column[first + i_pyramid], layer[first + i_pyramid] = i, step
                i_pyramid += 1
            elif still == 2:
                if not at_a:
                    a, b, c = b, c, a
                elif not at_b:
                    a, b, c = c, a, b
                q = tetrahedra[i_tetra]
                q[0], q[1], q[2], q[3] = low[a], low[b], low[c], high[c]
                column[second + i_tetra], layer[second + i_tetra] = i, step
                i_tetra += 1


def cells_of(columns: Numbers, number: Numbers) -> Cells:
    """The cells between the levels of rays.

    Parameters
    ----------
    columns : (c, 3) int32
    number : (levels + 1, r) int32
        The vertex of each ray on each level: the same on several levels where it stays.
    """
    many = np.zeros(4, dtype=np.int64)
    _count(columns, number, many)
    wedges, pyramids, tetrahedra = (np.empty((many[k], 6 - k), dtype=np.int32) for k in range(3))
    column, layer = np.empty(many[:3].sum(), dtype=np.int64), np.empty(many[:3].sum(), dtype=np.int32)
    _fill(columns, number, wedges, pyramids, tetrahedra, column, layer)
    blocks = {"wedge": wedges, "pyramid": pyramids, "tetra": tetrahedra}
    return Cells({name: rows for name, rows in blocks.items() if len(rows)}, column, layer)


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
