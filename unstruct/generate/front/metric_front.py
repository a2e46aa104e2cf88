"""One run of `advancing_front` in a metric: the queue for its kernels, the finishing pass, the account."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, ROOM
from ...base.errors import InputError
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.stars import Stars, opposite_half_edges
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...sizing.metric import Metric
from ..bodies.laying import too_many
from ..boundary.constrained import planar_complex
from ..rebay.queue import ACCEPTED, STATUS, empty_queue, grown_links
from ..rebay.run import FRONT_STEPS_A_CALL
from . import metric_improve as improving
from . import metric_resize as resizing
from . import metric_steps as k
from .bookkeeping import FRONT_COUNTS, MADE, WIDEST, FrontRule
from .run import LENGTHS, ORDERS, PLACEMENTS, SPARE_NUMBERS, WIDTHS, accounted, columns, longer_diary

__all__ = ["MetricRun", "filled_by_metric"]

# Before the front starts, passes of swaps for metric circles: at most so many, and so many triangles seen.
FEWEST_PASSES, MOST_PASSES, MOST_SEEN = 12, 400, 4e6
METRIC_FINISH_NAMES = ("moves", "swaps", "points again", "removed")
RESIZE_ROUNDS = range(1, 6)  # in which long edges get points, and vertices at short edges are removed
FINISH_ROUNDS = 7  # of swaps and moves, at most
FEW_CHANGES = 2e-3  # a round that changes fewer places than this share of the vertices is the last one
GOOD_STAR = 0.96  # stars whose triangles have all at least this metric quality are not looked at
MOVED_A_CALL = 50_000  # vertices looked at in one kernel call
REPORTED_LENGTH = 2.0  # triangles with a longer edge, in the metric, are reported


class MetricRun:
    """The state of one run.

    Parameters
    ----------
    domain : Domain
    complex_ : PlanarComplex
        The triangulation to start from, its pieces cut by the metric.
    metric : Metric
    order, placement : str
        As for `advancing_front`, checked.
    history : bool
        Whether to keep a record of each step.
    """

    def __init__(
        self,
        domain: Domain,
        complex_: PlanarComplex,
        metric: Metric,
        order: str,
        placement: str,
        history: bool,
    ):
        self.domain, self.complex, self.history = domain, complex_, history
        self.circles = False  # whether metric circles are to be empty in the end
        c, rank = complex_, ORDERS.index(order)
        table = metric.table(*domain.bounds, factor=c.factor)
        self.table, self.expected = table.nodes, table.area() / np.sqrt(0.75)  # points: half the triangles
        if len(c.where) < c.segments + SPARE_NUMBERS:
            c.reserve(c.size, c.segments + SPARE_NUMBERS)
        scale = 1.0 if rank == WIDEST else self._scale(rank)
        self.rule = FrontRule(rank, PLACEMENTS.index(placement), scale, c.segments, 0.0)
        buckets = WIDTHS if rank == WIDEST else LENGTHS
        self.links, self.gates, self.turn = empty_queue(0, buckets, 0)
        self.counts = np.zeros(FRONT_COUNTS, dtype=np.int64)
        self.first, self.spent, self.most = c.size, "", c.size
        self.diary = longer_diary(None, 0, history)
        self.reserve(int(c.size + 1000 + min(1.2 * self.expected, 1e7)))

    def _scale(self, rank: int) -> float:
        """What makes the measure of the order at least about 1."""
        c = self.complex
        if rank == ORDERS.index("smallest"):
            return float(np.exp(-self.table.values[..., [0, 2]].sum(axis=-1).min()))
        return float(len(c.xy)) ** 2  # the longest edge has at most about as many units

    def reserve(self, vertices: int) -> None:
        """Make room for so many vertices in all."""
        c = self.complex
        if vertices > len(c.xy):
            c.reserve(vertices, len(c.where))
        if len(c.region) > len(self.links):
            self.links = grown_links(self.links, len(c.region))
        self.scratch = c.scratch()
        self.diary = longer_diary(self.diary, len(c.region), self.history)

    def marching(self) -> k.MetricMarching:
        """The queue, the metric and the choices, as they are now."""
        return k.MetricMarching(self.links, self.gates, self.turn, self.table, self.rule)

    def stars(self) -> Stars:
        """The arrays for swaps and moves; vertices that were given or lie on segments stay."""
        c = self.complex
        at, still = np.empty(c.size, dtype=np.int32), np.zeros(c.size, dtype=bool)
        opposite_half_edges(c.vertex, c.region, c.triangles, at)
        still[: self.first] = True
        still[at < 0] = True
        still[c.ends[: c.segments].ravel()] = True
        ring, places = np.empty(c.size + 8, dtype=np.int32), np.empty((c.size + 9, 2))
        none, counts = np.empty(0, dtype=np.int32), np.zeros(2, dtype=np.int64)
        return Stars(c.xy, c.vertex, c.twin, c.mark, c.where, at, still, ring, places, none, counts)

    def march(self, budget: int, bar: Any) -> None:
        """Advance until the front is empty, or until there are so many new points."""
        c = self.complex
        self._swap_for_circles(min(max(int(MOST_SEEN / c.triangles), FEWEST_PASSES), MOST_PASSES))
        self.most = self.first + budget
        k.start_metric_front(c.plane(), self.marching())
        while True:
            before, limit = c.size, min(FRONT_STEPS_A_CALL, self.most - c.size)
            if limit <= 0:
                self.spent = "budget"
                break
            status = k.advance_in_metric(
                c.plane(), self.marching(), self.scratch, self.diary, self.counts, limit
            )
            if status == ROOM:
                self.reserve(2 * c.size + 1000)
            if bar is not None:
                bar.update(c.size - before)
            if status == DONE:
                break
        mark = c.mark[: 3 * c.triangles]
        mark[mark == self.rule.number] = -1

    def _swap_for_circles(self, passes: int) -> None:
        """Swap diagonals until metric circles are empty, or for so many passes."""
        c, stars = self.complex, self.stars()
        for _ in range(passes):
            if improving.swap_for_circles(stars, c.region, c.triangles, self.table) == 0:
                break

    # ------------------------------------------------------------------ finishing and the account

    def finish(self, most: int) -> dict[str, int]:
        """Mend edges of wrong lengths, swap diagonals, and move vertices, for a few rounds."""
        c = self.complex
        done = dict.fromkeys(METRIC_FINISH_NAMES, 0)
        stars, todo = self.stars(), np.ones(c.size, dtype=bool)
        for number in range(FINISH_ROUNDS):
            before, removed = c.size, 0
            if number in RESIZE_ROUNDS:
                corners = c.vertex[: 3 * c.triangles].copy()
                look = np.ones_like(todo) if number == 1 else todo
                removed = resizing.remove_short(c.plane(), stars, self.table, look)
                self._split(look, most)
                stars, todo = self.stars(), self._touched(corners, todo)
            swaps = improving.swap_in_metric(stars, c.region, c.triangles, self.table, todo)
            again = np.zeros(c.size, dtype=bool)
            moves = 0
            for start in range(0, c.size, MOVED_A_CALL):
                stop = min(start + MOVED_A_CALL, c.size)
                moves += improving.improve_in_metric(stars, todo, again, self.table, GOOD_STAR, start, stop)
            for name, times in zip(METRIC_FINISH_NAMES, (moves, swaps, c.size - before, removed)):
                done[name] += times
            todo = again
            if number > 0 and moves + swaps + c.size - before + removed <= FEW_CHANGES * c.size:
                break
        if self.circles:
            self._swap_for_circles(MOST_PASSES)
        return done

    def _touched(self, corners: NDArray[np.int32], todo: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """The vertices of ``todo``, and the corners of triangles that have changed since ``corners``."""
        c = self.complex
        now = c.vertex[: 3 * c.triangles]
        changed = np.ones(len(now), dtype=bool)
        changed[: len(corners)] = now[: len(corners)] != corners
        touched = now.reshape(-1, 3)[changed.reshape(-1, 3).any(axis=1) & c.kept()]
        found = np.zeros(c.size, dtype=bool)
        found[: len(todo)] = todo
        found[touched.ravel()] = True
        return found

    def _split(self, todo: NDArray[np.bool_], most: int) -> None:
        """Give long edges a point."""
        c, t = self.complex, 0
        while True:
            t = resizing.split_long(c.plane(), self.scratch, self.table, todo, t, most)
            if t >= c.triangles or c.size >= most:
                return
            self.reserve(2 * c.size + 1000)

    def figures(self) -> dict[str, float]:
        """Number of triangles, minimum and mean metric quality, and the metric lengths of the edges."""
        c, found = self.complex, np.zeros(7)
        improving.survey_in_metric(c.xy, c.vertex, c.twin, c.region, c.triangles, self.table, found)
        return {
            "triangles": float(found[0]),
            "minimum metric quality": float(found[2]),
            "mean metric quality": float(found[1] / max(found[0], 1.0)),
            "edges within √2": float(found[4] / max(found[3], 1.0)),
            "shortest edge": float(found[5]),
            "longest edge": float(found[6]),
        }

    def result(self, finish: bool) -> DomainMesh:
        """The mesh with its account, after the finishing pass if it is wanted."""
        c = self.complex
        made = self.diary.slots[: int(self.counts[MADE])]
        figures, more, order = self.figures(), {}, None
        if finish and not self.spent:
            more = self.finish(self.most)
            after = self.figures()
            figures = {f"{name} before": x for name, x in figures.items()}
            figures |= {f"{name} after": x for name, x in after.items()}
        else:
            undone = np.flatnonzero(self.links[: c.triangles, STATUS] != ACCEPTED)
            order = np.concatenate([made, undone])
        steps = self.steps if self.history else None
        return accounted(
            self.domain, c, steps, self.missed(), self.counts, more, order=order, figures=figures
        )

    def missed(self) -> dict[int, str]:
        """The triangles with an edge that is too long in the metric, and why."""
        c = self.complex
        long = np.zeros(c.triangles, dtype=bool)
        improving.find_long(c.xy, c.vertex, c.region, c.triangles, self.table, REPORTED_LENGTH, long)
        return dict.fromkeys(np.flatnonzero(long).tolist(), self.spent or "too large: no room for a point")

    def steps(self, place: NDArray[np.int32]) -> dict[str, NDArray]:
        """The record by columns; see `advancing_front`. ``place[v]`` is the final number of vertex v."""
        c, made = self.complex, int(self.counts[MADE])
        numbers = self.diary.numbers[:made]
        return columns(self.diary, made, place) | {
            "ideal": numbers[:, :2] / c.factor,
            "size": numbers[:, 2] / c.factor,
            "radius": numbers[:, 3].copy(),
        }


def filled_by_metric(planar: Domain, metric: Metric, most: int) -> DomainMesh:
    """A domain of the plane whose pieces stay as they are, meshed by a metric: for faces of bodies.

    In the end the metric circles of its triangles are empty, so that cells of the body can have them as faces
    without ado (see `space_front.metric_start`).
    """
    run = MetricRun(planar, planar_complex(planar, metric), metric, "widest", "circle", False)
    run.circles = True
    run.march(most, None)
    if run.spent:
        raise InputError(too_many(most + 1, most))
    return run.result(True)
