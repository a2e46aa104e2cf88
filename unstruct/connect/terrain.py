"""A terrain as a triangulated surface, by greedy insertion (section 2.4a of the book).

The method starts with the corners of a grid of heights and inserts, repeatedly, the grid point at which the
error of the surface is largest. The worst point of each triangle is stored. An insertion changes only the
triangles of its star, so that few points of the grid are examined again.

Source: M. Garland and P. Heckbert, Fast polygonal approximation of terrains and height fields,
CMU-CS-95-181 (1995), algorithm III; R. Fowler and J. Little, SIGGRAPH 1979.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import as_flags
from ..base.errors import InputError
from ..base.jit import inline, kernel
from ..base.progress import progress_bar
from ..mesh.mesh import Mesh
from .insertion.triangulation import Triangulation

Triangle = tuple[int, int, int]

__all__ = ["Terrain", "greedy_terrain", "grid_surface"]


@dataclass(frozen=True)
class Terrain:
    """A surface over a grid, linear on each triangle.

    Attributes
    ----------
    mesh : Mesh
        The Delaunay triangulation of the chosen grid points, in the order of their insertion (the four
        corners first), in the units of ``spacing``.
    places : (n, 2) int64
        Row and column of each vertex.
    heights : (n,) float64
        Height of each vertex, as in the grid.
    errors : (n - 3,) float64
        ``errors[k]`` is the largest vertical error over the grid of the surface with 4 + k vertices.
    surface : (rows, columns) float64
        The surface at all grid points.
    """

    mesh: Mesh
    places: NDArray[np.int64]
    heights: NDArray[np.float64]
    errors: NDArray[np.float64]
    surface: NDArray[np.float64]

    def __repr__(self) -> str:
        return (
            f"<Terrain: {len(self.heights)} vertices, {len(self.mesh.simplices)} triangles, "
            f"error {self.errors[-1]:.4g}>"
        )

    def mesh3d(self) -> Mesh:
        """The surface itself, as a mesh of triangles in space."""
        points = np.column_stack([self.mesh.points, self.heights])
        return Mesh(points, self.mesh.simplices)


def greedy_terrain(
    heights: ArrayLike,
    *,
    count: int | None = None,
    tolerance: float = 0.0,
    spacing: tuple[float, float] = (1.0, 1.0),
    progress: bool = False,
) -> Terrain:
    """Approximate a grid of heights by a Delaunay triangulation of few of its points.

    Parameters
    ----------
    heights : (rows, columns) array
        Finite heights, at least 2 × 2. Row i, column j is the point ``(j dx, i dy)``.
    count : int, optional
        Stop with this many vertices (at least 4); without it, only ``tolerance`` decides.
    tolerance : float
        Stop as soon as no grid point has a vertical distance from the surface of more than this. The default
        0 asks for the exact surface.
    spacing : (dx, dy)
        Positive distances between columns and between rows. They are rounded to single precision, so that
        every product j·dx is exact and collinear grid points remain collinear.
    progress : bool
        Whether to show a progress bar.

    Returns
    -------
    Terrain

    Raises
    ------
    InputError
        For a wrong shape, a height that is not finite (the first one is named), a negative tolerance, a count
        below 4, or a spacing that is not positive.

    Notes
    -----
    Each step takes the point that is worst at the time, so the method is greedy and not optimal. The largest
    error can grow in a step. Examining the grid takes O((g + n) log n) for g grid points and n vertices if
    the triangles shrink evenly, and O(g n) in the worst case. The triangulation is copied after each
    insertion, which adds O(n^2) with a small constant: about a second for 2,400 vertices.
    """
    as_flags(progress=progress)
    grid, scale = _checked(heights, count, tolerance, spacing)
    last = grid.size if count is None else min(count, grid.size)
    growing = _Growing(grid, scale, last)
    errors = [growing.error()]
    with progress_bar(progress, " points", total=last, initial=growing.n) as bar:
        while growing.n < last and errors[-1] > tolerance:
            growing.insert_worst()
            errors.append(growing.error())
            bar.update()
    mesh = growing.triangulation.mesh()
    places = growing.places[: growing.n].copy()
    z = grid[places[:, 0], places[:, 1]]
    return Terrain(mesh, places, z, np.array(errors), grid_surface(mesh.simplices, places, z, grid.shape))


class _Growing:
    """The growing triangulation, and a heap that contains the worst place of each triangle."""

    def __init__(self, grid: NDArray[np.float64], scale: NDArray[np.float64], most: int):
        i, j = grid.shape[0] - 1, grid.shape[1] - 1
        self.grid, self.scale, self.n = grid, scale, 4
        self.places = np.zeros((most, 2), dtype=np.int64)
        self.places[:4] = [(0, 0), (0, j), (i, j), (i, 0)]
        self.heap: list[tuple[float, int, int, Triangle]] = []
        self.alive: set[Triangle] = set()
        self.triangulation = Triangulation(self._position(self.places[:4]))
        self._add(self.triangulation.mesh().simplices)

    def error(self) -> float:
        """The largest error, 0 if no entry is left; entries of removed triangles are dropped."""
        while self.heap and self.heap[0][3] not in self.alive:
            heapq.heappop(self.heap)
        return -self.heap[0][0] if self.heap else 0.0

    def insert_worst(self) -> None:
        """Insert the place on top of the heap; `error` must be called before, to drop removed triangles."""
        _, i, j, _ = heapq.heappop(self.heap)
        self.places[self.n] = i, j
        point = self._position(self.places[self.n])
        removed = self.triangulation.mesh().simplices[self.triangulation.cavity(point)]
        self.alive.difference_update(_name(triangle) for triangle in removed.tolist())
        self.triangulation.insert(point)
        simplices = self.triangulation.mesh().simplices
        self._add(simplices[(simplices == self.n).any(axis=1)])
        self.n += 1

    def _add(self, triangles: NDArray[np.int64]) -> None:
        """Examine all grid points in new triangles; keep the worst point of each triangle."""
        errors = np.zeros(len(triangles))
        worst = np.zeros((len(triangles), 2), dtype=np.int64)
        _worst(triangles, self.places, self.grid, errors, worst)
        for triangle, error, (i, j) in zip(triangles.tolist(), errors.tolist(), worst.tolist()):
            name = _name(triangle)
            self.alive.add(name)
            if error > 0:
                heapq.heappush(self.heap, (-error, i, j, name))

    def _position(self, places: NDArray[np.int64]) -> NDArray[np.float64]:
        """Coordinates (x, y), which are exact products because both factors have few bits."""
        return places[..., ::-1] * self.scale


def _name(triangle: list[int]) -> Triangle:
    a, b, c = sorted(triangle)
    return a, b, c


def grid_surface(
    triangles: ArrayLike, places: ArrayLike, heights: ArrayLike, shape: tuple[int, int]
) -> NDArray[np.float64]:
    """Evaluate a triangulated surface at every point of a grid.

    Parameters
    ----------
    triangles : (m, 3) int array
        Triangles that are positively oriented as points ``(column, row)``; flat ones are skipped.
    places : (n, 2) int array
        Row and column of each vertex, inside the grid.
    heights : (n,) array
    shape : (rows, columns)

    Returns
    -------
    (rows, columns) float64
        NaN at points that are in no triangle.

    Raises
    ------
    InputError
        For a vertex outside the grid, which is named.
    """
    where = np.asarray(places, dtype=np.int64).reshape(-1, 2)
    outside = np.flatnonzero(((where < 0) | (where >= np.array(shape))).any(axis=1))
    if len(outside):
        v = int(outside[0])
        raise InputError(
            f"places[{v}] = {tuple(where[v].tolist())} lies outside the grid of shape {tuple(shape)}"
        )
    z = np.asarray(heights, dtype=np.float64).reshape(len(where))
    surface = np.full(shape, np.nan)
    _fill(np.asarray(triangles, dtype=np.int64).reshape(-1, 3), where, z, surface)
    return surface


def _checked(
    heights: ArrayLike, count: int | None, tolerance: float, spacing: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The grid as float64 and the spacing rounded to single precision; otherwise an `InputError`."""
    try:
        grid = np.ascontiguousarray(np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan))
        scale = np.asarray(spacing, dtype=np.float32).astype(np.float64).reshape(2)
    except (TypeError, ValueError) as error:
        raise InputError(f"heights must be a grid of numbers, and spacing two numbers: {error}") from error
    if grid.ndim != 2 or min(grid.shape) < 2:
        raise InputError(f"heights must have shape (rows >= 2, columns >= 2), not {grid.shape}")
    bad = np.argwhere(~np.isfinite(grid))
    if len(bad):
        i, j = bad[0].tolist()
        raise InputError(f"heights[{i}, {j}] is not finite; fill such gaps or crop the grid")
    if not (np.isfinite(scale).all() and (scale > 0).all()):
        raise InputError(f"spacing = {spacing} must be two positive numbers in the range of single precision")
    if not tolerance >= 0:
        raise InputError(f"tolerance = {tolerance} must be at least 0; 0 gives the exact surface")
    if count is not None and count < 4:
        raise InputError(f"count = {count} must be at least 4, for the four corners of the grid")
    return grid, scale


# --- kernels over the grid, with integers (row, column) throughout --------------------------------


@inline
def _span(i, corners, width):
    """First and last column of row i inside a counterclockwise triangle of (row, column) corners."""
    low, high = 0, width - 1
    for k in range(3):
        pi, pj = corners[k, 0], corners[k, 1]
        rise = corners[(k + 1) % 3, 0] - pi
        run = (corners[(k + 1) % 3, 1] - pj) * (i - pi)
        if rise > 0:  # the inside is to the left of an edge that goes up
            high = min(high, pj + run // rise)
        elif rise < 0:
            low = max(low, pj - run // -rise)
    return low, high


@inline
def _twice_area(corners):
    return (corners[1, 1] - corners[0, 1]) * (corners[2, 0] - corners[0, 0]) - (
        corners[1, 0] - corners[0, 0]
    ) * (corners[2, 1] - corners[0, 1])


@inline
def _slopes(corners, z0, z1, z2, area):
    """Slopes of the plane through the corners: per row, and per column."""
    i1, j1 = corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1]
    i2, j2 = corners[2, 0] - corners[0, 0], corners[2, 1] - corners[0, 1]
    return (j1 * (z2 - z0) - j2 * (z1 - z0)) / area, (i2 * (z1 - z0) - i1 * (z2 - z0)) / area


@kernel
def _fill(triangles, places, z, surface):
    """Write the heights of each triangle's plane at the grid points in it, then the heights of vertices."""
    for t in range(len(triangles)):
        corners = places[triangles[t]]
        area = _twice_area(corners)
        if area <= 0:
            continue
        z0 = z[triangles[t, 0]]
        down, along = _slopes(corners, z0, z[triangles[t, 1]], z[triangles[t, 2]], area)
        for i in range(corners[:, 0].min(), corners[:, 0].max() + 1):
            low, high = _span(i, corners, surface.shape[1])
            for j in range(low, high + 1):
                surface[i, j] = z0 + down * (i - corners[0, 0]) + along * (j - corners[0, 1])
    for t in range(len(triangles)):
        for v in triangles[t]:
            surface[places[v, 0], places[v, 1]] = z[v]


@kernel
def _worst(triangles, places, grid, errors, worst):
    """Write the largest vertical error of each triangle to ``errors``, and its first place to ``worst``."""
    for t in range(len(triangles)):
        corners = places[triangles[t]]
        errors[t] = 0.0
        area = _twice_area(corners)
        if area <= 0:
            continue
        z0 = grid[corners[0, 0], corners[0, 1]]
        z1, z2 = grid[corners[1, 0], corners[1, 1]], grid[corners[2, 0], corners[2, 1]]
        down, along = _slopes(corners, z0, z1, z2, area)
        for i in range(corners[:, 0].min(), corners[:, 0].max() + 1):
            low, high = _span(i, corners, grid.shape[1])
            for j in range(low, high + 1):
                value = z0 + down * (i - corners[0, 0]) + along * (j - corners[0, 1])
                error = abs(grid[i, j] - value)
                if error > errors[t] and not _is_corner(i, j, corners):  # corners have rounding errors only
                    errors[t] = error
                    worst[t, 0], worst[t, 1] = i, j


@inline
def _is_corner(i, j, corners):
    for k in range(3):
        if corners[k, 0] == i and corners[k, 1] == j:
            return True
    return False
