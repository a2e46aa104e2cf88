"""Delaunay refinement of bodies: `refine` in space (section 2.8d of the book)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.progress import progress_bar
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ..boundary.kept import SplitBoundary, kept_pieces
from ..volume.filling import filled
from .account import result_of
from .limits import make_body_limits, points_allowed, shape_limits
from .run import BodyRun, recovered

__all__ = ["refine_body"]

RADIUS_EDGE = 2.0  # by default


def refine_body(
    domain: Domain,
    size: Any = None,
    *,
    radius_edge: float | None = None,
    max_volume: Any = None,
    min_dihedral: float | None = None,
    split_boundary: SplitBoundary = True,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
    held: NDArray[np.bool_] | None = None,
    names: list[Any] | None = None,
) -> DomainMesh:
    """`refine` for a body in space; see there.

    ``held`` are pieces that stay as they are; by ``names`` limits are given for regions, if not by their own.
    """
    ratio, angle = shape_limits(RADIUS_EDGE if radius_edge is None else radius_edge, min_dihedral)
    most = points_allowed(domain, size, budget)
    kept = kept_pieces(split_boundary, len(domain.facets), len(domain.pieces), held)
    cells, found = recovered(domain, progress)
    if not found.complete:
        return filled(domain, progress=progress)
    run = BodyRun(domain, cells, found, kept, budget is None)
    called = list(domain.regions) if names is None else names
    called = [*called, *[""] * (int(run.regions.max()) + 1 - len(called))]
    limits = make_body_limits(
        called, np.asarray(domain.bounds), cells.factor,
        size=size, max_volume=max_volume, radius_edge=ratio, min_dihedral=angle,
    )  # fmt: skip
    run.begin(limits)
    with progress_bar(progress, " vertices", desc="refine") as bar:
        run.advance(max(most - len(domain.points), 0), bar)
    return result_of(run, history)
