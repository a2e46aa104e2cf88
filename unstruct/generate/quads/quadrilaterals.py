"""Quadrilaterals in a domain: points packed along a field of crosses, triangulated and recombined.

See the book, chapter 6c.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, MOST_VERTICES, as_count, as_flags
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain, Sampled, as_domain
from ...mesh.domain_mesh import DomainMesh, noticed
from ...predicates.batch import scaled, unscaled
from ...sizing.background_mesh import limit_nodes
from ...sizing.field import as_size
from ..boundary.constrained import complex_of
from ..boundary.kept import SplitBoundary
from ..boundary.pairs import paired
from ..rebay.voronoi_segment import voronoi_segment
from .crosses import cross_field
from .packing import Guide, packed
from .recombine import on_pieces, recombined

__all__ = ["quadrilaterals"]

GROWTH = 0.5  # of the lengths per unit of length, beside edges of the boundary that are shorter than wanted


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
        As in `voronoi_segment`: whether edges of the boundary may be divided further.
    budget : int, optional
        The largest number of points inside; 10^7 by default. `DomainMesh.complete` says whether they were
        enough.
    progress : bool
        Show a bar.

    Returns
    -------
    DomainMesh
        ``cells`` has "quad", and "triangle" if some are left, which ``unrefined`` lists. Every cell is
        convex. Counts and figures are those of `recombine`, and "points", which were packed inside.

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
    if isinstance(domain, Domain) and domain.dimension == 3:
        raise InputError('quadrilaterals are for the plane; in space see octree(...).mesh("hex-dominant")')
    budget = DEFAULT_BUDGET if budget is None else min(as_count(budget, "budget"), MOST_VERTICES)
    domain = as_domain(domain)
    guide = voronoi_segment(
        domain, size, finish=False, split_boundary=split_boundary, budget=budget, progress=progress
    )
    with progress_bar(progress, " points") as bar:
        given = np.zeros(len(guide.points), dtype=bool)
        given[guide.segments.ravel()] = True
        given |= guide.origin >= 0
        xy, _ = scaled(guide.points)
        place = int(np.argmax(np.abs(guide.points)))
        factor = float(xy.flat[place] / guide.points.flat[place])
        inside = packed(_guide(guide, xy, given, _lengths(guide, size, given) * factor), budget)
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
    return noticed(paired(domain, recombined(mesh, finish)))


def _lengths(mesh: DomainMesh, size: Any, given: NDArray[np.bool_]) -> NDArray[np.float64]:
    """The lengths at the vertices: as wanted, no longer than the edges of the boundary there, graded."""
    wanted = np.full(len(mesh.points), np.inf)
    if isinstance(size, Mapping):
        region = mesh.markers["region"]
        names = {number: name for name, number in mesh.regions.items()}
        for number in np.unique(region).tolist():
            name = names.get(number)
            field = size[name] if name in size else size[None]
            rows = np.unique(np.asarray(mesh.simplices)[region == number])
            wanted[rows] = np.minimum(wanted[rows], as_size(field)(mesh.points[rows]))
    else:
        wanted[:] = as_size(size)(mesh.points)
    ends = mesh.segments
    x = mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
    length = np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2)
    total = np.bincount(ends.ravel(), np.repeat(length, 2), len(wanted))
    many = np.bincount(ends.ravel(), minlength=len(wanted))
    mean = np.divide(total, many, out=np.full(len(wanted), np.inf), where=many > 0)
    return limit_nodes(mesh, np.minimum(wanted, mean), GROWTH)


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
