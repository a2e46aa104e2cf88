"""The facets of a body cut into triangles of a wanted size, before the inside is filled.

A polygon with more than three corners is a shape, and so is a triangle joined to no other one; other
triangles are parts of a surface that somebody has meshed. So shapes are divided, and these triangles kept,
unless all are asked to be divided. Each edge is cut
once, for all pieces that end at it; each polygon is then meshed in its plane with exactly these edges. The
corners are those of the body, so that facets still meet edge on edge, bit for bit. New points are rounded;
that what results is a body is proved by the checks of `Domain`. See the book, 2.8c.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...domain.domain import Domain
from ...domain.plane.by_size import evenly
from ...geometry.edge_vectors import lengths
from ...mesh.grouping import group_rows
from ...predicates.batch import power_of_two
from ...sizing.field import SizeField
from ...sizing.on_faces import wanted_along, wanted_triangles
from ...sizing.space_metric import SpaceMetric
from ..volume.lattice import MOST_INNER
from .covering import Cover, covered
from .laying import Filler, filled_by_size, lay, meshed, too_many
from .patches import Patches, patches_of, shapes_of

__all__ = ["Divided", "Pieces", "divided", "divided_around"]

Numbers = NDArray[np.int64]
Array = NDArray[np.float64]
Wish = SizeField | SpaceMetric
Limits = tuple[int, Cover | None, Filler]  # points, what something else covers, and how polygons are meshed
COARSE_PATCH = (
    1.5  # edges of the triangles of a polygon whose sides stay, over the size, from which it is meshed
)
PLACES_OF_EDGE = 8  # where the size is looked at before edges are cut
ROUGHLY = 4  # how many times too many points an estimate by few places must tell, before it is believed
BOTH_ENDS = np.array([0.0, 1.0])
NO_CURVES: Mapping[int, Any] = {}


class Divided(NamedTuple):
    """A body with smaller facets, and what they are parts of.

    Attributes
    ----------
    domain : Domain
        Its first points are those of the body.
    parent : (p,) int32
        For each of its pieces the piece of the body that it is a part of.
    span : (p, 2) float64
        For parts of inner segments the parameters of their ends; else 0 and 1.
    names : callable
        The name of a piece of the body, for messages.
    """

    domain: Domain
    parent: NDArray[np.int32]
    span: Array
    names: Callable[[int], str]

    def name(self, piece: int) -> str:
        """What messages call the piece of the body that a piece is a part of."""
        return self.names(int(self.parent[piece]))


class Pieces(NamedTuple):
    """The arrays of a body with smaller facets, which need not be closed.

    Attributes
    ----------
    points : (n, 3) float64
    facets : (f, 3)
    inner : list
        Rows of vertices.
    parent : (p,) int32
    span : (p, 2) float64
        As of `Divided`.
    """

    points: Array
    facets: Numbers
    inner: list[Any]
    parent: NDArray[np.int32]
    span: Array


class _Edges:
    """Straight edges in space, as `evenly` wants pieces and their sizes: each lies along the first axis."""

    curves: Mapping[int, Any] = NO_CURVES
    spacings: Mapping[int, Any] = NO_CURVES

    def __init__(self, points: Array, ends: Numbers):
        self.points, self.pieces = points, ends
        self._start, end = points[ends].transpose(1, 0, 2)
        self.along = end - self._start
        self.length = lengths(self.along)

    def in_space(self, piece: Numbers, t: Array) -> Array:
        """Points of many edges by parameters, (k, 3)."""
        return self._start[piece] + t[:, None] * self.along[piece]

    def points_at(self, piece: Numbers, t: Array) -> Array:
        """The same, each edge along the first axis, (k, 2)."""
        return np.stack([t * self.length[piece], np.zeros(len(t))], axis=1)

    def at(self, piece: int, t: Any) -> Array:
        """Points of one edge, for messages."""
        share = np.atleast_1d(np.asarray(t, dtype=np.float64))
        return self.in_space(np.full(len(share), piece), share)

    def name(self, piece: int) -> str:
        """What messages call an edge."""
        return f"edge {self.pieces[piece, 0]}-{self.pieces[piece, 1]}"


class _Sizes:
    """The wanted lengths along edges in space, as `evenly` asks for them."""

    def __init__(self, edges: _Edges, field: Wish):
        self.fields: list[Any] = [field]
        self._edges = edges

    def at(self, piece: Numbers, x: Array, direction: Array) -> Array:
        """The lengths at points of `_Edges.points_at`."""
        x = self._edges.in_space(piece, x[:, 0] / self._edges.length[piece])
        return wanted_along(self.fields[0], x, self._edges.along[piece])

    def even(self) -> NDArray[np.bool_]:
        """For which edges the length is constant."""
        return np.full(len(self._edges.pieces), self.fields[0].constant is not None)


def divided(
    domain: Domain,
    field: Wish,
    everything: bool = False,
    most: int = MOST_INNER,
    fill: Filler = filled_by_size,
) -> Divided | None:
    """Cut the facets, inner facets and inner segments of a body by a size.

    Parameters
    ----------
    domain : Domain
        In space.
    field : SizeField or SpaceMetric
        The wanted length of edges.
    everything : bool
        Whether triangles are divided, too.
    most : int
        The largest number of new points.
    fill : callable
        How polygons are meshed in their planes: see `laying.Filler`. With a metric it takes metrics.

    Returns
    -------
    Divided or None
        None where nothing is to be divided: edges of kept triangles stay.

    Raises
    ------
    InputError
        If there would be more new points.
    DomainError
        If by rounding the parts of the facets touch or cross.

    Notes
    -----
    O(n log n) for n vertices.
    """
    made = _divided(domain, field, everything, (most, None, fill))
    if made is None:
        return None
    body = Domain(
        made.points,
        made.facets,
        inner=made.inner or None,
        markers={k: np.flatnonzero(np.isin(made.parent, v)) for k, v in domain.markers.items()},
        regions=domain.regions,
    )
    return Divided(body, made.parent, made.span, domain.name)


def divided_around(domain: Domain, field: Wish, everything: bool, cover: Cover) -> Pieces:
    """The same without what something else covers of facets: see `divided` and `Cover`."""
    made = _divided(domain, field, everything, (MOST_INNER, cover, filled_by_size))
    assert made is not None
    return made


def _divided(domain: Domain, field: Wish, everything: bool, limits: Limits) -> Pieces | None:
    most, cover, _ = limits
    patches, points = patches_of(domain), domain.points
    shape = shapes_of(domain)[patches.piece]
    coarse = _too_coarse(domain, field, patches, everything)
    if cover is not None:
        points = np.concatenate([points, cover.points])
        patches, changed = covered(patches, cover)
        coarse |= changed
    segments = domain.triangulated.segments.astype(np.int64)
    every = np.sort(np.concatenate([patches.sides, segments]), axis=1)
    number, first = group_rows(every)
    edges = every[first]
    kept = np.zeros(len(edges), dtype=bool)
    if not everything:
        kept[number[: len(patches.sides)][~shape[patches.patch]]] = True
    if cover is not None:
        group, _ = group_rows(np.concatenate([edges, cover.kept]))
        kept |= np.isin(group[: len(edges)], group[len(edges) :])
    _refuse_too_many(points, field, edges[~kept], most)
    chain = _Chains.of(points, edges, kept, field)
    if chain is None and not coarse.any():
        return None
    chain = chain or _Chains.whole(points, edges)
    return _put_together(domain, field, patches, number, chain, coarse, limits)


class _Chains(NamedTuple):
    """The points along each edge: those of edge e are vertices[start[e] : start[e + 1]], ends included."""

    points: Array
    vertices: Numbers
    start: Numbers
    t: Array

    @classmethod
    def whole(cls, points: Array, edges: Numbers) -> _Chains:
        """No edge is cut."""
        return cls(points, edges.ravel(), 2 * np.arange(len(edges) + 1), np.tile(BOTH_ENDS, len(edges)))

    @classmethod
    def of(cls, points: Array, edges: Numbers, kept: NDArray[np.bool_], field: Wish) -> _Chains | None:
        """Edges cut by a size, but for those that are kept; None if none is cut."""
        free = np.flatnonzero(~kept)
        if len(free) == 0:
            return None
        along = _Edges(points, edges[free])
        owner, _, t1 = evenly(along, _Sizes(along, field), 1.0)
        inner = t1 < 1.0
        if not inner.any():
            return None
        owner, t = owner[inner], t1[inner]
        new = along.in_space(owner, t)
        owner = free[owner]
        count = 2 + np.bincount(owner, minlength=len(edges))
        start = np.concatenate([[0], np.cumsum(count)])
        vertices, place = np.empty(start[-1], dtype=np.int64), np.zeros(start[-1])
        vertices[start[:-1]], vertices[start[1:] - 1] = edges.T
        place[start[1:] - 1] = 1.0
        head = np.searchsorted(owner, np.arange(len(edges)))
        at = start[owner] + 1 + np.arange(len(owner)) - head[owner]
        vertices[at], place[at] = len(points) + np.arange(len(new)), t
        return cls(np.concatenate([points, new]), vertices, start, place)

    def steps(self, edge: Numbers) -> tuple[Numbers, Numbers, Array]:
        """The parts of some edges as pairs of vertices, the place in ``edge`` of each, and their spans."""
        count = self.start[edge + 1] - self.start[edge] - 1
        owner = np.repeat(np.arange(len(edge)), count)
        at = self.start[edge][owner] + np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
        pairs, spans = (np.column_stack([row[at], row[at + 1]]) for row in (self.vertices, self.t))
        return pairs, owner, spans


def _too_coarse(domain: Domain, field: Wish, patches: Patches, everything: bool) -> NDArray[np.bool_]:
    """Which patches have triangles that are much larger than wanted, by their edges."""
    shell = domain.triangulated
    x = domain.points[shell.triangles]
    large = np.zeros(len(domain.pieces), dtype=bool)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        side = x[:, i] - x[:, j]
        wanted = wanted_along(field, (x[:, i] + x[:, j]) / 2, side)
        large[shell.piece[lengths(side) > COARSE_PATCH * wanted]] = True
    may = large[patches.piece]
    return may if everything else may & shapes_of(domain)[patches.piece]


def _put_together(
    domain: Domain,
    field: Wish,
    patches: Patches,
    number: Numbers,
    chain: _Chains,
    coarse: NDArray[np.bool_],
    limits: Limits,
) -> Pieces:
    """Mesh the patches that are coarse or have a cut side, and collect all their triangles."""
    shell = domain.triangulated
    most, cover, fill = limits
    cut = np.diff(chain.start) > 2
    touched = coarse.copy()
    touched[patches.patch[cut[number[: len(patches.sides)]]]] = True
    use = np.flatnonzero(touched[patches.patch])
    use = use[np.argsort(patches.patch[use], kind="stable")]
    steps, owner, _ = chain.steps(number[use])
    of, within = patches.patch[use[owner]], patches.within[use[owner]]
    bare = touched
    if cover is not None:
        steps, of, within = cover.taken_from(steps, of, within, patches)
        bare = np.zeros(len(touched), dtype=bool)
        bare[of] = True
    rank = np.cumsum(bare) - 1
    laid = lay(chain.points, patches.normal[bare], steps, rank[of], within)
    wide = np.isin(shell.piece, patches.piece[touched])
    corners = domain.points[shell.triangles[wide]]
    asked = float(wanted_triangles(field, corners, power_of_two(domain.points)).sum())
    if asked > ROUGHLY * most:
        raise InputError(too_many(asked, most))
    points, rows, patch = meshed(laid, field, chain.points, most, fill)
    parent = patches.piece[bare][patch]
    still = np.ones(len(shell.triangles), dtype=bool)
    still[np.isin(shell.piece, patches.piece[touched & patches.flat])] = False
    others = np.flatnonzero(~np.isin(shell.piece, patches.piece[patches.flat]))
    still[others] = ~touched[~patches.flat]
    rows = np.concatenate([rows, shell.triangles[still].astype(np.int64)])
    parent = np.concatenate([parent, shell.piece[still].astype(np.int64)])
    return _body(domain, points, rows, parent, number, chain)


def _refuse_too_many(points: Array, field: Wish, edges: Numbers, most: int) -> None:
    """Raise an error if edges alone would have far too many points, by the size at some places of them."""
    if len(edges) == 0:
        return
    along = _Edges(points, edges)
    share = (np.arange(PLACES_OF_EDGE) + 0.5) / PLACES_OF_EDGE
    piece = np.repeat(np.arange(len(edges)), PLACES_OF_EDGE)
    x = along.in_space(piece, np.tile(share, len(edges)))
    parts = along.length[piece] / wanted_along(field, x, along.along[piece])
    if parts.sum() / PLACES_OF_EDGE > ROUGHLY * most:
        raise InputError(too_many(float(parts.sum()) / PLACES_OF_EDGE, most))


def _body(
    domain: Domain, points: Array, rows: Numbers, parent: Numbers, number: Numbers, chain: _Chains
) -> Pieces:
    """The triangles and the parts of inner segments."""
    shell = domain.triangulated
    facets = parent < len(domain.facets)
    order = np.concatenate([np.flatnonzero(facets), np.flatnonzero(~facets)])
    rows, parent = rows[order], parent[order]
    many = int(facets.sum())
    edge = number[len(number) - len(shell.segments) :]
    steps, owner, span = chain.steps(edge)
    turned = (shell.segments[:, 0] > shell.segments[:, 1])[owner]
    steps[turned], span[turned] = steps[turned][:, ::-1], 1.0 - span[turned][:, ::-1]
    whole = np.concatenate([parent, shell.segment_piece[owner]]).astype(np.int32)
    spans = np.concatenate([np.tile(BOTH_ENDS, (len(rows), 1)), span])
    return Pieces(points, rows[:many], [*rows[many:], *steps], whole, spans)
