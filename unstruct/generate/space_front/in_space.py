"""`advancing_front` for a body in space: its surface cut to the size, the front, and what is too large."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain
from ...domain.space.by_part import size_by_part
from ...geometry.edge_vectors import lengths
from ...mesh.domain_mesh import DomainMesh
from ...sizing.asked import COARSE_BOUNDARY, MUCH_LONGER, asked_again
from ...sizing.field import SizeField, as_size
from ..bodies.dividing import divided
from ..bodies.tetrahedralize import as_parts
from ..volume.filling import filled
from ..volume.improving import improve
from ..volume.lattice import MOST_INNER
from ..volume_points.limits import make_body_limits, points_allowed
from ..volume_points.run import recovered
from .run import SPACE_ORDERS, SPACE_PLACEMENTS, SpaceFrontRun, SpacePlacement

__all__ = ["NO_ROOM_FOR_POINT", "larger_cells", "space_front"]

NO_ROOM_FOR_POINT = "too large: no room for a point"
EDGES_OF_CELL = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))


def space_front(
    domain: Domain,
    size: Any,
    *,
    order: str = "widest",
    placement: str | SpacePlacement = "equal sides",
    finish: bool = True,
    split_boundary: bool | None = None,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """`advancing_front` for a body in space; see there."""
    if not (isinstance(order, str) and order in SPACE_ORDERS):
        raise InputError(f"order = {order!r} must be one of {', '.join(map(repr, SPACE_ORDERS))}")
    if not (placement in SPACE_PLACEMENTS if isinstance(placement, str) else callable(placement)):
        raise InputError(
            f"placement = {placement!r} must be one of {', '.join(map(repr, SPACE_PLACEMENTS))}, "
            "or a function"
        )
    field = as_size(size_by_part(domain, size))
    most = points_allowed(domain, field, budget)
    sizes = size if isinstance(size, Mapping) else None
    choices = order, placement, history, progress

    def made(field: SizeField) -> DomainMesh:
        mesh, done = _made(domain, field if sizes is None else sizes, field, split_boundary, most, choices)
        return _finished(mesh, field, finish, progress, bool(split_boundary)) if done else mesh

    return asked_again(made, field)


def _made(
    domain: Domain,
    size: Any,
    field: SizeField,
    split_boundary: bool | None,
    most: int,
    choices: tuple[str, str | SpacePlacement, bool, bool],
) -> tuple[DomainMesh, bool]:
    """The mesh as the front makes it, and whether the front has become empty."""
    order, placement, history, progress = choices
    cut = None if split_boundary is False else divided(domain, field, bool(split_boundary), MOST_INNER)
    body = domain if cut is None else cut.domain
    cells, found = recovered(body, progress)
    done = found.complete
    if done:
        run = SpaceFrontRun(body, cells, found, order, placement, history)
        names = [*body.regions, *[""] * (int(run.regions.max()) + 1 - len(body.regions))]
        limits = make_body_limits(names, np.asarray(domain.bounds), cells.factor, size=size)
        with progress_bar(progress, " points", desc="front") as bar:
            run.march(limits, most, bar)
        mesh, done = run.result(), not run.spent
    else:
        mesh = filled(body, names=domain.name if cut is None else cut.name, progress=progress)
    return mesh if cut is None else as_parts(domain, cut, mesh), done


def _finished(mesh: DomainMesh, field: SizeField, finish: bool, progress: bool, cut: bool) -> DomainMesh:
    """The mesh after the finishing pass if it is wanted, with what is too large."""
    better = improve(mesh, progress=progress) if finish else mesh
    large = larger_cells(better, field)
    why = NO_ROOM_FOR_POINT if cut else NO_ROOM_FOR_POINT + COARSE_BOUNDARY
    better.unrefined, better.reasons = large, np.full(len(large), why)
    better.steps = mesh.steps
    return better


def larger_cells(mesh: DomainMesh, field: SizeField) -> NDArray[np.int32]:
    """The cells with an edge that is much longer than wanted at the barycenter."""
    corners = mesh.points[mesh.simplices]
    wanted = field(corners.mean(axis=1))
    longest = np.zeros(len(corners))
    for i, j in EDGES_OF_CELL:
        np.maximum(longest, lengths(corners[:, i] - corners[:, j]), out=longest)
    return np.flatnonzero(longest > MUCH_LONGER * wanted).astype(np.int32)
