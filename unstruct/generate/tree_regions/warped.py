"""Cut and warp: vertices of leaves near the boundary move onto it, edges that still cross it are cut there.

See the book, chapter 4b.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...domain.domain import Domain
from ...domain.plane.sample import Sampled, assemble
from ...geometry.boxes import BoxTree, bounding_boxes
from ...mesh.domain_mesh import DomainMesh
from ..boundary.constrained import complex_of
from ..boundary.pairs import paired
from ..front.made_mesh import quality_figures
from ..tree.cells import TreeCells
from ..tree.contacts import ALL_OUTSIDE
from ..tree.templates import squares_as_triangles
from .cutting import cut_by_leaves, safe_and_round
from .fitted import Spots, states_for
from .near import nearness
from .thinning import thinned

__all__ = ["warped"]

Array = NDArray[np.float64]
WARPED = 0.45  # of the least leaf around a vertex: nearer to a piece than this it moves
ROOM_ALONG = 0.35  # of that leaf: points along a piece are not nearer to each other
MAY_BE_CUT = 3.0  # leaves with a vertex nearer than this may be cut
CUT_RANK, WARPED_RANK, GIVEN_RANK = 0, 1, 2


class Marks(NamedTuple):
    """Points on pieces, before they are thinned.

    Attributes
    ----------
    piece : (k,) int64
    t : (k,) float64
        The parameters on them.
    size : (k,) float64
        Of the leaf there.
    rank : (k,) int64
        Which goes first where there is room for one.
    start : (k, 2, 2) float64
        Where the vertex was, twice, or both ends of the edge that is cut.
    """

    piece: NDArray[Any]
    t: NDArray[Any]
    size: NDArray[Any]
    rank: NDArray[Any]
    start: NDArray[Any]


def _marks(
    sampled: Sampled,
    row: NDArray[np.int64],
    share: Array,
    size: Array,
    rank: int,
    start: Array,
) -> Marks:
    """Marks at shares of subsegments."""
    first, last = sampled.span[row].T
    t = first + share * (last - first)
    return Marks(sampled.piece[row].astype(np.int64), t, size, np.full(len(row), rank), start)


def _cuts(sampled: Sampled, spots: Spots, edges: NDArray[np.int32]) -> Marks:
    """Where edges between vertices that did not move cross subsegments."""
    ends = sampled.points[sampled.ends]
    x = spots.points[edges]
    row, edge = BoxTree(*bounding_boxes(x)).pairs(*bounding_boxes(ends))
    a, u = ends[row, 0], ends[row, 1] - ends[row, 0]
    c, v = x[edge, 0], x[edge, 1] - x[edge, 0]
    w = c - a
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        share = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / turn
        other = (w[:, 0] * u[:, 1] - w[:, 1] * u[:, 0]) / turn
        cross = (share >= 0) & (share < 1) & (other > 0) & (other < 1)
    row, edge, share = row[cross], edge[cross], share[cross]
    size = spots.sizes[edges[edge]].min(axis=1)
    return _marks(sampled, row, share, size, CUT_RANK, x[edge])


def _thinned(domain: Domain, sampled: Sampled, marks: Marks) -> tuple[Sampled, Marks]:
    """The pieces cut at the marks that stay, and these."""
    held = domain.held()
    given = np.flatnonzero((sampled.span[:, 1] < 1.0) & held[sampled.piece])
    own = _marks(
        sampled, given, np.ones(len(given)), np.zeros(len(given)), GIVEN_RANK, np.zeros((len(given), 2, 2))
    )
    keep = ~held[marks.piece] & (marks.t > 0.0) & (marks.t < 1.0)
    both = Marks(*(np.concatenate([m[keep], o]) for m, o in zip(marks, own, strict=True)))
    order = np.lexsort((both.rank, both.t, both.piece))
    both = Marks(*(column[order] for column in both))
    x = domain.points_at(both.piece, both.t)
    ends = domain.points[domain.pieces].reshape(-1, 4)
    stays = thinned(both.piece, ends, x, ROOM_ALONG * both.size, both.rank)
    stays &= np.append(True, (np.diff(both.piece) != 0) | (np.diff(both.t) > 0))[: len(stays)]
    both = Marks(*(column[stays] for column in both))
    many = np.arange(len(domain.pieces))
    owner, t0 = np.concatenate([many, both.piece]), np.concatenate([np.zeros(len(many)), both.t])
    order = np.lexsort((t0, owner))
    owner, t0 = owner[order], t0[order]
    t1 = np.where(np.append(owner[1:] == owner[:-1], False), np.append(t0[1:], 1.0), 1.0)
    return safe_and_round(domain, assemble(domain, owner, t0, t1)), both


def warped(cells: TreeCells, domain: Domain) -> DomainMesh:
    """The template triangles of a quadtree, warped to the pieces of a domain and cut by them.

    Parameters
    ----------
    cells : TreeCells
        A quadtree over the domain; if it is not balanced across corners, it is balanced first.
    domain : Domain

    Returns
    -------
    DomainMesh
        ``counts``: "warped" vertices, "cuts", "merged" ones, for which there was no room beside another
        point, and "halved" subsegments of curves. ``steps``: "from" (k, 2) and "to" (k, 2) of the vertices
        that were warped; "edge" (c, 2, 2) and "cut" (c, 2) of the edges that were cut. ``figures``:
        "triangles", "minimum angle", "minimum 2r/R", "mean 2r/R".

    Raises
    ------
    InputError
        As `unstruct.constrained_delaunay` does.

    Notes
    -----
    A vertex of a leaf nearer to a piece than 0.45 of the least leaf around it moves to the nearest point
    there. Edges of the templates between the others are cut where they cross pieces. Vertices of the domain
    stay, and points nearer to one another along a piece than .35 of the leaf become one. Of all
    triangulations of these points that contain the pieces, the result is the one with the largest least
    angle: constrained Delaunay. There is no bound on angles: the chapter measures them.
    """
    if cells.balance != "corners":
        cells = cells.balanced("corners")
    spots, sampled = Spots.of(cells), cut_by_leaves(cells, domain)
    outside = states_for(cells, domain, sampled) == ALL_OUTSIDE
    loose = domain.points[domain.loose]

    def away_from(pieces: Sampled) -> Array:
        ends = np.concatenate([pieces.points[pieces.ends].reshape(-1, 4), np.tile(loose, (1, 2))])
        return nearness(cells.grid, ends, MAY_BE_CUT, spots.of_leaf, spots.points, spots.sizes)

    away, which, place = away_from(sampled).T
    near = away < WARPED * WARPED
    moved = np.flatnonzero(near & (which < len(sampled.ends)))
    marks = _marks(
        sampled, which[moved].astype(np.int64), place[moved], spots.sizes[moved], WARPED_RANK,
        spots.points[moved, None].repeat(2, axis=1),
    )  # fmt: skip
    leaves = np.flatnonzero((np.append(away, np.inf)[spots.of_leaf] < MAY_BE_CUT * MAY_BE_CUT).any(axis=1))
    chosen = flagged(len(cells), leaves)
    _, triangles, _ = squares_as_triangles(cells.grid, spots.vertices, chosen)
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    edges = np.unique(edges[~near[edges].any(axis=1)], axis=0)
    cuts = _cuts(sampled, spots, edges)
    marks = Marks(*(np.concatenate(both) for both in zip(marks, cuts, strict=True)))
    final, stay = _thinned(domain, sampled, marks)
    if domain.curves:  # chords have changed
        near |= away_from(final)[:, 0] < 0.25 * WARPED * WARPED
    rows = np.concatenate([final.points, spots.points[spots.kept(outside) & ~near]])
    origin = np.full(len(rows), -1, dtype=np.int32)
    origin[: len(domain.points)] = np.arange(len(domain.points))
    whole = complex_of(domain, Sampled(rows, origin, final.ends, final.piece, final.span, domain))
    x = domain.points_at(stay.piece, stay.t)
    on, cut = stay.rank == WARPED_RANK, stay.rank == CUT_RANK
    mesh = whole.mesh(
        facets=len(domain.facets), markers=domain.markers, origin=origin, points=rows,
        counts={
            "warped": int(on.sum()), "cuts": int(cut.sum()), "merged": len(marks.t) - int((on | cut).sum()),
            "halved": len(final.points) - len(domain.points) - len(stay.t),
        },
        steps={"from": stay.start[on, 0], "to": x[on], "edge": stay.start[cut], "cut": x[cut]},
    )  # fmt: skip
    mesh.figures = quality_figures(mesh.points, mesh.simplices)
    return paired(domain, mesh)
