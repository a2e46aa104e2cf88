"""A given surface of triangles in space, which other meshes stay on: nearest points, features, distances.

See the book, chapter 2.7.
"""

from __future__ import annotations

from copy import copy

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import finite
from ..base.arrays import as_points, frozen
from ..base.errors import InputError
from ..predicates.batch import power_of_two
from .boxes import BoxTree, bounding_boxes
from .farthest_samples import Sampled, Sought, farthest_samples
from .support_features import features_of, same_points, unit_normals
from .support_walk import Held, chain_rows, nearest_rows

__all__ = ["Support"]

Array = NDArray[np.float64]
MOST_SAMPLES = 1 << 22  # points at which a distance is measured: the step grows if there were more
FINEST_CUT = 64  # parts of a side between samples, at most, if a triangle is far larger than others


class Support:
    """The given surface.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Two equal points count as one vertex.
    triangles : array_like of int, shape (m, 3)
        At least one. They may be flat, may end or branch, and need not be connected.
    sharp : float, optional
        Degrees by which the direction of the surface turns at a crease; between 0 and 180. By default there
        are no creases.
    edges : array_like of int, shape (k, 2), optional
        Other edges that are features, such as those between triangles with different names.
    corners : array_like of int, shape (c,), optional
        Other vertices that must be kept, such as those with a name.

    Attributes
    ----------
    points, triangles : ndarray
        As given.
    normals : (m, 3) float64
        Unit normals; zero for flat triangles.
    features : (k, 2) int64
        The edges that must be kept: where the surface ends, where more than two triangles meet or two that
        run through the edge in the same direction, creases, and the given edges. Each once, by the first of
        equal vertices; one curve after the other, each edge beginning where the one before ends.
    corners : (c,) int64
        The vertices that must be kept: the given ones; where other than two features meet; where two meet and
        turn by more than ``sharp`` (without it, 45 degrees); where several fans of triangles meet in a point;
        the tip of a cone, at which some triangle is tilted by more than ``sharp`` from the mean of all.
    chain : (k,) int64
        The feature curve of each edge, in order. Curves run from corner to corner, or are closed.
    factor : float
        A power of two: coordinates in ``held`` are scaled by it.
    held : Held
        The arrays for kernels; see `support_walk`.
    """

    def __init__(
        self,
        points: ArrayLike,
        triangles: ArrayLike,
        *,
        sharp: float | None = None,
        edges: ArrayLike | None = None,
        corners: ArrayLike | None = None,
    ):
        self.points = frozen(_in_space(points, "points"))
        self.triangles = frozen(_rows(triangles, 3, "triangles", len(self.points)))
        if len(self.triangles) == 0:
            raise InputError("a surface needs at least one triangle")
        if sharp is not None and not 0.0 < finite(sharp, "sharp") < 180.0:
            raise InputError(f"sharp must be an angle between 0 and 180 degrees, not {sharp!r}")
        self.factor = power_of_two(self.points)
        xyz, same = self.points * self.factor, same_points(self.points)
        rows = same[self.triangles]
        named = np.empty((0, 2), dtype=np.int64) if edges is None else _rows(edges, 2, "edges", len(xyz))
        self.normals = frozen(unit_normals(xyz, rows))
        kept = np.empty(0, dtype=np.int64)
        if corners is not None:
            kept = same[_numbers(corners, "corners", np.size(corners), len(xyz))]
        found = features_of(xyz, rows, self.normals, sharp, same[named], kept)
        self.features, self.chain = frozen(found.edges), frozen(found.chain)
        self.corners = frozen(found.corners)
        self.held = _held(xyz, rows, np.array(self.normals), found.edges, found.chain)

    def of_triangles(self, triangles: ArrayLike) -> Support:
        """The same surface divided into other triangles of the same vertices, with the same features."""
        result = copy(self)
        rows = _rows(triangles, 3, "triangles", len(self.points))
        result.triangles = frozen(rows)
        xyz = self.points * self.factor
        result.normals = frozen(unit_normals(xyz, rows))
        result.held = _held(xyz, rows, np.array(result.normals), self.features, self.chain)
        return result

    def nearest(
        self, x: ArrayLike, hint: ArrayLike | None = None, normals: ArrayLike | None = None
    ) -> tuple[NDArray[np.int64], Array, Array]:
        """The nearest point of the surface to each of many points.

        Parameters
        ----------
        x : array_like, shape (q, 3)
        hint : array_like of int, shape (q,), optional
            A triangle close to each; by default that of the point before.
        normals : array_like, shape (q, 3), optional
            Only triangles count whose normal has a positive product with that of the point, so that points on
            one side of a thin plate do not go to the other. Where none has, or the normal is zero, all count.

        Returns
        -------
        triangle : (q,) int64
        weights : (q, 3) float64
            Of the corners of the triangle.
        points : (q, 3) float64
            On the surface, up to rounding; a vertex exactly where it is the nearest point.

        Notes
        -----
        O(log m) for each point, if it is near, and more quickly if the hint is good.
        """
        array = _in_space(x, "x")
        units = np.ascontiguousarray(array * self.factor)
        if normals is None:
            directions = np.zeros(units.shape)
        else:
            directions = np.ascontiguousarray(_in_space(normals, "normals"))
        which = np.full(len(units), -1, dtype=np.int64)
        if hint is not None:
            which = _numbers(hint, "hint", len(units), len(self.triangles)).copy()
        if directions.shape != units.shape:
            raise InputError(f"normals must have the shape of x, {units.shape}, not {directions.shape}")
        places = np.zeros((len(units), 3))
        nearest_rows(self.held, units, directions, which, places)
        return which, places, self._at(self.triangles[which], places)

    def onto_chain(self, x: ArrayLike, chain: ArrayLike) -> tuple[NDArray[np.int64], Array, Array]:
        """The nearest point on a feature curve.

        Parameters
        ----------
        x : array_like, shape (q, 3)
        chain : int or array_like of int, shape (q,)
            The number of the curve.

        Returns
        -------
        edge : (q,) int64
            The row of ``features``.
        parameter : (q,) float64
            From 0 at its first vertex to 1.
        points : (q, 3) float64
        """
        units = np.ascontiguousarray(_in_space(x, "x") * self.factor)
        many = int(self.chain.max(initial=-1)) + 1
        chains = np.ascontiguousarray(np.broadcast_to(np.asarray(chain), (len(units),)))
        which, t = np.empty(len(units), dtype=np.int64), np.empty(len(units))
        chain_rows(self.held, units, _numbers(chains, "chain", len(units), many), which, t)
        return which, t, self._at(self.features[which], np.column_stack([1.0 - t, t]))

    def deviation(
        self, points: ArrayLike, triangles: ArrayLike, step: float | None = None
    ) -> tuple[float, float]:
        """The largest distances, measured at samples, of a mesh from the surface and of it from the mesh.

        Parameters
        ----------
        points : array_like, shape (k, 3)
        triangles : array_like of int, shape (t, 3)
        step : float, optional
            How far the samples are apart at most, by default half of the mean length of an edge of the mesh.
            It grows if there were more than four million samples, and a side has no more than 64.

        Returns
        -------
        there, back : float
            In the units of the coordinates. The samples are the vertices and the center of each triangle, and
            the points that divide its sides and itself evenly.

        Notes
        -----
        Lower bounds of the two distances whose maximum is the Hausdorff distance. A point of a triangle is
        within step / √3 of a sample, and the distance from a set changes no faster than the point moves: the
        true values are larger by step / √3 at most, if the step could be kept.
        """
        there, _, back, _ = self._measured(points, triangles, step, False)
        return there, back

    def _cut(
        self, points: ArrayLike, triangles: ArrayLike, step: float | None
    ) -> tuple[Array, list[NDArray[np.int64]]]:
        """The corners of the mesh, in scaled coordinates; into how many parts sides of both are cut."""
        x = _in_space(points, "points")
        rows = _rows(triangles, 3, "triangles", len(x))
        if len(rows) == 0:
            raise InputError("the mesh needs at least one triangle")
        mesh, own = np.ascontiguousarray(x[rows] * self.factor), self.held.corners
        longest = [_longest(mesh), _longest(own)]
        if step is None:
            wanted = float(_sum_of_sides(mesh) / (3 * len(mesh))) / 2
        else:
            wanted = finite(step, "step") * self.factor
        if not wanted > 0.0:
            wanted = max(float(longest[0].max()), float(longest[1].max()), 1e-300)
        return mesh, _parts(longest, wanted)

    def distances(
        self, points: ArrayLike, triangles: ArrayLike, step: float | None = None
    ) -> tuple[Array, Array]:
        """The same for each triangle of the mesh, (t,), and for each of the surface, (m,)."""
        _, there, _, back = self._measured(points, triangles, step, True)
        return there, back

    def _measured(
        self, points: ArrayLike, triangles: ArrayLike, step: float | None, each: bool
    ) -> tuple[float, Array, float, Array]:
        """The largest distance of the mesh, those of its triangles; the same of the surface."""
        mesh, parts = self._cut(points, triangles, step)
        held, tree = self.held, BoxTree(*bounding_boxes(mesh))
        found: list = []
        sides = (mesh, tree.low, tree.high, tree.order), (held.corners, held.low, held.high, held.order)
        for (corners, _, _, order), number, (others, low, high, rank) in zip(sides, parts, sides[::-1]):
            far = np.empty(len(corners))
            sought = Sought(others[rank], low, high)
            most = farthest_samples(Sampled(corners, number, order), sought, each, far)
            found += [float(np.sqrt(most)) / self.factor, np.sqrt(far) / self.factor]
        return found[0], found[1], found[2], found[3]

    def _at(self, rows: np.ndarray, weights: Array) -> Array:
        """Points of given weights; those of weight 1 are vertices exactly."""
        corners = self.points[rows]
        result = corners[:, 0] * weights[:, :1]
        for k in range(1, rows.shape[1]):
            result = result + corners[:, k] * weights[:, k : k + 1]
        for k in range(rows.shape[1]):
            exact = weights[:, k] == 1.0
            result[exact] = corners[exact, k]
        return result


def _in_space(values: ArrayLike, name: str) -> Array:
    array = np.array(as_points(values, name), dtype=np.float64)
    if array.shape[1] != 3:
        raise InputError(f"{name} must be points in space, rows of three numbers, not of {array.shape[1]}")
    return array


def _rows(values: ArrayLike, width: int, name: str, n: int) -> NDArray[np.int64]:
    """Rows of vertices, checked."""
    array = np.asarray(values)
    if array.size == 0:
        return np.empty((0, width), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != width or not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{name} must be rows of {width} vertices, not {array.dtype} of shape {array.shape}")
    wrong = np.flatnonzero(((array < 0) | (array >= n)).any(axis=1))
    if len(wrong):
        raise InputError(f"{name}[{wrong[0]}] = {array[wrong[0]].tolist()} is outside of 0..{n - 1}")
    return array.astype(np.int64)


def _numbers(values: ArrayLike, name: str, count: int, most: int) -> NDArray[np.int64]:
    array = np.asarray(values)
    if array.shape != (count,) or not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{name} must be {count} integers, not {array.dtype} of shape {array.shape}")
    wrong = np.flatnonzero((array < 0) | (array >= most))
    if len(wrong):
        raise InputError(f"{name}[{wrong[0]}] = {array[wrong[0]]} is outside of 0..{most - 1}")
    return array.astype(np.int64)


def _held(
    xyz: Array, rows: NDArray[np.int64], normals: Array, edges: NDArray[np.int64], chain: NDArray[np.int64]
) -> Held:
    corners = np.ascontiguousarray(xyz[rows])
    tree = BoxTree(*bounding_boxes(corners))
    flat = np.ascontiguousarray(xyz[edges[:, [0, 1, 1]]])
    curves = BoxTree(*bounding_boxes(flat))
    order = np.argsort(rows.ravel(), kind="stable")
    start = np.searchsorted(rows.ravel()[order], np.arange(len(xyz) + 1))
    return Held(
        corners, rows, normals, start, order // 3, tree.low, tree.high, tree.order,
        flat, chain, curves.low, curves.high, curves.order, np.zeros(len(rows), dtype=np.int64), 0.0,
    )  # fmt: skip


# ---------------------------------------------------------------------- samples


def _sides_of(x: Array) -> Array:
    """The lengths of the sides of triangles (m, 3, 3): (m, 3)."""
    u = x[:, [1, 2, 0]] - x
    return np.sqrt(u[..., 0] ** 2 + u[..., 1] ** 2 + u[..., 2] ** 2)


def _longest(x: Array) -> Array:
    return _sides_of(x).max(axis=1)


def _sum_of_sides(x: Array) -> float:
    return float(_sides_of(x).sum())


def _parts(longest: list[Array], step: float) -> list[NDArray[np.int64]]:
    """Into how many parts the sides of each triangle of both surfaces are cut."""
    while True:
        cuts = [np.clip(np.ceil(x / step), 1, FINEST_CUT).astype(np.int64) for x in longest]
        if sum(int(((k + 1) * (k + 2) // 2).sum()) for k in cuts) <= max(
            MOST_SAMPLES, 3 * sum(map(len, cuts))
        ):
            return cuts
        step *= 1.5
