"""Metrics at the vertices of a background mesh: interpolation, second derivatives, and gradation.

See the book, chapter 3.3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import finite
from ..base.arrays import as_numbers, distinct
from ..base.errors import InputError, MeshError
from ..base.jit import kernel
from ..geometry.segment_tree import SegmentTree
from ..mesh.mesh import Mesh
from .background_mesh import fills_its_space, refuse_flat, weights_in_cells
from .directions import intersected
from .metric import MOST_STRETCH, InverseMetric, symmetric_rows
from .metric_table import inverted, spectrum
from .solution import second_derivatives
from .space_metric import MOST_SPACE_STRETCH, matrix_rows
from .space_metric_mesh import BackgroundSpaceMetric, graded_in_space
from .space_spectrum import IN_ROW, spectrum_in_space

__all__ = ["BackgroundMetric", "gradation", "metric_background", "metric_from_hessian"]

Array = NDArray[np.float64]
SPACES = {2: ("metric", "plane"), 3: ("metric", "space")}
MOST_SWEEPS = 1000  # over all edges
UNEVEN_BY_ROUNDING = 2.0**-30  # by what entries across the diagonal may differ, as a share of the largest one
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
        # The triangle is exact, but the weights are rounded: none may be negative.
        weights = np.maximum(weights_in_cells(self.mesh.points[rows], x[inside]), 0.0)
        weights /= weights.sum(axis=1, keepdims=True)
        result[inside] = np.einsum("kc,kcj->kj", weights, self._inverse[rows])
        if not inside.all():
            self.outside += int((~inside).sum())
            facet, t = self._border.nearest(x[~inside])
            a, b = self._inverse[self.mesh.boundary[facet]].transpose(1, 0, 2)
            result[~inside] = (1 - t)[:, None] * a + t[:, None] * b
        return result


def metric_background(mesh: Mesh, values: ArrayLike) -> BackgroundMetric | BackgroundSpaceMetric:
    """A metric from matrices at the vertices of a background mesh.

    Parameters
    ----------
    mesh : Mesh
        A mesh of triangles in the plane, or of tetrahedra in space.
    values : array_like, shape (n, d, d)
        A symmetric positive definite matrix for each vertex. Those of vertices that no cell uses are ignored.

    Returns
    -------
    BackgroundMetric, or BackgroundSpaceMetric for tetrahedra
        In each triangle the inverse matrices are interpolated linearly. Such a mean is positive definite,
        and no length is below those at the corners. In each tetrahedron the logarithms of the matrices are:
        no length is beyond those at the corners, and no ratio above theirs. Outside the mesh, and in its
        holes, it is the metric at the nearest point of the boundary.

    Raises
    ------
    MeshError, InputError
        For a mesh of anything else; for a matrix that is not positive definite, with its row.

    Notes
    -----
    O(log m) per point for m cells. Source for logarithms: V. Arsigny et al., Magnetic Resonance in Medicine
    56 (2006) 411-421. Book: 3.3, 3.5.
    """
    if not fills_its_space(mesh) or mesh.size == 0:
        raise MeshError(
            "a background mesh consists of triangles in the plane or tetrahedra in space, at least one"
        )
    refuse_flat(mesh)
    array, d = as_numbers(values, "values").copy(), mesh.dimension
    if array.shape != (len(mesh.points), d, d):
        raise InputError(
            f"give one matrix per vertex, shape ({len(mesh.points)}, {d}, {d}), not {array.shape}"
        )
    unused = np.ones(len(array), dtype=bool)
    unused[mesh.simplices.ravel()] = False
    array[unused] = np.eye(d)
    if d == 2:
        return BackgroundMetric(mesh, symmetric_rows(array, "metric", mesh.points))
    return BackgroundSpaceMetric(mesh, matrix_rows(array, mesh.points))


def metric_from_hessian(
    mesh: Mesh, second: ArrayLike, error: float, *, lower: float, upper: float, ratio: float = 1000.0
) -> BackgroundMetric | BackgroundSpaceMetric:
    """The metric for which linear interpolation of a function has about the same, wanted error everywhere.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane, or tetrahedra in space.
    second : array_like, shape (n, d, d)
        Second derivatives at the vertices, for example from `hessian`.
    error : float
        The largest pointwise error that is allowed.
    lower, upper : float
        Bounds of the lengths.
    ratio : float
        The largest ratio of two lengths at a place.

    Returns
    -------
    BackgroundMetric, or BackgroundSpaceMetric for tetrahedra
        The direction of each length is an eigenvector of the second derivatives, with eigenvalue k; the
        length is sqrt(6 error / |k|) in the plane and sqrt(16 error / (3 |k|)) in space, clipped to the
        bounds.

    Raises
    ------
    MeshError, InputError
        For any other mesh; for derivatives that are not finite, or not symmetric up to rounding, with their
        vertex, and for bounds that are not positive or not in order.

    Notes
    -----
    A simplex that is regular with edges 1 in this metric has at most the error of a regular one of edge h
    under second derivatives k in all directions, where h is the length above; see `from_hessian`. Where the
    function bends in one direction only, the others get long edges. Source: F. Alauzet, A. Loseille,
    Computer-Aided Design 72 (2016) 13-39. Book: 3.3, 3.5.
    """
    if not fills_its_space(mesh) or mesh.size == 0:
        raise MeshError("metrics from a solution need triangles in the plane or tetrahedra in space")
    array, d = second_derivatives(mesh, second, error, lower, upper), mesh.dimension
    most = MOST_STRETCH if d == 2 else MOST_SPACE_STRETCH
    if not 1 <= finite(ratio, "ratio") <= most:
        raise InputError(f"ratio must lie between 1 and {most:g}, not {ratio!r}")
    even = _symmetric(array)
    if d == 2:
        values, vectors = np.linalg.eigh(even)
    else:
        values, vectors = spectrum_in_space(even[:, IN_ROW[0], IN_ROW[1]])
        vectors = vectors.transpose(0, 2, 1)
    with np.errstate(divide="ignore"):
        # a regular simplex of d dimensions and edges h has R^2 = h^2 d / (2 (d + 1))
        length = np.clip(np.sqrt(4.0 * (d + 1) / d * error / np.abs(values)), lower, upper)
    length = np.minimum(length, ratio * length.min(axis=1, keepdims=True))
    matrices = np.einsum("nij,nj,nkj->nik", vectors, 1.0 / (length * length), vectors)
    return metric_background(mesh, matrices)


def _symmetric(second: NDArray[np.float64]) -> NDArray[np.float64]:
    """The means of matrices (n, d, d) and their transposes, which may differ by rounding."""
    turned = second.transpose(0, 2, 1)
    size = np.abs(second).max(axis=(1, 2), initial=0.0)
    apart = np.abs(second / 2 - turned / 2).max(axis=(1, 2), initial=0.0)
    if (apart > UNEVEN_BY_ROUNDING * size).any():
        row = int(np.argmax(apart > UNEVEN_BY_ROUNDING * size))
        raise InputError(
            f"the second derivatives at vertex {row} are {second[row].tolist()}; they must be symmetric"
        )
    even: NDArray[np.float64] = second / 2 + turned / 2
    return even


def gradation(
    metric: BackgroundMetric | BackgroundSpaceMetric, growth: float, *, space: str = "metric"
) -> BackgroundMetric | BackgroundSpaceMetric:
    """Shorten the lengths of a background metric until they grow slowly along all edges of its mesh.

    Parameters
    ----------
    metric : BackgroundMetric or BackgroundSpaceMetric
    growth : float
        How fast lengths may grow; positive.
    space : "metric", or "plane" in the plane and "space" in space
        In which sense. "metric": all lengths h grow by the factor 1 + growth L over an edge of metric length
        L, so that their ratios stay. Else each grows by growth times the usual length of the edge, as sizes
        do, so that the metric becomes the same in all directions far away.

    Returns
    -------
    BackgroundMetric or BackgroundSpaceMetric
        At each vertex the intersection of its metric with those of its neighbors after they have grown,
        repeated until nothing changes (at most 1000 times).

    Raises
    ------
    InputError
        For a growth that is not positive and finite, and for anything but a background metric.

    Notes
    -----
    O(n) a sweep; a sweep takes the edges in order, the next one in reverse. Source: F. Alauzet, Finite
    Elements in Analysis and Design 46 (2010) 181-202. Book: 3.3, 3.5.
    """
    if not isinstance(metric, BackgroundMetric | BackgroundSpaceMetric):
        raise InputError(f"gradation needs a metric of `metric_background`, not {metric!r:.60}")
    if not finite(growth, "growth") > 0:
        raise InputError(f"growth must be a positive number, not {growth!r}")
    spaces = SPACES[metric.dimension]
    if not isinstance(space, str) or space not in spaces:
        raise InputError(f"space = {space!r} must be one of {', '.join(map(repr, spaces))}")
    if isinstance(metric, BackgroundSpaceMetric):
        return graded_in_space(metric, growth, space == "metric")
    rows = np.ascontiguousarray(metric.values.reshape(-1, 4)[:, [0, 1, 3]])
    edges = np.ascontiguousarray(metric.mesh.edges, dtype=np.int64)
    for sweep in range(MOST_SWEEPS):
        if _sweep(metric.mesh.points, edges, rows, growth, spaces.index(space), sweep % 2) <= LEAST_CHANGE:
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
