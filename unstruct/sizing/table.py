"""A size field as kernels read it: a quadtree over a box, with four corner values in each leaf.

Between the corners of a leaf the size is bilinear, so it never leaves the range of the values that the
field itself gave. Across the common edge of two leaves of different depths it may jump, by no more than
their errors. See the book, chapter 2.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_points
from ..base.errors import InputError
from ..base.jit import inline, kernel

__all__ = ["Nodes", "SizeTable", "box_of", "build", "leaf_at", "size_at", "table_of"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
ROOT3 = math.sqrt(3.0)  # a wanted edge length divided by this is a wanted circumradius
FIRST_LEVELS = 5  # levels that are always made, so that 32 x 32 leaves are sampled at nine points each
# Nodes are numbered level by level. If all levels above depth FIRST_LEVELS are full, ABOVE is the number of
# their last node, and its children are the last four nodes of that depth, of which LAST_FULL is the first.
# Conversely, if LAST_FULL is a child of node ABOVE, then all nodes before that node are divided as well.
SIDE = 1 << FIRST_LEVELS
ABOVE = (SIDE * SIDE - 1) // 3 - 1
LAST_FULL = ABOVE + SIDE * SIDE - 3
DEEPEST = 50  # the largest number of levels for which places are exact in doubles
MOST_PLACES = 1 << DEEPEST  # along a side of the box
RESOLVED = 0.25  # a leaf no larger than this many wanted edge lengths is small enough

# Where the field is sampled in a leaf, in coordinates of the leaf. FRESH are the places that are new when the
# leaf is examined: the middles of its sides (corners of its children), then the centers of its children.
CORNERS = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
FRESH = np.array([[2, 0], [0, 2], [4, 2], [2, 4], [1, 1], [3, 1], [1, 3], [3, 3]]) / 4.0
#   2 8 3       The corners are numbered 0 to 3, the center 4, and the middles of the sides 5 to 8.
#   6 4 7       Row c of CHILD lists the corners of child c.
#   0 5 1
CHILD = np.array([[0, 5, 6, 4], [5, 1, 4, 7], [6, 4, 2, 8], [4, 7, 8, 3]])


@inline
def spaced(i):
    """The number i, below 256, with a zero bit inserted between any two of its bits."""
    i = (i | i << 4) & 0x0F0F
    i = (i | i << 2) & 0x3333
    return (i | i << 1) & 0x5555


@inline
def leaf_at(child, box, x, y):
    """The leaf at (x, y), in scaled coordinates, or nearest to it, and the place in it: (node, u, v)."""
    width, height = box[2] - box[0], box[3] - box[1]
    u = min(max((x - box[0]) / width, 0.0), 1.0) if width > 0.0 else 0.0
    v = min(max((y - box[1]) / height, 0.0), 1.0) if height > 0.0 else 0.0
    # Bits of the places, as integers, lead down without comparisons, whose outcome cannot be predicted.
    i = min(int(MOST_PLACES * u), MOST_PLACES - 1) if u >= 0.0 else 0
    j = min(int(MOST_PLACES * v), MOST_PLACES - 1) if v >= 0.0 else 0
    node, shift = np.int64(0), DEEPEST
    # If the first levels are full, one step leads to the node at depth FIRST_LEVELS.
    if len(child) > ABOVE and child[ABOVE] == LAST_FULL:
        shift = DEEPEST - FIRST_LEVELS
        node = np.int64(ABOVE + 1 + spaced(i >> shift) + 2 * spaced(j >> shift))
    below = child[node]
    while below >= 0:
        shift -= 1
        node = np.int64(below + (i >> shift & 1) + 2 * (j >> shift & 1))
        below = child[node]
    times = float(1 << DEEPEST - shift)
    return node, times * u - (i >> shift), times * v - (j >> shift)


@inline
def size_at(child, values, box, x, y):
    """The size at (x, y), in scaled coordinates of the table; outside the box, that at its nearest point."""
    node, u, v = leaf_at(child, box, x, y)
    low = values[node, 0] + u * (values[node, 1] - values[node, 0])
    high = values[node, 2] + u * (values[node, 3] - values[node, 2])
    return low + v * (high - low)


@kernel
def _sizes_at(child, values, box, x, factor, result):
    for i in range(x.shape[0]):
        result[i] = size_at(child, values, box, x[i, 0] * factor, x[i, 1] * factor)


class Nodes(NamedTuple):
    """The arrays of a table, in the order in which `size_at` takes them."""

    child: NDArray[np.int32]
    values: Array
    box: Array


class SizeTable:
    """A size field over a box, as arrays for kernels.

    Attributes
    ----------
    child : ndarray of int32, shape (q,)
        The first of the four children of each node (lower left, lower right, upper left, upper right); -1
        for a leaf. Node 0 is the box.
    values : ndarray, shape (q, 4)
        Sizes at the corners of each node, in the same order, times `factor`.
    box : ndarray, shape (4,)
        x and y of the lower corner, then of the upper one, times `factor`.
    factor : float
        The factor by which coordinates and sizes are multiplied.
    error : float
        The largest relative difference from the field that was found in a leaf: at nine points of each leaf,
        and at the landmarks of the field.
    capped : dict of str to int
        How many leaves have an error above the tolerance, by the reason why they were not divided.
        "resolved": the leaf is no larger than a quarter of the wanted edge length there, so that a mesh
        could not use more detail. "depth" and "nodes": the limit on the depth or the number of nodes was
        reached. A field with a jump always has such leaves.
    """

    def __init__(self, nodes: Nodes, factor: float, error: float, capped: dict[str, int]):
        self.nodes = nodes
        self.child, self.values, self.box = nodes
        self.factor, self.error, self.capped = factor, error, capped

    def __call__(self, x: ArrayLike) -> Array:
        """The sizes of the table at points (k, 2) in the coordinates of the field, unscaled, shape (k,)."""
        points = as_points(x, "x")
        if points.shape[1] != 2:
            raise InputError(f"x must have shape (k, 2), not {points.shape}")
        result = np.empty(len(points))
        _sizes_at(*self.nodes, points, self.factor, result)
        return result / self.factor

    def corners(self) -> tuple[Array, Array]:
        """The corners of all nodes, each place once, (c, 2), and the sizes there, (c,); both unscaled."""
        low, node, side = np.zeros((1, 2)), np.zeros(1, dtype=np.int64), 1.0
        places, values = [], []
        while len(node):  # level by level
            places.append((low[:, None] + side * CORNERS).reshape(-1, 2))
            values.append(self.values[node].ravel())
            divided = self.child[node] >= 0
            node = (self.child[node[divided], None] + np.arange(4)).ravel()
            side /= 2
            low = (low[divided, None] + side * CORNERS).reshape(-1, 2)
        place, first = np.unique(np.concatenate(places), axis=0, return_index=True)
        span = self.box[2:] - self.box[:2]
        return (self.box[:2] + place * span) / self.factor, np.concatenate(values)[first] / self.factor

    def __repr__(self) -> str:
        leaves = int((self.child < 0).sum())
        kept = f", {sum(self.capped.values())} capped" if sum(self.capped.values()) else ""
        return f"<SizeTable: {leaves} leaves, relative error {self.error:.2g}{kept}>"


class _Level(NamedTuple):
    """The leaves of one depth: their places and the sizes known in them."""

    node: Integers  # (m,) numbers of the leaves in the table
    place: Integers  # (m, 2) integer coordinates of the lower corner, in units of the side of a leaf
    values: Array  # (m, 5) sizes at the corners and the center
    marks: Integers  # (j,) numbers of the landmarks in these leaves
    inside: Integers  # (j,) the leaf that contains each landmark, as a row of this level


def build(
    field: Callable[[Array], Array],
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    landmarks: Array,
    factor: float,
    tolerance: float,
    max_depth: int,
    max_nodes: int,
    deeper: Callable[[float, Array, Array], NDArray[np.bool_]] | None = None,
) -> SizeTable:
    """The table of a field; see `SizeField.table`, which calls it.

    All leaves of one depth are sampled together, with one call of the field. A leaf that is small enough for
    any mesh, and whose error exceeds the tolerance, is divided only if ``deeper`` returns True for it. The
    arguments of ``deeper`` are the longer side of the leaves, the 13 places that were sampled in each,
    (m, 13, 2), and the sizes there, (m, 13).
    """
    box = box_of(lower, upper, factor, tolerance)
    if not 0 <= max_depth <= DEEPEST:
        raise InputError(f"max_depth must lie in 0..{DEEPEST}, not {max_depth!r}")
    capped = {"resolved": 0, "depth": 0, "nodes": 0}
    constant = getattr(field, "constant", None)
    if constant is not None:
        return table_of([np.full((1, 4), constant)], np.array([-1]), box, factor, 0.0, capped)
    span = box[1] - box[0]

    def where(place: Array) -> Array:  # relative coordinates -> coordinates of the field
        return np.minimum(box[0] + place * span, box[1])

    def at(place: Array) -> Array:  # (..., 2) relative coordinates -> (...)
        return field(where(place).reshape(-1, 2)).reshape(place.shape[:-1])

    relative, wanted = _landmarks(field, landmarks, box)
    every = np.arange(len(wanted))
    first = np.concatenate([CORNERS, [[0.5, 0.5]]])
    level = _Level(np.zeros(1, np.int64), np.zeros((1, 2), np.int64), at(first)[None], every, 0 * every)
    blocks, child, worst = [level.values[:, :4]], np.array([-1]), 0.0
    for depth in range(max_depth + 1):
        side = 0.5**depth
        probes = at((level.place[:, None] + FRESH) * side)
        error, least = _look(level, probes, relative, wanted, side)
        wrong = error > tolerance
        divide = wrong | (depth < FIRST_LEVELS)
        small = side * span.max() <= RESOLVED * least
        if deeper is not None:
            rows = np.nonzero(small & wrong)[0]
            x = where((level.place[rows, None] + np.concatenate([first, FRESH])) * side)
            small[rows] = ~deeper(side * span.max(), x, np.hstack([level.values[rows], probes[rows]]))
        for reason, stop in (
            ("resolved", small),
            ("depth", np.full(len(least), depth == max_depth)),
            ("nodes", _beyond(error, divide, (max_nodes - len(child)) // 4)),
        ):
            capped[reason] += int((divide & stop & wrong).sum())
            divide &= ~stop
        worst = max(worst, float(error[~divide].max(initial=0.0)))
        if not divide.any():
            break
        child[level.node[divide]] = len(child) + 4 * np.arange(divide.sum())
        level = _divided(level, probes, divide, relative, side / 2, len(child))
        blocks.append(level.values[:, :4])
        child = np.append(child, np.full(len(level.node), -1))
    return table_of(blocks, child, box, factor, worst, capped)


def _landmarks(field: Callable[[Array], Array], landmarks: Array, box: Array) -> tuple[Array, Array]:
    """Relative coordinates of the landmarks in the box, and the sizes there."""
    if len(landmarks) == 0:
        return np.empty((0, 2)), np.empty(0)
    if landmarks.shape[1] != 2:
        raise InputError(
            f"a table is of the plane, but the landmarks of the size have shape {landmarks.shape}"
        )
    marks = landmarks[((landmarks >= box[0]) & (landmarks <= box[1])).all(axis=1)]
    span = box[1] - box[0]
    relative = np.clip((marks - box[0]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
    return relative, field(marks) if len(marks) else np.empty(0)


def _bilinear(corners: Array, u: Array) -> Array:
    """The bilinear interpolant of corner values (..., 4) at places u (..., 2) in [0, 1]^2."""
    x, y = u[..., 0], u[..., 1]
    low = corners[..., 0] + x * (corners[..., 1] - corners[..., 0])
    return low + y * (corners[..., 2] + x * (corners[..., 3] - corners[..., 2]) - low)


def _look(level: _Level, probes: Array, relative: Array, wanted: Array, side: float) -> tuple[Array, Array]:
    """The largest relative error of the interpolant of each leaf, and the smallest size seen in it."""
    seen = np.concatenate([level.values[:, 4:], probes], axis=1)
    guess = _bilinear(level.values[:, None, :4], np.concatenate([[[0.5, 0.5]], FRESH]))
    error = (np.abs(guess - seen) / seen).max(axis=1)
    least = np.minimum(seen.min(axis=1), level.values.min(axis=1))
    marks, inside = level.marks, level.inside
    if len(marks):
        guess = _bilinear(level.values[inside, :4], relative[marks] / side - level.place[inside])
        np.maximum.at(error, inside, np.abs(guess - wanted[marks]) / wanted[marks])
        np.minimum.at(least, inside, wanted[marks])
    return error, least


def _beyond(error: Array, divide: NDArray[np.bool_], room: int) -> NDArray[np.bool_]:
    """Of the leaves to be divided, those for which there is no room: all but the ``room`` worst ones."""
    stop = np.zeros(len(error), dtype=bool)
    rows = np.nonzero(divide)[0]
    if len(rows) > room:
        stop[rows[np.argsort(-error[rows], kind="stable")[max(room, 0) :]]] = True
    return stop


def _divided(
    level: _Level, probes: Array, divide: NDArray[np.bool_], relative: Array, side: float, count: int
) -> _Level:
    """The children of the divided leaves, four consecutive ones each, numbered from ``count`` on."""
    known = np.concatenate([level.values, probes[:, :4]], axis=1)[divide]  # nine columns, as drawn above
    values = np.concatenate([known[:, CHILD], probes[divide, 4:, None]], axis=2).reshape(-1, 5)
    place = (2 * level.place[divide][:, None] + CORNERS).reshape(-1, 2)
    keep = divide[level.inside]
    marks, inside = level.marks[keep], level.inside[keep]
    quadrant = np.clip((relative[marks] // side).astype(np.int64) - 2 * level.place[inside], 0, 1)
    row = 4 * (np.cumsum(divide) - 1)[inside] + quadrant @ np.array([1, 2])
    return _Level(count + np.arange(len(place)), place, values, marks, row)


def box_of(lower: ArrayLike, upper: ArrayLike, factor: float, tolerance: float) -> Array:
    """The corners of the box, shape (2, 2); the arguments are checked."""
    try:
        box = np.array([lower, upper], dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("lower and upper must have two coordinates each") from None
    if box.shape != (2, 2):
        raise InputError(
            f"a table needs a box of the plane: lower and upper must have two coordinates each, "
            f"not shape {box.shape[1:]}"
        )
    with np.errstate(over="ignore", invalid="ignore"):
        span = box[1] - box[0]
    if not (np.isfinite(box).all() and np.isfinite(span).all() and (span >= 0).all()):
        raise InputError(
            f"lower {box[0].tolist()} and upper {box[1].tolist()} are not a box: "
            "they must be finite, with lower <= upper"
        )
    for name, value in (("factor", factor), ("tolerance", tolerance)):
        if not (np.isfinite(value) and value > 0):
            raise InputError(f"{name} must be a positive number, not {value!r}")
    return box


def table_of(
    blocks: list[Array], child: Integers, box: Array, factor: float, error: float, capped: dict[str, int]
) -> SizeTable:
    """A table of nodes level by level, scaled by a factor.

    Parameters
    ----------
    blocks : list of (q, 4) ndarray
        The sizes at the corners of the nodes of each level.
    child : (n,) int64
    box : (2, 2) float64
    factor, error, capped
        As for `SizeTable`.

    Raises
    ------
    InputError
        If scaled sizes leave the range of doubles.
    """
    with np.errstate(over="ignore", under="ignore"):
        values, scaled = np.concatenate(blocks) * factor, box.ravel() * factor
    tiny = np.finfo(np.float64).tiny
    if not (values.min() >= tiny and np.isfinite(values).all() and np.isfinite(scaled).all()):
        low, high = values.min() / factor, values.max() / factor
        raise InputError(
            f"sizes from {low:g} to {high:g} times the factor {factor:g} leave the range of doubles"
        )
    return SizeTable(Nodes(child.astype(np.int32), values, scaled), float(factor), error, capped)
