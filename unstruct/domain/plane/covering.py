"""Polygons with holes become pieces of a domain: what is inside, which polygon it belongs to, what bounds it.

The lines of all rings divide the plane into faces. A triangulation finds them. From one face to the next
across a line, inside and outside are exchanged for the rings that the line is part of. So one walk over the
faces, beginning outside, tells for each face which shells and holes contain it. A polygon is its shell minus
its holes; a line bounds the region if there is a polygon on one side only, and is an inner segment if there
are two different ones.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...connect.planar.complex import PlanarComplex
from ...connect.planar.inserting import insert_all
from ...geometry.outline import Outline
from ...mesh.topology import components
from ...predicates.batch import orient_rows
from .account import Repair
from .crossings import distinct_segments, split
from .faults import Fault, refuse

__all__ = ["Covered", "Rings", "covered"]

CORRECT = "correct the rings, or let resolve=True take what they cover together"


class Rings(NamedTuple):
    """Rings of polygons, and lines, as segments between points.

    Attributes
    ----------
    points : (n, 2) float64
        Equal points count as one.
    segments : (s, 2) int64
        All rings' segments and those of lines.
    ring : (s,) int64
        The ring that each segment is part of; -1 for lines.
    polygon : (r,) int64
        The polygon of each ring.
    hole : (r,) bool
        Whether each ring is a hole of its polygon, or its shell.
    """

    points: np.ndarray
    segments: np.ndarray
    ring: np.ndarray
    polygon: np.ndarray
    hole: np.ndarray


class Covered(NamedTuple):
    """Rings as parts of a domain.

    Attributes
    ----------
    points : (n, 2) float64
    origin : (n,) int32
        For each point the first given point that equals it; -1 for crossings.
    facets, inner : (f, 2), (g, 2) int32
    source : (f + g,) int32
        The given segment that each piece is a part of; the first of them, if several coincide.
    parts : (t, 2) int64
        All pairs of a given segment and a piece that is a part of it.
    number : (k,) int64
        For each given point its number in ``points``, or -1.
    seeds : (c, 2) float64
        A point inside of each face that belongs to a polygon.
    polygon : (c,) int64
        The polygon of each of them.
    sound : (c,) bool
        Whether each seed lies strictly inside; not in a face that is narrower than rounding errors.
    repairs : list of Repair
        What was changed; empty unless it was allowed.
    """

    points: np.ndarray
    origin: np.ndarray
    facets: np.ndarray
    inner: np.ndarray
    source: np.ndarray
    parts: np.ndarray
    number: np.ndarray
    seeds: np.ndarray
    polygon: np.ndarray
    sound: np.ndarray
    repairs: list[Repair]


class _Faces(NamedTuple):
    """The faces between lines: the two beside each line, a point in each face, the unbounded face."""

    beside: np.ndarray  # (s, 2)
    seeds: np.ndarray  # (c, 2)
    sound: np.ndarray  # (c,) whether the point lies strictly inside
    outer: int


Namer = Callable[[int], str]


def covered(rings: Rings, named: Namer, line: Namer, *, resolve: bool) -> Covered:
    """Find what the rings cover.

    Parameters
    ----------
    rings : Rings
    named : function
        The name in messages of each ring.
    line : function
        The name in messages of each segment of a line.
    resolve : bool
        Whether lines may cross, polygons overlap, and holes lie anywhere. Then the first polygon that
        contains a point owns it, and the holes of a polygon are removed from its shell. All this is reported.

    Raises
    ------
    DomainError
        Without ``resolve`` for crossings, for polygons that overlap, for holes that leave their polygon or
        overlap, and for rings that run along themselves; the message names rings and the place.

    Notes
    -----
    O(n log n), and for each face the number of rings that change at a line to it.
    """

    def label(s: int) -> str:
        return line(s) if rings.ring[s] < 0 else named(int(rings.ring[s]))

    parts = split(rings.points, rings.segments, label, resolve=resolve)
    n = len(parts.points)
    rows, group, head = distinct_segments(parts.segments, n)
    ring = rings.ring[parts.source]
    of_line = np.zeros(len(rows), dtype=bool)
    of_line[group[ring < 0]] = True
    start, which, repeated = _passes(group, ring, len(rows))
    used = np.ones(len(parts.first), dtype=bool)
    used[rings.segments.ravel()] = False
    used = np.bincount(parts.first[used], minlength=n) > 0  # the loose points
    left = right = np.full(len(rows), -1)
    seeds, polygon, sound = np.empty((0, 2)), np.empty(0, dtype=np.int64), np.empty(0, dtype=bool)
    faults = _vanished(rings, ring, named) + _spikes(parts.points[rows], repeated, named)
    if len(which):
        faces = _faces(parts.points, rows, used)
        owner, found = _walk(rings, faces, start, which, named)
        left, right = owner[faces.beside].T
        empty = np.flatnonzero((left < 0) & (right < 0))
        faults += found + _walls(parts.points[rows], empty, start, which, named)
        inside = np.flatnonzero(owner >= 0)
        seeds, polygon, sound = faces.seeds[inside], owner[inside], faces.sound[inside]
    if faults and not resolve:
        sides = rings.segments.astype(np.int32)
        wrong = [Fault(f.kind, f"{f.text.partition('; ')[0]}; {CORRECT}", f.place) for f in faults]
        refuse(Outline(rings.points, sides, sides[:0], {}, {}, {}), wrong)
    facet = (left < 0) != (right < 0)
    inner = ~facet & (of_line | (left != right))
    used[rows[facet | inner]] = True
    origin = np.flatnonzero(used)
    number = np.full(n, -1, dtype=np.int64)
    number[origin] = np.arange(len(origin))
    order, many = np.concatenate([np.flatnonzero(facet), np.flatnonzero(inner)]), int(facet.sum())
    pieces = number[rows[order]].astype(np.int32)
    piece = np.full(len(rows), -1)
    piece[order] = np.arange(len(order))
    pairs = np.column_stack([parts.source, piece[group]])
    return Covered(
        points=parts.points[origin],
        origin=np.where(origin < len(parts.first), origin, -1).astype(np.int32),
        facets=pieces[:many],
        inner=pieces[many:],
        source=parts.source[head[order]].astype(np.int32),
        parts=pairs[pairs[:, 1] >= 0],
        number=number[parts.first],
        seeds=seeds,
        polygon=polygon,
        sound=sound,
        repairs=parts.repairs + faults,
    )


def _passes(group: np.ndarray, ring: np.ndarray, rows: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(start, which, repeated): the rings that pass along distinct segments.

    ``which[start[i]:start[i + 1]]`` pass along segment i an odd number of times; ``repeated`` has a row
    (segment, ring) for each ring that passes along a segment more than once.
    """
    of_ring = ring >= 0
    width = int(ring.max(initial=0)) + 1
    keys, times = np.unique(group[of_ring] * width + ring[of_ring], return_counts=True)
    odd = keys[times % 2 == 1]
    return np.searchsorted(odd, np.arange(rows + 1) * width), odd % width, _columns(keys[times > 1], width)


def _columns(keys: np.ndarray, width: int) -> np.ndarray:
    return np.column_stack([keys // width, keys % width])


def _vanished(rings: Rings, left: np.ndarray, named: Namer) -> list[Repair]:
    """What to say of rings whose corners are all equal; ``left``: the rings of segments of some length."""
    rows = np.flatnonzero(rings.ring >= 0)
    every, first = np.unique(rings.ring[rows], return_index=True)
    gone = ~np.isin(every, left)
    result = []
    for r, s in zip(every[gone].tolist(), rows[first[gone]].tolist()):
        x, y = rings.points[rings.segments[s, 0]].tolist()
        text = f"all corners of {named(r)} are equal, at ({x:.6g}, {y:.6g}); it was left out"
        result.append(Repair("zero length", text, (x, y)))
    return result


def _spikes(lines: np.ndarray, repeated: np.ndarray, named: Namer) -> list[Repair]:
    """What to say of rings that run along themselves, once for each ring."""
    rings, first = np.unique(repeated[:, 1], return_index=True)
    result = []
    for r, s in zip(rings.tolist(), repeated[first, 0].tolist()):
        x, y = lines[s].mean(axis=0).tolist()
        text = f"{named(r)} runs along itself near ({x:.6g}, {y:.6g}); there it was left out"
        result.append(Repair("spike", text, (x, y)))
    return result


def _walls(
    lines: np.ndarray, empty: np.ndarray, start: np.ndarray, which: np.ndarray, named: Namer
) -> list[Repair]:
    """What to say of rings with a common line that has no polygon on either side, once for two rings."""
    shared = empty[start[empty + 1] - start[empty] > 1]
    pairs = np.column_stack([which[start[shared]], which[start[shared] + 1]])
    pairs, first = np.unique(pairs, axis=0, return_index=True)
    result = []
    for (r, q), s in zip(pairs.tolist(), shared[first].tolist()):
        x, y = lines[s].mean(axis=0).tolist()
        text = f"{named(r)} and {named(q)} share a line near ({x:.6g}, {y:.6g}) with nothing on either side"
        text += "; it was left out"
        result.append(Repair("wall of no thickness", text, (x, y)))
    return result


# ---------------------------------------------------------------------- faces


def _faces(points: np.ndarray, rows: np.ndarray, loose: np.ndarray) -> _Faces:
    """The faces of the plane between segments that meet at vertices only."""
    used = loose.copy()
    used[rows.ravel()] = True
    number = np.cumsum(used, dtype=np.int32) - np.int32(1)
    complex_ = PlanarComplex(points[used])
    many = len(rows)
    span = np.tile([0.0, 1.0], (many, 1))
    insert_all(complex_, number[rows], np.arange(many, dtype=np.int32), span, facets=-1)
    count = complex_.triangles
    vertex, twin = complex_.vertex[: 3 * count], complex_.twin[: 3 * count]
    mark, beyond = complex_.mark[: 3 * count], twin // 3
    face = components(np.where(mark < 0, beyond, -1).reshape(-1, 3))[1]
    half = complex_.where[:many]
    ghost = (vertex.reshape(-1, 3) < 0).any(axis=1)
    outer = int(face[np.argmax(ghost)])
    solid = np.flatnonzero(~ghost)
    seeds, sound = _seeds(complex_.xy, vertex.reshape(-1, 3)[solid], face[solid], int(face.max()) + 1)
    return _Faces(face[np.column_stack([half // 3, beyond[half]])], seeds / complex_.factor, sound, outer)


def _seeds(
    xy: np.ndarray, triangles: np.ndarray, face: np.ndarray, faces: int
) -> tuple[np.ndarray, np.ndarray]:
    """The centroid of the largest triangle of each face, and whether it lies strictly inside."""
    a, b, c = xy[triangles].transpose(1, 0, 2)
    u, v = b - a, c - a
    order = np.lexsort((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], face))
    largest = order[np.append(face[order[1:]] != face[order[:-1]], True)]
    corners = xy[triangles[largest]]
    at = corners.mean(axis=1)
    inside = np.ones(len(largest), dtype=bool)
    for i in range(3):
        three = corners.copy()
        three[:, i] = at
        inside &= orient_rows(three.reshape(-1, 2), np.arange(3 * len(at)).reshape(-1, 3)) > 0
    seeds, sound = np.full((faces, 2), np.nan), np.zeros(faces, dtype=bool)
    seeds[face[largest]], sound[face[largest]] = at, inside
    return seeds, sound


# ---------------------------------------------------------------------- what contains a face


class _Around:
    """The shells and holes around a face, kept up to date while the walk crosses lines."""

    def __init__(self, rings: Rings):
        many = int(rings.polygon.max()) + 1
        self.polygon, self.hole = rings.polygon.tolist(), rings.hole.tolist()
        self.shell = dict(zip(rings.polygon[~rings.hole].tolist(), np.flatnonzero(~rings.hole).tolist()))
        self.within = [False] * len(self.polygon)  # for each ring
        self.shells: list[set[int]] = [set() for _ in range(many)]
        self.holes: list[set[int]] = [set() for _ in range(many)]
        self.covering: set[int] = set()  # polygons
        self.wrong: set[int] = set()  # polygons with a hole outside of the shell, or holes that overlap

    def cross(self, rings: list[int]) -> None:
        """Exchange inside and outside of some rings."""
        for r in rings:
            p = self.polygon[r]
            kind = self.holes[p] if self.hole[r] else self.shells[p]
            if self.within[r]:
                kind.remove(r)
            else:
                kind.add(r)
            self.within[r] = not self.within[r]
            shells, holes = self.shells[p], self.holes[p]
            (self.covering.add if shells and not holes else self.covering.discard)(p)
            (self.wrong.add if len(holes) > len(shells) else self.wrong.discard)(p)


def _walk(
    rings: Rings, faces: _Faces, start: np.ndarray, which: np.ndarray, named: Namer
) -> tuple[np.ndarray, list[Repair]]:
    """The first polygon that contains each face, -1 for none, and what is wrong with polygons.

    Neighboring faces differ by the rings of any line between them, so one line for two faces is enough.
    """
    one, two = np.sort(faces.beside, axis=1).T
    _, line = np.unique(one * np.int64(len(faces.seeds)) + two, return_index=True)
    line = line[one[line] != two[line]]
    beyond: list[list[tuple[int, int]]] = [[] for _ in faces.seeds]
    for s, (f, g) in zip(line.tolist(), faces.beside[line].tolist()):
        beyond[f].append((g, s))
        beyond[g].append((f, s))
    around, owner = _Around(rings), np.full(len(faces.seeds), -2)
    at, ends = which.tolist(), start.tolist()
    faults: dict[tuple[int, ...], Repair] = {}
    owner[faces.outer] = -1
    stack = [(faces.outer, -1, iter(beyond[faces.outer]))]
    while stack:
        _, line_back, rest = stack[-1]
        for other, s in rest:
            if owner[other] == -2:
                around.cross(at[ends[s] : ends[s + 1]])
                owner[other] = min(around.covering, default=-1)
                if around.wrong or len(around.covering) > 1:
                    _judge(around, faces.seeds[other], named, faults)
                stack.append((other, s, iter(beyond[other])))
                break
        else:
            stack.pop()
            if line_back >= 0:
                around.cross(at[ends[line_back] : ends[line_back + 1]])
    return owner, list(faults.values())


def _judge(around: _Around, seed: np.ndarray, named: Namer, faults: dict[tuple[int, ...], Repair]) -> None:
    """Add what is wrong in a face, once for the same rings."""
    x, y = seed.tolist()
    near = f"near ({x:.6g}, {y:.6g})"
    for p in sorted(around.wrong):
        holes = sorted(around.holes[p])
        if around.shells[p]:
            key = (holes[0], holes[1])
            text = f"{named(key[0])} and {named(key[1])} overlap {near} (an island there is another polygon)"
            text += "; both were removed"
            kind = "overlapping holes"
        else:
            key = (holes[0], -1)
            text = f"{named(key[0])} lies outside {named(around.shell[p])} {near}; there it has no effect"
            kind = "hole outside"
        faults.setdefault(key, Repair(kind, text, (x, y)))
    if len(around.covering) > 1:
        first, second = sorted(around.covering)[:2]
        one, two = around.shell[first], around.shell[second]
        text = f"{named(one)} and {named(two)} overlap {near}; the common part belongs to the first"
        faults.setdefault((one, two), Repair("overlapping polygons", text, (x, y)))
