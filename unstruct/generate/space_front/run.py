"""One run of the advancing front in space: the arrays of its kernels, and the account."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, ROOM
from ...connect.insertion.engine import grown
from ...connect.spatial.complex import Recovered, SpatialComplex, SpatialMesh
from ...connect.spatial.numbered import new_numbered, number_edges
from ...connect.spatial.opening import MAY_GO, STAR_WALLS, new_star
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ..rebay.queue import ACCEPTED, STATUS, empty_queue, grown_links
from ..volume.filling import chains_of_segments, numbered_regions, with_names
from ..volume_points.limits import BodyLimits
from . import ledger as book
from . import placing
from . import steps as k

__all__ = ["SPACE_ORDERS", "SPACE_PLACEMENTS", "SpaceFrontRun"]

SPACE_ORDERS = ("widest", "smallest", "shortest", "oldest")
SPACE_PLACEMENTS = ("equal edges", "dihedral", "sphere")
SPACE_REASONS = (
    "new point", "small enough", "empty sphere", "near apex", "angle", "closed", "circumcenter", "forced",
)  # fmt: skip
SPACE_COUNT_NAMES = (*SPACE_REASONS, "set aside", "outside", "encroaching", "collisions", "needles","","","e0","e1","e2","e3","searches","cells","walls","unseen")
CELL_WIDTHS, CELL_LENGTHS = 13, 97  # buckets for R / f, and for sizes and lengths; one is for cells aside
STEPS_OF_FRONT = 5000  # steps of one kernel call
SPARE = 1 << 12


class SpaceFrontRun:
    def __init__(self, domain: Domain, cells: SpatialComplex, found: Recovered, order: str, placement: str, history: bool):
        self.domain, self.cells, self.found, self.history = domain, cells, found, history
        made = cells.inside()
        slots = cells.inside_slots()
        self.regions = numbered_regions(domain, made)
        cells.region[slots] = self.regions
        self.chains = chains_of_segments(domain, found, made)
        self.ends = made.vertex[self.chains[0]].astype(np.int32).reshape(-1, 2)
        self.may_go = found.inner
        self.order, self.placement = SPACE_ORDERS.index(order), SPACE_PLACEMENTS.index(placement)
        self.counts = np.zeros(book.SPACE_COUNTS, dtype=np.int64)
        self.counts[book.VERTICES_USED] = cells.size
        self.first = cells.size
        buckets = CELL_WIDTHS if self.order == book.WIDEST_CELL else CELL_LENGTHS
        self.links, self.gates, self.turn = empty_queue(0, buckets)
        self.diary = book.SpaceDiary(np.zeros(0, np.int32), np.zeros((0, 6), np.int32), np.zeros((0, 5)))
        self.edges = new_numbered(len(self.ends), cells.size)
        self.star = new_star(0, 0)
        self.out = np.zeros(24)
        self.spent = False
        self.limits: BodyLimits
        self.rule: book.SpaceRule

    def _reserve(self) -> None:
        cells, points = self.cells, int(self.counts[book.VERTICES_USED])
        cells.size = points
        slots, walls = cells.slots, int(self.star.sizes[STAR_WALLS])
        cells.reserve(points + points // 2 + 1024, slots + slots // 2 + SPARE + walls)
        vertices, slots = len(cells.xyz), len(cells.stamp)
        if len(self.links) < slots:
            self.links = grown_links(self.links, slots)
            self.later = np.empty(4 * slots, dtype=np.int32)
            self.diary = self.diary._replace(slots=grown(self.diary.slots, slots))
            if self.history:
                more = slots - len(self.diary.log)
                self.diary = self.diary._replace(
                    log=np.concatenate([self.diary.log, np.full((more, 6), -1, dtype=np.int32)]),
                    numbers=np.concatenate([self.diary.numbers, np.full((more, 5), np.nan)]),
                )
        if len(self.star.cells) < slots or len(self.star.met) < vertices:
            self.star = new_star(slots, vertices)
            self.star.met[self.may_go] = MAY_GO
        if len(self.edges.degree) < vertices:
            self.edges = new_numbered(len(self.ends), vertices)
            number_edges(self.edges, self.ends, 0, len(self.ends))

    def march_record(self) -> book.SpaceMarch:
        return book.SpaceMarch(
            self.cells.solid(), self.star, self.edges, self.limits, self.links, self.gates, self.turn,
            self.later, self.rule,
        )  # fmt: skip

    def march(self, limits: BodyLimits, budget: int, bar: Any, tune: dict = {}) -> None:
        cells = self.cells
        self.limits = limits
        self.rule = book.SpaceRule(self.order, self.placement, 1.0, tune.get("accept", 1.2), tune.get("room", .7), tune.get("flat", 1.0), tune.get("closing", 3))
        self._reserve()
        made = cells.inside_slots()
        marks = cells.mark[: 4 * cells.slots].reshape(-1, 4)[made]
        start = made[(marks >= 0).any(axis=1)].astype(np.int32)
        self.rule = self.rule._replace(scale=self._scale(made))
        k.start_in_space(self.march_record(), start, self.out)
        while True:
            before = int(self.counts[book.VERTICES_USED])
            limit = min(STEPS_OF_FRONT, self.first + budget - before)
            if limit <= 0:
                self.spent = True
                break
            status = k.advance_in_space(self.march_record(), self.diary, self.counts, self.out, limit)
            if status == ROOM:
                self._reserve()
            bar.update(int(self.counts[book.VERTICES_USED]) - before)
            if status == DONE:
                break
        cells.size = int(self.counts[book.VERTICES_USED])
        mark = cells.mark[: 4 * cells.slots]
        mark[mark == book.FRONT_MARK] = -1

    def _scale(self, made) -> float:
        cells = self.cells
        if self.order == book.SMALLEST_SIZE:
            sizes = self.limits.values if len(self.limits.values) > 1 else self.limits.size
            return float(np.max(sizes[np.isfinite(sizes)]) ** 2)
        if self.order == book.SMALLEST_FACE:
            return 4.0
        return self.rule.accept**2 * k.REGULAR**2

    def result(self) -> DomainMesh:
        cells, n = self.cells, int(self.counts[book.CELLS_MADE])
        slots = cells.inside_slots()
        made = cells.inside()
        place = np.full(cells.slots + 1, -1, dtype=np.int64)
        accepted = self.diary.slots[:n]
        undone = slots[self.links[slots, STATUS] != ACCEPTED]
        order = np.concatenate([accepted, undone])
        number = np.searchsorted(slots, order)
        new = np.full(len(slots) + 1, -1, dtype=np.int32)
        new[number] = np.arange(len(number), dtype=np.int32)
        made = made._replace(simplices=made.simplices[number], neighbors=new[made.neighbors[number]], region=made.region[number])
        counts = dict(zip(SPACE_COUNT_NAMES, self.counts[: len(SPACE_COUNT_NAMES)].tolist()))
        return with_names(self.domain, self.found, made, chains_of_segments(self.domain, self.found, made), {}, counts)
