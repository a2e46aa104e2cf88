"""One run of an insertion in space: its arrays, which grow as needed, and the mesh in the end."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE, HIDDEN, MORE, ROOM
from ...base.errors import InputError
from ...connect.insertion.engine import grown
from ...connect.spatial.complex import Recovered, SpatialComplex, SpatialMesh
from ...connect.spatial.numbered import new_numbered, number_edges
from ...connect.spatial.opening import MAY_GO, STAR_WALLS, new_star
from ...connect.spatial.rebuilt import rebuilt
from ...connect.spatial.star import flawed_faces
from ...domain.domain import Domain
from ...geometry.edge_vectors import lengths
from ..volume.filling import numbered_regions
from .limits import BodyLimits
from .narrow import find_extents, find_touching
from .queues import enter_all, look_at_all
from .records import (
    CELLS_WAIT,
    CENTER_POINTS,
    FACET_POINTS,
    FREE_POINT,
    IN_FACES,
    IN_HEAP,
    IN_SEGMENTS,
    NO_MORE,
    OF_DOMAIN,
    REFUSED_POINTS,
    SEGMENT_POINTS,
    SUBSEGMENTS_NOW,
    VERTICES_NOW,
    VORONOI_POINTS,
    WHY_NO_MORE,
    BodyWork,
)
from .sharp import find_sharp
from .start import find_surface, planes_of
from .steps import SPARE_QUEUE, divide

__all__ = ["BodyRun", "recovered"]

BODY_STEPS_A_CALL = 5000  # steps of one kernel call, some hundredths of a second: Ctrl-C works between
# Where no budget is given: points for the shape's sake alone, on a segment of the input, on a facet, and
# there for each of its sides. Points for the size's sake allow more: see `dividing`.
MOST_ON_SEGMENT, MOST_ON_FACET, EACH_SIDE = 256, 1024, 64
NARROW_GAP = 1.0 / 16.0  # see `narrow`
FRESH_STARTS = 3  # how often the cells are made anew while only segments and facets are divided
HIDDEN_PASSES = 4  # how often cells whose centers were hidden are tried again
NO_LIMIT = 2**30
SHORTEST_TO_JUDGE = 2.0**-500  # of the largest coordinate: squares of shorter edges lose digits
MOST_SPATIAL = 2**31 // 64  # vertices for which cells can be numbered by 32 bits


def recovered(
    domain: Domain, progress: bool = False, points: NDArray[np.float64] | None = None
) -> tuple[SpatialComplex, Recovered]:
    """The cells of the vertices of a body, with its facets as faces, its parts numbered.

    With ``points`` the vertices have these places instead, as an image of the body under a linear map.
    """
    shell = domain.triangulated
    if len(domain.facets) == 0:
        raise InputError("the domain has no facets, so nothing is inside: give facets")
    cells = SpatialComplex(domain.points if points is None else points, progress=progress)
    found = cells.recover(shell.triangles, shell.segments, progress=progress)
    cells.flood(len(shell.bounding))
    if not (cells.region[: cells.slots][cells.used()] >= 0).any():
        raise InputError("the facets enclose no volume")
    return cells, found


class BodyRun:
    """The state of an insertion in a complex that has been recovered completely.

    Parameters
    ----------
    domain : Domain
    cells : SpatialComplex
    found : Recovered
        See `recovered`.
    kept : (pieces,) uint8
        Which pieces get no points.
    narrow : bool
        Whether each segment and facet gets only so many points for the shape's sake alone.
    """

    def __init__(
        self,
        domain: Domain,
        cells: SpatialComplex,
        found: Recovered,
        kept: NDArray[np.uint8],
        narrow: bool = False,
    ):
        self.domain, self.cells, self.found = domain, cells, found
        made = cells.inside()
        self.regions = numbered_regions(domain, made)
        slots = np.flatnonzero(cells.used() & (cells.region[: cells.slots] >= 0))
        cells.region[slots] = self.regions
        shell = domain.triangulated
        first, self.plane = planes_of(shell, cells.factor)
        parts = cells.given_parts
        assert parts is not None
        marks = cells.mark[: 4 * cells.slots]
        there = marks >= 0
        marks[there] = first[parts.root[marks[there]]]
        surface = find_surface(domain, found, made, cells)
        count = len(surface.ends)
        self.kept = kept[shell.piece].astype(np.int8)
        self.ends, self.parent, self.span = surface.ends.copy(), surface.parent.copy(), surface.span.copy()
        stays = np.append(kept, np.zeros(count, dtype=kept.dtype))[
            np.minimum(surface.parent, len(kept))
        ].astype(bool)
        row, _, mark = surface.wings
        stays[row[kept[shell.piece[mark]] > 0]] = True
        self.sharp, self.sharp_vertex, soft = find_sharp(
            cells.xyz[: cells.size], self.ends, self.parent, surface.wings, len(shell.triangles)
        )
        self.asked = np.where(stays, 3 << NO_MORE, 0).astype(np.int8)
        self.count = np.zeros(16, dtype=np.int64)
        self.count[VERTICES_NOW], self.count[SUBSEGMENTS_NOW] = cells.size, count
        self.given = cells.size
        self.edges = new_numbered(2 * count + 64, cells.size)
        self.feature = np.full(cells.size, OF_DOMAIN, dtype=np.int32)
        self.feature[found.inner] = FREE_POINT
        self.may_go = found.inner
        self.floor = _shortest(cells, made)
        parts_of = cells.xyz[: cells.size], self.ends, self.parent, surface.faces, surface.mark
        self.touch = find_touching(cells.size, *parts_of[1:], len(self.kept))
        self.extent = find_extents(*parts_of, len(self.kept))
        segments = int(self.parent.max()) + 1 if count else 0
        self.narrow = narrow
        self.left = np.full(segments, MOST_ON_SEGMENT if narrow else NO_LIMIT, dtype=np.int32)
        self.left_facet = np.full(len(self.kept), MOST_ON_FACET if narrow else NO_LIMIT, dtype=np.int32)
        if narrow:
            self.left_facet += EACH_SIDE * np.bincount(mark, minlength=len(self.kept)).astype(np.int32)
        self.left[soft[0]] = self.left_facet[soft[1]] = -1
        self.flag, self.why = np.zeros(0, dtype=np.int8), np.zeros(0, dtype=np.int8)
        self.heap, self.bad = np.empty(0), np.empty(0, dtype=np.int32)
        self.segments, self.faces = np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)
        self.star = new_star(0, 0)
        self.out = np.zeros(24)
        self.limits: BodyLimits
        self._reserve()
        number_edges(self.edges, self.ends, 0, count)

    # ------------------------------------------------------------------ arrays

    def _reserve(self) -> None:
        """Make room for half as much again."""
        cells, count = self.cells, self.count
        points = int(count[VERTICES_NOW])
        cells.size = points
        slots, walls = cells.slots, int(self.star.sizes[STAR_WALLS])
        cells.reserve(points + points // 2 + 1024, slots + slots // 2 + 4 * SPARE_QUEUE + walls)
        vertices, slots = len(cells.xyz), len(cells.stamp)
        if len(self.why) < slots:
            more = slots - len(self.why)
            self.why = np.append(self.why, np.zeros(more, dtype=np.int8))
            self.flag = np.append(self.flag, np.zeros(4 * more, dtype=np.int8))
            self.star = new_star(slots, vertices)
        elif len(self.star.met) < vertices:
            self.star = new_star(slots, vertices)
        self.star.met[self.may_go] = MAY_GO
        self.feature, self.floor = grown(self.feature, vertices), grown(self.floor, vertices)
        parts = int(count[SUBSEGMENTS_NOW]) + vertices - points
        self.ends, self.parent = grown(self.ends, parts), grown(self.parent, parts)
        self.span, self.asked = grown(self.span, parts), grown(self.asked, parts)
        self.segments = grown(self.segments, parts)
        if len(self.edges.key) < 6 * parts or len(self.edges.degree) < vertices:
            self.edges = new_numbered(3 * parts, vertices)
            number_edges(self.edges, self.ends, 0, int(count[SUBSEGMENTS_NOW]))
        self.heap = grown(self.heap, int(count[IN_HEAP]) * 2 + 4 * (SPARE_QUEUE + walls))
        self.bad = grown(self.bad, len(self.heap))
        self.faces = grown(self.faces, int(count[IN_FACES]) * 2 + 4 * (SPARE_QUEUE + walls))

    def work(self) -> BodyWork:
        """The arrays as they are now, in one record for the kernels."""
        return BodyWork(
            self.cells.solid(), self.star, self.edges, self.limits, self.sharp, self.touch,
            self.extent, self.sharp_vertex, self.ends, self.parent, self.span, self.asked, self.plane,
            self.kept, self.feature, self.floor, self.left, self.left_facet, self.flag, self.why, self.heap,
            self.bad, self.segments, self.faces, self.count,
        )  # fmt: skip

    # ------------------------------------------------------------------ the run

    def begin(self, limits: BodyLimits) -> None:
        """Take limits, and let everything wait that misses one.

        Raises
        ------
        InputError
            If edges are so short that quotients with them are no doubles.
        """
        least = float(self.floor[: self.given].min(initial=math.inf))
        if limits.ratio2 < math.inf and least < SHORTEST_TO_JUDGE:
            raise InputError(
                f"the shortest edge, {least / self.cells.factor:.6g}, is too short beside the largest "
                "coordinate for quotients of radii and edges: stretch the body, or use tetrahedralize"
            )
        self.limits = limits._replace(thin=NARROW_GAP if self.narrow else 0.0)
        slots = self.cells.slots
        self.heap = grown(self.heap, slots + 4 * SPARE_QUEUE)
        self.bad = grown(self.bad, len(self.heap))
        self.faces = grown(self.faces, 4 * slots + 4 * SPARE_QUEUE)
        at = _cells_at(self.cells, self.ends[: int(self.count[SUBSEGMENTS_NOW])])
        look_at_all(self.work(), self.out, at)

    def enter_again(self) -> None:
        """Fill the queue of cells anew."""
        enter_all(self.work(), self.out)

    def advance(self, budget: int, bar: Any) -> bool:
        """Put points until nothing waits, or so many are there; whether nothing waits."""
        last, passes, reached = min(self.given + budget, MOST_SPATIAL), 0, -1
        self.count[CELLS_WAIT] = 1
        for _ in range(FRESH_STARTS):
            if self._until(last, bar) != DONE or not self._make_anew():
                break
        self.count[CELLS_WAIT] = 0
        while True:
            code = self._until(last, bar)
            hidden = self.why[: self.cells.slots] >> 2 == HIDDEN
            passes += 1
            if (
                code != DONE
                or passes == HIDDEN_PASSES
                or not hidden.any()
                or self.count[VERTICES_NOW] == reached
            ):
                break
            reached = int(self.count[VERTICES_NOW])
            if not self._make_anew():
                self.why[: self.cells.slots][hidden] = 0
                enter_all(self.work(), self.out)
        self.cells.size = int(self.count[VERTICES_NOW])
        return code == DONE

    def _make_anew(self) -> bool:
        """Put Delaunay cells in place of others, if the divided surface allows that; False if not.

        Recovery and hidden centers leave cells that are not Delaunay. Once the surface is fine enough, its
        faces are Delaunay, or nearly all are, and no point that recovery has added inside is needed any
        longer.
        """
        self.cells.size = int(self.count[VERTICES_NOW])
        flaws = flawed_faces(self.cells.solid())
        if flaws == 0:
            return False
        parts = int(self.count[SUBSEGMENTS_NOW])
        new = rebuilt(self.cells, self.ends[:parts], self.may_go)
        if new is None or flawed_faces(new.solid()) >= flaws:
            return False
        self.cells = new
        waiting = self.asked[:parts]
        waiting[:] = np.where(waiting >> WHY_NO_MORE > 0, 0, waiting & ~3)
        self.count[[IN_HEAP, IN_SEGMENTS, IN_FACES]] = 0
        self.flag, self.why = np.zeros(0, dtype=np.int8), np.zeros(0, dtype=np.int8)
        self._reserve()
        self.begin(self.limits)
        return True

    def _until(self, last: int, bar: Any) -> int:
        code = MORE
        while code != DONE and self.count[VERTICES_NOW] < last:
            before = int(self.count[VERTICES_NOW])
            code = int(divide(self.work(), self.out, last, BODY_STEPS_A_CALL))
            bar.update(int(self.count[VERTICES_NOW]) - before)
            if code == ROOM:
                self._reserve()
                if self.count[IN_HEAP] > len(self.heap) // 2:
                    enter_all(self.work(), self.out)
        return code

    # ------------------------------------------------------------------ results

    def chains(self, made: SpatialMesh) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
        """The edges of inner segments in the mesh, their pieces, and the parameters of their ends."""
        parts = int(self.count[SUBSEGMENTS_NOW])
        place = np.full(self.cells.size, -1, dtype=np.int32)
        place[made.vertex] = np.arange(len(made.vertex), dtype=np.int32)
        rows = np.flatnonzero(self.parent[:parts] < len(self.domain.pieces))
        rows = rows[(place[self.ends[rows]] >= 0).all(axis=1)]
        rows = rows[np.lexsort((self.span[rows, 0], self.parent[rows]))]
        return place[self.ends[rows]], self.parent[rows].copy(), self.span[rows].copy()

    def steps(self, made: SpatialMesh) -> dict[str, NDArray]:
        """The new vertices in order, by their numbers in the mesh, and where each was put."""
        new = np.flatnonzero(made.vertex >= self.given)
        feature = self.feature[made.vertex[new]]
        kind = np.where(feature == FREE_POINT, "circumcenter", np.where(feature >= 0, "segment", "facet"))
        return {"kind": kind, "vertex": new.astype(np.int32)}

    def counts(self) -> dict[str, int]:
        """How many points were put where."""
        return {
            "Voronoi points": int(self.count[VORONOI_POINTS]),
            "circumcenters": int(self.count[CENTER_POINTS]),
            "segment points": int(self.count[SEGMENT_POINTS]),
            "facet points": int(self.count[FACET_POINTS]),
            "refused": int(self.count[REFUSED_POINTS]),
        }


def _shortest(cells: SpatialComplex, made: SpatialMesh) -> NDArray[np.float64]:
    """The shortest edge at each vertex, scaled."""
    result = np.full(cells.size, np.inf)
    corner = made.vertex[made.simplices]
    for i in range(4):
        for j in range(i):
            length = lengths(cells.xyz[corner[:, i]] - cells.xyz[corner[:, j]])
            np.minimum.at(result, corner[:, i], length)
            np.minimum.at(result, corner[:, j], length)
    return result


def _cells_at(cells: SpatialComplex, ends: NDArray[np.int32]) -> NDArray[np.int64]:
    """A cell at each edge, inside if there is one; -1 where there is none."""
    slots = np.flatnonzero(cells.used())
    corner = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[slots].astype(np.int64)
    pairs = [(i, j) for i in range(4) for j in range(i)]
    n = cells.size
    keys = np.concatenate([
        np.minimum(corner[:, i], corner[:, j]) * n + np.maximum(corner[:, i], corner[:, j]) for i, j in pairs
    ])  # fmt: skip
    owner = np.tile(slots, len(pairs))
    order = np.lexsort((cells.region[owner] < 0, keys))
    keys, owner = keys[order], owner[order]
    wanted = ends.min(axis=1).astype(np.int64) * n + ends.max(axis=1)
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[place] == wanted, owner[place], -1).astype(np.int64)
