"""The exact insertion of segments into a planar complex; each becomes one edge or several."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE
from ...base.errors import InputError
from ...base.jit import kernel
from ...base.progress import progress_bar
from ...geometry.ordering import draws, radix_argsort
from .complex import SEGMENTS, PlanarComplex
from .filling import Filling
from .segments import CROSSES, LEAVES, LOST, carriers, fill_corners, insert_segments, mark_present

__all__ = ["insert_all", "ordered"]


PATIENCE = 32  # circle tests per corner of a polygon beside a segment, before its ears are cut instead
SEGMENTS_A_CALL = 20_000  # segments per kernel call: a fraction of a second, so that Ctrl-C takes effect


def insert_all(
    complex_: PlanarComplex,
    ends: NDArray[np.int32],
    piece: NDArray[np.int32],
    span: NDArray[np.float64],
    *,
    facets: int,
    progress: bool = False,
) -> NDArray[np.int64]:
    """Insert subsegments into a complex that has none, exactly: each becomes one edge or several.

    Parameters
    ----------
    complex_ : PlanarComplex
    ends : ndarray of int32, shape (s, 2)
    piece : ndarray of int32, shape (s,)
    span : ndarray, shape (s, 2)
    facets : int
        How many pieces are facets; messages call the others inner segments (if -1, all are called edges).
    progress : bool
        Show a progress bar.

    Returns
    -------
    ndarray of int64, shape (s,)
        How many triangles each of them crossed when it was inserted: 0 for those that were edges already.

    Raises
    ------
    InputError
        For segments that cross or overlap; both are named. The complex is then no longer valid.
    """
    count, n = complex_.triangles, complex_.size
    ends = ends.copy()  # kernels are compiled once more for read-only arrays, as those of a `Domain` are
    corner = np.empty(n, dtype=np.int32)
    fill_corners(complex_.vertex, 3 * count, corner)
    missing = np.empty(len(ends), dtype=bool)
    where = np.empty(len(ends), dtype=np.int32)
    status, i, other = mark_present(
        complex_.vertex, complex_.twin, complex_.mark, corner, ends, where, missing
    )
    if status != DONE:
        raise _refusal(status, int(i), int(other), ends, piece, facets)
    crossed = np.zeros(len(ends), dtype=np.int64)
    if i == 0 and not progress:  # no segment is missing
        _enter(complex_, ends, piece, span, where, known=True)
        return crossed
    order = ordered(missing, i, ends, corner, draws(i, 2**32), int(count).bit_length() + 2)
    left, right = np.empty(count + 2, dtype=np.int64), np.empty(count + 2, dtype=np.int64)
    cells, pending = np.empty(count + 2, dtype=np.int64), np.empty(8 * count + 8, dtype=np.int32)
    sides, stack = np.empty((8, count + 3), dtype=np.int64), np.empty((count + 3, 3), dtype=np.int64)
    c = complex_
    filling = Filling(
        c.xy, c.vertex, c.twin, c.mark, corner, where, left, right, cells, sides, stack, pending
    )
    bar = progress_bar(progress, " segments", total=len(ends))
    bar.update(len(ends) - len(order))
    for start in range(0, len(order), SEGMENTS_A_CALL):
        stop = min(start + SEGMENTS_A_CALL, len(order))
        status, i, other = insert_segments(filling, ends, order[start:stop], crossed, PATIENCE)
        if status != DONE:
            raise _refusal(status, int(i), int(other), ends, piece, facets)
        bar.update(stop - start)
    bar.close()
    _enter(complex_, ends, piece, span, where, known=False)
    return crossed


@kernel
def ordered(missing, left, ends, corner, draw, bits):
    """An order in random rounds, each eight times as large as the one before; within a round, by corners.

    If many long segments cross many triangles, an order without rounds can cost a hundred times more.
    ``left`` segments are missing; ``bits`` are enough for the number of a corner.
    """
    rows, keys = np.empty(left, dtype=np.int64), np.empty(left, dtype=np.int64)
    k = 0
    for i in range(missing.shape[0]):
        if missing[i]:
            rows[k] = i
            rounds, share = 15, 3
            while left >> share > 32:
                rounds -= draw[k] < 2 ** (32 - share)
                share += 3
            keys[k] = (rounds << bits) | corner[ends[i, 0]]
            k += 1
    return rows[radix_argsort(keys, bits + 4)]


def _refusal(status: int, i: int, other: int, ends: NDArray, piece: NDArray, facets: int) -> InputError:
    def name(s: int) -> str:
        p = int(piece[s])
        if facets < 0:
            kind = f"edges[{p}]"
        else:
            kind = f"facet {p}" if p < facets else f"inner segment {p - facets}"
        return f"{kind} (vertices {ends[s, 0]} and {ends[s, 1]})"

    if ends[i, 0] == ends[i, 1]:
        return InputError(f"{name(i)} leads nowhere: its ends must be different vertices")
    if status in (LEAVES, LOST):
        return InputError(f"{name(i)} leaves the mesh: take a mesh that covers it")
    verb = "crosses" if status == CROSSES else "overlaps"
    return InputError(
        f"{name(i)} {verb} {name(other)}: segments may meet at vertices only; "
        "a Domain with resolve=True cuts them"
    )


def _enter(
    complex_: PlanarComplex, ends: NDArray, piece: NDArray, span: NDArray, where: NDArray, known: bool
) -> None:
    """Number the subsegments that the segments have become, in their order, and store them.

    With ``known`` each segment is one edge, and ``where`` has its half-edge.
    """
    slots = 3 * complex_.triangles
    if known or carriers(complex_.vertex, complex_.mark, slots, ends, where) == 2 * len(ends):
        complex_.take_subsegments(ends, piece.copy(), span.copy(), where)
        return
    half = np.flatnonzero(complex_.mark[:slots] >= 0)
    vertex, of = complex_.vertex, complex_.mark[half]
    start, stop = vertex[_next(half)], vertex[_prev(half)]
    a, b = complex_.xy[ends[of, 0]], complex_.xy[ends[of, 1]]
    axis = np.abs(b - a).argmax(axis=1)  # vertices on a segment are ordered along its longer coordinate
    rows = np.arange(len(half))
    x, y = complex_.xy[start][rows, axis], complex_.xy[stop][rows, axis]
    low, high = a[rows, axis], b[rows, axis]
    keep = (x < y) == (low < high)
    order = np.lexsort([np.where(low < high, x, -x)[keep], of[keep]])
    pick = np.flatnonzero(keep)[order]
    t = np.clip((np.stack([x, y]) - low) / (high - low), 0.0, 1.0)[:, pick]
    segment = of[pick]
    s0, s1 = span[segment].T
    complex_.ends = np.column_stack([start[pick], stop[pick]]).astype(np.int32)
    complex_.piece, complex_.where = piece[segment], half[pick].astype(np.int32)
    complex_.span = (s0 + t * (s1 - s0)).T.copy()
    where = complex_.where
    complex_.mark[where] = np.arange(len(where), dtype=np.int32)
    complex_.mark[complex_.twin[where]] = np.arange(len(where), dtype=np.int32)
    complex_.state[SEGMENTS] = len(where)


def _next(e: NDArray) -> NDArray:
    return np.where(e % 3 == 2, e - 2, e + 1)


def _prev(e: NDArray) -> NDArray:
    return np.where(e % 3 == 0, e + 2, e - 1)
