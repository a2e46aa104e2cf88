"""The feature curves of a surface as chains of edges of a mesh, and what meets at them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.report import Problem, Report, problem
from ..domain.given_surface import GivenSurface
from ..geometry.boxes import BoxTree, bounding_boxes
from ..geometry.support import Support
from ..geometry.support_features import side_groups
from ..mesh.mesh import Mesh
from .chains import keys_of
from .held import same_places

__all__ = ["Curves", "curves_held"]


class Curves(NamedTuple):
    """Edges of a mesh, and where they run along curves of the surface.

    Attributes
    ----------
    sides : (e, 2) int64
        All edges of the mesh, each once, in the direction of one of its triangles.
    cells : (e,) int64
        A triangle at each.
    meeting : tuple of (e,) int64
        How many triangles run along each, and how many against it.
    on : (e,) bool
        Whether it is a part of a curve.
    origin : (n,) int64
        The vertex of the surface in the place of each vertex of the mesh, -1 for none.
    pairs : (p, 2) int64
        Vertices that follow each other along curves, in their direction.
    first, last : (p,) int64
        The features of the surface from ``first`` to ``last`` lie between them.
    """

    sides: NDArray[np.int64]
    cells: NDArray[np.int64]
    meeting: tuple[NDArray[np.int64], NDArray[np.int64]]
    on: NDArray[np.bool_]
    origin: NDArray[np.int64]
    pairs: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


def curves_held(mesh: Mesh, given: GivenSurface, off: float, report: Report) -> Curves:
    """Test that each curve is a chain of edges through all vertices on it, and what meets at them.

    Parameters
    ----------
    off : float
        How far vertices on a curve may be from it, in units of the largest coordinate.
    """
    support, rows, n = given.support, np.asarray(mesh.simplices, dtype=np.int64), len(mesh.points)
    sides, cells, ahead, back = _edges(rows)
    used = np.zeros(n, dtype=bool)
    used[rows.ravel()] = True
    origin = np.where(used, same_places(mesh.points, support.points), -1).astype(np.int64)
    place = np.full(len(support.points), -1, dtype=np.int64)
    place[origin[origin >= 0]] = np.flatnonzero(origin >= 0)
    lost = support.corners[place[support.corners] < 0]
    shown = [f"{v} at ({', '.join(f'{x:.6g}' for x in support.points[v])})" for v in lost[:4].tolist()]
    report.note(
        "corners of the surface are vertices",
        Problem("corner", f"{len(lost)} are no vertices, such as {', '.join(shown)}") if len(lost) else None,
    )
    pairs, first, last = _following(mesh.points, used, support, place, off)
    keys = keys_of(sides, n)
    order = np.argsort(keys)
    at = np.searchsorted(keys[order], keys_of(pairs, n))
    at = order[np.minimum(at, len(order) - 1)]
    there = keys[at] == keys_of(pairs, n)
    _chained(support, pairs, first, there, report)
    pairs, first, last, at = pairs[there], first[there], last[there], at[there]
    on = np.zeros(len(sides), dtype=bool)
    on[at] = True
    _meeting(support, (sides, cells, ahead, back), (pairs, first, at), report)
    return Curves(sides, cells, (ahead, back), on, origin, pairs, first, last)


def _edges(rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], ...]:
    """Each side once with a triangle there, and how many triangles run along it and against it."""
    ends = np.stack([rows, rows[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    place, group, size = side_groups(rows)
    first = place[np.cumsum(size) - size]
    along = ends[place, 0] == ends[first, 0][group]
    ahead = np.bincount(group[along], minlength=len(size))
    return ends[first], first // 3, ahead, size - ahead


def _following(
    points: np.ndarray, used: np.ndarray, support: Support, place: np.ndarray, off: float
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Vertices that follow each other on the curves, and the first and last feature between them."""
    vertex, where, owner = _vertices_on(points, used, support, off)
    features, chain = support.features, support.chain
    many = int(chain.max(initial=-1)) + 1
    start = np.searchsorted(chain, np.arange(many + 1))
    ends = np.column_stack([features[start[:-1], 0], features[start[1:] - 1, 1]]) if many else features[:0]
    corner = np.zeros(len(support.points), dtype=bool)
    corner[support.corners] = True
    open_one = corner[ends[:, 0]]
    heads, tails = place[ends[open_one, 0]], place[ends[open_one, 1]]
    begins, stops = start[:-1][open_one].astype(float), start[1:][open_one].astype(float)
    vertex = np.concatenate([vertex, heads[heads >= 0], tails[tails >= 0]])
    where = np.concatenate([where, begins[heads >= 0], stops[tails >= 0]])
    owner = np.concatenate(
        [owner, np.flatnonzero(open_one)[heads >= 0], np.flatnonzero(open_one)[tails >= 0]]
    )
    order = np.lexsort((where, owner))
    vertex, where, owner = vertex[order], where[order], owner[order]
    ahead = np.arange(1, len(vertex) + 1)
    final = np.append(owner[1:] != owner[:-1], True)[: len(vertex)]
    ahead[final] = np.searchsorted(owner, owner[final])  # closed curves go on with their first vertex
    goes_on = ~final | ~open_one[owner]
    first, last = np.floor(where).astype(np.int64), np.ceil(where[ahead]).astype(np.int64) - 1
    return np.column_stack([vertex, vertex[ahead]])[goes_on], first[goes_on], last[goes_on]


def _vertices_on(
    points: np.ndarray, used: np.ndarray, support: Support, off: float
) -> tuple[NDArray[np.int64], np.ndarray, NDArray[np.int64]]:
    """Vertices on curves that are no corners, where (the feature plus the share of it), and the curve."""
    none = np.empty(0, dtype=np.int64)
    if len(support.features) == 0:
        return none, np.empty(0), none
    x, ends = points * support.factor, support.points[support.features] * support.factor
    low, high = bounding_boxes(ends)
    row, edge = BoxTree(low - off, high + off).pairs(x, x)
    row, edge = row[used[row]], edge[used[row]]
    along, away = ends[edge, 1] - ends[edge, 0], x[row] - ends[edge, 0]
    square = np.maximum((along * along).sum(axis=1), 1e-300)
    share = np.clip((away * along).sum(axis=1) / square, 0.0, 1.0)
    rest = np.sqrt(((away - share[:, None] * along) ** 2).sum(axis=1))
    good = (rest <= off) & ~_at_corners(x, support, off)[row]
    row, edge, share, rest = row[good], edge[good], share[good], rest[good]
    small = off / np.sqrt(square[good])
    chain = support.chain[edge]
    begin = np.searchsorted(support.chain, chain)
    share[share <= small] = 0.0
    over = share >= 1.0 - small  # the end of a feature is the beginning of the next one
    edge = np.where(over, edge + 1, edge)
    share[over] = 0.0
    past = edge >= np.searchsorted(support.chain, chain, side="right")
    edge[past] = begin[past]
    order = np.lexsort((rest, chain, row))
    row, edge, share, chain = row[order], edge[order], share[order], chain[order]
    new = np.ones(len(row), dtype=bool)
    new[1:] = (row[1:] != row[:-1]) | (chain[1:] != chain[:-1])
    return row[new], (edge + share)[new], chain[new]


def _at_corners(x: np.ndarray, support: Support, off: float) -> np.ndarray:
    result = np.zeros(len(x), dtype=bool)
    corners = support.points[support.corners] * support.factor
    if len(corners):
        result[BoxTree(corners - off, corners + off).pairs(x, x)[0]] = True
    return result


def _chained(
    support: Support, pairs: np.ndarray, first: np.ndarray, there: np.ndarray, report: Report
) -> None:
    """Report curves without vertices, and vertices that follow each other but have no edge."""
    many = int(support.chain.max(initial=-1)) + 1
    count = np.bincount(support.chain[first], minlength=many)
    closed = support.features[np.searchsorted(support.chain, np.arange(many)), 0]
    closed = ~np.isin(closed, support.corners)
    bare = np.flatnonzero(count < np.where(closed, 3, 1))
    shown = [
        f"that from ({', '.join(f'{x:.6g}' for x in support.points[support.features[i, 0]])})"
        for i in np.searchsorted(support.chain, bare[:4]).tolist()
    ]
    report.note(
        f"the curves of the surface, {many}, are chains of edges",
        Problem("curve", f"{len(bare)} have too few vertices, such as {', '.join(shown)}")
        if len(bare)
        else None,
        problem("curve", "vertices that follow each other, without an edge", vertices=pairs[~there].ravel()),
    )


def _meeting(
    support: Support,
    edges: tuple[NDArray[np.int64], ...],
    along: tuple[NDArray[np.int64], ...],
    report: Report,
) -> None:
    """Test that as many triangles meet at the edges of curves as on the surface, in the same directions."""
    sides, cells, ahead, back = edges
    pairs, first, at = along
    own, _, own_ahead, own_back = _edges(support.held.rows)
    n = len(support.points)
    order = np.argsort(keys_of(own, n))
    known = keys_of(own, n)[order]
    keys = keys_of(support.features, n)
    row = order[np.minimum(np.searchsorted(known, keys), max(len(order) - 1, 0))]
    turned = own[row, 0] != support.features[:, 0]
    wanted = np.column_stack([np.where(turned, own_back[row], own_ahead[row]),
                              np.where(turned, own_ahead[row], own_back[row])])[first]  # fmt: skip
    turned = sides[at, 0] != pairs[:, 0]
    found = np.column_stack([np.where(turned, back[at], ahead[at]), np.where(turned, ahead[at], back[at])])
    less = found.sum(axis=1) < wanted.sum(axis=1)
    more = found.sum(axis=1) > wanted.sum(axis=1)
    other = ~less & ~more & (found != wanted).any(axis=1)
    report.note(
        "at each edge of a curve as many triangles as on the surface, in the same directions",
        problem(
            "hole", "on a curve, fewer triangles than on the surface", cells[at[less]], pairs[less].ravel()
        ),
        problem(
            "branch", "on a curve, more triangles than on the surface", cells[at[more]], pairs[more].ravel()
        ),
        problem("orientation", "on a curve, other directions", cells[at[other]], pairs[other].ravel()),
    )
