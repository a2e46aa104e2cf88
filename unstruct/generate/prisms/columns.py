"""Columns of wedges: how high they may be, and which are not positive.

A column over the triangle p with rays v is x = sum l_i (p_i + t v_i). Its Jacobian is A(t) . sum l_i v_i with
A(t) = (e + t e') x (f + t f'), linear in l: it is positive in the whole column exactly when the three
quadratics A(t) . v_i are (see `unstruct.geometry.jacobians`). If the layers are equal fractions of all three
rays, their wedges are slabs of this column, and one test is enough. Else, and because places are rounded,
each wedge is tested. A ray of no height makes pyramids, or tetrahedra, of the wedges beside it: its own
quadratic vanishes, and the others decide as before.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...geometry.jacobians import signs_of, wedge_signs
from ...predicates.batch import power_of_two
from ...predicates.filters import UNDECIDED
from .visibility import SIGN_ERROR, SIGN_TINY

__all__ = ["bad", "blind", "limits", "scaled_columns"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@inline
def _det(a, b, c):
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    return x * c[0] + y * c[1] + z * c[2]


@inline
def _from(p, q):
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


@inline
def _first_root(a, b, c):
    """The least t > 0 at which a + b t + c t^2 is not positive; 0 if it is not in the beginning."""
    if not a > 0.0:
        return 0.0
    if c == 0.0:
        return -a / b if b < 0.0 else math.inf
    inside = b * b - 4.0 * a * c
    if inside < 0.0:
        return math.inf
    # The roots are q / c and a / q, without cancellation.
    q = -0.5 * (b + math.sqrt(inside)) if b >= 0.0 else -0.5 * (b - math.sqrt(inside))
    one = q / c
    two = a / q if q != 0.0 else math.inf
    root = math.inf
    if one > 0.0:
        root = one
    if two > 0.0:
        root = min(root, two)
    return root


@kernel
def _limits(points, directions, columns, limit):
    for i in range(len(columns)):
        a, b, c = columns[i, 0], columns[i, 1], columns[i, 2]
        e, f = _from(points[b], points[a]), _from(points[c], points[a])
        u, w = _from(directions[b], directions[a]), _from(directions[c], directions[a])
        least = math.inf
        for k in range(3):
            v = directions[columns[i, k]]
            if v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0:
                continue
            least = min(least, _first_root(_det(e, f, v), _det(e, w, v) + _det(u, f, v), _det(u, w, v)))
        limit[i] = least


def limits(points: Array, directions: Array, columns: NDArray[np.int32]) -> Array:
    """How far columns may grow until their Jacobian is no longer positive, up to rounding.

    Parameters
    ----------
    points, directions : (r, 3) float64
        Of the rays; the vectors have any length, and the limits are in units of it. A zero vector is a ray
        that stays where it is.
    columns : (c, 3) int32

    Returns
    -------
    (c,) float64
        The least positive roots of the quadratics; inf where there are none, 0 where a ray does not see the
        triangle.
    """
    limit = np.empty(len(columns))
    one, two = power_of_two(points), power_of_two(directions)  # so that no product underflows
    _limits(points * one, directions * two, columns, limit)
    return limit * (two / one)


# ---------------------------------------------------------------------- exact


@inline
def _sum(v):
    return abs(v[0]) + abs(v[1]) + abs(v[2])


@inline
def _wedge(lower, upper, moves):
    """1 if a wedge is surely positive, -1 if it is surely not positive somewhere, else UNDECIDED.

    All entries of edges are differences of doubles, and so right up to 2^-53 of themselves; a determinant of
    them errs by less than 2^-50 of the product of sums of magnitudes.
    """
    e, f = _from(lower[1], lower[0]), _from(lower[2], lower[0])
    g, h = _from(upper[1], upper[0]), _from(upper[2], upper[0])
    size = max(_sum(e), _sum(g)) * max(_sum(f), _sum(h))
    result = 1
    for k in range(3):
        if not moves[k]:
            continue
        v = _from(upper[k], lower[k])
        bound = SIGN_ERROR * size * _sum(v) + SIGN_TINY
        b0, b2 = _det(e, f, v), _det(g, h, v)
        if b0 < -bound or b2 < -bound:
            return -1
        if not (b0 > bound and b2 > bound):
            result = UNDECIDED
            continue
        b1 = 0.5 * (_det(e, h, v) + _det(g, f, v))
        if b1 < bound:
            gap = b0 * b2 - b1 * b1
            slack = bound * (4.0 * (b0 + b2 + abs(b1)) + 4.0 * bound)
            if gap < -slack and b1 < -bound:
                return -1
            if not gap > slack:
                result = UNDECIDED
    return result


@kernel
def _bad(places, factor, columns, level, signs, layer):
    """Write the sign of each column and the first layer that is not surely positive."""
    top = len(places) - 1
    lower, upper, moves = np.empty((3, 3)), np.empty((3, 3)), np.empty(3, dtype=np.bool_)
    for i in range(len(columns)):
        signs[i], layer[i] = 1, top
        for j in range(3):
            for k in range(3):
                upper[j, k] = places[0, columns[i, j], k] * factor
        for step in range(top):
            lower, upper = upper, lower
            some = False
            for j in range(3):
                moves[j] = step < level[columns[i, j]]
                some = some or moves[j]
                for k in range(3):
                    upper[j, k] = places[step + 1, columns[i, j], k] * factor
            if not some:
                break
            sign = _wedge(lower, upper, moves)
            if sign != 1:
                if layer[i] == top:
                    layer[i] = step
                signs[i] = sign
                if sign == -1:
                    break


def bad(places: Array, columns: NDArray[np.int32], level: NDArray[np.int32] | None = None) -> Numbers:
    """The columns with a cell that is not positive, exactly.

    Parameters
    ----------
    places : (levels + 1, r, 3) float64
        The places of rays on all levels, as the mesh has them. Above its level a ray stays where it is.
    columns : (c, 3) int32
    level : (r,) int32, optional
        How many layers each ray has; all by default. Where rays of a column have different ones, its cells
        are wedges, then pyramids and tetrahedra.

    Returns
    -------
    (b,) int64
        Rows of ``columns``. O(c levels).
    """
    top = len(places) - 1
    level = np.full(places.shape[1], top, dtype=np.int32) if level is None else level
    signs, layer = np.empty(len(columns), dtype=np.int8), np.empty(len(columns), dtype=np.int64)
    _bad(places, power_of_two(places[[0, -1]].reshape(-1, 3)), columns, level, signs, layer)
    for i in np.flatnonzero(signs == UNDECIDED).tolist():
        steps = np.arange(layer[i], top)
        corners = np.concatenate([places[steps][:, columns[i]], places[steps + 1][:, columns[i]]], axis=1)
        moves = steps[:, None] < level[columns[i]]
        signs[i] = 1 if (_exact(corners, moves) == 1).all() else -1
    return np.flatnonzero(signs != 1)


def _exact(corners: Array, moves: NDArray[np.bool_]) -> NDArray[np.int8]:
    """The signs of wedges, or of the pyramids and tetrahedra that are left where not all edges move."""
    signs = np.ones(len(corners), dtype=np.int8)
    whole = moves.all(axis=1)
    signs[whole] = wedge_signs(corners[whole])
    for i in range(3):  # without mixed terms the quadratics are linear: both ends decide
        rows = np.flatnonzero(~whole & moves[:, i])
        for level in (0, 3):
            frame = [level + i, level + (i + 1) % 3, level + (i + 2) % 3, i, i + 3]
            found = signs_of(corners[rows][:, frame], _frame_sign)
            signs[rows[found != 1]] = -1
    return signs


def blind(places: Array, columns: NDArray[np.int32], level: NDArray[np.int32]) -> Numbers:
    """Rays whose first step, as rounded, does not see the base of a column, exactly: sorted, each once.

    To lower them does not help: what is lost to rounding is more then.
    """
    found = []
    for i in range(3):
        ray = columns[:, i]
        rows = np.flatnonzero(level[ray] > 0)
        base = places[0][columns[rows][:, [i, (i + 1) % 3, (i + 2) % 3]]]
        ends = np.stack([places[0, ray[rows]], places[1, ray[rows]]], axis=1)
        found.append(ray[rows[signs_of(np.concatenate([base, ends], axis=1), _frame_sign) != 1]])
    return np.unique(np.concatenate(found)).astype(np.int64)


def _frame_sign(x: np.ndarray, bound: np.ndarray) -> np.ndarray:
    e, f, v = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0], x[:, 4] - x[:, 3]
    det = v[:, 0] * (e[:, 1] * f[:, 2] - e[:, 2] * f[:, 1])
    det = det + v[:, 1] * (e[:, 2] * f[:, 0] - e[:, 0] * f[:, 2])
    det = det + v[:, 2] * (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])
    signs = np.full(len(x), UNDECIDED, dtype=np.int8)
    signs[(det <= -bound) & (det >= bound)] = 0  # exact, where the bound is 0
    signs[det > bound] = 1
    signs[det < -bound] = -1
    return signs


# ---------------------------------------------------------------------- how good they are


@inline
def _square(v):
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]


@inline
def _worst(x, v, least):
    """The lesser of a value and the signed squares of the three determinants at one end of a wedge."""
    e, f, g = _from(x[1], x[0]), _from(x[2], x[0]), _from(x[2], x[1])
    n = e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]
    one, two, three = _square(e), _square(f), _square(g)
    for k in range(3):
        lengths = (one if k < 2 else two) * (two if k == 0 else three) * _square(v[k])
        det = n[0] * v[k, 0] + n[1] * v[k, 1] + n[2] * v[k, 2]
        signed = det * abs(det)
        if signed < least * lengths:
            least = signed / lengths
    return least


@kernel
def _scaled(places, factor, columns, level, least):
    top = len(places) - 1
    lower, upper, v = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(len(columns)):
        least[i] = np.inf
        whole = min(level[columns[i, 0]], level[columns[i, 1]], level[columns[i, 2]], top)
        for j in range(3):
            for k in range(3):
                upper[j, k] = places[0, columns[i, j], k] * factor
        for step in range(whole):
            lower, upper = upper, lower
            for j in range(3):
                for k in range(3):
                    upper[j, k] = places[step + 1, columns[i, j], k] * factor
                    v[j, k] = upper[j, k] - lower[j, k]
            least[i] = _worst(upper, v, _worst(lower, v, min(least[i], 4.0)))


def scaled_columns(places: Array, columns: NDArray[np.int32], level: NDArray[np.int32]) -> Array:
    """The least scaled Jacobian of the wedges of each column, inf where it has none: (c,).

    The determinant of the unit vectors along the edges at a corner, over that of a right wedge on an
    equilateral triangle. Arguments as of `bad`.
    """
    least = np.empty(len(columns))
    _scaled(places, power_of_two(places[[0, -1]].reshape(-1, 3)), columns, level, least)
    return np.sign(least) * np.sqrt(np.abs(least) * (4.0 / 3.0))
