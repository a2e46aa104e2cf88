"""Points that recovery has added are taken away again, or moved off the surface.

The last point goes first, so that the surface becomes what it was before. The marked faces at a point divide
its star into sectors. In each of them the triangles that the point has split are put in place of their
parts; then the sector is refilled without the point. Where that is not possible, another point a little
inside takes its place (`sectors`).
"""

from __future__ import annotations

from itertools import combinations, product

import numpy as np

from ..insertion.engine import grown
from .arrays import CellArrays
from .costs import ANY, EDGE
from .dropping import drop, lower_degree, shake_star
from .exchange import exchange
from .given import Given, Split, edge
from .held import holds
from .journal import (
    EVENT_MOVED,
    EVENT_RELEASED,
    EVENT_ROOM,
)
from .leaving import MOST_LEFT, NODES_WITHOUT, leave, refill_walls
from .records import COST_KIND, LOCAL_ROOM, NEW_CELLS, TARGET, Local
from .recover import Recovery
from .recovery import SPARE_SLOTS
from .sectors import POSITIVE, Cell, Face, cancelled, growing, link_of, moved, steps_off, turned, widened

__all__ = ["Release"]

NODES_BESIDE = 100  # of the search for a sector with a new point
PARTS_BESIDE = (0.25, 0.015625, 0.000244140625)  # of the way to where it may be: powers of 1/4
FEW_AT_POINT = 20  # cells: so few are no obstacle to a search without their point
SHAKES_OF_STAR = 32  # refills by chance at a point, before it is tried again: they cost less than the try
SHAKING_ROOM = 16  # unit: slots that one refill may need; each leaves free what it replaces
FEW_WALLS = 100  # the same, for the kernel that needs no more
WALLS = 400  # faces of the largest star that is looked at


class Release:
    """Takes the points of a recovery away.

    Parameters
    ----------
    recovery : Recovery
        All goals of which are there.

    Attributes
    ----------
    kept : list of Split
        What is still split.
    inner : list of int
        Points that were moved off the surface.
    """

    def __init__(self, recovery: Recovery):
        self.recovery = recovery
        self.cells: CellArrays = recovery.cells
        self.local: Local = recovery.local
        self.kept: list[Split] = []
        self.inner: list[int] = []
        self.free = np.zeros(len(self.cells.xyz), dtype=np.bool_)  # the same, by vertex
        self.gone = np.empty(4 * FEW_WALLS + 2, dtype=np.int32)

    def run(self, shakes: int = 0) -> None:
        """Release all points, the last first; then try to do without those that were moved.

        Where a point cannot be released, its star is changed by chance up to ``shakes`` times.
        """
        self.kept = []
        for split in reversed(self.recovery.splits):
            if not self._release(split) and not any(self._shaken(split) for _ in range(shakes)):
                self.kept.append(split)
        self.kept.reverse()
        self.recovery.splits = self.kept
        self.inner = [p for p in self.inner if not self._remove(p)]
        self.free[:] = False
        self.free[self.inner] = True

    # ------------------------------------------------------------------ one point

    def _lowered(self, p: int, segment: tuple[int, int] | None) -> int:
        """How many cells at p there are in ``found``, after refills that have made them few."""
        goal = np.array([p, *(segment or (-1, -1))], dtype=np.int32)
        self.cells.reserve(self.cells.size + 8, self.cells.slots + 8 * SPARE_SLOTS)
        cells, held = self.cells, self.recovery.held
        size = -1
        while size < 0:
            size = lower_degree(cells.solid(), held, self.local, cells.found, goal, FEW_AT_POINT)
            if size < 0:
                cells.reserve_events()
        return size

    def _leaves(self, split: Split, size: int) -> bool:
        """Release a point by one kernel, or move it; most can."""
        cells, given, p = self.cells, self.recovery.given, split.point
        cells.reserve(cells.size + 8, cells.slots + MOST_LEFT)
        cells.reserve_events(5 * (FEW_WALLS + MOST_LEFT) + EVENT_ROOM)
        if len(self.free) < len(cells.xyz):
            self.free = grown(self.free, len(cells.xyz))
        a, b = split.segment or (-1, -1)
        row = (p, a, b, cells.size, len(split.children), len(split.parents), *split.children, *split.parents)
        around = cells.found.cells[:size].copy()
        new = leave(
            cells.solid(), self.recovery.held, self.local, around, np.array(row, dtype=np.int32),
            given.corner, self.free, self.gone,
        )  # fmt: skip
        if new < 0:
            cells.found.cells[:size] = around
            return False
        cells.size += new
        self._done(split, self.gone[1 : 1 + self.gone[0]].tolist(), list(range(cells.size - new, cells.size)))
        return True

    def _done(self, split: Split, gone: list[int], added: list[int]) -> None:
        """Write down what a release has changed."""
        self.inner = [v for v in self.inner if v not in gone] + added
        self.recovery.drop(split)
        self.cells.at[gone] = -1
        self.free[gone] = False
        self.free[added] = True

    def _shaken(self, split: Split) -> bool:
        """Change what is around a point by chance, and try to release it."""
        if not self._ready(split):
            return False
        cells, held, done = self.cells, self.recovery.held, -1
        while done < 0:
            cells.reserve(cells.size + 8, cells.slots + SHAKING_ROOM * SPARE_SLOTS)
            cells.reserve_events()
            done = shake_star(cells.solid(), held, self.local, cells.found, split.point, SHAKES_OF_STAR)
        return self._release(split, shaken=True)

    def _ready(self, split: Split) -> bool:
        """Whether the parts of a split are not split themselves."""
        given, p = self.recovery.given, split.point
        if not all(given.alive[t] for t in split.children):
            return False
        # without triangles, only the record tells that a part is split itself
        return split.segment is None or not any(edge(p, v) in given.middle for v in split.segment)

    def _release(self, split: Split, *, shaken: bool = False) -> bool:
        if not self._ready(split):
            return False
        given, p = self.recovery.given, split.point
        size = self._lowered(p, split.segment)
        if size <= FEW_WALLS and self._leaves(split, size):
            return True
        around = self.cells.found.cells[:size].tolist()
        marks = self.cells.rows(self.cells.mark, around)
        there = (marks >= 0) & (self.cells.rows(self.cells.vertex, around) != p)
        if set(marks[there].tolist()) != set(split.children) or len(around) > WALLS:
            return False
        before, claimed = self.cells.size, set(around)
        tets: list[Cell] = []
        for sector in self._sectors(around, p):
            found = self._filled(sector, split, claimed, shaken)
            if found is None:
                self.cells.size = before
                return False
            tets += found
        restored = {frozenset(given.corner[t].tolist()): t for t in split.parents}
        added = list(range(before, self.cells.size))
        event = (EVENT_MOVED if added else EVENT_RELEASED, *_goal(split, given), 0, p)
        gone = self._gone(claimed, tets, p)
        if gone is None or not self._replace(sorted(claimed), tets, restored, event):
            self.cells.size = before
            return False
        self._done(split, gone, added)
        return True

    def _filled(self, sector: list[int], split: Split, claimed: set[int], shaken: bool) -> list[Cell] | None:
        """Tetrahedra that fill a sector of the star of a point without it; more cells may be claimed.

        After a star was shaken, what takes long and seldom helps is left out: another shake helps more.
        """
        p, restored = split.point, self._restored(sector, split)
        link, whole = cancelled(list(link_of(self.cells, sector, p)), restored)
        found = self._without(link + whole, None if split.children else split.segment)
        if found is None and split.children:
            found = moved(self.cells, link, whole, p)
        if found is None and split.children and not shaken:
            found = self._grown(sector, restored, p, claimed)
        if found is None and split.children and not shaken:
            found = self._beside(link + whole, len(link), p)
        if found is None and split.children:
            wide = widened(self.cells, sector, restored, p, claimed)
            if wide is not None:
                found = wide[0]
                claimed |= set(wide[1])
        return found

    def _gone(self, old: set[int], tets: list[Cell], p: int) -> list[int] | None:
        """The point and others inside that go with the old cells; None if what must stay would go."""
        edges = {frozenset(ends) for cell in tets for ends in combinations(cell, 2)}
        there = {v for cell in tets for v in cell}
        gone, free = {p}, {p, *self.inner}
        for v in self.cells.rows(self.cells.vertex, list(old)).tolist():
            gone.update(set(v) - there)
            for ends in combinations(v, 2):
                if p not in ends and frozenset(ends) not in edges and holds(self.recovery.held, *ends):
                    return None
        return sorted(gone) if gone <= free else None

    def _remove(self, p: int) -> bool:
        """Take a point away that is not on the surface."""
        self._lowered(p, None)
        cells = self.cells
        cells.reserve(cells.size, cells.slots + SPARE_SLOTS)
        cells.reserve_events()
        return bool(drop(cells.solid(), self.recovery.held, self.local, cells.found, p))

    def _sectors(self, around: list[int], p: int) -> list[list[int]]:
        """The cells of a star, in parts that hang together through faces that are not marked."""
        left, sectors, cells = set(around), [], self.cells
        vertex, mark = cells.rows(cells.vertex, around), cells.rows(cells.mark, around)
        over = np.where((vertex != p) & (mark < 0), cells.rows(cells.across, around) >> 2, -1)
        next_to = dict(zip(around, over.tolist(), strict=True))
        while left:
            sector = [min(left)]
            left.remove(sector[0])
            for t in sector:
                for u in next_to[t]:
                    if u in left:
                        left.remove(u)
                        sector.append(u)
            sectors.append(sector)
        return sectors

    def _restored(self, sector: list[int], split: Split) -> list[Face]:
        """The triangles that the point has split and that bound a sector, seen from within."""
        p, given = split.point, self.recovery.given
        restored: dict[tuple[int, Face], Face] = {}
        marks = self.cells.rows(self.cells.mark, sector)
        vertex = self.cells.rows(self.cells.vertex, sector)
        for i, k in np.argwhere((marks >= 0) & (vertex != p)).tolist():
            number = int(marks[i, k])
            if number in split.children:
                v, parent = vertex[i].tolist(), self._parent(number, split)
                face = [v[j] for j in POSITIVE[k]]
                (lacking,) = set(given.corner[parent].tolist()) - set(face)
                seen = turned([lacking if x == p else x for x in face])
                restored[parent, seen] = seen
        return list(restored.values())

    def _parent(self, child: int, split: Split) -> int:
        """The triangle that a part belongs to: the one that has all its vertices but the point."""
        given = self.recovery.given
        others = set(given.corner[child].tolist()) - {split.point}
        return next(t for t in split.parents if others <= set(given.corner[t].tolist()))

    # ------------------------------------------------------------------ refills

    def _without(self, walls: list[Face], segment: tuple[int, int] | None) -> list[Cell] | None:
        """Tetrahedra within these walls on their vertices alone, with the segment, if any."""
        size = self.local.size
        size[COST_KIND] = ANY if segment is None else EDGE
        if segment is not None:
            size[TARGET : TARGET + 2] = segment
        if not walls:
            return []
        there = set().union(*walls)
        if segment is not None and not there >= set(segment):
            return None  # a part of it is not there
        rows = np.array(walls, dtype=np.int32)
        found = len(there) <= LOCAL_ROOM and refill_walls(
            self.cells.solid(), self.local, rows, -1, NODES_WITHOUT
        )
        return self._found() if found else None

    def _beside(self, walls: list[Face], around: int, p: int) -> list[Cell] | None:
        """As `moved`, where some walls do not see the new point: these may get other tetrahedra.

        The first walls are ``around`` the point.
        """
        rows, cells = np.array(walls, dtype=np.int32), self.cells
        self.local.size[COST_KIND] = ANY
        q, here = cells.size, cells.xyz[p].copy()
        for part, way in product(PARTS_BESIDE, steps_off(cells, rows, around, p)):
            cells.xyz[q] = here + part * way
            if refill_walls(cells.solid(), self.local, rows, q, NODES_BESIDE):
                cells.size += 1
                return self._found()
        return None

    def _grown(self, sector: list[int], whole: list[Face], p: int, claimed: set[int]) -> list[Cell] | None:
        """As `_without`, with cells beyond the walls, which are claimed then."""
        for walls, more in growing(self.cells, sector, whole, p, claimed):
            found = self._without(walls, None)
            if found is not None:
                claimed |= set(more)
                return found
        return None

    def _found(self) -> list[Cell]:
        """The tetrahedra of the best refill."""
        size = self.local.size
        return [tuple(row) for row in self.local.label[self.local.best[: size[NEW_CELLS]]].tolist()]

    def _replace(
        self,
        old: list[int],
        tets: list[Cell],
        restored: dict[frozenset, int],
        event: tuple[int, int, int, int, int, int],
    ) -> bool:
        """Replace cells by others that fill the same space; False, and no change, if faces do not fit."""
        cells = self.cells
        cells.reserve(cells.size, cells.slots + len(tets))
        cells.reserve_events(5 * (len(old) + len(tets)) + EVENT_ROOM)
        marks = [(*face, number) for face, number in restored.items()]
        return bool(
            exchange(
                cells.solid(),
                np.array(old, dtype=np.int32),
                np.array(tets, dtype=np.int32).reshape(-1, 4),
                np.array(marks, dtype=np.int32).reshape(-1, 4),
                np.array(event, dtype=np.int32),
            )
        )


def _goal(split: Split, given: Given) -> tuple[int, int, int]:
    """The segment or triangle that a point has split."""
    if split.segment is not None:
        return (*split.segment, -1)
    a, b, c = given.corner[split.parents[0]].tolist()
    return a, b, c
