"""Intrinsic triangulations: the same surface, other triangles, with straight lines along it as edges.

An edge is *legal* if the two angles opposite to it add up to at most pi: if its two triangles are laid into
the plane side by side, neither has the other's far corner strictly inside its circle. Flipping illegal edges
until none is left gives the intrinsic Delaunay triangulation (`IntrinsicTriangulation.delaunay`).

*Why this ends.* Let E be the sum of the cotangents of all angles of all triangles. Lay the two triangles of
an edge ab, with the far corners c and d, into the plane. For any values at the four corners, the two ways to
interpolate them linearly agree on the quadrilateral's border, and differ, by a jump j, at the crossing of
the diagonals. Their Dirichlet integrals differ by k j^2 with k independent of the values, since the
difference does not change if an affine function is added, and affine functions are all that has j = 0. The
crossing divides ab in the ratio of (1 - s) to s, and cd in that of (1 - t) to t, so j = s f(a) + (1 - s)
f(b) - t f(c) - (1 - t) f(d). Comparing the coefficients of f(a) f(b) gives k = -w / (s (1 - s)), with w half
the sum of the cotangents of the angles opposite ab. If ab is illegal, w < 0 and k > 0. Summed over the four
unit vectors, a form gives the sum of the cotangents of its triangles: a flip lowers E by k (s^2 + (1-s)^2 +
t^2 + (1-t)^2) > 0. All this concerns the four corners in the plane, so it does not matter whether some of
them are one vertex of the surface. An illegal edge has two different triangles: if it had one on both sides,
its opposite angles would be the two at the base of an isosceles triangle. And its quadrilateral is convex:
the angles at a and b are what is left of 2 pi. A triangle with sides x, y, z and area A has x^2 + y^2 + z^2
= 4 A (sum of its cotangents), at most 4 times the surface's area times the first E. So all edges stay below
one length; there are finitely many straight lines of bounded length between vertices, hence finitely many
triangulations, and E never returns.

*With rounding.* An edge is flipped only if the sum of its cotangents is below zero by more than rounding, and
if the sum of the rounded cotangent sums of the two triangles becomes less. A rounded sum is monotonous, so
the exact total of all rounded values decreases: no state returns, and there are finitely many. Edges that
this holds back are counted (`counts["held"]`): their angles add up to pi up to rounding.

Sources: I. Rivin, *Euclidean structures on simplicial surfaces and hyperbolic volume*, Annals of Mathematics
139 (1994); S. Rippa, *Minimal roughness property of the Delaunay triangulation*, CAGD 7 (1990); A. I. Bobenko
and B. A. Springborn, *A discrete Laplace-Beltrami operator for simplicial surfaces*, DCG 38 (2007); M.
Fisher, B. Springborn, P. Schroeder and A. I. Bobenko, *An algorithm for the construction of intrinsic
Delaunay triangulations with applications to digital geometry processing*, Computing 81 (2007). Book: 2.7.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import frozen
from ...base.errors import InputError, MeshError
from ...mesh.mesh import Mesh
from ...predicates.batch import power_of_two
from .given import surface_rows
from .gluing import Gluing, glued
from .lengths import Sides, flip_again, legalize, signposts, suspect_all
from .points import Places, Shape, split_side, split_triangle
from .polylines import polylines
from .tracing import Ground, Line

__all__ = ["IntrinsicTriangulation"]

FLIPS_A_CALL = 1 << 20  # edges that are examined before Ctrl-C is looked for
CROSSINGS = 1 << 10  # room for the sides that a line crosses, at first


class IntrinsicTriangulation:
    """A triangulation of a given surface by straight lines along it between vertices.

    Parameters
    ----------
    surface : Mesh
        Triangles in space, none of them flat. The surface may have a boundary. It is cut open along edges of
        more than two triangles and between neighbors of different orientation.
    kept : array_like of int, shape (k, 2), optional
        Edges of the surface that are never flipped, besides those at boundaries and cuts.

    Attributes
    ----------
    surface : Mesh
        What was given; it never changes.
    counts : dict of str to int
        "flips"; "held": edges that rounding kept from being flipped; "inserted".

    Raises
    ------
    InputError
        For another thing than triangles in space, and for kept edges that are none of the surface.
    MeshError
        For flat triangles.

    Notes
    -----
    Lengths are those of the given edges, in doubles, and afterwards those of diagonals of quadrilaterals laid
    into the plane. Each edge keeps its direction at both ends (*signposts*), from which `polylines` draws it
    on the given surface. Memory: some 120 bytes for each triangle.
    """

    def __init__(self, surface: Mesh, kept: ArrayLike | None = None):
        points, rows = surface_rows(surface)
        self.surface = surface
        self.counts = {"flips": 0, "held": 0, "inserted": 0}
        self._factor = power_of_two(points)
        self.gluing: Gluing = glued(rows, len(points))
        many = rows.size
        length = _edge_lengths(points * self._factor, rows)
        empty, content = np.zeros(many), np.zeros(len(rows))
        under = np.where(self.gluing.twin < 0, np.arange(many, dtype=np.int32), np.int32(-1))
        if kept is not None:
            under = _kept(rows, kept, under)
        label = np.arange(len(rows), dtype=np.int32)
        base = Sides(self.gluing.vertex, self.gluing.twin, length, empty, under, content, label)
        around = np.zeros(len(self.gluing.first))
        signposts(base, self.gluing.first, around)
        vertices = len(self.gluing.origin)
        sides = copied(base)
        places = Places(
            self.gluing.origin.copy(), np.full(vertices, -1, np.int32), np.zeros((vertices, 3)),
            np.full(vertices, -1, np.int32), np.zeros(vertices),
        )  # fmt: skip
        line = Line(np.empty(CROSSINGS, np.int32), np.empty(CROSSINGS), np.zeros(6))
        count = np.array([len(rows), vertices])
        self.shape = Shape(sides, places, Ground(base, self.gluing.first, around), line, count)
        self._events: list[NDArray[np.int64]] = []

    # ------------------------------------------------------------------ what there is

    @property
    def sides(self) -> Sides:
        """The half-edges in use; lengths are in units of 1 / `factor`."""
        m, sides = int(self.shape.numbers[0]), self.shape.sides
        return Sides(
            sides.vertex[: 3 * m], sides.twin[: 3 * m], sides.length[: 3 * m], sides.turn[: 3 * m],
            sides.under[: 3 * m], sides.content[:m], sides.label[:m],
        )  # fmt: skip

    @property
    def factor(self) -> float:
        """The power of two by which the surface is multiplied inside, so that no square overflows."""
        return self._factor

    @property
    def simplices(self) -> NDArray[np.int32]:
        """The triangles, (m, 3): vertices of the intrinsic triangulation, in which corners may be equal."""
        return frozen(self.sides.vertex.reshape(-1, 3).copy())

    @property
    def lengths(self) -> NDArray[np.float64]:
        """The length of side k, from corner k to the next one, of each triangle: (m, 3)."""
        return self.sides.length.reshape(-1, 3) / self._factor

    @property
    def areas(self) -> NDArray[np.float64]:
        """The area of each triangle, (m,)."""
        return self.sides.content / 4.0 / self._factor / self._factor

    @property
    def origin(self) -> NDArray[np.int32]:
        """The given vertex of each vertex, -1 for inserted ones."""
        return frozen(self.shape.places.origin[: self.shape.numbers[1]])

    @property
    def points(self) -> NDArray[np.float64]:
        """Where the vertices lie in space: (n, 3)."""
        n, places = int(self.shape.numbers[1]), self.shape.places
        given = places.origin[:n] >= 0
        rows = np.where(given, 0, places.face[:n])
        found = (places.weights[:n, :, None] * self.surface.points[self.surface.simplices[rows]]).sum(axis=1)
        return np.where(given[:, None], self.surface.points[places.origin[:n]], found)

    @property
    def edges(self) -> NDArray[np.int32]:
        """One half-edge of each edge, 3 t + k for the edge from corner k of triangle t to the next corner."""
        twin = self.sides.twin
        return np.flatnonzero((twin < 0) | (twin > np.arange(len(twin)))).astype(np.int32)

    def cotangents(self) -> NDArray[np.float64]:
        """The sum of the cotangents of the angles opposite each of `edges`: negative if it is illegal."""
        sides, h = self.sides, self.edges
        total = _cotangents(sides, h)
        g = sides.twin[h]
        return total + np.where(g >= 0, _cotangents(sides, np.maximum(g, 0)), 0.0)

    @property
    def energy(self) -> float:
        """The sum of the cotangents of all angles, which each flip lowers."""
        square = (self.sides.length**2).reshape(-1, 3).sum(axis=1)
        return float((square / self.sides.content).sum())

    def illegal(self) -> NDArray[np.int32]:
        """Those of `edges` that may be flipped, and whose angles add up to more than pi beyond rounding."""
        sides, h = self.sides, self.edges
        free = (sides.twin[h] >= 0) & (sides.under[h] < 0)
        return h[free & (self.cotangents() < -ROUNDED_SUM)]

    # ------------------------------------------------------------------ changes

    def delaunay(self) -> int:
        """Flip illegal edges until none is left; how many flips this took.

        Notes
        -----
        Ends for every surface; see the module for the proof. In practice O(m) flips; no better bound than the
        finite number of triangulations is known.
        """
        many = 3 * int(self.shape.numbers[0])
        queued, stack = np.zeros(many, dtype=np.bool_), np.empty(many, dtype=np.int64)
        sides = self.sides
        top, total = suspect_all(sides, many, queued, stack), 0
        events = np.empty(min(FLIPS_A_CALL, 2 * many + 16), dtype=np.int64)
        while top:
            top, count, held = legalize(sides, queued, stack, top, events)
            self._events.append(events[:count].copy())
            total += count
            self.counts["held"] += held
        self.counts["flips"] += total
        return total

    @property
    def flips(self) -> NDArray[np.int64]:
        """The half-edges that were flipped, in order; `replayed` does them again."""
        return np.concatenate([np.empty(0, dtype=np.int64), *self._events])

    def replayed(self, flips: ArrayLike) -> IntrinsicTriangulation:
        """The given surface after these flips: ``replayed(flips[:k])`` is the state after the first k.

        Raises
        ------
        InputError
            If a number is out of range, or a flip meets an edge that has one triangle only.
        """
        events = np.asarray(flips)
        if events.ndim != 1 or (events.size and events.dtype.kind not in "iu"):
            raise InputError(f"flips must be integers of shape (k,), not {events.dtype} of {events.shape}")
        result = IntrinsicTriangulation.__new__(IntrinsicTriangulation)
        result.__dict__.update(self.__dict__)
        base, vertices = self.shape.ground.sides, len(self.gluing.origin)
        many = len(base.vertex)
        places = copied(self.shape.places, vertices)
        count = np.array([many // 3, vertices])
        sides = copied(base)
        result.shape = Shape(sides, places, self.shape.ground, self.shape.line, count)
        result.counts = {"flips": len(events), "held": 0, "inserted": 0}
        wrong = np.flatnonzero((events < 0) | (events >= many))
        k = int(wrong[0]) if len(wrong) else flip_again(result.shape.sides, events.astype(np.int64))
        if k >= 0:
            raise InputError(f"flips[{k}] = {events[k]} does not fit this surface: give its own flips")
        result._events = [events.astype(np.int64)]
        return result

    def insert(self, triangle: int, weights: ArrayLike) -> int:
        """Put a vertex into a triangle, at these weights of its corners (3,); the number of the vertex.

        Edges are not flipped: call `delaunay` afterwards. The weights must be positive.
        """
        w = np.asarray(weights, dtype=np.float64)
        if not 0 <= triangle < self.shape.numbers[0]:
            raise InputError(f"there are triangles 0..{self.shape.numbers[0] - 1}, but not {triangle}")
        if w.shape != (3,) or not (w > 0).all() or not np.isfinite(w).all():
            raise InputError("weights must be three positive numbers")
        w = np.ldexp(w, -int(np.frexp(w.max())[1]))  # the sum of large ones may be no double
        w = w / w.sum()
        if not (w > 0).all():
            raise InputError(
                "weights differ too much: the vertex would lie on an edge or corner, so split one"
            )
        return self._inserted(split_triangle, triangle, w[1], w[2])

    def split(self, half_edge: int, part: float = 0.5) -> int:
        """Put a vertex on an edge, at this part of the way along the half-edge; the number of the vertex."""
        if not 0 <= half_edge < 3 * self.shape.numbers[0]:
            raise InputError(f"there are half-edges 0..{3 * self.shape.numbers[0] - 1}, but not {half_edge}")
        if not 0.0 < part < 1.0:
            raise InputError(f"part = {part} must lie between 0 and 1")
        twin = self.sides.twin[half_edge]
        if twin >= 0 and twin // 3 == half_edge // 3:
            raise MeshError(
                f"edge {half_edge} has one triangle on both sides: flip one of its other edges first"
            )
        return self._inserted(split_side, half_edge, float(part))

    def _inserted(self, operation: Any, *arguments: Any) -> int:
        self.reserve(2, 1)
        while (found := operation(self.shape, *arguments)) < 0:
            self.more_crossings()
        self.counts["inserted"] += 1
        self._events = []  # a replay cannot insert
        return int(found)

    def more_crossings(self) -> None:
        """Twice as much room for the sides that a line crosses."""
        room = 2 * len(self.shape.line.side)
        line = Line(np.empty(room, np.int32), np.empty(room), np.zeros(6))
        self.shape = self.shape._replace(line=line)

    def reserve(self, triangles: int, vertices: int) -> None:
        """Room for so many more triangles and vertices, at least."""
        shape = self.shape
        need = int(shape.numbers[0]) + triangles
        if len(shape.sides.content) < need:
            need += need // 2
            content, label = _grown(shape.sides.content, need), _grown(shape.sides.label, need)
            sides = grown_rows(shape.sides, 3 * need)._replace(content=content, label=label)
            shape = shape._replace(sides=sides)
        need = int(shape.numbers[1]) + vertices
        if len(shape.places.origin) < need:
            need += need // 2
            shape = shape._replace(places=grown_rows(shape.places, need))
        self.shape = shape

    # ------------------------------------------------------------------ on the surface

    def polylines(self, half_edges: ArrayLike | None = None) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Edges as polylines on the given surface.

        Parameters
        ----------
        half_edges : array_like of int, optional
            By default `edges`.

        Returns
        -------
        points : (k, 3)
            Where edges begin, cross edges of the surface, and end.
        start : (e + 1,) int64
            Edge i has the points ``points[start[i] : start[i + 1]]``.
        """
        h = self.edges if half_edges is None else np.atleast_1d(np.asarray(half_edges))
        if h.ndim != 1 or (
            h.size and (h.dtype.kind not in "iu" or h.min() < 0 or h.max() >= len(self.sides.twin))
        ):
            raise InputError("half_edges must be numbers of half-edges")
        return polylines(self.shape, h.astype(np.int64), self.points, self.surface)


R = TypeVar("R", Sides, Places)
ROUNDED_SUM = 1e-9  # a sum of cotangents that is as much below zero is no rounding


def _cotangents(sides: Sides, h: NDArray[np.int32]) -> NDArray[np.float64]:
    """The cotangent of the angle opposite each half-edge."""
    after, before = np.where(h % 3 == 2, h - 2, h + 1), np.where(h % 3 == 0, h + 2, h - 1)
    square = sides.length[after] ** 2 + sides.length[before] ** 2 - sides.length[h] ** 2
    return square / sides.content[h // 3]


def _edge_lengths(points: NDArray[np.float64], rows: NDArray[np.int32]) -> NDArray[np.float64]:
    """The length of each half-edge; the difference is taken in one direction, so that twins agree."""
    length = np.empty((len(rows), 3))
    for k in range(3):
        a, b = rows[:, k], rows[:, (k + 1) % 3]
        square = np.zeros(len(rows))
        for i in range(3):
            square += (points[a, i] - points[b, i]) ** 2
        length[:, k] = np.sqrt(square)
    return length.ravel()


def _kept(rows: NDArray, kept: ArrayLike, under: NDArray[np.int32]) -> NDArray[np.int32]:
    """Mark the half-edges of kept edges."""
    edges = np.asarray(kept)
    if edges.size == 0:
        return under
    if edges.ndim != 2 or edges.shape[1] != 2 or edges.dtype.kind not in "iu":
        raise InputError("kept must be pairs of vertices of the surface, shape (k, 2)")
    count = np.int64(max(rows.max(), edges.max()) + 1)
    ends = np.column_stack([rows.ravel(), rows[:, [1, 2, 0]].ravel()]).astype(np.int64)
    keys = ends.min(axis=1) * count + ends.max(axis=1)
    wanted = edges.min(axis=1).astype(np.int64) * count + edges.max(axis=1)
    missing = ~np.isin(wanted, keys)
    if missing.any():
        i = int(np.argmax(missing))
        raise InputError(f"kept[{i}] = {edges[i].tolist()} is no edge of the surface; leave it out")
    there = np.isin(keys, wanted)
    return np.where(there, np.arange(len(keys), dtype=np.int32), under)


def copied(record: R, count: int | None = None) -> R:
    """A record of copies of arrays, of their first rows if a number of them is given."""
    arrays: Any = (array[:count].copy() for array in record)
    return type(record)(*arrays)


def grown_rows(record: R, count: int) -> R:
    """A record of arrays with so many rows."""
    arrays: Any = (_grown(array, count) for array in record)
    return type(record)(*arrays)


def _grown(array: NDArray, count: int) -> NDArray:
    result = np.zeros((count, *array.shape[1:]), dtype=array.dtype)
    result[: len(array)] = array
    return result
