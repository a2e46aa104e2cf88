"""Voronoi diagrams, the duals of Delaunay triangulations (12.2.1 of the chapter, 2.1 of the book)."""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count
from ...base.arrays import as_points, as_weights
from ...base.doors import door
from ...base.errors import DegenerateInputError, InputError
from ...mesh.mesh import Mesh
from ..insertion.copies import distinct_points
from ..insertion.delaunay import delaunay
from .clip import Cells, Pairs, clip_cells
from .complex import VoronoiComplex
from .measures import cell_sizes
from .nearest import NearestSite
from .window import Window, as_window

__all__ = ["Relaxation", "Voronoi", "voronoi"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

_plot_voronoi = door("unstruct.view:plot_voronoi")


def voronoi(points: ArrayLike, *, weights: ArrayLike | None = None) -> Voronoi:
    """Voronoi diagram (Dirichlet tessellation) of points; with weights, their power diagram.

    Parameters
    ----------
    points : array_like, shape (n, d)
        The sites, finite. From three dimensions on they must not all be in one hyperplane. In the plane they
        may lie on a line, and there may be one or two: regions are then strips (half-planes, the plane),
        which a window cuts. Equal sites share a region.
    weights : array_like, shape (n,), optional
        A weight w for each site p, in the units of a squared length: "nearest" then means the least
        ``|x - p|^2 - w``. Regions stay convex, but a site may lie outside of its own, and that of a hidden
        site is empty.

    Returns
    -------
    Voronoi
        The diagram; its vertices, ridges and regions have the same names as in SciPy.

    Raises
    ------
    InputError
        For a wrong shape or type, or coordinates that are not finite.
    DegenerateInputError
        If the sites lie in a hyperplane, but for the plane. Their cells are then prisms over the diagram in
        that hyperplane, and have no vertices; project the sites onto it.

    Notes
    -----
    The diagram is the dual of `unstruct.delaunay`, so that its combinatorics are exact: which vertices lie
    around a cell, which cells share a ridge, and which are unbounded. Sites on a common empty sphere share
    one vertex; for example, the four corners of a square have one vertex of degree four. The cost is that of
    `delaunay`, plus O(size of the diagram). Book: 2.1. Sources: G. L. Dirichlet, J. reine angew. Math. 40
    (1850) 209-227; G. Voronoi, ibid. 134 (1908) 198-287; B. Delaunay, Bull. Acad. Sci. URSS (1934) 793-800.

    Examples
    --------
    >>> import unstruct
    >>> diagram = unstruct.voronoi([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    >>> diagram
    Voronoi(5 regions (4 unbounded) of 5 sites in 2D, 4 vertices, 8 ridges)
    >>> diagram.areas().round(12).tolist()
    [inf, inf, inf, inf, 0.5]
    >>> unstruct.voronoi([[0, 0], [1, 0], [1, 1], [0, 1]]).vertices.tolist()
    [[0.5, 0.5]]
    """
    rows = as_points(points)
    heavy = None if weights is None else as_weights(weights, len(rows))
    if rows.shape[1] != 2 or len(rows) == 0:
        return Voronoi(delaunay(rows, weights=heavy), _trusted=True)
    try:
        if len(rows) > 2:
            return Voronoi(delaunay(rows, weights=heavy), _trusted=True)
    except DegenerateInputError:
        pass
    return Voronoi(_on_a_line(rows, heavy))


def _on_a_line(rows: Floats, weights: Floats | None) -> Mesh:
    """Sites on a line as a mesh without triangles."""
    duplicates = distinct_points(rows, weights)[1]
    return Mesh(rows, np.empty((0, 3), dtype=np.int32), duplicates=duplicates, weights=weights)


class Relaxation(NamedTuple):
    """The result of `Voronoi.relax`."""

    voronoi: Voronoi  # the diagram of the moved sites
    energies: Floats  # the energies before each iteration and after the last one
    idle: NDArray[np.int64]  # the sites whose cells in the last diagram do not meet the window


class Voronoi(VoronoiComplex):
    """The dual of a Delaunay mesh; see `voronoi`.

    Parameters
    ----------
    mesh : Mesh
        A Delaunay triangulation of full dimension, for example from `unstruct.delaunay`. In the plane also
        points on a line, without triangles.

    Raises
    ------
    InputError
        For cells that are no simplices of full dimension.
    MeshError
        For a mesh that is not Delaunay; the message names a facet. For cells that are flat, turned, or
        overlap, and for a mesh that does not fill the convex hull of its points. All this is exact, and costs
        little more than the diagram.

    Attributes
    ----------
    points : ndarray, shape (n, d)
        The sites, as given.
    vertices : ndarray, shape (v, d)
        Each vertex is the center of an empty sphere through at least d + 1 sites; infinite if it lies beyond
        the range of doubles.
    ridge_points : ndarray of int32, shape (r, 2)
        The two sites of each ridge, a facet between two cells.
    point_region : ndarray of int32, shape (n,)
        The region of each site; equal sites share one.
    simplex_vertex : ndarray of int32, shape (m,)
        The vertex at the circumcenter of each Delaunay simplex.
    ray_vertices, ray_directions : ndarrays, shapes (h,), (h, d)
        The unbounded edges: the vertex where each starts, and its unit direction.
    duplicates : ndarray of int32, shape (c, 2)
        Equal sites, as rows (copy, kept); of sites with weights the heaviest is kept.
    weights : ndarray, shape (n,), or None
        Without weights, None.
    mesh : Mesh
        The Delaunay mesh.
    """

    # --- measures ----------------------------------------------------------------------------------

    def areas(self, clip: Any = None) -> Floats:
        """Areas of the regions (lengths on the line, volumes in space).

        Parameters
        ----------
        clip : optional
            A window, as for `clip` (only in the plane).

        Returns
        -------
        ndarray, shape (regions,)
            ``inf`` for unbounded regions without a window. ``areas()[point_region]`` has the areas by site.

        Notes
        -----
        A cell is divided into pyramids over its ridges with the site as apex. The height of a pyramid is half
        the distance of the two sites, so no term is negative. (With weights the height is signed, as a site
        may be outside of its cell.)
        """
        if clip is not None:
            return self._unscaled(self._clipped(clip)[2][:, 0], 2)
        d = self.points.shape[1]
        if d > 3:
            raise InputError(f"areas are computed in at most three dimensions, not in {d}")
        own, heavy = self.points[self._sites] * self._scale, self._heavy
        total = cell_sizes(own, heavy, self._ridges, self._base, self._offset)
        total[self.unbounded] = np.inf
        return self._unscaled(total, d)

    def _unscaled(self, values: Any, power: int) -> Any:
        """Scaled quantities in the units of the input; ``scale**power`` itself might underflow."""
        with np.errstate(over="ignore", under="ignore"):
            for _ in range(power):
                values = values / self._scale
        return values

    @property
    def _heavy(self) -> Floats:
        """The weights in scaled units."""
        return self._weights * self._scale * self._scale

    def clip(self, window: Any) -> list[Floats] | list[list[Floats]]:
        """The regions of a planar diagram, cut by a window.

        Parameters
        ----------
        window : array_like, sequence of array_like, Domain, or geometry
            A box ((x0, y0), (x1, y1)); the corners (k, 2) of a polygon, in either direction, closed or not,
            convex or not; several rings, of which the first is the outline and the others are holes; a
            `Domain`, whose curves are replaced by chords that turn by a degree at most; a GeoJSON mapping or
            an object with ``__geo_interface__``, such as shapely's polygons.

        Returns
        -------
        list of ndarray, shapes (k, 2)
            For a box or one convex polygon: the corners of each region, counterclockwise; none if it does not
            meet the window.
        list of list of ndarray
            For all other windows: each region as convex polygons with disjoint interiors, in the same form.
            In a window that is not convex, a region may have several parts or holes; it is cut along
            diagonals of the window.

        Raises
        ------
        InputError
            For a window that is empty, whose sides cross or overlap (the message names them), whose holes are
            not inside, or whose polygons overlap; for a diagram that is not planar.

        Notes
        -----
        Which window it is, is decided exactly; corners of the regions are rounded. O(n + w log w) for a
        convex window with w corners; otherwise each region is cut by all convex pieces of the window that its
        bounding box meets.
        """
        shape = as_window(window)
        pairs, polygons, _ = self._clipped(shape)
        parts = [polygon / self._scale for polygon in polygons]
        if shape.convex:
            return parts
        regions: list[list[Floats]] = [[] for _ in self._sites]
        for site, part in zip(pairs.site.tolist(), parts):
            if len(part):
                regions[site].append(part)
        return regions

    def _clipped(self, window: Any) -> tuple[Pairs, list[Floats], Floats]:
        """Regions with pieces of the window, their polygons, and moments, all in scaled units."""
        if self.points.shape[1] != 2:
            raise InputError(f"a window needs a planar diagram, not one in {self.points.shape[1]} dimensions")
        shape, own = as_window(window), self.points[self._sites] * self._scale
        shape = Window(shape.corner * self._scale, shape.start, shape.convex)
        cells = Cells(*self._rings, self._base, self._offset, *self._links, self._heavy)
        found = clip_cells(own, shape, cells)
        if not np.isfinite(found[2]).all():
            raise InputError(
                "the window is too large for the spacing of the sites, so that areas overflow; shrink it"
            )
        return found

    def relax(self, iterations: int = 1, clip: Any = None) -> Relaxation:
        """Lloyd's relaxation: move every site to the centroid of its cell, and repeat.

        Parameters
        ----------
        iterations : int
        clip : optional
            The window by which the cells are cut, as for `clip`; by default the bounding box of the sites.

        Returns
        -------
        Relaxation
            The last diagram; the energies (the integral over the window of the squared distance to the
            nearest site), which never rise except by rounding; and the sites whose cells do not meet the
            window, which therefore do not move.

        Notes
        -----
        Source: S. P. Lloyd, IEEE Trans. Inform. Theory 28 (1982) 129-137. Each step lowers the energy for two
        reasons: the centroid is the best site for a cell, and the nearest site is the best one for a point.
        The centroid of a cell in a window that is not convex may lie outside (in a hole, or beyond a bend).
        The site moves there all the same, as the energy demands. Weights, if there are any, stay with their
        sites, and w times the area of the cell is subtracted from the energy.
        """
        iterations = as_count(iterations, "iterations")
        if clip is None:
            clip = np.stack([self.points.min(axis=0), self.points.max(axis=0)])
        window = as_window(clip)
        diagram, energies = self, []
        moments = self._clipped(window)[2]
        for _ in range(iterations):
            energies.append(diagram._energy(moments))
            area = moments[:, :1]
            step = np.divide(moments[:, 1:3], area, out=np.zeros((len(area), 2)), where=area > 0)
            moved = diagram.points[diagram._sites] + step / diagram._scale
            diagram = voronoi(moved[diagram.point_region], weights=diagram.weights)
            moments = diagram._clipped(window)[2]
        energies.append(diagram._energy(moments))
        idle = np.flatnonzero((moments[:, 0] <= 0)[diagram.point_region])
        return Relaxation(diagram, np.array(energies), idle)

    def _energy(self, moments: Floats) -> Any:
        return self._unscaled((moments[:, 3] - self._heavy * moments[:, 0]).sum(), 4)

    # --- queries -----------------------------------------------------------------------------------

    @cached_property
    def _search(self) -> NearestSite:
        if self.weights is not None:
            return NearestSite(self.points, self._sites, self.weights)
        lowest = np.full(len(self._sites), len(self.points), dtype=np.intp)
        np.minimum.at(lowest, self.point_region, np.arange(len(self.points)))
        return NearestSite(self.points, lowest)

    def nearest(self, x: ArrayLike) -> Any:
        """The nearest site, exactly; of several at the same distance, the first one; with weights, by power.

        Parameters
        ----------
        x : array_like, shape (..., d)
            Query points; any finite coordinates are allowed.

        Returns
        -------
        int or ndarray of intp, shape (...)
            Indices of sites.

        Notes
        -----
        A search tree finds the candidates in O(log n). If two distances agree to ten digits, rational
        arithmetic decides.
        """
        return self._search(x)

    # --- display -----------------------------------------------------------------------------------

    def plot(
        self,
        ax: Any = None,
        *,
        delaunay: bool = False,
        sites: bool = True,
        vertices: bool = True,
        view: Any = None,
    ) -> Any:
        """Draw a planar diagram, on new axes or on ``ax``; see `unstruct.view.plot_voronoi`."""
        return _plot_voronoi(self, ax, delaunay=delaunay, sites=sites, vertices=vertices, view=view)

    def __repr__(self) -> str:
        n, d = self.points.shape
        return (
            f"Voronoi({len(self._sites)} regions ({int(self.unbounded.sum())} unbounded) of {n} sites "
            f"in {d}D, {len(self.vertices)} vertices, {len(self.ridge_points)} ridges)"
        )
