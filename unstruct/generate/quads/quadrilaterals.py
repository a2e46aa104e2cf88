"""Quadrilaterals in a domain: points packed along a field of crosses, triangulated and recombined.

See the book, chapter 6c.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count, as_flags
from ...base.arrays import frozen
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain, Sampled, as_domain
from ...domain.plane.by_region import size_by_region
from ...mesh.domain_mesh import DomainMesh, noticed
from ...predicates.batch import scaled, unscaled
from ...sizing.background_mesh import limit_nodes
from ...sizing.field import SizeField, as_size
from ..boundary.constrained import complex_of, planar_complex
from ..boundary.kept import SplitBoundary, check_split_boundary, kept_pieces
from ..boundary.pairs import paired
from ..rebay.run import VoronoiSegmentRun, rule_of
from .crosses import cross_field
from .packing import Guide, packed
from .recombine import Middles, on_pieces, recombined

__all__ = ["quadrilaterals"]

# Of the lengths per unit of length, beside edges of the boundary that are shorter than wanted.
LENGTH_GROWTH = 0.5
GUIDE_ACCEPTED = 1.35  # of the triangles of the guide: see `voronoi_segment`
# Of the largest coordinate: where lengths are less, points are as far apart as this.
SHORTEST_LENGTH = 2.0**-44
TOO_LONG = 2.0  # lengths; longer sides are told if the budget was not enough


def quadrilaterals(
    domain: Domain,
    size: Any,
    *,
    finish: bool = True,
    split_boundary: SplitBoundary = True,
    budget: int | None = None,
    progress: bool = False,
) -> DomainMesh:
    """Mesh a planar region by quadrilaterals that follow its boundary.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, 2) -> (k,), SizeField, or dict of region name to one of these
        The wanted edge length. Each piece of the boundary is cut into a whole number of edges of about this
        length.
    finish : bool
        Whether to improve the pairs of triangles, as `recombine` does.
    split_boundary : bool or "inner"
        As in `voronoi_segment`: whether edges of the boundary may be divided further, also where a triangle
        is left: with one more edge it becomes a quadrilateral. Pieces inside are not divided for that.
    budget : int, optional
        The largest number of points inside; 10^7 by default. `DomainMesh.complete` says whether they were
        enough.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        ``cells`` has "quad", and "triangle" if some are left, which ``unrefined`` lists. Every cell is
        convex. Counts and figures are those of `recombine`, "points", which were packed inside, and
        "divided", edges of the boundary. If the budget is spent, cells with a side of more than twice the
        wanted length are listed in ``unrefined``, too.

    Raises
    ------
    InputError
        As `voronoi_segment` does, and for a body in space.

    Notes
    -----
    A triangulation by `voronoi_segment` carries the crosses (directions up to quarter turns, along the
    boundary, harmonic inside) and the lengths, which are no longer than edges of the boundary nearby. Points
    are packed from the boundary on: each has four steps along its cross, to where no point is in the square
    of 0.7 lengths about. Their constrained Delaunay triangulation is recombined: see `recombine`, also for
    where triangles remain. O(n log n).
    Sources: J.-F. Remacle and others, Int. J. Numer. Methods Eng. 94 (2013) 494-512. Book: 6c.
    """
    as_flags(finish=finish, progress=progress)
    check_split_boundary(split_boundary)
    if isinstance(domain, Domain) and domain.dimension == 3:
        raise InputError('quadrilaterals are for the plane; in space see octree(...).mesh("hex-dominant")')
    budget = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    domain = as_domain(domain)
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces), domain.held())
    with progress_bar(progress, " points") as bar:
        complex_ = planar_complex(domain, size, progress=progress)
        wanted = as_size(size_by_region(complex_, size, domain.regions))
        rule = rule_of(GUIDE_ACCEPTED, "center", "first", None, bool(split_boundary))
        run = VoronoiSegmentRun(domain, complex_, wanted, None, rule, kept, False)
        run.insert(budget, bar)
        guide = run.result()
        given = np.zeros(len(guide.points), dtype=bool)
        given[guide.segments.ravel()] = True
        given |= guide.origin >= 0
        xy, _ = scaled(guide.points)
        place = int(np.argmax(np.abs(guide.points)))
        factor = float(xy.flat[place] / guide.points.flat[place])
        length = _lengths(guide, xy, factor, wanted)
        inside = packed(_guide(guide, xy, given, length), budget)
        bar.update(len(inside))
    number = np.cumsum(given) - 1
    sampled = Sampled(
        np.concatenate([guide.points[given], unscaled(inside, factor)]),
        np.concatenate([guide.origin[given], np.full(len(inside), -1, dtype=np.int32)]),
        number[guide.segments].astype(np.int32), guide.piece, guide.span, domain.sampled().outline,
    )  # fmt: skip
    mesh = complex_of(domain, sampled, progress=progress).mesh(
        facets=len(domain.facets), origin=sampled.origin, markers=domain.markers, points=sampled.points,
        counts={"points": len(inside)},
    )  # fmt: skip
    mesh = recombined(mesh, finish, _middles(domain, mesh, kept))
    if len(inside) == budget or run.spent:
        _list_large(mesh, wanted)
    return noticed(paired(domain, mesh))


def _middles(domain: Domain, mesh: DomainMesh, kept: NDArray[np.uint8]) -> Middles:
    """Where the subsegments of the mesh may be divided, on the true curves, if cells are on one side only."""
    ends = np.sort(mesh.segments.astype(np.int64), axis=1)
    sides = np.sort(np.asarray(mesh.simplices)[:, [[1, 2], [2, 0], [0, 1]]].astype(np.int64), axis=2)
    outer = sides[np.asarray(mesh.neighbors) < 0]
    n = len(mesh.points)
    free = np.flatnonzero(
        (kept[mesh.piece] == 0) & np.isin(ends[:, 0] * n + ends[:, 1], outer[:, 0] * n + outer[:, 1])
    )
    points = domain.points_at(mesh.piece[free], mesh.span[free].mean(axis=1))
    distinct = (points != mesh.points[mesh.segments[free, 0]]).any(axis=1)
    distinct &= (points != mesh.points[mesh.segments[free, 1]]).any(axis=1)
    return Middles(free[distinct], points[distinct])


def _list_large(mesh: DomainMesh, wanted: SizeField) -> None:
    """Cells with a side of more than twice the wanted length are not as asked for: the budget was small."""
    large = []
    for rows in mesh.cells.values():
        corners = mesh.points[rows]
        sides = np.roll(corners, -1, axis=1) - corners
        longest = np.sqrt((sides**2).sum(axis=2).max(axis=1))
        large.append(longest > TOO_LONG * wanted(corners.mean(axis=1)))
    found = np.flatnonzero(np.concatenate(large))
    reasons = dict(zip(mesh.unrefined.tolist(), mesh.reasons.tolist()))
    reasons |= {t: f"{reasons[t]}, budget" if t in reasons else "budget" for t in found.tolist()}
    mesh.unrefined = frozen(np.array(sorted(reasons), dtype=np.int64))
    mesh.reasons = frozen(np.array([reasons[t] for t in sorted(reasons)], dtype=str))


def _lengths(
    mesh: DomainMesh, xy: NDArray[np.float64], factor: float, wanted: SizeField
) -> NDArray[np.float64]:
    """The scaled lengths at the vertices: as wanted, no longer than edges of the boundary there, graded."""
    ends = mesh.segments
    x = xy[ends[:, 1]] - xy[ends[:, 0]]
    length = np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2)
    total = np.bincount(ends.ravel(), np.repeat(length, 2), len(xy))
    many = np.bincount(ends.ravel(), minlength=len(xy))
    mean = np.divide(total, many, out=np.full(len(many), np.inf), where=many > 0)
    shortest = SHORTEST_LENGTH * float(np.abs(xy).max())
    least = np.maximum(np.minimum(wanted(mesh.points), mean / factor), shortest / factor)
    return np.maximum(limit_nodes(mesh, least, LENGTH_GROWTH) * factor, shortest)


def _guide(
    mesh: DomainMesh, xy: NDArray[np.float64], given: NDArray[np.bool_], length: NDArray[np.float64]
) -> Guide:
    rows = np.asarray(mesh.simplices)
    flat = rows.ravel()
    order = np.argsort(flat, kind="stable")
    start = np.searchsorted(flat[order], np.arange(len(xy) + 1))
    return Guide(
        xy, rows, np.asarray(mesh.neighbors), on_pieces(mesh), given, cross_field(xy, rows, mesh.segments),
        length, start, order // 3,
    )  # fmt: skip
