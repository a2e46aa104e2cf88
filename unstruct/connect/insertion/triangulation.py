"""Triangulation: a Delaunay triangulation that grows.

It has the points in input order and an engine with the cells: `Planar` and `Spatial` (compiled) or
`General` (integers, any dimension). It translates between the numbers of the input, which the user sees,
and the ranks, the order in which points were inserted. See the book, sections 12.2.2 and 12.2.4.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count
from ...base.arrays import as_points
from ...base.errors import InputError, MeshError
from ...base.progress import progress_bar
from ...geometry.ordering import brio, hilbert_order
from ...mesh.cells import counted, simplex_type
from ...mesh.mesh import Mesh
from ...predicates.batch import in_sphere, orient, power_of_two
from .engine import COUNT, GHOST, Compiled, gather, grown
from .first import first_simplex, not_spanning
from .general import General
from .halfedges import HalfEdges
from .plane import Planar
from .space import Spatial

__all__ = ["Triangulation"]

COMPILED: dict[int, type[Compiled]] = {2: Planar, 3: Spatial}
MOST_POINTS = 2**28  # with 6 half-edges per point, their numbers stay below 2^31


class Triangulation:
    """A Delaunay triangulation that grows (and, in the plane, shrinks), exact in any dimension.

    Parameters
    ----------
    points : array_like, shape (n, d), optional
        First points to insert.
    dimension : int, optional
        d, if there are no points yet.
    progress : bool
        Show a progress bar while inserting.

    Raises
    ------
    InputError
        For points that are not finite, of the wrong shape or type; the message names the first row.

    Notes
    -----
    A batch is inserted along a Hilbert curve, so that a point of a large one costs a constant in practice; a
    point by itself costs a walk, O(n^(1/d)) cells. Ties are decided by the order of insertion: a point on a
    sphere counts as outside. Two dimensions and three are compiled; others, and coordinates whose exponents
    differ too much for one scale, use integer arithmetic. An interrupt (Ctrl-C) takes effect within a
    second and loses nothing: the remaining points are inserted at the next call. Sources: A. Bowyer, The
    Computer Journal 24 (1981) 162-166; D. F. Watson, ibid. 167-172. Book: 12.2.2, 12.2.4.
    """

    def __init__(
        self, points: ArrayLike | None = None, *, dimension: int | None = None, progress: bool = False
    ):
        dimension = None if dimension is None else as_count(dimension, "dimension")
        if points is None and dimension is None:
            raise InputError("give points or dimension")
        first = None if points is None else as_points(points)
        if first is not None and dimension not in (None, first.shape[1]):
            raise InputError(f"points have {first.shape[1]} coordinates, but dimension is {dimension}")
        self.dimension: int = first.shape[1] if first is not None else int(dimension or 0)
        if self.dimension < 1:
            raise InputError(f"dimension must be at least 1, not {dimension}")
        self._rows = np.empty((0, self.dimension))
        self._removed = np.empty(0, dtype=bool)
        self._size = 0
        self._forget()
        if first is not None:
            self._append(first, progress)

    def _forget(self) -> None:
        """Drop the cells and keep the points; the next call triangulates anew."""
        self._engine: Compiled | General | None = None
        self._input = np.empty(0, dtype=np.int32)  # rank -> number in the input
        self._given = 0  # points that the engine has, or that were found not to span the space
        self._flat = -1  # dimension of the flat that contains all points, while they do not span the space
        self._factor = 1.0
        self._mesh: Mesh | None = None
        self._number = np.empty(0, dtype=np.int32)  # slot -> cell of the mesh

    @property
    def points(self) -> NDArray[np.float64]:
        """All points ever inserted, (n, d), in the order of insertion; a vertex keeps its number."""
        return self._rows[: self._size].copy()

    @property
    def spans(self) -> bool:
        """Whether the points span the space. As long as they do not, they are kept and there are no cells."""
        self._update(False)
        return self._engine is not None

    def __len__(self) -> int:
        return self._size

    def __repr__(self) -> str:
        state = f"not spanning {self.dimension} dimensions yet"
        if self.spans:
            state = counted(len(self.mesh().simplices), simplex_type(self.dimension))
        return f"Triangulation({self._size} points in {self.dimension} dimensions, {state})"

    def insert(self, points: ArrayLike, *, progress: bool = False) -> None:
        """Insert points, one (d,) or many (m, d), inside or outside the present hull.

        They are numbered from ``len(self)`` on. A point equal to a vertex is listed in
        ``mesh().duplicates``. Points that do not yet span the space are kept.
        """
        rows = np.asanyarray(points)
        rows = as_points(rows[None] if rows.ndim == 1 else rows)
        if rows.shape[1] != self.dimension:
            raise InputError(
                f"points have {rows.shape[1]} coordinates; this triangulation has {self.dimension}"
            )
        self._append(rows, progress)

    def _append(self, rows: NDArray[np.float64], progress: bool) -> None:
        size = self._size + len(rows)
        if size > MOST_POINTS:
            raise InputError(
                f"{size} points are too many for 32-bit numbers of cells: insert at most {MOST_POINTS}"
            )
        larger, removed = grown(self._rows, size), grown(self._removed, size)
        larger[self._size : size] = rows
        removed[self._size : size] = False
        self._rows, self._removed, self._size, self._mesh = larger, removed, size, None
        self._update(progress)

    def _update(self, progress: bool) -> None:
        """Insert what is not inserted yet."""
        if self._engine is not None and self._engine.broken:
            self._forget()
        if self._given < self._size:
            if self._engine is None:
                self._start(exact=self.dimension in COMPILED)
            else:
                self._enqueue(self._given + brio(self._rows[self._given : self._size]))
        engine = self._engine
        if engine is None or engine.done == engine.size:
            return
        with progress_bar(progress, " points", total=engine.size, initial=engine.done) as bar:
            while engine.done < engine.size:
                before = engine.done
                engine.advance()
                bar.update(engine.done - before)

    def _start(self, exact: bool) -> None:
        """Find a first simplex among all points, and hand them to an engine."""
        alive = np.flatnonzero(~self._removed[: self._size])
        if len(alive) == 0:
            self._given, self._flat = self._size, -1
            return
        rows = self._rows[: self._size] if len(alive) == self._size else self._rows[alive]
        order = brio(rows)
        factor = power_of_two(rows) if exact else 1.0
        inserted = np.empty_like(rows)
        exact = gather(rows, order, factor, inserted) and exact
        if not exact:
            factor = 1.0
            gather(rows, order, factor, inserted)
        first = first_simplex(inserted, compiled=exact)
        if len(first) <= self.dimension:
            self._given, self._flat = self._size, len(first) - 1
            return
        if first[-1] != self.dimension:  # bring the first simplex to the front
            rest = np.delete(np.arange(len(order)), first)
            order = order[np.concatenate([first, rest])]
            gather(rows, order, factor, inserted)
        kind: Any = COMPILED[self.dimension] if exact else General
        engine = kind(inserted[: self.dimension + 1])
        engine.add(inserted[self.dimension + 1 :])
        self._input, self._factor, self._given = alive[order].astype(np.int32), factor, self._size
        self._engine = engine

    def _enqueue(self, order: NDArray[np.int64]) -> None:
        """Give further points to the engine, in this order; rescale all points if these are too large."""
        engine = self._engine
        assert engine is not None
        rows = self._rows[order]
        if isinstance(engine, Compiled) and not self._fits(rows, self._factor):
            everything = self._rows[: self._size]
            factor = min(self._factor, power_of_two(everything))
            if not self._fits(everything, factor):
                self._forget()
                self._start(exact=False)
                return
            engine.rescale(factor / self._factor)
            self._factor = factor
        numbers = np.concatenate([self._input, order.astype(np.int32)])
        engine.add(rows * self._factor)
        self._input, self._given = numbers, self._size  # together: an interrupt finds all or none

    @staticmethod
    def _fits(rows: NDArray[np.float64], factor: float) -> bool:
        """Whether the factor takes these rows to at most 1 in magnitude, exactly."""
        with np.errstate(over="ignore", under="ignore"):
            scaled = rows * factor
        return bool(np.abs(scaled).max(initial=0.0) <= 1.0 and np.array_equal(scaled / factor, rows))

    def _labels(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """The number in the input that stands for each rank, and the duplicates as (copy, kept).

        Of several equal points the one with the least number is kept, whichever was inserted first.
        """
        assert self._engine is not None
        copy_of = self._engine.copy_of[: self._engine.size]
        copies = np.flatnonzero(copy_of >= 0)
        if len(copies) == 0:
            return self._input, np.empty((0, 2), dtype=np.int32)
        labels = self._input.copy()
        members = np.concatenate([copies, np.unique(copy_of[copies])])
        roots = np.where(copy_of[members] >= 0, copy_of[members], members)
        numbers = self._input[members]
        there = ~self._removed[numbers]
        roots, numbers = roots[there], numbers[there]
        least = np.full(len(labels), np.iinfo(np.int32).max, dtype=np.int32)
        np.minimum.at(least, roots, numbers)
        labels[roots] = least[roots]
        pairs = np.stack([numbers, least[roots]], axis=1)
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
        return labels, pairs[np.argsort(pairs[:, 0])].astype(np.int32)

    @property
    def duplicates(self) -> NDArray[np.int32]:
        """Points that equal others, as rows (copy, kept); the point with the lowest number is kept."""
        return np.empty((0, 2), dtype=np.int32) if not self.spans else self._labels()[1]

    def half_edges(self) -> HalfEdges | None:
        """The triangles of the plane, for kernels; None without triangles, or if no single scale is exact."""
        self._update(False)
        engine, factor = self._engine, self._factor
        if not isinstance(engine, Planar):
            return None
        slots, labels = 3 * int(engine.state[COUNT]), np.append(self._labels()[0], np.int32(GHOST))
        vertex, twin = labels[engine.vertex[:slots]], engine.across[:slots].copy()
        return HalfEdges(self._rows[: self._size] * factor, vertex, twin, factor)

    def linked(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Cells in space with what is across their faces, as in `space`, without ghosts."""
        self._update(False)
        if not isinstance(self._engine, Spatial):
            raise not_spanning(self._rows[: self._size], self._flat)
        return self._engine.linked(self._labels()[0])

    def mesh(self) -> Mesh:
        """The triangulation as a `Mesh` (kept until the next change).

        Its points are those that were inserted and not removed, in the order of insertion; ``origin`` has
        their numbers in ``points`` (the same numbers, as long as nothing was removed).

        Raises
        ------
        DegenerateInputError
            As long as the points do not span the space.
        """
        self._update(False)
        if self._engine is None:
            raise not_spanning(self._rows[: self._size][~self._removed[: self._size]], self._flat)
        if self._mesh is None:
            labels, duplicates = self._labels()
            simplices, neighbors, number = self._engine.cells(labels)
            rows, origin = self.points, np.flatnonzero(~self._removed[: self._size]).astype(np.int32)
            if len(origin) < self._size:
                place = np.full(self._size, -1, dtype=np.int32)
                place[origin] = np.arange(len(origin), dtype=np.int32)
                rows, simplices, duplicates = rows[origin], place[simplices], place[duplicates]
            mesh = Mesh(rows, simplices, neighbors=neighbors, origin=origin, duplicates=duplicates)
            self._number, self._mesh = number, mesh
        return self._mesh

    def _queries(self, x: ArrayLike) -> NDArray[np.float64]:
        x = np.asanyarray(x)
        rows = as_points(x[None] if x.ndim == 1 else x, "x")
        if rows.shape[1] != self.dimension:
            raise InputError(f"x has {rows.shape[1]} coordinates; this triangulation has {self.dimension}")
        return rows

    def _scaled(self, x: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """The query as the engine sees it, or None where scaling would not be exact."""
        with np.errstate(over="ignore", under="ignore"):
            scaled = x * self._factor
            return scaled if np.array_equal(scaled / self._factor, x) else None

    def locate(self, x: ArrayLike) -> NDArray[np.int32] | int:
        """The cell of ``mesh().simplices`` that contains each point; -1 outside the hull.

        Parameters
        ----------
        x : array_like, shape (d,) or (m, d)

        Returns
        -------
        int or ndarray of int32, shape (m,)
            Cells are closed: for a point in several cells, one of them. -1 everywhere while there are none.
            Many queries are processed along a Hilbert curve.
        """
        rows = self._queries(x)
        result = np.full(len(rows), -1, dtype=np.int32)
        if self.spans:
            self.mesh()  # numbers the cells
            if isinstance(self._engine, General):
                result[:] = self._number[[self._engine.locate(row) for row in rows]]
            else:
                self._locate_scaled(rows, result)
        return int(result[0]) if np.ndim(x) == 1 else result

    def _locate_scaled(self, rows: NDArray[np.float64], result: NDArray[np.int32]) -> None:
        """`locate` by the compiled engine; points that cannot be scaled are sought in all cells."""
        assert isinstance(self._engine, Compiled)
        with np.errstate(over="ignore", under="ignore"):
            scaled = rows * self._factor
            exact = (scaled / self._factor == rows).all(axis=1)
        near = np.flatnonzero(exact & (np.abs(scaled) <= 1.0).all(axis=1))  # the others are outside
        near = near[hilbert_order(scaled[near])]
        result[near] = self._number[self._engine.locate_all(scaled[near])]
        for i in np.flatnonzero(~exact):
            result[i] = self._locate_exactly(rows[i])

    def _locate_exactly(self, x: NDArray[np.float64]) -> int:
        """Test all cells, by signs that are exact for any doubles, for a query that cannot be scaled."""
        simplices = self.mesh().points[self.mesh().simplices]
        inside = np.ones(len(simplices), dtype=bool)
        for k in range(self.dimension + 1):
            turned = simplices.copy()
            turned[:, k] = x
            inside &= np.asarray(orient(turned)) >= 0
        return int(np.argmax(inside)) if inside.any() else -1

    def cavity(self, p: ArrayLike) -> NDArray[np.int32]:
        """The cells whose open circumscribed ball contains p: those that an insertion of p would replace.

        Parameters
        ----------
        p : array_like, shape (d,)

        Returns
        -------
        ndarray of int32
            Numbers of cells of ``mesh().simplices``, increasing. Empty where p is a vertex, and for points
            outside the hull that are in no ball.
        """
        (row,) = self._queries(np.asarray(p)[None] if np.ndim(p) == 1 else p)
        if not self.spans:
            return np.empty(0, dtype=np.int32)
        mesh = self.mesh()
        scaled = self._scaled(row)
        if scaled is None:
            return np.flatnonzero(np.asarray(in_sphere(mesh.points[mesh.simplices], row)) > 0).astype(
                np.int32
            )
        cells = self._number[self._engine.cavity(scaled)]  # type: ignore[union-attr]
        return np.sort(cells[cells >= 0]).astype(np.int32)

    def remove(self, vertex: int) -> None:
        """Remove a vertex (plane only): what is left is the Delaunay triangulation of the other points.

        Parameters
        ----------
        vertex : int
            Its number in ``points``. The numbers of the others do not change there; ``mesh().origin`` has
            them. Of several equal points only this one goes; the lowest of the others then stands for them.

        Raises
        ------
        MeshError
            In dimensions other than two, and for a vertex that is not there.

        Notes
        -----
        Exact, hull vertices included. O(k^2) for a vertex with k neighbors, after a walk to it.
        """
        if self.dimension != 2:
            raise MeshError(
                f"vertices can be removed in two dimensions only, not in {self.dimension}; triangulate anew"
            )
        if not 0 <= vertex < self._size or self._removed[vertex]:
            raise MeshError(f"there is no vertex {vertex} to remove")
        self._update(False)
        self._mesh = None
        self._removed[vertex] = True
        if not isinstance(self._engine, Planar):
            self._forget()
            return
        copy_of = self._engine.copy_of[: self._engine.size]
        rank = int(np.flatnonzero(self._input == vertex)[0])
        root = int(copy_of[rank]) if copy_of[rank] >= 0 else rank
        group = np.append(np.flatnonzero(copy_of == root), root)
        if self._removed[self._input[group]].all() and not self._engine.remove(root):
            self._forget()
