"""Sharp convex creases of walls, and the fans of rays along them.

Over an edge at which a wall turns by 164 degrees, as at a trailing edge of 16, one ray is at 82 degrees to
both normals: cells beside it are thin however fine the layers are. With several rays at each vertex of the
crease, from the normal of one side to that of the other, the wall is cut open along it (each side a *sheet*
with rays of its own), and the gap between both sheets is filled: over each edge, between two neighbors of
the fans at its ends, stand a wedge lying on its side, and hexahedra on top of it, up to the cap. Where
tetrahedra follow, a pyramid stands on each quadrilateral of the cap. Where three or more creases meet, the
rays of all make a polygon on the sphere; its triangles carry a tetrahedron and wedges on top.

To divide the topmost hexahedra from points inside instead was measured: around a lens of 16 degrees, with a
top layer of a quarter of an edge, the least scaled Jacobian of the parts is at most .19, wherever the points
are, and of a fifteenth .018: all parts are as flat as the layer is. That of the pyramids is .81 and .28.

A crease that ends where a vertex V can have only one ray VV' would need, between it and a vertex U with a
fan, a cell with two quadrilaterals that share the edges UV and VV': as they meet in no third edge at V, its
Jacobian is zero there. If the cells beside are divided so that these quadrilaterals are triangles, there can
be tetrahedra in its place; but each has a triangle of which one side is as short as the first layer is high,
and two are as long as the edge. At 16 degrees, with five rays and a first layer of a fiftieth of the edge,
the least scaled Jacobian is .008 then, of a tenth .038. Nor could more rays elsewhere raise that of the
crease to more than 2 / sqrt 3 cos(a / 2), where the normals beside UV are at an angle a: the ray of V is at
a / 2 or more to one of them. So such creases keep one ray.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .records import Walls
from .stars import Stars, unit_normals

__all__ = ["Creases", "Fans", "chains_of", "creases_of", "fans_of", "no_fans", "usable"]

Numbers = NDArray[np.int64]
Flags = NDArray[np.bool_]

CREASE_FROM = 50.0  # degrees between the normals of both sides, from which on an edge is a sharp crease
RAY_EVERY = 45.5  # degrees between two rays of a fan, at most: a right angle has three
EAR_COSINE = 0.5  # of the angle of a sheet at a corner, up to which its ray is cut off from the others
STEPS_OF_CREASE = [math.cos(math.radians(RAY_EVERY * k)) for k in range(1, 4)]


class Creases(NamedTuple):
    """The edges of sharp convex creases: e edges.

    Attributes
    ----------
    ends : (e, 2) int64
        In the direction in which the triangle of ``sides[:, 0]`` has them.
    sides : (e, 2) int64
        Places 3 t + k of the side in both triangles, opposite corner k.
    steps : (e,) int64
        How many gaps a fan has there.
    """

    ends: Numbers
    sides: Numbers
    steps: Numbers


class Fans(NamedTuple):
    """Rays with fans: those of sheets first, of which the first n are one at each vertex; then the others.

    Attributes
    ----------
    base : (r,) int32
        The vertex of the wall from which each ray starts.
    sheets : int
        How many rays belong to sheets.
    columns : (t, 3) int32
        The triangles of the walls, as rows of rays.
    quads : (q, 4) int32
        Rows of rays: over an edge, two at its first end, two at its second one; counterclockwise from above.
    corners : (c, 3) int32
        Rows of rays that start at the same vertex.
    crease : (q,) int64
        A number of the crease, for each of ``quads``.
    owner : (q + c,) int64
        A triangle beside each.
    rims : (i, 3) int64
        Where creases end in planes: two neighboring rays of the fan, and a triangle beside.
    between : (i, 2) int64, share : (i,) float64
        For rays after those of sheets the two rays between which they are, and where; -1 for the rays in the
        middle of corners, which have the directions of single rays.
    """

    base: NDArray[np.int32]
    sheets: int
    columns: NDArray[np.int32]
    quads: NDArray[np.int32]
    corners: NDArray[np.int32]
    crease: Numbers
    owner: Numbers
    rims: Numbers
    between: Numbers
    share: NDArray[np.float64]

    @property
    def caps(self) -> NDArray[np.int32]:
        """Triangles of rays: two for each of ``quads``, cut from its lowest ray, then ``corners``."""
        turn = (self.quads.argmin(axis=1)[:, None] + np.arange(4)) % 4
        rows = np.take_along_axis(self.quads, turn, axis=1)
        halves = np.stack([rows[:, [0, 1, 2]], rows[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
        return np.concatenate([halves, self.corners]).astype(np.int32)


def no_fans(walls: Walls) -> Fans:
    """One ray at each vertex."""
    n = len(walls.points)
    none = np.empty(0, dtype=np.int64)
    return Fans(
        np.arange(n, dtype=np.int32),
        n,
        walls.triangles,
        np.empty((0, 4), dtype=np.int32),
        np.empty((0, 3), dtype=np.int32),
        none,
        none,
        np.empty((0, 3), dtype=np.int64),
        np.empty((0, 2), dtype=np.int64),
        np.empty(0),
    )


def creases_of(walls: Walls, stars: Stars) -> Creases:
    """The edges at which the wall turns away from the layers sharply."""
    normals, _ = unit_normals(walls.points, walls.triangles)
    one = np.flatnonzero(stars.mates > np.arange(len(stars.mates)))
    two = stars.mates[one]
    t, k = one // 3, one % 3
    m, n = normals[t], normals[two // 3]
    cosine = m[:, 0] * n[:, 0] + m[:, 1] * n[:, 1] + m[:, 2] * n[:, 2]
    a, b = walls.triangles[t, (k + 1) % 3], walls.triangles[t, (k + 2) % 3]
    opposite = walls.points[walls.triangles[two // 3, two % 3]] - walls.points[a]
    below = m[:, 0] * opposite[:, 0] + m[:, 1] * opposite[:, 1] + m[:, 2] * opposite[:, 2] < 0.0
    rows = np.flatnonzero((cosine < math.cos(math.radians(CREASE_FROM))) & below)
    steps = 1 + (cosine[rows, None] < np.array(STEPS_OF_CREASE)).sum(axis=1)
    ends = np.column_stack([a, b])[rows].astype(np.int64)
    return Creases(ends, np.column_stack([one, two])[rows].astype(np.int64), steps)


def usable(
    walls: Walls, stars: Stars, creases: Creases, kept: Flags, ending: Flags | None = None
) -> tuple[Flags, Numbers]:
    """The edges of those that are kept whose creases can have fans from end to end, and their creases.

    A crease ends at vertices with another number of edges of creases than two. It can end where there are
    three or more, or in one plane, where it comes alone.

    Parameters
    ----------
    walls, stars, creases
    kept : (e,) bool
    ending : (n,) bool, optional
        At which vertices in planes creases may end; by default at all.

    Returns
    -------
    usable : (e,) bool
    crease : (e,) int64
        The crease of each edge: a number of one of its edges.
    """
    kept = kept.copy()
    border = np.zeros(len(walls.points), dtype=bool)
    side = np.flatnonzero(stars.mates < 0)
    border[walls.triangles[side // 3, (side % 3 + 1) % 3]] = True
    border[walls.triangles[side // 3, (side % 3 + 2) % 3]] = True
    in_one = (walls.planes[:, 0] >= 0) & (walls.planes[:, 1] < 0)
    in_one = in_one if ending is None else in_one & ending
    while True:
        degree = np.bincount(creases.ends[kept].ravel(), minlength=len(walls.points))
        crease = _chains(creases.ends, kept, (degree == 2) & ~border)
        bad = np.where(border, (degree != 1) | ~in_one, degree == 1) & (degree > 0)
        wrong = kept & bad[creases.ends].any(axis=1)
        if not wrong.any():
            return kept, crease
        kept &= ~np.isin(crease, crease[wrong])


def chains_of(creases: Creases) -> Numbers:
    """The crease of each edge, before any is found not to be usable."""
    degree = np.bincount(creases.ends.ravel(), minlength=1)
    return _chains(creases.ends, np.ones(len(creases.ends), dtype=bool), degree == 2)


def _chains(ends: Numbers, kept: Flags, through: Flags) -> Numbers:
    """A number for each edge, the same for edges that hang together through some vertices."""
    parent = list(range(len(ends)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    last: dict[int, int] = {}
    for i in np.flatnonzero(kept).tolist():
        for v in ends[i].tolist():
            if through[v]:
                if v in last:
                    parent[root(i)] = root(last[v])
                last[v] = i
    return np.array([root(i) for i in range(len(ends))], dtype=np.int64)


class _Rays:
    """The rays that are made, one after the other."""

    def __init__(self, many: int):
        self.base = list(range(many))
        self.between: list[tuple[int, int]] = []
        self.share: list[float] = []

    def sheet(self, v: int) -> int:
        """A further ray of a sheet."""
        self.base.append(v)
        return len(self.base) - 1

    def within(self, v: int, ends: tuple[int, int], steps: int) -> list[int]:
        """The rays between two."""
        first = len(self.base)
        for i in range(1, steps):
            self.base.append(v)
            self.between.append(ends)
            self.share.append(i / steps)
        return list(range(first, len(self.base)))

    def middle(self, v: int) -> int:
        """The ray in the middle of a corner."""
        self.between.append((-1, -1))
        self.share.append(0.0)
        return self.sheet(v)


def fans_of(walls: Walls, stars: Stars, creases: Creases, kept: Flags, crease: Numbers) -> Fans:
    """Fans along creases; arguments as `usable` returns them. O(t) and a loop over the edges of creases."""
    steps = creases.steps.copy()
    np.maximum.at(steps, crease, creases.steps)
    steps = steps[crease]
    edge = np.full(3 * len(walls.triangles), -1, dtype=np.int64)
    rows = np.flatnonzero(kept)
    for k in range(2):
        edge[creases.sides[rows, k]] = rows
    columns = walls.triangles.copy()
    rays = _Rays(len(walls.points))
    vertices = np.unique(creases.ends[kept]).tolist()
    crossed = {v: _cut(rays, columns, stars, edge, v) for v in vertices}
    sheets = len(rays.base)
    along: dict[tuple[int, int], list[int]] = {}
    corners: list[list[int]] = []
    beside: list[int] = []
    rims: list[tuple[int, int, int]] = []
    for v in vertices:
        polygon: list[list[int]] = []
        for e, one, two in crossed[v]:
            ends = crossed[v]
            if len(ends) == 2 and e == ends[1][0]:  # the same rays as on the other side
                along[v, e] = along[v, ends[0][0]][::-1]
                continue
            row = [one, *rays.within(v, (one, two), int(steps[e])), two]
            along[v, e] = row
            polygon.append(row)
        first = int(stars.around[stars.start[v]]) // 3
        if len(crossed[v]) == 1:
            rims += [(row[i], row[i + 1], first) for i in range(len(row) - 1)]
        if len(crossed[v]) > 2:
            ears = _ears(walls.points, creases.ends, v, [e for e, _, _ in crossed[v]])
            found = list(_triangles(rays, v, polygon, ears))
            corners += found
            beside += [first] * len(found)
    quads, owner, which = [], [], []
    for e in rows.tolist():
        a, b = creases.ends[e].tolist()
        left, right = along[a, e][::-1], along[b, e]
        for i in range(len(left) - 1):
            quads.append([left[i], left[i + 1], right[i + 1], right[i]])
            owner.append(int(creases.sides[e, 0]) // 3)
            which.append(int(crease[e]))
    return Fans(
        np.array(rays.base, dtype=np.int32),
        sheets,
        columns,
        np.array(quads, dtype=np.int32).reshape(-1, 4),
        np.array(corners, dtype=np.int32).reshape(-1, 3),
        np.array(which, dtype=np.int64),
        np.array(owner + beside, dtype=np.int64),
        np.array(rims, dtype=np.int64).reshape(-1, 3),
        np.array(rays.between, dtype=np.int64).reshape(-1, 2),
        np.array(rays.share),
    )


def _cut(
    rays: _Rays, columns: NDArray[np.int32], stars: Stars, edge: Numbers, v: int
) -> list[tuple[int, int, int]]:
    """Give the sheets at a vertex rays of their own; the edges between them, the rays before and after."""
    around = stars.around[stars.start[v] : stars.start[v + 1]]
    after = edge[3 * (around // 3) + (around % 3 + 1) % 3]  # the edge that follows each triangle
    first = 3 * (int(around[0]) // 3) + (int(around[0]) % 3 + 2) % 3
    cuts = np.flatnonzero(after >= 0).tolist()
    closed = stars.mates[first] >= 0
    if closed:
        bounds = [(cuts[i - 1] + 1, cuts[i] + 1) for i in range(len(cuts))]
    else:
        bounds = list(zip([0] + [c + 1 for c in cuts], [c + 1 for c in cuts] + [len(around)], strict=True))
    sheet = []
    for i, (start, stop) in enumerate(bounds):
        ray = rays.sheet(v) if i else v
        sheet.append(ray)
        places = np.arange(start, stop if start < stop else stop + len(around)) % len(around)
        columns[around[places] // 3, around[places] % 3] = ray
    follow = sheet[1:] + sheet[:1]
    return [(int(after[cuts[i]]), sheet[i], follow[i]) for i in range(len(cuts))]


def _ears(points: NDArray[np.float64], ends: Numbers, v: int, edges: list[int]) -> list[bool]:
    """Whether the sheet before each edge has an angle there that is neither acute nor obtuse."""
    along = []
    for e in edges:
        x, y, z = (points[ends[e].sum() - v] - points[v]).tolist()
        length = math.sqrt(x * x + y * y + z * z) or 1.0
        along.append((x / length, y / length, z / length))
    pairs = [(along[i - 1], along[i]) for i in range(len(along))]
    return [abs(p[0] * q[0] + p[1] * q[1] + p[2] * q[2]) <= EAR_COSINE for p, q in pairs]


def _triangles(rays: _Rays, v: int, rows: list[list[int]], ears: list[bool]) -> Iterator[list[int]]:
    """The triangles of the polygon of the rays of a corner: rows of fans, from sheet to sheet.

    Rays of sheets are cut off where this makes good triangles; what is left gets a ray in its middle.
    """
    polygon: list[int] = []
    for i, row in enumerate(rows):
        before = rows[i - 1]
        if ears[i] and len(row) > 2 and len(before) > 2:
            yield [before[-2], row[0], row[1]]
            polygon += row[1:-1]
        else:
            polygon += row[:-1]
    if len(polygon) == 3:
        yield polygon
        return
    middle = rays.middle(v)
    for i in range(len(polygon)):
        yield [middle, polygon[i - 1], polygon[i]]
