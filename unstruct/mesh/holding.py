"""Which cells contain a point: exact signs for simplices, polygons of the plane, and solids of several faces.

Simplices are decided facet by facet, which is possible for all convex cells. Other cells are decided by the
even-odd rule along a ray, which only requires that the surface of a cell is closed. Points on the surface are
decided first. The rule may then move any other point by an arbitrarily small amount, so that the ray misses
every corner and edge (H. Edelsbrunner, E. P. Mücke, *Simulation of simplicity*, ACM Trans. Graphics 9,
1990). See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ..geometry.boxes import bounding_boxes
from ..predicates.batch import orient, orient_rows
from .cells import cell_rows
from .split import surface_triangles

__all__ = ["PlanarCells", "SimplexCells", "SolidCells"]

QUERIES_PER_PART = 1 << 14  # pairs of points and cells at a time
PLANES = ((1, 2), (2, 0), (0, 1))  # PLANES[i]: the coordinates that are kept when coordinate i is dropped


class SimplexCells:
    """Simplices of full dimension; `holds` decides pairs of points and cells."""

    def __init__(self, points: np.ndarray, simplices: np.ndarray):
        self.points, self.simplices = points, simplices
        corners = points[simplices]
        self.sign = np.atleast_1d(orient(corners)) if len(simplices) else np.empty(0, dtype=np.int8)
        self.low, self.high = bounding_boxes(corners)

    def foreign(self, vertices: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """Whether the vertex ``vertices[i]`` is no corner of the cell ``cells[i]``."""
        result = np.ones(len(cells), dtype=bool)
        for column in self.simplices.T:
            result &= column[cells] != vertices
        return result

    def holds(self, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """Whether the closed cell ``cells[i]`` contains the point ``x[i]``; flat cells contain nothing."""
        found = np.zeros(len(cells), dtype=bool)
        left = np.nonzero(self.sign[cells] != 0)[0]
        for i in range(self.simplices.shape[1]):
            if len(left) == 0:
                break
            corners = self.points[self.simplices[cells[left]]]
            corners[:, i] = x[left]
            left = left[orient(corners) * self.sign[cells[left]] >= 0]
        found[left] = True
        return found


class PlanarCells:
    """Quadrilaterals or polygons of the plane, convex or not; even-odd if they cross themselves."""

    def __init__(self, points: np.ndarray, polygons: Sequence[np.ndarray]):
        self.points = points
        self.indptr, self.corners = cell_rows({"polygon": list(polygons)})
        self.after = np.arange(1, len(self.corners) + 1)
        self.after[self.indptr[1:] - 1] = self.indptr[:-1]
        x, firsts = points[self.corners], self.indptr[:-1]
        some = len(firsts) > 0
        self.low = np.minimum.reduceat(x, firsts) if some else np.empty((0, 2))
        self.high = np.maximum.reduceat(x, firsts) if some else np.empty((0, 2))
        self.solid = ~self._flat(x) if some else np.empty(0, dtype=bool)

    def _flat(self, x: np.ndarray) -> np.ndarray:
        """Whether all corners of a cell lie on the line through its leftmost and its rightmost corner."""
        owner = np.repeat(np.arange(len(self.indptr) - 1), np.diff(self.indptr))
        order = self.corners[np.lexsort((x[:, 1], x[:, 0], owner))]
        first, last = order[self.indptr[:-1]], order[self.indptr[1:] - 1]
        turns = orient_rows(self.points, np.column_stack([first[owner], last[owner], self.corners]))
        return ~np.logical_or.reduceat(turns != 0, self.indptr[:-1])

    def holds(self, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """As `SimplexCells.holds`; true on a side, or if a ray to the right crosses an odd number."""
        found = np.zeros(len(cells), dtype=bool)
        for i in range(0, len(cells), QUERIES_PER_PART):
            part = slice(i, i + QUERIES_PER_PART)
            found[part] = self._holds(x[part], cells[part])
        return found & self.solid[cells]

    def _holds(self, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
        counts = np.diff(self.indptr)[cells]
        pair = np.repeat(np.arange(len(cells)), counts)
        place = np.arange(len(pair)) + np.repeat(self.indptr[cells] - (np.cumsum(counts) - counts), counts)
        a, b = self.points[self.corners[place]], self.points[self.corners[self.after[place]]]
        # Sides that do not reach the height of the point, or that lie to its left, do not count.
        y, right = x[pair, 1], np.maximum(a[:, 0], b[:, 0]) >= x[pair, 0]
        near = np.nonzero(right & (np.minimum(a[:, 1], b[:, 1]) <= y) & (y <= np.maximum(a[:, 1], b[:, 1])))[
            0
        ]
        pair, a, b = pair[near], a[near], b[near]
        q = x[pair]
        turn = orient(np.stack([a, b, q], axis=1)) if len(q) else np.empty(0, dtype=np.int8)
        on = (turn == 0) & (np.minimum(a, b) <= q).all(axis=1) & (q <= np.maximum(a, b)).all(axis=1)
        up = (a[:, 1] <= q[:, 1]) & (q[:, 1] < b[:, 1]) & (turn > 0)
        down = (b[:, 1] <= q[:, 1]) & (q[:, 1] < a[:, 1]) & (turn < 0)
        odd = np.bincount(pair[up | down], minlength=len(cells)) % 2 == 1
        odd[pair[on]] = True
        return odd


class SolidCells:
    """Solids of one kind, their quadrilaterals cut along the diagonal through the lowest vertex.

    This does not change cells with plane faces. If a face is not plane, its two cells agree on its triangles,
    so that cells that tile a region do so exactly, without gaps or overlaps.
    """

    def __init__(self, kind: str, points: np.ndarray, block: np.ndarray):
        self.points = points
        self.triangles = surface_triangles(kind, block)
        corners = points[block]
        self.low, self.high = bounding_boxes(corners)
        flat = np.ones(len(block), dtype=bool)
        for four in combinations(range(block.shape[1]), 4):
            rows = np.nonzero(flat)[0]
            flat[rows] = orient_rows(points, block[rows][:, four]) == 0
        self.solid = ~flat

    def holds(self, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """As `SimplexCells.holds`; true on a triangle, or if a ray along axis 0 meets an odd number."""
        found = np.zeros(len(cells), dtype=bool)
        for i in range(0, len(cells), QUERIES_PER_PART):
            part = slice(i, i + QUERIES_PER_PART)
            found[part] = self._holds(x[part], cells[part])
        return found & self.solid[cells]

    def _holds(self, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
        corners = self.points[self.triangles[cells]]
        low, high = corners.min(axis=2), corners.max(axis=2)
        # The ray goes to the right; triangles that it cannot meet do not count.
        near = (low[:, :, 1:] <= x[:, None, 1:]) & (x[:, None, 1:] <= high[:, :, 1:])
        pair, which = np.nonzero(near.all(axis=2) & (high[:, :, 0] >= x[:, None, 0]))
        abc, q = corners[pair, which], x[pair]
        if len(q) == 0:
            return np.zeros(len(cells), dtype=bool)
        side = orient(np.concatenate([abc, q[:, None]], axis=1))
        plane = np.nonzero((side == 0) & (low[pair, which, 0] <= q[:, 0]))[0]
        on = pair[plane[_in_triangles(abc[plane], q[plane])]]
        turn = _perturbed_turns(abc[:, :, 1:], q[:, 1:])
        through = (turn[:, 0] == turn[:, 1]) & (turn[:, 1] == turn[:, 2]) & (turn[:, 0] * side < 0)
        odd = np.bincount(pair[through], minlength=len(cells)) % 2 == 1
        odd[on] = True
        return odd


def _turns(abc: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The side of each edge of triangles (r, 3, 2) on which points (r, 2) lie: signs (r, 3)."""
    if len(q) == 0:
        return np.empty((0, 3), dtype=np.int8)
    sides = [orient(np.stack([abc[:, i], abc[:, (i + 1) % 3], q], axis=1)) for i in range(3)]
    return np.stack(sides, axis=1)


def _perturbed_turns(abc: np.ndarray, q: np.ndarray) -> np.ndarray:
    """As `_turns`, for points moved to the right by very little, and up by still much less."""
    turns = _turns(abc, q)
    step = np.roll(abc, -1, axis=1) - abc
    across = np.where(step[..., 1] != 0, -np.sign(step[..., 1]), np.sign(step[..., 0])).astype(np.int8)
    return np.where(turns == 0, across, turns)


def _in_triangles(abc: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Whether closed triangles in space contain points of their planes.

    In each of the three coordinate planes the projection of the point must lie in that of the triangle. One
    projection that is not flat would be enough; for a triangle without area, which is a segment, all three
    together leave only this segment.
    """
    inside = ((abc.min(axis=1) <= q) & (q <= abc.max(axis=1))).all(axis=1)
    for axes in PLANES:
        rows = np.nonzero(inside)[0]
        turns = _turns(np.ascontiguousarray(abc[rows][:, :, axes]), np.ascontiguousarray(q[rows][:, axes]))
        inside[rows] = (turns >= 0).all(axis=1) | (turns <= 0).all(axis=1)
    return inside
