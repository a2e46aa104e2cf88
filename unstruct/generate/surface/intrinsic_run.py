"""Intrinsic Delaunay refinement of a given surface: the loop around the kernels of `intrinsic_steps`.

*Theorem.* Let a surface be closed, without kept edges, with at least pi / 3 around each vertex. Put
circumcenters of triangles with an angle below 30 degrees until there is none. This ends. *Proof.* Let s be
the length of the shortest edge of the first intrinsic Delaunay triangulation. Such a triangle has a
circumradius R longer than its shortest edge, at least s by induction. Its open circumscribed disc is an
immersed flat disc without vertices, so no line from the new vertex to another one is shorter than R. A line
from the new vertex back to itself goes around a vertex at the distance R or more; if the angle there is w <
pi, it has the length 2 R sin(w / 2) at least, which is R for w = pi / 3. So no edge is ever shorter than s,
and the surface has room for finitely many discs of radius s / 2. ∎

*What is proved, and where.* The theorem is for intrinsic triangles, of closed surfaces without kept edges, of
any genus, that have no sharp cone; it says nothing of the straight triangles in space, whose angles differ
where the surface bends, nor of rounding. The argument is Chew's for the plane, with Sharp, Soliman and
Crane's intrinsic circumcenters. Tests measure it on thin frames of genus 1 to 3: no angle below 30 degrees,
no edge shorter than s. Triangles with a corner of less than pi / 3 opposite their shortest side are left.

With boundaries and kept edges, midpoints of these are put as J. Ruppert does in the plane; the bound is then
20.7 degrees in theory, if kept edges meet at 60 degrees or more. At smaller angles nothing shorter than half
of s is divided.

Sources: N. Sharp, Y. Soliman and K. Crane, *Navigating intrinsic triangulations*, ACM Trans. Graphics 38
(2019); L. P. Chew, *Guaranteed-quality mesh generation for curved surfaces*, SoCG 1993; J. Ruppert, *A
Delaunay refinement algorithm for quality 2-dimensional mesh generation*, J. Algorithms 18 (1995). Book: 2.7.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import sine
from ...connect.surface.intrinsic import IntrinsicTriangulation
from ...connect.surface.tracing import Line
from ...domain.given_surface import GivenSurface
from ...mesh.mesh import Mesh
from .intrinsic_steps import Bounds, Queues, halve_sides, refine_triangles, worst_triangles
from .own_crossings import OwnCrossings

__all__ = ["IntrinsicRun"]

Array = NDArray[np.float64]
SHARP_CORNER = np.pi / 3  # angles below it, whole or between kept edges, are no reason to divide
LONGER_KEPT = 2.0**0.5  # kept edges may be so many times as long as wanted
REFINING_PASSES = 1000
CLOSER_SHRINK, LEAST_SHRINK, GREATEST_SHRINK = (
    0.7,
    0.35,
    0.6,
)  # by how much shorter edges are wanted at a time
WALK_ROOM = 512
LINE_ROOM = 4096


class IntrinsicRun:
    """A run of refinement.

    Parameters
    ----------
    given : GivenSurface
    rows : (m, 3) int32
        Its triangles, each of equal points by the same number.
    size : function (k, 3) -> (k,), optional
        The wanted edge length.
    min_angle : float
        Degrees; 0 for none.
    budget : int
        The most vertices.
    """

    def __init__(
        self, given: GivenSurface, rows: NDArray[np.int32], size: Any, min_angle: float, budget: int, bar: Any
    ):
        support = given.support
        self.given, self.size, self.budget, self.bar = given, size, budget, bar
        self.found = IntrinsicTriangulation(Mesh(support.points, rows), support.features)
        self.found.delaunay()
        self.sine = 2.0 * float(sine(np.radians(min_angle)))
        self.own = OwnCrossings(support)
        self.repaired = 0
        self.out_of_budget = False
        self.floor = 0.0
        many = int(self.found.shape.numbers[1])
        self.wanted = np.full(many, np.inf)
        self.sharp = self._sharp(many)
        self.measured = 0
        self.measure()
        self.queues = self._queues()

    # ------------------------------------------------------------------ what is wanted

    def measure(self) -> None:
        """Ask for the size at the vertices that are new since."""
        many = int(self.found.shape.numbers[1])
        if self.size is not None and many > self.measured:
            places = self.found.points[self.measured : many]
            self.wanted[self.measured : many] = self.size(places) * self.found.factor
        self.measured = many

    def _sharp(self, many: int) -> NDArray[np.bool_]:
        """Vertices with less than `SHARP_CORNER` around them, or between kept edges that end there."""
        sides, ground = self.found.sides, self.found.shape.ground
        result = (ground.around < SHARP_CORNER) & (ground.first >= 0)
        kept = np.flatnonzero(sides.under >= 0)
        v, turn = sides.vertex[kept], sides.turn[kept]
        open_ = kept[sides.twin[kept] < 0]  # the last edge of a boundary vertex runs toward it
        end = sides.vertex[np.where(open_ % 3 == 2, open_ - 2, open_ + 1)]
        v = np.concatenate([v, end])
        turn = np.concatenate([turn, ground.around[end]])
        order = np.lexsort((turn, v))
        v, turn = v[order], turn[order]
        same = v[1:] == v[:-1]
        result[v[1:][same & (np.diff(turn) < SHARP_CORNER)]] = True
        closed = np.ones(many, dtype=bool)
        closed[end] = False
        last = np.flatnonzero(np.append(~same, True) if len(v) else [])
        first = np.flatnonzero(np.insert(~same, 0, True) if len(v) else [])
        gap = turn[first] + ground.around[v[first]] - turn[last]
        inner = closed[v[first]] & (first != last)
        result[v[first][inner & (gap < SHARP_CORNER)]] = True
        return result

    # ------------------------------------------------------------------ room

    def _queues(self) -> Queues:
        many = 3 * len(self.found.shape.sides.content)
        line = Line(np.empty(LINE_ROOM, np.int32), np.empty(LINE_ROOM), np.zeros(6))
        return Queues(
            np.zeros(many, np.bool_), np.empty(many, np.int64), np.empty(64, np.int64),
            np.empty((WALK_ROOM, 5)), line,
        )  # fmt: skip

    def _grow(self) -> None:
        """Room for half as many triangles and vertices again, and for longer lines."""
        shape = self.found.shape
        self.found.reserve(int(shape.numbers[0]) // 2 + 64, int(shape.numbers[1]) // 2 + 64)
        self.found.more_crossings()
        many = len(self.found.shape.places.origin)
        for name in ("wanted", "sharp"):
            old = getattr(self, name)
            new = np.zeros(many, dtype=old.dtype)
            new[: len(old)] = old
            setattr(self, name, new)
        line = self.queues.line
        self.queues = self._queues()
        room = 2 * len(line.side)
        self.queues = self.queues._replace(line=Line(np.empty(room, np.int32), np.empty(room), np.zeros(6)))

    @property
    def bounds(self) -> Bounds:
        """What triangles must be like, for kernels."""
        room = min(len(self.wanted), self.budget)
        return Bounds(self.wanted[:room], self.sine, self.floor, self.sharp)

    # ------------------------------------------------------------------ changes

    def _driven(self, operation: Any, rows: NDArray[np.int64]) -> int:
        """Run an operation over rows; how many vertices it put."""
        tally, first, shown = np.zeros(2, dtype=np.int64), 0, int(self.found.shape.numbers[1])
        while first < len(rows):
            if int(self.found.shape.numbers[1]) >= self.budget:
                self.out_of_budget = True
                break
            first = operation(self.found.shape, self.bounds, self.queues, rows, first, tally)
            self.bar.update(int(self.found.shape.numbers[1]) - shown)
            shown = int(self.found.shape.numbers[1])
            if first < len(rows) and int(self.found.shape.numbers[1]) < self.budget:
                self._grow()
        self.measure()
        return int(tally[0])

    def halve_long(self) -> None:
        """Halve kept edges that are longer than wanted."""
        while not self.out_of_budget:
            sides = self.found.sides
            h = np.flatnonzero((sides.under >= 0) & (sides.twin < np.arange(len(sides.twin))))
            after = np.where(h % 3 == 2, h - 2, h + 1)
            wanted = np.minimum(self.wanted[sides.vertex[h]], self.wanted[sides.vertex[after]])
            rows = h[sides.length[h] > LONGER_KEPT * wanted]
            put = self._driven(halve_sides, rows.astype(np.int64)) if len(rows) else 0
            if put + self.equalize() == 0:
                break

    def bad(self) -> tuple[NDArray[np.int64], Array]:
        """Triangles that are too large or too sharp, the largest circumradius first."""
        many = int(self.found.shape.numbers[0])
        rows, radii = np.empty(many, dtype=np.int64), np.empty(many)
        count = worst_triangles(self.found.shape.sides, self.bounds, many, rows, radii)
        order = np.lexsort((rows[:count], -radii[:count]))
        return rows[order], radii[order]

    def _settle_floor(self) -> None:
        """Half the shortest edge that there is or that the size asks for: set once."""
        if self.floor == 0.0:
            least = min(
                float(self.found.sides.length.min()), float(self.wanted[: self.measured].min()) / LONGER_KEPT
            )
            self.floor = 0.5 * least

    def angles_below(self) -> NDArray[np.int64]:
        """Triangles with an angle that is less than wanted, for whatever reason."""
        x = self.found.sides.length.reshape(-1, 3)
        radius = x[:, 0] * x[:, 1] * x[:, 2] / self.found.sides.content
        return np.flatnonzero(x.min(axis=1) < self.sine * radius * (1.0 - 1e-12))

    def too_large(self) -> NDArray[np.int64]:
        """Triangles that are larger than wanted."""
        sides = self.found.sides
        x, wanted = sides.length.reshape(-1, 3), self.wanted[sides.vertex].reshape(-1, 3).min(axis=1)
        radius = x[:, 0] * x[:, 1] * x[:, 2] / sides.content
        return np.flatnonzero(radius > wanted / LONGER_KEPT)

    def refine(self) -> None:
        """Put vertices until all triangles are as they should be, or nothing more can be done."""
        self.halve_long()
        self._settle_floor()
        for _ in range(REFINING_PASSES):
            rows, _ = self.bad()
            if len(rows) == 0 or self.out_of_budget:
                break
            if self._driven(refine_triangles, rows) + self.equalize() == 0:
                break

    def divide(self, rows: NDArray[np.int64]) -> int:
        """Halve edges for another reason; how many vertices were put."""
        put = self._driven(halve_sides, rows.astype(np.int64)) + self.equalize()
        self.repaired += put
        return put

    def want_less(self, triangles: NDArray[np.int64], excess: Array) -> None:
        """Want shorter edges at the corners of triangles that are so many times too far from the surface.

        Across a crease the distance is proportional to the length of edges.
        """
        sides = self.found.sides
        x = sides.length.reshape(-1, 3)[triangles]
        largest = (
            LONGER_KEPT * x[:, 0] * x[:, 1] * x[:, 2] / sides.content[triangles]
        )  # the size that it fits
        less = largest * np.clip(CLOSER_SHRINK / excess, LEAST_SHRINK, GREATEST_SHRINK)
        corners = sides.vertex.reshape(-1, 3)[triangles]
        for k in range(3):
            np.minimum.at(self.wanted, corners[:, k], less)

    def equalize(self) -> int:
        """Halve edges at cuts as the same edge of another sheet has been; how many vertices were put.

        Kept edges are only halved, so that all sheets' vertices belong to one dyadic tree, exactly.
        """
        cut, put = self.found.gluing.cut, 0
        while cut.any() and not self.out_of_budget:
            h = np.flatnonzero((self.found.sides.under >= 0) & (self.found.sides.twin < 0))
            h = h[cut[self.found.sides.under[h]]]
            group, low, high = self.intervals(h)
            middle = (low + high) / 2
            there = set(zip(group.tolist(), low.tolist())) | set(zip(group.tolist(), high.tolist()))
            rows = [i for i, g, m in zip(h.tolist(), group.tolist(), middle.tolist()) if (g, m) in there]
            if not rows:
                break
            put += self._driven(halve_sides, np.array(rows, dtype=np.int64))
        return put

    def intervals(self, h: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array, Array]:
        """The given edge under half-edges, and where they begin and end on it, from its lesser vertex on."""
        sides, places = self.found.sides, self.found.shape.places
        rows = np.asarray(self.found.surface.simplices).ravel()
        s = sides.under[h].astype(np.int64)
        first, last = rows[s].astype(np.int64), rows[np.where(s % 3 == 2, s - 2, s + 1)].astype(np.int64)
        turned = first > last
        group = np.minimum(first, last) * len(self.found.surface.points) + np.maximum(first, last)
        ends = []
        for k, v in enumerate((sides.vertex[h], sides.vertex[np.where(h % 3 == 2, h - 2, h + 1)])):
            at = np.where(places.side[v] == s, places.at[v], 1.0 - places.at[v])
            at = np.where(places.face[v] < 0, float(k), at)
            ends.append(np.where(turned, 1.0 - at, at))
        return group, ends[0], ends[1]
