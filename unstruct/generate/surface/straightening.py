"""From an intrinsic triangulation to straight triangles in space, and what is wrong with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...connect.surface.crossing import unit_normals
from ...geometry.embedded import embedded, flat_rows, meeting_pairs
from .intrinsic_run import IntrinsicRun

__all__ = ["MEETS_OTHERS", "Faulty", "Straight", "faulty", "own_crossings", "straightened", "too_far"]

Array = NDArray[np.float64]
MEETS_OTHERS = "triangles that meet others"


class Straight(NamedTuple):
    """Straight triangles.

    Attributes
    ----------
    points : (n, 3)
    origin : (n,) int32
        The given vertex, -1 for new ones.
    triangles : (m, 3) int32
        In the order of those of the intrinsic triangulation.
    sides : (k,) int64
        Half-edges that are kept, one of each edge.
    edges : (k, 2) int32
        Their vertices.
    """

    points: Array
    origin: NDArray[np.int32]
    triangles: NDArray[np.int32]
    sides: NDArray[np.int64]
    edges: NDArray[np.int32]


class Faulty(NamedTuple):
    """What is wrong with straight triangles, one kind at a time.

    Attributes
    ----------
    sides : (k,) int64
        Half-edges to be halved.
    triangles : (t,) int64
    text : str
        Empty if nothing is wrong.
    """

    sides: NDArray[np.int64]
    triangles: NDArray[np.int64]
    text: str


def straightened(run: IntrinsicRun) -> Straight:
    """The triangles with straight edges; vertices of several sheets at one place become one."""
    found = run.found
    sides, n = found.sides, int(found.shape.numbers[1])
    origin = found.origin.astype(np.int64)
    number = np.where(origin >= 0, origin, len(found.surface.points) + np.arange(n))
    h = np.flatnonzero((sides.under >= 0) & (sides.twin < 0))
    h = h[found.gluing.cut[sides.under[h]]]
    if len(h):
        group, low, _ = run.intervals(h)
        v = sides.vertex[h]
        new = origin[v] < 0
        group, low, v = group[new], low[new], v[new]
        order = np.lexsort((v, low, group))
        head = np.ones(len(order), dtype=bool)
        head[1:] = (group[order][1:] != group[order][:-1]) | (low[order][1:] != low[order][:-1])
        number[v[order]] = number[v[order[np.flatnonzero(head)[np.cumsum(head) - 1]]]]
    used, rows = np.unique(number[sides.vertex], return_inverse=True)
    first = np.zeros(len(used), dtype=np.int64)
    first[rows] = sides.vertex
    kept = np.flatnonzero((sides.under >= 0) & (sides.twin < np.arange(len(sides.twin))))
    after = np.where(kept % 3 == 2, kept - 2, kept + 1)
    edges = np.stack([rows[kept], rows[after]], axis=1).astype(np.int32)
    return Straight(
        found.points[first], origin[first].astype(np.int32), rows.reshape(-1, 3).astype(np.int32), kept, edges
    )


def _in_doubt(run: IntrinsicRun, straight: Straight) -> NDArray[np.int64]:
    """Half-edges with which the triangles are no complex: loops, and edges with the same ends as another."""
    rows = straight.triangles
    flat, after = rows.ravel().astype(np.int64), rows[:, [1, 2, 0]].ravel().astype(np.int64)
    twin, under = run.found.sides.twin, run.found.sides.under
    one = np.flatnonzero(twin < np.arange(len(twin)))
    low, high = np.minimum(flat[one], after[one]), np.maximum(flat[one], after[one])
    _, number = np.unique(low * len(straight.points) + high, return_inverse=True)
    # the sheets of a cut have the same edge; other edges with the same ends are different lines
    cut = (under[one] >= 0) & run.found.gluing.cut[np.maximum(under[one], 0)]
    lines = np.bincount(number, ~cut) + (np.bincount(number, cut) > 0)
    return one[((lines[number] > 1) & ~cut) | (low == high)]


def _same_rows(rows: NDArray[np.int32]) -> NDArray[np.int64]:
    """Triangles with the same corners as another."""
    ordered = np.sort(rows, axis=1)
    _, number, count = np.unique(ordered, axis=0, return_inverse=True, return_counts=True)
    return np.flatnonzero(count[number.ravel()] > 1)


def faulty(run: IntrinsicRun, straight: Straight) -> Faulty:
    """What is to be halved so that straight triangles become a surface near the given one."""
    sides = _in_doubt(run, straight)
    if len(sides):
        return Faulty(sides, np.unique(sides // 3), "edges with the same ends as others")
    factor = run.found.factor  # squares of lengths are finite in scaled coordinates
    corner = (straight.points * factor)[straight.triangles]
    same = _same_rows(straight.triangles)
    if len(same):
        return Faulty(_longest(run, same), same, "triangles with the same corners as others")
    normal = unit_normals(corner)
    weights = np.full((len(corner), 3), 1.0 / 3.0)
    middle = (corner * weights[:, :, None]).sum(axis=1) / factor
    near, _, _ = run.given.support.nearest(middle, hint=run.found.sides.label, normals=normal)
    along = run.given.support.normals[near]
    against = np.flatnonzero((normal * along).sum(axis=1) <= 0.0)
    against = np.union1d(against, flat_rows(straight.points, straight.triangles))
    if len(against):
        return Faulty(_longest(run, against), against, "triangles that face the other way")
    if not embedded(straight.points, straight.triangles):
        pairs, own = _meeting(run, straight)
        met = np.unique(pairs[~own])
        if len(met):
            return Faulty(_longest(run, met), met, MEETS_OTHERS)
    none = np.empty(0, dtype=np.int64)
    return Faulty(none, none, "")


def _meeting(run: IntrinsicRun, straight: Straight) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Pairs of triangles that meet; whether the given surface does so there."""
    pairs = meeting_pairs(straight.points, straight.triangles)
    return pairs, run.own.among(straight.points * run.found.factor, straight.triangles, pairs)


def own_crossings(run: IntrinsicRun, straight: Straight) -> NDArray[np.int64]:
    """Triangles that meet others where the given surface meets itself, if that is known."""
    if not run.own.count:
        return np.empty(0, dtype=np.int64)
    pairs, own = _meeting(run, straight)
    return np.unique(pairs[own])


def too_far(run: IntrinsicRun, straight: Straight, near: float) -> tuple[NDArray[np.int64], Array, float]:
    """Triangles that are too far from the surface, how many times too far, and the greatest distance."""
    support = run.given.support
    there, back = support.distances(straight.points, straight.triangles)
    measured = float(max(there.max(), back.max()))
    excess = there / near if near > 0.0 else np.where(there > 0.0, np.inf, 0.0)
    if (back > near).any():  # parts of the surface that are far from the mesh: all triangles over them
        middle = straight.points[straight.triangles].mean(axis=1)
        below, _, _ = support.nearest(middle, hint=run.found.sides.label)
        lonely = back[below]
        excess = np.maximum(excess, lonely / near if near > 0.0 else np.where(lonely > 0.0, np.inf, 0.0))
    far = np.flatnonzero(excess > 1.0)
    return far, excess[far], measured


def _longest(run: IntrinsicRun, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """The longest side of each triangle, once if two have it in common."""
    sides = run.found.sides
    h = 3 * triangles + np.argmax(sides.length.reshape(-1, 3)[triangles], axis=1)
    twin = sides.twin[h]
    return np.unique(np.where((twin >= 0) & (twin < h), twin, h)).astype(np.int64)
