"""The steps of the front in space in a metric, compiled: `steps`, with all measures through it.

The queue, the rules of acceptance and the record are those of `ledger` and `steps`; lengths are 1 where they
are as wanted. For measures see `metric_measures`, for points, and why this ends, `metric_apex`. Book: 3.5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, MORE, ROOM
from ...base.jit import inline, kernel
from ...connect.spatial.numbered import Numbered
from ...connect.spatial.opening import STAR_WALLS, Star
from ...connect.spatial.records import Solid
from ...connect.spatial.star import in_star
from ...sizing.space_metric_table import SpaceMetricNodes
from ..advancing.queue import LAST_LEVEL
from ..rebay.queue import ACCEPTED, LEVEL, STATUS, WAITING, bucket_of, next_slot, push, unlink
from ..volume_points.limits import REGULAR
from ..volume_points.measures import cell_center
from . import ledger as book
from .metric_apex import metric_apex, try_metric_apex
from .metric_measures import (
    LOCAL_CELL,
    map_cell,
    metric_at_cell,
    put_back,
    square_of_cell,
    square_of_face,
)  # fmt: skip
from .steps import APEX_FITS, LACKS_SLOTS, NO_REASON, NOT_SEEN, count_failed, write_row

SMALL_SQUARE = (book.CELL_ACCEPT * REGULAR) ** 2  # of the circumradius of a cell that is small enough


class MetricMarch(NamedTuple):
    """As `ledger.SpaceMarch`, with a metric in place of sizes."""

    solid: Solid
    star: Star
    edges: Numbered
    table: SpaceMetricNodes
    links: NDArray[np.int32]
    gates: NDArray[np.int32]
    turn: NDArray[np.int64]
    later: NDArray[np.int32]
    rule: book.SpaceRule
    local: NDArray[np.float64]  # (4, 3) images


@inline
def metric_face(march, t, tried):
    """The smallest face of cell t at the front, in the metric, that has not been tried (bits), or -1."""
    best, least, solid = np.int64(-1), np.inf, march.solid
    for k in range(4):
        face = np.int64(4 * t + k)
        if (tried >> k) & 1 == 0 and solid.mark[face] >= 0:
            square = square_of_face(solid.xyz, solid.vertex, face, march.table, march.local)
            if best < 0 or square < least:
                best, least = face, square
    return best


@inline
def enqueue_in_metric(march, t, out):
    """Put an unfinished cell that has just got a face at the front in the queue, as `ledger.enqueue_cell`."""
    solid, links = march.solid, march.links
    waits = links[t, STATUS] >= 0
    if not waits or links[t, LEVEL] == LAST_LEVEL:
        if waits:
            unlink(links, march.gates, t, WAITING)
        measure = 1.0
        if march.rule.order == book.WIDEST_CELL:
            measure = square_of_cell(solid.xyz, solid.vertex, t, march.table, march.local, out) / SMALL_SQUARE
        buckets = len(march.gates) // 2
        level = bucket_of(measure, buckets - 1) if measure < 1e300 else buckets - 2
        links[t, LEVEL] = LAST_LEVEL + 1 + level
        push(links, march.gates, march.turn, t, False)


@inline
def put_metric_apex(march, counts, out, p, taken):
    """Replace the cavity by the star of p; see `ledger.put_apex`."""
    found = book.replace_cavity(march, counts, p, taken)
    for i in range(march.star.sizes[STAR_WALLS]):
        t = book.cell_to_queue(march, i, taken)
        if t >= 0:
            enqueue_in_metric(march, t, out)
    return found


@inline
def end_metric_step(march, diary, counts, face, reason, out):
    """Accept the cell ahead of a face, then small cells with three or four faces at the front."""
    solid, depth, many = march.solid, 0, 0
    while face >= 0:
        many, depth = book.accept_and_note(march, diary, counts, face, reason, many, depth)
        face = np.int64(-1)
        while depth > 0 and face < 0:
            t, depth = book.next_to_close(march, depth)
            if t >= 0:
                square = square_of_cell(solid.xyz, solid.vertex, t, march.table, march.local, out)
                if square < SMALL_SQUARE:
                    face, reason = metric_face(march, t, 0), book.CLOSED_CELL
    for i in range(many):
        if march.links[march.later[i], STATUS] != ACCEPTED:
            enqueue_in_metric(march, np.int64(march.later[i]), out)


@inline
def center_in_metric(march, counts, face, out):
    """Write the circumcenter of a cell that was set aside as the next vertex, and judge it.

    Returns an outcome and R^2. The cell itself must go, and a small cell needs no point.
    """
    solid, xyz, p = march.solid, march.solid.xyz, counts[book.VERTICES_USED]
    m, o = metric_at_cell(xyz, solid.vertex, face >> 2, march.table), solid.vertex[face]
    map_cell(xyz, solid.vertex, face, m, -1, march.local)
    square, _, _ = cell_center(march.local, LOCAL_CELL, 0, out)
    if not (square < np.inf and square > SMALL_SQUARE):
        return NOT_SEEN, square
    out[12], out[13], out[14] = out[0], out[1], out[2]
    put_back(m, xyz[o, 0], xyz[o, 1], xyz[o, 2], out, 12, xyz, p)
    outcome, _ = try_metric_apex(march, face, p, 1.0, march.local, out)
    if outcome == APEX_FITS and not in_star(solid, face >> 2):
        outcome = NOT_SEEN
    return outcome, square


@kernel
def advance_in_space_metric(march, diary, counts, out, limit):
    """Take up to ``limit`` steps; return how it ended: DONE, MORE or ROOM."""
    solid, xyz = march.solid, march.solid.xyz
    for _ in range(limit):
        p = counts[book.VERTICES_USED]
        t = np.int64(next_slot(march.links, march.gates, march.turn))
        if t < 0:
            return DONE
        if p >= xyz.shape[0]:
            return ROOM
        reason, face, near, failed, tried = NO_REASON, np.int64(-1), np.int64(-1), 0, 0
        side = square = 0.0
        while reason == NO_REASON:
            face = metric_face(march, t, tried)
            if face < 0:
                break
            side, square, ahead = metric_apex(
                solid, march.table, march.rule.placement, face, p, march.local, out
            )
            near = np.int64(-1)
            if square < SMALL_SQUARE * min(1.0, side) ** 2:
                reason = book.SMALL_CELL
            elif not ahead:
                reason = book.EMPTY_SPHERE
            else:
                outcome, near = try_metric_apex(march, face, p, side, march.local, out)
                if outcome == LACKS_SLOTS:
                    return ROOM
                if outcome == APEX_FITS:
                    face, reason = put_metric_apex(march, counts, out, p, face), book.NEW_APEX
                elif near == solid.vertex[face]:
                    reason = book.NEAR_APEX
                else:
                    failed += 1 << 8 * outcome
            tried |= 1 << (face & 3)
        row = p
        if reason == NO_REASON and not book.cell_aside(march, counts, t):
            face = metric_face(march, t, 0)
            outcome, square = center_in_metric(march, counts, face, out)
            if outcome == LACKS_SLOTS:
                return ROOM
            near, reason, row = np.int64(-1), book.FORCED_CELL, np.int64(-1)
            if outcome == APEX_FITS:
                face, reason, row = put_metric_apex(march, counts, out, p, face), book.CENTER_APEX, p
        count_failed(counts, failed)
        if reason != NO_REASON:
            write_row(diary, counts[book.CELLS_DONE], xyz, row, side, square, near)
            end_metric_step(march, diary, counts, face, reason, out)
    return MORE


@kernel
def start_in_space_metric(march, cells, out):
    """Put the cells along the surface into the queue, in a random order as `steps.start_in_space` does."""
    book.set_all_unfinished(march)
    book.shuffle_rows(march.solid.state, cells)
    for i in range(cells.shape[0]):
        enqueue_in_metric(march, np.int64(cells[i]), out)
