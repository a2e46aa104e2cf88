"""Where pieces meet at small angles: the ends of subsegments that concentric shells must be put around."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import turns
from ...connect.planar.complex import PlanarComplex
from .encroachment import FIRST, SECOND

__all__ = ["apexes"]

SMALL = np.pi / 3  # below it, two straight pieces can split each other for ever
# chords turn while curves are split, each by no more than the chord of a half turn / 6
SMALL_CURVED = np.pi / 2


def apexes(complex_: PlanarComplex, curved: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """For each subsegment which of its ends are apexes of a small angle within the domain: a sum of bits.

    Parameters
    ----------
    complex_ : PlanarComplex
        Flooded.
    curved : ndarray of bool, shape (pieces,)

    Returns
    -------
    ndarray of uint8, shape (subsegments,)
        FIRST, SECOND, both or 0.
    """
    s = complex_.segments
    half = complex_.where[:s].astype(np.int64)
    # each leaves one end, with a triangle on its left
    half = np.stack([half, complex_.twin[half]], axis=1).ravel()
    start, stop = (complex_.vertex[half // 3 * 3 + (half + k) % 3] for k in (1, 2))
    number = np.repeat(np.arange(s), 2)
    vector = complex_.xy[stop] - complex_.xy[start]
    angle = turns(vector[:, 1], vector[:, 0])
    order = np.lexsort((angle, start))
    again = _next_around(start[order])
    wedge = np.mod(angle[order][again] - angle[order], 2 * np.pi)
    one, two = order, order[again]
    bent = curved[complex_.piece[number[one]]] | curved[complex_.piece[number[two]]]
    small = (one != two) & (wedge < np.where(bent, SMALL_CURVED, SMALL) * (1 - 1e-9))
    small &= complex_.region[half[one] // 3] >= 0
    small &= complex_.piece[number[one]] != complex_.piece[number[two]]
    result = np.zeros(s, dtype=np.uint8)
    for rows in (one[small], two[small]):
        first = complex_.ends[number[rows], 0] == start[rows]
        np.bitwise_or.at(result, number[rows], np.where(first, FIRST, SECOND).astype(np.uint8))
    return result


def _next_around(start: NDArray) -> NDArray[np.int64]:
    """For rows sorted by vertex: the next row at the same vertex, cyclically."""
    n = len(start)
    again = np.arange(1, n + 1)
    head = np.flatnonzero(np.diff(start, prepend=-1))
    last = np.append(head[1:], n) - 1
    again[last] = head
    return again
