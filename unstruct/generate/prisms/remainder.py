"""What layers leave of a body, as a body of its own: its walls are replaced by the cap of the layers.

Facets that are no walls stay. Polygons in whose planes layers slide are cut anew: where a side of the polygon
is a side of a wall, the side of the cap above it takes its place. See the book, chapter 5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import DomainError, InputError
from ...domain.domain import Domain
from ...geometry.polygons import Polygons
from .flat_sides import number_of

__all__ = ["Grown", "Remainder", "border_edges", "padded_to_four", "remainder", "side_pieces"]

Rows = NDArray[np.int64]
CAP_NAME = "a triangle of the cap"


class Grown(NamedTuple):
    """Layers on the walls of a body.

    Attributes
    ----------
    points : (n, 3) float64
        Their vertices.
    cells : dict of str to array
        By kind; "tetra" is the last one.
    column : (c,) int64
        For each cell, through all kinds, the face of the cap that it is below; the first of several.
    layer : (c,) int64
        The layer of each.
    stem : (n,) int64
        For each vertex the point of the body from which its ray starts.
    level : (n,) int64
        Of each vertex; those of level 0 are points of the body.
    base : (t, 3) int64
        The triangles of walls.
    piece : (t,) int64
        The piece of the body that each is a part of.
    cap : (t, 3) or (t, 4) int64
        The faces above them: the same vertices where there are no layers. With quadrilaterals triangles are
        padded by -1; there are none with anything beyond.
    """

    points: NDArray[np.float64]
    cells: dict[str, NDArray[np.int32]]
    column: Rows
    layer: Rows
    stem: Rows
    level: Rows
    base: Rows
    piece: Rows
    cap: Rows


class Remainder(NamedTuple):
    """What layers leave of a body.

    Attributes
    ----------
    domain : Domain
        Facets: what is left of those that are no walls, then the triangles of the cap.
    vertex : (m,) int64
        For each of its points the point of the body, or N and the vertex of the layers, where the body has N
        points.
    piece : (p,) int64
        For each of its pieces the piece of the body, -1 for triangles of the cap.
    cap : slice
        The pieces that are triangles of the cap.
    """

    domain: Domain
    vertex: Rows
    piece: Rows
    cap: slice

    def name(self, piece: int, body: Domain) -> str:
        """What messages call a piece."""
        return CAP_NAME if self.piece[piece] < 0 else body.name(int(self.piece[piece]))


def padded_to_four(rows: Rows) -> Rows:
    """Rows of three vertices with -1 as the fourth; others as they are."""
    return np.column_stack([rows, np.full((len(rows), 4 - rows.shape[1]), -1)])


def border_edges(triangles: Rows) -> Rows:
    """The edges that only one of some triangles has, in its direction: (e, 2)."""
    ends = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    key = np.sort(ends, axis=1)
    _, which, count = np.unique(key[:, 0] << 32 | key[:, 1], return_inverse=True, return_counts=True)
    return ends[count[which] == 1]


def _is_wall(domain: Domain, grown: Grown) -> NDArray[np.bool_]:
    return flagged(len(domain.facets), grown.piece)


def remainder(domain: Domain, grown: Grown) -> Remainder:
    """The rest of a body.

    Raises
    ------
    InputError
        If inner pieces end at walls, or what is left is no body, because the layers meet pieces that are no
        walls.
    """
    many = len(domain.points)
    facets, inner = Polygons.of(domain.facets), Polygons.of(domain.inner)
    wall = _is_wall(domain, grown)
    on_wall = flagged(many, grown.stem)
    meets = np.flatnonzero(on_wall[inner.vertices]) if len(inner) else np.empty(0, dtype=np.int64)
    if len(meets):
        at = int(inner.vertices[meets[0]])
        raise InputError(
            f"an inner piece ends at vertex {number_of(domain, at)} of a wall, at "
            f"{domain.points[at].tolist()}: layers would cut it; leave the facets there out of walls"
        )
    number = np.where(grown.level == 0, grown.stem, many + np.arange(len(grown.points)))
    kept = np.flatnonzero(~wall)
    outer = _lifted(facets.select(kept), grown, number, many)
    cap = number[grown.cap]
    used = flagged(many + len(grown.points), outer.vertices, cap, inner.vertices, np.asarray(domain.loose))
    vertex = np.flatnonzero(used)
    place = np.zeros(len(used), dtype=np.int32)
    place[vertex] = np.arange(len(vertex))
    every = Polygons.joined(outer, Polygons.of_rows(cap)).renumbered(place)
    points = np.concatenate([domain.points, grown.points])[vertex]
    try:
        rest = Domain(points, every, inner=inner.renumbered(place) if len(inner) else None)
    except DomainError as error:
        where = next((fault.place for fault in error.faults if fault.place is not None), None)
        near = "" if where is None else f", near {[float(f'{x:.6g}') for x in where]}"
        raise InputError(
            f"what the layers leave is no body, because they meet pieces that are no walls{near}: make "
            "layers thinner, or leave these pieces out, or make them walls"
        ) from error
    piece = np.concatenate([kept, np.full(len(cap), -1), len(facets) + np.arange(len(inner))])
    return Remainder(rest, vertex, piece, slice(len(kept), len(kept) + len(cap)))


def _lifted(polygons: Polygons, grown: Grown, number: Rows, many: int) -> Polygons:
    """Polygons whose vertices at walls are replaced by those above them; vertices as in `Remainder`."""
    place = np.arange(many)
    rim = border_edges(grown.cap)[:, 0]  # the border is loops: each of its vertices begins one edge
    place[grown.stem[rim]] = number[rim]
    rows = _fans_of_border(grown)
    return _inserted(polygons, {v: (u, number[row]) for v, (u, row) in rows.items()}, place)


def _fans_of_border(grown: Grown) -> dict[int, tuple[int, list[int]]]:
    """Points of the body with several tops at the border of the cap: the point before, the tops in order."""
    edges = border_edges(grown.cap)
    stems = grown.stem[edges]
    same = stems[:, 0] == stems[:, 1]
    if not same.any():
        return {}
    follow = dict(edges[same].tolist())
    rows = {}
    for i in np.flatnonzero(~same & np.isin(edges[:, 1], edges[same, 0])).tolist():
        row = [int(edges[i, 1])]
        while row[-1] in follow:
            row.append(follow[row[-1]])
        rows[int(stems[i, 1])] = int(stems[i, 0]), row
    return rows


def _inserted(polygons: Polygons, rows: dict[int, tuple[int, Rows]], place: Rows) -> Polygons:
    """Polygons with other vertices: some in place of one, in order or turned, the others by ``place``."""
    flat = polygons.vertices
    many = np.ones(len(place), dtype=np.int64)
    for v, (_, row) in rows.items():
        many[v] = len(row)
    copies = many[flat]
    starts = np.concatenate([[0], np.cumsum(copies)])
    result = np.repeat(place[flat], copies)
    for i in np.flatnonzero(copies > 1).tolist():
        before, row = rows[int(flat[i])]
        ring = int(np.searchsorted(polygons.ring_start, i, side="right")) - 1
        first, last = polygons.ring_start[ring : ring + 2].tolist()
        previous = int(flat[i - 1 if i > first else last - 1])
        result[starts[i] : starts[i + 1]] = row if previous == before else row[::-1]
    return Polygons(result.astype(np.int32), starts[polygons.ring_start], polygons.first_ring)


def side_pieces(
    domain: Domain, grown: Grown, faces: Rows, walls: NDArray[np.integer], *, exposed: bool = False
) -> Rows:
    """The facets in whose planes faces at the sides of layers lie, by the points of the body below them.

    Parameters
    ----------
    domain : Domain
    grown : Grown
    faces : (f, w) int64
        Rows of vertices of layers, padded by -1.
    walls : (k,) int
        The facets that are walls, with layers or not.
    exposed : bool
        Whether layers may end where there is no other facet: the piece is then -1.

    Raises
    ------
    InputError
        If they do without ``exposed``.
    """
    many = len(domain.points)
    facets = Polygons.of(domain.facets)
    sides, owner = facets.sides
    other = ~flagged(len(facets), walls)[owner]
    sides, owner = np.sort(sides[other].astype(np.int64), axis=1), owner[other]
    key = sides[:, 0] * many + sides[:, 1]
    order = np.argsort(key, kind="stable")
    stems = np.where(faces < 0, grown.stem[faces[:, :1]], grown.stem[faces])
    low, high = stems.min(axis=1), stems.max(axis=1)
    at = np.searchsorted(key[order], low * many + high).clip(max=max(len(key) - 1, 0))
    found = order[at] if len(key) else np.zeros(len(low), dtype=np.int64)
    lost = (key[found] != low * many + high) if len(key) else np.ones(len(low), dtype=bool)
    fan = np.flatnonzero(low == high)  # sides of fans: above one vertex, of one facet that is no wall
    if len(fan) and len(key):
        ends = sides[order].ravel()
        by_end = np.argsort(ends, kind="stable")
        spot = np.searchsorted(ends[by_end], low[fan]).clip(max=len(ends) - 1)
        found[fan] = order[by_end[spot] // 2]
        lost[fan] = ends[by_end[spot]] != low[fan]
    if lost.any() and not exposed:
        row = int(np.argmax(lost))
        edge = f"{number_of(domain, low[row])}-{number_of(domain, high[row])}"
        raise InputError(
            f"layers end at the edge {edge} near {domain.points[low[row]].tolist()}, where there is no facet "
            "beside the wall"
        )
    return np.where(lost, -1, owner[found]) if len(key) else np.full(len(low), -1, dtype=np.int64)
