"""Recovery as a whole: segments, then triangles; with further points where nothing else helps."""

from __future__ import annotations

from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.progress import progress_bar
from .arrays import CellArrays
from .costs import EDGE, FACE
from .crossing import crossings
from .given import Given, Split, edge
from .held import grown_held, hold, new_held
from .journal import EVENT_ROOM
from .lookup import look_up
from .records import RESUMED, SEED, new_local
from .recovery import SPARE_SLOTS, STOP, recover_all, survey
from .signs import DISJOINT, meets
from .steiner import distance, insert_around, insert_between, insert_within, off_plane, on_plane, places

__all__ = ["MORE_EFFORT", "Recovery"]

SPARE_EDGES = 1000  # for which there is room from the beginning
CHUNK = 512  # goals per call of a kernel, so that Ctrl-C takes effect
# Largest cavity, shakes, nodes of one search, nodes for one goal. The first is for all goals, and so is the
# first of more, for what is left, before anything is split: points are in the way of others. Then there is
# more for each before it is split, and still more for what is missing or in parts in the end.
EFFORT = (7, 0, 100, 2000)
MORE_EFFORT = ((8, 3, 100, 2000), (8, 10, 200, 10_000), (9, 40, 300, 40_000))
EFFORT_OF_FLIPS = (6, 0, 100, 2000)
EFFORT_OF_PARTS = (8, 0, 100, 1000)  # the same, for parts of what was split
WIDER = 200  # cells that may be replaced beside those at a new point, so that all walls see it
MOST_OFF = 2.0**-49  # from a point to its facet; unit: the largest coordinate
FACES_ROOM = 64  # faces that a segment meets; more where that is not enough
BETWEEN = (0.5, 0.25, 0.75, 0.1, 0.9)  # where on a segment points may be if none of its crossings is possible
PART_ROUNDS = 8  # how often parts of a segment are split


class Recovery:
    """The state of a recovery in a complex.

    Parameters
    ----------
    cells : CellArrays
    given : Given
    budget : int
        How many points may be added.
    seed : int

    Attributes
    ----------
    level : int
        How much is tried for what is left; see ``MORE_EFFORT``.
    edges : int
        How many have been held at some time, at most.
    """

    def __init__(self, cells: CellArrays, given: Given, *, budget: int, seed: int):
        self.cells, self.given, self.budget, self.level = cells, given, budget, 0
        self.rounding = MOST_OFF * float(np.abs(cells.xyz[: cells.given]).max())
        self.held, self.edges = new_held(len(given.segment) + SPARE_EDGES), len(given.segment)
        self.local = new_local()
        self.splits: list[Split] = []
        self.added = 0  # points, also those that were released since
        self.crossed = np.zeros(4, dtype=np.int64)
        self.rows, self.where = np.empty((FACES_ROOM, 6), dtype=np.int32), np.empty(FACES_ROOM)
        self.lost_edges: set[tuple[int, int]] = set()
        self.lost: list[int] = []
        cells.state[SEED] = (seed * 7919 + 12345) & 0x7FFFFFFF
        cells.reserve(cells.size + min(budget, SPARE_EDGES), cells.slots + max(1000, cells.slots // 4))

    def run(self, *, progress: bool = False) -> None:
        """Recover all segments, then all triangles."""
        goals = np.zeros((len(self.given.segment), 4), dtype=np.int32)
        goals[:, :2] = self.given.segment
        with progress_bar(progress, " segments", total=len(goals)) as bar:
            left = self._recover(EDGE, goals, (EFFORT, MORE_EFFORT[0]), bar)
        self._split_segments([edge(*row) for row in goals[left != 0, :2].tolist()])
        self._triangles(progress)

    def again(self, *, progress: bool = False) -> None:
        """Try more for what is missing."""
        waiting = sorted(self.lost_edges & self.given.edges()) if self.lost_edges else []
        self.lost_edges.clear()
        self._split_segments(waiting)
        self._triangles(progress)

    def _triangles(self, progress: bool) -> None:
        tried: set[int] = set()
        while True:
            every = np.flatnonzero(self.given.alive[: self.given.count])
            lacking = np.zeros(len(every), dtype=bool)
            if self.lost_edges:
                lacking[:] = [self._lacks_edge(t) for t in every.tolist()]
            rows = every[~lacking]
            with progress_bar(progress, " triangles", total=len(rows)) as bar:
                left = self._recover(FACE, self.given.goals(rows), (EFFORT, MORE_EFFORT[self.level]), bar)
            waiting = rows[left != 0].tolist()
            self.lost = [*waiting, *every[lacking].tolist()]
            again = [t for t in waiting if t not in tried]
            if not again or not self._split_triangles(again, tried):
                return

    def _lacks_edge(self, t: int) -> bool:
        a, b, c = self.given.corner[t].tolist()
        return bool(self.lost_edges & {edge(a, b), edge(b, c), edge(c, a)})

    # ------------------------------------------------------------------ refills

    def _room(self) -> None:
        cells = self.cells
        cells.reserve(cells.size, cells.slots + 4 * SPARE_SLOTS)
        cells.reserve_events()

    def _recover(self, kind: int, goals: NDArray[np.int32], efforts, bar: Any) -> NDArray[np.int64]:
        """Recover many goals in rounds; how many faces are in the way of each in the end."""
        left = np.zeros(len(goals), dtype=np.int64)
        rest = np.flatnonzero(~look_up(self.cells.solid(), self.held, kind, goals))
        for i in range(0, len(rest), CHUNK):
            rows = rest[i : i + CHUNK]
            ways = left[rows]
            survey(self.cells.solid(), self.held, self.cells.found, kind, goals[rows], ways, self.crossed)
            left[rows] = ways
        bar.update(int((left == 0).sum()))
        for options in efforts:
            waiting = np.flatnonzero(left != 0)
            for i in range(0, len(waiting), CHUNK):
                rows = waiting[i : i + CHUNK]
                left[rows] = self._refill(kind, goals[rows], left[rows], options)
                bar.update(int((left[rows] == 0).sum()))
        return left

    def _refill(
        self, kind: int, goals: NDArray[np.int32], left: NDArray[np.int64], options
    ) -> NDArray[np.int64]:
        self._refill_until(kind, goals, left, np.array((*options, 0), dtype=np.int64))
        return left

    def _refill_until(
        self, kind: int, goals: NDArray[np.int32], left: NDArray[np.int64], options: NDArray[np.int64]
    ) -> int:
        """Recover goals in order; the first that is left if that is to stop it, or how many there are."""
        self.local.size[RESUMED] = first = 0
        while first < len(goals):
            cells, rest = self.cells, slice(first, None)
            first += recover_all(
                cells.solid(), self.held, self.local, cells.found, kind, goals[rest], left[rest], options
            )
            self._room()
            if options[STOP] and not self.local.size[RESUMED]:
                break
        return first

    # ------------------------------------------------------------------ points

    def _split_segments(self, waiting: list[tuple[int, int]]) -> None:
        """Split these segments, then what comes of them, until all are there.

        Those that came of one split are split only after all others have been tried: in the meantime refills
        may find them. After some generations, or when the budget is used up, what is left is lost.
        """
        for generation in range(PART_ROUNDS):
            following: list[tuple[int, int]] = []
            goals, i = np.zeros((len(waiting), 4), dtype=np.int32), 0
            goals[:, :2] = np.array(waiting, dtype=np.int32).reshape(-1, 2)
            left = np.ones(len(waiting), dtype=np.int64)
            first = MORE_EFFORT[self.level] if self.level else EFFORT_OF_FLIPS
            effort = first if generation == 0 else EFFORT_OF_PARTS
            options = np.array((*effort, 1), dtype=np.int64)
            while True:
                i += self._refill_until(EDGE, goals[i:], left[i:], options)
                if i == len(waiting):
                    break
                a, b = waiting[i]
                i += 1
                p = self._insert_on_segment(a, b) if generation < PART_ROUNDS - 1 else -1
                if p < 0:
                    self.lost_edges.add(edge(a, b))
                    continue
                split = self.given.split_segment(a, b, p)
                self._split(split)
                following += split.edges()
            if not following:
                return
            waiting = following

    def _split_triangles(self, rows: list[int], tried: set[int]) -> bool:
        """Split these triangles; whether that was possible for one."""
        before = len(self.splits)
        for t in rows:
            tried.add(t)
            if not self.given.alive[t]:
                continue
            p = self._insert_on_triangle(t)
            if p >= 0:
                split = self.given.split_triangle(t, p)
                self._split(split)
                self._split_segments(list(split.inner))
        return len(self.splits) > before

    def _split(self, split: Split) -> None:
        self.splits.append(split)
        self.added += 1
        self.edges += len(split.edges())
        self.held = grown_held(self.held, self.edges)

    def _next_vertex(self) -> bool:
        cells = self.cells
        if self.added >= self.budget:
            return False
        spare = len(cells.found.faces) // 64 + 4 * SPARE_SLOTS + 4 * WIDER
        cells.reserve(cells.size + 1, cells.slots + spare)
        cells.reserve_events(20 * cells.slots + EVENT_ROOM)
        return True

    def _place(self, row: NDArray[np.float64]) -> int:
        """Write the next vertex; it counts when it is inserted."""
        p = self.cells.size
        self.cells.xyz[p] = row
        return p

    def _insert_on_segment(self, a: int, b: int) -> int:
        """Insert a point where the segment crosses a face or an edge; -1 for none.

        Points in the middle of all crossings are tried first: of two parts with half of the crossings each,
        both are found more easily than what is left behind the first crossing. Where flat cells see none of
        them, as they are in planes up to rounding, points between crossings are tried.
        """
        if not self._next_vertex():
            return -1
        cells, goal = self.cells, np.array([a, b, 0, 0], dtype=np.int32)
        count = places(cells.solid(), goal, cells.found, self.rows, self.where)
        while count < 0:
            self.rows, self.where = np.empty((2 * len(self.rows), 6), np.int32), np.empty(2 * len(self.rows))
            count = places(cells.solid(), goal, cells.found, self.rows, self.where)
        rows = zip(self.where[:count].tolist(), self.rows[:count].tolist(), strict=True)
        found = sorted(row for row in rows if 0.0 < row[0] < 1.0)
        middle = found[len(found) // 2][0] if found else 0.0
        found.sort(key=lambda row: abs(row[0] - middle))
        start, end = cells.xyz[a], cells.xyz[b]
        for more in (0, WIDER):
            for where, (face, *corners) in found:
                p = self._place(start + where * (end - start))
                if self._insert_at(face, corners[:3], corners[3:], p, more):
                    cells.size += 1
                    cells.name_point((a, b, -1), count)
                    return p
        ends = [0.0, *sorted(where for where, _ in found), 1.0]
        between = sorted(((u + v) / 2 for u, v in pairwise(ends)), key=lambda where: abs(where - 0.5))
        for where in dict.fromkeys((*between, *BETWEEN)):
            p = self._place(start + where * (end - start))
            if insert_within(cells.solid(), self.held, cells.found, goal, p, WIDER):
                cells.size += 1
                cells.name_point((a, b, -1), count)
                return p
        return -1

    def _insert_at(self, face: int, corners: list[int], crossed: list[int], p: int, more: int) -> bool:
        """Insert vertex p at the crossed edge, or between the two cells at the face, or around an edge of it.

        Where the segment passes by an edge more closely than coordinates are rounded, the two cells may not
        see p, and the cells around the edge do.
        """
        cells, solid = self.cells, self.cells.solid()
        if crossed[0] >= 0:
            return bool(insert_around(solid, self.held, cells.found, crossed[0], crossed[1], p, more))
        if insert_between(solid, self.held, cells.found, face, p, more):
            return True
        u, v, w = corners
        by_distance = sorted(
            ((u, v), (v, w), (w, u)), key=lambda ends: distance(cells.xyz[p], *cells.xyz[list(ends)])
        )
        return any(insert_around(solid, self.held, cells.found, *ends, p, more) for ends in by_distance[:2])

    def _insert_on_triangle(self, t: int) -> int:
        """Insert a point of the triangle where an edge crosses it, the first possible; -1 for none."""
        if not self._next_vertex():
            return -1
        cells, goal = self.cells, self.given.goals(np.array([t]))[0]
        count = crossings(cells.solid(), FACE, goal, cells.found)
        crossing = set()
        for face in cells.found.faces[: max(count, 0)].tolist():
            u, v, w = (int(cells.vertex[(face & ~3) + (face + i) % 4]) for i in (1, 2, 3))
            crossing |= {
                edge(p, q)
                for p, q in ((u, v), (v, w), (w, u))
                if meets(cells.xyz, p, q, goal[0], goal[1], goal[2]) != DISJOINT
            }
        for more, (u, v) in product((0, WIDER), sorted(crossing)):
            where = on_plane(cells.xyz, u, v, *goal[:3].tolist())
            p = self._place(cells.xyz[u] + where * (cells.xyz[v] - cells.xyz[u]))
            if not 0 < where < 1 or off_plane(cells.xyz[p], *cells.xyz[goal[:3]]) > self.rounding:
                continue  # a point that is off its facet would be no part of it
            if insert_around(cells.solid(), self.held, cells.found, u, v, p, more):
                cells.size += 1
                cells.name_point(tuple(goal[:3].tolist()), count)
                return p
        return -1

    def missing(self) -> NDArray[np.int32]:
        """The given segments that are not there, neither whole nor in parts: each part is looked for."""
        given = self.given.segment
        if not self.splits and not self.lost_edges:
            return given[:0]
        chains = [self.given.parts(*row) for row in given.tolist()]
        owner = np.repeat(np.arange(len(given)), [len(chain) - 1 for chain in chains])
        goals = np.zeros((len(owner), 4), dtype=np.int32)
        goals[:, :2] = [ends for chain in chains for ends in pairwise(chain)]
        left, counts = np.zeros(len(goals), dtype=np.int64), np.zeros(4, dtype=np.int64)
        survey(self.cells.solid(), self.held, self.cells.found, EDGE, goals, left, counts)
        return given[np.unique(owner[left != 0])]

    def missing_triangles(self) -> NDArray[np.int32]:
        """The given triangles that are not there, neither whole nor in parts; chance may have made some."""
        rows = np.array([t for t in self.lost if self.given.alive[t]], dtype=np.int64)
        left, counts = np.zeros(len(rows), dtype=np.int64), np.zeros(4, dtype=np.int64)
        survey(self.cells.solid(), self.held, self.cells.found, FACE, self.given.goals(rows), left, counts)
        return np.unique(self.given.root[rows[left != 0]])

    def drop(self, split: Split) -> None:
        """Join what was split, in the tables."""
        for u, v in split.edges():
            hold(self.held, u, v, 0)
        self.given.undo(split)
        if split.segment is not None:
            hold(self.held, *split.segment, 1)
