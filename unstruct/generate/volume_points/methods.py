"""The source chapter's methods in space: circumcenters of the worst cells, and points on Voronoi segments.

Both make slivers; `improve` cures them. See the book, 2.8c.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...base.arguments import positive
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain
from ...domain.plane.by_region import no_entry, per_region
from ...mesh.domain_mesh import DomainMesh
from ..boundary.kept import SplitBoundary, kept_pieces
from ..volume.filling import filled
from ..volume.improving import improve
from .account import result_of
from .limits import (
    BY_FIELD,
    BY_QUOTIENT,
    BY_RADIUS,
    CENTER_RULE,
    REGULAR,
    SEGMENT_RULE,
    field_of,
    make_body_limits,
    points_allowed,
)
from .run import BodyRun, recovered

__all__ = ["centers_in_body", "segments_in_body"]

NO_SIZE = 2.0**-40  # of the extent: every cell is larger than the cube of this


def centers_in_body(
    domain: Domain,
    size: Any = None,
    *,
    priority: Any = None,
    split_boundary: SplitBoundary = True,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """`circumcenter_insertion` for a body in space; see there."""
    if size is None and budget is None:
        raise InputError("without a size or a limit every cell is bad: give a size, or a budget")
    choice = _order(priority, size is not None)
    rule = choice, CENTER_RULE, 1.0
    return _run(domain, size, rule, split_boundary, budget, history, progress, "centers")[0]


def segments_in_body(
    domain: Domain,
    size: Any,
    *,
    priority: Any = None,
    accept: float = 1.35,
    finish: bool = True,
    split_boundary: SplitBoundary = True,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """`voronoi_segment` for a body in space; see there."""
    if size is None:
        raise InputError("size must be a number, a function of points or a SizeField, not None")
    accept = positive(accept, "accept")
    rule = _order(priority, True), SEGMENT_RULE, accept
    mesh, done = _run(domain, size, rule, split_boundary, budget, history, progress, "Voronoi")
    if not finish or history or not done:
        return mesh
    better = improve(mesh, progress=progress)
    for name in ("min_dihedral", "3r/R"):
        for when, one in (("before", mesh), ("after", better)):
            better.figures[f"minimum {name} {when}"] = float(one.quality(name).min())
    return better


def _order(priority: Any, sized: bool) -> tuple[int, Any]:
    """How the next cell is chosen, and the size for that, if there is another one."""
    if priority is None:
        return BY_QUOTIENT if sized else BY_RADIUS, None
    if not isinstance(priority, str):
        return BY_FIELD, field_of(priority)
    if priority not in ("alpha", "circumradius"):
        raise InputError(
            f"priority = {priority!r:.60} must be 'alpha' or 'circumradius' in space, or a size to compare "
            "circumradii with"
        )
    if priority == "alpha" and not sized:
        raise InputError("the priority 'alpha' compares circumradii with a size: give a size")
    return BY_QUOTIENT if priority == "alpha" else BY_RADIUS, None


def _run(
    domain: Domain,
    size: Any,
    chosen: tuple[tuple[int, Any], int, float],
    split_boundary: SplitBoundary,
    budget: int | None,
    history: bool,
    progress: bool,
    what: str,
) -> tuple[DomainMesh, bool]:
    """The mesh, and whether nothing is left to do."""
    (order, priority), rule, accept = chosen
    most = points_allowed(domain, size, budget)
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces))
    cells, found = recovered(domain, progress)
    if not found.complete:
        return filled(domain, progress=progress), False
    run = BodyRun(domain, cells, found, kept, budget is None)
    names = [*domain.regions, *[""] * (int(run.regions.max()) + 1 - len(domain.regions))]
    for r, one in enumerate(per_region(size, names, "size")):
        if one is None and size is not None:
            made = cells.inside()
            raise no_entry(
                names[r], made.points[made.simplices[int(np.argmax(run.regions == r))]].mean(axis=0)
            )
    limits = make_body_limits(
        names, np.asarray(domain.bounds), cells.factor,
        size=size, reach=accept * REGULAR, order=order, rule=rule, bold=True, lens=1.0,
        priority=priority,
    )  # fmt: skip
    if size is None:  # each cell is bad, but no segment and no facet is too large
        extent = float(np.ptp(domain.bounds * cells.factor, axis=0).max())
        limits = limits._replace(volume=np.full(len(limits.volume), 6.0 * (NO_SIZE * extent) ** 3))
    run.begin(limits)
    with progress_bar(progress, " points", desc=what) as bar:
        done = run.advance(most, bar)
        if done and rule == SEGMENT_RULE:  # cells that never had an active face
            run.limits = limits._replace(rule=CENTER_RULE)
            run.enter_again()
            done = run.advance(most, bar)
    return result_of(run, history), done
