"""The coordinates of a Voronoi diagram: its vertices and the directions of its rays.

The combinatorics are exact; coordinates are rounded. A center is computed relative to a site on its sphere,
so that large coordinates of all sites cause no loss of accuracy. Nearly flat simplices are treated with
integer arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

__all__ = ["determinants", "local_circumcenters", "outward_normals", "volumes"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

AT_ONCE = 1 << 15  # how many centers are computed at a time, to bound the memory
NEARLY_FLAT = 1e-3  # integers are used if the determinant over the product of edge lengths is at most this


def local_circumcenters(
    points: Floats, simplices: Ints, scale: float, weights: Floats | None = None
) -> tuple[Ints, Floats]:
    """Circumcenters of the points times ``scale``, as (corner, offset from that corner).

    With weights: power centers, at which |x - p|^2 - w is the same for all corners.

    ``scale`` is a power of two that makes all coordinates at most 1 in magnitude. For each simplex, the first
    corner from which the edges are far from parallel is taken; errors are then about 1e-12 of the
    circumradius. If there is no such corner, the offset is computed exactly and rounded once. An offset
    beyond the range of doubles is infinite.
    """
    m, width = simplices.shape
    scaled = points * scale
    base, offset = simplices[:, 0].copy(), np.empty((m, width - 1))
    for low in range(0, m, AT_ONCE):
        part = slice(low, low + AT_ONCE)
        _some_centers((points, scaled, weights), simplices[part], scale, base[part], offset[part])
    return base, offset


def _some_centers(given: tuple, simplices: Ints, scale: float, base: Ints, offset: Floats) -> None:
    """`local_circumcenters` of some simplices, written into ``base`` and ``offset``."""
    points, scaled, weights = given
    todo, width = np.arange(len(simplices)), simplices.shape[1]
    for k in range(width):
        corner = simplices[todo, k]
        rows = scaled[np.delete(simplices[todo], k, axis=1)] - scaled[corner][:, None]
        square = (rows**2).sum(axis=2)
        size = np.sqrt(square).prod(axis=1)
        if weights is not None:
            square -= (
                (weights[np.delete(simplices[todo], k, axis=1)] - weights[corner][:, None]) * scale * scale
            )
        solid = (np.abs(determinants(rows)) > NEARLY_FLAT * size) & (size > 1e-200)
        done = todo[solid]
        base[done] = corner[solid]
        offset[done] = _solve(rows[solid], square[solid] / 2)
        todo = todo[~solid]
        if not len(todo):
            break
    for t in todo.tolist():
        heavy = [0.0] * width if weights is None else weights[simplices[t]].tolist()
        offset[t] = _exact_offset(points[simplices[t]].tolist(), heavy, scale)


def volumes(points: Floats, simplices: Ints, scale: float) -> Floats:
    """d! times the volumes of simplices of the points times ``scale``; rounded, for comparisons of size."""
    corners = points[simplices] * scale
    return np.abs(determinants(corners[:, 1:] - corners[:, :1]))


def determinants(rows: Floats) -> Floats:
    """Determinants of matrices (m, d, d); for d <= 3 by plain formulas, which are exact on small integers."""
    d = rows.shape[1]
    if d == 0:
        return np.ones(len(rows))
    if d > 3:
        return _eliminated(rows, np.zeros(rows.shape[:2]))[0]
    if d == 1:
        return rows[:, 0, 0]
    head, rest = rows[:, 0], rows[:, 1:]
    total: Floats = np.zeros(len(rows))
    for k in range(d):
        total += (-1) ** k * head[:, k] * determinants(np.delete(rest, k, axis=2))
    return total


def _solve(rows: Floats, right: Floats) -> Floats:
    """Solutions of linear systems (m, d, d), by Cramer's rule up to d = 3."""
    d = rows.shape[1]
    if d > 3:
        return _eliminated(rows, right)[1]
    result = np.empty(right.shape)
    for k in range(d):
        changed = rows.copy()
        changed[:, :, k] = right
        result[:, k] = determinants(changed)
    return result / determinants(rows)[:, None]


def _eliminated(rows: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Determinants and solutions by elimination with the largest pivots, in one order on all processors."""
    table = np.concatenate([rows, right[..., None]], axis=2)
    m, d = right.shape
    every, volume = np.arange(m), np.ones(m)
    with np.errstate(all="ignore"):  # if singular: determinant 0, solution not finite
        for k in range(d):
            best = k + np.abs(table[:, k:, k]).argmax(axis=1)
            volume *= np.where(best == k, 1.0, -1.0)
            table[every, best], table[:, k] = table[:, k].copy(), table[every, best]
            volume *= table[:, k, k]
            ratio = table[:, k + 1 :, k] / table[:, k, k, None]
            ratio = np.where(table[:, k, k, None] == 0.0, 0.0, ratio)
            table[:, k + 1 :] -= ratio[..., None] * table[:, None, k]
        for k in range(d - 1, -1, -1):
            table[:, k, d] /= table[:, k, k]
            table[:, :k, d] -= table[:, :k, k] * table[:, k, d, None]
    return volume, table[:, :, d]


def _exact_offset(corners: list[list[float]], heavy: list[float], factor: float) -> list[float]:
    """Power center minus first corner, times ``factor``, by Cramer's rule: a_i . c = (|a_i|^2 - v_i) / 2.

    a_i and v_i are the differences of corners and of weights to the first ones.
    """
    weights = [Fraction(w) for w in heavy]
    bits = max(w.denominator.bit_length() for w in weights) // 2
    rows, scale = _integer_rows(corners, 1 << bits)
    up, down = factor.as_integer_ratio()
    extra = [int((w - weights[0]) * scale * scale) for w in weights[1:]]
    squares = [sum(x * x for x in row) - v for row, v in zip(rows, extra)]
    whole = 2 * _determinant(rows) * scale * down
    result = []
    for k in range(len(rows)):
        part = _determinant([[*row[:k], s, *row[k + 1 :]] for row, s in zip(rows, squares)])
        result.append(_quotient(part * up, whole))
    return result


def outward_normals(points: Floats, simplices: Ints, facets: NDArray[np.int64], scale: float) -> Floats:
    """Unit normals, pointing away from the cell, of facets given as numbers cell * (d + 1) + corner."""
    width = simplices.shape[1]
    cell, corner = facets // width, facets % width
    keep = np.array([[j for j in range(width) if j != i] for i in range(width)])
    sites = simplices[cell[:, None], keep[corner]]
    rows = (points[sites[:, 1:]] - points[sites[:, :1]]) * scale
    normal = np.empty((len(cell), width - 1))
    for k in range(width - 1):
        normal[:, k] = (-1) ** k * determinants(np.delete(rows, k, axis=2))
    size = np.sqrt((rows**2).sum(axis=2)).prod(axis=1)
    length = np.sqrt((normal**2).sum(axis=1))
    weak = ~((length > NEARLY_FLAT * size) & (size > 1e-100))
    for r in np.flatnonzero(weak).tolist():
        normal[r] = _exact_normal(points[sites[r]].tolist())
        length[r] = math.hypot(*normal[r])
    return np.where(corner % 2 == 0, 1.0, -1.0)[:, None] * normal / length[:, None]


def _exact_normal(corners: list[list[float]]) -> list[float]:
    """The minors of the edges from the first corner, divided by the largest of them."""
    rows, _ = _integer_rows(corners)
    minors = [
        (-1) ** k * _determinant([[*row[:k], *row[k + 1 :]] for row in rows]) for k in range(len(corners[0]))
    ]
    most = max(abs(x) for x in minors)
    return [x / most for x in minors]


def _integer_rows(corners: list[list[float]], least: int = 1) -> tuple[list[list[int]], int]:
    """The corners minus the first, times the common denominator of their coordinates, and that number.

    The number is a power of two, at least ``least``.
    """
    ratios = [[x.as_integer_ratio() for x in p] for p in corners]
    scale = max(least, *(q for p in ratios for _, q in p))
    first, *others = [[n * (scale // q) for n, q in p] for p in ratios]
    return [[x - y for x, y in zip(p, first)] for p in others], scale


def _determinant(rows: Sequence[Sequence[int]]) -> int:
    """The determinant of a small integer matrix, by minors of its first row."""
    if not rows:
        return 1
    head, rest = rows[0], rows[1:]
    minors = ([[*row[:k], *row[k + 1 :]] for row in rest] for k in range(len(head)))
    return sum((-1) ** k * x * _determinant(minor) for k, (x, minor) in enumerate(zip(head, minors)) if x)


def _quotient(a: int, b: int) -> float:
    try:
        return a / b  # correctly rounded
    except OverflowError:
        return math.inf if (a > 0) == (b > 0) else -math.inf
