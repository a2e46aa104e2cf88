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
from ..geometry.triangle_tree import TriangleTree
from ..mesh.mesh import Mesh, is_planar
from ..predicates.batch import orient
from .field import SizeField

__all__ = ["Background", "background", "fills_its_space", "limit_nodes", "refuse_flat", "weights_in_cells"]

Array = NDArray[np.float64]


class Background(SizeField):
    """A size that is interpolated linearly in the cells of a mesh; `background` creates it.

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
        corners = mesh.points[mesh.boundary]
        self._border = SegmentTree(corners) if mesh.dimension == 2 else TriangleTree(corners)
        used = distinct(mesh.simplices)
        cells = "triangles" if mesh.dimension == 2 else "tetrahedra"
        super().__init__(
            self._interpolate, landmarks=mesh.points[used], name=f"background of {mesh.size} {cells}"
        )

    def _interpolate(self, x: Array) -> Array:
        cells = self.mesh.find_simplex(x)
        inside = cells >= 0
        result = np.empty(len(x))
        result[inside] = self._within(cells[inside], x[inside])
        if not inside.all():
            self.outside += int((~inside).sum())
            facet, place = self._border.nearest(x[~inside])
            values = self.values[self.mesh.boundary[facet]]
            if self.mesh.dimension == 2:
                result[~inside] = values[:, 0] + place * (values[:, 1] - values[:, 0])
            else:
                result[~inside] = (values * place).sum(axis=1)
        return result

    def _within(self, cells: NDArray[np.int32], x: Array) -> Array:
        rows = self.mesh.simplices[cells]
        weights, values = weights_in_cells(self.mesh.points[rows], x), self.values[rows]
        # The cell is exact, but the weights are rounded. Clipping to the range of the corner values makes
        # sure that no size is negative.
        return np.clip((weights * values).sum(axis=1), values.min(axis=1), values.max(axis=1))


def weights_in_cells(corners: Array, x: Array) -> Array:
    """The weights of the corners (k, d + 1, d) of simplices whose means the points (k, d) are, rounded."""
    away, exponent = corners - x[:, None], exponents(corners - x[:, None])
    away = np.ldexp(away, -exponent[:, None, None])  # squares of lengths may be beyond the doubles
    weights = np.empty(away.shape[:2])
    if x.shape[1] == 2:
        for i in range(3):
            a, b = away[:, (i + 1) % 3], away[:, (i + 2) % 3]
            weights[:, i] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    else:
        for i, (j, k, m) in enumerate(((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))):
            weights[:, i] = (away[:, j] * np.cross(away[:, k], away[:, m])).sum(axis=1)
    return weights / weights.sum(axis=1, keepdims=True)


def fills_its_space(mesh: object) -> bool:
    """Whether this is a mesh of triangles in the plane or of tetrahedra in space."""
    if is_planar(mesh):
        return True
    return isinstance(mesh, Mesh) and list(mesh.cells) == ["tetra"] and mesh.points.shape[1] == 3


def refuse_flat(mesh: Mesh) -> None:
    """Raise an error if a background mesh has a flat cell, in which nothing can be interpolated."""
    flat = np.nonzero(np.atleast_1d(orient(mesh.corners)) == 0)[0]
    if len(flat):
        kind = "triangle" if mesh.dimension == 2 else "tetrahedron"
        raise MeshError(f"{kind} {flat[0]} of the background mesh is flat; remove it first")


def _nodal(mesh: Mesh, values: ArrayLike) -> Array:
    """The values as an array; they must be positive at used vertices, and are ignored at all others."""
    if not fills_its_space(mesh):
        raise MeshError("a background mesh consists of triangles in the plane or tetrahedra in space")
    if mesh.size == 0:
        raise MeshError("a background mesh needs at least one cell")
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
        A mesh of triangles in the plane, or of tetrahedra in space.
    values : array_like, shape (n,)
        The wanted edge length at each vertex. Values at vertices that no cell uses are ignored.

    Returns
    -------
    Background
        Linear in each cell. Outside the mesh, and in its holes, it is the size at the nearest point of
        the boundary; `Background.outside` counts how often that happened.

    Raises
    ------
    MeshError, InputError
        For a mesh of anything else; for a value that is not positive, with its vertex.

    Notes
    -----
    The cell of a point is found exactly by `Mesh.find_simplex`, in O(log m) per point. Source: the
    chapter's generalized choice of the insertion triangle (12.2.6). See the book, chapter 2.3.
    """
    nodal = _nodal(mesh, values)
    refuse_flat(mesh)
    return Background(mesh, nodal)


def limit_nodes(mesh: Mesh, values: ArrayLike, growth: float) -> Array:
    """Lower sizes at the vertices of a mesh until no edge is steeper than ``growth``.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane, or tetrahedra in space.
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
