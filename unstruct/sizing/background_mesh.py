"""Sizes at the vertices of a mesh: interpolation between them, and a limit of their growth along its edges.

See the book, chapter 2.3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import finite
from ..base.arrays import as_numbers, distinct
from ..base.errors import InputError, MeshError
from ..geometry.edge_vectors import exponents, lengths
from ..geometry.segment_tree import SegmentTree
from ..mesh.mesh import Mesh, is_planar
from ..predicates.batch import orient
from .field import SizeField

__all__ = ["Background", "background", "limit_nodes"]

Array = NDArray[np.float64]


class Background(SizeField):
    """A size that is interpolated linearly in the triangles of a mesh; `background` creates it.

    Attributes
    ----------
    mesh : Mesh
    values : ndarray, shape (n,)
        The sizes at its vertices.
    outside : int
        How many of the points evaluated so far lay outside the mesh. Their size is that at the nearest point
        of its boundary.
    """

    def __init__(self, mesh: Mesh, values: Array):
        self.mesh, self.values, self.outside = mesh, values, 0
        border = mesh.points[mesh.boundary]
        self._border = SegmentTree(border)
        used = distinct(mesh.simplices)
        super().__init__(
            self._interpolate, landmarks=mesh.points[used], name=f"background of {mesh.size} triangles"
        )

    def _interpolate(self, x: Array) -> Array:
        cells = self.mesh.find_simplex(x)
        inside = cells >= 0
        result = np.empty(len(x))
        result[inside] = self._within(cells[inside], x[inside])
        if not inside.all():
            self.outside += int((~inside).sum())
            facet, t = self._border.nearest(x[~inside])
            a, b = self.values[self.mesh.boundary[facet]].T
            result[~inside] = a + t * (b - a)
        return result

    def _within(self, cells: NDArray[np.int32], x: Array) -> Array:
        corners = self.mesh.points[self.mesh.simplices[cells]]
        weights = np.empty((len(x), 3))
        away, exponent = corners - x[:, None], exponents(corners - x[:, None])
        away = np.ldexp(away, -exponent[:, None, None])  # squares of lengths may be beyond the doubles
        for i in range(3):
            a, b = away[:, (i + 1) % 3], away[:, (i + 2) % 3]
            weights[:, i] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        weights /= weights.sum(axis=1, keepdims=True)
        values = self.values[self.mesh.simplices[cells]]
        # The triangle is exact, but the weights are rounded. Clipping to the range of the corner values makes
        # sure that no size is negative.
        return np.clip((weights * values).sum(axis=1), values.min(axis=1), values.max(axis=1))


def _nodal(mesh: Mesh, values: ArrayLike) -> Array:
    """The values as an array; they must be positive at used vertices, and are ignored at all others."""
    if not is_planar(mesh):
        raise MeshError("a background mesh consists of triangles in the plane")
    if mesh.size == 0:
        raise MeshError("a background mesh needs at least one triangle")
    array = as_numbers(values, "values")
    if array.shape != (len(mesh.points),):
        raise InputError(f"give one size per vertex, shape ({len(mesh.points)},), not {array.shape}")
    used = np.zeros(len(array), dtype=bool)
    used[mesh.simplices.ravel()] = True
    bad = used & ~(np.isfinite(array) & (array > 0))
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(
            f"size must be positive and finite: it is {float(array[row])!r} at vertex {row}, "
            f"{mesh.points[row].tolist()}"
        )
    return array


def background(mesh: Mesh, values: ArrayLike) -> Background:
    """A size field from values at the vertices of a background mesh.

    Parameters
    ----------
    mesh : Mesh
        A mesh of triangles in the plane.
    values : array_like, shape (n,)
        The wanted edge length at each vertex. Values at vertices that no triangle uses are ignored.

    Returns
    -------
    Background
        Linear in each triangle. Outside the mesh, and in its holes, it is the size at the nearest point of
        the boundary; `Background.outside` counts how often that happened.

    Raises
    ------
    MeshError, InputError
        For a mesh of anything but triangles in the plane; for a value that is not positive, with its vertex.

    Notes
    -----
    The triangle of a point is found exactly by `Mesh.find_simplex`, in O(log m) per point. Source: the
    chapter's generalized choice of the insertion triangle (12.2.6). See the book, chapter 2.3.
    """
    nodal = _nodal(mesh, values)
    flat = np.nonzero(np.atleast_1d(orient(mesh.corners)) == 0)[0]
    if len(flat):
        raise MeshError(f"triangle {flat[0]} of the background mesh is flat; remove it first")
    return Background(mesh, nodal)


def limit_nodes(mesh: Mesh, values: ArrayLike, growth: float) -> Array:
    """Lower sizes at the vertices of a mesh until no edge is steeper than ``growth``.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane.
    values : array_like, shape (n,)
        The wanted edge length at each vertex.
    growth : float
        The largest change of the size per unit of length along an edge; positive.

    Returns
    -------
    ndarray, shape (n,)
        The largest values that are at most the given ones and satisfy |h_i - h_j| <= growth |x_i - x_j| on
        every edge: h_i = min_j (values_j + growth * (length of the shortest path of edges from i to j)).

    Notes
    -----
    The sizes are found by one run of Dijkstra's algorithm from an additional node that is joined to each
    vertex j by an edge of length values_j / growth, in O(n log n). The bound holds on edges, up to rounding.
    Inside a triangle whose largest angle is gamma, the gradient of the interpolant is at most
    growth / cos(gamma / 2), which is 1.155 times growth in an equilateral triangle. Paths of edges go around
    holes and notches, and are longer than straight lines, so these sizes are nowhere below what `limited`
    would give for the same values.

    Source: Borouchaki, Hecht and Frey, *Mesh gradation control* (1998). See the book, chapter 2.3.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    nodal = _nodal(mesh, values)
    if not finite(growth, "growth") > 0:
        raise InputError(f"growth must be a positive number, not {growth!r}")
    i, j = mesh.edges.T
    length = lengths(mesh.points[i] - mesh.points[j])
    n = len(nodal)
    used = distinct(mesh.simplices)
    ends = np.concatenate([i, np.full(len(used), n)]), np.concatenate([j, used])
    weights = np.concatenate([growth * length, nodal[used]])
    graph = coo_array((weights, ends), shape=(n + 1, n + 1)).tocsr()
    result = nodal
    result[used] = np.minimum(nodal[used], dijkstra(graph, directed=False, indices=n)[used])
    return result
