"""Cubic surfaces fitted to the neighborhood of each vertex: principal curvatures and their directions.

Over the plane orthogonal to the normal, z = d x + e y + a x^2 / 2 + b x y + c y^2 / 2 + four cubic terms is
fitted by least squares, with weights of one over the squared distance. The linear terms make up for a normal
that is not exact.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel

__all__ = ["fit_surfaces"]

Array = NDArray[np.float64]
TERMS_OF_CUBIC, TERMS_OF_QUADRIC = 9, 5
ENOUGH_NEAR = 12  # neighbors: with as many or more of them, those two edges away are not needed
MOST_NEIGHBORS = 96
WEAK_PIVOT = 1e-9  # of the diagonal: what is left of a column that others explain


@inline
def _terms(x, y, row):
    row[0], row[1] = x, y
    row[2], row[3], row[4] = x * x / 2.0, x * y, y * y / 2.0
    row[5], row[6], row[7], row[8] = x * x * x, x * x * y, x * y * y, y * y * y


@kernel
def _solve(matrix, right, many, solution):
    """Solve the leading ``many`` equations by Cholesky's method; False if one depends on the others."""
    for i in range(many):
        for j in range(i + 1):
            value = matrix[i, j]
            for k in range(j):
                value -= matrix[many + i, k] * matrix[many + j, k]
            if i == j:
                if not value > WEAK_PIVOT * matrix[i, i]:
                    return False
                matrix[many + i, i] = np.sqrt(value)
            else:
                matrix[many + i, j] = value / matrix[many + j, j]
    for i in range(many):
        value = right[i]
        for k in range(i):
            value -= matrix[many + i, k] * solution[k]
        solution[i] = value / matrix[many + i, i]
    for i in range(many - 1, -1, -1):
        value = solution[i]
        for k in range(i + 1, many):
            value -= matrix[many + k, i] * solution[k]
        solution[i] = value / matrix[many + i, i]
    return True


@kernel
def _gather(v, start, joined, stamp, near):
    """The vertices one edge from v, and those two edges away if the former are few."""
    count = 0
    stamp[v] = v
    for i in range(start[v], start[v + 1]):
        if count < near.shape[0]:
            near[count] = joined[i]
            stamp[joined[i]] = v
            count += 1
    if count >= ENOUGH_NEAR:
        return count
    for k in range(count):
        w = near[k]
        for i in range(start[w], start[w + 1]):
            if stamp[joined[i]] != v and count < near.shape[0]:
                near[count] = joined[i]
                stamp[joined[i]] = v
                count += 1
    return count


@inline
def _frame(n):
    """A unit vector orthogonal to n: away from the axis that n is nearest to."""
    x, y, z = abs(n[0]), abs(n[1]), abs(n[2])
    if x <= y and x <= z:
        ux, uy, uz = 0.0, -n[2], n[1]
    elif y <= z:
        ux, uy, uz = n[2], 0.0, -n[0]
    else:
        ux, uy, uz = -n[1], n[0], 0.0
    size = np.sqrt(ux * ux + uy * uy + uz * uz)
    return ux / size, uy / size, uz / size


@kernel
def _fit(xyz, normals, start, joined, principal, directions):
    stamp, near = np.full(xyz.shape[0], -1), np.empty(MOST_NEIGHBORS, dtype=np.int64)
    row, solution = np.empty(TERMS_OF_CUBIC), np.empty(TERMS_OF_CUBIC)
    matrix, right = np.empty((2 * TERMS_OF_CUBIC, TERMS_OF_CUBIC)), np.empty(TERMS_OF_CUBIC)
    for v in range(xyz.shape[0]):
        n = normals[v]
        count = _gather(v, start, joined, stamp, near)
        if count < 3 or not n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0.0:
            continue
        ux, uy, uz = _frame(n)
        wx, wy, wz = n[1] * uz - n[2] * uy, n[2] * ux - n[0] * uz, n[0] * uy - n[1] * ux
        scale = 0.0
        for k in range(count):
            scale = max(scale, _away(xyz, v, near[k]))
        scale = np.sqrt(scale)
        for i in range(TERMS_OF_CUBIC):
            right[i] = 0.0
            for j in range(TERMS_OF_CUBIC):
                matrix[i, j] = 0.0
        for k in range(count):
            p = near[k]
            px, py, pz = xyz[p, 0] - xyz[v, 0], xyz[p, 1] - xyz[v, 1], xyz[p, 2] - xyz[v, 2]
            px, py, pz = px / scale, py / scale, pz / scale
            _terms(px * ux + py * uy + pz * uz, px * wx + py * wy + pz * wz, row)
            z = px * n[0] + py * n[1] + pz * n[2]
            weight = 1.0 / max(px * px + py * py + pz * pz, 1e-12)
            for i in range(TERMS_OF_CUBIC):
                right[i] += weight * row[i] * z
                for j in range(i + 1):
                    matrix[i, j] += weight * row[i] * row[j]
        if not (count > TERMS_OF_CUBIC and _solve(matrix, right, TERMS_OF_CUBIC, solution)):
            if not (count >= TERMS_OF_QUADRIC and _solve(matrix, right, TERMS_OF_QUADRIC, solution)):
                continue
        k1, k2, du, dv = _principal(solution)
        principal[v, 0], principal[v, 1] = k1 / scale, k2 / scale
        d, e = solution[0], solution[1]
        tx = du * (ux + d * n[0]) + dv * (wx + e * n[0])
        ty = du * (uy + d * n[1]) + dv * (wy + e * n[1])
        tz = du * (uz + d * n[2]) + dv * (wz + e * n[2])
        size = np.sqrt(tx * tx + ty * ty + tz * tz)
        tx, ty, tz = tx / size, ty / size, tz / size
        mx, my, mz = n[0] - d * ux - e * wx, n[1] - d * uy - e * wy, n[2] - d * uz - e * wz
        size = np.sqrt(mx * mx + my * my + mz * mz)
        mx, my, mz = mx / size, my / size, mz / size
        directions[v, 0, 0], directions[v, 0, 1], directions[v, 0, 2] = tx, ty, tz
        directions[v, 1, 0] = my * tz - mz * ty
        directions[v, 1, 1] = mz * tx - mx * tz
        directions[v, 1, 2] = mx * ty - my * tx


@inline
def _away(xyz, v, p):
    return (xyz[p, 0] - xyz[v, 0]) ** 2 + (xyz[p, 1] - xyz[v, 1]) ** 2 + (xyz[p, 2] - xyz[v, 2]) ** 2


@kernel
def _principal(solution):
    """(greater, lesser, direction of the greater) of the fitted surface where x = y = 0."""
    d, e = solution[0], solution[1]
    w = np.sqrt(1.0 + d * d + e * e)
    L, M, N = -solution[2] / w, -solution[3] / w, -solution[4] / w
    E, F, G = 1.0 + d * d, d * e, 1.0 + e * e
    det = E * G - F * F
    mean = (E * N - 2.0 * F * M + G * L) / (2.0 * det)
    gauss = (L * N - M * M) / det
    root = np.sqrt(max(mean * mean - gauss, 0.0))
    k1, k2 = mean + root, mean - root
    # the direction is orthogonal to both rows of II - k1 I; the longer row is used
    one, two = (L - k1 * E, M - k1 * F), (M - k1 * F, N - k1 * G)
    if one[0] * one[0] + one[1] * one[1] >= two[0] * two[0] + two[1] * two[1]:
        du, dv = -one[1], one[0]
    else:
        du, dv = -two[1], two[0]
    if du * du + dv * dv == 0.0:
        du = 1.0
    return k1, k2, du, dv


def fit_surfaces(xyz: Array, normals: Array, start: NDArray, joined: NDArray) -> tuple[Array, Array]:
    """Principal curvatures (n, 2), the greater first, directions (n, 2, 3); nan where nothing can be fitted.

    Parameters
    ----------
    xyz, normals : (n, 3)
    start, joined : ndarray
        The vertices joined to each: see `vertex_neighbors`.
    """
    principal, directions = np.full((len(xyz), 2), np.nan), np.full((len(xyz), 2, 3), np.nan)
    _fit(
        np.ascontiguousarray(xyz), np.ascontiguousarray(normals), start.astype(np.int64),
        joined.astype(np.int64), principal, directions,
    )  # fmt: skip
    return principal, directions
