"""One run of `prismatic_layers`: rays that get directions and heights, and are lowered until all is valid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.progress import progress_bar
from ...sizing.stretching import Layers
from .clear import Border, Over, Skin, clashes, inside_out, skin_of, surrounded
from .columns import bad, blind
from .creases import Fans, no_fans
from .directions import directed
from .fans import NO_APEXES, apex_heights, apexes_of, cap_of, fan_faults, on_cap, spread_directions
from .heights import LOWER_BY, edges_of_columns, graded, limited, placed
from .marching import marched
from .records import COLUMN, CROSSING_RAY, HIDDEN_RAY, Rays, Walls
from .split import twisted
from .stars import stars_of
from .walls import LARGEST_COORDINATE, Base

__all__ = ["PrismOptions", "PrismRun"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

SLOPE = 1.0  # how much heights of neighbors differ at most; unit: the length of their edge
# A ray that is lowered again and again is lowered by smaller factors, up to these many times; then it has no
# height. So layers get into any gap that doubles can tell from none, and it ends.
LOWERINGS = ((12, LOWER_BY), (18, 0.3), (36, 0.05))
FASTER_ROUNDS = 80  # after so many rounds what is wrong loses its layers at once
WIDER_ROUNDS = 100  # ... and then its neighbors, too, in rings that grow from round to round
LOWER_APEXES = 8  # so many times pyramids on top of layers are lowered before the layers are


class PrismOptions(NamedTuple):
    """How rays are made; see `prismatic_layers`."""

    normals: str = "visible"
    ridge: float = 40.0
    smoothing: int = 10
    recompute: bool = False
    progress: bool = False
    cells: str = "wedge"
    room: float = 0.0


DEFAULT_PRISMS = PrismOptions()


class PrismRun:
    """The state of one run.

    Parameters
    ----------
    base : Base
    layers : Layers
    options : PrismOptions

    Attributes
    ----------
    rays : Rays
    columns : (c, 3) int32
        The triangles of walls, as rows of rays.
    places : (levels + 1, r, 3) float64
        The places of rays on all levels, rounded.
    rounds : int
        How often heights were lowered.
    """

    def __init__(
        self,
        base: Base,
        layers: Layers,
        options: PrismOptions = DEFAULT_PRISMS,
        fans: Fans | None = None,
        single: Array | None = None,
    ):
        self.base, self.options, walls = base, options, base.walls
        self.stars = stars_of(walls.triangles, len(walls.points))
        self.fans = no_fans(walls) if fans is None else fans
        self.single = single
        self.columns, ray = self.fans.columns, self.fans.base
        self.points, self.planes = walls.points[ray], walls.planes[ray]
        heights = layers.cumulative(at=walls.points) if layers.varies else layers.cumulative()
        if heights.ndim == 2 and len(heights) != len(walls.points):
            raise InputError(
                f"layers have {len(heights)} values, but the walls have {len(walls.points)} vertices: give "
                "one value, one for each of them, or a function of the place"
            )
        farthest = float(np.abs(walls.points).max(initial=0.0))
        if not heights.max() + farthest <= LARGEST_COORDINATE:
            raise InputError(
                f"layers have the total height {heights.max():.3g}: it must be at most "
                f"{LARGEST_COORDINATE:.0e}; give fewer layers, or less growth"
            )
        total = np.broadcast_to(heights[..., -1], len(walls.points)).astype(np.float64)
        self.shares = np.atleast_2d(heights / heights[..., -1:])
        self.shares = self.shares[ray] if len(self.shares) > 1 else self.shares
        self.total, self.rounds = total[ray], 0
        self.edges = edges_of_columns(np.concatenate([self.columns, self.fans.caps]))
        self.base_row = walls.vertex[ray].astype(np.int64)
        self.border = self._border()

    @property
    def levels(self) -> int:
        """How many layers there are."""
        return self.shares.shape[-1] - 1

    @property
    def how(self) -> str:
        """What the cap is like over creases: quadrilaterals, with pyramids on them, or cut into halves."""
        if self.options.cells == "tetrahedron":
            return "halves"
        return "pyramids" if self.options.room > 0.0 else "whole"

    @property
    def apexes(self) -> Array:
        """Where the pyramids on the cap end: (q, 3), or none."""
        if self.how != "pyramids" or not len(self.fans.quads):
            return NO_APEXES
        return apexes_of(self.fans, self.places[-1], self.apex_height)

    def begin(self) -> None:
        """Give rays directions, and heights at which columns have room."""
        direction, seen = self._directed_rays()
        self.direction = np.where(seen[:, None], direction, 0.0)
        start = np.where(seen, self.total, 0.0)
        self.height, self.reason = limited(self.points, self.direction, self.columns, start)
        self.reason[~seen] = HIDDEN_RAY
        self.lowered = np.zeros(len(start), dtype=np.int64)
        quads = len(self.fans.quads) if self.how == "pyramids" else 0
        self.apex_height = apex_heights(self.fans, self.base.walls.points) if quads else np.empty(0)
        self.apex_lowered = np.zeros(quads, dtype=np.int64)
        self.tested = [np.full((len(self.points) + quads, 3), np.nan) for _ in range(2)]
        self.tested_fans = np.full(len(start), np.nan)

    def _directed(self, walls: Walls) -> tuple[Array, NDArray[np.bool_]]:
        options = self.options
        return directed(walls, options.normals, options.ridge, options.smoothing, self.stars)

    def _directed_rays(self) -> tuple[Array, NDArray[np.bool_]]:
        """The directions of all rays, and which of them see what is beside them."""
        walls, fans = self.base.walls, self.fans
        if self.single is None:
            return self._directed(walls)
        # Each sheet is a wall of its own.
        base = fans.base[: fans.sheets]
        sheets = walls._replace(
            points=self.points[: fans.sheets],
            triangles=self.columns,
            vertex=walls.vertex[base],
            planes=walls.planes[base],
        )
        options, stars = self.options, stars_of(self.columns, fans.sheets)
        direction, seen = directed(sheets, options.normals, options.ridge, options.smoothing, stars)
        direction = spread_directions(fans, direction, self.single)
        every = np.ones(len(walls.points), dtype=bool)  # a fan is seen as a whole
        every[base[~seen]] = False
        return direction, every[fans.base]

    def placed(self, height: Array) -> Array:
        """The places of rays of some heights."""
        if self.options.recompute:
            return marched(self.base.walls, self._directed, self.direction, height, self.shares)
        return placed(self.points, self.direction, height, self.shares)

    def advance(self) -> None:
        """Give rays directions and heights; lower them until all cells are positive and nothing meets."""
        self.begin()
        fresh = np.ones(len(self.columns), dtype=bool)
        with progress_bar(self.options.progress, " rounds") as bar:
            while True:
                self._grade(fresh)
                self.places = self.placed(self.height)
                wrong = self._wrong_columns(fresh)
                why = COLUMN
                if not len(wrong):
                    wrong, why = self.wrong_tops(), CROSSING_RAY
                if not len(wrong):
                    break
                fresh[:] = self._lower(wrong, why) | self.options.recompute
                bar.update(1)
        level = np.where(self.height > 0.0, self.levels, 0).astype(np.int32)
        self.rays = Rays(self.fans.base, self.direction, self.height, self.total, level, self.reason)

    def _grade(self, fresh: NDArray[np.bool_]) -> None:
        """Lower heights that differ too much; note the columns that change."""
        before = self.height
        self.height, self.reason = graded(self.points, self.edges, self.height, self.reason, SLOPE)
        if self.height is not before:
            fresh |= (self.height != before)[self.columns].any(axis=1)

    def _wrong_columns(self, fresh: NDArray[np.bool_]) -> Numbers:
        """The rays of columns that are not positive."""
        moves = self.height > 0.0
        rows = np.flatnonzero(fresh & moves[self.columns].any(axis=1))
        level = np.where(moves, self.levels, 0).astype(np.int32)
        wrong = self.columns[rows[self.bad_columns(rows, level)]]
        lost = blind(self.places, wrong, level)
        self.lowered[lost] = LOWERINGS[-1][0]  # they get no height, and the others of their columns remain
        wrong = wrong[~np.isin(wrong, lost).any(axis=1)]
        rays = np.union1d(wrong, lost).astype(np.int64)
        rays = rays[moves[rays]]
        return rays if len(rays) else self._wrong_fans()

    def _wrong_fans(self) -> Numbers:
        """The rays of fans with cells that are not positive."""
        quads, corners = self.fans.quads, self.fans.corners
        if not len(quads):
            return np.empty(0, dtype=np.int64)
        fresh, moves = self.height != self.tested_fans, self.height > 0.0
        asked = [fresh[rows].any(axis=1) & moves[rows].all(axis=1) for rows in (quads, corners)]
        some = np.flatnonzero(np.concatenate(asked))
        rows = fan_faults(self.fans, self.places, some, self.how, self.apexes, self._in_simplices)
        rays = [quads[rows[rows < len(quads)]], corners[rows[rows >= len(quads)] - len(quads)]]
        found = np.unique(np.concatenate([part.ravel() for part in rays])).astype(np.int64)
        if not len(found):
            self.tested_fans = self.height
        return found

    @property
    def _in_simplices(self) -> bool:
        """Whether the tetrahedra of cells have to be positive, too.

        With something beyond, too: `check` tests for overlap by tetrahedra, and so tests the whole mesh.
        """
        return self.options.cells == "tetrahedron" or self.options.room > 0.0

    def bad_columns(self, rows: Numbers, level: NDArray[np.int32]) -> Numbers:
        """Those of some columns, by their place, with a cell, or a part of one, that is not positive."""
        found = bad(self.places, self.columns[rows], level)
        if self._in_simplices:
            base = self.fans.base if len(self.fans.quads) else None
            turned = np.flatnonzero(twisted(self.places, self.columns[rows], level, base))
            found = np.union1d(found, turned)
        return found

    def wrong_tops(self) -> Numbers:
        """The rays whose cap meets something, or whose layers surround another part of the walls.

        Where room is to be left, a cap that is so much higher is tested after that. Pyramids on the cap that
        meet something are lowered first.
        """
        many = len(self.points)
        while True:
            rays = self._met(self.places[-1], 0)
            if not len(rays) and self.options.room > 0.0:
                low, high = self.places[0], self.places[-1]
                rays = self._met(low + (1.0 + self.options.room) * (high - low), 1)
            apexes = rays[rays >= many] - many
            apexes = apexes[self.apex_lowered[apexes] < LOWER_APEXES]
            if not len(apexes):
                return rays[rays < many]
            self.apex_lowered[apexes] += 1
            self.apex_height[apexes] *= LOWER_BY

    def _met(self, tops: Array, which: int) -> Numbers:
        """The rays whose tops, or layers below them, meet something; what has been tested before is known.

        The apexes of pyramids are counted as rays after the others.
        """
        fans, many = self.fans, len(tops)
        start, rises = np.empty(0, dtype=np.int64), self.height > 0.0
        if self.how == "pyramids":
            start = fans.quads[:, 0].astype(np.int64)
            rises = np.concatenate([rises, rises[fans.quads].all(axis=1)])
            tops = np.concatenate([tops, apexes_of(fans, tops, self.apex_height)])
        changed = (tops != self.tested[which]).any(axis=1)
        self.tested[which] = tops
        ray = np.concatenate([np.arange(many), start])
        planes = self.planes[ray]
        planes[many:] = -1  # apexes
        others, border = self.base.others, self.border

        def skin_with(how: str) -> Skin:
            above = cap_of(fans, how, np.arange(many), many + np.arange(len(start)))
            rows = np.concatenate([self.columns, above]).astype(np.int32)
            over = Over(*(on_cap(fans, how, values) for values in (fans.owner, np.arange(len(fans.owner)))))
            return skin_of(others, rows, self.base_row[ray], tops, rises, planes, border, changed, over)

        bent = self.how == "whole"  # a bent quadrilateral lies between the halves of both its diagonals
        skin = skin_with("halves" if bent else self.how)
        rays = clashes(skin_with("both") if bent and len(fans.quads) else skin)
        if not len(rays):
            rays = surrounded(skin, self.columns, rises)
        return rays if len(rays) else inside_out(skin, self.columns, border, rises)

    def _border(self) -> Border:
        """The edges at which the walls end."""
        side = np.flatnonzero(self.stars.mates < 0)
        t, k = side // 3, side % 3
        a, b = self.columns[t, (k + 1) % 3], self.columns[t, (k + 2) % 3]
        one, two = self.planes[a], self.planes[b]
        plane = np.full(len(a), -1, dtype=np.int32)
        for i in range(2):
            for j in range(2):
                same = (one[:, i] == two[:, j]) & (one[:, i] >= 0) & (plane < 0)
                plane[same] = one[same, i]
        one, two, t_fans = self.fans.rims.T
        return Border(
            np.column_stack([np.concatenate([a, one]), np.concatenate([b, two])]).astype(np.int64),
            np.concatenate([plane, self.planes[one, 0]]),
            np.concatenate([t, t_fans]),
        )

    def _lower(self, rays: Numbers, why: int) -> NDArray[np.bool_]:
        """Lower the heights of rays; which columns change."""
        self.rounds += 1
        for _ in range(max(self.rounds - WIDER_ROUNDS, 0).bit_length()):
            near = np.isin(self.columns, rays).any(axis=1)
            rays = np.unique(self.columns[near])
        rays = rays[self.height[rays] > 0.0]
        self.lowered[rays] += 1
        share = np.zeros(len(rays))
        for times, factor in LOWERINGS[::-1]:
            share[self.lowered[rays] <= times] = factor
        share *= self.rounds <= FASTER_ROUNDS
        height, reason = self.height.copy(), self.reason.copy()
        height[rays] *= share
        reason[rays] = why
        self.height, self.reason = height, reason
        changed = np.zeros(len(height), dtype=bool)
        changed[rays] = True
        return np.asarray(changed[self.columns].any(axis=1), dtype=bool)
