"""Cells are exchanged for others that fill the same space, if their faces fit."""

from __future__ import annotations

import numpy as np

from ...base.jit import kernel, lean
from ..insertion.engine import FREE, STAMP
from .cavity import new_slot
from .journal import close_event, old_cells, open_event
from .signs import in_order

__all__ = ["exchange"]

# Columns of the table of faces.
FIRST, SECOND = 3, 4  # where the face is in the new cells, as 4 i + k
BEYOND, CARRIED = 5, 6  # what is across on the border, -2 inside; the mark
INNER = -2


@lean
def _row_of(faces, table, u, v, w):
    """The place in the table of the face with these vertices, or where it would be, and them in order."""
    _, u, v, w, _ = in_order(-1, u, v, w)
    room = table.shape[0]
    place = (u * 40503 + v * 30011 + w * 65599) & (room - 1)
    while table[place] >= 0:
        i = table[place]
        if faces[i, 0] == u and faces[i, 1] == v and faces[i, 2] == w:
            break
        place = (place + 1) & (room - 1)
    return place, u, v, w


@lean
def _enter(faces, table, tets):
    """List the faces of the new cells; how many there are, -1 if one is there more than twice."""
    count = 0
    for i in range(tets.shape[0]):
        for k in range(4):
            place, u, v, w = _row_of(
                faces, table, tets[i, (k + 1) & 3], tets[i, (k + 2) & 3], tets[i, (k + 3) & 3]
            )
            f = table[place]
            if f < 0:
                table[place] = count
                faces[count, 0], faces[count, 1], faces[count, 2] = u, v, w
                faces[count, FIRST], faces[count, SECOND] = 4 * i + k, -1
                faces[count, BEYOND], faces[count, CARRIED] = INNER, -1
                count += 1
            elif faces[f, SECOND] < 0:
                faces[f, SECOND] = 4 * i + k
            else:
                return -1
    return count


@lean
def _keep(solid, old, faces, table, p):
    """Note the border of the old cells, and the marks inside that do not have p; False if one is lacking."""
    solid.state[STAMP] += 1
    inside = 2 * solid.state[STAMP]
    for i in range(old.shape[0]):
        solid.stamp[old[i]] = inside
    for i in range(old.shape[0]):
        t = 4 * old[i]
        for k in range(4):
            over = solid.across[t + k]
            u, v, w = (
                solid.vertex[t + (k + 1 & 3)],
                solid.vertex[t + (k + 2 & 3)],
                solid.vertex[t + (k + 3 & 3)],
            )
            border = over < 0 or solid.stamp[over >> 2] != inside
            if not border and (solid.mark[t + k] < 0 or u == p or v == p or w == p):
                continue
            place, _, _, _ = _row_of(faces, table, u, v, w)
            f = table[place]
            if f < 0:
                return False
            faces[f, CARRIED] = solid.mark[t + k]
            if border:
                faces[f, BEYOND] = over
    return True


@lean
def _link(solid, slots, faces, count):
    """Join the new cells with each other and with those beyond the border, and mark their faces."""
    for f in range(count):
        first, second, mark = faces[f, FIRST], faces[f, SECOND], faces[f, CARRIED]
        place = 4 * slots[first >> 2] + (first & 3)
        over = faces[f, BEYOND]
        if over == INNER:
            over = 4 * slots[second >> 2] + (second & 3)
        solid.across[place], solid.mark[place] = over, mark
        if over >= 0:
            solid.across[over], solid.mark[over] = place, mark


@kernel
def exchange(solid, old, tets, restored, event):
    """Replace cells by others that fill the same space; False, and no change, if faces do not fit.

    Parameters
    ----------
    solid : Solid
        With room for the new cells, and for the event in its record.
    old : (k,) int32
        Cells; the new ones get the region of the first.
    tets : (m, 4) int32
        The vertices of the new cells.
    restored : (r, 4) int32
        Vertices of faces that are marked from now on, and their marks.
    event : (6,) int32
        What is written to the record; last the point that goes.
    """
    room = 64
    while room < 12 * tets.shape[0]:
        room *= 2
    table, faces = np.full(room, -1, dtype=np.int32), np.empty((4 * tets.shape[0], 7), dtype=np.int32)
    count = _enter(faces, table, tets)
    if count < 0 or not _keep(solid, old, faces, table, event[5]):
        return False
    for f in range(count):
        if (faces[f, BEYOND] == INNER) == (faces[f, SECOND] < 0):
            return False
    for i in range(restored.shape[0]):
        place, _, _, _ = _row_of(faces, table, restored[i, 0], restored[i, 1], restored[i, 2])
        if table[place] >= 0:
            faces[table[place], CARRIED] = restored[i, 3]
    noting = solid.journal.shape[0] > 0
    if noting:
        open_event(solid, event[0], event[1], event[2], event[3], event[4], event[5])
        old_cells(solid, old, old.shape[0])
    region, slots = solid.region[old[0]], np.empty(tets.shape[0], dtype=np.int32)
    for i in range(old.shape[0]):
        solid.vertex[4 * old[i]] = -2
        solid.free[solid.state[FREE]] = old[i]
        solid.state[FREE] += 1
    for i in range(tets.shape[0]):
        t = slots[i] = new_slot(solid)
        solid.region[t] = region
        for k in range(4):
            solid.vertex[4 * t + k] = tets[i, k]
            solid.at[tets[i, k]] = t
    if noting:
        close_event(solid, slots, slots.shape[0])
    _link(solid, slots, faces, count)
    return True
