"""The inside of a planar domain as polygons: the ends of bodies that are swept over it.

Each part between facets and inner pieces is a polygon with holes. Where inner pieces or loose points end
inside of it, it is the triangles of a constrained Delaunay triangulation, put together to polygons as far as
each remains simple: every such point is then a corner of some of them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...connect.insertion.engine import COUNT
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.flood import mark_regions
from ...connect.planar.inserting import insert_all
from ...geometry.parity import even_odd
from ...geometry.polygons import Polygons
from ..plane.sample import Sampled

__all__ = ["capped"]

Rings = list[NDArray[np.int32]]


def capped(chords: Sampled, ends: NDArray[np.int32]) -> Polygons:
    """The inside of a planar domain as polygons of its points, counterclockwise.

    Parameters
    ----------
    chords : Sampled
    ends : (s, 2) int32
        Of its chords; those of facets have the inside on their left.

    Notes
    -----
    O(n log n) without inner pieces that end inside.
    """
    many = int(np.count_nonzero(chords.piece < len(chords.outline.facets)))
    facets = ends[chords.piece < len(chords.outline.facets)]
    if many == 0:
        return Polygons.of_rows(np.empty((0, 3), dtype=np.int32))
    leaving = np.bincount(facets[:, 0], minlength=len(chords.points))
    if many == len(ends) and (leaving[leaving > 0] == 1).all() and len(chords.outline.loose) == 0:
        return Polygons.of_rings(_polygons(chords.points, facets))
    complex_ = PlanarComplex(chords.points)
    span = np.tile([0.0, 1.0], (len(ends), 1))
    insert_all(complex_, ends, np.arange(len(ends), dtype=np.int32), span, facets=many, progress=False)
    mark_regions(complex_, many, {}, False)
    count = int(complex_.state[COUNT])
    cells = complex_.vertex[: 3 * count].reshape(-1, 3).astype(np.int32)
    region, across = complex_.region[:count], complex_.twin[: 3 * count].astype(np.int64)
    wall = complex_.mark[: 3 * count] >= 0
    slots = np.flatnonzero(region >= 0)
    slots = slots[np.argsort(region[slots], kind="stable")]
    found: list[Rings] = []
    for rows in np.split(slots, np.flatnonzero(np.diff(region[slots])) + 1):
        found += _of_part(chords.points, cells, region, across, wall, rows)
    return Polygons.of_rings(found)


def _of_part(
    points: np.ndarray,
    cells: NDArray[np.int32],
    region: NDArray[np.int32],
    across: NDArray[np.int64],
    wall: NDArray[np.bool_],
    rows: NDArray[np.int64],
) -> list[Rings]:
    """The polygons of the triangles ``rows``, a part between walls."""
    sides = (3 * rows[:, None] + np.arange(3)).ravel()
    start, end = cells[rows][:, [1, 2, 0]].ravel(), cells[rows][:, [2, 0, 1]].ravel()
    border = region[across[sides] // 3] != region[rows[0]]
    own, corners = np.unique(start[border], return_counts=True)
    if not (wall[sides] & ~border).any() and len(own) == len(np.unique(start)) and corners.max() == 1:
        return _polygons(points, np.stack([start[border], end[border]], axis=1))
    place = np.full(len(cells), -1)
    place[rows] = np.arange(len(rows))
    other = np.where(border, -1, place[across[sides] // 3])
    joined = _merged(cells[rows], start, end, other, wall[sides] | border)
    kept = (other < 0) | (joined[np.repeat(np.arange(len(rows)), 3)] != joined[other])
    polygon = joined[np.flatnonzero(kept) // 3]
    found = []
    for one in np.unique(polygon).tolist():
        ring = np.stack([start[kept][polygon == one], end[kept][polygon == one]], axis=1)
        found += _polygons(points, ring)
    return found


def _merged(
    cells: NDArray[np.int32],
    start: NDArray[np.int32],
    end: NDArray[np.int32],
    other: NDArray[np.int64],
    fixed: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """The polygon of each triangle, where triangles are put together across sides as long as that is simple.

    Two polygons are joined if the ends of their common side are all that they share, and have a third side
    each, so that the ends still have two.
    """
    many = len(cells)
    label = list(range(many))
    members = [[t] for t in range(many)]
    corners = [set(row) for row in cells.tolist()]
    degree: dict[int, int] = {}
    once = (other < 0) | (np.repeat(np.arange(many), 3) < other)
    for u, v in zip(start[once].tolist(), end[once].tolist()):
        degree[u], degree[v] = degree.get(u, 0) + 1, degree.get(v, 0) + 1
    for side in np.flatnonzero(once & ~fixed).tolist():
        a, b = label[side // 3], label[int(other[side])]
        u, v = int(start[side]), int(end[side])
        if a == b or degree[u] < 3 or degree[v] < 3:
            continue
        if len(corners[a]) < len(corners[b]):
            a, b = b, a
        if sum(w in corners[a] for w in corners[b]) != 2:
            continue
        corners[a] |= corners[b]
        members[a] += members[b]
        for t in members[b]:
            label[t] = a
        degree[u], degree[v] = degree[u] - 1, degree[v] - 1
    return np.array(label)


def _polygons(points: np.ndarray, facets: np.ndarray) -> list[Rings]:
    """Rings that do not touch as polygons with holes; the inside is on the left of the facets."""
    after = np.empty(len(points), dtype=np.int32)
    after[facets[:, 0]] = facets[:, 1]
    seen = np.zeros(len(points), dtype=bool)
    rings: list[NDArray[np.int32]] = []
    following = dict(facets.tolist())
    for start in facets[:, 0].tolist():
        if seen[start]:
            continue
        ring: list[int] = [start]
        here = following[start]
        while here != start:
            ring.append(here)
            here = following[here]
        seen[ring] = True
        rings.append(np.array(ring, dtype=np.int32))
    # the lowest vertex of a ring has a corner that is convex if and only if the ring is an outline
    area = [_twice_area(points[ring]) for ring in rings]
    outlines = [i for i in range(len(rings)) if area[i] > 0]
    holes = [i for i in range(len(rings)) if area[i] <= 0]
    if len(outlines) == 0:  # rounding leaves nothing of a needle
        outlines, holes = list(range(len(rings))), []
    found: dict[int, Rings] = {i: [rings[i]] for i in outlines}
    tips = points[[rings[i][0] for i in holes]]
    owner = np.full(len(holes), outlines[0])
    if len(outlines) > 1 and holes:
        for i in sorted(outlines, key=lambda i: -area[i]):  # of those that hold a hole the smallest is last
            sides = np.column_stack([rings[i], np.roll(rings[i], -1)])
            owner[even_odd(points, sides, tips)[0]] = i
    for hole, i in zip(holes, owner.tolist()):
        found[i].append(rings[hole])
    return list(found.values())


def _twice_area(ring: np.ndarray) -> float:
    x, y = (ring - ring[0]).T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
