"""Metrics at the vertices of a mesh of tetrahedra: logarithms are interpolated, and growth is limited.

The mean of logarithms has no length beyond those at the corners, and no larger ratio; with the mean of the
matrices, or of their inverses, the ellipsoids of two thin metrics that are turned against each other swell.
Source: V. Arsigny et al., Magnetic Resonance in Medicine 56 (2006) 411-421. Book: 3.3, 3.5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import distinct
from ..base.jit import apart, kernel
from ..geometry.stretched import cholesky
from ..geometry.triangle_tree import TriangleTree
from ..mesh.mesh import Mesh
from .background_mesh import weights_in_cells
from .space_metric import InverseSpaceMetric
from .space_spectrum import (
    ENTRY_OF_MATRIX,
    IN_ROW,
    diagonal_in_space,
    diagonalize,
    inverted_in_space,
    keep_shorter,
    logarithms_in_space,
    means_in_space,
    seen_from,
)

__all__ = ["BackgroundSpaceMetric", "graded_in_space"]

Array = NDArray[np.float64]
SWEEPS_IN_SPACE = 1000  # over all edges
NOT_SHORTER = 1e-9  # lengths that shrink by less than that, relatively, stay as they are


class BackgroundSpaceMetric(InverseSpaceMetric):
    """A metric whose logarithm is interpolated linearly in the tetrahedra of a mesh.

    Attributes
    ----------
    mesh : Mesh
    values : ndarray, shape (n, 3, 3)
        The matrices at its vertices; the identity at those that no tetrahedron uses.
    outside : int
        How many of the points evaluated so far lay outside the mesh. They take the metric at the nearest
        point of its boundary.
    """

    def __init__(self, mesh: Mesh, rows: Array):
        self.mesh, self.outside = mesh, 0
        self.values = rows[:, ENTRY_OF_MATRIX]
        self._logarithms = np.empty(rows.shape)
        logarithms_in_space(np.ascontiguousarray(rows), self._logarithms)
        self._border = TriangleTree(mesh.points[mesh.boundary])
        marks = mesh.points[distinct(mesh.simplices)]
        super().__init__(self._interpolate, landmarks=marks, name=f"background of {mesh.size} tetrahedra")

    def _interpolate(self, x: Array) -> Array:
        cells = self.mesh.find_simplex(x)
        inside = cells >= 0
        vertices, weights = np.zeros((len(x), 4), dtype=np.int64), np.zeros((len(x), 4))
        vertices[inside] = rows = self.mesh.simplices[cells[inside]]
        weights[inside] = weights_in_cells(self.mesh.points[rows], x[inside])
        if not inside.all():
            self.outside += int((~inside).sum())
            facet, place = self._border.nearest(x[~inside])
            vertices[~inside, :3], weights[~inside, :3] = self.mesh.boundary[facet], place
        weights = np.maximum(weights, 0.0)  # they are rounded
        weights /= weights.sum(axis=1, keepdims=True)
        result = np.empty((len(x), 6))
        means_in_space(self._logarithms, vertices, weights, result)
        return result


def graded_in_space(metric: BackgroundSpaceMetric, growth: float, in_metric: bool) -> BackgroundSpaceMetric:
    """`gradation` of a metric in space."""
    mesh = metric.mesh
    rows = metric.values[:, IN_ROW[0], IN_ROW[1]]
    inverse = inverted_in_space(rows)
    before = inverse.copy()
    edges = np.ascontiguousarray(mesh.edges, dtype=np.int64)
    for sweep in range(SWEEPS_IN_SPACE):
        if not _sweep_in_space(mesh.points, edges, inverse, growth, in_metric, sweep % 2):
            break
    changed = (inverse != before).any(axis=1)
    rows[changed] = inverted_in_space(inverse[changed])
    return BackgroundSpaceMetric(mesh, rows)


@apart
def _grown(row, d, root, growth, in_metric, a, v, into):
    """Write the inverse metric ``row``, B = L L' with the factor ``root``, as it may be a vector d away."""
    if in_metric:
        x = d[0] / root[0]
        y = (d[1] - root[1] * x) / root[2]
        z = (d[2] - root[3] * x - root[4] * y) / root[5]
        grown = 1.0 + growth * np.sqrt(x * x + y * y + z * z)
        for k in range(6):
            into[k] = row[k] * grown * grown
        return
    far = growth * np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    diagonal_in_space(row, a, v)
    for k in range(6):
        into[k] = 0.0
    for n in range(3):
        h = np.sqrt(max(a[n, n], 0.0)) + far
        x, y, z = h * v[n, 0], h * v[n, 1], h * v[n, 2]
        into[0] += x * x
        into[1] += x * y
        into[2] += y * y
        into[3] += x * z
        into[4] += y * z
        into[5] += z * z


@apart
def _factor_of(row, root):
    """Write the factor L of B = L L'."""
    a, b, c, d, e, f = cholesky(row[0], row[1], row[2], row[3], row[4], row[5])
    root[0], root[1], root[2] = a, b, c
    root[3], root[4], root[5] = d, e, f


@kernel
def _sweep_in_space(x, edges, rows, growth, in_metric, backward):
    """Intersect the metrics at both ends of each edge, given by their inverses; whether a length shrinks."""
    a, v, w = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    d, root, other = np.empty(3), np.empty(6), np.empty(6)
    shorter = False
    for n in range(edges.shape[0]):
        row = edges.shape[0] - 1 - n if backward else n
        for turn in range(2):
            i, j = edges[row, turn], edges[row, 1 - turn]
            for k in range(3):
                d[k] = x[j, k] - x[i, k]
            _factor_of(rows[i], root)
            _grown(rows[i], d, root, growth, in_metric, a, v, other)
            _factor_of(rows[j], root)
            seen_from(root, other, a, w)
            diagonalize(a, v)
            if min(a[0, 0], min(a[1, 1], a[2, 2])) < 1.0 - NOT_SHORTER:
                keep_shorter(root, a, v, rows[j])
                shorter = True
    return shorter
