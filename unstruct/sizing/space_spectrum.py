"""Eigenvalues, inverses and intersections of symmetric matrices with three rows, by rotations. Book: 3.3.

A matrix is a row of six numbers b11, b21, b22, b31, b32, b33. Rotations need no more than square roots, so
results are the same on every processor. Source: C. G. J. Jacobi, J. reine angew. Math. 30 (1846) 51-94.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.elementary import exponential, logarithm
from ..base.jit import apart, inline, kernel

__all__ = [
    "ENTRY_OF_MATRIX", "IN_ROW", "diagonal_in_space", "diagonalize", "intersect_in_space",
    "inverted_in_space", "keep_shorter", "logarithms_in_space", "means_in_space", "seen_from",
    "spectrum_in_space",
]  # fmt: skip

Array = NDArray[np.float64]
ENTRY_OF_MATRIX = np.array([[0, 1, 3], [1, 2, 4], [3, 4, 5]])  # the matrix of a row
IN_ROW = (np.array([0, 1, 1, 2, 2, 2]), np.array([0, 0, 1, 0, 1, 2]))
JACOBI_SWEEPS = 12  # of rotations; each squares what is left, roughly


@inline
def _rotate(a, v, p, q, r):
    """One rotation of Jacobi's method, which makes a[p, q] zero; r is the third index."""
    if a[p, q] == 0.0:
        return
    theta = (a[q, q] - a[p, p]) / (2.0 * a[p, q])
    t = 1.0 / (abs(theta) + np.sqrt(theta * theta + 1.0))
    if theta < 0.0:
        t = -t
    c = 1.0 / np.sqrt(t * t + 1.0)
    s = t * c
    a[p, p] -= t * a[p, q]
    a[q, q] += t * a[p, q]
    a[p, q] = a[q, p] = 0.0
    x, y = a[r, p], a[r, q]
    a[r, p] = a[p, r] = c * x - s * y
    a[r, q] = a[q, r] = s * x + c * y
    for k in range(3):
        x, y = v[p, k], v[q, k]
        v[p, k], v[q, k] = c * x - s * y, s * x + c * y


@inline
def diagonalize(a, v):
    """Make the symmetric matrix a diagonal by rotations; the rows of v become the eigenvectors."""
    for k in range(3):
        for j in range(3):
            v[k, j] = 1.0 if k == j else 0.0
    for _ in range(JACOBI_SWEEPS):
        _rotate(a, v, 0, 1, 2)
        _rotate(a, v, 0, 2, 1)
        _rotate(a, v, 1, 2, 0)


@apart
def diagonal_in_space(row, a, v):
    """Make ``a`` the diagonal matrix of the eigenvalues of a row, and the rows of v its eigenvectors."""
    a[0, 0], a[1, 1], a[2, 2] = row[0], row[2], row[5]
    a[0, 1] = a[1, 0] = row[1]
    a[0, 2] = a[2, 0] = row[3]
    a[1, 2] = a[2, 1] = row[4]
    diagonalize(a, v)


@inline
def _add_square(into, share, x, y, z):
    """Add a share of the matrix of all products of two of x, y, z."""
    into[0] += share * x * x
    into[1] += share * x * y
    into[2] += share * y * y
    into[3] += share * x * z
    into[4] += share * y * z
    into[5] += share * z * z


@kernel
def _spectra(rows, values, vectors):
    a = np.empty((3, 3))
    for i in range(rows.shape[0]):
        diagonal_in_space(rows[i], a, vectors[i])
        for k in range(3):
            values[i, k] = a[k, k]


def spectrum_in_space(rows: Array) -> tuple[Array, Array]:
    """Eigenvalues (k, 3), the largest first, and eigenvectors as rows (k, 3, 3), of matrices (k, 6)."""
    values, vectors = np.empty((len(rows), 3)), np.empty((len(rows), 3, 3))
    size = np.abs(rows).max(axis=1, initial=0.0)
    size = np.where(size > 0.0, size, 1.0)
    _spectra(rows / size[:, None], values, vectors)
    order = np.argsort(-values, axis=1, kind="stable")
    with np.errstate(over="ignore"):  # then an eigenvalue is larger than all doubles
        values = np.take_along_axis(values, order, axis=1) * size[:, None]
    return values, np.take_along_axis(vectors, order[:, :, None], axis=1)


def inverted_in_space(rows: Array) -> Array:
    """The inverses of positive definite matrices, (k, 6) -> (k, 6)."""
    values, vectors = spectrum_in_space(rows)
    result = np.zeros((len(rows), 6))
    for k in range(3):
        result += vectors[:, k, IN_ROW[0]] * vectors[:, k, IN_ROW[1]] / values[:, k, None]
    return result


@apart
def seen_from(root, other, a, w):
    """Write the matrix L^-1 B L^-T into ``a``; ``root`` is the row of L, and ``other`` that of B."""
    l = root
    for k in range(3):  # w = L^-1 other
        for j in range(3):
            high, low = max(k, j), min(k, j)
            w[k, j] = other[high * (high + 1) // 2 + low]
    for j in range(3):
        w[0, j] = w[0, j] / l[0]
        w[1, j] = (w[1, j] - l[1] * w[0, j]) / l[2]
        w[2, j] = (w[2, j] - l[3] * w[0, j] - l[4] * w[1, j]) / l[5]
    for k in range(3):
        a[k, 0] = w[k, 0] / l[0]
        a[k, 1] = (w[k, 1] - l[1] * a[k, 0]) / l[2]
        a[k, 2] = (w[k, 2] - l[3] * a[k, 0] - l[4] * a[k, 1]) / l[5]
    for k in range(3):
        for j in range(k):
            a[k, j] = a[j, k] = 0.5 * (a[k, j] + a[j, k])


@apart
def keep_shorter(root, a, v, into):
    """Write L A L' as a row; A has the eigenvectors v, and the eigenvalues of ``a``, but none above 1."""
    l = root
    for k in range(6):
        into[k] = 0.0
    for n in range(3):
        x = l[0] * v[n, 0]
        y = l[1] * v[n, 0] + l[2] * v[n, 1]
        z = l[3] * v[n, 0] + l[4] * v[n, 1] + l[5] * v[n, 2]
        _add_square(into, min(a[n, n], 1.0), x, y, z)


@kernel
def intersect_in_space(into, root, other):
    """Replace each B of ``into``, rows (k, 6), by that of its intersection with ``other``; B = root root'."""
    a, v, w = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(into.shape[0]):
        seen_from(root[i], other[i], a, w)
        diagonalize(a, v)
        keep_shorter(root[i], a, v, into[i])


@kernel
def logarithms_in_space(rows, result):
    """Write the logarithms of positive definite matrices, rows (k, 6)."""
    a, v = np.empty((3, 3)), np.empty((3, 3))
    for i in range(rows.shape[0]):
        diagonal_in_space(rows[i], a, v)
        for k in range(6):
            result[i, k] = 0.0
        for n in range(3):
            _add_square(result[i], logarithm(a[n, n]), v[n, 0], v[n, 1], v[n, 2])


@kernel
def means_in_space(logs, vertices, weights, result):
    """Write exp(-L), rows (k, 6), for weighted sums L of some rows of ``logs``, as ``vertices`` name them."""
    a, v, mean = np.empty((3, 3)), np.empty((3, 3)), np.empty(6)
    for i in range(result.shape[0]):
        for k in range(6):
            mean[k] = result[i, k] = 0.0
            for j in range(vertices.shape[1]):
                mean[k] += weights[i, j] * logs[vertices[i, j], k]
        diagonal_in_space(mean, a, v)
        for n in range(3):
            _add_square(result[i], exponential(-a[n, n]), v[n, 0], v[n, 1], v[n, 2])
