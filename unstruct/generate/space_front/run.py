"""One run of the advancing front in space: the arrays of its kernels, which grow as needed, and the mesh."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.codes import DONE, ROOM
from ...base.errors import InputError
from ...connect.insertion.engine import grown
from ...connect.spatial.complex import Recovered, SpatialComplex
from ...connect.spatial.numbered import new_numbered, number_edges
from ...connect.spatial.opening import MAY_GO, STAR_WALLS, new_star
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ..rebay.queue import ACCEPTED, STATUS, empty_queue, grown_links
from ..volume.filling import chains_of_segments, numbered_regions, with_names
from ..volume_points.limits import REGULAR, wanted_in_space
from . import ledger as book
from . import placing
from . import steps as k

__all__ = ["SPACE_ORDERS", "SPACE_PLACEMENTS", "SpaceFrontRun", "SpacePlacement"]

SpacePlacement = Callable[[NDArray, NDArray, NDArray, float], ArrayLike | None]
SPACE_ORDERS = ("widest", "smallest", "shortest", "oldest")
SPACE_PLACEMENTS = ("equal sides", "angle", "sphere")
# Why a cell was accepted, in the order of the codes of `ledger`, and what else is counted.
SPACE_REASONS = (
    "new point", "small enough", "empty sphere", "near apex", "angle", "closed", "circumcenter", "forced",
)  # fmt: skip
SPACE_COUNT_NAMES = (*SPACE_REASONS, "set aside", "outside", "encroaching", "collisions", "flat")
CELL_WIDTHS, CELL_LENGTHS = 13, 97  # buckets for R / f, and for sizes and areas; one is for cells aside
SPACE_STEPS_A_CALL = 5000  # steps of one kernel call, some hundredths of a second: Ctrl-C works between
SPARE_CELLS = 1 << 12  # slots beyond half as many again


class SpaceFrontRun:
    """The state of a run in a complex that has been recovered completely.

    Parameters
    ----------
    domain : Domain
    cells : SpatialComplex
    found : Recovered
        See `generate.volume_points.run.recovered`.
    order, placement
        As for `advancing_front`, checked.
    history : bool
        Whether to keep a record of each step.
    """

    def __init__(
        self,
        domain: Domain,
        cells: SpatialComplex,
        found: Recovered,
        order: str,
        placement: str | SpacePlacement,
        history: bool,
    ):
        self.domain, self.cells, self.found, self.history = domain, cells, found, history
        made = cells.inside()
        self.regions = numbered_regions(domain, made)
        cells.region[cells.inside_slots()] = self.regions
        self.ends = made.vertex[chains_of_segments(domain, found, made)[0]].astype(np.int32).reshape(-1, 2)
        self.place = None if isinstance(placement, str) else placement
        kind = SPACE_PLACEMENTS.index(placement) if isinstance(placement, str) else placing.BY_CALLER
        self.rule = book.SpaceRule(SPACE_ORDERS.index(order), kind, 1.0)
        self.counts = np.zeros(book.SPACE_COUNTS, dtype=np.int64)
        self.counts[book.VERTICES_USED] = self.first = cells.size
        buckets = CELL_WIDTHS if self.rule.order == book.WIDEST_CELL else CELL_LENGTHS
        self.links, self.gates, self.turn = empty_queue(0, buckets)
        self.later = np.empty(0, dtype=np.int32)
        self.diary = book.SpaceDiary(np.zeros(0, np.int32), np.zeros((0, 6), np.int32), np.zeros((0, 5)))
        self.edges, self.star = new_numbered(len(self.ends), 0), new_star(0, 0)
        self.ask, self.answer, self.out = np.array([-1, 0]), np.zeros(3), np.zeros(24)
        self.spent = False
        self.limits: Any  # a BodyLimits

    def _reserve(self) -> None:
        """Make room for half as much again."""
        cells, points = self.cells, int(self.counts[book.VERTICES_USED])
        cells.size = points
        slots, walls = cells.slots, int(self.star.sizes[STAR_WALLS])
        cells.reserve(points + points // 2 + 1024, slots + slots // 2 + SPARE_CELLS + walls)
        vertices, slots = len(cells.xyz), len(cells.stamp)
        if len(self.links) < slots:
            self.links = grown_links(self.links, slots)
            self.later = np.empty(4 * slots, dtype=np.int32)
            numbers, log = self.diary.numbers, self.diary.log
            if self.history:
                more = slots - len(log)
                log = np.concatenate([log, np.full((more, 6), -1, dtype=np.int32)])
                numbers = np.concatenate([numbers, np.full((more, 5), np.nan)])
            self.diary = book.SpaceDiary(grown(self.diary.slots, slots), log, numbers)
        if len(self.star.cells) < slots or len(self.star.met) < vertices:
            self.star = new_star(slots, vertices)
            self.star.met[self.found.inner] = MAY_GO
        if len(self.edges.degree) < vertices:
            self.edges = new_numbered(len(self.ends), vertices)
            number_edges(self.edges, self.ends, 0, len(self.ends))

    def marching(self) -> Any:
        """The arrays as they are now, in one record for the kernels."""
        return book.SpaceMarch(
            self.cells.solid(), self.star, self.edges, self.limits, self.links, self.gates, self.turn,
            self.later, self.rule,
        )  # fmt: skip

    def march(self, limits: Any, budget: int, bar: Any) -> None:
        """Advance until the front is empty, or until there are so many new points."""
        cells, self.limits = self.cells, limits
        self.rule = self.rule._replace(scale=self._scale())
        self._reserve()
        inside = cells.inside_slots()
        at_surface = (cells.mark[: 4 * cells.slots].reshape(-1, 4)[inside] >= 0).any(axis=1)
        self._start(inside[at_surface].astype(np.int32))
        while True:
            before = int(self.counts[book.VERTICES_USED])
            limit = min(SPACE_STEPS_A_CALL, self.first + budget - before)
            if limit <= 0:
                self.spent = True
                break
            status = self._advance(limit)
            if status == k.CALLER:
                self.answer[:] = self._asked(int(self.ask[0]))
            elif status == ROOM:
                self._reserve()
            bar.update(int(self.counts[book.VERTICES_USED]) - before)
            if status == DONE:
                break
        cells.size = int(self.counts[book.VERTICES_USED])
        mark = cells.mark[: 4 * cells.slots]
        mark[mark == book.FRONT_MARK] = -1

    def _start(self, cells: NDArray[np.int32]) -> None:
        """Put the cells along the surface into the queue."""
        k.start_in_space(self.marching(), cells, self.out)

    def _advance(self, limit: int) -> int:
        """Take up to so many steps; how it ended."""
        return int(
            k.advance_in_space(
                self.marching(), self.diary, self.counts, self.ask, self.answer, self.out, limit
            )
        )

    def _scale(self) -> float:
        """What the measure of the order is divided by, or divides, so that it is at least about 1."""
        if self.rule.order == book.SMALLEST_SIZE:
            values = np.append(self.limits.values.ravel(), self.limits.size)
            return float(values[np.isfinite(values)].max() ** 2)
        if self.rule.order == book.SMALLEST_FACE:
            return 4.0  # the cells are in a cube of side 2
        return float(book.CELL_ACCEPT**2 * REGULAR**2)

    def _asked(self, face: int) -> NDArray[np.float64]:
        """The point that the function of the caller wants for a face, scaled; NaN for the apex ahead."""
        cells, place = self.cells, self.place
        assert place is not None
        t, i = face >> 2, face & 3
        corners = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]][i]
        vertices = cells.vertex[4 * t : 4 * t + 4][corners]
        a, b, c = cells.xyz[vertices] / cells.factor
        middle = cells.xyz[vertices].mean(axis=0)
        h = float(wanted_in_space(self.limits, cells.region[t], *middle)) / cells.factor
        where = f"the front face {a.tolist()}, {b.tolist()}, {c.tolist()}"
        try:
            point = place(a, b, c, h)
        except Exception as error:
            raise InputError(
                f"placement raised {type(error).__name__} ({error}) for {where}; it is called as "
                "placement(a, b, c, h) and returns a point (x, y, z) or None"
            ) from error
        if point is None:
            return np.full(3, np.nan)
        try:
            x = np.asarray(point, dtype=float)
        except (TypeError, ValueError):
            x = np.empty(0)
        if x.shape != (3,) or not np.isfinite(x).all():
            raise InputError(f"placement returned {point!r} for {where}; return a point (x, y, z) or None")
        return x * cells.factor

    # ------------------------------------------------------------------ results

    def result(self) -> DomainMesh:
        """The mesh with its account: the accepted cells in order, then others if the budget is spent."""
        cells, made = self.cells, self.cells.inside()
        slots = cells.inside_slots()
        undone = slots[self.links[slots, STATUS] != ACCEPTED]
        number = np.searchsorted(slots, np.append(self.diary.slots[: self.counts[book.CELLS_DONE]], undone))
        place = np.full(len(slots) + 1, -1, dtype=np.int32)
        place[number] = np.arange(len(number), dtype=np.int32)
        made = made._replace(
            simplices=made.simplices[number],
            neighbors=place[made.neighbors[number]],
            region=made.region[number],
        )
        missed = dict.fromkeys(range(len(slots) - len(undone), len(slots)), "budget")
        counts = dict(zip(SPACE_COUNT_NAMES, self.counts.tolist()))
        chains = chains_of_segments(self.domain, self.found, made)
        steps = self._steps(made.vertex) if self.history else None
        return with_names(self.domain, self.found, made, chains, missed, counts, steps)

    def _steps(self, vertex: NDArray[np.int32]) -> dict[str, NDArray]:
        """The record by columns; see `advancing_front`."""
        made = int(self.counts[book.CELLS_DONE])
        place = np.full(self.cells.size + 1, -1, dtype=np.int32)
        place[vertex] = np.arange(len(vertex), dtype=np.int32)
        log, numbers = self.diary.log[:made], self.diary.numbers[:made] / self.cells.factor
        return {
            "face": place[log[:, :3]],
            "apex": place[log[:, 3]],
            "reason": np.array(SPACE_REASONS)[log[:, 4]],
            "near": place[log[:, 5]],
            "ideal": numbers[:, :3].copy(),
            "size": numbers[:, 3].copy(),
            "radius": numbers[:, 4].copy(),
        }
