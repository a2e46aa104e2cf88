"""Planar Voronoi cells cut by windows, with their areas and moments.

Each cell is computed relative to its site, so that large coordinates cause no loss of accuracy.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ...geometry.boxes import BoxTree
from .window import Window

__all__ = ["clip_cells"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

PAIRS_AT_ONCE = 200_000  # how many cells are cut at a time, so that Ctrl-C takes effect
BOX_SLACK = 1e-12  # boxes are larger than their cells by this share of the coordinates


@inline
def _cut(x, y, size, nx, ny, level, newx, newy):
    """Write the part of a convex polygon where n . x <= level to ``newx``, ``newy``; return its size."""
    kept = 0
    for k in range(size):
        j = k + 1 if k + 1 < size else 0
        f = level - (nx * x[k] + ny * y[k])
        g = level - (nx * x[j] + ny * y[j])
        if f >= 0.0:
            newx[kept], newy[kept] = x[k], y[k]
            kept += 1
        if (f > 0.0 and g < 0.0) or (f < 0.0 and g > 0.0):
            t = f / (f - g)
            newx[kept], newy[kept] = x[k] + t * (x[j] - x[k]), y[k] + t * (y[j] - y[k])
            kept += 1
    return kept


@inline
def _inside(x, y, size, corner, low, high, px, py):
    """Whether all corners, given relative to the site p, lie in the convex polygon corner[low:high]."""
    for i in range(low, high):
        j = i + 1 if i + 1 < high else low
        ax, ay = corner[i, 0] - px, corner[i, 1] - py
        bx, by = corner[j, 0] - px, corner[j, 1] - py
        for k in range(size):
            if not ((bx - ax) * (y[k] - ay) - (by - ay) * (x[k] - ax) >= 0.0):
                return False
    return True


class Cells(NamedTuple):
    """The cells of a planar diagram: rings of Voronoi vertices, where these are, neighbors of sites."""

    start: NDArray[Any]
    ring: Ints
    base: Ints
    offset: Floats
    link: NDArray[Any]
    linked: Ints
    weight: Floats  # of the sites; equal weights count for nothing


class Pairs(NamedTuple):
    """Which cell (site) is cut by which convex piece of the window, and the corners of the pieces."""

    site: NDArray[np.int64]
    piece: NDArray[np.int64]
    corner: Floats
    start: NDArray[np.int64]


@kernel
def _clip(points, pairs, cells, i, ends, corners, moments):
    """Write the parts of cells from pair ``i`` on, until ``corners`` is full; return the first pair left.

    A bounded cell inside the piece keeps its own corners. Any other part is the piece, cut by the bisectors
    between the site and its neighbors. ``moments`` receives the area and the integrals of x, y and |x|^2,
    all relative to the site.
    """
    start, ring, base, offset, link, linked, weight = cells
    most = 0
    for r in range(i, pairs.site.shape[0]):
        v, p = pairs.site[r], pairs.piece[r]
        w = pairs.start[p + 1] - pairs.start[p]
        most = max(most, start[v + 1] - start[v], link[v + 1] - link[v] + w)
    x, y = np.empty(most + 2), np.empty(most + 2)
    newx, newy = np.empty(most + 2), np.empty(most + 2)
    used = 0
    while i < pairs.site.shape[0]:
        v, low, high = pairs.site[i], pairs.start[pairs.piece[i]], pairs.start[pairs.piece[i] + 1]
        px, py = points[v, 0], points[v, 1]
        begin, size = start[v], start[v + 1] - start[v]
        whole = size > 0 and ring[begin] >= 0
        if whole:
            for k in range(size):
                g = ring[begin + k]
                x[k] = (points[base[g], 0] - px) + offset[g, 0]
                y[k] = (points[base[g], 1] - py) + offset[g, 1]
            whole = _inside(x, y, size, pairs.corner, low, high, px, py)
        if not whole and size > 0:
            size = high - low
            for k in range(size):
                x[k], y[k] = pairs.corner[low + k, 0] - px, pairs.corner[low + k, 1] - py
            for j in range(link[v], link[v + 1]):
                u = linked[j]
                nx, ny = points[u, 0] - px, points[u, 1] - py
                level = (nx * nx + ny * ny + (weight[v] - weight[u])) / 2
                size = _cut(x, y, size, nx, ny, level, newx, newy)
                x, newx = newx, x
                y, newy = newy, y
        if used + size > corners.shape[0]:
            break
        if _integrate(x, y, size, moments, i) <= 0.0:  # the piece only touches the cell
            size = 0
        for k in range(size):
            corners[used + k, 0], corners[used + k, 1] = px + x[k], py + y[k]
        used += size
        ends[i] = used
        i += 1
    return i


@inline
def _integrate(x, y, size, moments, v):
    """Area and moments about the origin of a convex polygon; return the area.

    The polygon is divided into triangles, all with areas of one sign, so that areas do not cancel.
    """
    area, mx, my, inertia = 0.0, 0.0, 0.0, 0.0
    for j in range(1, size - 1):
        k = j + 1
        part = ((x[j] - x[0]) * (y[k] - y[0]) - (y[j] - y[0]) * (x[k] - x[0])) / 2
        sx, sy = x[0] + x[j] + x[k], y[0] + y[j] + y[k]
        square = x[0] * x[0] + x[j] * x[j] + x[k] * x[k] + y[0] * y[0] + y[j] * y[j] + y[k] * y[k]
        area += part
        mx += part * sx / 3
        my += part * sy / 3
        inertia += part * (square + sx * sx + sy * sy) / 12
    if area <= 0.0:
        area, mx, my, inertia = 0.0, 0.0, 0.0, 0.0
    moments[v, 0], moments[v, 1], moments[v, 2], moments[v, 3] = area, mx, my, inertia
    return area


def clip_cells(points: Floats, window: Window, cells: Cells) -> tuple[Pairs, list[Floats], Floats]:
    """Cut all planar cells by a window.

    Parameters
    ----------
    points : (n, 2) array
        The sites; those with an empty ring (hidden sites) get no polygon.
    window : Window
        The result of `as_window`, in the units of the points.
    cells : Cells

    Returns
    -------
    pairs : Pairs
        Which cell and which convex piece of the window each polygon is common to, sorted by cells. For a
        convex window there is one pair for each cell.
    polygons : list of (k, 2) arrays
        Corners in counterclockwise order; an empty array where a cell does not meet the piece.
    moments : (n, 4) array
        The area, and the integrals of x, y and |x|^2 relative to each site, over all its polygons.
    """
    n, corner, start = len(points), window.corner, window.start
    pieces = len(start) - 1
    site, piece = np.arange(n), np.zeros(n, dtype=np.int64)
    if pieces > 1:
        low, high = np.minimum.reduceat(corner, start[:-1]), np.maximum.reduceat(corner, start[:-1])
        site, piece = BoxTree(low, high).pairs(*_boxes(points, cells))
    pairs = Pairs(site, piece, corner, start)
    moments, polygons = np.empty((len(site), 4)), []
    longest = int(np.diff(cells.link).max(initial=0)) + int(np.diff(start).max())
    room = max(6 * min(len(site), PAIRS_AT_ONCE), 2 * longest + 2)
    i = 0
    # Cells are cut in parts, so that the computation can be interrupted and windows with many corners do not
    # need more memory.
    while i < len(site):
        corners, ends = np.empty((room, 2)), np.empty(len(site), dtype=np.int64)
        last = _clip(points, pairs, cells, i, ends, corners, moments)
        polygons += np.split(corners[: ends[last - 1]], ends[i : last - 1])
        i = last
    if pieces > 1:
        moments = np.stack([np.bincount(site, column, minlength=n) for column in moments.T], axis=1)
    return pairs, polygons, moments


def _boxes(points: Floats, cells: Cells) -> tuple[Floats, Floats]:
    """Boxes around all cells, a little too large; those of unbounded cells are unbounded, too."""
    n, size = len(points), np.diff(cells.start)
    low, high = np.full((n, 2), np.inf), np.full((n, 2), -np.inf)  # empty: these meet nothing
    where = points[cells.base] + cells.offset
    owner, ring = np.repeat(np.arange(n), size), cells.ring
    with np.errstate(invalid="ignore"):
        slack = BOX_SLACK * (
            np.abs(where).max(axis=1, initial=0.0) + np.abs(cells.offset).max(axis=1, initial=0.0)
        )
        for k in range(2):
            least, most = where[:, k] - slack, where[:, k] + slack
            np.minimum.at(low[:, k], owner, np.where(ring < 0, -np.inf, least[ring] if len(least) else 0.0))
            np.maximum.at(high[:, k], owner, np.where(ring < 0, np.inf, most[ring] if len(most) else 0.0))
    return np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)
