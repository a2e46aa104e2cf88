"""A metric as kernels read it: a quadtree over a box, with its logarithm at four corners of each leaf.

The table stores L = log(M) / 2, which has the eigenvalues -log(h_i) and the directions of M. Between the
corners of a leaf L is bilinear, and exp(L), the square root of M, is positive definite whatever L is. So no
rounding can spoil the metric, and no square of a length can leave the range of doubles. If the directions at
two places differ by a small angle d, and the lengths have the ratio r at both, then the shorter length of the
mean of the logarithms is too long by the factor r^(d^2 / 4). For the mean of the inverse matrices it is
sqrt(1 + (d r / 2)^2), so that a table of these needs many more leaves at large ratios. Source: V. Arsigny et
al., Magnetic Resonance in Medicine 56 (2006) 411-421. Book: 3.3.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_points
from ..base.errors import InputError
from ..base.jit import inline, kernel
from .table import CORNERS, FRESH, box_of, leaf_at

__all__ = ["MetricNodes", "MetricTable", "build_metric", "inverted", "root_at", "spectrum"]

Array = NDArray[np.float64]
ALWAYS = 4  # levels of the table that are always made
FINE_ENOUGH = 1.0  # a leaf no larger than this many of its smallest lengths is not divided
LN2, INVERSE_OF_LN2 = 0.6931471805599453, 1.4426950408889634
LEAST_POWER = 1000
POWERS = 2.0 ** np.arange(-LEAST_POWER, LEAST_POWER + 1.0)
MOST_LOGARITHM = 340.0  # squares of lengths, and their inverses, are doubles then
PROBES = np.concatenate([[[0.5, 0.5]], FRESH])


@inline
def rapid_exponential(x):
    """e to the power of x, |x| < 690, to 10 digits, by basic operations: equal on every processor."""
    k = np.floor(x * INVERSE_OF_LN2 + 0.5)
    r = x - k * LN2
    s = r * r
    low = 1.0 + r + s * (1.0 / 2.0 + r * (1.0 / 6.0))
    high = 1.0 / 24.0 + r * (1.0 / 120.0) + s * (1.0 / 720.0 + r * (1.0 / 5040.0) + s * (1.0 / 40320.0))
    return POWERS[int(k) + LEAST_POWER] * (low + s * s * high)


@inline
def root_at(table, x, y):
    """(p, q, r): the square root of the metric at a place, in scaled coordinates, with rows (p, q), (q, r).

    The metric length of a vector is the length of its image in the plane. The map keeps orientation.
    """
    values = table.values
    node, u, v = leaf_at(table.child, table.box, x, y)
    k, l, m, n = (1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v
    a = k * values[node, 0, 0] + l * values[node, 1, 0] + m * values[node, 2, 0] + n * values[node, 3, 0]
    b = k * values[node, 0, 1] + l * values[node, 1, 1] + m * values[node, 2, 1] + n * values[node, 3, 1]
    c = k * values[node, 0, 2] + l * values[node, 1, 2] + m * values[node, 2, 2] + n * values[node, 3, 2]
    mean, half = 0.5 * (a + c), 0.5 * (a - c)
    radius = sqrt(half * half + b * b)
    large, small = rapid_exponential(mean + radius), rapid_exponential(mean - radius)
    middle = 0.5 * (large + small)
    share = 0.5 * (large - small) / radius if radius > 1e-9 else middle
    return middle + share * half, share * b, middle - share * half


@kernel
def _roots_at(table, x, factor, result):
    for i in range(x.shape[0]):
        p, q, r = root_at(table, x[i, 0] * factor, x[i, 1] * factor)
        result[i, 0], result[i, 1], result[i, 2] = p, q, r


@inline
def larger_eigenvalue(a, b, c):
    """The larger eigenvalue of the matrix with rows (a, b) and (b, c)."""
    return 0.5 * (a + c) + sqrt(0.25 * (a - c) * (a - c) + b * b)


def spectrum(rows: Array) -> tuple[Array, Array]:
    """The larger and the smaller eigenvalue of symmetric matrices (k, 3)."""
    a, b, c = rows.T
    with np.errstate(over="ignore", invalid="ignore", divide="ignore", under="ignore"):
        large = 0.5 * (a + c) + np.hypot(0.5 * (a - c), b)
        small = np.where(large > 0, (a / large) * c - (b / large) * b, -np.inf)
    return large, small


def inverted(rows: Array) -> Array:
    """The inverses of positive definite matrices, (k, 3) -> (k, 3)."""
    a, b, c = rows.T
    large, small = spectrum(rows)
    return np.stack([c / large / small, 0.0 - b / large / small, a / large / small], axis=1)


def logarithms(rows: Array) -> Array:
    """Half of the logarithms of the inverses of positive definite matrices, (k, 3) -> (k, 3)."""
    a, b, c = rows.T
    large, small = spectrum(rows)
    one, two = -0.5 * np.log(large), -0.5 * np.log(small)
    radius = np.hypot(0.5 * (a - c), b)
    share = np.divide(one - two, 2.0 * radius, out=np.zeros(len(rows)), where=radius > 0)
    middle, half = 0.5 * (one + two), share * 0.5 * (a - c)
    return np.stack([middle + half, share * b, middle - half], axis=1)


def inverses_of(logs: Array) -> Array:
    """The positive definite matrices (k, 3) with these `logarithms`."""
    a, b, c = logs.T
    mean, half = 0.5 * (a + c), 0.5 * (a - c)
    radius = np.hypot(half, b)
    one, two = np.exp(-2.0 * (mean + radius)), np.exp(-2.0 * (mean - radius))
    share = np.divide(one - two, 2.0 * radius, out=np.zeros(len(logs)), where=radius > 0)
    middle = 0.5 * (one + two)
    return np.stack([middle + share * half, share * b, middle - share * half], axis=1)


class MetricNodes(NamedTuple):
    """The arrays of a table."""

    child: NDArray[np.int32]
    values: Array  # (q, 4, 3) l11, l12, l22 of L = log(M) / 2 at the corners of each node, scaled
    box: Array


class MetricTable:
    """A metric over a box, as arrays for kernels.

    Attributes
    ----------
    nodes : MetricNodes
        ``child``, ``values`` and ``box``, as in `SizeTable`; ``values`` has log(M) / 2 at the four corners
        of each node.
    factor : float
        The factor by which coordinates and lengths are multiplied.
    error : float
        The largest relative difference of a length, in any direction, that was found in a leaf.
    capped : int
        How many leaves have an error above the tolerance because they are as small as the smallest
        length in them, or because a limit was reached.
    """

    def __init__(self, nodes: MetricNodes, factor: float, error: float, capped: int):
        self.nodes, self.factor, self.error, self.capped = nodes, factor, error, capped

    def inverses(self, x: ArrayLike) -> Array:
        """The inverse metric of the table at points (k, 2), unscaled: rows b11, b12, b22."""
        points = as_points(x, "x")
        if points.shape[1] != 2:
            raise InputError(f"x must have shape (k, 2), not {points.shape}")
        roots = np.empty((len(points), 3))
        _roots_at(self.nodes, points, self.factor, roots)
        p, q, r = (roots * self.factor).T
        det = p * r - q * q
        return np.stack(
            [(q * q + r * r) / det / det, -q * (p + r) / det / det, (p * p + q * q) / det / det], 1
        )

    def area(self) -> float:
        """The area of the box in the metric, by one value for each leaf."""
        width, height = self.nodes.box[2:] - self.nodes.box[:2]
        node, share, total = np.zeros(1, dtype=np.int64), width * height, 0.0
        while len(node):
            leaf = self.nodes.child[node] < 0
            middle = self.nodes.values[node[leaf]].mean(axis=1)
            total += float(share * np.exp(middle[:, 0] + middle[:, 2]).sum())  # exp(trace L) = sqrt(det M)
            node, share = (self.nodes.child[node[~leaf], None] + np.arange(4)).ravel(), share / 4
        return total

    def __repr__(self) -> str:
        leaves = int((self.nodes.child < 0).sum())
        return f"<MetricTable: {leaves} leaves, relative error {self.error:.2g}>"


def _difference(guess: Array, true: Array) -> Array:
    """The largest relative difference of a length, in any direction: (..., 3), (..., 3) -> (...)."""
    large, small = spectrum(true.reshape(-1, 3))
    scale = large.reshape(*true.shape[:-1], 1)  # so that no product leaves the range of doubles
    guess, true, det = guess / scale, true / scale, (small / large).reshape(true.shape[:-1])
    trace = true[..., 2] * guess[..., 0] - 2 * true[..., 1] * guess[..., 1] + true[..., 0] * guess[..., 2]
    large, small = spectrum(guess.reshape(-1, 3))
    product = (large * small).reshape(true.shape[:-1]) / det
    trace /= det
    root = np.sqrt(np.maximum(trace * trace / 4 - product, 0.0))
    most = trace / 2 + root
    least = np.maximum(product / most, 0.0)
    return np.maximum(np.sqrt(most) - 1, 1 - np.sqrt(least))


def build_metric(
    at: Callable[[Array], Array],
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    constant: Array | None,
    landmarks: Array,
    factor: float,
    tolerance: float,
    max_depth: int,
    max_nodes: int,
) -> MetricTable:
    """The table of a metric; see `Metric.table`, which calls it. ``at`` gives inverse metrics (k, 3)."""
    box = box_of(lower, upper, factor, tolerance)
    if constant is not None:
        return _metric_table([np.tile(logarithms(constant), (1, 4, 1))], np.array([-1]), box, factor, 0.0, 0)
    span = box[1] - box[0]

    def look(place: Array) -> Array:  # (..., 2) relative coordinates -> (..., 3)
        x = np.minimum(box[0] + place * span, box[1])
        return at(x.reshape(-1, 2)).reshape(*place.shape[:-1], 3)

    marks = landmarks[((landmarks >= box[0]) & (landmarks <= box[1])).all(axis=1)]
    known = at(marks) if len(marks) else np.empty((0, 3))
    marks = np.clip((marks - box[0]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
    inside = np.zeros(len(marks), dtype=np.int64)  # the leaf of each landmark, as a row of this level
    node, place = np.zeros(1, dtype=np.int64), np.zeros((1, 2), dtype=np.int64)
    values = logarithms(look(CORNERS)).reshape(1, 4, 3)
    blocks, child, worst, capped = [values], np.array([-1]), 0.0, 0
    u, v = PROBES.T
    weight = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v], axis=1)
    for depth in range(max_depth + 1):
        side = 0.5**depth
        seen = look((place[:, None] + PROBES) * side)
        guess = np.einsum("pc,mck->mpk", weight, values)
        guess = inverses_of(guess.reshape(-1, 3)).reshape(seen.shape)
        error = _difference(guess, seen).max(axis=1)
        _, least = spectrum(seen.reshape(-1, 3))
        least = least.reshape(len(seen), -1).min(axis=1)
        if len(marks):
            u, v = (marks / side - place[inside]).T
            share = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v], axis=1)
            there = inverses_of(np.einsum("kc,kcj->kj", share, values[inside]))
            np.maximum.at(error, inside, _difference(there, known))
            np.minimum.at(least, inside, spectrum(known)[1])
        wrong = error > tolerance
        stop = (side * span.max() <= FINE_ENOUGH * np.sqrt(least)) | (depth == max_depth)
        divide = (wrong | (depth < ALWAYS)) & ~stop
        room = max((max_nodes - len(child)) // 4, 0)
        if divide.sum() > room:
            rows = np.flatnonzero(divide)
            divide[rows[np.argsort(-error[rows], kind="stable")[room:]]] = False
        worst = max(worst, float(error[~divide].max(initial=0.0)))
        capped += int((wrong & ~divide).sum())
        if not divide.any():
            break
        child[node[divide]] = len(child) + 4 * np.arange(divide.sum())
        keep = divide[inside]
        marks, known, inside = marks[keep], known[keep], inside[keep]
        quadrant = np.clip((marks // (side / 2)).astype(np.int64) - 2 * place[inside], 0, 1)
        inside = 4 * (np.cumsum(divide) - 1)[inside] + quadrant @ np.array([1, 2])
        place = (2 * place[divide][:, None] + CORNERS.astype(np.int64)).reshape(-1, 2)
        node = len(child) + np.arange(len(place))
        values = look((place[:, None] + CORNERS) * (side / 2))
        values = logarithms(values.reshape(-1, 3)).reshape(values.shape)
        blocks.append(values)
        child = np.append(child, np.full(len(node), -1))
    return _metric_table(blocks, child, box, factor, worst, capped)


def _metric_table(
    blocks: list[Array], child: NDArray, box: Array, factor: float, error: float, capped: int
) -> MetricTable:
    values = np.concatenate(blocks)
    values[..., [0, 2]] -= np.log(factor)
    with np.errstate(over="ignore", under="ignore"):
        scaled = box.ravel() * factor
    if not (np.abs(values).max() < MOST_LOGARITHM and np.isfinite(scaled).all()):
        raise InputError(f"the lengths of the metric times {factor:g} leave the range of doubles")
    return MetricTable(MetricNodes(child.astype(np.int32), values, scaled), float(factor), error, capped)
