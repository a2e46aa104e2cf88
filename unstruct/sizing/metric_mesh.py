"""Metrics at the vertices of a background mesh: interpolation, second derivatives, and gradation.

See the book, chapter 3.3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import finite
from ..base.arrays import distinct
from ..base.errors import InputError, MeshError
from ..base.jit import kernel
from ..geometry.segment_tree import SegmentTree
from ..mesh.mesh import Mesh, is_planar
from ..predicates.batch import orient
from .directions import intersected
from .metric import MOST_STRETCH, InverseMetric, symmetric_rows
from .metric_table import inverted, spectrum
from .solution import second_derivatives

__all__ = ["BackgroundMetric", "gradation", "metric_background", "metric_from_hessian"]

Array = NDArray[np.float64]
SPACES = ("metric", "plane")
MOST_SWEEPS = 1000  # over all edges
LEAST_CHANGE = 1e-9  # a sweep that shortens no length by more than this, relatively, is the last one


class BackgroundMetric(InverseMetric):
    """A metric whose inverse is interpolated linearly in the triangles of a mesh.

    Attributes
    ----------
    mesh : Mesh
    values : ndarray, shape (n, 2, 2)
        The matrices at its vertices; the identity at those that no triangle uses.
    outside : int
        How many of the points evaluated so far lay outside the mesh. They take the metric at the nearest
        point of its boundary.
    """

    def __init__(self, mesh: Mesh, rows: Array):
        self.mesh, self.outside = mesh, 0
        self.values = rows[:, [[0, 1], [1, 2]]]
        self._inverse = inverted(rows)
        self._border = SegmentTree(mesh.points[mesh.boundary])
        marks = mesh.points[distinct(mesh.simplices)]
        super().__init__(self._interpolate, landmarks=marks, name=f"background of {mesh.size} triangles")

    def _interpolate(self, x: Array) -> Array:
        cells = self.mesh.find_simplex(x)
        inside = cells >= 0
        result = np.empty((len(x), 3))
        rows = self.mesh.simplices[cells[inside]]
        corners = self.mesh.points[rows]
        weights = np.empty((len(rows), 3))
        for i in range(3):
            a, b = corners[:, (i + 1) % 3] - x[inside], corners[:, (i + 2) % 3] - x[inside]
            weights[:, i] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        # The triangle is exact, but the weights are rounded: none may be negative.
        weights = np.maximum(weights / weights.sum(axis=1, keepdims=True), 0.0)
        weights /= weights.sum(axis=1, keepdims=True)
        result[inside] = np.einsum("kc,kcj->kj", weights, self._inverse[rows])
        if not inside.all():
            self.outside += int((~inside).sum())
            facet, t = self._border.nearest(x[~inside])
            a, b = self._inverse[self.mesh.boundary[facet]].transpose(1, 0, 2)
            result[~inside] = (1 - t)[:, None] * a + t[:, None] * b
        return result


def metric_background(mesh: Mesh, values: ArrayLike) -> BackgroundMetric:
    """A metric from matrices at the vertices of a background mesh.

    Parameters
    ----------
    mesh : Mesh
        A mesh of triangles in the plane.
    values : array_like, shape (n, 2, 2)
        A symmetric positive definite matrix for each vertex. Those of vertices that no triangle uses are
        ignored.

    Returns
    -------
    BackgroundMetric
        In each triangle the inverse matrices are interpolated linearly. Such a mean is positive definite,
        and no length is below those at the corners. Outside the mesh, and in its holes, it is the metric at
        the nearest point of the boundary.

    Raises
    ------
    MeshError, InputError
        For a mesh of anything but triangles in the plane; for a matrix that is not positive definite, with
        its row.
    """
    if not is_planar(mesh) or mesh.size == 0:
        raise MeshError("a background mesh consists of triangles in the plane, at least one")
    flat = np.nonzero(np.atleast_1d(orient(mesh.corners)) == 0)[0]
    if len(flat):
        raise MeshError(f"triangle {flat[0]} of the background mesh is flat; remove it first")
    array = np.array(values, dtype=np.float64)
    if array.shape != (len(mesh.points), 2, 2):
        raise InputError(f"give one matrix per vertex, shape ({len(mesh.points)}, 2, 2), not {array.shape}")
    unused = np.ones(len(array), dtype=bool)
    unused[mesh.simplices.ravel()] = False
    array[unused] = np.eye(2)
    return BackgroundMetric(mesh, symmetric_rows(array, "metric", mesh.points))


def metric_from_hessian(
    mesh: Mesh, second: ArrayLike, error: float, *, lower: float, upper: float, ratio: float = 1000.0
) -> BackgroundMetric:
    """The metric for which linear interpolation of a function has about the same, wanted error everywhere.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane.
    second : array_like, shape (n, 2, 2)
        Second derivatives at the vertices, for example from `hessian`.
    error : float
        The largest pointwise error that is allowed.
    lower, upper : float
        Bounds of the lengths.
    ratio : float
        The largest ratio of the two lengths at a place.

    Returns
    -------
    BackgroundMetric
        The direction of each length is an eigenvector of the second derivatives, with eigenvalue k; the
        length is sqrt(6 error / |k|), clipped to the bounds.

    Raises
    ------
    MeshError, InputError
        For anything but triangles in the plane; for derivatives that are not finite, with their vertex, and
        for bounds that are not positive or not in order.

    Notes
    -----
    A triangle that is equilateral with edges 1 in this metric has at most the error of an equilateral one of
    edge h = sqrt(6 error / k) under second derivatives k in all directions; see `from_hessian`. Where the
    function bends in one direction only, the other one gets long edges. Source: F. Alauzet, A. Loseille,
    Computer-Aided Design 72 (2016) 13-39. Book: 3.3.
    """
    if not is_planar(mesh) or mesh.size == 0:
        raise MeshError("metrics from a solution need a mesh of triangles in the plane")
    array = second_derivatives(mesh, second, error, lower, upper)
    if not 1 <= finite(ratio, "ratio") <= MOST_STRETCH:
        raise InputError(f"ratio must lie between 1 and {MOST_STRETCH:g}, not {ratio!r}")
    values, vectors = np.linalg.eigh((array + array.transpose(0, 2, 1)) / 2)
    with np.errstate(divide="ignore"):
        length = np.clip(np.sqrt(6.0 * error / np.abs(values)), lower, upper)
    length = np.minimum(length, ratio * length.min(axis=1, keepdims=True))
    matrices = np.einsum("nij,nj,nkj->nik", vectors, 1.0 / (length * length), vectors)
    return metric_background(mesh, matrices)


def gradation(metric: BackgroundMetric, growth: float, *, space: str = "metric") -> BackgroundMetric:
    """Shorten the lengths of a background metric until they grow slowly along all edges of its mesh.

    Parameters
    ----------
    metric : BackgroundMetric
    growth : float
        How fast lengths may grow; positive.
    space : "metric" or "plane"
        In which sense. "metric": both lengths h grow by the factor 1 + growth L over an edge of metric length
        L, so that their ratio stays. "plane": each grows by growth times the length of the edge in the plane,
        as sizes do, so that the metric becomes the same in all directions far away.

    Returns
    -------
    BackgroundMetric
        At each vertex the intersection of its metric with those of its neighbors after they have grown,
        repeated until nothing changes (at most 1000 times).

    Raises
    ------
    InputError
        For a growth that is not positive and finite, and for anything but a background metric.

    Notes
    -----
    O(n) a sweep; a sweep takes the edges in order, the next one in reverse. Source: F. Alauzet, Finite
    Elements in Analysis and Design 46 (2010) 181-202. Book: 3.3.
    """
    if not isinstance(metric, BackgroundMetric):
        raise InputError(f"gradation needs a metric of `metric_background`, not {metric!r:.60}")
    if not finite(growth, "growth") > 0:
        raise InputError(f"growth must be a positive number, not {growth!r}")
    if not isinstance(space, str) or space not in SPACES:
        raise InputError(f"space = {space!r} must be one of {', '.join(map(repr, SPACES))}")
    rows = np.ascontiguousarray(metric.values.reshape(-1, 4)[:, [0, 1, 3]])
    edges = np.ascontiguousarray(metric.mesh.edges, dtype=np.int64)
    for sweep in range(MOST_SWEEPS):
        if _sweep(metric.mesh.points, edges, rows, growth, SPACES.index(space), sweep % 2) <= LEAST_CHANGE:
            break
    large, small = spectrum(rows)
    del large
    if not (small > 0).all():
        row = int(np.argmin(small))
        raise InputError(f"the metric at vertex {row} is too stretched for a gradation; bound its ratio")
    return BackgroundMetric(metric.mesh, rows)


@kernel
def _sweep(x, edges, rows, growth, space, backward):
    """Intersect the metrics at both ends of each edge; return the largest relative change of an area."""
    most = 0.0
    for n in range(len(edges)):
        row = len(edges) - 1 - n if backward else n
        for turn in range(2):
            i, j = edges[row, turn], edges[row, 1 - turn]
            dx, dy = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1]
            a, b, c = rows[i, 0], rows[i, 1], rows[i, 2]
            if space == 0:
                grown = 1.0 + growth * np.sqrt(max(a * dx * dx + 2.0 * b * dx * dy + c * dy * dy, 0.0))
                a, b, c = a / grown / grown, b / grown / grown, c / grown / grown
            else:
                # The eigenvalues m become m / (1 + growth |dx| sqrt(m))^2; the directions stay.
                mean, half = 0.5 * (a + c), np.hypot(0.5 * (a - c), b)
                large = mean + half
                small = max((a / large) * c - (b / large) * b, 1e-15 * large)
                far = growth * np.hypot(dx, dy)
                one = large / (1.0 + far * np.sqrt(large)) ** 2
                two = small / (1.0 + far * np.sqrt(small)) ** 2
                share = (one - two) / (2.0 * half) if half > 0.0 else 0.0
                middle = 0.5 * (one + two)
                a, b, c = middle + share * 0.5 * (a - c), share * b, middle - share * 0.5 * (a - c)
            p, q, r = rows[j, 0], rows[j, 1], rows[j, 2]
            rows[j, 0], rows[j, 1], rows[j, 2] = intersected(p, q, r, a, b, c)
            before, after = p * r - q * q, rows[j, 0] * rows[j, 2] - rows[j, 1] * rows[j, 1]
            if before > 0.0:
                most = max(most, after / before - 1.0)
    return most
