"""Faults of the pieces of a body: an exact search, in stages; each fault names its pieces and its place.

Which way a facet is turned does not matter: by the even-odd rule its inside follows from all of them.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from ...base.arrays import surely_different
from ...geometry.embedded import embedded, flat_rows
from ...geometry.outline import Outline
from ...geometry.triangle_pairs import (
    EDGES_CROSS,
    OVERLAP,
    PIERCES,
    VERTEX_ON_EDGE,
    Meetings,
    crossing_segments,
    edges_of,
    meetings_in_space,
    points_on_edges,
    points_on_triangles,
    sides_index,
)
from ..plane.faults import Fault
from .cutting import Shell, at, cut, place
from .open_edges import open_edges

__all__ = [
    "NO_PLACE",
    "crossing_faults",
    "crossing_place",
    "find_faults",
    "first_copies",
    "meeting_faults",
    "repeats",
    "shell_of",
]

NO_PLACE = (float("nan"),) * 3
CROSSING_BODIES = (
    "the facets of a body must not cross: unite the bodies first (with manifold3d, for example; here only "
    "crossings at doubles are cut, by resolve=True)"
)
CROSSING_INNER = "put a vertex of both there, or leave the inner piece out"


def shell_of(outline: Outline) -> Shell:
    """The triangles of a body without faults."""
    polygons: Any = outline.pieces
    return cut(outline.points, polygons, len(outline.facets))[0]


def find_faults(outline: Outline, *, meetings: bool = True) -> list[Fault]:
    """All faults, in stages: a stage is the last if it finds any.

    Without ``meetings``, whether pieces meet is not asked, nor what comes after it.
    """
    for stage in (_indices, _duplicates, _repeated_vertices):
        faults = stage(outline)
        if faults:
            return faults
    polygons: Any = outline.pieces
    shell, faults = cut(outline.points, polygons, len(outline.facets))
    if faults:
        return [replace(f, text=f.text.format(name=outline.name(f.pieces[0]))) for f in faults]
    for later in (_flat, _repeated, _meetings, _loose, open_edges)[: None if meetings else 2]:
        faults = later(outline, shell)
        if faults:
            return faults
    return []


def first_copies(points: np.ndarray) -> np.ndarray:
    """For each point the lowest number of a point with equal coordinates (0.0 equals -0.0)."""
    if surely_different(points):
        return np.arange(len(points))
    rows = points + 0.0
    order = np.lexsort(rows.T[::-1])
    head = np.ones(len(rows), dtype=bool)
    head[1:] = (rows[order[1:]] != rows[order[:-1]]).any(axis=1)
    first = np.empty(len(rows), dtype=np.int64)
    first[order] = order[np.maximum.accumulate(np.where(head, np.arange(len(rows)), 0))]
    return first


# ---------------------------------------------------------------------- what the arrays show


def _indices(outline: Outline) -> list[Fault]:
    polygons: Any = outline.pieces
    n, flat = len(outline.points), polygons.vertices
    bad = np.flatnonzero((flat < 0) | (flat >= n))
    owner = np.repeat(np.arange(len(polygons)), polygons.corners)[bad]
    return [
        Fault(
            "index out of range",
            f"{outline.name(i)} refers to points outside 0..{n - 1}: {v}; correct the index, or let "
            "resolve=True drop the facet",
            NO_PLACE,
            (i,),
        )
        for i, v in dict(zip(owner.tolist()[::-1], flat[bad].tolist()[::-1])).items()
    ][::-1]


def _duplicates(outline: Outline) -> list[Fault]:
    first, points = first_copies(outline.points), outline.points
    return [
        Fault(
            "duplicate points",
            f"points {first[copy]} and {copy} are equal, {at(points[copy])}; use only one of them, or let "
            "resolve=True merge them",
            place(points[copy]),
            vertices=(int(first[copy]), copy),
        )
        for copy in np.flatnonzero(first != np.arange(len(first))).tolist()
    ]


def _repeated_vertices(outline: Outline) -> list[Fault]:
    """Polygons in which a vertex stands twice: sides without length, rings that touch themselves."""
    polygons: Any = outline.pieces
    whole = polygons.triangles
    if whole is not None:
        a, b, c = whole.T
        if not ((a == b) | (b == c) | (c == a)).any():
            return []
    owner = np.repeat(np.arange(len(polygons)), polygons.corners)
    key = (owner << 32) | polygons.vertices
    order = np.argsort(key, kind="stable")
    twice = np.flatnonzero(np.diff(key[order]) == 0)
    result = []
    for i, v in zip(owner[order[twice]].tolist(), polygons.vertices[order[twice]].tolist()):
        text = (
            f"{outline.name(i)} has point {v} twice, {at(outline.points[v])}; leave one out, or let "
            "resolve=True do so"
        )
        result.append(Fault("repeated vertex", text, place(outline.points[v]), (i,), (v,)))
    return result


# ---------------------------------------------------------------------- what the triangles show


def _rows(outline: Outline, shell: Shell, t: int) -> str:
    """The name of the piece of a triangle, with its vertices."""
    i = int(shell.piece[t])
    polygons: Any = outline.pieces
    row = "" if polygons.corners[i] > 8 else f" = {polygons.vertices_of(i).tolist()}"
    return f"{outline.name(i)}{row}"


def _flat(outline: Outline, shell: Shell) -> list[Fault]:
    """Triangles whose vertices lie on a line."""
    result = []
    for t in flat_rows(shell.points, shell.triangles).tolist():
        row = shell.triangles[t]
        text = (
            f"{_rows(outline, shell, t)} has no area: its vertices lie on a line, "
            f"{at(shell.points[row[0]])}; leave it out, or let resolve=True do so"
        )
        where = place(shell.points[row[0]])
        result.append(Fault("zero area", text, where, (int(shell.piece[t]),), tuple(row.tolist())))
    return result


def repeats(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of rows with the same vertices: each with the next one of its kind."""
    if surely_different(rows, as_sets=True):
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    rows = np.sort(rows, axis=1)
    order = np.lexsort(rows.T[::-1])
    same = np.flatnonzero((rows[order[1:]] == rows[order[:-1]]).all(axis=1))
    return order[same], order[same + 1]


def _repeated(outline: Outline, shell: Shell) -> list[Fault]:
    """Facets, or inner segments, with the same vertices."""
    result = []
    for rows, piece in ((shell.triangles, shell.piece), (shell.segments, shell.segment_piece)):
        for one, two in zip(*map(np.ndarray.tolist, repeats(rows))):
            i, j = int(piece[one]), int(piece[two])
            text = (
                f"{outline.name(i)} and {outline.name(j)} have the same points {sorted(rows[one].tolist())}, "
                f"{at(shell.points[rows[one].min()])}; drop one, or let resolve=True do so (it keeps one "
                "of two equal facets if the surface is closed only with it, else, by the even-odd rule, none)"
            )
            result.append(Fault("repeated facet", text, place(shell.points[rows[one].min()]), (i, j)))
    return result


def _meetings(outline: Outline, shell: Shell) -> list[Fault]:
    """Edges and inner segments that meet a triangle outside of common vertices."""
    if embedded(shell.points, shell.triangles):
        if len(shell.segments) == 0:
            return []
        own = np.empty((0, 2), dtype=np.int32)
    else:
        own = edges_of(shell.triangles) if len(shell.triangles) else np.empty((0, 2), dtype=np.int32)
    edges = np.concatenate([own, shell.segments]).astype(np.int32)
    met = meetings_in_space(shell.points, shell.triangles, edges)
    return [*meeting_faults(outline, shell, edges, met), *crossing_faults(outline, shell)]


def meeting_faults(outline: Outline, shell: Shell, edges: np.ndarray, met: Meetings) -> list[Fault]:
    """These meetings as faults; the edges of triangles come first, then the segments."""
    own = len(edges) - len(shell.segments)
    found: dict[Any, Fault] = {}
    if len(met.edge) == 0:
        return []
    key, triangle = sides_index(shell.triangles)
    low, high = np.sort(edges[:own], axis=1).astype(np.int64).T
    # the piece of each edge: that of its first triangle, or the segment's
    owner = np.concatenate(
        [shell.piece[triangle[np.searchsorted(key, (low << 32) | high)]], shell.segment_piece]
    )
    for k in range(len(met.edge)):
        fault = _meeting(outline, shell, edges, owner, met, k)
        found.setdefault((fault.kind, tuple(sorted(fault.pieces)), fault.vertices), fault)
    return list(found.values())


def _meeting(
    outline: Outline, shell: Shell, edges: np.ndarray, owner: np.ndarray, met: Meetings, k: int
) -> Fault:
    """One meeting as a fault."""
    e, t, kind, v = int(met.edge[k]), int(met.triangle[k]), int(met.kind[k]), int(met.vertex[k])
    j = int(owner[e])
    p, q = edges[e].tolist()
    i = int(shell.piece[t])
    if e < len(edges) - len(shell.segments):
        one = f"{outline.name(j)} (edge {p}-{q})"
    else:
        one = f"{outline.name(j)} = [{p}, {q}]"
    two = _rows(outline, shell, t)
    if v >= 0:
        where = place(shell.points[v])
        if kind == VERTEX_ON_EDGE:
            on = f"an edge of {two}" if v in (p, q) else f"the edge {p}-{q} of {outline.name(j)}"
            name = "vertex on an edge"
        else:
            on, name = two, "vertex on a facet"
        text = (
            f"point {v} lies on {on}, {at(shell.points[v])}; split the facet there, or let resolve=True do so"
        )
        return Fault(name, text, where, (i, j), (v,))
    if kind in (PIERCES, EDGES_CROSS):
        where = tuple(map(float, crossing_place(shell.points, p, q, shell.triangles[t])))
        remedy = CROSSING_BODIES if max(i, j) < shell.facets else CROSSING_INNER
        text = f"{one} crosses {two} {at(np.array(where))}; {remedy}"
        return Fault("crossing", text, where, (i, j))
    assert kind == OVERLAP
    where = place(shell.points[[p, q]].mean(axis=0))
    if e < len(edges) - len(shell.segments):
        text = (
            f"{one} and {two} overlap in a plane, near {at(np.array(where))[3:]}; cut both along the outline "
            "of what they have in common, and drop what is there twice, or let resolve=True do so"
        )
    else:
        text = (
            f"{one} lies in {two} and crosses an edge of it, or ends inside, near {at(np.array(where))[3:]}; "
            "split the facet and the segment there, or let resolve=True do so"
        )
    return Fault("overlap", text, where, (i, j))


def crossing_place(points: np.ndarray, p: int, q: int, triangle: np.ndarray) -> tuple[Fraction, ...]:
    """Where a segment crosses the plane of a triangle, as rational numbers."""
    rows = [[Fraction(x) for x in points[v].tolist()] for v in (p, q, *triangle.tolist())]
    a, b, o, u, v = rows
    u, v = ([x - y for x, y in zip(w, o)] for w in (u, v))
    n = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
    one, two = (sum((x * (y - z) for x, y, z in zip(n, w, o)), Fraction(0)) for w in (a, b))
    share = one / (one - two)
    return tuple(x + share * (y - x) for x, y in zip(a, b))


def crossing_faults(outline: Outline, shell: Shell) -> list[Fault]:
    """Inner segments that meet another inner segment, or an end of one, apart from facets."""
    rows = shell.segments
    if len(rows) == 0:
        return []
    result = []
    for v, s in zip(*map(np.ndarray.tolist, points_on_edges(shell.points, np.unique(rows), rows))):
        i = int(shell.segment_piece[s])
        text = (
            f"point {v} lies on {outline.name(i)}, {at(shell.points[v])}; split the segment there, or let "
            "resolve=True do so"
        )
        result.append(Fault("vertex on a segment", text, place(shell.points[v]), (i,), (v,)))
    for s, t in zip(*map(np.ndarray.tolist, crossing_segments(shell.points, rows))):
        i, j = int(shell.segment_piece[s]), int(shell.segment_piece[t])
        where = _nearest(shell.points, rows[s], rows[t])
        text = f"{outline.name(i)} and {outline.name(j)} cross, {at(np.array(where))}; put a vertex there"
        result.append(Fault("crossing", text, where, (i, j)))
    return result


def _nearest(points: np.ndarray, s: np.ndarray, t: np.ndarray) -> tuple[float, ...]:
    """Where two segments that cross meet, up to rounding."""
    a, b, c, d = points[[*s, *t]]
    sides = np.column_stack([b - a, c - d])
    share = np.linalg.lstsq(sides, c - a, rcond=None)[0]
    return place(a + share[0] * (b - a))


def _loose(outline: Outline, shell: Shell) -> list[Fault]:
    """Vertices of no piece that lie on a facet or a segment."""
    loose = np.asarray(outline.loose)
    if len(loose) == 0:
        return []
    result: list[Fault] = []
    if len(shell.triangles):
        for v, t, _ in zip(
            *map(np.ndarray.tolist, points_on_triangles(shell.points, loose, shell.triangles))
        ):
            i = int(shell.piece[t])
            text = (
                f"point {v} lies on {_rows(outline, shell, t)}, {at(shell.points[v])}; split the facet "
                "there, or move the point"
            )
            result.append(Fault("vertex on a facet", text, place(shell.points[v]), (i,), (v,)))
    if len(shell.segments):
        for v, s in zip(*map(np.ndarray.tolist, points_on_edges(shell.points, loose, shell.segments))):
            i = int(shell.segment_piece[s])
            text = (
                f"point {v} lies on {outline.name(i)}, {at(shell.points[v])}; split the segment there, or "
                "move the point"
            )
            result.append(Fault("vertex on a segment", text, place(shell.points[v]), (i,), (v,)))
    return [*{(f.kind, f.pieces, f.vertices): f for f in result}.values()]
