"""What layers leave of a body, as a body of its own: its walls are replaced by the cap of the layers.

Facets that are no walls stay. Polygons in whose planes layers slide are cut anew: where a side of the polygon
is a side of a wall, the side of the cap above it takes its place. See the book, chapter 5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import InputError
from ...domain.domain import Domain
from ...geometry.polygons import Polygons

__all__ = ["Grown", "Remainder", "border_edges", "remainder", "side_pieces"]

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
        For each cell, through all kinds, the triangle of the whole cap that it is below.
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
    cap : (t, 3) int64
        The triangles above them: the same vertices where there are no layers.
    fans : (f, 3) int64
        Further triangles of the cap, over edges and vertices with several rays.
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
    fans: Rows

    @property
    def whole_cap(self) -> Rows:
        """All triangles of the cap."""
        return np.concatenate([self.cap, self.fans])


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
        If inner pieces end at walls.
    DomainError
        If what is left is no body, because the layers cross facets that are no walls.
    """
    many = len(domain.points)
    facets, inner = Polygons.of(domain.facets), Polygons.of(domain.inner)
    wall = _is_wall(domain, grown)
    on_wall = flagged(many, grown.stem)
    meets = np.flatnonzero(on_wall[inner.vertices]) if len(inner) else np.empty(0, dtype=np.int64)
    if len(meets):
        vertex = int(inner.vertices[meets[0]])
        raise InputError(
            f"an inner piece ends at vertex {vertex} of a wall, at {domain.points[vertex].tolist()}: layers "
            "would cut it; leave the facets there out of walls"
        )
    number = np.where(grown.level == 0, grown.stem, many + np.arange(len(grown.points)))
    kept = np.flatnonzero(~wall)
    outer = _lifted(facets.select(kept), grown, number, on_wall)
    cap = number[grown.whole_cap]
    used = flagged(many + len(grown.points), outer.vertices, cap, inner.vertices, np.asarray(domain.loose))
    vertex = np.flatnonzero(used)
    place = np.zeros(len(used), dtype=np.int32)
    place[vertex] = np.arange(len(vertex))
    every = Polygons.joined(outer, Polygons.of_rows(cap)).renumbered(place)
    points = np.concatenate([domain.points, grown.points])[vertex]
    rest = Domain(points, every, inner=inner.renumbered(place) if len(inner) else None)
    piece = np.concatenate([kept, np.full(len(cap), -1), len(facets) + np.arange(len(inner))])
    return Remainder(rest, vertex, piece, slice(len(kept), len(kept) + len(cap)))


def _lifted(polygons: Polygons, grown: Grown, number: Rows, on_wall: NDArray[np.bool_]) -> Polygons:
    """Polygons whose sides at walls are replaced by those of the cap; vertices as in `Remainder`."""
    cap = grown.whole_cap
    tops: dict[int, list[int]] = {}
    rim = np.unique(grown.stem[border_edges(cap)])
    for row in np.unique(cap[np.isin(grown.stem[cap], rim)]).tolist():
        tops.setdefault(int(grown.stem[row]), []).append(row)
    touched = np.zeros(len(on_wall), dtype=bool)
    touched[rim] = True
    if not touched[polygons.vertices].any():
        return polygons
    edges = _edges_by_stem(border_edges(cap), grown.stem)
    rings = []
    for i in range(len(polygons)):
        if touched[polygons.vertices_of(i)].any():
            rings.append([_lifted_ring(ring.tolist(), tops, edges, number) for ring in polygons.rings(i)])
        else:
            rings.append([ring.tolist() for ring in polygons.rings(i)])
    return Polygons.of_rings(rings)


def _edges_by_stem(edges: Rows, stem: Rows) -> dict[tuple[int, int], list[tuple[int, int]]]:
    """The border of the cap, both ways, by the points of the body below."""
    found: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for u, v in edges.tolist():
        a, b = int(stem[u]), int(stem[v])
        found.setdefault((a, b), []).append((u, v))
        found.setdefault((b, a), []).append((v, u))
    return found


def _lifted_ring(
    ring: list[int],
    tops: dict[int, list[int]],
    edges: dict[tuple[int, int], list[tuple[int, int]]],
    number: Rows,
) -> list[int]:
    """One ring, each vertex at a wall replaced by that above it, or by the chain of those above it."""
    result: list[int] = []
    for k, v in enumerate(ring):
        rows = tops.get(v)
        if rows is None:
            result.append(v)
        elif len(rows) == 1:
            result.append(int(number[rows[0]]))
        else:
            before, after = ring[k - 1], ring[(k + 1) % len(ring)]
            result += [int(number[row]) for row in _chain(v, before, after, edges)]
    return result


def _chain(v: int, before: int, after: int, edges: dict[tuple[int, int], list[tuple[int, int]]]) -> list[int]:
    """The vertices above one point of the body, from the side above one neighbor to that of the other."""
    first, last = edges.get((before, v), []), edges.get((v, after), [])
    both = edges.get((v, v), [])
    if not first or not last:
        return [(first or last)[0][1 if first else 0]]
    row, end = first[0][1], last[0][0]
    chain = [row]
    while row != end and len(chain) <= len(both) + 1:
        following = [b for a, b in both if a == row and b not in chain]
        if not following:
            break
        row = following[0]
        chain.append(row)
    return chain


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
    single = low == high
    if single.any():  # the side of a fan over a vertex: the facet that has an edge of the wall there
        rim = np.sort(grown.stem[border_edges(grown.base)], axis=1)
        for row in np.flatnonzero(single).tolist():
            at = np.flatnonzero((rim == low[row]).any(axis=1))[0]
            low[row], high[row] = rim[at]
    at = np.searchsorted(key[order], low * many + high).clip(max=max(len(key) - 1, 0))
    found = order[at] if len(key) else np.zeros(len(low), dtype=np.int64)
    lost = (key[found] != low * many + high) if len(key) else np.ones(len(low), dtype=bool)
    if lost.any() and not exposed:
        row = int(np.argmax(lost))
        raise InputError(
            f"layers end at the edge {low[row]}-{high[row]} near {domain.points[low[row]].tolist()}, where "
            "there is no facet beside the wall"
        )
    return np.where(lost, -1, owner[found]) if len(key) else np.full(len(low), -1, dtype=np.int64)
