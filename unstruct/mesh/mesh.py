"""Mesh: points and cells as flat arrays, and what follows from them, computed when asked for.

See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from math import fsum
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.arrays import as_points, distinct, frozen, refrozen
from ..base.errors import InputError, MeshError
from ..geometry import simplex
from . import topology
from .cells import (
    as_cells,
    cell_dimension,
    counted,
    incident_edges,
    incident_facets,
    simplex_dimension,
    simplex_type,
)

if TYPE_CHECKING:
    from .locate import Locator

__all__ = ["Mesh", "as_points"]


class Mesh:
    """An unstructured mesh: points, cells, and the account of where they came from.

    Parameters
    ----------
    points : array_like, shape (n, d)
    simplices : array_like of int, shape (m, k + 1), optional
        Cells of dimension k <= d. Kept as given: `unstruct.check` names cells that are not positively
        oriented (k = d), `Mesh.oriented` turns them.
    neighbors : array_like of int, shape (m, k + 1), optional
        ``neighbors[t, i]`` lies opposite vertex i of cell t, -1 for none. Computed when missing.
    origin : array_like of int, shape (n,), optional
        The input vertex that each vertex is, or -1 for a new one. All are input by default.
    duplicates : array_like of int, shape (c, 2), optional
        Rows (copy, kept): vertex ``copy`` equals vertex ``kept`` and is used by no cell.
    markers : dict of str to array, optional
        A one-dimensional array of length m gives a value to each cell. An integer array of shape (c, j)
        names c faces by their j vertices: (c, 1) vertices, (c, 2) edges, (c, 3) triangles.
    cells : dict of str to array, optional
        Instead of ``simplices``: kind -> rows of vertices, by meshio's names ("triangle", "quad", "tetra",
        "hexahedron", "wedge", "pyramid", "polygon", ...), all of one dimension; "polygon" may be a list of
        rows of different lengths.

    Raises
    ------
    InputError
        For arrays of wrong shape, type or range; the message names the first offending row.

    Notes
    -----
    All arrays are read-only views and are not copied where the type already fits. The methods return new
    meshes. Validation is O(n + m); adjacency and the rest are computed once, when asked for.
    """

    def __init__(
        self,
        points: Any,
        simplices: Any = None,
        *,
        neighbors: Any = None,
        origin: Any = None,
        duplicates: Any = None,
        markers: Mapping[str, Any] | None = None,
        cells: Mapping[str, Any] | None = None,
    ):
        self.points: np.ndarray = frozen(as_points(points))
        n, d = self.points.shape
        if (simplices is None) == (cells is None):
            raise InputError("give either simplices or cells")
        if simplices is not None:
            rows = topology.as_simplices(simplices, vertices=n)
            self.cells: dict[str, Any] = {simplex_type(rows.shape[1] - 1): frozen(rows)}
        else:
            self.cells = as_cells(cells or {}, n)
        self.dimension: int = cell_dimension(next(iter(self.cells)))
        if self.dimension > d:
            raise InputError(f"cells of dimension {self.dimension} cannot lie in {d} dimensions")
        if neighbors is not None:
            self.__dict__["neighbors"] = self._integers(neighbors, "neighbors", self.simplices.shape)
        self.origin: np.ndarray = self._integers(
            np.arange(n, dtype=np.int32) if origin is None else origin, "origin", (n,)
        )
        self.duplicates: np.ndarray = self._integers(
            np.empty((0, 2), dtype=np.int32) if duplicates is None else duplicates, "duplicates", (None, 2)
        )
        if self.duplicates.size and not 0 <= self.duplicates.min() <= self.duplicates.max() < n:
            raise InputError(f"duplicates refers to vertices outside 0..{n - 1}")
        self.markers: dict[str, np.ndarray] = {
            name: self._marker(name, values) for name, values in (markers or {}).items()
        }

    @staticmethod
    def _integers(values: Any, name: str, shape: tuple[int | None, ...]) -> np.ndarray:
        array = np.asarray(values)
        if array.ndim != len(shape) or any(s is not None and s != a for s, a in zip(shape, array.shape)):
            raise InputError(f"{name} must have shape {shape}, not {array.shape}")
        if array.size and array.dtype.kind not in "iu":
            raise InputError(f"{name} must be integers, not {array.dtype}")
        return frozen(np.ascontiguousarray(array, dtype=np.int32))

    def _marker(self, name: str, values: Any) -> np.ndarray:
        array = np.asarray(values)
        if array.ndim == 1 and len(array) == self.size:
            return frozen(array)
        if array.ndim != 2 or (array.size and array.dtype.kind not in "iu"):
            raise InputError(
                f"markers[{name!r}] must be one value a cell, shape ({self.size},), or faces as rows of "
                f"vertices, not {array.dtype} of shape {array.shape}"
            )
        if array.size and not 0 <= array.min() <= array.max() < len(self.points):
            row = int(np.argmax(((array < 0) | (array >= len(self.points))).any(axis=1)))
            raise InputError(f"markers[{name!r}][{row}] = {array[row].tolist()} refers to missing vertices")
        return frozen(array.astype(np.int32))

    # ------------------------------------------------------------------ cells and adjacency

    @property
    def size(self) -> int:
        """The number of cells."""
        return sum(len(block) for block in self.cells.values())

    @property
    def is_simplicial(self) -> bool:
        """Whether all cells are simplices of one kind, so that `simplices` and `neighbors` exist."""
        return len(self.cells) == 1 and simplex_dimension(next(iter(self.cells))) is not None

    @property
    def simplices(self) -> np.ndarray:
        """The cells, int32 of shape (m, k + 1); `MeshError` where cells are of other or several kinds."""
        if not self.is_simplicial:
            raise MeshError(f"this mesh holds cells of kind {', '.join(self.cells)}: use .cells")
        return next(iter(self.cells.values()))

    @cached_property
    def neighbors(self) -> np.ndarray:
        """``neighbors[t, i]``: the cell across the facet opposite vertex i of cell t, -1 for none."""
        return frozen(topology.neighbors(self.simplices))

    @cached_property
    def edges(self) -> np.ndarray:
        """Edges (i, j), i < j, in lexicographic order: int32, shape (e, 2)."""
        return frozen(topology.edges(self.simplices) if self.is_simplicial else incident_edges(self.cells))

    @cached_property
    def facets(self) -> np.ndarray:
        """Faces of codimension one, rows sorted, lexicographic: int32, shape (f, k)."""
        if self.is_simplicial:
            return frozen(topology.facets(self.simplices))
        rows, _, group = incident_facets(self.cells)
        rows = np.sort(rows[np.unique(group, return_index=True)[1]], axis=1)
        return frozen(rows[np.lexsort(rows.T[::-1])])

    @cached_property
    def boundary(self) -> np.ndarray:
        """Facets with one cell, outward for positively oriented cells (2D: the mesh on the left).

        Rows of kinds with facets of several sizes are padded by -1.
        """
        if self.is_simplicial:
            return frozen(topology.boundary(self.simplices, self.neighbors))
        rows, _, group = incident_facets(self.cells)
        return frozen(rows[np.bincount(group)[group] == 1])

    @property
    def convex_hull(self) -> np.ndarray:
        """Facets of the convex hull of the points, as SciPy's `Delaunay.convex_hull`: int32, (h, d).

        The boundary where that is convex (always so for a Delaunay mesh); otherwise the boundary of the
        Delaunay mesh of the points.
        """
        from ..assess.check import boundary_is_convex

        if self.is_simplicial and self.dimension == self.points.shape[1] and boundary_is_convex(self):
            return self.boundary
        from ..connect.insertion.delaunay import delaunay

        return delaunay(self.points).boundary

    @cached_property
    def vertex_neighbor_vertices(self) -> tuple[np.ndarray, np.ndarray]:
        """(indptr, indices): vertex v is joined to ``indices[indptr[v]:indptr[v + 1]]``, increasing."""
        if self.is_simplicial:
            return topology.vertex_neighbors(self.simplices, len(self.points))
        return topology.vertex_neighbors(self.edges, len(self.points))

    @cached_property
    def stars(self) -> tuple[np.ndarray, np.ndarray]:
        """(indptr, cells): vertex v belongs to the cells ``cells[indptr[v]:indptr[v + 1]]``, increasing."""
        return topology.stars(self.simplices, len(self.points))

    def face_counts(self) -> tuple[int, ...]:
        """(f_0, ..., f_k): used vertices, edges, ..., cells."""
        if self.is_simplicial:
            return topology.face_counts(self.simplices)
        used = len(distinct(self.edges))
        middle = [len(self.edges)] if self.dimension == 2 else [len(self.edges), len(self.facets)]
        return (used, *middle, self.size)

    @property
    def euler_characteristic(self) -> int:
        """f_0 - f_1 + f_2 - ...; 1 for a ball, 0 for an annulus, 2 for a sphere."""
        return sum((-1) ** j * f for j, f in enumerate(self.face_counts()))

    # ------------------------------------------------------------------ geometry

    @property
    def corners(self) -> np.ndarray:
        """Coordinates of the cells' corners, shape (m, k + 1, d), as `unstruct.simplex` takes them."""
        return self.points[self.simplices]

    @cached_property
    def volumes(self) -> np.ndarray:
        """Length, area or volume of each cell, signed where k = d."""
        from .measures import cell_volumes

        return frozen(cell_volumes(self))

    @property
    def volume(self) -> float:
        """Total length, area or volume (the sum of `volumes`, correctly rounded)."""
        return fsum(self.volumes)

    def quality(self, name: str) -> np.ndarray:
        """One number for the shape of each cell: `unstruct.simplex.quality` (which lists the names)."""
        return simplex.quality(name, self.corners)

    @cached_property
    def _locator(self) -> Locator:
        from .locate import Locator

        return Locator(self)

    def find_simplex(self, x: Any) -> np.ndarray:
        """The cell that holds each point, by exact signs; -1 outside.

        Parameters
        ----------
        x : array_like, shape (..., d)

        Returns
        -------
        ndarray of int32, shape (...)
            Cells are closed; a point on several has the lowest number among them.

        Notes
        -----
        The mesh need be neither convex nor connected. A tree of bounding boxes, built on the first call in
        O(m log m), leads to a few cells each, which exact orientation signs decide.
        """
        return self._locator.find(x)

    def summary(self) -> dict[str, Any]:
        """Counts and quality statistics: a dictionary, which prints as a short text."""
        from .measures import summarize

        return summarize(self)

    # ------------------------------------------------------------------ new meshes

    def oriented(self) -> Mesh:
        """The mesh with negatively oriented cells turned (their first two vertices swapped); k = d only."""
        from ..predicates.batch import orient

        negative = orient(self.corners) < 0
        simplices = self.simplices.copy()
        simplices[negative, :2] = simplices[negative, 1::-1]
        return Mesh(
            self.points, simplices, origin=self.origin, duplicates=self.duplicates, markers=self.markers
        )

    def select(self, mask: Any) -> Mesh:
        """The mesh of some cells, with the vertices that they use.

        Parameters
        ----------
        mask : array_like of bool, shape (m,), or of int
            Cells to keep, as a mask or as numbers (then in that order).

        Returns
        -------
        Mesh
            `origin` still points to the input vertices; per-cell markers and the named faces that remain
            are kept; `duplicates` has nothing to tell any more and is empty.
        """
        chosen = np.asarray(mask)
        if chosen.dtype == bool and chosen.shape != (self.size,):
            raise InputError(f"mask must have shape ({self.size},), not {chosen.shape}")
        if chosen.dtype != bool and (chosen.ndim != 1 or (chosen.size and chosen.dtype.kind not in "iu")):
            raise InputError("mask must be booleans, one a cell, or cell numbers")
        if chosen.dtype != bool and chosen.size and not 0 <= chosen.min() <= chosen.max() < self.size:
            raise InputError(f"cell numbers must lie in 0..{self.size - 1}")
        chosen = np.nonzero(chosen)[0] if chosen.dtype == bool else chosen.astype(np.int64)
        simplices = self.simplices[chosen]
        used, simplices = np.unique(simplices, return_inverse=True)
        simplices = simplices.reshape(len(chosen), self.dimension + 1).astype(np.int32)
        number = np.full(len(self.points), -1, dtype=np.int32)
        number[used] = np.arange(len(used))
        markers = {
            name: values[chosen] if values.ndim == 1 else _remaining(number[values], simplices)
            for name, values in self.markers.items()
        }
        return Mesh(self.points[used], simplices, origin=self.origin[used], markers=markers)

    # ------------------------------------------------------------------ pictures and files

    def plot(self, **options: Any) -> Any:
        """Draw with matplotlib: `unstruct.view.plot`, which see for the options."""
        from .. import view

        return view.plot(self, **options)

    def write(self, path: str | Path) -> None:
        """Write a file; its suffix chooses the format.

        What `Mesh.read` finds again; of the rest, a warning tells the names:

        ============ ============== ================= ==================== ===================
        format       points, cells  origin, copies    markers of faces     markers of cells
        ============ ============== ================= ==================== ===================
        .vtu, .vtk   yes            yes               all, empty ones too  all
        .msh         yes            yes               one for each face    "region"
        .node, .ele  simplices      no                no                   no
        others       yes            no                no                   no
        ============ ============== ================= ==================== ===================

        In .msh markers are Gmsh's physical groups (`unstruct.mesh.gmsh`): "region 0", ... for cells; a face
        of several markers is in the first but "facets" and "inner", which follow from where the mesh ends.
        """
        from .files import write

        write(self, path)

    @classmethod
    def read(cls, path: str | Path) -> Mesh:
        """Read a file by its suffix: any format of meshio, or Triangle's .node/.ele pair."""
        from .files import read

        return read(path)

    def to_meshio(self) -> Any:
        """The mesh as a `meshio.Mesh`."""
        from .files import to_meshio

        return to_meshio(self)

    def to_skfem(self) -> Any:
        """The mesh as a scikit-fem mesh: `MeshLine`, `MeshTri`, `MeshTet`, `MeshQuad` or `MeshHex`."""
        from .files import to_skfem

        return to_skfem(self)

    def __len__(self) -> int:
        return self.size

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(refrozen(state))

    def __repr__(self) -> str:
        kinds = ", ".join(counted(len(block), name) for name, block in self.cells.items())
        extra = f", {len(self.duplicates)} duplicates" if len(self.duplicates) else ""
        return f"<Mesh: {len(self.points)} points, {kinds} in {self.points.shape[1]}D{extra}>"

    def _repr_html_(self) -> str:
        from .card import html

        return html(self)


def is_planar(mesh: Any) -> bool:
    """Whether this is a mesh whose cells are all triangles, of points with two coordinates."""
    if not isinstance(mesh, Mesh):
        return False
    return mesh.is_simplicial and mesh.dimension == 2 and mesh.points.shape[1] == 2


def _remaining(faces: np.ndarray, simplices: np.ndarray) -> np.ndarray:
    """Those rows of vertices (-1: gone) that are still faces of some cell."""
    faces = faces[(faces >= 0).all(axis=1)]
    width = faces.shape[1]
    if len(faces) == 0 or width > simplices.shape[1]:
        return faces[:0]
    present = (
        topology.faces(simplices, width - 1) if width < simplices.shape[1] else np.sort(simplices, axis=1)
    )
    group, _ = topology.group_rows(np.concatenate([present, np.sort(faces, axis=1)]))
    return faces[np.isin(group[len(present) :], group[: len(present)])]
