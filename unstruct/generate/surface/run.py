"""RemeshRun: the rounds of remeshing, and the account of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...connect.surface.complex import SurfaceComplex
from ...connect.surface.halfedges import SURFACE_SLOTS, SURFACE_VERTICES
from ...geometry.support import Support
from ...geometry.support_walk import WAITING_BOXES
from ...sizing.field import SizeField
from .flips import flip_pass
from .lengths import collapse_pass, split_pass
from .measuring import faults_pass, grade_pass, lower_pass
from .moves import move_pass
from .shapes import RemeshWork
from .sharpest import sharpest_pass

__all__ = ["ALLOWED", "RemeshRun"]

Array = NDArray[np.float64]
ALLOWED = 0.01  # the distance from the given surface that is allowed, in sizes, if nothing is said
ROUNDS = 6  # of splits, collapses, flips and moves; more, if the size had to be lowered
MEASURED = (2, 3, 4, 5)  # rounds after which distances are measured
FLIP_SWEEPS = 6
GROWTH = 0.25  # of sizes that are lowered, by distance
LEAST_SHARE = 0.125  # the part of the wanted size below which it is not lowered
RELAXED = 1.3  # by how much a lowered size may rise again from one measurement to the next
TARGETS = (30.0, 35.0, 38.0, 40.0)  # degrees below which triangles are sharp, one after the other
SWEEPS = 12  # over triangles that are sharp, for each of them
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
        self.deviation = deviation
        self.counts = np.zeros(6, dtype=np.int64)
        self.x, self.place = np.zeros((4, 3)), np.zeros(6)
        self.stack = np.empty(WAITING_BOXES, dtype=np.int64)
        self.short = False  # whether the budget did not suffice
        self.refresh()

    @property
    def work(self) -> RemeshWork:
        """The record for kernels: of the arrays as they are now."""
        sheets = self.complex.sheets
        return RemeshWork(
            sheets, self.support.held, self.x, np.zeros(3), np.zeros(3), self.place, self.stack, self.counts
        )

    def refresh(self) -> None:
        """Ask for the size at all vertices."""
        s, factor = self.complex.sheets, self.support.factor
        used = np.flatnonzero(s.at[: int(s.state[SURFACE_VERTICES])] >= 0)
        if self.size.constant is None:
            asked = self.size(s.xyz[used] / factor) * factor
        else:
            asked = np.full(len(used), self.size.constant * factor)
        s.size[used] = np.minimum(asked, np.maximum(s.cap[used], LEAST_SHARE * asked))
        s.allowed[used] = ALLOWED * asked if self.deviation is None else self.deviation * factor

    def split(self) -> None:
        """Split edges until all are short enough, or the budget is used up."""
        start = 0
        while start >= 0:
            used = int(self.complex.sheets.state[SURFACE_VERTICES])
            room = min(int(GROWN * used) + 1, self.budget - used)
            if room <= 0:
                self.short = True
                return
            self.complex.grow(room, 2 * room)
            start = int(split_pass(self.work, start))

    def flip(self, by_degree: bool) -> None:
        for _ in range(FLIP_SWEEPS):
            if flip_pass(self.work, by_degree) == 0:
                return

    def measure(self, relax: bool) -> None:
        """Lower sizes where the mesh is too far from the surface."""
        s = self.complex.sheets
        bound = np.full(len(s.at), np.inf)
        lower_pass(self.work, bound)
        s.cap[:] = np.minimum(bound, RELAXED * s.cap if relax else s.cap)
        self.grade()

    def grade(self) -> None:
        while grade_pass(self.work, GROWTH):
            pass
        self.refresh()

    def round(self) -> None:
        """One round."""
        self.split()
        collapse_pass(self.work)
        self.flip(True)
        move_pass(self.work)
        move_pass(self.work)
        self.refresh()
        self.flip(False)

    def begin(self) -> None:
        """What is small or flat in the given triangles goes first."""
        self.flip(False)
        collapse_pass(self.work)
        self.flip(False)

    def finish(self) -> None:
        """Moves and flips alone, and then whatever makes the sharpest triangles less sharp."""
        for _ in range(4):
            move_pass(self.work)
            self.flip(False)
        for degrees in TARGETS:
            target = float(np.sin(np.deg2rad(degrees))) ** 2
            for _ in range(SWEEPS):
                self.complex.grow(64, 128)
                if sharpest_pass(self.work, target) == 0:
                    break
                self.flip(False)
        self.refresh()

    def faults(self) -> tuple[NDArray[np.int8], float]:
        """What is wrong with each slot of triangles, and the largest distance from the given surface."""
        fault = np.zeros(int(self.complex.sheets.state[SURFACE_SLOTS]), dtype=np.int8)
        worst = float(faults_pass(self.work, fault))
        return fault, float(np.sqrt(worst)) / self.support.factor

    def run(self, bar: Any) -> None:
        self.begin()
        for i in range(ROUNDS):
            self.round()
            if i in MEASURED:
                self.measure(True)
            bar.update()
        for _ in range(3):
            self.finish()
            fault, _ = self.faults()
            if not (fault & 4).any():
                break
            self.measure(False)
            self.round()
            bar.update()
