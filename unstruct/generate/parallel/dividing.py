"""Coarse triangles of a part as a domain: its boundary, of which the interfaces are held as they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...domain.domain import Domain
from ...domain.plane.sample import Sampled, fine_chains
from ...geometry.curves import Curve
from ...geometry.outline import Outline
from ...mesh.domain_mesh import DomainMesh
from .bisecting import divided
from .coarse import Coarse, by_part
from .records import Part
from .straightening import least_of_all, straightened

__all__ = ["Division", "divide"]

IN_TRIANGLE = 0.25  # of its height: a curve that goes farther into the coarse triangle becomes its chord


class Division(NamedTuple):
    """A region in parts."""

    parts: list[Part]
    sampled: Sampled
    points: NDArray[np.float64]  # those that parts share: of the sampled pieces, then of interfaces
    regions: dict[str, int]
    numbered: bool  # whether the cells of the whole have a marker "region"
    sine: float  # the square of the sine of the least angle of the coarse triangles
    triangles: int
    interface: int  # how many edges the interfaces have


class _Edges(NamedTuple):
    """The edges of coarse triangles that bound parts or are pieces, each once."""

    ends: NDArray[np.int64]  # (e, 2) coarse vertices, in the direction of the piece if there is one
    beside: NDArray[np.int64]  # (e, 2) the triangles, -1 for none
    row: NDArray[np.int64]  # (e,) the sampled subsegment, or -1


def divide(domain: Domain, size: Any, coarse: Coarse, parts: int, method: Any) -> Division:
    """Divide a region into parts, each of them a domain whose interfaces are cut by the size."""
    mesh = coarse.mesh
    simplices, neighbors = np.asarray(mesh.simplices), np.asarray(mesh.neighbors)
    corners = mesh.points[simplices]
    sides = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]  # opposite to the vertices, as the neighbors
    graph = simplices, neighbors, np.sqrt((sides * sides).sum(axis=2))
    centers = (corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0
    part = divided(centers, graph, coarse.cells, parts)
    edges = _edges(mesh, part)
    points = _straight(mesh, part, edges)
    sine = float(least_of_all(points, simplices))
    shared, chains = _shared(coarse, points, edges, part, size)
    names = {v: k for k, v in mesh.regions.items()}
    region = np.asarray(mesh.markers.get("region", np.zeros(mesh.size, dtype=np.int64)))
    sizes = by_part(mesh, size)
    curved = _curved(coarse.sampled, edges, points, simplices)
    found = []
    for k in range(parts):
        regions = _seeds(points, mesh, edges, part == k, region) if "region" in mesh.markers else {}
        rows = _pieces_of(edges, chains, part, k, len(domain.facets), coarse.sampled)
        loose = _loose(mesh, edges, part == k)
        used, number = np.unique(np.concatenate([rows.ends.ravel(), loose]), return_inverse=True)
        ends = number[: 2 * len(rows.ends)].reshape(-1, 2).astype(np.int32)
        own: Any = size
        if isinstance(size, Mapping):
            own = {str(r): sizes[r] for r in map(int, regions)}
        fixed = rows.met | ~np.isin(rows.row, curved.free)
        found.append(
            Part(
                k, parts, shared[used], used, ends[: rows.facets], ends[rows.facets :], rows.row,
                np.flatnonzero(fixed), _stretches(coarse.sampled, rows.row, fixed, curved.bent), regions,
                own, method, float(coarse.cells[part == k].sum()),
            )
        )  # fmt: skip
    edges_on = sum(len(chain) - 1 for chain in chains.values())
    regions_of = {name: int(number) for number, name in names.items()}
    return Division(
        found, coarse.sampled, shared, regions_of, "region" in mesh.markers, sine, mesh.size, edges_on
    )


# ---------------------------------------------------------------------- edges between parts


def _edges(mesh: DomainMesh, part: NDArray[np.int32]) -> _Edges:
    """The edges between parts and those on pieces, in the order of their triangles."""
    simplices, neighbors = np.asarray(mesh.simplices, dtype=np.int64), np.asarray(mesh.neighbors)
    n = len(mesh.points)
    a, b = simplices[:, [1, 2, 0]].ravel(), simplices[:, [2, 0, 1]].ravel()
    own, other = np.repeat(np.arange(len(simplices)), 3), neighbors.ravel().astype(np.int64)
    key = np.minimum(a, b) * n + np.maximum(a, b)
    low, high = np.sort(np.asarray(mesh.segments, dtype=np.int64), axis=1).T
    known = low * n + high
    order = np.argsort(known, kind="stable")
    at = np.minimum(np.searchsorted(known[order], key), max(len(known) - 1, 0))
    there = known[order][at] == key
    row = np.where(there, np.asarray(mesh.piece, dtype=np.int64)[order][at], -1)
    chosen = (other < own) & (there | ((other >= 0) & (part[other] != part[own])))
    turned = there & (np.asarray(mesh.segments)[order][at, 0] != a)
    ends = np.column_stack([np.where(turned, b, a), np.where(turned, a, b)])
    return _Edges(ends[chosen], np.column_stack([own, other])[chosen], row[chosen])


def _between(edges: _Edges, part: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which of the edges have different parts on their sides."""
    one, two = edges.beside.T
    return (two >= 0) & (part[one] != part[two])


def _straight(mesh: DomainMesh, part: NDArray[np.int32], edges: _Edges) -> NDArray[np.float64]:
    free = np.asarray(mesh.origin) < 0
    free[edges.ends[edges.row >= 0].ravel()] = False
    return straightened(mesh.points, mesh.simplices, edges.ends[_between(edges, part)], free)


def _shared(
    coarse: Coarse, points: NDArray[np.float64], edges: _Edges, part: NDArray[np.int32], size: Any
) -> tuple[NDArray[np.float64], dict[int, NDArray[np.int64]]]:
    """The points that parts share, and for each interface edge that is no piece the chain of its points."""
    mesh = coarse.mesh
    number = np.asarray(mesh.origin, dtype=np.int64).copy()
    rows = np.flatnonzero(_between(edges, part) & (edges.row < 0))
    new = np.unique(edges.ends[rows])
    new = new[number[new] < 0]
    first = len(coarse.sampled.points)
    number[new] = first + np.arange(len(new))
    shared = [coarse.sampled.points, points[new]]
    first += len(new)
    region = np.asarray(mesh.markers.get("region", np.zeros(mesh.size, dtype=np.int64)))
    chains: dict[int, NDArray[np.int64]] = {}
    for r, field in by_part(mesh, size).items():
        own = rows[region[edges.beside[rows, 0]] == r]
        if len(own) == 0:
            continue
        used, ends = np.unique(edges.ends[own], return_inverse=True)
        cut = Domain(points[used], np.empty((0, 2), int), inner=ends.reshape(-1, 2)).sampled(field)
        shared.append(cut.points[len(used) :])
        numbers = np.append(number[used], first + np.arange(len(cut.points) - len(used)))
        first += len(cut.points) - len(used)
        start = np.searchsorted(cut.piece, np.arange(len(own) + 1))
        for i, e in enumerate(own.tolist()):
            chain = cut.ends[start[i] : start[i + 1]]
            chains[e] = numbers[np.append(chain[:, 0], chain[-1:, 1])]
    return np.concatenate(shared), chains


# ---------------------------------------------------------------------- pieces of one part


class _Rows(NamedTuple):
    ends: NDArray[np.int64]  # (p, 2) shared points: facets, then inner pieces
    facets: int
    row: NDArray[np.int64]  # (p,) the sampled subsegment, -1 on interfaces
    met: NDArray[np.bool_]  # (p,) another part has it, too


def _pieces_of(
    edges: _Edges, chains: dict[int, NDArray[np.int64]], part: NDArray[np.int32], k: int, facets: int,
    sampled: Sampled,
) -> _Rows:  # fmt: skip
    """The pieces of one part in the order of the edges: facets, then those with it on both sides."""
    one, two = part[edges.beside[:, 0]] == k, (edges.beside[:, 1] >= 0) & (part[edges.beside[:, 1]] == k)
    between = _between(edges, part)
    outer, inner = np.flatnonzero(one ^ two), np.flatnonzero(one & two)
    ends: list[NDArray[np.int64]] = []
    row: list[NDArray[np.int64]] = []
    met: list[NDArray[np.bool_]] = []
    for e in outer.tolist():
        if edges.row[e] >= 0:
            chain = sampled.ends[edges.row[e]].astype(np.int64)
        else:
            chain = chains[e]
        ends.append(np.column_stack([chain[:-1], chain[1:]]))
        row.append(np.full(len(chain) - 1, edges.row[e]))
        met.append(np.full(len(chain) - 1, between[e]))
    count = sum(map(len, row))
    ends.append(sampled.ends[edges.row[inner]].astype(np.int64).reshape(-1, 2))
    row.append(edges.row[inner])
    met.append(np.zeros(len(inner), dtype=bool))
    return _Rows(np.concatenate(ends), count, np.concatenate(row), np.concatenate(met))


def _loose(mesh: DomainMesh, edges: _Edges, own: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The given vertices of a part that are on none of its pieces, by their shared numbers."""
    inside = np.zeros(len(mesh.points), dtype=bool)
    inside[np.asarray(mesh.simplices)[own].ravel()] = True
    inside[edges.ends.ravel()] = False
    origin = np.asarray(mesh.origin, dtype=np.int64)
    return origin[inside & (origin >= 0)]


def _seeds(
    points: NDArray[np.float64], mesh: DomainMesh, edges: _Edges, own: NDArray[np.bool_],
    region: NDArray[np.int64],
) -> dict[str, NDArray[np.float64]]:  # fmt: skip
    """For each region of the whole points in all that a part has of it: centers of its largest triangles."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    simplices = np.asarray(mesh.simplices)
    one, two = edges.beside.T
    n = len(simplices)
    walls = np.maximum(one, two) * n + np.minimum(one, two)
    t, u = np.repeat(np.arange(n), 3), np.asarray(mesh.neighbors).ravel().astype(np.int64)
    open_ = (u >= 0) & (u < t) & own[t] & own[np.maximum(u, 0)]
    open_ &= ~np.isin(t * n + u, walls)
    graph = coo_array((np.ones(open_.sum(), dtype=np.int8), (t[open_], u[open_])), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    corners = points[simplices]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    rows = np.flatnonzero(own)
    rows = rows[np.lexsort((rows, -area[rows], label[rows]))]
    rows = rows[np.append(True, np.diff(label[rows]) != 0)]
    rows = rows[np.argsort(region[rows], kind="stable")]
    center = (corners[rows, 0] + corners[rows, 1] + corners[rows, 2]) / 3.0
    return {str(r): center[region[rows] == r] for r in np.unique(region[rows]).tolist()}


# ---------------------------------------------------------------------- curves


class _Curved(NamedTuple):
    free: NDArray[np.int64]  # subsegments that may be cut further
    bent: NDArray[np.int64]  # those of them that follow a curve


def _curved(
    sampled: Sampled, edges: _Edges, points: NDArray[np.float64], simplices: NDArray[np.int32]
) -> _Curved:
    """Which subsegments may be cut further: none that matches or is spaced, none far from its chord."""
    outline: Outline = sampled.outline
    held = outline.held()[sampled.piece]
    bent = np.zeros(len(outline.pieces), dtype=bool)
    bent[list(outline.curves)] = True
    rows = np.flatnonzero((edges.row >= 0) & bent[sampled.piece[edges.row]])
    chain = fine_chains(outline, sampled, edges.row[rows])[:, 1:-1] if len(rows) else np.empty((0, 1, 2))
    far = np.zeros(len(sampled.piece), dtype=bool)
    for j in range(2):
        t = edges.beside[rows, j]
        there = np.flatnonzero(t >= 0)
        tri = simplices[t[there]]
        ends = edges.ends[rows[there]]
        apex = tri.sum(axis=1) - ends.sum(axis=1)
        a, b, c = points[ends[:, 0]][:, None], points[ends[:, 1]][:, None], points[apex][:, None]
        x = chain[there]
        whole = _twice(a, b, c)
        high, left, right = _twice(a, b, x) / whole, _twice(b, c, x) / whole, _twice(c, a, x) / whole
        out = (high > IN_TRIANGLE) | ((high > 0.0) & ((left <= 0.0) | (right <= 0.0)))
        far[edges.row[rows[there[out.any(axis=1)]]]] = True
    every = np.arange(len(sampled.piece))
    free = every[~held & ~far]
    return _Curved(free, free[bent[sampled.piece[free]]])


def _twice(a: NDArray, b: NDArray, c: NDArray) -> NDArray:
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (
        c[..., 0] - a[..., 0]
    )


def _stretches(
    sampled: Sampled, row: NDArray[np.int64], fixed: NDArray[np.bool_], bent: NDArray[np.int64]
) -> dict[int, Any]:
    """The curves of a part's pieces; parts of one curve share its function."""
    found: dict[int, Any] = {}
    functions: dict[int, Any] = {}
    for k in np.flatnonzero(~fixed & np.isin(row, bent)).tolist():
        piece, (t0, t1) = int(sampled.piece[row[k]]), sampled.span[row[k]].tolist()
        curve: Any = sampled.outline.curves[piece]
        function = functions.setdefault(piece, curve.point)
        found[k] = Curve(function, t0, t1)
    return found
