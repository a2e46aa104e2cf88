"""VoronoiComplex: which vertices, ridges and rays a Voronoi diagram has, and where; `Voronoi` measures it."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...mesh.mesh import Mesh
from ...predicates.batch import power_of_two
from ...predicates.power import power_factor
from .centers import local_circumcenters, outward_normals, volumes
from .dual import cospherical_groups, find_ridges, planar_rings
from .given import not_delaunay, refuse_others
from .line import chain_of_sites, ridges_of_chain

__all__ = ["VoronoiComplex"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


class VoronoiComplex:
    """The dual of a Delaunay mesh, without measures; see `Voronoi`."""

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.points, self.duplicates = (
            self.mesh.points,
            self.mesh.duplicates,
        )  # read-only, which pickle forgets

    def __init__(self, mesh: Mesh, *, _trusted: bool = False):
        if not isinstance(mesh, Mesh):
            raise InputError(f"mesh must be a Mesh, not {type(mesh).__name__}: give delaunay(points)")
        points, simplices = mesh.points, mesh.simplices
        n, d = points.shape
        if simplices.shape[1] != d + 1:
            raise InputError(
                f"the mesh has cells with {simplices.shape[1]} vertices in {d} dimensions; "
                f"a diagram needs simplices with {d + 1}, as delaunay(points) makes them"
            )
        if not _trusted and len(simplices):
            refuse_others(mesh)
        self.mesh, self.points, self.weights = mesh, points, mesh.weights
        self.duplicates = mesh.duplicates
        used = np.zeros(n, dtype=bool)
        used[simplices if len(simplices) else slice(None)] = True
        used[mesh.hidden] = True
        used[self.duplicates[:, 0]] = False
        self._sites = np.flatnonzero(used)  # the site that represents each region
        self.point_region = np.full(n, -1, dtype=np.int32)
        self.point_region[self._sites] = np.arange(len(self._sites))
        self.point_region[self.duplicates[:, 0]] = self.point_region[self.duplicates[:, 1]]
        every = len(self._sites) == n  # then regions have the numbers of sites, and no array is copied
        # the simplices, with numbers of regions as corners
        self._cells = simplices if every else self.point_region[simplices]
        self._scale = power_of_two(points)
        if self.weights is not None:
            self._scale = min(self._scale, power_factor(points, self.weights))
        own = points if every else points[self._sites]
        self._weights = np.zeros(len(own)) if mesh.weights is None else mesh.weights[self._sites]
        self.simplex_vertex, wrong = cospherical_groups(
            points, simplices, mesh.neighbors, weights=mesh.weights
        )
        if wrong is not None:
            raise not_delaunay(mesh, *wrong)
        if len(simplices):
            self._ridges = find_ridges(own, self._cells, mesh.neighbors, self.simplex_vertex)
        else:
            self._ridges = ridges_of_chain(self._chain)
        pairs = self._ridges.points
        self.ridge_points = pairs if every else self._sites[pairs].astype(np.int32)
        self._base, self._offset = self._centers(own)
        with np.errstate(over="ignore"):
            self.vertices = (own * self._scale)[self._base]
            self.vertices /= self._scale
            self.vertices += self._offset / self._scale
        facets = self._ridges.ray_facets
        self.ray_vertices = self.simplex_vertex[facets // (d + 1)]
        self.ray_directions = outward_normals(own, self._cells, facets, self._scale) + 0.0  # no -0.0

    def _centers(self, own: Floats) -> tuple[Ints, Floats]:
        """One center for each vertex, computed from the largest of its simplices."""
        cells = self._cells
        if len(cells) == 0:
            return np.empty(0, dtype=np.int32), np.empty((0, own.shape[1]))
        if len(cells) > self.simplex_vertex.max() + 1:
            order = np.lexsort((-volumes(own, cells, self._scale), self.simplex_vertex))
            cells = cells[order[np.unique(self.simplex_vertex[order], return_index=True)[1]]]
        return local_circumcenters(own, cells, self._scale, None if self.weights is None else self._weights)

    @cached_property
    def _chain(self) -> NDArray[np.int64]:
        """The regions along a line that contains all sites."""
        return chain_of_sites(self.points[self._sites], self._weights)

    # --- regions and ridges as lists, as in SciPy --------------------------------------------------

    @cached_property
    def _rings(self) -> tuple[NDArray[np.int64], Ints]:
        """Vertices around each region, compressed; counterclockwise in the plane; -1 first if unbounded."""
        count, (m, width) = len(self._sites), self._cells.shape
        start = np.zeros(count + 1, dtype=np.int64)
        if m == 0:  # on a line
            start[1:] = np.cumsum(self.unbounded)
            return start, np.full(start[-1], -1, dtype=np.int32)
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
        if len(self._cells) == 0:  # on a line
            on_hull[self._chain] = True
            return on_hull
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


def _lists(start: NDArray[np.int64], flat: Ints) -> list[list[int]]:
    values = flat.tolist()
    return [values[a:b] for a, b in pairwise(start.tolist())]
