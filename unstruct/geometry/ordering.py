"""The order in which points are inserted: Hilbert keys, and BRIO rounds.

An incremental Delaunay construction walks from the last cell to the next point. It is fast if consecutive
points are close, so points are sorted along a Hilbert curve. A purely spatial order has bad worst cases.
A biased randomized insertion order (BRIO) therefore inserts first a small random sample, then a larger one,
then the rest, each of them sorted along the curve.

The curve is a finite automaton in any dimension (Hamilton's formulation). In every state a table gives the
position of each of the ``2**d`` subcells along the curve, and the state in which the curve runs through it.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import fill
from ..base.jit import inline, kernel

__all__ = ["brio", "draws", "hilbert_order"]

MAX_TABLE_DIMENSION = 8  # the table has d * 4**d entries; in higher dimensions 8 coordinates give the key
KEY_BITS = 60  # keys are signed 64-bit integers, which leaves room for the number of the round
DRAWN_ONCE = 1 << 14  # how many random numbers are drawn only once
FEW_KEYS = 64  # up to so many keys are sorted by insertion, without counting
DIGIT = 11  # bits per pass of the radix sort; a histogram of 2048 counters stays in the first-level cache


class Automaton(NamedTuple):
    """A Hilbert curve: how many levels its finest grid has, and the tables of `_tables`."""

    levels: int
    ranks: NDArray[np.int64]
    turns: NDArray[np.int64]


def hilbert_order(points: ArrayLike) -> NDArray[np.int64]:
    """Sort points along a Hilbert curve through their bounding box.

    Parameters
    ----------
    points : array_like, shape (n, d)
        Finite coordinates; all axes have the same scale.

    Returns
    -------
    ndarray of int64, shape (n,)
        A permutation; points in the same cell of the finest grid keep their input order.

    Notes
    -----
    O(n) for a fixed number of key bits (radix sort). Along each axis the grid has about 250 cells per mean
    spacing of the points, unless 60 bits are too few for that. Source: C. Hamilton, *Compact Hilbert
    indices*, Dalhousie University CS-2006-07. Book: section 12.2.2.
    """
    points = _as_table(points)
    rounds = np.zeros(len(points), dtype=np.uint8)
    return _sorted_by_round(points, rounds)


def brio(
    points: ArrayLike, rng: np.random.Generator | int | None = None, *, ratio: int = 8, rounds: int = 3
) -> NDArray[np.int64]:
    """Biased randomized insertion order: random rounds, each sorted along a Hilbert curve.

    Parameters
    ----------
    points : array_like, shape (n, d)
        Finite coordinates.
    rng : numpy Generator, int or None
        Source of the random rounds; None means a fixed seed, so that the same input gives the same order.
    ratio : int
        Each round is about ``ratio`` times as large as all rounds before it.
    rounds : int
        Number of rounds; 1 gives the plain Hilbert order.

    Returns
    -------
    ndarray of int64, shape (n,)
        A permutation of the points.

    Notes
    -----
    O(n). Source: N. Amenta, S. Choi, G. Rote, *Incremental constructions con BRIO*, SoCG 2003.
    Book: section 12.2.2.
    """
    points = _as_table(points)
    below = ratio ** (rounds - 1)
    if rng is None:
        draw = draws(len(points), below)
    else:
        draw = np.random.default_rng(rng).integers(0, below, len(points), dtype=np.uint32)
        draw.flags.writeable = False  # as those of `draws`: for others the kernel would be compiled again
    return _sorted_by_round(points, random_rounds(draw, ratio, rounds))


def draws(n: int, below: int) -> NDArray[np.uint32]:
    """``n`` random numbers from 0, 1, ..., ``below`` - 1, always the same because the seed is fixed."""
    return _first_draws(below, DRAWN_ONCE)[:n] if n <= DRAWN_ONCE else _first_draws.__wrapped__(below, n)


@cache
def _first_draws(below: int, n: int) -> NDArray[np.uint32]:
    """The random numbers for small inputs, drawn once because drawing would take a tenth of their time."""
    first = np.random.default_rng(0).integers(0, below, n, dtype=np.uint32)
    first.flags.writeable = False
    return first


def _as_table(points: ArrayLike) -> NDArray[np.float64]:
    table = np.ascontiguousarray(points, dtype=np.float64)
    if table.ndim != 2:
        raise ValueError(f"points must have shape (n, d), not {table.shape}")
    return table


def _sorted_by_round(points: NDArray[np.float64], rounds: NDArray[np.uint8]) -> NDArray[np.int64]:
    n, d = points.shape
    if n < 2 or d == 0:
        return np.arange(n, dtype=np.int64)
    d = min(d, MAX_TABLE_DIMENSION)
    return along_curve(points, d, rounds, *curve(n, d))


def curve(n: int, d: int) -> tuple[int, NDArray[np.int64], NDArray[np.int64]]:
    """For n >= 2 points in d dimensions the levels of their grid, and the automaton: see `along_curve`."""
    levels = min(KEY_BITS // d, -(-(n - 1).bit_length() // d) + 8, 30)
    levels += levels % 2 if d == 2 else 0  # in the plane, two levels are read at a time
    return levels, *_tables(d)


@cache
def _tables(d: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The automaton: the rank of each subcell within its cell, and the state in it (times ``2**d``).

    A state is (e, a): the corner e where the curve enters a cell, and the axis a along which it leaves.
    """
    size, mask = 1 << d, (1 << d) - 1

    def left(b: int, k: int) -> int:
        k %= d
        return ((b << k) | (b >> (d - k))) & mask

    gray = [i ^ (i >> 1) for i in range(size)]
    rank_of = {g: i for i, g in enumerate(gray)}
    entry = [0] + [gray[2 * ((w - 1) // 2)] for w in range(1, size)]
    trailing = [((~i & (i + 1)).bit_length() - 1) for i in range(size)]  # number of trailing ones
    axis = [0] + [trailing[w if w % 2 else w - 1] % d for w in range(1, size)]
    ranks = np.empty((d * size, size), dtype=np.int64)
    turns = np.empty((d * size, size), dtype=np.int64)
    for e in range(size):
        for a in range(d):
            for cell in range(size):
                w = rank_of[left(cell ^ e, d - (a + 1) % d)]
                to_e = e ^ left(entry[w], a + 1)
                to_a = (a + axis[w] + 1) % d
                ranks[e * d + a, cell] = w
                turns[e * d + a, cell] = (to_e * d + to_a) << d
    if d == 2:
        return _two_levels(ranks, turns >> d)
    return ranks.ravel(), turns.ravel()


def _two_levels(ranks: NDArray[np.int64], turns: NDArray[np.int64]) -> tuple[NDArray, NDArray]:
    """The automaton of the plane that reads two bits of x and of y; the index has bits x0, x1, y0, y1."""
    bits = np.arange(16)
    high, low = ((bits >> 1) & 1) + 2 * (bits >> 3), (bits & 1) + 2 * ((bits >> 2) & 1)
    state = np.arange(len(ranks))[:, None]
    middle = turns[state, high]
    return (4 * ranks[state, high] + ranks[middle, low]).ravel(), (turns[middle, low] << 4).ravel()


@inline
def _cell(x, low, shrink, factor):
    return np.int64((x * 0.5 - low) * shrink * factor)


@kernel
def half_extent(points, d, low):
    """Half the largest side of the box of the first d coordinates; half its lowest corner goes to ``low``."""
    extent = 0.0
    for k in range(d):
        least = most = points[0, k]
        for i in range(points.shape[0]):
            least, most = min(least, points[i, k]), max(most, points[i, k])
        low[k] = least * 0.5
        extent = max(extent, most * 0.5 - low[k])
    return extent


@kernel
def random_rounds(draw, ratio, rounds):
    """The round of each point, by a random number below ``ratio ** (rounds - 1)``."""
    number = np.empty(draw.shape[0], dtype=np.uint8)
    for i in range(draw.shape[0]):
        early, below = 0, 1
        while early < rounds - 1 and draw[i] >= below:
            early += 1
            below *= ratio
        number[i] = early
    return number


@kernel
def along_curve(points, d, rounds, levels, ranks, turns):
    """The order of points round by round, each along the curve through the box of all of them.

    Rounding does no harm here, because the keys influence only the speed. Halving keeps the extent finite.
    """
    low = np.empty(d)
    extent = half_extent(points, d, low)
    shrink = 2.0**600 if 0.0 < extent < 1e-280 else 1.0  # the factor must not overflow
    factor = 0.0 if extent == 0.0 else (2.0**levels - 1e-3) / (extent * shrink)
    keys = np.empty(points.shape[0], dtype=np.int64)
    hilbert_keys(points, low, shrink, factor, Automaton(levels, ranks, turns), rounds, keys)
    bits, most = d * levels, 0
    for i in range(rounds.shape[0]):
        most = max(most, rounds[i])
    while most > 0:
        bits, most = bits + 1, most >> 1
    return radix_argsort(keys, bits)


@kernel
def hilbert_keys(points, low, shrink, factor, automaton, rounds, keys):
    """Write the key of every point: the number of its round, followed by its place on the curve."""
    levels, ranks, turns = automaton
    d = low.shape[0]
    cell = np.empty(d, dtype=np.int64)
    for i in range(points.shape[0]):
        state = 0
        key = np.int64(rounds[i])
        if d == 2:
            x = _cell(points[i, 0], low[0], shrink, factor)
            y = _cell(points[i, 1], low[1], shrink, factor)
            for level in range(levels - 2, -1, -2):
                at = state + ((x >> level) & 3) + 4 * ((y >> level) & 3)
                key = (key << 4) | ranks[at]
                state = turns[at]
        else:
            for k in range(d):
                cell[k] = _cell(points[i, k], low[k], shrink, factor)
            for level in range(levels - 1, -1, -1):
                at = state
                for k in range(d):
                    at += ((cell[k] >> level) & 1) << k
                key = (key << d) | ranks[at]
                state = turns[at]
        keys[i] = key


@kernel
def radix_argsort(keys, bits):
    """Stable order of non-negative keys below ``2**bits``, by one counting pass per digit, lowest first.

    The array ``keys`` is overwritten.
    """
    n = keys.shape[0]
    order = np.empty(n, dtype=np.int64)
    for i in range(n):
        order[i] = i
    if n <= FEW_KEYS:  # by insertion
        for i in range(1, n):
            key, j = keys[i], i
            while j > 0 and keys[j - 1] > key:
                keys[j], order[j] = keys[j - 1], order[j - 1]
                j -= 1
            keys[j], order[j] = key, i
        return order
    spare_keys, spare_order = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    size = 1 << DIGIT
    start = np.empty(size + 1, dtype=np.int64)
    for shift in range(0, bits, DIGIT):
        fill(start, 0)
        for i in range(n):
            start[((keys[i] >> shift) & (size - 1)) + 1] += 1
        for j in range(size):
            start[j + 1] += start[j]
        for i in range(n):
            digit = (keys[i] >> shift) & (size - 1)
            spare_keys[start[digit]] = keys[i]
            spare_order[start[digit]] = order[i]
            start[digit] += 1
        keys, spare_keys = spare_keys, keys
        order, spare_order = spare_order, order
    return order
