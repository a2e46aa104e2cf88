"""SpatialComplex: tetrahedra of given points, in which given segments and triangles are recovered.

Nothing here knows a `Domain`: points, triangles and segments are plain arrays, checked before. See the book,
2.8b.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...geometry.inside_shell import even_odd_in_space
from .arrays import CellArrays
from .flood import INWARD, flood_parts, is_flat, number_inside, write_inside
from .given import Given
from .lookup import all_faces, edges_there
from .recover import MORE_EFFORT, Recovery
from .release import Release

__all__ = ["RESTARTS", "WORTH_ANOTHER", "Recovered", "SpatialComplex", "SpatialMesh"]

WORTH_ANOTHER = 40  # with more than this missing or in parts, more effort, or a third seed, would not help
MOST_ADDED = 200_000
SHAKEN = 10  # times the star of a point that is left, before more is tried
# In a hurry, with few points left, so often in all: most leave soon, and another seed costs more.
SHAKEN_IN_HURRY, FEW_KEPT = 12, 3
# What one more seed costs for each point, and what is tried to release a point that is left; unit: what one
# more seed costs for each triangle.
SPLITTING, SHAKING_ONE = 50, 2000
RESTARTS = 3  # how many seeds are tried when something is left over


class Recovered(NamedTuple):
    """What a recovery has reached.

    Attributes
    ----------
    segments : ndarray of int32, shape (k, 2)
        Given segments and edges of triangles that are not there, neither whole nor in parts.
    triangles : ndarray of int32
        Given triangles that are not there, neither whole nor in parts.
    steiner : ndarray of int32
        Vertices that had to be added and are on given segments or triangles.
    inner : ndarray of int32
        Vertices that had to be added and are not.
    crossings : ndarray of int64, shape (4,)
        How missing segments crossed cells at the beginning: vertex-face, edge-edge, edge-face, face-face.
    seed : int
        The seed that led here.
    chains : dict of list of int by pair of int
        For each given segment, lower vertex first, that is there in parts: its vertices in order.
    """

    segments: NDArray[np.int32]
    triangles: NDArray[np.int32]
    steiner: NDArray[np.int32]
    inner: NDArray[np.int32]
    crossings: NDArray[np.int64]
    seed: int
    chains: dict[tuple[int, int], list[int]]

    @property
    def complete(self) -> bool:
        """Whether all segments and triangles are there, whole or in parts."""
        return len(self.segments) == 0 and len(self.triangles) == 0

    @property
    def exact(self) -> bool:
        """Whether all are there, and whole."""
        return self.complete and len(self.steiner) == 0

    @property
    def rank(self) -> tuple[int, int, int]:
        """What is missing, in parts, and added: of two recoveries that with the lower rank is better."""
        return len(self.segments) + len(self.triangles), len(self.steiner), len(self.inner)


class SpatialMesh(NamedTuple):
    """The cells inside, as arrays.

    ``vertex[i]`` is the vertex of the complex that point i is: below ``given`` the number of a given point.
    ``neighbors[t, k]`` is the cell opposite vertex k, -1 for none. ``faces`` are the marked faces of the
    cells, once each, seen from a cell that has them; ``triangle`` are the numbers of their given triangles.
    """

    points: NDArray[np.float64]
    vertex: NDArray[np.int32]
    simplices: NDArray[np.int32]
    neighbors: NDArray[np.int32]
    region: NDArray[np.int32]
    faces: NDArray[np.int32]
    triangle: NDArray[np.int32]


class SpatialComplex(CellArrays):
    """Tetrahedra of given points, with recovery; arrays and errors are those of `CellArrays`.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Vertices, all different. They keep their numbers.
    progress : bool
        Show a progress bar while they are inserted.
    """

    given_parts: Given | None = None

    def recover(
        self,
        triangles: ArrayLike,
        segments: ArrayLike | None = None,
        *,
        budget: int | None = None,
        seed: int = 0,
        restarts: int = RESTARTS,
        hurry: bool = False,
        history: bool = False,
        progress: bool = False,
    ) -> Recovered:
        """Make given segments edges and given triangles faces, with as few further points as are found.

        Parameters
        ----------
        triangles : array_like of int, shape (m, 3)
            Numbers of points. No two triangles meet but in common vertices and edges; no vertex is on another
            triangle or segment.
        segments : array_like of int, shape (s, 2), optional
            Further segments; edges of triangles need not be repeated.
        budget : int, optional
            How many points may be added: by default 300, and half of the number of triangles; at most
            200,000. Most of them leave the surface again.
        seed : int
            Of the random numbers by which ties and cavities are chosen.
        restarts : int
            How many seeds in all are tried as long as something is missing, or is there in parts only.
        hurry : bool
            Whether to stop at once where something is missing (then what was split stays so), or in parts and
            another seed costs less than to release the last points; where these are few, that is tried.
        history : bool
            Whether to keep a record of what the best seed has changed; see `history`.
        progress : bool
            Show progress bars.

        Returns
        -------
        Recovered
            Whatever it says is missing, the complex is a triangulation.

        Notes
        -----
        The same input and seed give the same complex. The time is about proportional to the number of
        segments that are missing at first. Sources: N. P. Weatherill, O. Hassan, Int. J. Numer. Methods Eng.
        37 (1994) 2005-2039; P.-L. George, F. Hecht, E. Saltel, Comput. Methods Appl. Mech. Eng. 92 (1991)
        269-288.
        """
        corners = np.asarray(triangles, dtype=np.int32).reshape(-1, 3)
        ends = (
            np.empty((0, 2), np.int32) if segments is None else np.asarray(segments, np.int32).reshape(-1, 2)
        )
        budget = min(300 + len(corners) // 2 if budget is None else budget, MOST_ADDED)
        if history:
            self.start_history()
        given = Given(corners, ends)
        if self._is_there(given):
            self.given_parts = given
            none = np.empty(0, dtype=np.int32)
            crossed = np.zeros(4, dtype=np.int64)
            return Recovered(none.reshape(0, 2), none, none, none, crossed, seed, {})
        before, best, score = self.saved(), self.saved(), None
        result: tuple[Recovered, Given] | None = None
        for k in range(max(restarts, 1)):
            found, parts = self._once(corners, ends, budget, seed + k, hurry, progress)
            if score is None or found.rank < score:
                score, result, best = found.rank, (found, parts), self.saved()
            if found.exact or (k > 0 and sum(found.rank[:2]) > WORTH_ANOTHER):
                break
            self.restore(before)
        assert result is not None
        self.restore(best)
        found, self.given_parts = result
        return found

    def _is_there(self, given: Given) -> bool:
        """Whether there is nothing to recover; then all triangles are marked."""
        loose = given.loose
        if len(loose) and not edges_there(self.solid(), loose).all():
            return False
        return all_faces(self.solid(), given.corner)

    def _once(
        self,
        corners: NDArray[np.int32],
        ends: NDArray[np.int32],
        budget: int,
        seed: int,
        hurry: bool,
        progress: bool,
    ) -> tuple[Recovered, Given]:
        given = Given(corners, ends)
        run = Recovery(self, given, budget=budget, seed=seed)
        run.run(progress=progress)
        release = Release(run)
        if not (hurry and (run.lost or run.lost_edges)):
            release.run()
            if hurry and 0 < len(release.kept) <= FEW_KEPT and not (run.lost or run.lost_edges):
                release.run(SHAKEN_IN_HURRY // len(release.kept))
            again = len(corners) + SPLITTING * run.added
            if not (hurry and again < SHAKING_ONE * len(release.kept)):
                self._more(run, release, progress)
        return Recovered(
            run.missing(), run.missing_triangles(),
            np.array([split.point for split in run.splits], dtype=np.int32),
            np.array(release.inner, dtype=np.int32), run.crossed, seed, given.chains(),
        ), given  # fmt: skip

    def _more(self, run: Recovery, release: Release, progress: bool) -> None:
        """Try more for the last few that are missing or in parts."""
        for run.level in range(1, len(MORE_EFFORT)):
            left = len(run.lost) + len(run.lost_edges) + len(release.kept)
            if not 0 < left <= WORTH_ANOTHER:
                return
            run.again(progress=progress)
            release.run(SHAKEN if run.level == 1 else 0)

    def flood(self, facets: int | None = None) -> int:
        """Find what is inside the first ``facets`` given triangles, by parity; the others are inner.

        Parameters
        ----------
        facets : int, optional
            By default all triangles are facets.

        Returns
        -------
        int
            How many parts there are inside: ``region`` has the number of its part for each cell, -1 outside.
            Parts are separated by facets and inner triangles.

        Notes
        -----
        If facets are missing, each cell is judged by its centroid, and all of the inside is one part; with a
        tree of boxes, that takes little more than O(cells + facets).
        """
        given = self.given_parts
        corners = np.empty((0, 3), dtype=np.int32) if given is None else given.corner[: given.count]
        root = np.empty(0, dtype=np.int32) if given is None else given.root[: given.count]
        alive = np.empty(0, dtype=bool) if given is None else given.alive[: given.count]
        facet = np.append(root < (len(root) if facets is None else facets), False).astype(np.int8)
        parity, there = np.zeros(self.slots + 1, dtype=np.int8), np.zeros(len(facet), dtype=np.bool_)
        stack = np.empty(5 * self.slots + 8, dtype=np.int32)
        parts, wrong = flood_parts(self.solid(), stack, facet, parity, there)
        wanted = (facet[:-1] > 0) & alive
        if wrong or (wanted & ~there[:-1]).any():
            self._judge_centers(corners[wanted])
            return int((self.region[: self.slots] >= 0).any())
        inside = parity[:parts] > 0
        number = np.where(inside, np.cumsum(inside) - 1, -1).astype(np.int32)
        slots = self.region[: self.slots]
        slots[:] = np.where(slots >= 0, number[slots], -1)
        return int(inside.sum())

    def _judge_centers(self, facets: NDArray[np.int32]) -> None:
        """Write region 0 for cells whose centers are inside these triangles, otherwise -1.

        The centers of flat cells say nothing. These follow their neighbors, though not through marked faces.
        """
        slots = np.flatnonzero(self.used())
        corners = self.xyz[self.vertex[: 4 * self.slots].reshape(-1, 4)[slots]]
        odd, _ = even_odd_in_space(self.xyz[: self.size], facets.astype(np.int32), corners.mean(axis=1))
        state = np.full(self.slots + 1, -1, dtype=np.int8)  # the last for what is beyond the hull
        flat = slots[is_flat(corners)]
        state[slots] = odd
        state[flat] = -1
        beyond = np.where(self.mark[: 4 * self.slots] < 0, self.across[: 4 * self.slots] >> 2, self.slots)
        beyond = beyond.reshape(-1, 4)
        while True:
            unknown = slots[state[slots] < 0]
            found = state[beyond[unknown]].max(axis=1, initial=-1)
            if not (found >= 0).any():
                break
            state[unknown] = found
        self.region[: self.slots] = -1
        self.region[slots] = np.where(state[slots] == 1, 0, -1)

    def inside_slots(self) -> NDArray[np.int64]:
        """The slots of the cells that `flood` found inside."""
        return np.flatnonzero(self.used() & (self.region[: self.slots] >= 0))

    def inside(self) -> SpatialMesh:
        """The cells that `flood` found inside, in the units of the input."""
        number, place = np.full(self.slots + 1, -1, dtype=np.int32), np.full(self.size, -1, dtype=np.int32)
        solid = self.solid()
        count, marked = number_inside(solid, number, place)
        simplices, neighbors = np.empty((count, 4), dtype=np.int32), np.empty((count, 4), dtype=np.int32)
        region = np.empty(count, dtype=np.int32)
        faces, marks = np.empty((marked, 3), dtype=np.int32), np.empty(marked, dtype=np.int32)
        write_inside(solid, number, place, INWARD, (simplices, neighbors, region), (faces, marks))
        used = np.flatnonzero(place >= 0)
        root = np.empty(0, np.int32) if self.given_parts is None else self.given_parts.root
        return SpatialMesh(
            self.points()[used], used.astype(np.int32), simplices, neighbors, region, faces, root[marks]
        )
