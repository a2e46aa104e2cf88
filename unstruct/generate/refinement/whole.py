"""A whole run of refinement in one kernel call, for input so small that setting up a run takes longer."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET
from ...base.arrays import fill
from ...base.codes import DONE
from ...base.jit import kernel
from ...connect.insertion.engine import COUNT
from ...connect.insertion.halfedges import SEGMENTS, VERTICES
from ...connect.planar.complex import copy_all
from ...connect.planar.extraction import extract, named_sets, survey
from ...connect.planar.records import Plane
from ...mesh.domain_mesh import DomainMesh
from .account import survey_missed, told
from .encroachment import OTHER
from .free_vertices import MOST_CORNERS
from .limits import Limits
from .run import Planned, counts_of
from .state import BY_FUNCTION, KEPT, LARGE, REFUSALS, VERTEX_LIMIT, Work, begin, expected
from .steps import advance

__all__ = ["refined_at_once"]

FEW_VERTICES = 1024  # input with more vertices, or for which more are expected, is refined step by step
STEPS_AT_ONCE = 20_000  # as many as in one call otherwise


@kernel
def _larger(plane, n, s):
    """A copy of a triangulation with room for so many vertices and subsegments."""
    xy, span = np.empty((n, 2)), np.empty((s, 2))
    vertex, twin = np.empty(6 * n, dtype=np.int32), np.empty(6 * n, dtype=np.int32)
    mark, region = np.empty(6 * n, dtype=np.int32), np.empty(2 * n, dtype=np.int32)
    where, ends = np.empty(s, dtype=np.int32), np.empty((s, 2), dtype=np.int32)
    piece = np.empty(s, dtype=np.int32)
    larger = Plane(xy, vertex, twin, mark, region, where, ends, piece, span, plane.state.copy())
    copy_all(plane, larger)
    return larger


@kernel
def _work(plane, pieces, hold):
    """The arrays of a run on this triangulation, which has all the room that the run may take."""
    curve, arc, joints = pieces
    allowed = np.empty((len(joints), 2), dtype=np.int64)
    n, s, t = len(plane.xy), len(plane.where), len(plane.region)
    status, gates = fill(np.empty(t + 1, dtype=np.uint16), 0), np.empty((LARGE, 2), dtype=np.int32)
    for k in range(LARGE):
        gates[k, 0] = gates[k, 1] = -1
    return Work(
        plane.xy, plane.vertex, plane.twin, plane.mark, plane.region, plane.where, plane.ends, plane.piece,
        plane.span, plane.state,
        np.empty(n, dtype=np.int32), np.empty(n),
        np.empty(s, dtype=np.uint8), np.empty(s, dtype=np.uint8), np.empty(s, dtype=np.uint8), np.empty(s),
        np.empty((s, 3)), np.empty(s, dtype=np.int32), np.empty(s, dtype=np.int32),
        status, np.empty(t + 1, dtype=np.int32), np.empty(t + 1, dtype=np.int32),
        np.empty(t + 1, dtype=np.int32), gates, curve, arc, joints, allowed,
        np.empty(t + 16, dtype=np.int32), np.empty(t + 8, dtype=np.int32), np.empty(t + 16, dtype=np.int32),
        hold, np.empty(t + 16, dtype=np.int32),
        np.empty((MOST_CORNERS, 7), dtype=np.int64), np.empty((0, 5), dtype=np.int32), np.empty((0, 2)),
    )  # fmt: skip


@kernel
def _refined(triangles, subsegments, state, pieces, limited, choices, kept, tally):
    """Refine a copy of a triangulation; DONE with the arrays of the mesh, or another code and no arrays.

    ``limited`` is `Limits` as a plain tuple, and ``choices`` are the room for vertices and subsegments,
    the distance of off-centers, whether splits for the angle are limited, the factor of the coordinates, and
    the numbers of facets and of vertices that were given.
    """
    room, offset, thrifty, factor, facets, given = choices
    limits = Limits(*limited)
    n, s = state[VERTICES], state[SEGMENTS]
    plane = _larger(Plane(*triangles, *subsegments, state), room + 8 * n + 256, room + 8 * s + 256)
    w = _work(plane, pieces, np.empty((len(plane.region) + 16, 4), dtype=np.int64))
    inputs = np.empty(given, dtype=np.int32)
    for v in range(given):
        inputs[v] = v
    begin(w, inputs, limits.fraction, thrifty)
    for i in range(s):
        if kept[w.piece[i]] > 0:
            w.lock[i] = KEPT
    code, found = advance(w, tally, limits, offset, STEPS_AT_ONCE), np.empty((0, 8), dtype=np.int64)
    if code == DONE and tally[REFUSALS] > 0:  # at least one for each triangle that misses a limit
        found = np.empty((tally[REFUSALS], 8), dtype=np.int64)
        found = found[: survey_missed(w, limits, found)]
    n = plane.state[VERTICES]
    number, place = np.empty(plane.state[COUNT], dtype=np.int32), np.empty(n, dtype=np.int32)
    made = plane.vertex, plane.twin, plane.region
    parts = plane.where, plane.ends, plane.piece, plane.span
    count, vertices, held, outer = survey(made, parts, plane.state, facets, number, place)
    simplices, neighbors = np.empty((count, 3), dtype=np.int32), np.empty((count, 3), dtype=np.int32)
    cells = simplices, neighbors, np.empty(count, dtype=np.int32)
    rows = np.empty((held, 2), dtype=np.int32), np.empty(held, dtype=np.int32), np.empty((held, 2))
    extract(made, parts, plane.state, number, place, cells, rows)
    for i in range(len(found)):
        found[i, 0] = number[found[i, 0]]
    points, origin = np.empty((vertices, 2)), np.empty(vertices, dtype=np.int32)
    for v in range(n):
        i = place[v]
        if i >= 0:
            points[i, 0], points[i, 1] = plane.xy[v, 0] / factor, plane.xy[v, 1] / factor
            origin[i] = v if v < given else -1
    return code, points, origin, cells, rows, outer, found, plane.xy


def refined_at_once(
    planned: Planned, limits: Limits, offset: float, budget: int | None, kept: NDArray[np.uint8], curved: bool
) -> DomainMesh | None:
    """The whole run for a small triangulation of a `Domain`.

    Parameters
    ----------
    planned, limits, offset, budget
        As for `RefineRun`.
    kept : ndarray of uint8, shape (pieces,)
        1 for pieces that must not be split.
    curved : bool
        Whether there are curves.

    Returns
    -------
    DomainMesh or None
        None if more room or time is needed than expected, if there are curves of other kinds than arcs, or if
        the budget was not enough. Nothing has changed then, and a `RefineRun` will do.
    """
    c, mesh = planned.complex_, planned.rest["mesh"]
    if c.size > FEW_VERTICES or len(limits.child):
        return None
    more = expected(c.plane(), limits)  # by itself, so that nothing is compiled for a run by steps
    if not more <= FEW_VERTICES:
        return None
    curve, arc = planned.curve, planned.arc
    if curved:
        if (curve == OTHER).any():
            return None
        arc = arc.copy()
        arc[:, :3] *= c.factor
    tally = np.zeros(BY_FUNCTION + 1, dtype=np.int64)
    tally[VERTEX_LIMIT] = DEFAULT_BUDGET if budget is None else budget
    facets = mesh["facets"]
    code, points, origin, triangles, subsegments, outer, found, xy = _refined(
        (c.xy, c.vertex, c.twin, c.mark, c.region), (c.where, c.ends, c.piece, c.span), c.state,
        (curve, arc, planned.joints.copy()), tuple(limits),
        (2 * int(more), offset, budget is None, c.factor, facets, len(mesh["points"])), kept, tally,
    )  # fmt: skip
    if code != DONE:
        return None
    simplices, neighbors, region = triangles
    ends, piece, _ = subsegments
    cells, reasons, missed = told(found, xy, limits, planned, True)
    return DomainMesh.of_triangles(
        points, origin, (simplices, neighbors),
        named_sets(ends, piece, outer, facets, mesh["markers"]) | {"region": region}, subsegments,
        regions=c.regions, unrefined=cells, reasons=reasons, counts=counts_of(tally, missed),
    )  # fmt: skip
