"""Voronoi diagrams, the duals of Delaunay triangulations (12.2.1 of the chapter, 2.1 of the book)."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.doors import door
from ...base.errors import InputError
from ...mesh.mesh import Mesh
from ...predicates.batch import power_of_two
from ..insertion.delaunay import delaunay
from .centers import local_circumcenters, outward_normals, volumes
from .clip import as_window, clip_cells
from .dual import cospherical_groups, find_ridges, planar_rings
from .nearest import NearestSite

__all__ = ["Relaxation", "Voronoi", "voronoi"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

_plot_voronoi = door("unstruct.view:plot_voronoi")


def voronoi(points: ArrayLike) -> Voronoi:
    """Voronoi diagram (Dirichlet tessellation) of points.

    Parameters
    ----------
    points : array_like, shape (n, d)
        The sites. They must be finite and not all in one hyperplane. Equal sites share a region.

    Returns
    -------
    Voronoi
        The diagram; its vertices, ridges and regions have the same names as in SciPy.

    Raises
    ------
    InputError
        For a wrong shape or type, or coordinates that are not finite.
    DegenerateInputError
        If the sites lie in a hyperplane. Their cells are then prisms over the diagram in that hyperplane, and
        have no vertices; project the sites onto it.

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
    return Voronoi(delaunay(points))


class Relaxation(NamedTuple):
    """The result of `Voronoi.relax`."""

    voronoi: Voronoi  # the diagram of the moved sites
    energies: Floats  # the energies before each iteration and after the last one
    idle: NDArray[np.int64]  # the sites whose cells in the last diagram do not meet the window


class Voronoi:
    """The dual of a Delaunay mesh; see `voronoi`.

    Parameters
    ----------
    mesh : Mesh
        A Delaunay triangulation of full dimension, for example from `unstruct.delaunay`.

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
        Equal sites, as rows (copy, kept).
    mesh : Mesh
        The Delaunay mesh.
    """

    def __init__(self, mesh: Mesh):
        points, simplices = mesh.points, mesh.simplices
        n, d = points.shape
        if simplices.shape[1] != d + 1:
            raise InputError(
                f"the mesh has cells with {simplices.shape[1]} vertices in {d} dimensions; "
                f"a diagram needs simplices with {d + 1}, as delaunay(points) makes them"
            )
        self.mesh, self.points = mesh, points
        self.duplicates = mesh.duplicates
        used = np.zeros(n, dtype=bool)
        used[simplices] = True
        used[self.duplicates[:, 0]] = False
        self._sites = np.flatnonzero(used)  # the site that represents each region
        self.point_region = np.full(n, -1, dtype=np.int32)
        self.point_region[self._sites] = np.arange(len(self._sites))
        self.point_region[self.duplicates[:, 0]] = self.point_region[self.duplicates[:, 1]]
        self._cells = self.point_region[simplices]  # the simplices, with numbers of regions as corners
        self._scale = power_of_two(points)
        self.simplex_vertex = cospherical_groups(points, simplices, mesh.neighbors)
        own = points[self._sites]
        self._ridges = find_ridges(own, self._cells, mesh.neighbors, self.simplex_vertex)
        self.ridge_points = self._sites[self._ridges.points].astype(np.int32)
        self._base, self._offset = self._centers(own)
        with np.errstate(over="ignore"):
            self.vertices = (own * self._scale)[self._base] / self._scale + self._offset / self._scale
        facets = self._ridges.ray_facets
        self.ray_vertices = self.simplex_vertex[facets // (d + 1)]
        self.ray_directions = outward_normals(own, self._cells, facets, self._scale) + 0.0  # no -0.0

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.points, self.duplicates = (
            self.mesh.points,
            self.mesh.duplicates,
        )  # read-only, which pickle forgets

    def _centers(self, own: Floats) -> tuple[Ints, Floats]:
        """One center for each vertex, computed from the largest of its simplices."""
        cells = self._cells
        if len(cells) > self.simplex_vertex.max() + 1:
            order = np.lexsort((-volumes(own, cells, self._scale), self.simplex_vertex))
            cells = cells[order[np.unique(self.simplex_vertex[order], return_index=True)[1]]]
        return local_circumcenters(own, cells, self._scale)

    # --- regions and ridges as lists, as in SciPy --------------------------------------------------

    @cached_property
    def _rings(self) -> tuple[NDArray[np.int64], Ints]:
        """Vertices around each region, compressed; counterclockwise in the plane; -1 first if unbounded."""
        count, (m, width) = len(self._sites), self._cells.shape
        start = np.zeros(count + 1, dtype=np.int64)
        if width == 3:
            ring = np.empty(3 * m + count, dtype=np.int32)
            first = np.empty(count, dtype=np.int32)
            args = self._cells, self.mesh.neighbors, self.simplex_vertex
            return start, ring[: planar_rings(*args, first, start, ring)]
        most = int(self.simplex_vertex.max()) + 2
        key = self._cells.astype(np.int64) * most + self.simplex_vertex[:, None] + 1
        outside = np.flatnonzero(self.unbounded) * most
        key = np.unique(np.concatenate([key.ravel(), outside]))
        start[1:] = np.cumsum(np.bincount(key // most, minlength=count))
        return start, (key % most - 1).astype(np.int32)

    @cached_property
    def unbounded(self) -> NDArray[np.bool_]:
        """Whether each region is unbounded, that is, whether its site is on the boundary of the hull."""
        cell, corner = np.nonzero(self.mesh.neighbors < 0)
        on_hull = np.zeros(len(self._sites), dtype=bool)
        for k in range(self._cells.shape[1]):
            on_hull[self._cells[cell[corner != k], k]] = True
        return on_hull

    @cached_property
    def regions(self) -> list[list[int]]:
        """Vertices of each region, counterclockwise in the plane; a leading -1 stands for infinity."""
        return _lists(*self._rings)

    @cached_property
    def ridge_vertices(self) -> list[list[int]]:
        """Vertices of each ridge, in cyclic order in space; a leading -1 stands for infinity.

        From three dimensions on, SciPy omits unbounded ridges with few vertices; here none is missing.
        """
        if self.points.shape[1] == 2:
            return self._ridges.vertices.reshape(-1, 2).tolist()
        return _lists(self._ridges.start, self._ridges.vertices)

    @cached_property
    def ridge_rays(self) -> list[list[int]]:
        """The rays that bound each ridge: one in the plane, two in space (at its first and last vertex)."""
        return _lists(self._ridges.ray_start, self._ridges.rays)

    @cached_property
    def _links(self) -> tuple[NDArray[np.int64], Ints]:
        """The neighbors of each region, compressed."""
        pairs = self._ridges.points
        tail, head = np.concatenate([pairs[:, 0], pairs[:, 1]]), np.concatenate([pairs[:, 1], pairs[:, 0]])
        order = np.lexsort((head, tail))
        return np.concatenate([[0], np.cumsum(np.bincount(tail, minlength=len(self._sites)))]), head[order]

    def neighbors(self, region: int) -> list[int]:
        """The regions that share a ridge with ``region``."""
        start, linked = self._links
        return linked[start[region] : start[region + 1]].tolist()

    # --- measures ----------------------------------------------------------------------------------

    def areas(self, clip: ArrayLike | None = None) -> Floats:
        """Areas of the regions (lengths on the line, volumes in space).

        Parameters
        ----------
        clip : array_like, optional
            A window, as for `clip` (only in the plane).

        Returns
        -------
        ndarray, shape (regions,)
            ``inf`` for unbounded regions without a window. ``areas()[point_region]`` has the areas by site.

        Notes
        -----
        A cell is divided into pyramids over its ridges with the site as apex. The height of a pyramid is half
        the distance of the two sites, so no term is negative.
        """
        if clip is not None:
            return self._unscaled(self._clipped(clip)[1][:, 0], 2)
        d = self.points.shape[1]
        if d > 3:
            raise InputError(f"areas are computed in at most three dimensions, not in {d}")
        pairs, own = self._ridges.points, self.points[self._sites] * self._scale
        height = np.sqrt(((own[pairs[:, 1]] - own[pairs[:, 0]]) ** 2).sum(axis=1)) / 2
        part = self._ridge_sizes(own) * height
        total = np.bincount(pairs.ravel(), np.repeat(part, 2), minlength=len(self._sites)) / d
        total[self.unbounded] = np.inf
        return self._unscaled(total, d)

    def _unscaled(self, values: Any, power: int) -> Any:
        """Scaled quantities in the units of the input; ``scale**power`` itself might underflow."""
        with np.errstate(over="ignore", under="ignore"):
            for _ in range(power):
                values = values / self._scale
        return values

    def _ridge_sizes(self, own: Floats) -> Floats:
        """Scaled lengths or areas of the bounded ridges; 0 for unbounded ones."""
        ridges, d = self._ridges, self.points.shape[1]
        count = np.diff(ridges.start)
        owner = np.repeat(np.arange(len(count)), count)
        bounded = ridges.vertices[ridges.start[:-1]] >= 0
        if d == 1:
            return bounded.astype(float)
        site, last = ridges.points[owner, 0], np.roll(np.arange(len(owner)), -1)
        last[ridges.start[1:] - 1] = ridges.start[:-1]
        kept = bounded[owner]
        corner = np.zeros((len(owner), d))  # relative to the first site of the ridge
        v = ridges.vertices[kept]
        corner[kept] = (own[self._base[v]] - own[site[kept]]) + self._offset[v]
        corner -= corner[np.repeat(ridges.start[:-1], count)]
        if d == 2:
            return np.sqrt((corner[ridges.start[1:] - 1] ** 2).sum(axis=1))
        turn = np.cross(corner, corner[last])
        return np.sqrt((np.add.reduceat(turn, ridges.start[:-1], axis=0) ** 2).sum(axis=1)) / 2

    def clip(self, window: ArrayLike) -> list[Floats]:
        """The regions of a planar diagram, cut by a convex window.

        Parameters
        ----------
        window : array_like
            A box ((x0, y0), (x1, y1)) or the corners (k, 2) of a convex polygon in either direction.

        Returns
        -------
        list of ndarray, shapes (k, 2)
            The corners of each region, counterclockwise; none if it does not meet the window.

        Raises
        ------
        InputError
            For a window that is not convex or is empty, and for a diagram that is not planar.
        """
        return [polygon / self._scale for polygon in self._clipped(window)[0]]

    def _clipped(self, window: ArrayLike) -> tuple[list[Floats], Floats]:
        """Polygons and moments, both in scaled units."""
        if self.points.shape[1] != 2:
            raise InputError(f"a window needs a planar diagram, not one in {self.points.shape[1]} dimensions")
        own, box = self.points[self._sites] * self._scale, as_window(window) * self._scale
        polygons, moments = clip_cells(own, box, self._rings, (self._base, self._offset), self._links)
        if not np.isfinite(moments).all():
            raise InputError(
                "the window is too large for the spacing of the sites, so that areas overflow; shrink it"
            )
        return polygons, moments

    def relax(self, iterations: int = 1, clip: ArrayLike | None = None) -> Relaxation:
        """Lloyd's relaxation: move every site to the centroid of its cell, and repeat.

        Parameters
        ----------
        iterations : int
        clip : array_like, optional
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
        """
        if iterations < 0:
            raise InputError(f"iterations = {iterations} must be at least 0")
        window = np.stack([self.points.min(axis=0), self.points.max(axis=0)]) if clip is None else clip
        diagram, energies = self, []
        moments = self._clipped(window)[1]
        for _ in range(iterations):
            energies.append(diagram._unscaled(moments[:, 3].sum(), 4))
            area = moments[:, :1]
            step = np.divide(moments[:, 1:3], area, out=np.zeros((len(area), 2)), where=area > 0)
            moved = diagram.points[diagram._sites] + step / diagram._scale
            diagram = voronoi(moved[diagram.point_region])
            moments = diagram._clipped(window)[1]
        energies.append(diagram._unscaled(moments[:, 3].sum(), 4))
        idle = np.flatnonzero((moments[:, 0] <= 0)[diagram.point_region])
        return Relaxation(diagram, np.array(energies), idle)

    # --- queries -----------------------------------------------------------------------------------

    @cached_property
    def _search(self) -> NearestSite:
        lowest = np.full(len(self._sites), len(self.points), dtype=np.intp)
        np.minimum.at(lowest, self.point_region, np.arange(len(self.points)))
        return NearestSite(self.points, lowest)

    def nearest(self, x: ArrayLike) -> Any:
        """The nearest site, exactly; of several at the same distance, the first one.

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

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw a planar diagram; see `unstruct.view.plot_voronoi` for the options."""
        return _plot_voronoi(self, ax, **options)

    def __repr__(self) -> str:
        n, d = self.points.shape
        return (
            f"Voronoi({len(self._sites)} regions ({int(self.unbounded.sum())} unbounded) of {n} sites "
            f"in {d}D, {len(self.vertices)} vertices, {len(self.ridge_points)} ridges)"
        )


def _lists(start: NDArray[np.int64], flat: Ints) -> list[list[int]]:
    values = flat.tolist()
    return [values[a:b] for a, b in pairwise(start.tolist())]
