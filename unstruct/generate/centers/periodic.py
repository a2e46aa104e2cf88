"""Triangulations of the unit torus: the unit square with opposite sides glued together, without a boundary.

`generate.centers.torus` inserts points into them; see the book, 2.6a.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import as_points, frozen
from ...base.errors import InputError
from ...base.report import Report, problem
from ...connect.insertion.delaunay import delaunay
from ...geometry import simplex
from ...mesh.mesh import Mesh
from ...predicates.batch import in_sphere, orient
from .torus_steps import GRID

__all__ = ["PeriodicMesh", "periodic_delaunay"]

Array = NDArray[np.float64]
LARGEST = 0.25  # below this circumradius the cavity of a point contains no two copies of a triangle


class PeriodicMesh:
    """A triangulation of the unit torus.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Vertices in [0, 1) x [0, 1), multiples of 2^-50.
    simplices : ndarray of int, shape (m, 3)
        Counterclockwise triangles; m = 2 n.
    shifts : ndarray of int, shape (m, 3, 2)
        By how many periods each corner is moved from its vertex.
    neighbors : ndarray of int, shape (m, 3)
        The triangle opposite each vertex.
    unrefined, reasons, counts, steps
        As for `DomainMesh`.
    """

    def __init__(
        self,
        points: Array,
        simplices: NDArray,
        shifts: NDArray,
        neighbors: NDArray,
        *,
        unrefined: ArrayLike | None = None,
        reason: str = "",
        counts: dict[str, int] | None = None,
        steps: dict[str, NDArray] | None = None,
    ):
        self.points, self.simplices = frozen(points), frozen(simplices)
        self.shifts, self.neighbors = frozen(shifts), frozen(neighbors)
        self.unrefined = frozen(np.asarray([] if unrefined is None else unrefined, dtype=np.int32))
        self.reasons = np.full(len(self.unrefined), reason)
        self.complete = len(self.unrefined) == 0
        self.counts, self.steps = dict(counts or {}), steps

    @property
    def corners(self) -> Array:
        """Coordinates of the corners, (m, 3, 2); each triangle is in one piece and may leave the square."""
        return self.points[self.simplices] + self.shifts

    def quality(self, name: str) -> Array:
        """One number for the shape of each triangle: `unstruct.simplex.quality` (which lists the names)."""
        return simplex.quality(name, self.corners)

    def plane(self) -> Mesh:
        """The triangles laid into the plane; ``origin`` names the vertex of which each point is a copy."""
        rows = np.concatenate([self.simplices[..., None], self.shifts], axis=2).reshape(-1, 3)
        copies, number = np.unique(rows, axis=0, return_inverse=True)
        points = self.points[copies[:, 0]] + copies[:, 1:]
        return Mesh(points, number.reshape(-1, 3).astype(np.int32), origin=copies[:, 0])

    def check(self) -> Report:
        """Whether this is a Delaunay triangulation of the torus, by exact signs and an exact area."""
        n, m, corners = len(self.points), len(self.simplices), self.corners
        report = Report(f"triangulation of the torus: {n} points, {m} triangles")
        report.note(
            "orientation", problem("orientation", "not positive", np.flatnonzero(orient(corners) <= 0))
        )
        back = self.neighbors[self.neighbors] == np.arange(m)[:, None, None]
        lonely = np.flatnonzero(~back.any(axis=2).all(axis=1))
        report.note("adjacency", problem("adjacency", "a neighbor does not name them in return", lonely))
        count = problem(
            "count", f"{m} triangles are not twice as many as {n} points", range(m * (m != 2 * n))
        )
        report.note("Euler: two triangles for each vertex", count)
        unused = np.setdiff1d(np.arange(n), self.simplices)
        report.note("all vertices used", problem("unused", "in no triangle", (), unused))
        whole = (corners / GRID).astype(np.int64).astype(object)  # exact: |corner| < 3
        (ax, ay), (bx, by) = ((whole[:, k] - whole[:, 0]).T for k in (1, 2))
        area = Fraction(int((ax * by - ay * bx).sum()), 2 * 2**100)
        report.note("area 1", problem("area", f"{float(area)!r} in all, not 1", range(m * (area != 1))))
        if report:
            report.note("empty circles", problem("Delaunay", "a circle is not empty", self._violations()))
        return report

    def _violations(self) -> NDArray[np.int64]:
        """Triangles whose open circle contains the far corner of a neighbor: none in a Delaunay mesh."""
        t, k = np.divmod(np.arange(self.simplices.size), 3)
        s = self.neighbors[t, k]
        # triangle s has the same vertex as the corner of t after k, but perhaps in another frame
        v, place = self.simplices[t, (k + 1) % 3], self.corners[t, (k + 1) % 3]
        w, other = self.simplices[t, (k + 2) % 3], self.corners[t, (k + 2) % 3]
        bad = np.ones(len(t), dtype=bool)
        for j in range(3):  # s has the edge w -> v at its corners j and j + 1, if both have the same shift
            start, end = self.corners[s, j], self.corners[s, (j + 1) % 3]
            same = (self.simplices[s, j] == w) & (self.simplices[s, (j + 1) % 3] == v)
            same &= ((place - end) == (other - start)).all(axis=1)
            far = self.corners[s, (j + 2) % 3] + (place - end)
            bad[same] &= np.asarray(in_sphere(self.corners[t[same]], far[same])) > 0
        return t[bad]

    def __repr__(self) -> str:
        return f"<PeriodicMesh: {len(self.points)} points, {len(self.simplices)} triangles on the unit torus>"


def periodic_delaunay(points: ArrayLike) -> PeriodicMesh:
    """The Delaunay triangulation of points on the unit torus.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        They are taken modulo 1 and rounded to multiples of 2^-50; then they must be different.

    Returns
    -------
    PeriodicMesh
        Polygons of cocircular points are cut into a fan from their lowest leftmost corner, each copy in the
        same way.

    Raises
    ------
    InputError
        For equal points, or if a disk of radius 1/4 contains none: then a triangle could meet its own copy.
        The remedy is to begin with more points; a lattice of 3 x 3 is enough.
    """
    rows = as_points(points)
    if rows.shape[1] != 2:
        raise InputError(f"points have {rows.shape[1]} coordinates; the torus has 2")
    rows = np.floor((rows - np.floor(rows)) / GRID + 0.5) * GRID
    rows[rows >= 1.0] -= 1.0
    _, first, back = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    if len(first) < len(rows):
        twice = int(np.flatnonzero(first[back.ravel()] != np.arange(len(rows)))[0])
        raise InputError(
            f"points {first[back.ravel()[twice]]} and {twice} are equal on the torus: remove one of them"
        )
    moves = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    copies = (rows[:, None] + moves).reshape(-1, 2)
    near = ((copies >= -0.5) & (copies <= 1.5)).all(axis=1)
    source = np.repeat(np.arange(len(rows)), len(moves))[near]
    shift = np.tile(moves, (len(rows), 1))[near]
    simplices, shifts = _fans(delaunay(copies[near]) if len(rows) > 2 else None, source, shift)
    corners = rows[simplices] + shifts
    twin = half_edge_twins(simplices, shifts)
    wrong = len(rows) == 0 or len(simplices) != 2 * len(rows)
    if wrong or twin is None or simplex.circumradius(corners).max() >= LARGEST:
        raise InputError(
            f"{len(rows)} points are too few or too uneven: a disk of radius 1/4 contains none of them, and "
            "a triangle could meet its own copy; begin with more points, such as a lattice of 3 x 3"
        )
    return PeriodicMesh(rows, simplices, shifts, (twin // 3).reshape(-1, 3))


def _fans(mesh: Mesh | None, source: NDArray, shift: NDArray) -> tuple[NDArray, NDArray]:
    """One copy of each Delaunay polygon as a fan from its lowest leftmost corner: vertices, shifts."""
    if mesh is None:
        return np.empty((0, 3), dtype=np.int32), np.empty((0, 3, 2), dtype=np.int32)
    m = mesh.size
    t, k = np.nonzero(mesh.neighbors > np.arange(m)[:, None])
    s = mesh.neighbors[t, k]
    far = mesh.simplices[s][~(mesh.simplices[s][:, :, None] == mesh.simplices[t][:, None]).any(axis=2)]
    tied = np.asarray(in_sphere(mesh.corners[t], mesh.points[far])) == 0
    group = np.arange(m)
    for a, b in zip(t[tied], s[tied]):  # these are few, except in lattices
        group[group == group[b]] = group[a]
    triangles, shifts = [], []
    order = np.argsort(group, kind="stable")
    for cells in np.split(order, np.flatnonzero(np.diff(group[order])) + 1):
        corners = np.unique(mesh.simplices[cells])
        lowest = min(corners, key=lambda v: tuple(mesh.points[v]))
        if (shift[lowest] == 0).all():
            # the lowest leftmost corner sees the others of a convex polygon in the order of their slopes
            ring = _around(mesh.points, int(lowest), [int(v) for v in corners if v != lowest])
            for a, b in pairwise(ring):
                triangles.append(source[[lowest, a, b]])
                shifts.append(shift[[lowest, a, b]])
    return np.array(triangles, dtype=np.int32).reshape(-1, 3), np.array(shifts, np.int32).reshape(-1, 3, 2)


def _around(points: Array, center: int, others: list[int]) -> list[int]:
    """Corners of a convex polygon counterclockwise from one of them, by exact signs."""
    ring: list[int] = []
    for v in others:
        place = sum(int(orient(points[[center, u, v]])) > 0 for u in ring)
        ring.insert(place, v)
    return ring


def half_edge_twins(simplices: NDArray, shifts: NDArray) -> NDArray[np.int32] | None:
    """For each half-edge the other one of its edge, up to a common shift; None if one has no partner."""
    a, b = np.roll(simplices, -1, axis=1), np.roll(simplices, -2, axis=1)
    step = np.roll(shifts, -2, axis=1) - np.roll(shifts, -1, axis=1)  # of edge k, from corner k+1 to k+2
    there = {row: i for i, row in enumerate(zip(a.ravel(), b.ravel(), *step.reshape(-1, 2).T))}
    pairs = [there.get(row, -1) for row in zip(b.ravel(), a.ravel(), *(-step.reshape(-1, 2)).T)]
    if len(there) < simplices.size or -1 in pairs:
        return None
    return np.array(pairs, dtype=np.int32)
