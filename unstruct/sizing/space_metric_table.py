"""A metric in space as kernels read it: an octree over a box, with inverse matrices at the corners of leaves.

Between the corners of a leaf the inverse matrix B = sum h_i^2 d_i d_i' is trilinear, hence positive definite,
as a mean of such matrices; its lengths never leave the range of those at the corners. Its Cholesky factor L
(B = L L') is the map from the space in which lengths are 1 where they are as wanted. Where directions turn by
an angle d within a leaf, the shortest length of the mean is too long by sqrt(1 + (d r / 2)^2) for a ratio r:
leaves are divided for that. Book: 3.3, 3.5.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..base.jit import inline, kernel
from ..geometry.stretched import cholesky
from .space_table import CUBE_CORNERS, EIGHTH_CENTERS, IN_HALVES, IS_CORNER, octree_leaf

__all__ = [
    "SpaceMetricNodes", "cholesky_rows", "factor_in_space", "leaves_of", "scaled_nodes", "space_metric_nodes",
    "wanted_cells",
]  # fmt: skip

Array = NDArray[np.float64]
DIVIDED_FIRST = 3  # levels that are always made: 8 x 8 x 8 leaves
MOST_METRIC_LEVELS = 16
MOST_METRIC_NODES = 200_000
ALLOWED_LENGTH_ERROR = 0.05  # relative, in any direction
FINE_METRIC_LEAF = 1.0  # a leaf no larger than this many of its shortest lengths is small enough
CELLS_IN_A_CUBE = 6.0 * np.sqrt(2.0)  # regular tetrahedra of edge 1 with the volume of the unit cube
PROBED = np.concatenate([IN_HALVES / 2.0, EIGHTH_CENTERS])


class SpaceMetricNodes(NamedTuple):
    """The first child of each node (-1 for a leaf), inverse matrices (n, 8, 6) at corners, and the box."""

    child: NDArray[np.int32]
    values: Array
    box: Array


@inline
def factor_in_space(table, x, y, z):
    """The factor L of the inverse metric at a place, in scaled coordinates: l11, l21, l22, l31, l32, l33."""
    node, u, v, w = octree_leaf(table.child, table.box, x, y, z)
    b1 = b2 = b3 = b4 = b5 = b6 = 0.0
    for k in range(8):
        share = (u if k & 1 else 1.0 - u) * (v if k & 2 else 1.0 - v) * (w if k & 4 else 1.0 - w)
        b1 += share * table.values[node, k, 0]
        b2 += share * table.values[node, k, 1]
        b3 += share * table.values[node, k, 2]
        b4 += share * table.values[node, k, 3]
        b5 += share * table.values[node, k, 4]
        b6 += share * table.values[node, k, 5]
    return cholesky(b1, b2, b3, b4, b5, b6)


@kernel
def factors_in_space(table, x, result):
    """`factor_in_space` for the rows of x."""
    for i in range(x.shape[0]):
        a, b, c, d, e, f = factor_in_space(table, x[i, 0], x[i, 1], x[i, 2])
        result[i, 0], result[i, 1], result[i, 2] = a, b, c
        result[i, 3], result[i, 4], result[i, 5] = d, e, f


@kernel
def _factors(rows, result):
    for i in range(rows.shape[0]):
        r = rows[i]
        a, b, c, d, e, f = cholesky(r[0], r[1], r[2], r[3], r[4], r[5])
        result[i, 0], result[i, 1], result[i, 2] = a, b, c
        result[i, 3], result[i, 4], result[i, 5] = d, e, f


def cholesky_rows(rows: Array) -> Array:
    """The factors L of positive definite matrices B = L L', (k, 6) -> (k, 6)."""
    result = np.empty_like(rows)
    _factors(rows, result)
    return result


def space_metric_nodes(
    inverses: Callable[[Array], Array], box: Array, factor: float, landmarks: Array, constant: bool
) -> SpaceMetricNodes:
    """The table of a metric over a box.

    Parameters
    ----------
    inverses : callable
        Takes points (k, 3), returns the rows (k, 6) of the inverse matrices.
    box : (2, 3) ndarray
        Opposite corners, in the coordinates of the metric.
    factor : float
        Coordinates and lengths of the table are multiplied by it.
    landmarks : (j, 3) ndarray
        Places within the box, the leaves of which are divided until they are small.
    constant : bool
        Whether the metric is the same everywhere.

    Notes
    -----
    Level by level. A leaf is divided while a length in some direction at 27 places or at the centers of its
    eighths differs by more than 5 % from that of the interpolant, and while it is larger than the shortest
    length in it; no leaf is divided beyond 2^16 parts of the box or 200,000 nodes. O(n) for n nodes.
    """
    low, side = box[0], box[1] - box[0]
    places, node = np.zeros((1, 3), dtype=np.int64), np.zeros(1, dtype=np.int64)
    child, blocks = np.array([-1], dtype=np.int64), []
    for level in range(MOST_METRIC_LEVELS + 1):
        h = side * 0.5**level
        at = np.minimum((low + h * places)[:, None] + h * PROBED, box[1])
        seen = inverses(at.reshape(-1, 3)).reshape(len(places), len(PROBED), 6)
        values = seen[:, : len(IN_HALVES)][:, IS_CORNER]
        blocks.append(values)
        if constant or level == MOST_METRIC_LEVELS:
            break
        error, shortest = _errors(values, seen)
        for mark in np.unique(np.floor((landmarks - low) / h).astype(np.int64), axis=0):
            error[(places == mark).all(axis=1)] = np.inf
        split = (level < DIVIDED_FIRST) | ((error > ALLOWED_LENGTH_ERROR) & (h.max() > shortest))
        if not split.any() or len(child) + 8 * split.sum() > MOST_METRIC_NODES:
            break
        child[node[split]] = len(child) + 8 * np.arange(split.sum())
        places = (2 * places[split][:, None] + CUBE_CORNERS).reshape(-1, 3)
        node = len(child) + np.arange(len(places))
        child = np.append(child, np.full(len(places), -1))
    made = SpaceMetricNodes(child.astype(np.int32), np.concatenate(blocks), box.ravel())
    return scaled_nodes(made, factor)


def scaled_nodes(nodes: SpaceMetricNodes, factor: float) -> SpaceMetricNodes:
    """The table with coordinates and lengths multiplied by a power of two, so that nothing is rounded."""
    scaled = nodes.values * factor * factor
    tiny = np.finfo(np.float64).tiny
    if not (np.isfinite(scaled).all() and scaled[..., [0, 2, 5]].min() > tiny):
        raise InputError(f"lengths leave the range of doubles when they are multiplied by {factor:g}")
    return SpaceMetricNodes(nodes.child, scaled, nodes.box * factor)


def leaves_of(nodes: SpaceMetricNodes) -> tuple[Array, Array]:
    """The lower corners of the leaves (m, 3), and the sides of their boxes (m, 3)."""
    low, span = nodes.box[:3], nodes.box[3:] - nodes.box[:3]
    places, node = np.zeros((1, 3), dtype=np.int64), np.zeros(1, dtype=np.int64)
    corners, sides, level = [], [], 0
    while len(node):
        h = span * 0.5**level
        leaf = nodes.child[node] < 0
        corners.append(low + h * places[leaf])
        sides.append(np.broadcast_to(h, (int(leaf.sum()), 3)))
        places = (2 * places[~leaf][:, None] + CUBE_CORNERS).reshape(-1, 3)
        node, level = (nodes.child[node[~leaf], None] + np.arange(8)).ravel(), level + 1
    return np.concatenate(corners), np.concatenate(sides)


def wanted_cells(nodes: SpaceMetricNodes, x: Array) -> Array:
    """How many regular tetrahedra with edges of length 1 a unit of volume takes at points (k, 3)."""
    factors = np.empty((len(x), 6))
    factors_in_space(nodes, x, factors)
    return CELLS_IN_A_CUBE / (factors[:, 0] * factors[:, 2] * factors[:, 5])


def _errors(values: Array, seen: Array) -> tuple[Array, Array]:
    """The largest relative error of a length in each leaf, up to second order, and the shortest pivot."""
    u, v, w = PROBED.T
    shares = np.stack(
        [(u if k & 1 else 1 - u) * (v if k & 2 else 1 - v) * (w if k & 4 else 1 - w) for k in range(8)]
    )
    guess = np.zeros_like(seen)
    for k in range(8):
        guess += shares[k][:, None] * values[:, k, None, :]
    worst, shortest = np.zeros(len(seen)), np.full(len(seen), np.inf)
    l = cholesky_rows(seen.reshape(-1, 6)).reshape(seen.shape)
    q = cholesky_rows(guess.reshape(-1, 6)).reshape(seen.shape)
    a, b, c, d, e, f = np.moveaxis(l, 2, 0)
    qa, qb, qc, qd, qe, qf = np.moveaxis(q, 2, 0)
    # L^-1 Q is lower triangular, and the identity where the guess is right.
    g1, g3, g6 = qa / a, qc / c, qf / f
    g2 = (qb - b * g1) / c
    g4 = (qd - d * g1 - e * g2) / f
    g5 = (qe - e * g3) / f
    total = (g1 - 1) ** 2 + (g3 - 1) ** 2 + (g6 - 1) ** 2 + g2**2 + g4**2 + g5**2
    worst = np.sqrt(total).max(axis=1)
    shortest = np.minimum(a, np.minimum(c, f)).min(axis=1) * FINE_METRIC_LEAF
    return worst, shortest
