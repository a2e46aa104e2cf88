"""What the front in space keeps: its rule, its record, its counts, its queue and its faces, compiled.

The queue is that of the plane, too (`generate.advancing.queue`). Helpers here are inlined, since a record
with forty arrays is copied at each call: that took two thirds of the time. Book: 3.5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline
from ...connect.insertion.engine import COUNT
from ...connect.spatial.cavity import corner, draw
from ...connect.spatial.numbered import Numbered
from ...connect.spatial.opening import STAR_CELLS, STAR_WALLS, Star
from ...connect.spatial.records import Solid
from ...connect.spatial.star import commit_star
from ..advancing.queue import LAST_LEVEL, crosses_front, leaves_queue, sent_last
from ..rebay.queue import ACCEPTED, LEVEL, STATUS, WAITING, bucket_of, push, unlink
from ..volume_points.limits import BodyLimits, wanted_in_space
from ..volume_points.measures import cell_center

# Orders of the queue.
WIDEST_CELL, SMALLEST_SIZE, SMALLEST_FACE, OLDEST_FACE = range(4)
# Why a cell was accepted; each is also the place of its count.
NEW_APEX, SMALL_CELL, EMPTY_SPHERE, NEAR_APEX, AT_DIHEDRAL, CLOSED_CELL, CENTER_APEX, FORCED_CELL = range(8)
# Further counts: cells set aside, and ideal points that were not possible; then cells and vertices so far.
CELLS_ASIDE, APEX_OUTSIDE, APEX_ENCROACHES, APEX_NEAR, APEX_FLAT = range(8, 13)
CELLS_DONE, VERTICES_USED, SPACE_COUNTS = 13, 14, 15
FRONT_MARK = 2**30  # the mark of faces of the front that are on no facet

CELL_ACCEPT = 1.1  # a cell ahead with R < CELL_ACCEPT f is accepted as it is
APEX_ROOM = 0.75  # times the wanted length: no point nearer than that to a vertex
FACES_TO_CLOSE = 3  # so many faces at the front, and a small cell is accepted at once


class SpaceRule(NamedTuple):
    """What the caller chooses."""

    order: int  # of the queue: WIDEST_CELL, ...
    placement: int  # of the ideal point, see `placing`
    scale: float  # what the measure of the order is divided by, or divides


class SpaceDiary(NamedTuple):
    """The record: one row for each accepted cell, in order."""

    slots: NDArray[np.int32]
    log: NDArray[np.int32]  # (., 6) A, B, C, apex, reason, the vertex that was too near; (0, 6) if not wanted
    numbers: NDArray[np.float64]  # (., 5) the ideal point, h, R of the cell ahead


class SpaceMarch(NamedTuple):
    """The cells, the queue of those at the front, the size, and the choices."""

    solid: Solid
    star: Star
    edges: Numbered
    limits: BodyLimits
    links: NDArray[np.int32]
    gates: NDArray[np.int32]
    turn: NDArray[np.int64]
    later: NDArray[np.int32]  # cells that are queued when a step is done
    rule: SpaceRule


@inline
def faces_at_front(mark, t):
    """How many faces of cell t belong to the front (or to the surface), if it is unfinished."""
    return (mark[4 * t] >= 0) + (mark[4 * t + 1] >= 0) + (mark[4 * t + 2] >= 0) + (mark[4 * t + 3] >= 0)


@inline
def face_square(xyz, vertex, face):
    """The square of twice the area of a face."""
    t, k = face & ~3, face & 3
    a, b, c = vertex[t + corner(k, 0)], vertex[t + corner(k, 1)], vertex[t + corner(k, 2)]
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    return (uy * vz - uz * vy) ** 2 + (uz * vx - ux * vz) ** 2 + (ux * vy - uy * vx) ** 2


@apart
def front_face(xyz, vertex, mark, t, tried):
    """The smallest face of cell t at the front that has not been tried (bits of ``tried``), or -1."""
    best, least = np.int64(-1), np.inf
    for k in range(4):
        face = np.int64(4 * t + k)
        if (tried >> k) & 1 == 0 and mark[face] >= 0:
            square = face_square(xyz, vertex, face)
            if best < 0 or square < least:
                best, least = face, square
    return best


@inline
def size_of_cell(solid, limits, t):
    """The wanted length at the barycenter of cell t."""
    x = y = z = 0.0
    r = solid.region[t]
    if limits.first[r] >= 0:
        for k in range(4):
            v = solid.vertex[4 * t + k]
            x, y, z = x + 0.25 * solid.xyz[v, 0], y + 0.25 * solid.xyz[v, 1], z + 0.25 * solid.xyz[v, 2]
    return wanted_in_space(limits, r, x, y, z)


@inline
def grade_cell(march, t, out):
    """Set the bucket of cell t."""
    solid, links, rule = march.solid, march.links, march.rule
    measure = 1.0
    if rule.order == SMALLEST_FACE:
        face = front_face(solid.xyz, solid.vertex, solid.mark, t, 0)
        square = face_square(solid.xyz, solid.vertex, face) if face >= 0 else 0.0
        measure = rule.scale / np.sqrt(square) if square > 0.0 else np.inf
    elif rule.order != OLDEST_FACE:
        h = size_of_cell(solid, march.limits, t)
        if rule.order == SMALLEST_SIZE:
            measure = rule.scale / (h * h)
        else:
            square, _, _ = cell_center(solid.xyz, solid.vertex, t, out)
            measure = square / (rule.scale * h * h)
    buckets = len(march.gates) // 2
    level = bucket_of(measure, buckets - 1) if measure < 1e300 else buckets - 2
    links[t, LEVEL] = LAST_LEVEL + 1 + level


@inline
def enqueue_cell(march, t, out):
    """Put an unfinished cell that has just got a face at the front in the queue."""
    if leaves_queue(march, t, march.rule.order == SMALLEST_FACE):
        grade_cell(march, t, out)
        push(march.links, march.gates, march.turn, t, False)


@inline
def accept_cell(march, diary, counts, face, reason):
    """Accept the cell ahead of a front face, and write it into the record."""
    solid, links, t = march.solid, march.links, face >> 2
    if links[t, STATUS] >= 0:
        unlink(links, march.gates, t, ACCEPTED)
    links[t, STATUS] = ACCEPTED
    row = counts[CELLS_DONE]
    diary.slots[row] = t
    if len(diary.log) > 0:
        for i in range(3):
            diary.log[row, i] = solid.vertex[4 * t + corner(face & 3, i)]
        diary.log[row, 3], diary.log[row, 4] = solid.vertex[face], reason
    counts[CELLS_DONE] += 1
    counts[reason] += 1


@inline
def face_enters(solid, face):
    """Let a face of an accepted cell enter the front, or leave it; whether it enters."""
    return crosses_front(solid.mark, face, solid.across[face], FRONT_MARK)


@inline
def accept_and_note(march, diary, counts, face, reason, many, depth):
    """Accept the cell ahead of a face; its other faces enter the front, or leave it.

    Cells behind those that enter are noted in ``later`` and put on the stack; returns how many there are in
    each then.
    """
    accept_cell(march, diary, counts, face, reason)
    solid, stack = march.solid, march.star.cells
    for k in range(4):
        g = np.int64((face & ~3) + k)
        if face_enters(solid, g):
            march.later[many] = solid.across[g] >> 2
            many += 1
            if depth < len(stack):
                stack[depth] = solid.across[g] >> 2
                depth += 1
    return many, depth


@inline
def next_to_close(march, depth):
    """Take a cell from the stack: the cell if it is unfinished with three faces at the front, else -1."""
    depth -= 1
    t = np.int64(march.star.cells[depth])
    if march.links[t, STATUS] == ACCEPTED or faces_at_front(march.solid.mark, t) < FACES_TO_CLOSE:
        t = np.int64(-1)
    return t, depth


@inline
def replace_cavity(march, counts, p, taken):
    """Replace the cavity by the star of p, whose cells are in no queue; the face of its cell on ``taken``."""
    solid, star, links = march.solid, march.star, march.links
    for i in range(star.sizes[STAR_CELLS]):
        t = np.int64(star.cells[i])
        if links[t, STATUS] >= 0:
            unlink(links, march.gates, t, WAITING)
        links[t, STATUS] = ACCEPTED
    commit_star(solid, star, p)
    counts[VERTICES_USED] += 1
    found = np.int64(-1)
    for i in range(star.sizes[STAR_WALLS]):
        t = np.int64(star.fresh[i])
        links[t, STATUS] = WAITING
        if star.walls[i] == taken:
            found = 4 * t + (star.walls[i] & 3)
    return found


@inline
def cell_to_queue(march, i, taken):
    """The cell of a new star on its wall i, if that is at the front and not ``taken``, else -1."""
    star = march.star
    t, k = np.int64(star.fresh[i]), star.walls[i] & 3
    return t if star.walls[i] != taken and march.solid.mark[4 * t + k] >= 0 else np.int64(-1)


@inline
def put_apex(march, counts, out, p, taken):
    """Replace the cavity by the star of p; its cells at the front are queued, but for wall ``taken``.

    Returns the face of the new cell on that wall.
    """
    found = replace_cavity(march, counts, p, taken)
    for i in range(march.star.sizes[STAR_WALLS]):
        t = cell_to_queue(march, i, taken)
        if t >= 0:
            enqueue_cell(march, t, out)
    return found


@inline
def set_all_unfinished(march):
    """Let all cells inside be unfinished, and those outside accepted."""
    solid = march.solid
    for t in range(solid.state[COUNT]):
        outside = solid.vertex[4 * t] < 0 or solid.region[t] < 0
        march.links[t, STATUS] = ACCEPTED if outside else WAITING


@inline
def shuffle_rows(state, rows):
    """Put entries in a random order."""
    for i in range(rows.shape[0] - 1, 0, -1):
        j = draw(state, i + 1)
        rows[i], rows[j] = rows[j], rows[i]


@inline
def cell_aside(march, counts, t):
    """Whether cell t, for none of whose faces an ideal point was possible, is now set aside."""
    aside = sent_last(march, t, False)
    counts[CELLS_ASIDE] += aside
    return aside
