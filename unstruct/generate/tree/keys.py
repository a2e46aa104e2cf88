"""Morton keys: the coordinates of a cell of a tree as one number, in the order of the depth-first walk.

The cell of level l with integer coordinates (i, j), 0 <= i, j < 2**l, has the key that interleaves their
bits, those of i in the places 0, 2, 4, ...; in space the bits of i, j, k in the places 0, 3, ..., 1, 4, ...
and 2, 5, .... Child c of a cell with key k has the key ``k << d | c``, and bit a of c tells on which side of
the cell's center it lies along axis a. See the book, chapter 4a.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel

__all__ = ["DEEPEST", "compacted", "coordinates_of", "interleaved", "keys_of", "spread"]

Keys = NDArray[np.uint64]

# The deepest level, by dimension: keys, and a bit beyond them, fit into 64 bits.
DEEPEST = {2: 30, 3: 20}


@inline
def spread(x, d):
    """The bits of x, d places apart."""
    x = np.uint64(x)
    if d == 2:
        x = (x | (x << np.uint64(16))) & np.uint64(0x0000FFFF0000FFFF)
        x = (x | (x << np.uint64(8))) & np.uint64(0x00FF00FF00FF00FF)
        x = (x | (x << np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
        x = (x | (x << np.uint64(2))) & np.uint64(0x3333333333333333)
        return (x | (x << np.uint64(1))) & np.uint64(0x5555555555555555)
    x = (x | (x << np.uint64(32))) & np.uint64(0x001F00000000FFFF)
    x = (x | (x << np.uint64(16))) & np.uint64(0x001F0000FF0000FF)
    x = (x | (x << np.uint64(8))) & np.uint64(0x100F00F00F00F00F)
    x = (x | (x << np.uint64(4))) & np.uint64(0x10C30C30C30C30C3)
    return (x | (x << np.uint64(2))) & np.uint64(0x1249249249249249)


@inline
def compacted(x, d):
    """Every d-th bit of x, beginning with the lowest: `spread` backward."""
    if d == 2:
        x = x & np.uint64(0x5555555555555555)
        x = (x | (x >> np.uint64(1))) & np.uint64(0x3333333333333333)
        x = (x | (x >> np.uint64(2))) & np.uint64(0x0F0F0F0F0F0F0F0F)
        x = (x | (x >> np.uint64(4))) & np.uint64(0x00FF00FF00FF00FF)
        x = (x | (x >> np.uint64(8))) & np.uint64(0x0000FFFF0000FFFF)
        return (x | (x >> np.uint64(16))) & np.uint64(0x00000000FFFFFFFF)
    x = x & np.uint64(0x1249249249249249)
    x = (x | (x >> np.uint64(2))) & np.uint64(0x10C30C30C30C30C3)
    x = (x | (x >> np.uint64(4))) & np.uint64(0x100F00F00F00F00F)
    x = (x | (x >> np.uint64(8))) & np.uint64(0x001F0000FF0000FF)
    x = (x | (x >> np.uint64(16))) & np.uint64(0x001F00000000FFFF)
    return (x | (x >> np.uint64(32))) & np.uint64(0x00000000001FFFFF)


@inline
def interleaved(x, y, z, d):
    """The key of a cell with these coordinates; z is not used in the plane."""
    key = spread(x, d) | (spread(y, d) << np.uint64(1))
    if d == 3:
        key |= spread(z, d) << np.uint64(2)
    return key


@kernel
def _interleave(coordinates, keys):
    d = coordinates.shape[1]
    for i in range(len(keys)):
        z = coordinates[i, 2] if d == 3 else np.int64(0)
        keys[i] = interleaved(coordinates[i, 0], coordinates[i, 1], z, d)


@kernel
def _compact(keys, coordinates):
    d = coordinates.shape[1]
    for i in range(len(keys)):
        for a in range(d):
            coordinates[i, a] = np.int64(compacted(keys[i] >> np.uint64(a), d))


def keys_of(coordinates: NDArray[np.int64]) -> Keys:
    """The keys of cells with integer coordinates (n, d) on their own levels."""
    keys = np.empty(len(coordinates), dtype=np.uint64)
    _interleave(np.ascontiguousarray(coordinates, dtype=np.int64), keys)
    return keys


def coordinates_of(keys: Keys, dimension: int) -> NDArray[np.int64]:
    """The integer coordinates (n, d) of cells on their own levels."""
    coordinates = np.empty((len(keys), dimension), dtype=np.int64)
    _compact(keys, coordinates)
    return coordinates
