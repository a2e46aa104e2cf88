"""One run of `advancing_front`: the queue for its kernels, the finishing pass, and the account."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.codes import DONE, ROOM
from ...base.errors import InputError
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.stars import Stars, legalize_all
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ..rebay.finishing import figures
from ..rebay.queue import ACCEPTED, BATCH, STATUS, WAITING, empty_queue
from ..rebay.run import FRONT_STEPS_A_CALL, VoronoiSegmentRun
from . import bookkeeping as book
from . import placing
from . import steps as k

__all__ = ["FRONT_REASONS", "ORDERS", "PLACEMENTS", "FrontRun", "accounted", "columns", "longer_diary"]

Placement = Callable[[NDArray, NDArray, NDArray, NDArray, float], ArrayLike | None]
ORDERS = ("widest", "smallest", "shortest", "oldest")
PLACEMENTS = ("equal sides", "angle", "circle")
# Why a triangle was accepted, in the order of the codes of `steps`.
FRONT_REASONS = ("new point", "small enough", "empty circle", "near apex", "angle", "closed", "", "forced")
FRONT_COUNT_NAMES = (
    *FRONT_REASONS[:6], "circumcenters", "forced", "set aside", "outside", "encroaching", "collisions",
)  # fmt: skip
WIDTHS, LENGTHS = 13, 97  # buckets for R / f, and for sizes and lengths; one is for triangles set aside
SPARE_NUMBERS = 8  # rows after those of the subsegments, one of which all edges of the front share


def accounted(
    domain: Domain,
    complex_: PlanarComplex,
    steps: Callable[[NDArray[np.int32]], dict[str, NDArray]] | None,
    missed: dict[int, str],
    counts: NDArray[np.int64],
    more: dict[str, int],
    **rest: Any,
) -> DomainMesh:
    """The mesh of a front with its account.

    Parameters
    ----------
    domain, complex_
        Of the run.
    steps : function, optional
        The record, from the final numbers of the vertices (-1 for those that are not used).
    missed : dict of int to str
        The slots of triangles that are not as asked for, and why.
    counts : ndarray of int64
        What the kernels counted, in the order of `FRONT_COUNT_NAMES`.
    more : dict of str to int
        Further counts, of the finishing pass.
    **rest
        ``order`` and ``figures``, as for `PlanarComplex.mesh`.
    """
    c, slots, record = complex_, sorted(missed), None
    if steps is not None:
        used = np.zeros(c.size, dtype=bool)
        used[c.vertex[: 3 * c.triangles].reshape(-1, 3)[c.kept()].ravel()] = True
        record = steps(np.where(used, np.cumsum(used) - 1, -1).astype(np.int32))
    return c.mesh(
        facets=len(domain.facets),
        markers=domain.markers,
        origin=np.arange(len(domain.points), dtype=np.int32),
        points=domain.points,
        steps=record,
        unrefined=np.array(slots, dtype=np.int64),
        reasons=np.array([missed[slot] for slot in slots], dtype=str),
        counts=dict(zip(FRONT_COUNT_NAMES, counts[: len(FRONT_COUNT_NAMES)].tolist())) | more,
        **rest,
    )


def longer_diary(diary: book.Diary | None, rows: int, history: bool) -> book.Diary:
    """The record with at least so many rows, one for each triangle that there may be."""
    if diary is None:
        none = np.zeros(0, dtype=np.int32)
        diary = book.Diary(none, np.zeros((0, 5), dtype=np.int32), np.zeros((0, 4)))
    more = rows - len(diary.slots)
    if more <= 0:
        return diary
    slots, log, numbers = diary
    if history:
        log = np.concatenate([log, np.full((more, 5), -1, dtype=np.int32)])
        numbers = np.concatenate([numbers, np.full((more, 4), np.nan)])
    return book.Diary(np.concatenate([slots, np.empty(more, dtype=np.int32)]), log, numbers)


def columns(diary: book.Diary, made: int, place: NDArray[np.int32]) -> dict[str, NDArray]:
    """The columns of the record that contain vertices or reasons; ``place`` has the final numbers."""
    log, named = diary.log[:made], np.append(place, -1)
    return {
        "edge": named[log[:, :2]],
        "apex": named[log[:, 2]],
        "reason": np.array(FRONT_REASONS)[log[:, 3]],
        "near": named[log[:, 4]],
    }


class FrontRun:
    """The state of one run.

    Parameters
    ----------
    base : VoronoiSegmentRun
        A run that has not begun: its triangulation, its table of sizes, its pieces that must stay. Its
        finishing pass follows.
    order, placement
        As for `advancing_front`, checked.
    history : bool
        Whether to keep a record of each step.
    """

    def __init__(self, base: VoronoiSegmentRun, order: str, placement: str | Placement, history: bool):
        self.base, self.history = base, history
        c = base.complex
        if len(c.where) < c.segments + SPARE_NUMBERS:
            c.reserve(c.size, c.segments + SPARE_NUMBERS)
            base.reserve(c.size)
        self.place = None if isinstance(placement, str) else placement
        rank = ORDERS.index(order)
        kind = placing.AS_ASKED if not isinstance(placement, str) else PLACEMENTS.index(placement)
        constant = base.rule.constant
        self.rule = book.FrontRule(rank, kind, self._scale(rank), c.segments, constant)
        buckets = WIDTHS if rank == book.WIDEST else LENGTHS
        even = constant > 0.0 and rank == book.WIDEST and self.place is None
        _, self.gates, self.turn = empty_queue(0, buckets, BATCH if even else 0)
        self.counts = np.zeros(book.FRONT_COUNTS, dtype=np.int64)
        self.ask, self.answer = np.array([-1, 0], dtype=np.int64), np.zeros(2)
        self.diary = longer_diary(None, len(c.region), history)

    def _scale(self, rank: int) -> float:
        """What the squared measure of the order is divided by, so that it is at least about 1."""
        c = self.base.complex
        if rank == book.SMALLEST:
            return float(self.base.table.values.max() ** 2)
        if rank == book.SHORTEST:
            ends = c.ends[: c.segments]
            return float(np.square(c.xy[ends[:, 0]] - c.xy[ends[:, 1]]).sum(axis=1).max())
        return book.FRONT_ACCEPT**2

    def marching(self) -> k.Marching:
        """The queue and the choices, as they are now."""
        return k.Marching(self.base.links, self.gates, self.turn, self.base.table, self.rule)

    def march(self, budget: int, bar: Any) -> None:
        """Advance until the front is empty, or until there are so many new points."""
        base, c = self.base, self.base.complex
        k.start_front(c.plane(), self.marching())
        while True:
            before, limit = c.size, min(FRONT_STEPS_A_CALL, base.first + budget - c.size)
            if limit <= 0:
                base.spent = True
                break
            status = k.advance_front(
                c.plane(),
                self.marching(),
                base.scratch,
                self.diary,
                self.counts,
                self.ask,
                self.answer,
                limit,
            )
            if status == k.ASK:
                self.answer[:] = self._asked(int(self.ask[0]))
            elif status == ROOM:
                base.reserve(2 * c.size + 1000)
                self.diary = longer_diary(self.diary, len(c.region), self.history)
            if bar is not None:
                bar.update(c.size - before)
            if status == DONE:
                break
        mark = c.mark[: 3 * c.triangles]
        mark[mark == self.rule.number] = -1

    def _asked(self, e: int) -> NDArray[np.float64]:
        """The point that the function of the caller wants for the front edge e; NaN for the apex ahead."""
        c = self.base.complex
        vertex, twin, mark = c.vertex, c.twin, c.mark

        def turned(n: int, by: int) -> int:
            while mark[n] < 0:
                n = int(twin[n])
                n = n - n % 3 + (n + by) % 3
            return n

        first = e - e % 3
        after, before = turned(first + (e + 1) % 3, 1), turned(first + (e + 2) % 3, 2)
        corners = (
            vertex[before - before % 3 + (before + 1) % 3], vertex[first + (e + 1) % 3],
            vertex[first + (e + 2) % 3], vertex[after - after % 3 + (after + 2) % 3],
        )  # fmt: skip
        p, a, b, n = (c.xy[int(v)] / c.factor for v in corners)
        h = self._length((a + b) / 2)
        try:
            point = self.place(p, a, b, n, h) if self.place is not None else None
        except Exception as error:
            raise InputError(
                f"placement raised {type(error).__name__} ({error}) for the front edge from {a} to {b}; "
                "it is called as placement(p, a, b, n, h) and returns a point (x, y) or None"
            ) from error
        if point is None:
            return np.full(2, np.nan)
        try:
            x = np.asarray(point, dtype=float)
        except (TypeError, ValueError):
            x = np.empty(0)
        if x.shape != (2,) or not np.isfinite(x).all():
            raise InputError(
                f"placement returned {point!r} for the front edge from {a} to {b}; "
                "return a point (x, y) or None"
            )
        return x * c.factor

    def _length(self, x: NDArray[np.float64]) -> float:
        """The wanted length at a point, as the kernels read it."""
        c = self.base.complex
        return float(k.length_at(self.marching(), x[0] * c.factor, x[1] * c.factor) / c.factor)

    # ------------------------------------------------------------------ finishing and the account

    @property
    def made(self) -> int:
        """How many triangles have been accepted."""
        return int(self.counts[book.MADE])

    def legalize(self) -> int:
        """Make the triangulation constrained Delaunay again, across what was the front."""
        c = self.base.complex
        stack, at = np.empty(4 * len(c.mark) + 64, dtype=np.int32), np.empty(c.size, dtype=np.int32)
        still = np.empty(0, dtype=bool)
        none, places, counts = np.empty(0, dtype=np.int32), np.empty((0, 2)), np.zeros(2, dtype=np.int64)
        stars = Stars(c.xy, c.vertex, c.twin, c.mark, c.where, at, still, none, places, stack, counts)
        return int(legalize_all(stars, c.region, c.triangles))

    def result(self, budget: int, finish: bool) -> DomainMesh:
        """The mesh with its account, after the finishing pass if it is wanted."""
        base, c = self.base, self.base.complex
        made = self.diary.slots[: self.made]
        missed: dict[int, str] = {}
        order = None
        if finish and not base.spent:
            swaps = self.legalize()
            rest = base.finish(budget)
            rest["counts"]["swaps"] += swaps
            missed = dict(zip(rest["slots"], rest["reasons"])) | dict(zip(*base.waiting()))
        else:
            rest = {"counts": {}, "figures": figures(c)}
            undone = np.flatnonzero(base.links[: c.triangles, STATUS] != ACCEPTED)
            order = np.concatenate([made, undone])
            missed = dict.fromkeys(undone.tolist(), "budget") | self._large()
        steps = self.steps if self.history else None
        return accounted(
            base.domain, c, steps, missed, self.counts, rest["counts"], order=order, figures=rest["figures"]
        )

    def _large(self) -> dict[int, str]:
        """The accepted triangles that are too large, and why."""
        base, c = self.base, self.base.complex
        if base.spent:
            return {}
        base.restart()
        large = np.flatnonzero(c.kept() & (base.links[: c.triangles, STATUS] >= WAITING))
        return dict.fromkeys(large.tolist(), "too large: no room for a point")

    def steps(self, place: NDArray[np.int32]) -> dict[str, NDArray]:
        """The record by columns; see `advancing_front`. ``place[v]`` is the final number of vertex v."""
        c = self.base.complex
        found = columns(self.diary, self.made, self.base.in_old_order(place))
        numbers = self.diary.numbers[: self.made] / c.factor
        return found | {
            "ideal": numbers[:, :2].copy(),
            "size": numbers[:, 2] * k.ROOT3,
            "radius": numbers[:, 3].copy(),
        }
