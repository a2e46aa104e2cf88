"""Rows of small integers, sorted row by row and grouped by one hash table, without sorting all rows."""

from __future__ import annotations

import numpy as np

from ..base.jit import kernel

__all__ = ["group_rows"]


@kernel
def sort_rows(rows):
    """Sort each (short) row in place, by insertion."""
    for r in range(rows.shape[0]):
        for i in range(1, rows.shape[1]):
            value = rows[r, i]
            j = i - 1
            while j >= 0 and rows[r, j] > value:
                rows[r, j + 1] = rows[r, j]
                j -= 1
            rows[r, j + 1] = value


@kernel
def _group(rows, heads, following, group, first):
    """Number the distinct rows in order of appearance: group[r], and first[g], where g appears.

    A hash table with chaining: ``heads`` (its length a power of two) has the latest group of each
    bucket, ``following`` the one before each group. Horner's rule modulo 2^31 - 1 keeps every product below
    2^52, so that nothing wraps around, compiled or as plain Python. Returns the number of groups.
    """
    count = 0
    mask = heads.shape[0] - 1
    width = rows.shape[1]
    for r in range(rows.shape[0]):
        h = 0
        for i in range(width):
            h = (h * 1000003 + np.int64(rows[r, i])) % 2147483647
        bucket = h & mask
        g = heads[bucket]
        while g >= 0:
            s = first[g]
            same = True
            for i in range(width):
                if rows[s, i] != rows[r, i]:
                    same = False
                    break
            if same:
                break
            g = following[g]
        if g < 0:
            g = count
            first[g] = r
            following[g] = heads[bucket]
            heads[bucket] = g
            count += 1
        group[r] = g
    return count


def group_rows(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Number the distinct rows of an integer array in order of appearance.

    Returns
    -------
    group : ndarray of int64, shape (r,)
    first : ndarray of int64, shape (groups,)
        A row of each group: the first one.
    """
    rows = np.ascontiguousarray(rows)
    buckets = 1 << max(4, (len(rows) - 1).bit_length())
    heads = np.full(buckets, -1, dtype=np.int64)
    following, group, first = (np.empty(len(rows), dtype=np.int64) for _ in range(3))
    count = _group(rows, heads, following, group, first)
    return group, first[:count].copy()
