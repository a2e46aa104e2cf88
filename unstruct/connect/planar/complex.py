"""PlanarComplex: the triangulation of a domain while it grows, constrained edges and regions included.

All methods that mesh a planar domain work on these arrays with the kernels of `cavity`. The triangulation
covers the hull of all points, including the outside of the domain. So every change of the boundary is judged
from both sides, and whatever would touch or cross is found before it happens. See the book, 2.5.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import as_points
from ...base.errors import InputError
from ...base.jit import kernel
from ...mesh.domain_mesh import DomainMesh
from ...predicates.batch import unscaled
from ..insertion.engine import BUSY, COUNT, FREE, grown
from ..insertion.halfedges import SEGMENTS, VERTICES
from ..insertion.whole import half_edges
from .extraction import extract, named_sets, survey
from .records import Plane, Scratch

__all__ = ["PlanarComplex", "copy_all"]


# Loops, because numba takes seconds to compile assignments of slices.


@kernel
def _copy(old, new):
    for i in range(old.shape[0]):
        new[i] = old[i]


@kernel
def _copy_rows(old, new):
    for i in range(old.shape[0]):
        for k in range(old.shape[1]):
            new[i, k] = old[i, k]


@kernel
def copy_all(old, new):
    """Copy the arrays of a `Plane` to the beginnings of larger ones."""
    _copy(old.vertex, new.vertex)
    _copy(old.twin, new.twin)
    _copy(old.mark, new.mark)
    _copy(old.region, new.region)
    _copy(old.where, new.where)
    _copy(old.piece, new.piece)
    _copy_rows(old.ends, new.ends)
    _copy_rows(old.xy, new.xy)
    _copy_rows(old.span, new.span)


@kernel
def bounds(xy, n, box):
    """Write the smallest x and y, then the largest, of the first n rows."""
    box[0] = box[1] = np.inf
    box[2] = box[3] = -np.inf
    for i in range(n):
        box[0], box[1] = min(box[0], xy[i, 0]), min(box[1], xy[i, 1])
        box[2], box[3] = max(box[2], xy[i, 0]), max(box[3], xy[i, 1])


@kernel
def greatest(values, count):
    """The largest of the first ``count`` values; -1 for none."""
    most = -1
    for i in range(count):
        most = max(most, values[i])
    return most


class PlanarComplex:
    """A triangulation of the plane with constrained edges, as flat arrays for the kernels.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Vertices, all different and not all on a line. They keep their numbers.
    progress : bool
        Show a progress bar while they are inserted.

    Attributes
    ----------
    factor : float
        The power of two with ``xy = points * factor`` and |xy| <= 1.
    xy : ndarray, shape (capacity, 2)
        Coordinates of the vertices, of which ``size`` are in use.
    vertex, twin : ndarray of int32
        Half-edges, as in `insertion.plane`: three per triangle, with ghost triangles beyond the hull.
    mark : ndarray of int32
        The subsegment on each half-edge, -1 for none.
    region : ndarray of int32
        The part of the domain that each triangle belongs to: -1 outside and for ghosts.
    ends, piece, span, where : ndarray
        For each subsegment its two vertices in the direction of its piece, the piece, the parameters of the
        ends on it, and one half-edge that carries it.
    regions : dict of str to int
        The numbers of the parts that have a name.
    state : ndarray of int64, shape (16,)
        Counters that the kernels advance: triangles, vertices, subsegments, the first free slot.

    Raises
    ------
    InputError
        For duplicate points, and for coordinates whose exponents differ too much for one scale.
    DegenerateInputError
        For points on a line.
    """

    def __init__(self, points: ArrayLike, *, progress: bool = False):
        rows = as_points(points)
        if rows.shape[1] != 2:
            raise InputError(f"points have {rows.shape[1]} coordinates; a planar domain needs 2")
        made = half_edges(rows, progress=progress)
        count = len(made.vertex) // 3
        self.factor: float = made.factor
        self.xy: NDArray[np.float64] = made.xy
        self.vertex: NDArray[np.int32] = made.vertex
        self.twin: NDArray[np.int32] = made.twin
        self.mark: NDArray[np.int32] = np.empty(3 * count, dtype=np.int32)
        self.mark.fill(-1)
        self.region: NDArray[np.int32] = np.empty(count, dtype=np.int32)
        self.region.fill(-1)
        self.ends: NDArray[np.int32] = np.empty((0, 2), dtype=np.int32)
        self.piece: NDArray[np.int32] = np.empty(0, dtype=np.int32)
        self.span: NDArray[np.float64] = np.empty((0, 2))
        self.where: NDArray[np.int32] = np.empty(0, dtype=np.int32)
        self.regions: dict[str, int] = {}
        self.state: NDArray[np.int64] = np.zeros(16, dtype=np.int64)
        self.state[COUNT], self.state[FREE], self.state[VERTICES] = count, -1, len(rows)

    def take_subsegments(
        self, ends: NDArray[np.int32], piece: NDArray[np.int32], span: NDArray[np.float64],
        where: NDArray[np.int32],
    ) -> None:  # fmt: skip
        """Store these arrays, with one row per subsegment."""
        self.ends, self.piece, self.span, self.where = ends, piece, span, where
        self.state[SEGMENTS] = len(ends)

    # ------------------------------------------------------------------ counters

    @property
    def size(self) -> int:
        """How many vertices there are."""
        return int(self.state[VERTICES])

    @property
    def triangles(self) -> int:
        """How many slots for triangles are in use, ghosts and freed slots included."""
        return int(self.state[COUNT])

    @property
    def segments(self) -> int:
        """How many subsegments there are."""
        return int(self.state[SEGMENTS])

    def box(self) -> NDArray[np.float64]:
        """The smallest x and y of all vertices, then the largest, in the units of the input."""
        found = np.empty(4)
        bounds(self.xy, self.size, found)
        return found / self.factor

    def parts(self) -> int:
        """How many numbers of regions there are: one more than the largest."""
        return int(greatest(self.region, self.triangles)) + 1

    @property
    def broken(self) -> bool:
        """Whether an interrupt hit a half-done change (possible only if kernels are not compiled)."""
        return bool(self.state[BUSY])

    def reserve(self, vertices: int, segments: int) -> None:
        """Make room for this many vertices and subsegments in total; arrays that grow are replaced.

        Triangles need no count of their own: n vertices and the ghost have 2 n - 2 of them. Kernels continue
        as long as ``xy`` has rows, and it may have grown by more than was asked for, so all its rows count.
        """
        # In the usual case all arrays grow by at least half; this needs fewer calls.
        before, slots, s = len(self.region), 2 * vertices, len(self.where)
        fit = len(self.vertex) == len(self.mark) == 3 * before and len(self.ends) == len(self.span) == s
        if fit and 3 * max(before, 2 * len(self.xy)) <= 2 * slots and 3 * s <= 2 * segments:
            self._enlarge(vertices, slots, segments)
            return
        self.xy = grown(self.xy, vertices)
        slots = max(2 * len(self.xy), self.triangles)
        self.vertex, self.twin = grown(self.vertex, 3 * slots), grown(self.twin, 3 * slots)
        self.mark, self.region = grown(self.mark, 3 * slots), grown(self.region, slots)
        self.ends, self.piece = grown(self.ends, segments), grown(self.piece, segments)
        self.span, self.where = grown(self.span, segments), grown(self.where, segments)

    def plane(self) -> Plane:
        """The arrays as they are now, in one record for the kernels."""
        return Plane(
            self.xy, self.vertex, self.twin, self.mark, self.region, self.where, self.ends, self.piece,
            self.span, self.state,
        )  # fmt: skip

    def _enlarge(self, vertices: int, slots: int, segments: int) -> None:
        """`reserve` if all arrays grow: they are copied in one call."""
        xy, span = np.empty((vertices, 2)), np.empty((segments, 2))
        vertex, twin = np.empty(3 * slots, dtype=np.int32), np.empty(3 * slots, dtype=np.int32)
        mark, region = np.empty(3 * slots, dtype=np.int32), np.empty(slots, dtype=np.int32)
        ends, piece = np.empty((segments, 2), dtype=np.int32), np.empty(segments, dtype=np.int32)
        where = np.empty(segments, dtype=np.int32)
        copy_all(self.plane(), Plane(xy, vertex, twin, mark, region, where, ends, piece, span, self.state))
        self.xy, self.vertex, self.twin, self.mark, self.region = xy, vertex, twin, mark, region
        self.ends, self.piece, self.span, self.where = ends, piece, span, where

    def saved(self) -> tuple[NDArray, ...]:
        """Copies of all arrays as far as they are in use, for `restore`."""
        arrays: tuple[NDArray, ...] = self.plane()
        return tuple(array[:many].copy() for array, many in zip(arrays, self._in_use()))

    def restore(self, saved: tuple[NDArray, ...]) -> None:
        """Go back to the state in which `saved` was called."""
        arrays: tuple[NDArray, ...] = self.plane()
        for array, before in zip(arrays, saved):
            array[: len(before)] = before

    def _in_use(self) -> tuple[int, ...]:
        """How many rows of each array of `plane` are in use."""
        n, slots, s = self.size, self.triangles, self.segments
        return n, 3 * slots, 3 * slots, 3 * slots, slots, s, s, s, s, len(self.state)

    def scratch(self) -> Scratch:
        """Arrays that fit any cavity of the present triangulation."""
        # A search that runs in a circle ends when the cells are full. There are two more edges than cells.
        room = len(self.region) + 8
        stack, cells = np.empty(room + 8, dtype=np.int32), np.empty(room, dtype=np.int32)
        rim, fresh = np.empty(room + 8, dtype=np.int32), np.empty(room + 8, dtype=np.int32)
        return Scratch(stack, cells, rim, np.empty((room + 8, 4), dtype=np.int64), fresh)

    # ------------------------------------------------------------------ the result

    def kept(self) -> NDArray[np.bool_]:
        """Which slots hold triangles of the domain."""
        return self.region[: self.triangles] >= 0

    def numbers(self) -> NDArray[np.int32]:
        """For each slot the number of its cell in `mesh`, -1 for none."""
        kept = self.kept()
        number = np.cumsum(kept, dtype=np.int32) - np.int32(1)
        number[~kept] = -1
        return number

    def mesh(
        self,
        *,
        facets: int,
        origin: NDArray[np.int32] | None = None,
        markers: Mapping[str, ArrayLike] | None = None,
        regions: bool = True,
        points: NDArray[np.float64] | None = None,
        order: NDArray[np.int32] | None = None,
        **rest: Any,
    ) -> DomainMesh:
        """The triangles of the domain as a `DomainMesh` mesh.

        Parameters
        ----------
        facets : int
            Pieces below this number are facets, the others inner segments.
        origin : ndarray of int32, shape (k,), optional
            The domain's vertex that each of the first k vertices is, or -1; later ones are new. By default
            all vertices are new.
        markers : dict of str to array of int, optional
            Names of sets of pieces: their subsegments become markers of edges.
        regions : bool
            Whether to add the marker "region", one number per cell.
        points : ndarray, shape (n, 2), optional
            Coordinates to store for the first n vertices. By default these are the coordinates that the
            kernels used, unscaled, which are the same.
        order : ndarray of int, optional
            All slots of the domain's triangles, in the order that the cells shall have.
        **rest
            Passed on to `DomainMesh`; ``unrefined`` contains slots here, and cells there.

        Returns
        -------
        DomainMesh
            Vertices that no triangle of the domain uses are left out. Markers "facets" and "inner" contain
            the subsegments of each kind that bound a triangle.
        """
        number, place = np.empty(self.triangles, dtype=np.int32), np.empty(self.size, dtype=np.int32)
        triangles = self.vertex, self.twin, self.region
        subsegments = self.where, self.ends, self.piece, self.span
        cells, vertices, kept, outer = survey(triangles, subsegments, self.state, facets, number, place)
        if order is not None:
            number[order] = np.arange(cells, dtype=np.int32)
        simplices, neighbors = np.empty((cells, 3), dtype=np.int32), np.empty((cells, 3), dtype=np.int32)
        region, ends = np.empty(cells, dtype=np.int32), np.empty((kept, 2), dtype=np.int32)
        piece, span = np.empty(kept, dtype=np.int32), np.empty((kept, 2))
        extract(
            triangles, subsegments, self.state, number, place,
            (simplices, neighbors, region), (ends, piece, span),
        )  # fmt: skip
        named = named_sets(ends, piece, outer, facets, markers)
        rows, source = self._unscaled(points), self._origin(origin)
        if vertices < len(rows):
            used = place >= 0
            rows, source = rows[used], source[used]
        if regions:
            named["region"] = region
        if rest.get("unrefined") is not None and len(rest["unrefined"]):
            rest["unrefined"] = number[np.asarray(rest["unrefined"], dtype=np.int64)]
        return DomainMesh.of_triangles(
            rows, source, (simplices, neighbors), named, (ends, piece, span),
            regions=self.regions if regions else None, **rest,
        )  # fmt: skip

    def _origin(self, known: NDArray[np.int32] | None) -> NDArray[np.int32]:
        """``known`` for the first vertices, -1 for the others."""
        n = self.size
        if known is not None and len(known) == n and known.dtype == np.int32:
            return known
        origin = np.empty(n, dtype=np.int32)
        origin.fill(-1)
        if known is not None:
            origin[: len(known)] = known
        return origin

    def _unscaled(self, known: NDArray[np.float64] | None) -> NDArray[np.float64]:
        """The coordinates of all vertices in the units of the domain; the first of them are ``known``."""
        n = self.size
        if known is None:
            return unscaled(self.xy[:n], self.factor)
        if len(known) == n:
            return known
        return np.concatenate([known, unscaled(self.xy[len(known) : n], self.factor)])
