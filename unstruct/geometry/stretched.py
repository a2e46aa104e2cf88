"""Factors of inverse metrics in space, and cells whose vertices carry an inverse metric, compiled.

The inverse metric B = sum h_i^2 d_i d_i' has the factor L, B = L L', lower triangular; the vector L w has the
image w, and metric lengths are those of images. Six numbers b11, b21, b22, b31, b32, b33 stand for B. Where
rows of coordinates have nine columns, the last six are B at the vertex; that of a cell is the mean of its
vertices', positive definite as a mean of such matrices. Book: 3.3, 3.5.
"""

from __future__ import annotations

import numpy as np

from ..base.jit import apart, inline

__all__ = ["METRIC_COLUMNS", "cholesky", "metric_badness", "metric_gradient"]

METRIC_COLUMNS = 9  # of rows of coordinates with a metric
LEAST_PIVOT = 1e-14  # of Cholesky's factor, squared and relative: rounding may leave nothing


@inline
def cholesky(b1, b2, b3, b4, b5, b6):
    """The factor L of the matrix with rows (b1, ., .), (b2, b3, .), (b4, b5, b6), in the same order."""
    a = np.sqrt(b1)
    b = b2 / a
    c = np.sqrt(max(b3 - b * b, LEAST_PIVOT * b3))
    d = b4 / a
    e = (b5 - b * d) / c
    f = np.sqrt(max(b6 - d * d - e * e, LEAST_PIVOT * b6))
    return a, b, c, d, e, f


@inline
def _factor_of_cell(xyz, a, b, c, d):
    """The factor of the mean inverse metric of four vertices."""
    return cholesky(
        0.25 * (xyz[a, 3] + xyz[b, 3] + xyz[c, 3] + xyz[d, 3]),
        0.25 * (xyz[a, 4] + xyz[b, 4] + xyz[c, 4] + xyz[d, 4]),
        0.25 * (xyz[a, 5] + xyz[b, 5] + xyz[c, 5] + xyz[d, 5]),
        0.25 * (xyz[a, 6] + xyz[b, 6] + xyz[c, 6] + xyz[d, 6]),
        0.25 * (xyz[a, 7] + xyz[b, 7] + xyz[c, 7] + xyz[d, 7]),
        0.25 * (xyz[a, 8] + xyz[b, 8] + xyz[c, 8] + xyz[d, 8]),
    )


@inline
def _image(m, xyz, a, o):
    """The image of the vector from vertex o to vertex a."""
    x = (xyz[a, 0] - xyz[o, 0]) / m[0]
    y = (xyz[a, 1] - xyz[o, 1] - m[1] * x) / m[2]
    return x, y, (xyz[a, 2] - xyz[o, 2] - m[3] * x - m[4] * y) / m[5]


@inline
def _six_and_mean(u, v, w):
    """Six volumes and the mean squared edge of the cell of 0, u, v and w."""
    six = (
        u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
    )
    total = 0.0
    for j in range(3):
        total += u[j] * u[j] + v[j] * v[j] + w[j] * w[j]
        total += (u[j] - v[j]) ** 2 + (v[j] - w[j]) ** 2 + (w[j] - u[j]) ** 2
    return six, total / 6.0


@apart
def metric_badness(xyz, a, b, c, d):
    """`connect.spatial.costs.badness` in the metric that the vertices carry."""
    m = _factor_of_cell(xyz, a, b, c, d)
    six, mean = _six_and_mean(_image(m, xyz, b, a), _image(m, xyz, c, a), _image(m, xyz, d, a))
    cube = mean * np.sqrt(mean)
    return 1.0 if cube <= 0.0 else 1.0 - np.sqrt(2.0) * six / cube


@apart
def metric_gradient(xyz, p, a, b, c, step):
    """Write the direction in which a move of p helps the cell a, b, c, p most, as long as its mean edge.

    The gradient is that in the space of images. False if there is none.
    """
    m = _factor_of_cell(xyz, p, a, b, c)
    u, v, w = _image(m, xyz, a, p), _image(m, xyz, b, p), _image(m, xyz, c, p)
    six, mean = _six_and_mean(u, v, w)  # of the cell p, a, b, c: a, b, c, p has the other sign
    if not mean > 0.0:
        return False
    for j in range(3):
        i, h = (j + 1) % 3, (j + 2) % 3
        normal = (v[i] - u[i]) * (w[h] - u[h]) - (v[h] - u[h]) * (w[i] - u[i])
        step[j] = normal - 0.5 * six / mean * (u[j] + v[j] + w[j])
    length = step[0] ** 2 + step[1] ** 2 + step[2] ** 2
    if not length > 0.0:
        return False
    scale = np.sqrt(mean / length)
    x, y, z = scale * step[0], scale * step[1], scale * step[2]
    step[0] = m[0] * x
    step[1] = m[1] * x + m[2] * y
    step[2] = m[3] * x + m[4] * y + m[5] * z
    return True
