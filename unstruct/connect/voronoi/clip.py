"""Planar Voronoi cells cut by a convex window, with their areas and moments.

Each cell is computed relative to its site, so that large coordinates cause no loss of accuracy.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.errors import InputError
from ...base.jit import inline, kernel
from ...predicates.batch import orient

__all__ = ["as_window", "clip_cells"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


def as_window(clip: ArrayLike) -> Floats:
    """Corners of a convex window, counterclockwise, from a box ((x0, y0), (x1, y1)) or a convex polygon.

    Raises
    ------
    InputError
        If the shape is wrong, a coordinate is not finite, or the polygon is empty or not convex (which is
        decided exactly).
    """
    try:
        window = np.array(clip, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"clip is not an array of real numbers: {error}") from None
    if window.ndim != 2 or window.shape[1] != 2 or len(window) < 2:
        raise InputError(
            f"clip has shape {window.shape}; it must be a box ((x0, y0), (x1, y1)) "
            "or the corners (k, 2) of a convex polygon"
        )
    bad = np.flatnonzero(~np.isfinite(window).all(axis=1))
    if len(bad):
        raise InputError(f"corner {bad[0]} of clip is {window[bad[0]].tolist()}; all must be finite")
    if len(window) == 2:
        (x0, y0), (x1, y1) = window
        if not (x0 < x1 and y0 < y1):
            raise InputError(
                f"the box {window.tolist()} is empty; give its lower left corner, then its upper right one"
            )
        return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    turns = np.atleast_1d(
        orient(np.stack([np.roll(window, 1, axis=0), window, np.roll(window, -1, axis=0)], axis=1))
    )
    if (turns < 0).sum() > (turns > 0).sum():
        window, turns = window[::-1].copy(), -turns[::-1]
    window, straight = window[turns != 0], turns[turns != 0]
    if len(window) < 3:
        raise InputError("the corners of clip are collinear; they must enclose an area")
    fan = orient(
        np.stack([np.broadcast_to(window[0], (len(window) - 2, 2)), window[1:-1], window[2:]], axis=1)
    )
    if (straight < 0).any() or (np.atleast_1d(fan) <= 0).any():
        raise InputError("clip is not convex; divide it into convex polygons and clip by each of them")
    return window


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
def _inside(x, y, size, window, px, py):
    """Whether all corners, given relative to the site p, lie in the window."""
    w = window.shape[0]
    for i in range(w):
        ax, ay = window[i, 0] - px, window[i, 1] - py
        bx, by = window[(i + 1) % w, 0] - px, window[(i + 1) % w, 1] - py
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


@kernel
def _clip(points, window, cells, v, ends, corners, moments):
    """Write the cells from site ``v`` on, until ``corners`` is full; return the first site that is left.

    A bounded cell inside the window keeps its own corners. Any other cell is the window, cut by the bisectors
    between the site and its neighbors. ``moments`` receives the area and the integrals of x, y and |x|^2,
    all relative to the site.
    """
    start, ring, base, offset, link, linked = cells
    w = window.shape[0]
    most = 0
    for u in range(v, points.shape[0]):
        most = max(most, start[u + 1] - start[u], link[u + 1] - link[u] + w)
    x, y = np.empty(most + 2), np.empty(most + 2)
    newx, newy = np.empty(most + 2), np.empty(most + 2)
    used = 0
    while v < points.shape[0]:
        px, py = points[v, 0], points[v, 1]
        begin, size = start[v], start[v + 1] - start[v]
        whole = size > 0 and ring[begin] >= 0
        if whole:
            for k in range(size):
                g = ring[begin + k]
                x[k] = (points[base[g], 0] - px) + offset[g, 0]
                y[k] = (points[base[g], 1] - py) + offset[g, 1]
            whole = _inside(x, y, size, window, px, py)
        if not whole and size > 0:
            size = w
            for k in range(w):
                x[k], y[k] = window[k, 0] - px, window[k, 1] - py
            for i in range(link[v], link[v + 1]):
                nx, ny = points[linked[i], 0] - px, points[linked[i], 1] - py
                size = _cut(x, y, size, nx, ny, (nx * nx + ny * ny) / 2, newx, newy)
                x, newx = newx, x
                y, newy = newy, y
        if used + size > corners.shape[0]:
            break
        if _integrate(x, y, size, moments, v) <= 0.0:  # the window only touches the cell
            size = 0
        for k in range(size):
            corners[used + k, 0], corners[used + k, 1] = px + x[k], py + y[k]
        used += size
        ends[v] = used
        v += 1
    return v


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


def clip_cells(
    points: Floats,
    window: Floats,
    rings: tuple[Any, Ints],
    centers: tuple[Ints, Floats],
    links: tuple[Any, Ints],
) -> tuple[list[Floats], Floats]:
    """Cut all planar cells by a convex window.

    Parameters
    ----------
    points : (n, 2) array
        The sites; those with an empty ring (copies of other sites) get an empty polygon.
    window : (w, 2) array
        The result of `as_window`.
    rings, links : compressed rows
        The Voronoi vertices and the neighbors of each site.
    centers : (site, offset)
        The Voronoi vertices, from `local_circumcenters`.

    Returns
    -------
    polygons : list of (k, 2) arrays
        Corners in counterclockwise order; an empty array for a cell that does not meet the window.
    moments : (n, 4) array
        The area, and the integrals of x, y and |x|^2 relative to each site.
    """
    n = len(points)
    moments, polygons = np.empty((n, 4)), []
    room = max(6 * min(n, 200_000), 2 * len(window) + 2 * int(np.diff(links[0]).max(initial=0)) + 2)
    cells = Cells(*rings, *centers, *links)
    v = 0
    # Cells are cut in parts, so that the computation can be interrupted and windows with many corners do not
    # need more memory.
    while v < n:
        corners, ends = np.empty((room, 2)), np.empty(n, dtype=np.int64)
        last = _clip(points, window, cells, v, ends, corners, moments)
        polygons += np.split(corners[: ends[last - 1]], ends[v : last - 1])
        v = last
    return polygons, moments
