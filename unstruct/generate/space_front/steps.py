"""The advancing front over the tetrahedralization of what is not meshed yet, compiled.

Cells inside the body are *accepted*, that is, finished, or not. The *front* consists of all faces between
the two kinds and of all faces of facets that still have an unfinished side. Faces of the front are marked as
those of facets are, so that no cavity crosses them: what has been accepted stays.

A step takes a face ABC of the front, with the unfinished cell t ahead of it. It accepts t, or inserts the
ideal point X among what is not finished and accepts ABCX.

What is not meshed has a valid triangulation at all times: to accept a cell takes one out of it, and a star
of X (`connect.spatial.star`) is made only if all its cells are positive by exact signs. So there is always a
valid cell ahead of each face, though it may be flat. Book: 3.5.
"""

from __future__ import annotations

import numpy as np

from ...base.codes import DONE, MORE, ROOM
from ...base.jit import apart, inline, kernel
from ...connect.spatial.cavity import corner
from ...connect.spatial.opening import FACES_OPEN, STAR_FIRST, STAR_SEEDS, STAR_WALLS
from ...connect.spatial.star import room_for_star, search_star
from ..rebay.queue import ACCEPTED, STATUS, next_slot
from ..volume_points.limits import REGULAR
from ..volume_points.measures import cell_center, encroaches_face, face_center
from . import ledger as book
from .placing import BY_CALLER, LONGEST_LATERAL, ideal_apex

CALLER = 8  # how a call ended: a point is wanted from a function of the caller
# Outcomes of a judgment. All but the first and the last are counted, in the order of `ledger`.
APEX_FITS, NOT_SEEN, TOO_FLAT_ANGLE, VERTEX_NEAR, TOO_LOW, LACKS_SLOTS = range(6)
NO_REASON = -1  # in place of a reason
LEAST_VOLUME = 0.05  # six volumes of a cell with a new point, over the cube of the mean edge of its face
APEX_LENS = 1.0  # a face is encroached upon where it is seen under 120 degrees, as `encroaches_face` has it


@inline
def _square_to(xyz, v, p):
    return (xyz[v, 0] - xyz[p, 0]) ** 2 + (xyz[v, 1] - xyz[p, 1]) ** 2 + (xyz[v, 2] - xyz[p, 2]) ** 2


@apart
def judge_ahead(xyz, vertex, mark, face, p, clearance, out):
    """Whether p may be an apex, by the cell ahead of a face alone: an outcome and the vertex too near, or -1.

    Most points that fail do so here, without the search for a star.
    """
    t, k = face & ~3, face & 3
    a, b, c = vertex[t + corner(k, 0)], vertex[t + corner(k, 1)], vertex[t + corner(k, 2)]
    mean = (_square_to(xyz, a, b) + _square_to(xyz, b, c) + _square_to(xyz, c, a)) / 3.0
    face_center(xyz, a, b, c, out)
    height = 0.0
    for j in range(3):
        height += (xyz[p, j] - xyz[a, j]) * out[3 + j]
    double = np.sqrt(book.face_square(xyz, vertex, face))
    if not double * height >= LEAST_VOLUME * mean * np.sqrt(mean):
        return TOO_LOW, np.int64(-1)
    nearest, near = np.int64(-1), clearance * clearance
    for i in range(4):
        square = _square_to(xyz, vertex[t + i], p)
        if square < near:
            nearest, near = np.int64(vertex[t + i]), square
    if nearest >= 0:
        return VERTEX_NEAR, nearest
    for i in range(4):
        if mark[t + i] >= 0 and i != k:
            a = vertex[t + corner(i, 0)]
            square = face_center(xyz, a, vertex[t + corner(i, 1)], vertex[t + corner(i, 2)], out)
            height = 0.0
            for j in range(3):
                height += (xyz[p, j] - xyz[a, j]) * out[3 + j]
            if height <= 0.0:
                return NOT_SEEN, nearest
            if encroaches_face(xyz, out, square, p, APEX_LENS):
                return TOO_FLAT_ANGLE, nearest
    return APEX_FITS, nearest


@apart
def judge_star(solid, star, face, p, clearance, out):
    """Whether the star that was found for p may be made: an outcome, and the vertex too near, or -1."""
    xyz, vertex = solid.xyz, solid.vertex
    nearest, near = np.int64(-1), clearance * clearance
    for i in range(star.sizes[STAR_WALLS]):
        wall = np.int64(star.walls[i])
        for j in range(4):
            v = vertex[(wall & ~3) + j]
            square = _square_to(xyz, v, p)
            if j != wall & 3 and square < near:
                nearest, near = np.int64(v), square
    if nearest >= 0:
        return VERTEX_NEAR, nearest
    for i in range(star.sizes[STAR_WALLS]):
        wall = np.int64(star.walls[i])
        if solid.mark[wall] >= 0 and wall != face:
            t, k = wall & ~3, wall & 3
            a, b, c = vertex[t + corner(k, 0)], vertex[t + corner(k, 1)], vertex[t + corner(k, 2)]
            if encroaches_face(xyz, out, face_center(xyz, a, b, c, out), p, APEX_LENS):
                return TOO_FLAT_ANGLE, nearest
    return APEX_FITS if room_for_star(solid, star) else LACKS_SLOTS, nearest


@inline
def try_apex(march, face, p, clearance, out):
    """Search and judge the star of vertex p from the cell ahead of a face: an outcome and a vertex."""
    solid, star = march.solid, march.star
    outcome, near = judge_ahead(solid.xyz, solid.vertex, solid.mark, face, p, clearance, out)
    if outcome != APEX_FITS:
        return outcome, near
    star.cells[0] = face >> 2
    star.sizes[STAR_SEEDS], star.sizes[STAR_FIRST], star.sizes[FACES_OPEN] = 1, 1, 0
    if not search_star(solid, star, march.edges, p, -1):
        return NOT_SEEN, near
    return judge_star(solid, star, face, p, clearance, out)


@inline
def choose_ahead(march, counts, face, answer, out):
    """What to accept for a face of the front without a new point, once the ideal point is known.

    Returns the reason (`NO_REASON` if the point is to be tried), h, the lateral edge, and R^2 of
    the cell ahead. The ideal point is vertex ``counts[VERTICES_USED]``.
    """
    solid, xyz, t = march.solid, march.solid.xyz, face >> 2
    p, k = counts[book.VERTICES_USED], face & 3
    square, _, _ = cell_center(xyz, solid.vertex, t, out)
    fx, fy, fz = out[0], out[1], out[2]
    a, b = solid.vertex[4 * t + corner(k, 0)], solid.vertex[4 * t + corner(k, 1)]
    high = np.inf
    if square < np.inf and face_center(xyz, a, b, solid.vertex[4 * t + corner(k, 2)], out) < np.inf:
        high = (fx - xyz[a, 0]) * out[3] + (fy - xyz[a, 1]) * out[4] + (fz - xyz[a, 2]) * out[5]
    out[20] = high
    h, side, close = ideal_apex(solid, march.limits, march.rule.placement, face, p, out)
    if march.rule.placement == BY_CALLER:
        close = not answer[0] == answer[0]
        if not close:
            xyz[p, 0], xyz[p, 1], xyz[p, 2] = answer[0], answer[1], answer[2]
    reason = NO_REASON
    if square < (book.CELL_ACCEPT * REGULAR * min(h, side)) ** 2:
        reason = book.SMALL_CELL
    elif close:
        reason = book.AT_DIHEDRAL
    elif (xyz[p, 0] - fx) ** 2 + (xyz[p, 1] - fy) ** 2 + (xyz[p, 2] - fz) ** 2 >= square:
        reason = book.EMPTY_SPHERE
    return reason, h, side, square


@inline
def last_resort(march, counts, face, out):
    """Write the circumcenter of a cell that was set aside as the next vertex, and judge it.

    Returns an outcome, h and R^2. A small cell needs no point.
    """
    solid, xyz, p = march.solid, march.solid.xyz, counts[book.VERTICES_USED]
    square, _, _ = cell_center(xyz, solid.vertex, face >> 2, out)
    h = book.size_of_cell(solid, march.limits, face >> 2)
    if not (square < np.inf and square > (book.CELL_ACCEPT * REGULAR * h) ** 2):
        return VERTEX_NEAR, h, square
    xyz[p, 0], xyz[p, 1], xyz[p, 2] = out[0], out[1], out[2]
    outcome, _ = try_apex(march, face, p, book.APEX_ROOM * h, out)
    return outcome, h, square


@inline
def is_small(march, face, out):
    """Whether the circumradius of the cell ahead of a face is small enough for it to be accepted as it is."""
    solid, t, k = march.solid, face & ~3, face & 3
    xyz, a, b = solid.xyz, solid.vertex[t + corner(k, 0)], solid.vertex[t + corner(k, 1)]
    c = solid.vertex[t + corner(k, 2)]
    mean = np.sqrt((_square_to(xyz, a, b) + _square_to(xyz, b, c) + _square_to(xyz, c, a)) / 3.0)
    square, _, _ = cell_center(xyz, solid.vertex, face >> 2, out)
    h = min(book.size_of_cell(solid, march.limits, face >> 2), LONGEST_LATERAL * mean)
    return square < (book.CELL_ACCEPT * REGULAR * h) ** 2


@inline
def end_step(march, diary, counts, face, reason, out):
    """Accept the cell ahead of a face, then all small cells that have three or four faces at the front.

    Cells that the front has reached are queued at the end, in the order in which it has reached them.
    """
    solid, depth, many = march.solid, 0, 0
    while face >= 0:
        many, depth = book.accept_and_note(march, diary, counts, face, reason, many, depth)
        face = np.int64(-1)
        while depth > 0 and face < 0:
            t, depth = book.next_to_close(march, depth)
            if t >= 0:
                g = book.front_face(solid.xyz, solid.vertex, solid.mark, t, 0)
                if is_small(march, g, out):
                    face, reason = g, book.CLOSED_CELL
    for i in range(many):
        if march.links[march.later[i], STATUS] != ACCEPTED:
            book.enqueue_cell(march, np.int64(march.later[i]), out)


@inline
def count_failed(counts, failed):
    """Count the outcomes of a step, eight bits of ``failed`` each."""
    for outcome in range(NOT_SEEN, LACKS_SLOTS):
        counts[book.CELLS_ASIDE + outcome] += failed >> 8 * outcome & 255


@inline
def write_row(diary, row, xyz, p, h, square, near):
    """Write what was looked at into a row of the record; p is -1 if there is no ideal point."""
    if len(diary.log) > 0:
        for j in range(3):
            diary.numbers[row, j] = xyz[p, j] if p >= 0 else np.nan
        diary.numbers[row, 3], diary.numbers[row, 4] = h, np.sqrt(square)
        diary.log[row, 5] = near


@kernel
def advance_in_space(march, diary, counts, ask, answer, out, limit):
    """Take up to ``limit`` steps; return how it ended: DONE, MORE, ROOM, or CALLER.

    CALLER wants the ideal point for face ``ask[0]`` in ``answer`` (x, y, z; NaN for the apex ahead).
    """
    solid = march.solid
    xyz, vertex, mark = solid.xyz, solid.vertex, solid.mark
    for _ in range(limit):
        p = counts[book.VERTICES_USED]
        t = np.int64(next_slot(march.links, march.gates, march.turn))
        if t < 0:
            return DONE
        if p >= xyz.shape[0]:
            return ROOM
        tried = ask[1] if ask[0] >= 0 else 0
        reason, face, near, h, square, failed = NO_REASON, np.int64(-1), np.int64(-1), 0.0, 0.0, 0
        while reason == NO_REASON:
            answered = ask[0] >= 0
            face = np.int64(ask[0]) if answered else book.front_face(xyz, vertex, mark, t, tried)
            if face < 0:
                break
            if march.rule.placement == BY_CALLER and not answered:
                ask[0], ask[1] = face, tried
                return CALLER
            reason, h, side, square = choose_ahead(march, counts, face, answer, out)
            near = np.int64(-1)
            if reason == NO_REASON:
                outcome, near = try_apex(march, face, p, book.APEX_ROOM * min(h, side), out)
                if outcome == LACKS_SLOTS:
                    return ROOM
                if outcome == APEX_FITS:
                    face, reason = book.put_apex(march, counts, out, p, face), book.NEW_APEX
                elif near == vertex[face]:
                    reason = book.NEAR_APEX
                else:
                    failed += 1 << 8 * outcome
            ask[0] = -1
            tried |= 1 << (face & 3)
        row = p
        if reason == NO_REASON and not book.cell_aside(march, counts, t):
            face = book.front_face(xyz, vertex, mark, t, 0)
            outcome, h, square = last_resort(march, counts, face, out)
            if outcome == LACKS_SLOTS:
                return ROOM
            near, reason, row = np.int64(-1), book.FORCED_CELL, np.int64(-1)
            if outcome == APEX_FITS:
                face, reason, row = book.put_apex(march, counts, out, p, face), book.CENTER_APEX, p
        count_failed(counts, failed)
        if reason != NO_REASON:
            write_row(diary, counts[book.CELLS_DONE], xyz, row, h, square, near)
            end_step(march, diary, counts, face, reason, out)
    return MORE


@kernel
def start_in_space(march, cells, out):
    """Put the cells along the surface into the queue.

    In a random order: the first points have stars that reach across the whole body, n in all if they come in
    the order of the surface; by chance they halve it again and again.
    """
    book.set_all_unfinished(march)
    book.shuffle_rows(march.solid.state, cells)
    for i in range(cells.shape[0]):
        book.enqueue_cell(march, np.int64(cells[i]), out)
