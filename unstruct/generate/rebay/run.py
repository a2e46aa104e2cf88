"""One run of `voronoi_segment`: the arrays for its kernels, the splits of the boundary, and the account."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, as_number
from ...base.codes import DONE, ROOM, SPLIT
from ...base.errors import InputError
from ...connect.planar.cavity import blocked_by, commit_split, find_split
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.renumbering import renumber
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...sizing import as_size
from ..refinement.account import TEXTS
from ..refinement.state import FINEST_SPAN, KEPT
from . import steps as k
from .finishing import (
    HOPED_ANGLE,
    PASSES,
    PROMISED_ANGLE,
    QUICK,
    THOROUGH,
    TRIED_ANGLE,
    Best,
    figures,
    refine_angles,
    small_angles,
    smooth_poor,
)
from .queue import ACCEPTED, ASIDE, BATCH, STATUS, WAITING, empty_queue, grown_links, unlink
from .sharpening import SPARE_VERTICES, sharpen_worst

COUNT_NAMES = (
    "points", "capped", "clamped", "behind", "deleted", "cocircular", "circumcenters", "splits", "moved",
    "wide", "outside", "encroaching", "collisions", "rounded", "given up", "refused splits",
)  # fmt: skip
FINISH_NAMES = ("moves", "swaps", "points again", "patches", "angle points", "angle splits", "removed")
FRONT_STEPS_A_CALL = 50_000  # steps of one kernel call, a fraction of a second: Ctrl-C works between calls
TOLERANCE = 0.04  # the relative tolerance of the size table
AT_FIRST = 6  # times as many vertices as there are: there is room for these before the first points
BUCKETS = 12  # for R / f: two buckets an octave of its square; the last one takes all above 8 delta
ORDER_BUCKETS = 96  # for any other measure
RENUMBERED_FROM = 1 << 14  # new vertices: smaller meshes are in the processor's cache anyway
MOST_GROWTH, SPARE_POINTS = 16, 1000  # of vertices, by points that finishing adds for the angle


class VoronoiSegmentRun:
    """The state of one run.

    Parameters
    ----------
    domain, size, priority
        As for `voronoi_segment`.
    complex_ : PlanarComplex
        The constrained Delaunay triangulation to start from.
    rule : Rule
        The other choices.
    kept : ndarray of uint8
        1 for pieces that must not be split; see `kept_pieces`.
    history : bool
        Whether to keep a record of each step.
    """

    def __init__(
        self,
        domain: Domain,
        complex_: PlanarComplex,
        size: Any,
        priority: Any,
        rule: k.Rule,
        kept: NDArray[np.uint8],
        history: bool,
    ):
        self.domain, self.complex, self.kept = domain, complex_, kept
        field = as_size(size)
        self.effort = THOROUGH if field.thorough else QUICK
        # The table of a number is a number, whatever its box.
        even = field.constant is not None and priority is None
        lower, upper = complex_.box().reshape(2, 2) if even else domain.bounds
        self.table = field.table(lower, upper, factor=complex_.factor, tolerance=TOLERANCE).nodes
        self.order, buckets, scale = self.table, BUCKETS, rule.accept**2
        if priority is not None:
            measure = 1.0 if isinstance(priority, str) else priority
            self.order, buckets = (
                as_size(measure).table(lower, upper, factor=complex_.factor).nodes,
                ORDER_BUCKETS,
            )
            scale *= (self.table.values.min() / self.order.values.max()) ** 2
        constant = 0.0 if field.constant is None else self.table.values[0, 0] / k.ROOT3
        self.rule = rule._replace(scale=float(scale), constant=float(constant))
        self.batch = BATCH if field.constant is not None and not rule.last_first else 0
        self.links, self.gates, self.turn = empty_queue(0, buckets, self.batch)
        self.counts = np.zeros(k.COUNTS, dtype=np.int64)
        self.ask = np.zeros(1, dtype=np.int64)
        self.first = complex_.size  # vertices from here on are new
        self.numbers_now: NDArray[np.int32] | None = None  # of the vertices, once they have been renumbered
        self.seen = np.zeros(0, dtype=bool)  # vertices whose triangles have been classified; none at first
        self.history, self.spent = history, False
        self.log, self.numbers = np.zeros((0, 5), dtype=np.int32), np.zeros((0, 6))
        # Make room for all points at once where their number can be estimated; unused memory costs nothing.
        expected = 0.0
        if field.constant is not None:
            h = float(self.table.values[0, 0])
            expected = 1.2 * _area(complex_) * 2.0 / k.ROOT3 / h / h
        if not np.isfinite(expected):  # the area is beyond all doubles
            expected = 0.0
        self.reserve(AT_FIRST * complex_.size + 1000 + int(min(expected, 1e7)))

    def reserve(self, vertices: int) -> None:
        """Make room for so many vertices in all, and for a few more subsegments."""
        complex_ = self.complex
        if vertices > len(complex_.xy) or complex_.segments + 8 > len(complex_.ends):
            complex_.reserve(vertices, complex_.segments + 64)
        if len(complex_.region) > len(self.links):
            self.links = grown_links(self.links, len(complex_.region))
            self.scratch = complex_.scratch()
        more = len(complex_.xy) - len(self.log)
        if self.history and more > 0:
            self.log = np.concatenate([self.log, np.tile(np.array([-1, -1, -1, -1, 0], np.int32), (more, 1))])
            self.numbers = np.concatenate([self.numbers, np.full((more, 6), np.nan)])

    def front(self) -> k.Front:
        """The queue, and the arrays and choices that decide its order, as they are now."""
        return k.Front(self.links, self.gates, self.turn, self.table, self.order, self.rule)

    def insert(self, budget: int | None, bar: Any) -> None:
        """Insert points until no waiting triangle is left at the front, or the budget is spent."""
        self.start(np.ones(self.complex.size, dtype=bool))
        self.advance(budget, bar)

    def advance(self, budget: int | None, bar: Any) -> None:
        """Continue `insert` from the present state."""
        c = self.complex
        while True:
            before = c.size
            limit = (
                FRONT_STEPS_A_CALL
                if budget is None
                else min(FRONT_STEPS_A_CALL, self.first + budget - c.size)
            )
            if limit <= 0:
                self.spent = True
                return
            status = k.advance(
                c.plane(), self.front(), self.scratch, self.counts, self.log, self.numbers, self.ask, limit
            )
            if status == SPLIT:
                self.split(int(self.ask[0]))
            elif status == ROOM:
                self.reserve(2 * c.size + 1000)
            if bar is not None:
                bar.update(c.size - before)
            if status == DONE:
                return

    def split(self, e: int) -> bool:
        """Split the subsegment on half-edge e, on the true curve; False if that is not possible."""
        self.reserve(self.complex.size + 8)
        c = self.complex
        s = int(c.mark[e])
        if self.kept[c.piece[s]]:
            self.counts[k.GIVEN_UP] += 1
            return False
        t = float(c.span[s].mean())
        x, y = self.domain.points_at(c.piece[s : s + 1], np.array([t]))[0] * c.factor
        plane, scratch = c.plane(), self.scratch
        m, n, h = find_split(plane, scratch, e, x, y)
        if min(t - c.span[s, 0], c.span[s, 1] - t) < FINEST_SPAN:
            m = 0
        if m <= 0 or n < 0 or blocked_by(c.xy, c.vertex, scratch.rim, n, x, y) >= 0:
            self.counts[k.SPLIT_REFUSED] += 1
            return False
        for slot in scratch.cells[:m]:
            if self.links[slot, STATUS] >= 0:
                unlink(self.links, self.gates, slot, WAITING)
        p = c.size
        c.xy[p] = x, y
        if self.history:
            self.log[p], self.numbers[p, :2] = (*c.ends[s], -1, -1, 1 << k.BY_SPLIT), (x, y)
        commit_split(plane, scratch, e, m, n, h, p, t)
        fresh = scratch.fresh[:n]
        inside = c.region[fresh] >= 0
        self.links[fresh[~inside], STATUS] = ACCEPTED
        seen = fresh[inside]
        k.settle(plane, self.front(), seen, len(seen))
        self.counts[k.BY_SPLIT] += 1
        return True

    # ------------------------------------------------------------------ finishing

    def start(self, moved: NDArray[np.bool_]) -> None:
        """Classify all triangles that have a corner among these as accepted or waiting."""
        k.start(self.complex.plane(), self.front(), moved)
        self.seen = moved | self._seen() if len(self.seen) else moved

    def _seen(self) -> NDArray[np.bool_]:
        """The vertices all of whose triangles have been classified as they are now; new ones are such."""
        found, many = np.ones(self.complex.size, dtype=bool), min(self.complex.size, len(self.seen))
        found[:many] = self.seen[:many]
        return found

    def restart(self) -> None:
        """Classify all triangles again, beginning with an empty queue."""
        self.reserve(self.complex.size)
        slots, buckets = len(self.complex.region), len(self.gates) // 2
        self.links, self.gates, self.turn = empty_queue(slots, buckets, self.batch)
        self.start(np.ones(self.complex.size, dtype=bool))

    def finish(self, budget: int | None) -> dict[str, Any]:
        """Run the finishing pass; return what `result` reports about it."""
        c, most = self.complex, None if budget in (None, DEFAULT_BUDGET) else self.first + budget
        if self.rule.constant == 0.0 and c.size - self.first >= RENUMBERED_FROM:
            self._renumber()
        ceiling = MOST_GROWTH * c.size + SPARE_POINTS
        done = dict.fromkeys(FINISH_NAMES, 0)
        before: dict[str, float] = {}
        allowed = np.full((len(self.kept), 2), -1, dtype=np.int64)  # splits of pieces for the angle
        since = 0  # if not 0: vertices from this number on are new, and nothing else has changed
        slots: list[int] = []
        reasons: list[str] = []
        best = Best(c, bool(self.kept.any()))  # where pieces stay, refinement may end below its start
        for number in range(PASSES + 1):
            best.keep()
            if number < PASSES:  # the last pass only refines, so that its list describes the final mesh
                moves, swaps, moved, measured = smooth_poor(c, self.first, since, self.effort)
                if number == 0:
                    before, best.angle = measured, measured["minimum angle"]
                done["moves"] += moves
                done["swaps"] += swaps
                # What did not change has kept its class; but triangles that were given up are tried again.
                # What `refine_angles` could not change waits again; `start` needs an empty queue.
                fresh = since or not self.counts[k.GIVEN_UP]
                if fresh and not self.spent and (self.gates < 0).all():
                    self.start(moved)
                else:
                    self.restart()
            counted, size = self.counts.copy(), c.size
            self.advance(budget, None)  # some triangles may have become too large again
            done["points again"] += c.size - size
            again = c.size > size
            after = figures(c)
            if not self.spent and (self.effort is THOROUGH or after["minimum angle"] < self.effort.patched):
                self.reserve(c.size + SPARE_VERTICES)
                done["patches"] += sharpen_worst(
                    self.domain, c, self.front(), self.first, self.kept, most is None
                )
                after = figures(c)
            self.counts = counted
            if not best.offer(after["minimum angle"]) and best.wanted and 0 < number < PASSES:
                break
            refined, top = False, ceiling + done["removed"]  # a vertex that was removed is no growth
            slots, reasons = [], []
            if number < PASSES and after["minimum angle"] < HOPED_ANGLE:
                every = 1 + self.kept
                best.keep()
                found, _, _ = refine_angles(
                    self.domain, c, self.first, most, every, top, allowed, TRIED_ANGLE
                )
                refined, after = self._refined(found, done, after)
            if after["minimum angle"] < PROMISED_ANGLE:
                best.keep()
                found, slots, reasons = refine_angles(
                    self.domain, c, self.first, most, 2 * self.kept, top, allowed
                )
                more, after = self._refined(found, done, after)
                refined = refined or more
            if not refined and (not again or number > 0):
                break
            since = 0 if refined else size
        if best.wanted and after["minimum angle"] <= best.angle:
            # All that is too large is told, also what no step has looked at.
            if best.saved is None and not self.spent and not done["patches"]:
                k.classify_rest(c.plane(), self.front(), self._seen())
            else:
                if best.saved is not None:
                    c.restore(best.saved)
                    after = figures(c)
                self.restart()
            slots = small_angles(c, PROMISED_ANGLE).tolist() if after["minimum angle"] < HOPED_ANGLE else []
            reasons = [TEXTS[KEPT]] * len(slots)
        kept = {f"{name} before": x for name, x in before.items()}
        kept |= {f"{name} after": x for name, x in after.items()}
        return {"counts": done, "figures": kept, "slots": slots, "reasons": reasons}

    def _renumber(self) -> None:
        """Put neighbors near each other in memory: where the size varies, the front has not."""
        found = renumber(self.complex, self.first)
        if found is not None:
            self.numbers_now, slot = found
            links = self.links.copy()
            links[slot] = self.links[: len(slot)]
            self.links = links

    def in_old_order(self, values: NDArray[np.int32]) -> NDArray[np.int32]:
        """Values by vertex, for vertices by the numbers that they had before they were renumbered."""
        if self.numbers_now is None:
            return values
        return np.concatenate([values[self.numbers_now], values[len(self.numbers_now) :]])

    def _refined(
        self, found: dict[str, int], done: dict[str, int], before: dict[str, float]
    ) -> tuple[bool, dict[str, float]]:
        """Add up what `refine_angles` did; whether there are new points, and the figures afterwards."""
        done["angle points"] += found["circumcenters"]
        done["angle splits"] += found["splits"]
        done["removed"] += found["removed"]
        new = found["circumcenters"] + found["splits"] > 0
        self.restart()
        return new, figures(self.complex) if new else before

    # ------------------------------------------------------------------ the account

    def steps(self) -> dict[str, NDArray]:
        """The record by columns, with the final numbers of vertices; see `voronoi_segment`."""
        stop, c = self.complex.size, self.complex
        used = np.zeros(c.size, dtype=bool)
        used[c.vertex[: 3 * c.triangles].reshape(-1, 3)[c.kept()].ravel()] = True
        place = self.in_old_order(np.where(used, np.cumsum(used) - 1, -1).astype(np.int32))
        log, numbers = self.log[self.first : stop].copy(), self.numbers[self.first : stop] / c.factor
        if self.numbers_now is not None:  # rows that were written since then
            now = np.append(np.argsort(self.in_old_order(np.arange(stop, dtype=np.int32))), -1)
            since = len(self.numbers_now) - self.first
            log[since:, :4] = now[log[since:, :4]]
        edge, case = log[:, :2], log[:, 4].astype(np.uint8)
        f, p, q, d = numbers[:, 2:].T
        last = edge.max(axis=1, initial=-1)
        row = np.maximum(last - self.first, 0)
        ends = edge[row]
        other = edge.min(axis=1, initial=np.iinfo(np.int32).max)
        proper = ((case & 1) > 0) & ((case >> k.DELETED & 1) == 0)  # the step made the triangle AXB
        child = (last >= self.first) & proper[row] & ((ends == other[:, None]).any(axis=1)) & (case & 1 > 0)
        named = np.append(place, -1)
        return {
            "vertex": place[self.first : stop],
            "edge": named[edge],
            "accepted": named[log[:, 2]],
            "waiting": named[log[:, 3]],
            "parent": np.where(child, row, -1).astype(np.int32),
            "case": case,
            "f": f.copy(),
            "p": p.copy(),
            "q": q.copy(),
            "d": d.copy(),
            "point": numbers[:, :2].copy(),
        }

    def waiting(self) -> tuple[list[int], list[str]]:
        """The slots of the triangles that are not accepted, and the reason for each."""
        status = self.links[: self.complex.triangles, STATUS]
        slots = np.flatnonzero((self.complex.region[: self.complex.triangles] >= 0) & (status >= ASIDE))
        return slots.tolist(), ["budget" if self.spent else "too large: no room for a point"] * len(slots)

    def result(self, finished: dict[str, Any] | None = None) -> DomainMesh:
        """The mesh with its account, which includes that of the finishing pass."""
        c = self.complex
        waiting = dict(zip(*self.waiting()))
        counts = dict(zip(COUNT_NAMES, self.counts.tolist()))
        if finished is None:
            finished = {"counts": {}, "figures": figures(c), "slots": [], "reasons": []}
        missed = dict(zip(finished["slots"], finished["reasons"])) | waiting
        return c.mesh(
            facets=len(self.domain.facets),
            markers=self.domain.markers,
            origin=np.arange(len(self.domain.points), dtype=np.int32),
            points=self.domain.points,
            steps=self.steps() if self.history else None,
            unrefined=np.array(sorted(missed), dtype=np.int64),
            reasons=np.array([missed[slot] for slot in sorted(missed)], dtype=str),
            counts=counts | finished["counts"],
            figures=finished["figures"],
        )


def _area(c: PlanarComplex) -> float:
    """The area of the domain, up to rounding, in the units of the kernels."""
    a, b, d = c.xy[c.vertex[: 3 * c.triangles].reshape(-1, 3)[c.kept()]].transpose(1, 2, 0)
    return float(((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0])).sum()) / 2.0


def rule_of(accept: float, evaluate: str, order: str, priority: Any, split: bool) -> k.Rule:
    """Check the caller's choices and collect them in a `Rule`."""
    if not 1.0 < as_number(accept, "accept") < np.inf:
        raise InputError(
            f"accept = {accept!r} must be a finite number above 1; the default is 1.35, Rebay's value is 1.5"
        )
    if not isinstance(evaluate, str) or evaluate not in ("center", "middle"):
        raise InputError(f"evaluate = {evaluate!r} must be 'center' or 'middle'")
    if not isinstance(order, str) or order not in ("first", "last"):
        raise InputError(f"order = {order!r} must be 'first' or 'last'")
    if isinstance(priority, str) and priority not in ("alpha", "circumradius"):
        raise InputError(
            f"priority = {priority!r} must be 'alpha', 'circumradius' or a size to divide the circumradius by"
        )
    general = priority is not None and not (isinstance(priority, str) and priority == "alpha")
    return k.Rule(float(accept), general, 1.0, evaluate == "center", order == "last", bool(split), 0.0)
