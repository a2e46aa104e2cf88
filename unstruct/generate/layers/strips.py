"""The cells of the strips between rays, and the edges that they leave to the rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from ...predicates.batch import orient_rows, scaled
from ...predicates.kernels import orientation
from .heights import Fronts
from .rays import Rays
from .stops import BY_EXACTNESS, Stops, leveled

__all__ = ["Cells", "Numbering", "cells_of", "last_point", "numbered", "positive", "tops"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class Numbering(NamedTuple):
    """The numbers of the points: those of the boundary first, then ray by ray.

    Attributes
    ----------
    points : (n, 2) float64
    start : (r,) int64
        The number of the first new point of each ray.
    base : (r,) int64
    """

    points: Array
    start: Integers
    base: Integers

    def at(self, ray: Integers, layer: Integers) -> Integers:
        """The number of the point of a ray after so many layers."""
        return np.where(layer > 0, self.start[ray] + layer - 1, self.base[ray])


class Cells(NamedTuple):
    """Cells of layers: corners, with the strip and the layer (from 0) of each."""

    quads: Integers
    quad_strip: Integers
    quad_layer: Integers
    triangles: Integers
    triangle_strip: Integers
    triangle_layer: Integers


def numbered(points: Array, rays: Rays, fronts: Fronts, level: Integers) -> Numbering:
    """The points of all rays up to their levels, after those of the boundary."""
    start = len(points) + np.cumsum(level) - level
    every = np.empty((len(points) + int(level.sum()), 2))
    every[: len(points)] = points
    _write_places(fronts.places, level, start, every)
    return Numbering(every, start, rays.base)


@inline
def _point(start, base, ray, layer):
    """`Numbering.at` for kernels."""
    return start[ray] + layer - 1 if layer > 0 else base[ray]


@inline
def last_point(start, base, ray, level):
    """The number of the last point of a ray."""
    return _point(start, base, ray, level[ray])


@lean
def _write_places(places, level, start, every):
    for r in range(len(level)):
        for k in range(level[r]):
            every[start[r] + k, 0], every[start[r] + k, 1] = places[r, k + 1, 0], places[r, k + 1, 1]


def _counted(counts: Integers) -> tuple[Integers, Integers]:
    """For counts (2, 0, 3) the pairs of a row and a number below its count: (0, 0), (0, 1), (2, 0), ..."""
    row = np.repeat(np.arange(len(counts)), counts)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)


def cells_of(rays: Rays, level: Integers, numbers: Numbering) -> Cells:
    """Quadrilaterals up to the lower of two levels, and one triangle where levels differ.

    The first cells of a strip in a fan are triangles, because both rays start at one vertex.
    """
    counts = np.empty(2, dtype=np.int64)
    front = numbers.start, rays.base, rays.left, rays.right, level
    none = np.empty((0, 4), dtype=np.int64), np.empty((0, 3), dtype=np.int64)
    _write_cells(front, none, (np.empty((0, 2), dtype=np.int64), np.empty((0, 2), dtype=np.int64)), counts)
    q, t = counts.tolist()
    rows = np.empty((q, 4), dtype=np.int64), np.empty((t, 3), dtype=np.int64)
    quad, triangle = np.empty((q, 2), dtype=np.int64), np.empty((t, 2), dtype=np.int64)
    _write_cells(front, rows, (quad, triangle), counts)
    return Cells(rows[0], quad[:, 0], quad[:, 1], rows[1], triangle[:, 0], triangle[:, 1])


@lean
def _write_cells(front, rows, sources, counts):
    """Count the cells, and write as many as fit with their strips and layers; `cells_of` says which they are.

    The pointed triangles of fans come before those where levels differ.
    """
    start, base, left, right, level = front
    quads, triangles = rows
    quad, triangle = sources
    q = t = 0
    for s in range(len(left)):
        i, j = left[s], right[s]
        for m in range(min(level[i], level[j])):
            a, b = _point(start, base, i, m), _point(start, base, j, m)
            d, c = start[i] + m, start[j] + m
            if a == b:
                if t < len(triangles):
                    triangles[t, 0], triangles[t, 1], triangles[t, 2] = b, c, d
                    triangle[t, 0], triangle[t, 1] = s, m
                t += 1
                continue
            if q < len(quads):
                quads[q, 0], quads[q, 1], quads[q, 2], quads[q, 3] = a, b, c, d
                quad[q, 0], quad[q, 1] = s, m
            q += 1
    for s in range(len(left)):
        i, j = left[s], right[s]
        m = min(level[i], level[j])
        if level[i] == level[j] or (m == 0 and base[i] == base[j]):
            continue
        if t < len(triangles):
            triangles[t, 0], triangles[t, 1] = _point(start, base, i, m), _point(start, base, j, m)
            triangles[t, 2] = start[i if level[i] > level[j] else j] + m
            triangle[t, 0], triangle[t, 1] = s, m
        t += 1
    counts[0], counts[1] = q, t


def tops(rays: Rays, level: Integers, numbers: Numbering) -> tuple[Integers, Integers]:
    """The strips that have cells and the edges on top of them, with the rest on the left: (t,), (t, 2)."""
    left, right = rays.left, rays.right
    strip = np.flatnonzero(np.maximum(level[left], level[right]) > 0)
    i, j = left[strip], right[strip]
    return strip, np.column_stack([numbers.at(i, level[i]), numbers.at(j, level[j])])


@lean
def _good_layers(xy, start, base, left, right, whole):
    """Lower ``whole``, the number of layers of each strip, to those before the first bad cell."""
    for s in range(len(whole)):
        for m in range(whole[s]):
            i, j = left[s], right[s]
            a, b = _point(start, base, i, m), _point(start, base, j, m)
            d, c = start[i] + m, start[j] + m
            good = orientation(xy, c, d, a) > 0
            if a != b:
                good = good and orientation(xy, a, b, c) > 0 and orientation(xy, b, c, d) > 0
                good = good and orientation(xy, d, a, b) > 0
            if not good:
                whole[s] = m
                break


@lean
def _bad_ramps(xy, front, ramp, up, layer, bad):
    """Whether the triangles where levels differ are not positive."""
    start, base, left, right = front
    for s in range(len(ramp)):
        a = _point(start, base, left[ramp[s]], layer[s])
        b = _point(start, base, right[ramp[s]], layer[s])
        bad[s] = orientation(xy, a, b, _point(start, base, up[s], layer[s] + 1)) <= 0


def _good_rows(numbers: Numbering, rays: Rays, lower: Integers, whole: Integers) -> None:
    """`_good_layers` for any exponents."""
    strip, layer = _counted(lower)
    i, j = rays.left[strip], rays.right[strip]
    a, b = numbers.at(i, layer), numbers.at(j, layer)
    d, c = numbers.at(i, layer + 1), numbers.at(j, layer + 1)
    corners = np.concatenate([np.column_stack(v) for v in ((a, b, c), (b, c, d), (c, d, a), (d, a, b))])
    signs = orient_rows(numbers.points, corners).reshape(4, -1)
    good = np.where(a == b, signs[2] > 0, signs.min(axis=0, initial=1) > 0)
    np.minimum.at(whole, strip[~good], layer[~good])


def positive(points: Array, rays: Rays, fronts: Fronts, stops: Stops) -> Stops:
    """The levels lowered until all cells are positively oriented and all quadrilaterals are convex; exact."""
    stops = leveled(stops, rays)
    first = stops.level
    numbers = numbered(points, rays, fronts, first)
    left, right = rays.left, rays.right
    lower = np.minimum(first[left], first[right])
    xy, kept = scaled(numbers.points)
    whole = lower.copy()  # how many cells of a strip are good
    if kept:
        _good_layers(xy, numbers.start, rays.base, left, right, whole)
    else:  # exponents too wide for one scale
        _good_rows(numbers, rays, lower, whole)
    while True:
        level, reason = stops.level.copy(), stops.reason.copy()
        for ray in (left, right):
            over = np.minimum(level[left], level[right]) > whole
            rows = ray[over & (level[ray] > whole)]
            np.minimum.at(level, rows, whole[over & (level[ray] > whole)])
            reason[rows] = BY_EXACTNESS
        stops = leveled(Stops(level, reason), rays)
        level = stops.level
        low = np.minimum(level[left], level[right])
        ramp = np.flatnonzero((level[left] != level[right]) & (rays.base[left] != rays.base[right]))
        up = np.where(level[left[ramp]] > level[right[ramp]], left[ramp], right[ramp])
        m = low[ramp]
        if kept:
            bad = np.empty(len(ramp), dtype=bool)
            _bad_ramps(xy, (numbers.start, rays.base, left, right), ramp, up, m, bad)
        else:
            ends = numbers.at(left[ramp], m), numbers.at(right[ramp], m), numbers.at(up, m + 1)
            bad = orient_rows(numbers.points, np.column_stack(ends)) <= 0
        if not bad.any() and not (low > whole).any():
            return stops
        level, reason = stops.level.copy(), stops.reason.copy()
        np.minimum.at(level, up[bad], m[bad])
        reason[up[bad]] = BY_EXACTNESS
        stops = Stops(level, reason)
