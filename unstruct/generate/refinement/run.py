"""One run of Delaunay refinement: its arrays, which grow as needed, and points of curves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET
from ...base.codes import MORE, ROOM
from ...base.errors import InputError
from ...connect.insertion.engine import grown
from ...connect.planar.complex import PlanarComplex
from .encroachment import FIRST, SECOND, shell
from .free_vertices import MOST_CORNERS
from .limits import Limits
from .state import (
    BY_FUNCTION,
    CIRCUMCENTERS,
    CURVES,
    EVENTS,
    GUARDED,
    KEPT,
    LARGE,
    REMOVED,
    SEGMENT_TOP,
    VERTEX_LIMIT,
    WANTED,
    Work,
    begin,
    expected,
)
from .steps import advance

__all__ = ["Planned", "RefineRun", "counts_of"]

REFINE_STEPS_A_CALL = 20_000  # steps of one kernel call, some hundredths of a second: Ctrl-C works between
PER_VERTEX = ("kind", "floor")
PER_SEGMENT = ("apexes", "lock", "asked", "need", "given", "segments", "wanted")
PER_SLOT = ("large", "ahead", "behind")
OWN = (*PER_VERTEX, *PER_SEGMENT, "status", *PER_SLOT, "gates")  # in the order of `Work`
OWN_OF = attrgetter(*OWN)
RUN_COUNTS = ("circumcenters", "splits", "shell splits", "rejected", "locked", "refused")
At = Callable[[NDArray[Any], NDArray[np.float64]], NDArray[np.float64]]


@dataclass
class Planned:
    """A triangulation to be refined, with the data of its pieces."""

    complex_: PlanarComplex
    names: list[str]  # of the regions, by number
    joints: NDArray[np.int32]  # (pieces, 2) end vertices
    curve: NDArray[np.int8]  # (pieces,) STRAIGHT, ARC, OTHER
    arc: NDArray[np.float64]  # (pieces, 5), unscaled
    at: At  # points of pieces by parameter, unscaled
    rest: dict[str, Any] = field(default_factory=dict)  # for `PlanarComplex.mesh`


class RefineRun:
    """The arrays of a run besides those of its `PlanarComplex`, and the calls of the kernel."""

    def __init__(self, planned: Planned, limits: Limits, offset: float, budget: int | None, history: bool):
        c = planned.complex_
        self.planned, self.complex, self.limits, self.offset = planned, c, limits, offset
        self.tally = np.zeros(BY_FUNCTION + 1, dtype=np.int64)
        thrifty, budget = budget is None, DEFAULT_BUDGET if budget is None else budget
        self.tally[VERTEX_LIMIT] = budget
        n, s = c.size, c.segments
        self.polygon = np.empty((MOST_CORNERS, 7), dtype=np.int64)
        self.event = np.empty((1024 if history else 0, 5), dtype=np.int32)
        self.place = np.empty((len(self.event), 2))
        # These are copies, because read-only arrays have another type and would need a second compilation.
        self.arc, self.curve, self.joints = planned.arc.copy(), planned.curve.copy(), planned.joints.copy()
        self.allowed = np.empty((len(self.joints), 2), dtype=np.int64)
        if c.factor != 1.0:
            self.arc[:, :3] *= c.factor
        wanted = min(expected(c.plane(), limits), 2.0**25)
        c.reserve(min(int(wanted), budget) + 2 * n + 64, 2 * s + 64)
        self._allocate(len(c.xy), len(c.where), len(c.region) + 1)
        begin(self.work(), np.array(planned.rest["inputs"], dtype=np.int32), limits.fraction, thrifty)

    def keep(self, kept: NDArray[np.uint8]) -> None:
        """Split no subsegment of pieces with a 1, and guard those with a 2, too; before the first step."""
        own = kept[self.complex.piece[: self.complex.segments]]
        self.lock[: len(own)][own == 1] = KEPT
        self.lock[: len(own)][own > 1] = GUARDED

    def _allocate(self, n: int, s: int, t: int) -> None:
        """Make arrays for so many vertices, subsegments and slots."""
        self.kind, self.floor = np.empty(n, dtype=np.int32), np.empty(n)
        self.apexes, self.lock = np.empty(s, dtype=np.uint8), np.empty(s, dtype=np.uint8)
        self.asked, self.need, self.given = np.empty(s, dtype=np.uint8), np.empty(s), np.empty((s, 3))
        self.segments, self.wanted = np.empty(s, dtype=np.int32), np.empty(s, dtype=np.int32)
        self.status = np.zeros(t, dtype=np.uint16)  # pages of zeros that are never used cost nothing
        self.large, self.ahead = np.empty(t, dtype=np.int32), np.empty(t, dtype=np.int32)
        self.behind, self.gates = np.empty(t, dtype=np.int32), np.empty((LARGE, 2), dtype=np.int32)
        self.gates.fill(-1)
        self.scratch = self.complex.scratch()
        self._work: Work | None = None

    def _make_room(self, vertices: int, segments: int) -> None:
        c = self.complex
        c.reserve(vertices, segments)
        n, s, t = len(c.xy), len(c.where), len(c.region)
        for names, size in ((PER_VERTEX, n), (PER_SEGMENT, s), (PER_SLOT, t + 1)):
            for name in names:
                setattr(self, name, grown(getattr(self, name), size))
        if t >= len(self.status):
            status = np.zeros(len(self.large), dtype=np.uint16)
            status[: len(self.status)] = self.status
            self.status = status
        if self.tally[EVENTS] + 256 > len(self.event) > 0:
            self.event = grown(self.event, 2 * len(self.event))
            self.place = grown(self.place, len(self.event))
        self.scratch = c.scratch()
        self._work = None

    def work(self) -> Work:
        """The arrays as they are now."""
        if self._work is None:
            arrays: list[NDArray] = [
                *self.complex.plane(),
                *OWN_OF(self), self.curve, self.arc, self.joints, self.allowed, *self.scratch,
                self.polygon, self.event, self.place,
            ]  # fmt: skip
            self._work = Work(*arrays)
        return self._work

    def advance(self) -> int:
        """Take some thousand steps; return DONE, MORE or BUDGET."""
        code = advance(self.work(), self.tally, self.limits, self.offset, REFINE_STEPS_A_CALL)
        if code == ROOM:
            c = self.complex
            vertices = len(c.xy) if c.size + 1 <= len(c.xy) else 2 * len(c.xy)
            segments = len(c.where) if c.segments + 1 <= len(c.where) else 2 * len(c.where)
            self._make_room(vertices, segments)
            return MORE
        if code == CURVES:
            self._answer()
            return MORE
        return int(code)

    @property
    def vertices(self) -> int:
        """The number of vertices, without those that were removed."""
        return int(self.complex.size - self.tally[REMOVED])

    def _answer(self) -> None:
        """Compute the points of curves that the kernel waits for, and put their subsegments on the stack."""
        c, count = self.complex, int(self.tally[WANTED])
        s = self.wanted[:count].copy()
        t = self._parameters(s)
        x = self.planned.at(c.piece[s], t)
        if not np.isfinite(x).all():
            i = int(np.argmin(np.isfinite(x).all(axis=1)))
            raise InputError(
                f"the curve of piece {c.piece[s[i]]} has no finite point at parameter {t[i]}: its point(t) "
                "must give finite coordinates for all t in [0, 1]"
            )
        self.given[s, :2] = x * c.factor
        self.given[s, 2] = t
        top = int(self.tally[SEGMENT_TOP])
        self.segments[top : top + count] = s[::-1]
        self.tally[SEGMENT_TOP], self.tally[WANTED] = top + count, 0

    def _parameters(self, s: NDArray[np.int32]) -> NDArray[np.float64]:
        """The parameters at which curves are split: the middle, or where they leave a shell at an apex."""
        c = self.complex
        t0, t1 = c.span[s].T
        t = 0.5 * (t0 + t1)
        for i in np.flatnonzero((self.apexes[s] == FIRST) | (self.apexes[s] == SECOND)):
            a, b = c.xy[c.ends[s[i]]] / c.factor
            apex, near, far = (a, t0[i], t1[i]) if self.apexes[s[i]] == FIRST else (b, t1[i], t0[i])
            radius = shell(float(np.hypot(*(b - a) * c.factor))) / c.factor
            piece = c.piece[s[i] : s[i] + 1]
            for _ in range(60):  # the distance from the apex grows along the subsegment, which turns little
                t[i] = 0.5 * (near + far)
                x = self.planned.at(piece, t[i : i + 1])[0]
                near, far = (t[i], far) if np.hypot(*(x - apex)) < radius else (near, t[i])
        return t


def counts_of(tally: NDArray[np.int64], missed: dict[str, int]) -> dict[str, int]:
    """What happened in a run, and how many triangles miss each limit, by name."""
    numbers = tally.tolist()
    counts = {"removed": numbers[REMOVED], **dict(zip(RUN_COUNTS, numbers[CIRCUMCENTERS:]))}
    for name, number in missed.items():
        counts[f"missed {name}"] = number
    return counts
