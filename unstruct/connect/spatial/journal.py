"""The record of a recovery: a flat array of events, written by the kernels that change cells, if it has room.

An event begins with EVENT_HEAD numbers: its kind, three for the goal (a segment ends with -1), how many faces
are in the way of the goal before it, a point, and how many cells are removed and made. Five numbers for each
of these follow: its slot and its vertices.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.jit import apart, kernel, lean
from .records import EVENT, LAST_EVENT, NOTED, OLD_CELLS, TARGET, WAY_COUNT

__all__ = [
    "EVENT_FEWER",
    "EVENT_FOUND",
    "EVENT_GIVEN_UP",
    "EVENT_MOVED",
    "EVENT_POINT",
    "EVENT_REFILL",
    "EVENT_RELEASED",
    "EVENT_REMOVED",
    "EVENT_ROOM",
    "EVENT_SHAKE",
    "close_event",
    "new_journal",
    "note",
    "note_refill",
    "old_cells",
    "open_event",
    "replay_recovery",
    "unpacked",
]

EVENT_HEAD = 8
EVENT_ROOM = EVENT_HEAD + 5 * 256  # of one refill: CELLS_ROOM and TETS_ROOM cells
EVENT_KINDS = ("refill", "shake", "found", "given up", "point", "fewer", "released", "moved", "removed")
(
    EVENT_REFILL,
    EVENT_SHAKE,
    EVENT_FOUND,
    EVENT_GIVEN_UP,
    EVENT_POINT,
    EVENT_FEWER,
    EVENT_RELEASED,
    EVENT_MOVED,
    EVENT_REMOVED,
) = range(len(EVENT_KINDS))


def new_journal() -> NDArray[np.int32]:
    """Room for a first few events."""
    return np.zeros(32 * EVENT_ROOM, dtype=np.int32)


@lean
def open_event(solid, kind, a, b, c, faces, point):
    """Write the beginning of an event; it counts when it is closed."""
    at, journal = solid.state[NOTED], solid.journal
    journal[at], journal[at + 1], journal[at + 2], journal[at + 3] = kind, a, b, c
    journal[at + 4], journal[at + 5], journal[at + 6], journal[at + 7] = faces, point, 0, 0


@apart
def _append(solid, cells, count, entry):
    """Append cells to the event that is open; ``entry`` of its header counts them."""
    at, journal = solid.state[NOTED], solid.journal
    row = at + EVENT_HEAD + 5 * (journal[at + 6] + journal[at + 7])
    for i in range(count):
        t = cells[i]
        journal[row] = t
        for k in range(4):
            journal[row + 1 + k] = solid.vertex[4 * t + k]
        row += 5
    journal[at + entry] = count


@apart
def note_refill(solid, r):
    """Begin the event of a refill with what is sought, and with the cells that will be removed."""
    size = r.size
    a, point = size[TARGET], -1
    if size[EVENT] == EVENT_FEWER:
        point = a
    elif size[EVENT] == EVENT_REMOVED:
        a, point = -1, a
    open_event(solid, size[EVENT], a, size[TARGET + 1], size[TARGET + 2], size[WAY_COUNT], point)
    _append(solid, r.cells, r.size[OLD_CELLS], 6)


@kernel
def old_cells(solid, cells, count):
    """Write the cells that the open event removes, before they are."""
    _append(solid, cells, count, 6)


@kernel
def close_event(solid, cells, count):
    """Write the cells that the open event has made; from now on it counts."""
    _append(solid, cells, count, 7)
    at = solid.state[NOTED]
    solid.state[LAST_EVENT] = at
    solid.state[NOTED] = at + EVENT_HEAD + 5 * (solid.journal[at + 6] + solid.journal[at + 7])


@kernel
def note(solid, kind, a, b, c, faces, point):
    """Write an event that changes no cells, if there is a record."""
    if solid.journal.shape[0] > 0:
        open_event(solid, kind, a, b, c, faces, point)
        solid.state[NOTED] += EVENT_HEAD


def unpacked(journal: NDArray[np.int32], end: int) -> dict[str, NDArray]:
    """The events as named arrays, see `SpatialComplex.history`."""
    heads, removed, made, at = [], [], [], 0
    while at < end:
        heads.append(at)
        body = at + EVENT_HEAD
        middle, at = body + 5 * int(journal[at + 6]), body + 5 * int(journal[at + 6] + journal[at + 7])
        removed.append(journal[body:middle:5])
        made.append(journal[middle:at].reshape(-1, 5))
    head = journal[np.array(heads, dtype=np.int64)[:, None] + np.arange(EVENT_HEAD)]
    none = np.empty(0, dtype=np.int32)
    return {
        "kind": np.array([EVENT_KINDS[k] for k in head[:, 0]], dtype="U8"),
        "goal": head[:, 1:4].copy(),
        "faces": head[:, 4].copy(),
        "point": head[:, 5].copy(),
        "removed": np.concatenate([none, *removed]),
        "removed_end": np.cumsum(head[:, 6]),
        "made": np.concatenate([none.reshape(0, 5), *made]),
        "made_end": np.cumsum(head[:, 7]),
    }


def replay_recovery(steps: dict[str, NDArray], count: int | None = None) -> NDArray[np.int32]:
    """The cells after the first events of a recorded recovery.

    Parameters
    ----------
    steps : dict of str to ndarray
        The ``steps`` of a mesh that ``constrained_delaunay(domain, history=True)`` has made in space.
    count : int, optional
        How many events; by default all.

    Returns
    -------
    ndarray of int32, shape (slots, 4)
        The vertices of each cell, rows of ``steps["points"]``; -1 where a slot is free.

    Raises
    ------
    InputError
        For a record of something else, and if there are not as many events.
    """
    if steps is None or not {"start", "removed_end", "made_end"} <= set(steps):
        raise InputError("this is no record of a recovery: give mesh.steps of a mesh with history=True")
    events = len(steps["kind"])
    count = events if count is None else count
    if not 0 <= count <= events:
        raise InputError(f"count must be from 0 to {events}, the number of events, not {count}")
    slots = max(len(steps["start"]), 1 + int(steps["made"][:, 0].max(initial=-1)))
    cells = np.full((slots, 4), -1, dtype=np.int32)
    cells[: len(steps["start"])] = steps["start"]
    first_removed = first_made = 0
    for k in range(count):
        removed, made = int(steps["removed_end"][k]), int(steps["made_end"][k])
        cells[steps["removed"][first_removed:removed]] = -1
        rows = steps["made"][first_made:made]
        cells[rows[:, 0]] = rows[:, 1:]
        first_removed, first_made = removed, made
    return cells
