"""A size field in space as kernels read it: an octree over a box, with eight corner values in each leaf.

Between the corners of a leaf the size is trilinear, so it never leaves the range of the values that the
field itself gave. As in the plane (`sizing.table`) it may jump between leaves, by no more than their errors.
See the book, 2.3 and 2.8c.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..base.jit import inline, kernel

__all__ = ["SpaceNodes", "octree_leaf", "size_in_space", "space_nodes"]

Array = NDArray[np.float64]
ALWAYS_DIVIDED = 4  # levels that are always made: 16 x 16 x 16 leaves, with 15 further samples each
MOST_OCTREE_LEVELS = 20
MOST_OCTREE_NODES = 1_000_000
KEY_OF_PLACE = np.array([1 << 2 * MOST_OCTREE_LEVELS, 1 << MOST_OCTREE_LEVELS, 1])
ALLOWED_ERROR = 0.05  # relative, of the interpolant of a leaf that is divided no more
FINE_LEAF = 0.5  # a leaf no larger than this many wanted edge lengths is small enough
CUBE_CORNERS = np.array(list(product((0, 1), repeat=3)))[:, ::-1]  # x changes first
IN_HALVES = np.array(list(product((0, 1, 2), repeat=3)))[
    :, ::-1
]  # of corners, middles and center, in half sides
IS_CORNER = (IN_HALVES % 2 == 0).all(axis=1)
EIGHTH_CENTERS = CUBE_CORNERS * 0.5 + 0.25  # of the children


class SpaceNodes(NamedTuple):
    """The first child of each node (its eight children follow each other; -1 for a leaf), values, the box."""

    child: NDArray[np.int32]
    values: Array
    box: Array


@inline
def octree_leaf(child, box, x, y, z):
    """The leaf at a place in scaled coordinates, and where it is in the leaf; from outside the nearest."""
    u = min(max((x - box[0]) / (box[3] - box[0]), 0.0), 1.0)
    v = min(max((y - box[1]) / (box[4] - box[1]), 0.0), 1.0)
    w = min(max((z - box[2]) / (box[5] - box[2]), 0.0), 1.0)
    node = np.int64(0)
    while child[node] >= 0:
        node = np.int64(child[node])
        u *= 2.0
        v *= 2.0
        w *= 2.0
        if u >= 1.0:
            u -= 1.0
            node += 1
        if v >= 1.0:
            v -= 1.0
            node += 2
        if w >= 1.0:
            w -= 1.0
            node += 4
    return node, u, v, w


@inline
def size_in_space(child, values, box, x, y, z):
    """The size at (x, y, z), in scaled coordinates; outside the box, that at its nearest point."""
    node, u, v, w = octree_leaf(child, box, x, y, z)
    s0 = values[node, 0] + u * (values[node, 1] - values[node, 0])
    s1 = values[node, 2] + u * (values[node, 3] - values[node, 2])
    s2 = values[node, 4] + u * (values[node, 5] - values[node, 4])
    s3 = values[node, 6] + u * (values[node, 7] - values[node, 6])
    low, high = s0 + v * (s1 - s0), s2 + v * (s3 - s2)
    return low + w * (high - low)


@kernel
def sizes_in_space(child, values, box, x, result):
    """`size_in_space` for the rows of x."""
    for i in range(x.shape[0]):
        result[i] = size_in_space(child, values, box, x[i, 0], x[i, 1], x[i, 2])


def _trilinear(corners: Array, at: Array) -> Array:
    """The interpolant of corner values (..., 8) at places (..., 3) in the unit cube."""
    u, v, w = at[..., 0], at[..., 1], at[..., 2]
    edge = [corners[..., k] + u * (corners[..., k + 1] - corners[..., k]) for k in (0, 2, 4, 6)]
    low, high = edge[0] + v * (edge[1] - edge[0]), edge[2] + v * (edge[3] - edge[2])
    return low + w * (high - low)


def space_nodes(field: Callable[[Array], Array], box: Array, factor: float, landmarks: Array) -> SpaceNodes:
    """The table of a field over a box.

    Parameters
    ----------
    field : callable
        Takes points (k, 3), returns k lengths.
    box : (2, 3) ndarray
        Opposite corners, in the coordinates of the field.
    factor : float
        Coordinates and sizes of the table are multiplied by it.
    landmarks : (j, 3) ndarray
        Places where the field has details that sampling would miss.

    Returns
    -------
    SpaceNodes

    Notes
    -----
    Level by level, with one call of the field for each. A leaf is divided while its error at 27 places, at
    the centers of its eighths, or at a landmark is more than 5 %, and while it is larger than half a wanted
    length. O(n) for n nodes.
    """
    low, side = box[0], box[1] - box[0]

    def at(x: Array) -> Array:
        return np.minimum(x, box[1])

    places, node = np.zeros((1, 3), dtype=np.int64), np.zeros(1, dtype=np.int64)
    child, blocks = np.array([-1], dtype=np.int64), []
    marked = field(landmarks) if len(landmarks) else np.empty(0)
    for level in range(MOST_OCTREE_LEVELS + 1):
        h = side * 0.5**level
        corner = low + h * places[:, None]
        grid = _sampled(field, at(corner + 0.5 * h * IN_HALVES))
        probes = field(at(corner + h * EIGHTH_CENTERS).reshape(-1, 3)).reshape(-1, 8)
        values = grid[:, IS_CORNER]
        guess = _trilinear(values[:, None], np.concatenate([IN_HALVES / 2.0, EIGHTH_CENTERS]))
        seen = np.concatenate([grid, probes], axis=1)
        error, least = (np.abs(guess - seen) / seen).max(axis=1), seen.min(axis=1)
        _see_landmarks(places, (landmarks - low) / h, marked, (values, error, least))
        blocks.append(values)
        split = (error > ALLOWED_ERROR) & (h.max() > FINE_LEAF * least) | (level < ALWAYS_DIVIDED)
        if level == MOST_OCTREE_LEVELS or len(child) + 8 * split.sum() > MOST_OCTREE_NODES:
            break
        if not split.any():
            break
        child[node[split]] = len(child) + 8 * np.arange(split.sum())
        places = (2 * places[split][:, None] + CUBE_CORNERS).reshape(-1, 3)
        node = len(child) + np.arange(len(places))
        child = np.append(child, np.full(len(places), -1))
    scaled = np.concatenate(blocks) * factor
    tiny = np.finfo(np.float64).tiny
    if not (np.isfinite(scaled).all() and scaled.min() > tiny):
        raise InputError(f"sizes leave the range of doubles when they are multiplied by {factor:g}")
    return SpaceNodes(child.astype(np.int32), scaled, (box * factor).ravel())


def _sampled(field: Callable[[Array], Array], x: Array) -> Array:
    """The field at many places, asked only once where several are equal."""
    flat = x.reshape(-1, 3)
    order = np.lexsort(flat.T[::-1])
    rows = flat[order]
    new = np.ones(len(rows), dtype=bool)
    new[1:] = (rows[1:] != rows[:-1]).any(axis=1)
    found = np.empty(len(rows))
    found[order] = field(rows[new])[np.cumsum(new) - 1]
    return found.reshape(x.shape[:-1])


def _see_landmarks(places: NDArray[np.int64], at: Array, marked: Array, found: tuple) -> None:
    """Take the sizes at landmarks into account where they are within leaves of this level."""
    values, error, least = found
    if len(marked) == 0 or len(places) == 0:
        return
    cell = np.floor(at).astype(np.int64)
    outside = ((cell < 0) | (cell >= 1 << MOST_OCTREE_LEVELS)).any(axis=1)
    keys, wanted = ((rows * KEY_OF_PLACE).sum(axis=1) for rows in (places, cell))
    order = np.argsort(keys, kind="stable")
    at_leaf = order[np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)]
    marks = np.flatnonzero((keys[at_leaf] == wanted) & ~outside)
    leaf, size = at_leaf[marks], marked[marks]
    guess = _trilinear(values[leaf], at[marks] - cell[marks])
    np.maximum.at(error, leaf, np.abs(guess - size) / size)
    np.minimum.at(least, leaf, size)
