"""The first cell of gift wrapping: an empty sphere that grows from a vertex, dimension after dimension.

Let F be a face with an empty ball, center c, squared radius R^2, c in the flat of F. Moving the center by
t u, with u a unit vector normal to that flat, keeps F on the sphere, and a point x comes onto it at

    t(x, u) = (|x - c|^2 - R^2) / (2 u . (x - c)).

Over all u the first contact is at t(x) = (|x - c|^2 - R^2) / (2 h(x)), with h the distance of x from the
flat. The ball through F and the point of the least t(x) is empty: a point x inside it would have come
onto the sphere earlier, at t(x) <= t(x, u) < t. So the point of the smallest circumsphere is always
right, from a single vertex to a cell.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...base.errors import DegenerateInputError
from ...predicates.batch import in_sphere, orient
from ...predicates.filters import EPS
from ..insertion.first import FLATS
from ..insertion.general import exact_integers

__all__ = ["first_cell", "suspects"]


def first_cell(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """A positively oriented cell with an exactly empty sphere, round a closest pair of points.

    Parameters
    ----------
    points : ndarray, shape (n, d)
        No two equal, d >= 2.

    Raises
    ------
    DegenerateInputError
        Where the points do not span the space.

    Notes
    -----
    O(n d^2) in floating point, verified by exact signs; where these object, the same in rational
    arithmetic for all points.
    """
    row = grow_rounded(points)
    if row is not None and (sign := orient(points[row])) != 0:
        if sign < 0:
            row[[0, 1]] = row[[1, 0]]
        near = suspects(points, row)
        if len(near) == 0 or not np.any(np.asarray(in_sphere(points[row], points[near])) > 0):
            return row
    row = grow_exactly(points)
    if orient(points[row]) < 0:
        row[[0, 1]] = row[[1, 0]]
    return row


def grow_rounded(points: NDArray[np.float64]) -> NDArray[np.int64] | None:
    """The construction in floating point; None where it cannot tell."""
    from scipy.spatial import cKDTree

    with np.errstate(all="ignore"):
        size = np.abs(points).max()
        if not 1e-140 < size < 1e140:
            return None
        start = int(np.argmin(cKDTree(points).query(points, k=2)[0][:, 1]))
        chosen, center, radius2 = [start], points[start].copy(), 0.0
        basis = np.empty((0, points.shape[1]))
        while len(chosen) <= points.shape[1]:
            away = points - center
            height = away - _product(_product(away, basis.T), basis)
            height -= _product(_product(height, basis.T), basis)
            h = np.sqrt((height**2).sum(axis=1))
            t = ((away**2).sum(axis=1) - radius2) / (2 * h)
            t[~(h > 1e-10 * np.sqrt((away**2).sum(axis=1))) | np.isnan(t)] = np.inf
            t[chosen] = np.inf
            best = int(np.argmin(t))
            if not np.isfinite(t[best]):
                return None
            u = height[best] / h[best]
            center, radius2 = center + t[best] * u, radius2 + t[best] ** 2
            basis = np.vstack([basis, u])
            chosen.append(best)
    return np.array(chosen)


def _product(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """``a @ b``, its sums in one order on every processor: ties must not be decided by the machine."""
    return np.asarray((a[:, :, None] * b).sum(axis=1))


def grow_exactly(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """The construction in rational arithmetic, from vertex 0."""
    rows = exact_integers(points, 0)[0]
    d = points.shape[1]
    chosen, center, radius2 = [0], [Fraction(x) for x in rows[0]], Fraction(0)
    basis: list[list[Fraction]] = []
    while len(chosen) <= d:
        best = None
        for v, row in enumerate(rows):
            away = [x - c for x, c in zip(row, center)]
            power = _dot(away, away) - radius2
            for b in basis:
                factor = _dot(away, b) / _dot(b, b)
                away = [x - factor * y for x, y in zip(away, b)]
            h2 = _dot(away, away)
            if h2 and (best is None or power * power * best[1] < best[0] * best[0] * h2):
                best = (power, h2, away, v)
        if best is None:
            k = len(chosen) - 1
            what = f"all points are {FLATS[k]}" if k in FLATS else "all points lie in one flat"
            raise DegenerateInputError(
                f"{what} (dimension {k}): a triangulation in {d} dimensions needs points that span the "
                "space; add others, or drop the coordinates that carry nothing",
                k,
            )
        power, h2, away, v = best
        center = [c + power / (2 * h2) * y for c, y in zip(center, away)]
        radius2 += power * power / (4 * h2)
        basis.append(away)
        chosen.append(v)
    return np.array(chosen)


def _dot(a: list[Fraction], b: list[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b)), Fraction(0))


def suspects(points: NDArray[np.float64], row: NDArray[np.int64]) -> NDArray[np.int64]:
    """All points that may lie inside or on the sphere of the row, its corners left out: a superset, rounded.

    With g(x) = |x - c|^2 for *any* c, and barycentric coordinates b_v(x), a point is inside where
    g(x) < sum b_v g(v): certainly not where g(x) exceeds max g(v) + (max g(v) - min g(v)) sum |b_v|.
    """
    with np.errstate(all="ignore"):
        corners = points[row]
        edges = corners[1:] - corners[0]
        try:
            inverse = np.linalg.inv(edges)
            center = corners[0] + inverse @ ((edges**2).sum(axis=1) / 2)
            trusted = np.abs(edges) @ np.abs(inverse)
        except np.linalg.LinAlgError:
            return np.setdiff1d(np.arange(len(points)), row)
        g = ((points - center) ** 2).sum(axis=1)
        spread = np.ptp(g[row]) + 64 * EPS * g[row].max()
        b = (points - corners[0]) @ inverse
        total = 1 + 2 * np.abs(b).sum(axis=1)  # b_0 is 1 minus the others
        bound = (g[row].max() + 4 * spread * total) * (1 + 1e-12) + 1e-300
        outside = g > bound
        if not trusted.max() < 1e6:  # the inverse may be far off
            outside[:] = False
    outside[row] = True
    return np.flatnonzero(~outside)
