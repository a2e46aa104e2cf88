"""The classical advancing front in space, cell by cell, compiled.

A step takes the first face abc of the queue, places the ideal point X ahead of it, and collects the vertices
of the front around it. They are tried in the order of their distances; the first one whose cell is valid and
round enough is taken.

           . - - - - .         M  the barycenter of abc
        .       X       .      X  the ideal point: at right angles to abc above its circumcenter,
      .   C           D   .       Xa = Xb = Xc = the wanted length
     a--------M-------b--c     C  a candidate: it is nearer than X, and is tried before it

Two searches are built in. *Barycenter*, as the source chapter tells it: the sphere is about M, its radius
some times the height sqrt(2/3) s of the regular tetrahedron with the edges s, and X is one of the candidates,
at its distance from M. *Ideal*: the sphere is about X, candidates come by their distance from X, and X after
all of them.

**It may stick.** In the plane there is a valid triangle ahead of every edge of the front. In space there may
be no valid cell: what is not meshed may be Schönhardt's polyhedron. So a face for which no candidate serves
is put aside, behind all others: at first for flatter cells and a point X half as high, then for any valid
cell with a vertex of the front, the roundest one first. A face without any is *stuck*. No vertex that was
refused will ever serve: what is not meshed only shrinks, and a vertex or an edge that touches a cell stays at
the front as long as the cell is not meshed. So a stuck face is looked at again only if there are new points.
If all faces are stuck, no cell on the vertices of the front may be made at any of them; that is what
NO_CELL means, and what is left is filled otherwise (`classical_rest`). Source: the source chapter, 12.3.1; R.
Löhner, P. Parikh, International Journal for Numerical Methods in Fluids 8 (1988) 1135-1149. Book: 3.5.
"""

from __future__ import annotations

from math import frexp
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.candidate_heap import put, take
from ...base.codes import DONE, MORE, ROOM
from ...base.jit import apart, inline, lean
from ...geometry.triangle_pairs import side
from ..advancing.digital_tree import gather
from ..advancing.journal import note_tried
from ..advancing.rows import (
    ALIVE,
    CELLS_MADE,
    VERTEX_COUNT,
    Waiting,
    entry_of,
    in_turn,
    is_current,
    next_in_turn,
    row_of_entry,
)  # fmt: skip
from ..volume.coarse import square_from_triangle
from .classical_ideal import apart_by, from_place, ideal_in_space, roundness_of, wanted_at
from .classical_open import close_cell, enter_loose, has_space
from .classical_signs import (
    CELL_CROSSED,
    CELL_FREE,
    blocking_face,
    cell_fault,
    meets_cell,
    set_cell,
)

__all__ = [
    "CANDIDATES_TRIED",
    "MARCH_COUNTS",
    "NO_CELL",
    "RECORDED",
    "STUCK_FACES",
    "SpaceWaiting",
    "march_in_space",
    "start_waiting_in_space",
]  # fmt: skip

NO_CELL = 8  # all faces are stuck
NOT_ROUND_ENOUGH, POINT_TOO_NEAR = 4, 5  # verdicts, besides those of `cell_fault`
SHORTEST_FIRST, OLDEST_FIRST = 1, 2  # orders; 0: the smallest wanted length first
ABOUT_BARYCENTER, ABOUT_X = range(2)
# Places in the counts; the first four are also the reasons for a choice.
WITH_X, WITH_NEAR, WITH_ASIDE, WITH_ANY, CANDIDATES_TRIED, RECORDED, STUCK_FACES, MARCH_COUNTS = range(8)
STUCK_NOW, STUCK_AT = range(2)  # places in what is held
OFF_VERTICES, OFF_FACES = 0.5, 0.22  # times the edges: no new point is nearer to a vertex or another face
ASIDE_ROUND, LOW_X, ASIDE_REACH = 0.1, 0.5, 1.5  # where a face was put aside once
PARTS_OF_OCTAVE = (
    64  # sizes and lengths in the same one of so many parts of an octave are equal for the order
)
FACES_APART = 2.0**32  # more than there are faces
LEVEL_APART = 2.0**50
MOST_LEVEL = 2  # faces that have been put aside so often take any valid cell
LATEST = 1e300  # X comes after all others


class SpaceWaiting(NamedTuple):
    """The faces that wait, the candidates of a step, and stuck faces."""

    turns: Waiting
    stuck: NDArray[np.int64]  # entries of the queue
    held: NDArray[np.int64]  # (2,) how many faces are stuck, and the vertices when one got stuck


@inline
def rank_in_space(front, choices, row):
    """The key of a face in the queue: how often it was put aside, what the order measures, then its age."""
    a, b, c = front.corner[row, 0], front.corner[row, 1], front.corner[row, 2]
    xyz, level = front.xyz, 0.0
    if choices.order != OLDEST_FIRST:
        if choices.order == SHORTEST_FIRST:
            measure = apart_by(xyz, a, b) + apart_by(xyz, b, c) + apart_by(xyz, c, a)
        else:
            measure = wanted_at(
                choices, (xyz[a, 0] + xyz[b, 0] + xyz[c, 0]) / 3.0, (xyz[a, 1] + xyz[b, 1] + xyz[c, 1]) / 3.0,
                (xyz[a, 2] + xyz[b, 2] + xyz[c, 2]) / 3.0,
            )  # fmt: skip
        part, exponent = frexp(measure)
        level = float(PARTS_OF_OCTAVE * exponent + int(2 * PARTS_OF_OCTAVE * part)) + 2048.0 * PARTS_OF_OCTAVE
    return front.level[row] * LEVEL_APART + level * FACES_APART + front.stamp[row]


@inline
def wait_in_space(front, choices, waiting, row):
    """Put a face of the front into the queue."""
    in_turn(waiting.turns, front.stamp, row, rank_in_space(front, choices, row))


@lean
def start_waiting_in_space(front, choices, waiting):
    """Put all faces of the front into the queue."""
    for row in range(len(front.corner)):
        if front.corner[row, 0] >= 0:
            wait_in_space(front, choices, waiting, np.int64(row))


@lean
def next_face(front, choices, waiting):
    """The row of the next face; -1 if there is none: all are stuck, or the front is empty."""
    held = waiting.held
    while True:
        row, _ = next_in_turn(waiting.turns, front.stamp)
        if row >= 0 or held[STUCK_NOW] == 0 or held[STUCK_AT] == front.state[VERTEX_COUNT]:
            return row
        held[STUCK_AT] = front.state[VERTEX_COUNT]  # new points: stuck faces are looked at again
        for i in range(held[STUCK_NOW]):
            if is_current(front.stamp, waiting.stuck[i]):
                wait_in_space(front, choices, waiting, row_of_entry(waiting.stuck[i]))
        held[STUCK_NOW] = 0


@apart
def fault_of_point(front, row, edge):
    """The verdict on the new point, the next unused vertex, ahead of a face; ``edge``: its ideal edges."""
    xyz, n = front.xyz, front.state[VERTEX_COUNT]
    x, y, z, least = xyz[n, 0], xyz[n, 1], xyz[n, 2], OFF_VERTICES * edge
    if not (abs(x) <= 1.0 and abs(y) <= 1.0 and abs(z) <= 1.0):
        return CELL_CROSSED
    set_cell(front, row, n)
    found = front.vertices.found
    window = (x - least, y - least, z - least, x + least, y + least, z + least)
    for i in range(gather(front.vertices, window)):
        if apart_by(xyz, np.int64(found[i]), n) < least:
            return POINT_TOO_NEAR
    found, corners, least = front.faces.found, front.corners, OFF_FACES * edge
    window = (x - least, y - least, z - least, x + least, y + least, z + least)
    for i in range(gather(front.faces, window)):
        other = np.int64(found[i])
        if other == row:
            continue
        for j in range(3):
            v = np.int64(front.corner[other, j])
            for k in range(3):
                corners[j, k] = xyz[v, k]
        if square_from_triangle(xyz[n], corners) < least * least:
            return POINT_TOO_NEAR
    found = front.threads.found
    for i in range(gather(front.threads, window)):
        for j in range(3):
            v = np.int64(front.ends[found[i], min(j, 1)])
            for k in range(3):
                corners[j, k] = xyz[v, k]
        if square_from_triangle(xyz[n], corners) < least * least:
            return POINT_TOO_NEAR
    return cell_fault(front)


@inline
def note_candidate(journal, counts, v, verdict):
    """Record a candidate and what was found about it."""
    note_tried(journal, counts[RECORDED], v, verdict)
    counts[RECORDED] += 1
    counts[CANDIDATES_TRIED] += 1


@lean
def collect(front, choices, waiting, row, edge, may):
    """Put the vertices in the sphere, and the ideal point if it ``may`` be, into the heap: how many."""
    xyz, n, found = front.xyz, front.state[VERTEX_COUNT], front.vertices.found
    heap, what, count = waiting.turns.measures, waiting.turns.candidates, 0
    a, b, c = np.int64(front.corner[row, 0]), np.int64(front.corner[row, 1]), np.int64(front.corner[row, 2])
    x, y, z = xyz[n, 0], xyz[n, 1], xyz[n, 2]
    radius = choices.reach * edge
    if choices.search == ABOUT_BARYCENTER:
        radius *= 0.816496580927726  # the height of the regular tetrahedron
        x = (xyz[a, 0] + xyz[b, 0] + xyz[c, 0]) / 3.0
        y = (xyz[a, 1] + xyz[b, 1] + xyz[c, 1]) / 3.0
        z = (xyz[a, 2] + xyz[b, 2] + xyz[c, 2]) / 3.0
    if front.level[row] > 0:
        radius *= ASIDE_REACH
    window = (x - radius, y - radius, z - radius, x + radius, y + radius, z + radius)
    for i in range(gather(front.vertices, window)):
        v = np.int64(found[i])
        away = from_place(xyz, v, x, y, z)
        if v != a and v != b and v != c and away <= radius:
            count = put(heap, what, count, away, v)
    if may:
        about_x = choices.search == ABOUT_X
        count = put(heap, what, count, LATEST if about_x else from_place(xyz, n, x, y, z), n)
    return count


@lean
def search_in_space(front, choices, waiting, journal, counts, row, edge):
    """The vertex that is taken among those within the radius of the search, -1 for none."""
    n = front.state[VERTEX_COUNT]
    least = choices.roundness if front.level[row] == 0 else min(ASIDE_ROUND, choices.roundness)
    count = collect(front, choices, waiting, row, edge, n < choices.most)
    while count > 0:
        v = waiting.turns.candidates[0]
        count = take(waiting.turns.measures, waiting.turns.candidates, count)
        if v == n:
            verdict = fault_of_point(front, row, edge)
        else:
            set_cell(front, row, v)
            flat = roundness_of(front.xyz, front.cell) < least
            # Most candidates are too flat, and then the exact tests only serve the record.
            verdict = CELL_FREE if flat and len(journal.tried) == 0 else cell_fault(front)
            if verdict == CELL_FREE and flat:
                verdict = NOT_ROUND_ENOUGH
        note_candidate(journal, counts, v if v != n else np.int64(-1), verdict)
        if verdict == CELL_FREE:
            return v
    return np.int64(-1)


@inline
def is_blocked(front, row):
    """Whether the face in a row, if any, is in the way of the cell."""
    corner = front.corner
    return row >= 0 and meets_cell(
        front.xyz, front.cell, np.int64(corner[row, 0]), np.int64(corner[row, 1]), np.int64(corner[row, 2])
    )


@apart
def gather_ring(front, turns, row, window):
    """Put the vertices ahead of a face in a window that were not looked at into the heap; return how many.

    The roundest cell comes first. The window is a center, and the radii of an inner and an outer cube.
    """
    xyz, vertices, cell, count = front.xyz, front.vertices, front.cell, 0
    x, y, z, before, radius = window
    everywhere = (x - radius, y - radius, z - radius, x + radius, y + radius, z + radius)
    for i in range(gather(vertices, everywhere)):
        v = np.int64(vertices.found[i])
        away = max(abs(xyz[v, 0] - x), abs(xyz[v, 1] - y), abs(xyz[v, 2] - z))
        if v < front.refused[row] or away <= before or away > radius:
            continue
        set_cell(front, row, v)
        if v != cell[0] and v != cell[1] and v != cell[2] and side(xyz, cell[0], cell[1], cell[2], v) > 0:
            count = put(turns.measures, turns.candidates, count, -roundness_of(xyz, cell), v)
    return count


@apart
def search_everywhere(front, waiting, journal, counts, row):
    """The first vertex with a valid cell, in wider and wider cubes about the barycenter, the roundest first.

    -1 for none. Vertices that are not ahead do not count, nor those that were refused before.
    """
    xyz = front.xyz
    a, b, c = np.int64(front.corner[row, 0]), np.int64(front.corner[row, 1]), np.int64(front.corner[row, 2])
    x = (xyz[a, 0] + xyz[b, 0] + xyz[c, 0]) / 3.0
    y = (xyz[a, 1] + xyz[b, 1] + xyz[c, 1]) / 3.0
    z = (xyz[a, 2] + xyz[b, 2] + xyz[c, 2]) / 3.0
    before, radius = -1.0, apart_by(xyz, a, b) + apart_by(xyz, b, c) + apart_by(xyz, c, a)
    one = two = np.int64(-1)  # faces that have been in the way are looked at first
    while True:
        count = gather_ring(front, waiting.turns, row, (x, y, z, before, radius))
        while count > 0:
            v = waiting.turns.candidates[0]
            count = take(waiting.turns.measures, waiting.turns.candidates, count)
            set_cell(front, row, v)
            verdict = CELL_CROSSED
            if not (is_blocked(front, one) or is_blocked(front, two)):
                verdict = cell_fault(front)
                if verdict == CELL_CROSSED:
                    one, two = blocking_face(front), one
            note_candidate(journal, counts, v, verdict)
            if verdict == CELL_FREE:
                return v
        if radius > 2.0:
            return np.int64(-1)
        before, radius = radius, 2.0 * radius


@lean
def choose_in_space(front, choices, waiting, journal, counts, row):
    """The vertex that is taken for a face, and the reason; -1 for none: the face must be put aside."""
    n, level = front.state[VERTEX_COUNT], front.level[row]
    if level == MOST_LEVEL:
        return search_everywhere(front, waiting, journal, counts, row), WITH_ANY
    edge, h = ideal_in_space(front, choices, row, 1.0 if level == 0 else LOW_X)
    if len(journal.log) > 0:
        k = front.state[CELLS_MADE]
        for j in range(3):
            journal.numbers[k, j] = front.xyz[n, j]
        journal.numbers[k, 3] = h
        journal.numbers[k, 4] = choices.reach * edge * (ASIDE_REACH if level > 0 else 1.0)
        if choices.search == ABOUT_BARYCENTER:
            journal.numbers[k, 4] *= 0.816496580927726
    if edge == 0.0:
        return np.int64(-1), WITH_NEAR
    v = search_in_space(front, choices, waiting, journal, counts, row, edge)
    if v == n:
        return v, WITH_X
    return v, WITH_NEAR if level == 0 else WITH_ASIDE


@inline
def put_aside(front, choices, waiting, counts, row):
    """Put a face for which no candidate serves behind all others, or among those that are stuck."""
    if front.level[row] < MOST_LEVEL:
        front.level[row] += 1
        wait_in_space(front, choices, waiting, row)
        return
    held = waiting.held
    if held[STUCK_NOW] == 0:
        held[STUCK_AT] = front.state[VERTEX_COUNT]
    front.refused[row] = front.state[VERTEX_COUNT]
    waiting.stuck[held[STUCK_NOW]] = entry_of(front.stamp, row)
    held[STUCK_NOW] += 1
    counts[STUCK_FACES] += 1


@lean
def march_in_space(front, choices, waiting, journal, counts, limit):
    """Look at up to ``limit`` faces; return how it ended: DONE, MORE, ROOM or NO_CELL."""
    state, wanted = front.state, len(journal.log) > 0
    for _ in range(limit):
        room = state[VERTEX_COUNT] + 4 < len(waiting.turns.candidates)
        room = room and waiting.turns.many[0] + waiting.held[STUCK_NOW] + 8 < len(waiting.stuck)
        if wanted:
            room = room and counts[RECORDED] + state[VERTEX_COUNT] + 8 < len(journal.tried)
            room = room and state[CELLS_MADE] + 2 < len(journal.log)
        if not (room and has_space(front)):
            return ROOM
        row = next_face(front, choices, waiting)
        if row < 0:
            return DONE if state[ALIVE] == 0 else NO_CELL
        before, k, n = counts[RECORDED], state[CELLS_MADE], state[VERTEX_COUNT]
        v, reason = choose_in_space(front, choices, waiting, journal, counts, row)
        if v < 0:
            put_aside(front, choices, waiting, counts, row)
            counts[RECORDED] = before  # the record is that of the cells
            continue
        if v == n:
            state[VERTEX_COUNT] += 1
            enter_loose(front, n)
        counts[reason] += 1
        if wanted:
            journal.log[k, 0], journal.log[k, 1] = reason, before
        for new in close_cell(front, row, v):
            if new >= 0:
                wait_in_space(front, choices, waiting, new)
    return MORE
