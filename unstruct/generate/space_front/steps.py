"""The advancing front over the tetrahedralization of what is not meshed yet, compiled. Book: 3.5."""

from __future__ import annotations

import numpy as np

from ...base.codes import DONE, MORE, ROOM
from ...base.jit import inline, kernel, lean
from ...connect.insertion.engine import COUNT
from ...connect.spatial.cavity import corner
from ...connect.spatial.costs import badness
from ...connect.spatial.opening import FACES_OPEN, STAR_FIRST, STAR_SEEDS, STAR_WALLS
from ...connect.spatial.star import room_for_star, search_star
from ..rebay.queue import ACCEPTED, STATUS, next_slot
from ..volume_points.limits import REGULAR
from ..volume_points.measures import cell_center, encroaches_face, face_center
from . import ledger as book
from .placing import ideal_apex

FITS_HERE, NOT_SEEN, TOO_FLAT_HERE, TOO_NEAR_HERE, NO_SLOTS = range(5)


@inline
def judge_star(march, face, p, clearance, out):
    """Whether the star of p is good enough: an outcome, and the nearest vertex that is too near."""
    solid, star, xyz = march.solid, march.star, march.solid.xyz
    nearest, near, outcome = np.int64(-1), clearance * clearance, FITS_HERE
    for i in range(star.sizes[STAR_WALLS]):
        wall = np.int64(star.walls[i])
        t, k = wall & ~3, wall & 3
        for j in range(3):
            v = solid.vertex[t + corner(k, j)]
            square = 0.0
            for m in range(3):
                square += (xyz[v, m] - xyz[p, m]) ** 2
            if square < near:
                nearest, near = np.int64(v), square
    if nearest >= 0:
        return TOO_NEAR_HERE, nearest
    for i in range(star.sizes[STAR_WALLS]):
        wall = np.int64(star.walls[i])
        if solid.mark[wall] >= 0 and wall != face:
            t, k = wall & ~3, wall & 3
            a, b = solid.vertex[t + corner(k, 0)], solid.vertex[t + corner(k, 1)]
            square = face_center(xyz, a, b, solid.vertex[t + corner(k, 2)], out)
            if encroaches_face(xyz, out, square, p, march.rule.flat):
                return TOO_FLAT_HERE, nearest
    return FITS_HERE, nearest


@inline
def judge_ahead(march, face, p, clearance, out):
    """As `judge_star`, for the vertices and front faces of the cell ahead alone: most points fail at these."""
    solid, xyz, t = march.solid, march.solid.xyz, face & ~3
    nearest, near = np.int64(-1), clearance * clearance
    for k in range(4):
        v, square = solid.vertex[t + k], 0.0
        for m in range(3):
            square += (xyz[v, m] - xyz[p, m]) ** 2
        if square < near:
            nearest, near = np.int64(v), square
    if nearest >= 0:
        return TOO_NEAR_HERE, nearest
    for k in range(4):
        if solid.mark[t + k] >= 0 and t + k != face:
            a = solid.vertex[t + corner(k, 0)]
            square = face_center(xyz, a, solid.vertex[t + corner(k, 1)], solid.vertex[t + corner(k, 2)], out)
            height = 0.0
            for j in range(3):
                height += (xyz[p, j] - xyz[a, j]) * out[3 + j]
            if height <= 0.0:
                return NOT_SEEN, nearest
            if encroaches_face(xyz, out, square, p, march.rule.flat):
                return TOO_FLAT_HERE, nearest
    return FITS_HERE, nearest


@inline
def try_apex(march, counts, face, p, clearance, out):
    """Search and judge the star of vertex p from the cell ahead of a face: an outcome and a vertex."""
    star = march.star
    outcome, near = judge_ahead(march, face, p, clearance, out)
    if outcome != FITS_HERE:
        counts[15 + outcome] += 1
        return outcome, near
    counts[19] += 1
    star.cells[0] = face >> 2
    star.sizes[STAR_SEEDS], star.sizes[STAR_FIRST], star.sizes[FACES_OPEN] = 1, 1, 0
    if not search_star(march.solid, star, march.edges, p, -1):
        counts[22]+=1
        return NOT_SEEN, np.int64(-1)
    counts[20] += star.sizes[0]
    counts[21] += star.sizes[1]
    outcome, near = judge_star(march, face, p, clearance, out)
    if outcome == FITS_HERE and not room_for_star(march.solid, star):
        return NO_SLOTS, near
    return outcome, near


@inline
def write_row(diary, row, p, xyz, h, square, near):
    """Write what was looked at into a row of the record."""
    if len(diary.log) > 0:
        for j in range(3):
            diary.numbers[row, j] = xyz[p, j]
        diary.numbers[row, 3], diary.numbers[row, 4] = h, np.sqrt(square)
        diary.log[row, 5] = near


@inline
def is_small(march, t, out):
    """Whether the circumradius of cell t is small enough for it to be accepted as it is."""
    solid = march.solid
    square, _, _ = cell_center(solid.xyz, solid.vertex, t, out)
    f = march.rule.accept * REGULAR * book.size_of_cell(solid, march.limits, t)
    return square < f * f


@inline
def end_step(march, diary, counts, face, reason, out):
    """Accept the cell ahead of a face, then all small cells that have enough faces at the front."""
    solid, star = march.solid, march.star
    stack, later, depth, many = star.cells, march.later, 0, 0
    while face >= 0:
        book.accept_cell(march, diary, counts, face, reason)
        t = face >> 2
        for k in range(4):
            g = np.int64(4 * t + k)
            if book.enters(solid, g):
                o = np.int64(solid.across[g] >> 2)
                later[many] = o
                many += 1
                if depth < len(stack):
                    stack[depth] = o
                    depth += 1
        face = np.int64(-1)
        while depth > 0 and face < 0:
            depth -= 1
            o = np.int64(stack[depth])
            if march.links[o, STATUS] != ACCEPTED and book.faces_at_front(solid.mark, o) >= march.rule.closing:
                if is_small(march, o, out):
                    face, reason = book.front_face(solid, o, 0), book.CLOSED_CELL
    for i in range(many):
        if march.links[later[i], STATUS] != ACCEPTED:
            book.enqueue_cell(march, np.int64(later[i]), out)


@inline
def choose_cell(march, counts, face, out):
    """Choose what to accept for a face of the front: the face, the reason (-1: none), near, h, R^2, room."""
    solid, xyz, t = march.solid, march.solid.xyz, face >> 2
    p, apex = counts[book.VERTICES_USED], np.int64(solid.vertex[face])
    square, _, _ = cell_center(xyz, solid.vertex, t, out)
    fx, fy, fz = out[0], out[1], out[2]
    k, q = face & 3, 0.0
    a, b, c = (
        solid.vertex[4 * t + corner(k, 0)], solid.vertex[4 * t + corner(k, 1)], solid.vertex[4 * t + corner(k, 2)]
    )
    if square < np.inf:
        face_center(xyz, a, b, c, out)
        q = (fx - xyz[a, 0]) * out[3] + (fy - xyz[a, 1]) * out[4] + (fz - xyz[a, 2]) * out[5]
    else:
        q = np.inf
    h, side, good = ideal_apex(march, face, q, p, out)
    f = REGULAR * h
    none = np.int64(-1)
    if square < (march.rule.accept * f) ** 2:
        return face, book.SMALL_CELL, none, h, square, True
    if square < np.inf:
        away = (xyz[p, 0] - fx) ** 2 + (xyz[p, 1] - fy) ** 2 + (xyz[p, 2] - fz) ** 2
        if away >= square:
            return face, book.EMPTY_SPHERE, none, h, square, True
    if not good:
        counts[book.POINTS_NEEDLE] += 1
        return face, -1, none, h, square, True
    outcome, near = try_apex(march, counts, face, p, march.rule.room * min(h, side), out)
    if outcome == NO_SLOTS:
        return face, -1, near, h, square, False
    if outcome == FITS_HERE:
        return book.put_apex(march, counts, out, p, face), book.NEW_APEX, near, h, square, True
    if near == apex:
        return face, book.NEAR_APEX, near, h, square, True
    counts[
        book.POINTS_NEAR
        if outcome == TOO_NEAR_HERE
        else book.POINTS_ENCROACH
        if outcome == TOO_FLAT_HERE
        else book.POINTS_OUTSIDE
    ] += 1
    return face, -1, near, h, square, True


@inline
def last_resort(march, counts, face, out):
    """The circumcenter of a cell that was set aside, if it is possible; else the cell as it is."""
    solid, xyz, t = march.solid, march.solid.xyz, face >> 2
    p = counts[book.VERTICES_USED]
    square, _, six = cell_center(xyz, solid.vertex, t, out)
    h = book.size_of_cell(solid, march.limits, t)
    if square < np.inf and square > (march.rule.accept * REGULAR * h) ** 2:
        for j in range(3):
            xyz[p, j] = out[j]
        outcome, _ = try_apex(march, counts, face, p, march.rule.room * h, out)
        if outcome == NO_SLOTS:
            return face, -1
        if outcome == FITS_HERE:
            found = book.put_apex(march, counts, out, p, face)
            return found, book.CENTER_APEX
    return face, book.FORCED_CELL


@kernel
def advance_in_space(march, diary, counts, out, limit):
    """Take up to ``limit`` steps; return how it ended: DONE, MORE, or ROOM."""
    solid = march.solid
    for _ in range(limit):
        if counts[book.VERTICES_USED] + 1 >= solid.xyz.shape[0]:
            return ROOM
        t = np.int64(next_slot(march.links, march.gates, march.turn))
        if t < 0:
            return DONE
        tried, reason, face, near, h, square = 0, -1, np.int64(-1), np.int64(-1), 0.0, 0.0
        room = True
        while reason < 0:
            one = book.front_face(solid, t, tried)
            if one < 0:
                break
            tried |= 1 << (one & 3)
            face, reason, near, h, square, room = choose_cell(march, counts, one, out)
            if not room:
                return ROOM
        if reason < 0 and not book.set_aside(march, counts, t):
            face, reason = last_resort(march, counts, book.front_face(solid, t, 0), out)
            if reason < 0:
                return ROOM
        if reason >= 0:
            write_row(diary, counts[book.CELLS_MADE], counts[book.VERTICES_USED] - (reason == book.NEW_APEX), solid.xyz, h, square, near)
            end_step(march, diary, counts, face, reason, out)
    return MORE


@kernel
def start_in_space(march, cells, out):
    """Put the cells along the surface into the queue, in a random order."""
    book.set_all_unfinished(march)
    book.shuffle(march.solid.state, cells, cells.shape[0])
    for i in range(cells.shape[0]):
        book.enqueue_cell(march, np.int64(cells[i]), out)
