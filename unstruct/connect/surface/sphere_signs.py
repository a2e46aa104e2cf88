"""Signs that decide what is Delaunay on a surface, exact for all doubles.

Each is that of a polynomial in the coordinates, evaluated in doubles together with a bound of the rounding;
where that leaves the sign open, it is evaluated again in Python's integers. For the plane-centered sphere of
a triangle a, b, c, let u = b - a, v = c - a, w = p - a. The circumcenter is a + x with x = (|u|^2 (v x n) +
|v|^2 (n x u)) / (2 |n|^2), n = u x v. So p lies inside exactly if |w|^2 < 2 w . x, and multiplied by |n|^2
this contains nothing but scalar products:

    |w|^2 (AB - C^2) - AB (D + E) + C (AE + BD) < 0,   A = u.u, B = v.v, C = u.v, D = u.w, E = v.w.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline
from ...predicates.exact import integers
from ...predicates.filters import EPS, TINY

__all__ = ["cotangent_signs", "exact_ball_signs", "filter_ball", "plane_ball_signs"]

PLANE_BALL_BOUND = 32 * EPS  # 6 differences, 3 scalar products (3 each), 5 more operations: 20 roundings
COTANGENT_BOUND = 32 * EPS
SIGNS_IN_ONE_GO = 1 << 16

Array = NDArray[np.float64]


@inline
def filter_ball(xyz, a, b, c, p):
    """-1 if p surely lies inside the plane-centered sphere of a, b, c, 1 if surely outside, else 0."""
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    wx, wy, wz = xyz[p, 0] - xyz[a, 0], xyz[p, 1] - xyz[a, 1], xyz[p, 2] - xyz[a, 2]
    A, B, F = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
    C, D, E = ux * vx + uy * vy + uz * vz, ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    c_all = abs(ux * vx) + abs(uy * vy) + abs(uz * vz)
    d_all = abs(ux * wx) + abs(uy * wy) + abs(uz * wz)
    e_all = abs(vx * wx) + abs(vy * wy) + abs(vz * wz)
    value = F * (A * B - C * C) - A * B * (D + E) + C * (A * E + B * D)
    size = F * (A * B + c_all * c_all) + A * B * (d_all + e_all) + c_all * (A * e_all + B * d_all)
    bound = PLANE_BALL_BOUND * size + TINY
    return 1 if value > bound else (-1 if value < -bound else 0)


def _dot(x: Any, y: Any) -> Any:
    return x[:, 0] * y[:, 0] + x[:, 1] * y[:, 1] + x[:, 2] * y[:, 2]


def _ball(a: Any, b: Any, c: Any, p: Any) -> tuple[Any, Any]:
    """The polynomial and the sum of its absolute terms, for rows of doubles or of integers."""
    u, v, w = b - a, c - a, p - a
    A, B, F, C, D, E = _dot(u, u), _dot(v, v), _dot(w, w), _dot(u, v), _dot(u, w), _dot(v, w)
    value = F * (A * B - C * C) - A * B * (D + E) + C * (A * E + B * D)
    u, v, w = abs(u), abs(v), abs(w)
    C, D, E = _dot(u, v), _dot(u, w), _dot(v, w)
    return value, F * (A * B + C * C) + A * B * (D + E) + C * (A * E + B * D)


def as_integers(points: Array, *rows: NDArray) -> list[NDArray]:
    """Coordinates of vertices as Python integers over one power of two: an array (k, 3) for each row (k,)."""
    used, number = np.unique(np.concatenate(rows), return_inverse=True)
    exact = np.empty((len(used), 3), dtype=object)
    if len(used):
        exact[:] = integers(points[used])
    return np.split(exact[number], np.cumsum([len(row) for row in rows])[:-1])


def signs_of(values: NDArray) -> NDArray[np.int8]:
    """-1, 0 or 1 for each integer of any size."""
    return (values > 0).astype(np.int8) - (values < 0).astype(np.int8)


def exact_ball_signs(points: Array, rows: NDArray, p: NDArray) -> NDArray[np.int8]:
    """-1 where vertex p is inside the plane-centered sphere of a row of three, 0 on it, 1 outside."""
    parts = [np.empty(0, dtype=np.int8)]
    for i in range(0, len(rows), SIGNS_IN_ONE_GO):
        part = rows[i : i + SIGNS_IN_ONE_GO]
        corners = as_integers(points, part[:, 0], part[:, 1], part[:, 2], p[i : i + SIGNS_IN_ONE_GO])
        parts.append(signs_of(_ball(*corners)[0]))
    return np.concatenate(parts)


def plane_ball_signs(points: Array, factor: float, rows: NDArray, p: NDArray) -> NDArray[np.int8]:
    """`exact_ball_signs` of many triangles and vertices, with a filter; points * factor are at most 1."""
    xyz = points * factor
    value, size = _ball(xyz[rows[:, 0]], xyz[rows[:, 1]], xyz[rows[:, 2]], xyz[p])
    signs = signs_of(value)
    open_ = np.flatnonzero(np.abs(value) <= PLANE_BALL_BOUND * size + TINY)
    signs[open_] = exact_ball_signs(points, rows[open_], p[open_])
    return signs


def _corner(a: Any, b: Any, c: Any) -> tuple[Any, Any]:
    """At corner c: the scalar product of the two sides, and their vector product, in rows."""
    u, v = a - c, b - c
    cross = [u[:, (k + 1) % 3] * v[:, (k + 2) % 3] - u[:, (k + 2) % 3] * v[:, (k + 1) % 3] for k in range(3)]
    return _dot(u, v), np.stack(cross, axis=1)


def _corner_size(a: Array, b: Array, c: Array) -> tuple[Array, Array]:
    u, v = np.abs(a - c), np.abs(b - c)
    cross = [u[:, (k + 1) % 3] * v[:, (k + 2) % 3] + u[:, (k + 2) % 3] * v[:, (k + 1) % 3] for k in range(3)]
    return _dot(u, v), np.sqrt(sum(x * x for x in cross))


def cotangent_signs(points: Array, factor: float, ends: NDArray, opposite: NDArray) -> NDArray[np.int8]:
    """The sign of the sum of the cotangents of two angles: -1 where the angles add up to more than pi.

    Parameters
    ----------
    points : (n, 3)
    factor : float
        A power of two that brings coordinates to 1 at most.
    ends, opposite : (k, 2) int
        The ends of each edge, and the two corners opposite to it.

    Notes
    -----
    With scalar products D, E and vector products m, n at the two corners, the sum is D / |m| + E / |n|. If D
    and E have different signs, D^2 |n|^2 and E^2 |m|^2 are compared.
    """
    xyz = points * factor
    a, b, c, d = (xyz[i] for i in (ends[:, 0], ends[:, 1], opposite[:, 0], opposite[:, 1]))
    (D, m), (E, n) = _corner(a, b, c), _corner(a, b, d)
    (d_all, m_all), (e_all, n_all) = _corner_size(a, b, c), _corner_size(a, b, d)
    value = D * np.sqrt(_dot(n, n)) + E * np.sqrt(_dot(m, m))
    signs = signs_of(value)
    open_ = np.flatnonzero(np.abs(value) <= COTANGENT_BOUND * (d_all * n_all + e_all * m_all) + TINY)
    for i in range(0, len(open_), SIGNS_IN_ONE_GO):
        part = open_[i : i + SIGNS_IN_ONE_GO]
        signs[part] = _exact_cotangents(points, ends[part], opposite[part])
    return signs


def _exact_cotangents(points: Array, ends: NDArray, opposite: NDArray) -> NDArray[np.int8]:
    a, b, c, d = as_integers(points, ends[:, 0], ends[:, 1], opposite[:, 0], opposite[:, 1])
    (D, m), (E, n) = _corner(a, b, c), _corner(a, b, d)
    left, right = signs_of(D), signs_of(E)
    larger = signs_of(D * D * _dot(n, n) - E * E * _dot(m, m))
    return np.where(left * right < 0, left * larger, np.where(left == 0, right, left)).astype(np.int8)
