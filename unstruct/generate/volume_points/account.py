"""The cells that miss a limit after an insertion in space, and the reason for each."""

from __future__ import annotations

import numpy as np

from ...base.codes import HIDDEN, ROUNDED
from ...base.jit import kernel
from ...connect.insertion.engine import COUNT
from ...connect.spatial.complex import SpatialMesh
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ..volume.filling import with_names
from .limits import BY_QUALITY
from .measures import judge_cell
from .reasons import (
    AT_INPUT_ANGLE,
    BEYOND_THE_BOX,
    FLAT_TETRAHEDRON,
    IN_NARROW_GAP,
    MUST_STAY,
    NEAR_VERTEX,
    OFTEN_DIVIDED,
)
from .run import BodyRun

__all__ = ["result_of"]

BODY_REASONS = {
    HIDDEN: "hidden: a segment or facet that cannot be divided lies before its center",
    ROUNDED: "precision: rounding leaves no valid place for its center",
    NEAR_VERTEX: "too near: its shape would need edges much shorter than those of the input nearby",
    MUST_STAY: "kept: only a point on a segment or facet that must stay would help",
    OFTEN_DIVIDED: "divided often: only a further point on a segment or facet would help; a budget allows it",
    IN_NARROW_GAP: "narrow: between parts much nearer to each other than they are wide, or than the size",
    AT_INPUT_ANGLE: "input angle: pieces that meet at a small angle leave no choice",
    FLAT_TETRAHEDRON: "sliver: a point against it would be very near to its vertices; improve may help",
    BEYOND_THE_BOX: "flat: its center is far away from the body; improve may help",
    0: "budget",
}


@kernel
def _survey(w, out, cause):
    """Why each cell is bad, in bits."""
    for t in range(w.solid.state[COUNT]):
        cause[t] = 0
        if w.solid.vertex[4 * t] >= 0 and w.solid.region[t] >= 0:
            cause[t], _, _ = judge_cell(w.solid, w.limits, t, out)


def result_of(run: BodyRun, history: bool = False) -> DomainMesh:
    """The mesh of a run, with all that is known of it."""
    cells, domain = run.cells, run.domain
    made = cells.inside()
    cause = np.zeros(cells.slots, dtype=np.int8)
    _survey(run.work(), run.out, cause)
    slots = np.flatnonzero(cells.used() & (cells.region[: cells.slots] >= 0))
    bad = np.flatnonzero(cause[slots])
    why = run.why[slots[bad]]
    unrefined = {
        int(cell): BODY_REASONS.get(int(code), BODY_REASONS[0])
        for cell, code in zip(bad.tolist(), (why >> 2).tolist())
    }
    shape = int((cause[slots] & BY_QUALITY > 0).sum())
    counts = {**run.counts(), "size": len(bad) - shape, "shape": shape}
    return _named(domain, run, made, unrefined, counts, history)


def _named(
    domain: Domain, run: BodyRun, made: SpatialMesh, unrefined: dict[int, str], counts: dict, history: bool
) -> DomainMesh:
    mesh = with_names(domain, run.found, made, run.chains(made), unrefined, counts)
    if history:
        mesh.steps = run.steps(made)
    return mesh
