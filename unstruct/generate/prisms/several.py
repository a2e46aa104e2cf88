"""Runs with fans of rays along those creases where they raise the least scaled Jacobian.

It is that of the cells as the mesh has them: wedges, hexahedra, tetrahedra at corners, and pyramids on top
where tetrahedra follow; or tetrahedra, if all cells are divided.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...geometry import simplex
from ...geometry.polygons import Polygons
from ...predicates.batch import power_of_two
from ...sizing.stretching import Layers
from .columns import scaled_columns
from .creases import Creases, chains_of, creases_of, fans_of, usable
from .fans import fan_quality
from .run import PrismOptions, PrismRun
from .split import tetrahedra
from .walls import Base

__all__ = ["FannedRun", "run_with_fans"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

MOST_FAN_RUNS = 6  # after so many no crease that is worse keeps its fans, nor any other
SAME_QUALITY = 0.999  # of the least scaled Jacobian of cells near a crease must be left
LEAST_FAN_HEIGHT = 0.5  # of the height of single rays fans must have
SPREAD_WELL = 0.05  # the least determinant of unit vectors along the edge and two rays of a fan


class FannedRun(NamedTuple):
    """A run, how many creases have fans, and have one ray although they are sharp; the run without fans."""

    run: PrismRun
    fanned: int
    single: int
    without: PrismRun


def run_with_fans(base: Base, layers: Layers, options: PrismOptions) -> FannedRun:
    """The run whose fans are all better than single rays.

    Creases lose their fans, all that are worse at once, until none is worse: few runs in practice.
    """
    single = PrismRun(base, layers, options)
    single.advance()
    creases = creases_of(base.walls, single.stars)
    whole = chains_of(creases)
    kept = np.asarray((single.rays.height[creases.ends] > 0.0).all(axis=1), dtype=bool)
    ending = _ending(base)
    for _ in range(MOST_FAN_RUNS):
        kept, crease = usable(base.walls, single.stars, creases, kept, ending)
        if not kept.any():
            break
        fans = fans_of(base.walls, single.stars, creases, kept, crease)
        run = PrismRun(base, layers, options, fans, single.direction)
        run.begin()
        worse = kept & _narrow(run, creases)
        if not worse.any():
            run.advance()
            worse = kept & _worse(run, single, creases, kept, crease)
        if not worse.any():
            return FannedRun(run, len(np.unique(crease[kept])), len(np.unique(whole[~kept])), single)
        kept &= ~np.isin(crease, crease[worse])
    return FannedRun(single, 0, len(np.unique(whole)), single)


def _ending(base: Base) -> Flags | None:
    """At which vertices at most one facet is no wall; None for all."""
    if base.domain is None:
        return None
    facets = Polygons.of(base.domain.facets)
    sides, owner = facets.sides
    other = ~flagged(len(facets), base.walls.piece)[owner]
    pairs = np.unique(np.column_stack([sides[other, 0], owner[other]]), axis=0)
    many = np.bincount(pairs[:, 0], minlength=len(base.domain.points))
    return np.asarray(many[base.walls.vertex] <= 1, dtype=bool)


def _edges_at(creases: Creases, bad: Flags) -> Flags:
    return np.asarray(bad[creases.ends].any(axis=1), dtype=bool)


def _narrow(run: PrismRun, creases: Creases) -> Flags:
    """The edges at which cells of fans would not be positive, however low."""
    fans, direction, points = run.fans, run.direction, run.base.walls.points
    points = points * power_of_two(points)  # so that squares do not underflow
    bad = np.zeros(len(points), dtype=bool)
    a, b, c, d = fans.quads.T
    along = points[fans.base[d]] - points[fans.base[a]]
    length = np.sqrt(_product(along, along))
    along = along / np.where(length > 0.0, length, 1.0)[:, None]
    for one, two in ((a, b), (d, c)):
        wrong = _determinants(direction[one], direction[two], along) < SPREAD_WELL
        bad[fans.base[one[wrong]]] = True
    wrong = _determinants(*(direction[fans.corners[:, k]] for k in range(3))) < SPREAD_WELL
    bad[fans.base[fans.corners[wrong, 0]]] = True
    bad[fans.base[run.height == 0.0]] = True
    return _edges_at(creases, bad)


def _product(u: Array, v: Array) -> Array:
    return np.asarray(u[:, 0] * v[:, 0] + u[:, 1] * v[:, 1] + u[:, 2] * v[:, 2])


def _determinants(u: Array, v: Array, w: Array) -> Array:
    x, y, z = u.T
    a, b, c = v.T
    return _product(np.column_stack([y * c - z * b, z * a - x * c, x * b - y * a]), w)


def at_columns(run: PrismRun) -> Array:
    """The least scaled Jacobian of the wedges of each column, or of the tetrahedra that they are cut into."""
    if run.how != "halves":
        return scaled_columns(run.places, run.columns, run.rays.level)
    least = np.full(len(run.columns), np.inf)
    whole = np.flatnonzero(run.rays.level[run.columns].min(axis=1) > 0)
    rays, columns = run.places.shape[1], run.columns[whole]
    for k in range(run.levels if len(whole) else 0):
        points = run.places[k : k + 2].reshape(-1, 3)
        low = columns if k else run.fans.base[columns]  # the first ray of a vertex has its number
        rows, owner = tetrahedra({"wedge": np.column_stack([low, columns + rays])})
        np.minimum.at(least, whole[owner], simplex.quality("scaled_jacobian", points[rows]))
    return least


def at_vertices(run: PrismRun) -> Array:
    """The least scaled Jacobian of the cells at each vertex of the walls."""
    fans = run.fans
    result = np.full(len(run.base.walls.points), np.inf)
    columns = at_columns(run)
    for k in range(3):
        np.minimum.at(result, fans.base[run.columns[:, k]], columns)
    found = fan_quality(fans, run.places, run.how, run.apexes)
    for rows, values in ((fans.quads, found[: len(fans.quads)]), (fans.corners, found[len(fans.quads) :])):
        for k in range(rows.shape[1]):
            np.minimum.at(result, fans.base[rows[:, k]], values)
    return result


def _worse(run: PrismRun, single: PrismRun, creases: Creases, kept: Flags, crease: NDArray) -> Flags:
    """The edges of creases that have no layers, or whose least scaled Jacobian is no better than before."""
    low = np.zeros(len(run.base.walls.points), dtype=bool)
    low[run.fans.base[run.rays.height == 0.0]] = True
    beside = low[run.base.walls.triangles].any(axis=1)  # columns there may be left out
    low[run.base.walls.triangles[beside]] = True
    found = [at_vertices(which) for which in (run, single)]
    height = np.full(len(low), np.inf)
    np.minimum.at(height, run.fans.base, run.rays.height)
    low |= height < LEAST_FAN_HEIGHT * single.rays.height
    low |= _nearest(run, found[0] < found[1].min(), creases.ends[kept])
    least, before = (_by_crease(values, creases, kept, crease) for values in found)
    near = [_by_crease(_around(run, values), creases, kept, crease) for values in found]
    return _edges_at(creases, low) | ((least <= before) | (near[0] < SAME_QUALITY * near[1]))[crease]


def _nearest(run: PrismRun, bad: Flags, ends: NDArray) -> Flags:
    """Vertices and their neighbors, in as many rings as there must be to meet some edges."""
    triangles, many = run.base.walls.triangles, 0
    while many < bad.sum() and not bad[ends].any():
        many, beside = int(bad.sum()), bad[triangles].any(axis=1)
        bad = flagged(len(bad), triangles[beside])
    return bad


def _by_crease(values: Array, creases: Creases, kept: Flags, crease: NDArray) -> Array:
    """The least values at the vertices of creases, by their numbers."""
    result = np.full(len(creases.ends), np.inf)
    np.minimum.at(result, crease[kept], values[creases.ends].min(axis=1)[kept])
    return result


def _around(run: PrismRun, values: Array) -> Array:
    """The least values at vertices and their neighbors."""
    result, triangles = values.copy(), run.base.walls.triangles
    least = values[triangles].min(axis=1)
    for k in range(3):
        np.minimum.at(result, triangles[:, k], least)
    return result
