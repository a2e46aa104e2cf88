"""Fitted meshes: vertices of a quadtree inside, the domain's own boundary, and the triangles of Delaunay.

See the book, chapter 4b.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET
from ...domain.domain import Domain
from ...domain.plane.sample import Sampled
from ...geometry.parity import even_odd
from ...mesh.domain_mesh import DomainMesh
from ..boundary.constrained import complex_of
from ..boundary.kept import kept_pieces
from ..boundary.pairs import paired
from ..rebay.finishing import Effort
from ..rebay.run import VoronoiSegmentRun, rule_of
from ..tree.cells import TreeCells
from ..tree.contacts import ALL_OUTSIDE, boundary_of
from ..tree.templates import middles_of
from ..tree.vertices import Vertices, numbered
from .cutting import cut_by_leaves
from .near import nearness

__all__ = ["Spots", "fitted", "states_for"]

NEAREST_SPOT = 0.6  # of the least leaf around: nearer to a piece than this no vertex of the tree is taken
STILL_FROM = 2.0  # vertices farther from all pieces than so many of these stay where they are
# Right isosceles triangles have 2 r / R = .828: smoothing leaves them alone.
ALONG_PIECES = Effort(poor=0.8, search_rounds=2, improved_below=0.8, sharp_rounds=4, patched=30.0)
ANY_SIZE = 2.0**100  # times the domain: a size for which no triangle is too large


class Spots(NamedTuple):
    """Where vertices of a mesh may be: the corners of leaves, and centers of those with hanging vertices.

    Attributes
    ----------
    vertices : Vertices
        The corners.
    points : (v, 2) float64
        The corners, then the centers.
    sizes : (v,) float64
        The longest edge of the smallest leaf at each corner, and half of it at centers.
    of_leaf : (n, 5) int32
        Those of each leaf; the last one is the center, or -1.
    """

    vertices: Vertices
    points: NDArray[np.float64]
    sizes: NDArray[np.float64]
    of_leaf: NDArray[np.int32]

    @classmethod
    def of(cls, cells: TreeCells) -> Spots:
        """Those of a tree that is balanced across faces."""
        vertices = numbered(cells.grid)
        many = len(vertices.points)
        fan = np.flatnonzero((middles_of(cells.grid, vertices) >= 0).any(axis=1))
        center = np.full(len(cells), -1, dtype=np.int32)
        center[fan] = many + np.arange(len(fan))
        levels = np.zeros(many, dtype=np.int8)
        for c in range(4):
            np.maximum.at(levels, vertices.corners[:, c], cells.levels)
        sizes = float((cells.box[1] - cells.box[0]).max()) * 0.5 ** levels.astype(np.float64)
        return cls(
            vertices,
            np.concatenate([vertices.points, cells.centers[fan]]),
            np.concatenate([sizes, 0.5 * cells.sides[fan]]),
            np.column_stack([vertices.corners, center]),
        )

    def kept(self, outside: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Those of leaves of which none is outside: (v,)."""
        chosen = np.zeros(len(self.points) + 1, dtype=bool)  # one more for the number -1
        chosen[self.of_leaf[~outside]] = True
        chosen[self.of_leaf[outside]] = False
        return chosen[:-1]


def states_for(cells: TreeCells, domain: Domain, sampled: Sampled) -> NDArray[np.int8]:
    """Where leaves lie; if the domain has curves, by these chords of them, which bound the mesh."""
    if not domain.curves:
        return cells.states
    facets = sampled.ends[sampled.piece < len(domain.facets)]

    def contains(x: NDArray[np.float64]) -> NDArray[np.bool_]:
        return even_odd(sampled.points, facets, x)[0]

    finer = TreeCells(cells.linear, cells.box, cells.balance)
    finer.boundary = boundary_of(sampled.points, facets, cells.box, contains)
    return finer.states


def fitted(cells: TreeCells, domain: Domain) -> DomainMesh:
    """Triangles of a domain whose size is that of the leaves of a quadtree.

    Parameters
    ----------
    cells : TreeCells
        A quadtree over the domain; if it is not balanced across corners, it is balanced first.
    domain : Domain

    Returns
    -------
    DomainMesh
        Constrained Delaunay. ``counts`` has "tree points", "boundary points", and those of finishing;
        ``unrefined`` are the triangles with an angle below 26 degrees after it, ``reasons`` says why.

    Raises
    ------
    InputError
        As `unstruct.constrained_delaunay` does.

    Notes
    -----
    The pieces are cut by the leaves. Corners of leaves become vertices, except near pieces, and so do centers
    of leaves with hanging vertices. So the triangles inside are those of the templates, with angles of 45 and
    90 degrees if the box is a square. Triangles along the pieces are improved as by
    `unstruct.voronoi_segment`, which may add vertices for the sake of angles; no other vertex of the tree
    moves. O(n log n).
    """
    if cells.balance != "corners":
        cells = cells.balanced("corners")
    spots, sampled = Spots.of(cells), cut_by_leaves(cells, domain)
    loose = domain.points[domain.loose]
    ends = np.concatenate([sampled.points[sampled.ends].reshape(-1, 4), np.tile(loose, (1, 2))])
    away = nearness(cells.grid, ends, STILL_FROM, spots.of_leaf, spots.points, spots.sizes)[:, 0]
    outside = states_for(cells, domain, sampled) == ALL_OUTSIDE
    wanted = spots.kept(outside) & (away >= NEAREST_SPOT * NEAREST_SPOT)
    still = away >= STILL_FROM * STILL_FROM
    rows = np.concatenate([sampled.points, spots.points[wanted & still], spots.points[wanted & ~still]])
    origin = np.full(len(rows), -1, dtype=np.int32)
    origin[: len(domain.points)] = np.arange(len(domain.points))
    whole = complex_of(domain, Sampled(rows, origin, sampled.ends, sampled.piece, sampled.span, domain))
    kept = kept_pieces(True, len(domain.facets), len(domain.pieces), domain.held())
    size = ANY_SIZE * float((domain.bounds[1] - domain.bounds[0]).max())
    rule = rule_of(1.35, "center", "first", None, True)
    run = VoronoiSegmentRun(domain, whole, size, None, rule, kept, False)
    run.first = len(rows) - int((wanted & ~still).sum())
    run.effort = ALONG_PIECES
    result = run.finish(DEFAULT_BUDGET)
    result["counts"]["boundary points"] = len(sampled.points) - len(domain.points)
    result["counts"]["tree points"] = int(wanted.sum())
    return paired(domain, run.result(result))
