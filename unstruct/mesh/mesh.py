"""Mesh: points and cells, and what follows from them, which is computed when asked for.

See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

from ..base.arrays import frozen
from ..base.doors import door
from ..base.errors import InputError
from . import card, files
from .complex import CellComplex
from .embedding import boundary_is_convex
from .locate import Locator
from .marked import selected
from .measures import cell_volumes, summarize, total
from .orientation import jacobian_signs, turned_cells
from .shapes import cell_quality

__all__ = ["Mesh", "is_planar"]

_delaunay = door("unstruct.connect.insertion.delaunay:delaunay")
_plot = door("unstruct.view:plot")


class Mesh(CellComplex):
    """An unstructured mesh: points, cells, and a record of where they came from.

    Parameters
    ----------
    points : array_like, shape (n, d)
    simplices : array_like of int, shape (m, k + 1), optional
        Cells of dimension k <= d. Kept as given: `unstruct.check` names cells that are not positively
        oriented (k = d), `Mesh.oriented` turns them.
    neighbors : array_like of int, shape (m, k + 1), optional
        ``neighbors[t, i]`` lies opposite vertex i of cell t, -1 for none. Computed when missing.
    origin : array_like of int, shape (n,), optional
        The input vertex that each vertex is, or -1 for a new one. By default all are input.
    duplicates : array_like of int, shape (c, 2), optional
        Rows (copy, kept): vertex ``copy`` equals vertex ``kept`` and is used by no cell.
    markers : dict of str to array, optional
        A one-dimensional array of length m gives a value to each cell. An integer array of shape (c, j)
        names c faces by their j vertices: (c, 1) vertices, (c, 2) edges, (c, 3) triangles, (c, 4)
        quadrilaterals; beside cells that are no simplices, shorter rows end in -1, as in `boundary`.
    weights : array_like, shape (n,), optional
        Weights of the points: the mesh claims to be their regular triangulation (`unstruct.delaunay` with
        ``weights``) and not that of the bare points. `oriented` and `select` keep them, files do not.
    hidden : array_like of int, shape (h,), optional
        Vertices that no cell uses because their power cells are empty.
    cells : dict of str to array, optional
        Instead of ``simplices``: kind -> rows of vertices, by meshio's names ("triangle", "quad", "tetra",
        "hexahedron", "wedge", "pyramid", "polygon", ...), all of one dimension; "polygon" may be a list of
        rows of different lengths. Cells are numbered through the kinds in their order; the first three
        corners of a wedge turn left seen from the other three.
    regions : dict of str to int, optional
        Names of values of the marker "region": the cells of region ``name`` are those with
        ``mesh.markers["region"] == mesh.regions[name]``. Values without a name are allowed.
    periodic : iterable of (motion, pairs), optional
        Sides that match, as `Domain.matched` makes them: rows (vertex, image), and the motion that gives
        the place of the image, None if it is not known. `pairs` has all of them.

    Raises
    ------
    InputError
        For arrays of wrong shape, type or range; the message names the first offending row.

    Notes
    -----
    All arrays are read-only views and are not copied where the type already fits. The methods return new
    meshes. Validation is O(n + m); adjacency and the rest are computed once, when asked for.
    """

    @property
    def convex_hull(self) -> np.ndarray:
        """Facets of the convex hull of the points, as SciPy's `Delaunay.convex_hull`: int32, (h, d).

        This is the boundary of the mesh if that is convex (always so for a Delaunay mesh); otherwise it is
        the boundary of the Delaunay mesh of the points.
        """
        if self.is_simplicial and self.dimension == self.points.shape[1] and boundary_is_convex(self):
            return self.boundary
        return _delaunay(self.points).boundary

    # ------------------------------------------------------------------ geometry

    @cached_property
    def volumes(self) -> np.ndarray:
        """Length, area or volume of each cell, signed where k = d."""
        return frozen(cell_volumes(self))

    @property
    def volume(self) -> float:
        """Total length, area or volume (the sum of `volumes`, correctly rounded)."""
        return total(self.volumes)

    def quality(self, name: str) -> np.ndarray:
        """One number for the shape of each cell, in the order of the cells.

        Parameters
        ----------
        name : str
            For simplices the names that `unstruct.simplex.quality` lists. All kinds of cells have
            "scaled_jacobian" (the least determinant of unit edge vectors at a corner, over that of the
            ideal cell: 1 at best, at most 0 for cells turned or flat at a corner) and "min_angle",
            "max_angle" (degrees: inner angles in quadrilaterals and polygons, those of all faces in
            solids).

        Returns
        -------
        ndarray, shape (m,)

        Raises
        ------
        InputError
            For a name that is not known, or not for the kinds of cells in the mesh.

        Notes
        -----
        The ideal cells are the regular polygon, the cube, the right wedge over an equilateral triangle,
        and the pyramid of eight equal edges. A pyramid is measured by the four tetrahedra of three successive
        corners of its base and the apex, each from the base and from the apex. Hexahedra are measured at
        their corners alone (Verdict adds the center). Sources: P. M. Knupp, *Algebraic mesh quality
        metrics*, SIAM J. Sci. Comput. 23 (2001) 193-218; the Verdict library, SAND2007-1751.
        """
        return cell_quality(self, name)

    def jacobian_signs(self) -> np.ndarray:
        """The sign of the Jacobian over each whole cell: exact, for cells of all kinds.

        Returns
        -------
        ndarray of int8, shape (m,)
            1 where the Jacobian of the (multi)linear map is positive everywhere in the closed cell, -1
            where it is negative everywhere, 0 where it vanishes somewhere or changes its sign. The apex of a
            pyramid, where it always vanishes, is left out. Polygons have no such map: their sign is 1 if they
            are simple and counterclockwise, -1 if they are simple and clockwise, and 0 otherwise.

        Raises
        ------
        MeshError
            For cells of lower dimension than space.

        Notes
        -----
        Positive signs at the corners are enough for simplices, quadrilaterals and pyramids, but not for
        wedges, where three quadratics decide, and hexahedra, whose 27 Bernstein coefficients are bounded on
        ever smaller parts (`unstruct.geometry.jacobians`). A hexahedron whose least Jacobian is so near zero
        that the budget ends first has the sign 0, and `unstruct.check` reports it as undecided. O(m).
        """
        return jacobian_signs(self)[0]

    @cached_property
    def _locator(self) -> Locator:
        return Locator(self)

    def find_simplex(self, x: Any) -> np.ndarray:
        """The cell that contains each point, by exact signs; -1 outside.

        Parameters
        ----------
        x : array_like, shape (..., d)

        Returns
        -------
        ndarray of int32, shape (...)
            Cells are closed; a point in several cells has the lowest of their numbers.

        Notes
        -----
        "Simplex" is SciPy's word: cells of all kinds are found. Quadrilaterals and polygons of the plane
        need not be convex; the even-odd rule decides if they cross themselves. In space a quadrilateral face
        is cut along the diagonal through its lowest vertex number. That is exact if the face is plane;
        otherwise its two cells agree, so that cells tile without gaps or overlaps. Cells whose corners all
        lie on a line (in space: in a plane) contain nothing.

        The mesh need be neither convex nor connected. A tree of bounding boxes, built on the first call in
        O(m log m), leads to a few cells each, which exact orientation signs decide.
        """
        return self._locator.find(x)

    def holding(
        self, points: np.ndarray, vertices: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """All pairs (row of ``points``, closed cell that contains it), sorted by rows, without flat cells.

        Parameters
        ----------
        points : ndarray, shape (k, d)
        vertices : ndarray of int, shape (k,), optional
            Vertices of a mesh of simplices that are these points: cells of which they are corners do not
            count.

        Returns
        -------
        rows, cells : ndarray of int64, shape (p,)
        """
        return self._locator.holding(points, vertices)

    def summary(self) -> dict[str, Any]:
        """Counts and quality statistics: a dictionary, which prints as a short text."""
        return summarize(self)

    # ------------------------------------------------------------------ new meshes

    def oriented(self) -> Mesh:
        """The mesh with negatively oriented cells turned (their first two vertices swapped); k = d only.

        A cell is negative if its area or volume is, by exact signs. Quadrilaterals, polygons and the bases
        of pyramids keep their first corner and list the others backward; wedges and hexahedra do so in both
        of their faces, bottom and top.
        """
        return Mesh(
            self.points,
            cells=turned_cells(self),
            origin=self.origin,
            duplicates=self.duplicates,
            markers=self.markers,
            weights=self.weights,
            hidden=self.hidden,
            regions=self.regions,
            periodic=self.periodic,
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
            `origin` still points to the input vertices; per-cell markers, weights, and the named faces and
            pairs of vertices that remain are kept; `duplicates` is empty.

        Notes
        -----
        Cells of several kinds stay grouped by kind, in the order of the kinds, and within each kind in the
        order asked for; so do markers of cells. Kinds of which no cell is kept are left out, so that the
        triangles alone of a mixed mesh are simplices; if no cell is kept at all, all kinds stay, empty.
        """
        chosen = np.asarray(mask)
        if chosen.dtype == bool and chosen.shape != (self.size,):
            raise InputError(f"mask must have shape ({self.size},), not {chosen.shape}")
        if chosen.dtype != bool and (chosen.ndim != 1 or (chosen.size and chosen.dtype.kind not in "iu")):
            raise InputError("mask must be booleans, one per cell, or cell numbers")
        if chosen.dtype != bool and chosen.size and not 0 <= chosen.min() <= chosen.max() < self.size:
            raise InputError(f"cell numbers must lie in 0..{self.size - 1}")
        chosen = np.nonzero(chosen)[0] if chosen.dtype == bool else chosen.astype(np.int64)
        return Mesh(**selected(self, chosen))

    # ------------------------------------------------------------------ pictures and files

    def plot(
        self,
        ax: Any = None,
        *,
        role: str = "cell",
        names: bool = False,
        vertices: bool | None = None,
        values: Any = None,
        label: str = "",
        azimuth: float | None = None,
        elevation: float | None = None,
        explode: float | None = None,
        section: Any = None,
        cut: str | None = None,
        together: Any = None,
    ) -> Any:
        """Draw with matplotlib, on new axes or on ``ax``; see `unstruct.view.plot` for the options."""
        shown = {"role": role, "names": names, "vertices": vertices, "values": values, "label": label}
        shown |= {"azimuth": azimuth, "elevation": elevation, "explode": explode}
        return _plot(self, ax, **shown, section=section, cut=cut, together=together)

    def write(
        self,
        path: str | Path,
        *,
        version: str | None = None,
        binary: bool | None = None,
        thickness: float | None = None,
        point_data: Mapping[str, Any] | None = None,
        cell_data: Mapping[str, Any] | None = None,
    ) -> None:
        """Write a file; its suffix, in letters of any size, chooses the format.

        Parameters
        ----------
        path : str or Path
            A folder named "polyMesh" becomes OpenFOAM's mesh: of solid cells, or of one layer of prisms over
            a planar mesh.
        version : str, optional
            Of Gmsh's format: "2.2", the default without ``cell_data``, or "4.1".
        binary : bool, optional
            Binary instead of text: .msh (text by default), .vtu, .vtk, .stl, .ply, .xdmf.
        thickness : float, optional
            Of the layer over a planar mesh in polyMesh; by default a tenth of the longer side of its box.
        point_data, cell_data : dict of str to array_like, optional
            Fields by name, (n,) or (n, k) at the points, (m,) or (m, k) in the cells, in their order, for
            .vtu, .vtk, .xdmf, .msh (real there, in rows padded to 1, 3, 9). ``meshio.read`` has them all,
            `Mesh.read` takes one number per cell for a marker.

        Raises
        ------
        InputError
            If the format has no cells of some kind in the mesh, no such option or no fields, for fields of
            wrong shapes or names, and if the file cannot be written: the old file is then untouched.
        MissingPackageError
            For meshio's formats without meshio, and for .xdmf and others without h5py.

        Notes
        -----
        The table shows what `Mesh.read` finds again; a warning names the rest, such as weights. Only .msh
        stores `periodic`, with its motions, as Gmsh does (which itself reads them in version 4.1 alone).
        Another warning lists names that a format must change; .su2 and polyMesh have only these, while codes
        of quotes, brackets and percent signs in .msh, .vtu and .xdmf are turned back by `Mesh.read`:

        ============ ============== ================= ==================== ===================
        format       points, cells  origin, copies    markers of faces     markers of cells
        ============ ============== ================= ==================== ===================
        .vtu, .vtk   yes            yes               all, empty ones too  all
        .xdmf        yes            yes               all, empty ones too  all
        .msh         yes            yes               one for each face    "region"
        .mesh        yes            no                one for each face    "region"
        .su2         yes            no                one, boundary only   no
        polyMesh     (not read)     no                one for each face    "region"
        .node, .ele  simplices      no                no                   no
        others       yes            no                no                   no
        ============ ============== ================= ==================== ===================

        .msh, .su2, polyMesh, .node and .ele need no other package, the others meshio. Names of regions are
        kept where markers of cells are. In .msh markers are Gmsh's physical groups (`unstruct.mesh.gmsh`):
        those of cells have the names of regions, or "region 0", ... without one. In .vtu, .vtk and .xdmf
        names are field data, "region:<name>", with the number of the region; in .mesh (Medit), whose cells
        and faces have numbers, they are comments. A face in several markers is in the group of the first one
        other than "facets" and "inner", which follow from where the mesh ends. In polyMesh such groups are
        patches, and zones of faces inside; regions are zones of cells. .msh and .su2 have no polygons; .vtu
        and .vtk store all kinds, and polygons in their order.

        Kinds without cells are left out, as in `select`; .node and .ele alone store a mesh without any cell.
        Formats of meshio may group the kinds in another order, and store as many digits as they have (.bdf
        9 to 12). .svg is a picture.
        """
        given = {"version": version, "binary": binary, "thickness": thickness}
        files.write(self, path, **given, point_data=point_data, cell_data=cell_data)  # type: ignore[arg-type]

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Read a file by its suffix: Gmsh's .msh, .su2, Triangle's .node/.ele, or any format of meshio.

        Parameters
        ----------
        path : str or Path
            A .node file without its .ele is a set of points: the mesh has no cells.

        Raises
        ------
        InputError
            If there is no such file, or it is not what its suffix says; the message names the file and,
            in formats of text that need no other package, the line or section.

        Notes
        -----
        Cells of second or higher order are read by their corners, with a warning.
        """
        return cls(**files.read(path))

    def to_meshio(self) -> Any:
        """The mesh as a `meshio.Mesh`; a warning names weights and sides that match, which it cannot have."""
        return files.to_meshio(self)

    def to_skfem(self) -> Any:
        """The mesh as a scikit-fem mesh: `MeshLine`, `MeshTri`, `MeshTet`, `MeshQuad` or `MeshHex`.

        A warning names what it cannot have: weights, sides that match, markers with real numbers and of
        vertices. For periodic conditions ``mesh.pairs`` has the vertices to identify.
        """
        return files.to_skfem(self)

    def _repr_html_(self) -> str:
        return card.html(self)


def is_planar(mesh: Any) -> bool:
    """Whether this is a mesh whose cells are all triangles, of points with two coordinates."""
    if not isinstance(mesh, Mesh):
        return False
    return mesh.is_simplicial and mesh.dimension == 2 and mesh.points.shape[1] == 2
