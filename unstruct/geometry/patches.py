"""Do bilinear patches of space meet in more than what they share? A proof by planes, part by part.

A patch is the image of the unit square under x(u, v) = (1-u)(1-v) a + u (1-v) b + u v c + (1-u) v d; for
c = d it is a triangle. It lies in the hull of its corners, and so do its parts, which are patches again. Two
parts are *apart* if a plane has all corners of both on different sides, but for those that they share, which
lie in it:

* no corner in common: then the parts do not meet,
* one: they meet there alone,
* both ends of a part of a common edge: they meet there alone, as x lies on the line through two corners that
  follow each other only on their edge (its other two weights are products that vanish there alone),
* three, that is parts of two common edges: the fourth corners lie on different sides of the plane of the
  three. Both parts meet this triangle in those two edges alone, by the same weights.

If that is not seen, both parts are divided into four, in the middles of their sides, so that parts of a
common edge remain the same for both. Where two patches cross, or touch, that never ends, and they are given
up after some levels. Planes are found in doubles, and tested with a bound on all rounding errors: that two
patches are apart is certain.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["patches_apart"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

PATCH_LEVELS = 16  # halvings in each direction
MOST_PARTS = 1 << 11  # pairs of parts of two patches at one level
MOST_AT_ONCE = 1 << 15  # pairs of parts of all patches
ROWS_AT_ONCE = 1 << 8  # pairs of parts whose planes are looked for together
NEARLY_PARALLEL = 1e-12  # planes are only guessed with this; they are tested afterwards
PLANE_ERROR = 2.0**-45  # of coordinates: far above the rounding of differences of points of patches
CORNER_PLACES = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
QUARTERS = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(16, 4)


class _Parts(NamedTuple):
    """Pairs of parts: the pair of patches, and the places of both parts in units of their side."""

    pair: Integers
    one: Integers
    other: Integers


def patches_apart(points: Array, one: Integers, other: Integers) -> NDArray[np.bool_]:
    """For pairs of patches, whether they surely meet in their common corners and edges alone.

    Parameters
    ----------
    points : (n, 3) float64
    one, other : (m, 4) int
        Corners in order; triangles have their last corner twice. No two rows have the same corners.

    Returns
    -------
    (m,) bool
        False where they meet elsewhere, and where they are so near that `PATCH_LEVELS` do not tell.
    """
    found = np.ones(len(one), dtype=bool)
    parts = _Parts(np.arange(len(one)), np.zeros((len(one), 2), np.int64), np.zeros((len(one), 2), np.int64))
    for level in range(PATCH_LEVELS + 1):
        left = ~_seen_apart(points, one, other, parts, level)
        parts = _Parts(*(array[left] for array in parts))
        if not len(parts.pair):
            return found
        many = np.bincount(parts.pair, minlength=len(one))
        each = MOST_AT_ONCE // int((many > 0).sum())  # where most pairs cross, none takes long
        found &= many * len(QUARTERS) <= max(min(MOST_PARTS, each), 4 * len(QUARTERS))
        going = found[parts.pair]
        pair, a, b = (np.repeat(array[going], len(QUARTERS), axis=0) for array in parts)
        step = np.tile(QUARTERS, (int(going.sum()), 1))
        parts = _Parts(pair, 2 * a + step[:, :2], 2 * b + step[:, 2:])
    found[parts.pair] = False
    return found


def _corners(points: Array, rows: Integers, place: Integers, level: int) -> tuple[Array, Integers]:
    """The corners of parts of patches (m, 4, 3), and what they are (m, 4, 3).

    That is, for a point of an edge, both ends of this edge, the lower one first, and the place from there on;
    for a corner of the patch it twice, and 0; for other points three times -1.
    """
    side = 1 << level
    at = place[:, None] + CORNER_PLACES
    u, v = (at[..., k, None] / side for k in range(2))
    a, b, c, d = (points[rows[:, k]][:, None] for k in range(4))
    x = (1 - u) * ((1 - v) * a + v * d) + u * ((1 - v) * b + v * c)
    what = np.full((*at.shape[:2], 3), -1, dtype=np.int64)
    i, j = at[..., 0], at[..., 1]
    for k, (on, along) in enumerate(((j == 0, i), (i == side, j), (j == side, side - i), (i == 0, side - j))):
        first, last = rows[:, k, None], rows[:, (k + 1) % 4, None]
        t = np.where(first <= last, along, side - along)
        low, high = np.minimum(first, last), np.maximum(first, last)
        single = (t == 0) | (t == side) | (low == high)
        end = np.where(t == side, high, low)
        for column, value in enumerate((np.where(single, end, low), np.where(single, end, high), t)):
            what[..., column][on] = np.broadcast_to(value, on.shape)[on]
        what[..., 2][on & np.broadcast_to(single, on.shape)] = 0
    return x, what


def _seen_apart(
    points: Array, one: Integers, other: Integers, parts: _Parts, level: int
) -> NDArray[np.bool_]:
    """Whether parts are apart."""
    p, of_p = _corners(points, one[parts.pair], parts.one, level)
    q, of_q = _corners(points, other[parts.pair], parts.other, level)
    same = ((of_p[:, :, None] == of_q[:, None]).all(axis=3)) & (of_p[:, :, None, 0] >= 0)
    mine, yours = same.any(axis=2), same.any(axis=1)
    many = _distinct(of_p, mine)
    apart = np.zeros(len(p), dtype=bool)
    for count in range(4):
        rows = np.flatnonzero(many == count)
        if count >= 2:  # they must be joined by common parts of edges
            rows = rows[_chained(mine[rows], of_p[rows]) & _chained(yours[rows], of_q[rows])]
        if len(rows):
            apart[rows] = _separated(p[rows], q[rows], mine[rows], yours[rows], count)
    return apart


def _distinct(what: Integers, some: NDArray[np.bool_]) -> Integers:
    """How many different corners are among some of them: a triangle has one twice."""
    count = np.zeros(len(what), dtype=np.int64)
    for k in range(4):
        known = np.zeros(len(what), dtype=bool)
        for i in range(k):
            known |= some[:, i] & (what[:, i] == what[:, k]).all(axis=1)
        count += some[:, k] & ~known
    return count


def _chained(some: NDArray[np.bool_], what: Integers) -> NDArray[np.bool_]:
    """Whether corners of parts that are common follow each other around the part, along its edges."""
    joined = np.zeros(len(some), dtype=np.int64)
    for k in range(4):
        j = (k + 1) % 4
        joined += some[:, k] & some[:, j] & (what[:, k] != what[:, j]).any(axis=1)
    return joined >= _distinct(what, some) - 1


def _separated(
    p: Array, q: Array, mine: NDArray[np.bool_], yours: NDArray[np.bool_], count: int
) -> NDArray[np.bool_]:
    """Whether a plane through the common corners surely has the others of p and of q on different sides."""
    size, row = np.abs(np.concatenate([p, q], axis=1)).max(axis=(1, 2)), np.arange(len(p))
    if count == 0:
        gap = np.maximum(p.min(axis=1) - q.max(axis=1), q.min(axis=1) - p.max(axis=1)).max(axis=1)
        apart = gap > PLANE_ERROR * size  # boxes tell most of them
        rows = np.flatnonzero(~apart)
        away = (p[rows, :, None] - q[rows, None]).reshape(len(rows), 16, 3)
        used = np.ones(away.shape[:2], dtype=bool)
        apart[rows] = _positive(_turned(away, used), away, used, PLANE_ERROR * size[rows])
        return apart
    origin = p[row, mine.argmax(axis=1)][:, None]
    away, used = np.concatenate([p - origin, origin - q], axis=1), ~np.concatenate([mine, yours], axis=1)
    if count == 1:
        return _positive(_turned(away, used), away, used, PLANE_ERROR * size)
    far = np.where(mine, np.abs(p - origin).max(axis=2), -1.0).argmax(axis=1)
    edge = p[row, far] - origin[:, 0]
    square = (edge * edge).sum(axis=1)
    long = square > 0.0
    width = np.sqrt(np.where(long, square, 1.0))
    unit = edge / width[:, None]
    most = np.abs(away).max(axis=(1, 2))
    if count == 2:
        normal = _turned(away - (away * unit[:, None]).sum(axis=2)[..., None] * unit[:, None], used, unit)
        normal -= (normal * unit).sum(axis=1)[:, None] * unit
        # The plane that contains the edge is turned from this one by what rounding has left.
        slack = 8.0 * PLANE_ERROR * size * (1.0 + most / width)
        return long & _positive(normal, away, used, slack)
    cross = np.where(mine, np.abs(np.cross(p - origin, edge[:, None])).max(axis=2), -1.0)
    third = p[row, cross.argmax(axis=1)] - origin[:, 0]
    normal = np.cross(unit, third)
    along = np.where(used, (away * normal[:, None]).sum(axis=2), 0.0)
    normal *= np.where(along.sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
    length = np.abs(normal).sum(axis=1)
    slack = 8.0 * PLANE_ERROR * size * (2.0 + (most + np.abs(third).max(axis=1)) / width)
    return long & _positive(normal, away, used, slack * (1.0 + most / np.where(length > 0.0, length, 1.0)))


def _turned(vectors: Array, used: NDArray[np.bool_], axis: Array | None = None) -> Array:
    """Vectors with whose products those used of a row (m, k, 3) are positive, if there are such: (m, 3).

    All such vectors form a cone. Each of its edges is orthogonal to two of those that are given; in a plane,
    whose ``axis`` is given, to one. The sum of its edges lies inside. Zero where there is none.
    """
    found = np.zeros((len(vectors), 3))
    length = np.sqrt((vectors * vectors).sum(axis=2))
    units = vectors / np.where(length > 0.0, length, 1.0)[..., None]
    first, second = np.triu_indices(units.shape[1], 1)
    for i in range(0, len(units), ROWS_AT_ONCE):
        part, mask = units[i : i + ROWS_AT_ONCE], used[i : i + ROWS_AT_ONCE]
        if axis is None:
            edges, here = np.cross(part[:, first], part[:, second]), mask[:, first] & mask[:, second]
        else:
            edges, here = np.cross(axis[i : i + ROWS_AT_ONCE, None], part), mask
        long = np.sqrt((edges * edges).sum(axis=2))
        edges = edges / np.where(long > 0.0, long, 1.0)[..., None]
        along = (edges[:, :, None] * part[:, None]).sum(axis=3)
        here = here & (long > NEARLY_PARALLEL)
        for sign in (1.0, -1.0):
            least = np.where(mask[:, None], sign * along, np.inf).min(axis=2)
            good = here & (least >= -NEARLY_PARALLEL)
            found[i : i + ROWS_AT_ONCE] += sign * np.where(good[..., None], edges, 0.0).sum(axis=1)
    return found


def _positive(normal: Array, vectors: Array, used: NDArray[np.bool_], slack: Array) -> NDArray[np.bool_]:
    """Whether products with all used vectors of a row are surely positive."""
    along = np.where(used, (vectors * normal[:, None]).sum(axis=2), np.inf).min(axis=1)
    return along > slack * np.abs(normal).sum(axis=1)
