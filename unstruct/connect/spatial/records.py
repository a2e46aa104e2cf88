"""Records for kernels on a complex of tetrahedra: its arrays, a small cavity to be refilled, and scratch.

As in `connect.planar.records`, a record is a tuple of named arrays, made again when an array had to grow.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..insertion.stars import Cavity

__all__ = [
    "CAVITY_KEY",
    "CELLS_ROOM",
    "COST_KIND",
    "EVENT",
    "GUARD_COUNT",
    "HASH",
    "LAST_EVENT",
    "LOCALS",
    "LOCAL_ROOM",
    "NEW_CELLS",
    "NODES",
    "NOTED",
    "NUMBERED",
    "OLD_CELLS",
    "RESUMED",
    "SEED",
    "SHAKES_LEFT",
    "TARGET",
    "TETS_ROOM",
    "WAY_COUNT",
    "WORK_DONE",
    "Held",
    "Local",
    "Solid",
    "new_local",
    "new_search",
]  # fmt: skip

LOCAL_ROOM = 12  # vertices of a cavity that is refilled: beyond this, searches explode
CELLS_ROOM = 128  # its cells
TETS_ROOM = 96  # tetrahedra in a refill; 12 points have no triangulation with more than 55
MEMO = 1 << 15  # exact signs that are remembered
FAILURES = 1 << 13  # cavities that are remembered, since they could not be refilled at lower cost
SEED = 6  # entry of the state of a `Solid`: the generator of random numbers
NOTED = 7  # entry of the state of a `Solid`: how much of its journal is written
LAST_EVENT = 8  # entry of the state of a `Solid`: where its last event begins

# Entries of ``size`` in a `Local`.
LOCALS = 0  # how many vertices the cavity has
OLD_CELLS = 1  # how many cells
NEW_CELLS = 2  # how many tetrahedra the best refill has
GUARD_COUNT = 3  # how many edges must stay
COST_KIND = 4  # what a refill costs
TARGET = 5  # three entries: the vertices of the segment or triangle that is sought
NODES = 8  # nodes that the last search has visited
NUMBERED = 10  # how many local numbers there are: corners, then those vertices of the target that are none
EVENT = 11  # what a refill is called in the record
WAY_COUNT = 12  # how many faces are in the way of the target
SHAKES_LEFT = 13  # of the present goal
RESUMED = 14  # 1 if the search for the present goal has been interrupted
WORK_DONE = 15  # steps since the last look at whether the user wants to stop
CAVITY_KEY = 16  # of the cavity and of what is sought in it, see `cavity.failed`
HASH = 9  # of the cells that are there, to recognize a refill that changes nothing


class Solid(NamedTuple):
    """The arrays of a `SpatialComplex`, as they are described there."""

    xyz: NDArray[np.float64]
    vertex: NDArray[np.int32]
    across: NDArray[np.int32]
    mark: NDArray[np.int32]
    region: NDArray[np.int32]
    stamp: NDArray[np.int32]
    free: NDArray[np.int32]
    at: NDArray[np.int32]
    state: NDArray[np.int64]
    journal: NDArray[np.int32]  # the record; empty if there is none


class Held(NamedTuple):
    """A hash table of edges that must not be destroyed: keys (-1: empty), and whether each is held now."""

    key: NDArray[np.int64]
    value: NDArray[np.int8]


class Local(NamedTuple):
    """A cavity of at most LOCAL_ROOM vertices, with local numbers, and the state of a search for refills.

    A face with local vertices x, y, z, the least first, has the number ``(x n + y) n + z``; it is seen from
    the tetrahedron that it belongs to. Tables indexed by it have LOCAL_ROOM^3 entries. Four bits are enough
    for a local vertex, twelve for a number: see `costs.packed_face`.
    """

    cells: NDArray[np.int32]
    label: NDArray[np.int32]  # the vertex of the complex that each local vertex is
    sign: NDArray[np.int8]  # orientations of four local vertices, filled when they are needed
    cost: NDArray[np.float64]  # of faces, filled when they are needed; negative: unknown
    edge: NDArray[np.int8]  # of pairs: 1 on the boundary; 2, 4: it crosses the target or not; 8: of a cell
    code: NDArray[np.uint8]  # of faces: open, closed
    beyond: NDArray[
        np.int64
    ]  # of boundary faces: what is across; while cells are made, of others: where they are
    number: NDArray[np.int32]  # of faces: the mark that they carry
    front: NDArray[np.int32]  # packed faces that were open at some time on the way to the present node
    chosen: NDArray[np.int32]  # for each depth: x, y, z, apex, which faces it opened, front, candidates, next
    apex: NDArray[np.int32]  # for each depth the candidates, the best first
    gain: NDArray[np.float64]  # what they cost
    total: NDArray[np.float64]  # cost of what is chosen above each depth
    best: NDArray[np.int32]  # the tetrahedra of the best refill
    # Sets of vertices, as bits: of faces those on the inner side (negative: unknown); of pairs a n + b those
    # with which the oriented face is open, or closed, and the cost of the face is known, not 0, or NEVER.
    fits: NDArray[np.int32]
    ajar: NDArray[np.int32]
    shut: NDArray[np.int32]
    judged: NDArray[np.int32]
    costly: NDArray[np.int32]
    barred: NDArray[np.int32]
    guard: NDArray[np.int32]  # local ends of edges that must stay
    memo: NDArray[np.int32]  # exact signs of vertices, see `remembered_side`
    goal: NDArray[np.int64]  # local numbers of the target
    size: NDArray[np.int64]
    failures: NDArray[np.int64]  # keys of cavities, each at its remainder


def new_local() -> Local:
    """Arrays for any cavity of LOCAL_ROOM vertices."""
    n, cube, square = LOCAL_ROOM, LOCAL_ROOM**3, LOCAL_ROOM**2
    return Local(
        np.empty(CELLS_ROOM, dtype=np.int32), np.empty(n + 3, dtype=np.int32),
        np.empty((n + 3) ** 4, dtype=np.int8), np.empty(cube), np.empty(square, dtype=np.int8),
        np.empty(cube, dtype=np.uint8), np.empty(cube, dtype=np.int64), np.empty(cube, dtype=np.int32),
        np.empty(4 * (CELLS_ROOM + TETS_ROOM), dtype=np.int32), np.empty((TETS_ROOM, 8), dtype=np.int32),
        np.empty((TETS_ROOM + 1, n), dtype=np.int32), np.empty((TETS_ROOM + 1, n)), np.empty(TETS_ROOM + 1),
        np.empty((TETS_ROOM, 4), dtype=np.int32), np.empty(cube, dtype=np.int32),
        np.zeros(square, dtype=np.int32), np.zeros(square, dtype=np.int32), np.zeros(square, dtype=np.int32),
        np.zeros(square, dtype=np.int32), np.zeros(square, dtype=np.int32),
        np.empty((square, 2), dtype=np.int32),
        np.full((MEMO, 5), -1, dtype=np.int32), np.zeros(3, dtype=np.int64), np.zeros(24, dtype=np.int64),
        np.zeros(FAILURES, dtype=np.int64),
    )  # fmt: skip


def new_search(slots: int) -> Cavity:
    """Room for a search through this many cells and all their faces."""
    return Cavity(
        np.empty(slots + 8, dtype=np.int32),
        np.empty(4 * slots + 32, dtype=np.int32),
        np.zeros(4, dtype=np.int64),
    )
