"""RemeshRun: the rounds of remeshing, and the account of them."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...connect.insertion.halfedges import UNUSED
from ...connect.surface.complex import SurfaceComplex
from ...connect.surface.halfedges import SEAM_CURVES, SURFACE_SLOTS, SURFACE_VERTICES
from ...geometry.edge_vectors import lengths
from ...geometry.embedded import meeting_pairs
from ...geometry.support import Support
from ...geometry.support_walk import WAITING_BOXES, strictly
from ...geometry.triangle_tree import TriangleTree
from ...sizing.field import SizeField
from .faceting import faceting
from .flips import count_degrees, flip_pass
from .lengths import LONG_SHARE, collapse_pass, split_pass
from .measuring import FLAT_TRIANGLE, TOO_FAR_OFF, crease_pass, faults_pass, grade_pass, lower_pass
from .missed import farther_from
from .moves import move_pass, put_pass, settle_pass
from .near_sheets import HELPED, total_area
from .own_crossings import OwnCrossings
from .seams import follow_sizes
from .shapes import COLLAPSES, FLIPS_DONE, SPLITS_DONE, RemeshWork
from .sharpest import mend_pass, sharpest_pass, thin_pass

__all__ = ["ALLOWED", "KEPT_TO", "RemeshRun"]

Array = NDArray[np.float64]
ALLOWED = 0.01  # the distance from the given surface that is allowed, in sizes, if nothing is said
MOST_ALLOWED = 0.15  # the same where the given triangles themselves are coarser than the size
COARSE_TIMES = 1.7  # how many times as far as the given triangles are off a smooth surface is allowed
KEPT_TO = 0.85  # the part of it that is kept to at the places that are looked at
REMESH_ROUNDS = 6  # of splits, collapses, flips and moves; more, if the size had to be lowered
MEASURED_ROUNDS = (0, 1, 3)  # rounds after which distances are measured
FLIP_SWEEPS = 3
LOWERED_GROWTH = 0.25  # of sizes that are lowered, by distance
LEAST_SHARE = 0.125  # the part of the wanted size below which it is not lowered
RELAXED = 1.3  # by how much a lowered size may rise again from one measurement to the next
TARGETS = (30.0, 35.0, 38.0, 40.0)  # degrees below which triangles are sharp, one after the other
SHARP_SWEEPS = 12  # over triangles that are sharp, for each of them
CREEPING_SWEEPS = 5  # where the surface leaves no room, vertices creep on and on, by less and less
CREEPING_SHARE = 0.01  # of all triangles: as many are improved in sweep after sweep, and it is left at that
LEAST_TARGET = 35.0  # the same where triangles were split because they were too far from the surface
LOOSE = 2.25  # the slack of rounds: the end mends what is left too far
SETTLED = 0.002  # changes per vertex in a round after which no other follows
MENDS = 5
NEAR_CROSSING = 4.0  # sizes from crossings in which triangles are looked at again
SEPARATIONS = 3  # times that sizes are lowered where creases are near each other
UNTANGLED = 4  # times that sizes are halved where triangles cross, as long as that helps
NOT_NEARER = 2.0**-50  # in scaled coordinates, up to 1: what is allowed at least, for vertices are rounded
PLACES_AT_ONCE = 1 << 17  # places that a kernel looks at in one call
GROWN = 0.5  # share of spare vertices by which arrays grow


class RemeshRun:
    """Remeshing of one surface.

    Parameters
    ----------
    support : Support
    complex : SurfaceComplex
        In the scaled coordinates of the support.
    size : SizeField
    deviation : float, optional
    budget : int
        The largest number of vertices.
    """

    def __init__(
        self, support: Support, complex: SurfaceComplex, size: SizeField, deviation: float | None, budget: int
    ):
        self.support, self.complex, self.size, self.budget = support, complex, size, budget
        self.deviation, self.held = deviation, strictly(support.held)
        self.counts = np.zeros(6, dtype=np.int64)
        self.x, self.place = np.zeros((4, 3)), np.zeros(6)
        self.stack = np.empty(WAITING_BOXES, dtype=np.int64)
        self.slack = 1.0
        self.faceting = faceting(support)
        self.short = False  # whether the budget did not suffice
        self.off = np.zeros(0, dtype=np.bool_)  # vertices that could not be moved onto the surface
        self.own = OwnCrossings(support)
        self.crossed = np.zeros((0, 3, 3))  # the corners of triangles that crossed before sizes were lowered
        self.seams = bool((complex.sheets.curve >= SEAM_CURVES).any())
        self.refresh()

    @property
    def work(self) -> RemeshWork:
        """The record for kernels: of the arrays as they are now."""
        sheets = self.complex.sheets
        return RemeshWork(
            sheets,
            self.held,
            self.x,
            np.zeros(3),
            np.zeros(3),
            self.place,
            self.stack,
            self.counts,
            self.slack,
        )

    def asked(self, vertices: NDArray[np.int64]) -> Array:
        """The size that was asked for at some vertices, in scaled coordinates."""
        factor = self.support.factor
        if self.size.constant is not None:
            return np.full(len(vertices), self.size.constant * factor)
        return self.size(self.complex.sheets.xyz[vertices] / factor) * factor

    def refresh(self) -> None:
        """Ask for the size at all vertices."""
        s = self.complex.sheets
        used = np.flatnonzero(s.at[: self.used] >= 0)
        asked = self.asked(used)
        s.size[used] = np.minimum(asked, np.maximum(s.cap[used], LEAST_SHARE * asked))
        if self.deviation is None:
            coarse = COARSE_TIMES * self.faceting[s.near[used]]
            more = np.minimum(0.5 * ALLOWED * asked + coarse, MOST_ALLOWED * asked)
            s.allowed[used] = np.where(coarse > ALLOWED * asked, more, KEPT_TO * ALLOWED * asked)
        else:
            s.allowed[used] = KEPT_TO * self.deviation * self.support.factor
        s.allowed[used] = np.maximum(s.allowed[used], NOT_NEARER)

    def split(self) -> None:
        """Split edges until all are short enough, or the budget is used up."""
        if self.seams:
            follow_sizes(self.complex, LONG_SHARE, self.budget - self.used)
        start = 0
        while start >= 0:
            room = self.room()
            if room == 0:
                return
            self.complex.grow(room, 2 * room)
            start = int(split_pass(self.work, start, min(room, PLACES_AT_ONCE)))

    def room(self) -> int:
        """For how many vertices arrays should grow; notes if there may be no more."""
        room = min(int(GROWN * self.used) + 1, self.budget - self.used)
        self.short = self.short or room <= 0
        return max(room, 0)

    @property
    def used(self) -> int:
        """The number of vertices, counting free ones between others."""
        return int(self.complex.sheets.state[SURFACE_VERTICES])

    def sweep(self, step: Any, count: int, *arguments: Any) -> int:
        """Call a kernel for parts of ``count`` places, one after the other: Ctrl-C has a chance between."""
        work, total = self.work, 0
        for start in range(0, count, PLACES_AT_ONCE):
            total += step(work, start, min(start + PLACES_AT_ONCE, count), *arguments)
        return int(total)

    @property
    def slots(self) -> int:
        """The number of slots of triangles."""
        return int(self.complex.sheets.state[SURFACE_SLOTS])

    def flip(self, by_degree: bool) -> None:
        """Flip edges until no flip helps."""
        if by_degree:
            self.sweep(count_degrees, self.used, True)
        for _ in range(FLIP_SWEEPS):
            if self.sweep(flip_pass, 3 * self.slots, by_degree) == 0:
                break
        if by_degree:
            self.sweep(count_degrees, self.used, False)

    def collapse(self) -> None:
        """Collapse short edges."""
        self.sweep(collapse_pass, 3 * self.slots)

    def move(self) -> None:
        """Move all vertices once."""
        self.sweep(move_pass, self.used)

    def thin(self) -> None:
        """No vertices that need not be within strips far thinner than the size."""
        before = self.counts[COLLAPSES]
        while self.sweep(thin_pass, 3 * self.slots):
            self.flip(False)
        if self.counts[COLLAPSES] > before:
            self.round()
            self.finish()

    def measure(self) -> bool:
        """Lower sizes where the mesh is too far from the surface; whether there is such a place."""
        s = self.complex.sheets
        bound = np.full(len(s.at), np.inf)
        self.sweep(lower_pass, self.slots, bound)
        s.cap[:] = np.minimum(bound, RELAXED * s.cap)
        return self.grade()

    def separate(self) -> bool:
        """Lower sizes where creases are near each other; whether there is such a place."""
        s = self.complex.sheets
        bound = np.full(len(s.at), np.inf)
        self.sweep(crease_pass, self.slots, bound, LEAST_SHARE)
        if not (bound < s.cap).any():
            return False
        s.cap[:] = np.minimum(bound, s.cap)
        return self.grade()

    def grade(self) -> bool:
        """Let lowered sizes grow slowly; whether there are any."""
        s = self.complex.sheets
        if not np.isfinite(s.cap[: self.used]).any():
            return False
        while self.sweep(grade_pass, 3 * self.slots, LOWERED_GROWTH):
            pass
        self.refresh()
        return bool((s.size[: self.used] == s.cap[: self.used]).any())

    def round(self) -> None:
        """One round."""
        self.split()
        self.collapse()
        self.flip(True)
        self.move()
        self.move()
        self.refresh()
        self.flip(False)

    def begin(self) -> None:
        """What is small or flat in the given triangles goes first."""
        self.flip(False)
        self.collapse()
        self.flip(False)

    def finish(self, around: Array | None = None) -> None:
        """Moves and flips alone, and then whatever makes the sharpest triangles less sharp.

        If there are points ``around`` (k, 3), only triangles near them are looked at in the end.
        """
        for _ in range(4):
            self.move()
            self.flip(False)
        tried = np.zeros(len(self.complex.sheets.name), dtype=np.bool_)
        if around is not None:
            tried[: self.slots] = ~self.near(around)
        for degrees in TARGETS:  # what has not helped a triangle does not for the next target either
            self.sharpen(degrees, tried)
        self.refresh()

    def near(self, places: Array) -> NDArray[np.bool_]:
        """The slots of triangles near some points, in sizes."""
        s = self.complex.sheets
        rows = s.vertex[: 3 * self.slots].reshape(-1, 3)
        middle = s.xyz[np.maximum(rows, 0)].mean(axis=1)
        which, _ = TriangleTree(places[:, None].repeat(3, axis=1)).nearest(middle)
        reach = NEAR_CROSSING * self.asked(np.maximum(rows[:, 0], 0).astype(np.int64))
        return (rows[:, 0] != UNUSED) & (lengths(middle - places[which]) <= reach)

    def sharpen(self, degrees: float, tried: NDArray[np.bool_] | None = None) -> None:
        """Change triangles with angles of fewer degrees; not those that were ``tried`` already."""
        target = float(np.sin(np.deg2rad(degrees))) ** 2
        if tried is None:
            tried = np.zeros(len(self.complex.sheets.name), dtype=np.bool_)
        done: list[int] = []
        for _ in range(SHARP_SWEEPS):
            done.append(self.sweep(sharpest_pass, self.slots, target, tried))
            creeping = len(done) >= CREEPING_SWEEPS and done[-1] > 0.5 * done[1]
            if done[-1] == 0 or (creeping and done[-1] > CREEPING_SHARE * self.slots):
                return

    def faults(self) -> NDArray[np.int8]:
        """What is wrong with each slot of triangles."""
        fault = np.zeros(self.slots, dtype=np.int8)
        self.sweep(faults_pass, self.slots, fault)
        return fault

    def farther(self, share: float = 1.0) -> NDArray[np.int8]:
        """`TOO_FAR_OFF` for slots of triangles with a sample farther than a share of what was asked for."""
        s, fault = self.complex.sheets, np.zeros(self.slots, dtype=np.int8)
        if self.deviation is None:
            return fault
        taken = self.complex.taken()
        corners = s.vertex[3 * taken.slots[:, None] + np.arange(3)]
        most = share * s.allowed[corners].max(axis=1) / self.support.factor
        fault[farther_from(self.support, taken, most)] = TOO_FAR_OFF
        return fault

    def mend(self, fault: NDArray[np.int8]) -> None:
        """Finer triangles where those there are too far from the surface."""
        start = 0
        while start >= 0:
            room = self.room()
            if room == 0:
                break
            self.complex.grow(room, 2 * room)
            start = int(mend_pass(self.work, fault, TOO_FAR_OFF, room))
        self.flip(False)
        self.sharpen(LEAST_TARGET)

    def crossing(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Slots of triangles that meet others outside of common vertices and edges, without flat ones.

        First those that a smaller size may help, then those that meet where the given surface does.
        """
        taken = self.complex.taken()
        sound = np.flatnonzero(self.faults()[taken.slots] & FLAT_TRIANGLE == 0)
        rows = np.ascontiguousarray(taken.triangles[sound])
        pairs = meeting_pairs(taken.points, rows)
        own = self.own.among(taken.points, rows, pairs)
        slots = taken.slots[sound]
        return slots[np.unique(pairs[~own])], slots[np.unique(pairs[own])]

    def untangle(self, bar: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Smaller sizes where triangles cross, but where the given surface does; `crossing` in the end.

        If a half of the size does not help, the mesh is again what it was before.
        """
        found = self.crossing()
        self.crossed = self.corners(found[0])
        for _ in range(UNTANGLED):
            if not len(found[0]):
                break
            before, area = self.state(), self.area(found[0])
            s = self.complex.sheets
            corners = np.unique(s.vertex[3 * found[0][:, None] + np.arange(3)])
            s.cap[corners] = np.minimum(s.cap[corners], 0.5 * s.size[corners])
            places = s.xyz[corners]
            self.grade()
            self.round()
            self.finish(places)
            self.settle()
            bar.update()
            now = self.crossing()
            if self.area(now[0]) > HELPED * area:
                self.restore(before)
                break
            found = now
        self.crossed = np.concatenate([self.crossed, self.corners(found[0])])
        return found

    def corners(self, slots: NDArray[np.int64]) -> Array:
        """The corners of some triangles: (k, 3, 3)."""
        s = self.complex.sheets
        return s.xyz[s.vertex[3 * slots[:, None] + np.arange(3)]]

    def area(self, slots: NDArray[np.int64]) -> float:
        """The area of some triangles."""
        return total_area(self.corners(slots))

    def state(self) -> tuple[Any, ...]:
        """All that changes, as it is now."""
        complex = self.complex
        return deepcopy((complex.sheets, complex.master, self.counts, self.off, self.short))

    def restore(self, state: tuple[Any, ...]) -> None:
        """Go back to what `state` returned."""
        self.complex.sheets, self.complex.master, self.counts, self.off, self.short = state

    def settle(self) -> None:
        """Move vertices onto the surface that are beside it, and note where that is impossible."""
        self.off = np.zeros(self.used, dtype=np.bool_)
        self.sweep(settle_pass, self.used, self.off)

    def put(self, places: Array) -> int:
        """Move vertices to these places, where no triangle turns over; how many stay."""
        self.off[:] = False
        return self.sweep(put_pass, self.used, places)

    def run(self, bar: Any) -> None:
        """All rounds, and what mends the rest."""
        self.begin()
        self.slack = LOOSE
        for i in range(REMESH_ROUNDS):
            before = self.counts.copy()
            self.round()
            lowered = i in MEASURED_ROUNDS and self.measure()
            bar.update()
            change = self.counts - before
            if (
                not lowered
                and change[SPLITS_DONE] + change[COLLAPSES] + change[FLIPS_DONE] < SETTLED * self.used
            ):
                break
        self.slack = 1.0
        self.finish()
        self.thin()
        for _ in range(SEPARATIONS):  # only now no other vertices are left between creases
            if not self.separate():
                break
            self.round()
            self.round()
            self.finish()
            bar.update()
        for _ in range(MENDS):
            fault = self.faults() | self.farther()
            if not (fault & TOO_FAR_OFF).any():
                break
            self.mend(fault)
            bar.update()
        self.settle()
