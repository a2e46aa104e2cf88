"""Insertion of points into an arbitrary triangulation: Baker's modernized Bowyer-Watson (12.2.2).

For a new point P, the *generalized cavity* B(P) is the set of cells whose open circumballs contain P. Its
*principal component* is the part that is connected through facets with the cell of P. If P sees every
boundary facet of the component from within, its cells are replaced by new cells that join these facets to P.
If the triangulation is not Delaunay, a facet may be hidden in three dimensions. Then the owner of the facet
(the cell of the component that has it) is spared and the component is computed again (*reduction*), or the
point is refused.

**No vertex is lost.** Suppose that all cells at a vertex A in the interior of the mesh are in B(P). The ray
from P through A enters some cell S at A behind A. P is in the open ball of S, and the points of S behind A
are in the closed ball. So A, which is strictly between, is in the open ball. But A lies on the sphere of S, a
contradiction. The same argument applies to A and P in one plane (or line) of a convex boundary, with the ray
in that plane.

**Every order of reduction ends with the same cavity.** As long as a cell remains, a facet of it that is
hidden from P remains hidden, because the cavity only shrinks. So no star-shaped part of the component
contains such a cell, and sparing only such cells ends with the largest star-shaped part. It contains the
cells with P in them, because their union is star-shaped.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_flags
from ...base.arrays import as_points
from ...base.codes import DONE, OUTSIDE, ROOM
from ...base.errors import InputError, MeshError
from ...mesh.marked import remaining_of
from ...mesh.mesh import Mesh
from ...predicates.batch import orient, power_of_two
from . import generalized_cavity as kernels
from .fixed import as_cells
from .records import Growing

__all__ = ["Baker", "Record", "insert"]

VERTICES_A_CALL = 1024  # how many vertices are inserted before Ctrl-C is checked again


@dataclass(frozen=True)
class Record:
    """What happened at each of k insertions: int64 arrays of shape (k,).

    Attributes
    ----------
    vertex : the number of the new vertex
    twin : the earlier vertex at the same place, or -1; a copy is not inserted, and its other values are 0
    component : the number of cells of the principal component
    hidden : the number of facets of the component that the point does not see
    rounds : how often the component was computed again
    spared : the number of owners of hidden facets that were spared in all rounds (they stay), without the
        cells that were cut off with them
    deleted : the number of cells of the star-shaped cavity, which were replaced
    made : the number of cells that replaced them
    """

    vertex: NDArray[np.int64]
    twin: NDArray[np.int64]
    component: NDArray[np.int64]
    hidden: NDArray[np.int64]
    rounds: NDArray[np.int64]
    spared: NDArray[np.int64]
    deleted: NDArray[np.int64]
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
        Points in the mesh or on its boundary.
    reduce : bool
        Whether a component that is not star-shaped is reduced; if not, such a point is an error.
    fixed : str or array_like, optional
        Cells that must remain: the name of a cell marker (the cells where it is not zero), a mask, or their
        numbers. They are in no cavity; the part of the cavity around the point that remains is used.

    Returns
    -------
    Mesh
        The points of ``mesh``, then the new ones (``origin`` -1). A point equal to an earlier vertex is
        listed in ``duplicates``. A new cell inherits the cell markers of the old cell whose facet it has. Of
        the faces in markers, those remain that are still faces of the mesh.

    Raises
    ------
    InputError
        For arrays of wrong shape, and for a point outside the mesh (the first such row is named).
    MeshError
        For cells that are flat or negatively oriented; with ``reduce=False``, if a facet is hidden; for a
        point in a fixed cell or on its boundary.

    Notes
    -----
    For a Delaunay mesh of a convex hull this is the Bowyer-Watson algorithm, and the result is Delaunay. For
    any other mesh the result is valid (signs are exact, and no vertex is lost; see the module), but it need
    not be Delaunay. Copying the mesh takes O(m); each point takes a walk and O(size of the cavity). To insert
    points one at a time, use `Baker`.
    Source: T. J. Baker, Engineering with Computers 5 (1989) 161-175. Book: 2.2b.
    """
    as_flags(reduce=reduce)
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
        if not isinstance(mesh, Mesh):
            raise InputError(f"mesh must be a Mesh, not {type(mesh).__name__}; see delaunay and refine")
        d = mesh.points.shape[1]
        if d not in (2, 3) or mesh.dimension != d:
            raise InputError(
                f"insertion needs triangles in 2D or tetrahedra in 3D, not {mesh.dimension}-cells in {d}D"
            )
        negative = orient(mesh.corners) <= 0
        if mesh.size == 0 or np.any(negative):
            c = int(np.argmax(negative)) if mesh.size else -1
            raise MeshError(
                f"cell {c} is missing, flat or negatively oriented; use mesh.oriented() and remove flat cells"
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

        If a row raises an error, the rows before it have been inserted.
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
                self._scaled,
                p,
                min(p + VERTICES_A_CALL, first + len(new)),
                reduce,
                self._growing(),
                records[p - first :],
            )
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
        faces = {name: rows for name, rows in old.markers.items() if rows.ndim > 1}
        faces = remaining_of(faces, simplices)
        return Mesh(
            self._points[: self._count].copy(),
            simplices,
            neighbors=number[self._neighbors[live]],
            origin=np.concatenate([old.origin, np.full(self._count - len(old.points), -1, np.int32)]),
            duplicates=np.concatenate([old.duplicates, *self._twins]),
            markers={
                name: values[self._source[live]] if values.ndim == 1 else faces[name]
                for name, values in old.markers.items()
            },
            regions=old.regions,
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
            raise InputError(
                f"vertex {row} has a coordinate too small to be scaled exactly with the others; round it to 0"
            )
        return scaled

    def _append(self, new: NDArray[np.float64]) -> int:
        """Store points; return the number of the first one."""
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
        """Keep the vertices before ``end`` and list the copies among them."""
        self._count = end
        vertex = np.arange(first, end)
        copies = records[:, 0] >= 0
        self._twins.append(np.column_stack([vertex[copies], records[copies, 0]]))
        return Record(vertex, *records.T)

    def _refusal(self, point: Any, row: int, status: int, cell: int, corner: int) -> InputError | MeshError:
        if status == OUTSIDE:
            return InputError(
                f"points[{row}] = {point.tolist()} lies outside the mesh: choose points in the mesh, or use "
                "unstruct.delaunay for all points together"
            )
        vertices = self._cells[cell].tolist()
        if status == kernels.HELD:
            return MeshError(
                f"points[{row}] = {point.tolist()} is refused: it lies in the fixed cell {vertices} or on "
                "its boundary; choose another point, or do not fix the cell"
            )
        facet = vertices[:corner] + vertices[corner + 1 :]
        return MeshError(
            f"points[{row}] = {point.tolist()} is refused: the facet {facet} of cell {vertices} in its "
            "principal component is hidden from it; use reduce=True, or choose another point"
        )

    def _growing(self) -> Growing:
        """The arrays as they are now."""
        return Growing(
            self._cells, self._neighbors, self._source, self._state, self._sides, self._place, self._free,
            self._counters,
        )  # fmt: skip

    def _work(self) -> None:
        """Create the work arrays, with one entry for each row of cells."""
        m = len(self._cells)
        self._state = np.zeros(m, dtype=np.int8)
        self._state[self._fixed] = kernels.FIXED  # rows of fixed cells never change
        self._sides = np.zeros(self._cells.shape, dtype=np.int8)
        self._place = np.zeros(m, dtype=np.int64)
        self._free = np.append(getattr(self, "_free", np.empty(0, np.int64)), np.zeros(m, np.int64))[:m]

    def _grow(self) -> None:
        """Make room for twice as many cells."""
        m = len(self._cells)
        self._cells, self._neighbors = (
            np.concatenate([a, np.zeros_like(a)]) for a in (self._cells, self._neighbors)
        )
        self._source = np.concatenate([self._source, np.zeros(m, np.int64)])
        self._work()
