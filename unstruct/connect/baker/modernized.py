"""Insertion of points into an arbitrary triangulation: Baker's modernized Bowyer-Watson (12.2.2).

For a new point P: B(P), the *generalized cavity*, is the set of cells whose open circumballs hold P; its
*principal component* is the part that hangs together through facets with the cell of P. Where P sees
every boundary facet of it from within, its cells are replaced by the facets joined to P. Where the
triangulation is not Delaunay, a facet may be hidden in three dimensions: then the owner of the facet is
given up and the component taken again (*reduction*), or the point is refused.

**No vertex is lost.** Let all cells at a vertex A be in B(P), A interior to the mesh. The ray from P through
A enters, behind A, some cell S at A. P is in the open ball of S and the points of S behind A are in the
closed ball: so A, strictly between, is in the open ball, but it lies on the sphere of S. The same holds
for A and P in one plane (or line) of a convex boundary, with the ray in that plane.

**Every order of reduction ends at the same cavity.** While a cell stays, a facet of it hidden from P stays
hidden, for the cavity only shrinks. So no star-shaped part of the component holds such a cell, and
dropping only such cells ends at the largest star-shaped part. It holds the cells with P in them: together
they are star-shaped.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import as_points
from ...base.codes import DONE, OUTSIDE, ROOM
from ...base.errors import InputError, MeshError
from ...mesh.marked import remaining
from ...mesh.mesh import Mesh
from ...predicates.batch import orient, power_of_two
from . import generalized_cavity as kernels
from .fixed import as_cells

__all__ = ["Baker", "Record", "insert"]

VERTICES_A_CALL = 1024  # vertices between two looks at the keyboard


@dataclass(frozen=True)
class Record:
    """What happened at each of k insertions: int64 arrays of shape (k,).

    Attributes
    ----------
    vertex : the number of the new vertex
    twin : the earlier vertex at the same place, else -1; a copy is not inserted, the rest is then 0
    component : cells of the principal component
    hidden : facets of the component that the point does not see
    dropped : owners of hidden facets that were given up, one after another (not those cut off with them)
    rounds : how often the component was taken again
    kept : cells of the star-shaped cavity that was kept: these were replaced
    made : cells that replaced them
    """

    vertex: NDArray[np.int64]
    twin: NDArray[np.int64]
    component: NDArray[np.int64]
    hidden: NDArray[np.int64]
    rounds: NDArray[np.int64]
    dropped: NDArray[np.int64]
    kept: NDArray[np.int64]
    made: NDArray[np.int64]

    @property
    def reduced(self) -> NDArray[np.bool_]:
        """Which insertions needed a reduction."""
        return self.hidden > 0


def insert(mesh: Mesh, point: Any, *, reduce: bool = True, fixed: Any = None) -> Mesh:
    """Insert a point, or several, into an arbitrary triangulation in two or three dimensions.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane or tetrahedra in space, positively oriented, Delaunay or not.
    point : array_like, shape (d,) or (k, d)
        In the mesh, its boundary included.
    reduce : bool
        Whether a component that is not star-shaped is reduced; if not, such a point is an error.
    fixed : str or array_like, optional
        Cells that must stay: the name of a cell marker (those where it is not zero), a mask, or their
        numbers. They take no part in any cavity; what is left of it around the point is used.

    Returns
    -------
    Mesh
        The points of ``mesh``, then the new ones (``origin`` -1). A point equal to an earlier vertex is
        listed in ``duplicates``. A new cell inherits the cell markers of the cell whose facet it takes over;
        of the faces named by markers those remain that still are faces.

    Raises
    ------
    InputError
        For arrays of wrong shape, and for a point outside the mesh (the first such row is named).
    MeshError
        For cells that are flat or negatively oriented, and with ``reduce=False`` where a facet is hidden;
        for a point in a fixed cell or on its boundary.

    Notes
    -----
    From a Delaunay mesh of a convex hull this is the Bowyer-Watson algorithm, and the result is
    Delaunay. From any other mesh the result is valid (exact signs; no vertex is lost: see the module)
    and no more is promised. O(m) for the copy of the mesh, then O(size of the cavity) a point after a walk;
    to insert points one at a time use `Baker`.
    Source: T. J. Baker, Engineering with Computers 5 (1989) 161-175. Book: 2.2.
    """
    growing = Baker(mesh, fixed=fixed)
    points = np.asarray(point)
    growing.insert(points[None] if points.ndim == 1 else points, reduce=reduce)
    return growing.mesh()


class Baker:
    """A triangulation that grows by Baker's insertion.

    Parameters
    ----------
    mesh, fixed
        As for `insert`.

    Attributes
    ----------
    points : ndarray, shape (n, d)
        All vertices so far, read-only.
    """

    def __init__(self, mesh: Mesh, *, fixed: Any = None):
        d = mesh.points.shape[1]
        if d not in (2, 3) or mesh.dimension != d:
            raise InputError(
                f"insertion needs triangles in 2D or tetrahedra in 3D, not {mesh.dimension}-cells in {d}D"
            )
        negative = orient(mesh.corners) <= 0
        if mesh.size == 0 or np.any(negative):
            c = int(np.argmax(negative)) if mesh.size else -1
            raise MeshError(
                f"cell {c} is missing, flat or negatively oriented: use mesh.oriented(), drop flat cells"
            )
        self._old = mesh
        self._fixed = as_cells(mesh, fixed)
        self._factor = power_of_two(mesh.points)
        self._count = len(mesh.points)
        self._points = mesh.points.copy()
        self._scaled = self._scale(mesh.points, 0)
        self._cells = mesh.simplices.astype(np.int64)
        self._neighbors = mesh.neighbors.astype(np.int64)
        self._source = np.arange(mesh.size)
        self._counters = np.array([mesh.size, 0, 0], dtype=np.int64)
        self._twins: list[NDArray[np.int64]] = []
        self._work()

    @property
    def points(self) -> NDArray[np.float64]:
        """All vertices so far."""
        view = self._points[: self._count].view()
        view.flags.writeable = False
        return view

    def insert(self, points: Any, *, reduce: bool = True) -> Record:
        """Insert the rows of ``points`` (k, d), in order; see `unstruct.insert`.

        Where a row raises an error, the rows before it have been inserted.
        """
        new = as_points(points)
        if new.shape[1] != self._points.shape[1]:
            raise InputError(f"points must have {self._points.shape[1]} coordinates, not {new.shape[1]}")
        self._check_box(new)
        first = self._append(new)
        records = np.zeros((len(new), 7), dtype=np.int64)
        p = first
        while p < first + len(new):
            p, status, cell, corner = kernels.insert_vertices(
                self._scaled, p, min(p + VERTICES_A_CALL, first + len(new)), reduce, self._cells,
                self._neighbors, self._source, self._state, self._sides, self._place, self._free,
                self._counters, records[p - first :],
            )  # fmt: skip
            if status == ROOM:
                self._grow()
            elif status != DONE:
                self._stop(p, records[: p - first], first)
                raise self._refusal(new[p - first], p - first, status, int(cell), int(corner))
        return self._stop(p, records, first)

    def mesh(self) -> Mesh:
        """The triangulation as a `Mesh`."""
        live = np.flatnonzero(self._cells[: self._counters[0], 0] >= 0)
        number = np.full(self._counters[0] + 1, -1, dtype=np.int32)  # the last entry is for "no neighbor"
        number[live] = np.arange(len(live))
        old, simplices = self._old, self._cells[live]
        return Mesh(
            self._points[: self._count].copy(),
            simplices,
            neighbors=number[self._neighbors[live]],
            origin=np.concatenate([old.origin, np.full(self._count - len(old.points), -1, np.int32)]),
            duplicates=np.concatenate([old.duplicates, *self._twins]),
            markers={
                name: values[self._source[live]] if values.ndim == 1 else remaining(values, simplices)
                for name, values in old.markers.items()
            },
        )

    def _check_box(self, new: NDArray[np.float64]) -> None:
        used = self._old.points[np.unique(self._old.simplices)]
        outside = ((new < used.min(axis=0)) | (new > used.max(axis=0))).any(axis=1)
        if outside.any():
            row = int(np.argmax(outside))
            raise self._refusal(new[row], row, OUTSIDE, -1, -1)

    def _scale(self, points: NDArray[np.float64], start: int) -> NDArray[np.float64]:
        scaled = points * self._factor
        exact = (scaled / self._factor == points).all(axis=1)
        if not exact.all():
            row = int(np.argmin(exact)) + start
            raise InputError(f"vertex {row} spans too many binary orders with the others: round it to 0")
        return scaled

    def _append(self, new: NDArray[np.float64]) -> int:
        """Store points; their first number."""
        first, needed = self._count, self._count + len(new)
        if needed > len(self._points):
            more = max(needed - len(self._points), len(self._points))
            self._points, self._scaled = (
                np.concatenate([a, np.zeros((more, a.shape[1]))]) for a in (self._points, self._scaled)
            )
        self._scaled[first:needed] = self._scale(new, first)
        self._points[first:needed] = new
        return first

    def _stop(self, end: int, records: NDArray[np.int64], first: int) -> Record:
        """Keep the vertices before ``end`` and the account of copies."""
        self._count = end
        vertex = np.arange(first, end)
        copies = records[:, 0] >= 0
        self._twins.append(np.column_stack([vertex[copies], records[copies, 0]]))
        return Record(vertex, *records.T)

    def _refusal(self, point: Any, row: int, status: int, cell: int, corner: int) -> InputError | MeshError:
        if status == OUTSIDE:
            return InputError(
                f"points[{row}] = {point.tolist()} lies outside the mesh: choose points of the mesh, or use "
                "unstruct.delaunay for all points together"
            )
        vertices = self._cells[cell].tolist()
        if status == kernels.HELD:
            return MeshError(
                f"points[{row}] = {point.tolist()} is refused: it lies in the fixed cell {vertices} or on "
                "its boundary; choose another point, or unfix the cell"
            )
        facet = vertices[:corner] + vertices[corner + 1 :]
        return MeshError(
            f"points[{row}] = {point.tolist()} is refused: of its principal component the facet {facet} "
            f"of cell {vertices} is hidden from it; allow reduce=True, or choose another point"
        )

    def _work(self) -> None:
        """Work arrays, as long as there are rows of cells."""
        m = len(self._cells)
        self._state = np.zeros(m, dtype=np.int8)
        self._state[self._fixed] = kernels.FIXED  # rows of fixed cells never change
        self._sides = np.zeros(self._cells.shape, dtype=np.int8)
        self._place = np.zeros(m, dtype=np.int64)
        self._free = np.append(getattr(self, "_free", np.empty(0, np.int64)), np.zeros(m, np.int64))[:m]

    def _grow(self) -> None:
        """Room for twice as many cells."""
        m = len(self._cells)
        self._cells, self._neighbors = (
            np.concatenate([a, np.zeros_like(a)]) for a in (self._cells, self._neighbors)
        )
        self._source = np.concatenate([self._source, np.zeros(m, np.int64)])
        self._work()
