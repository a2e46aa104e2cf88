"""Point location in any mesh of full dimension: a tree of bounding boxes, then exact signs.

A walk from cell to cell is faster where the mesh is convex (`Triangulation.locate` does that), but it
stops at holes and notches. The tree needs no adjacency at all. See the book, chapter 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError, MeshError
from .jit import kernel
from .predicates import orient

if TYPE_CHECKING:
    from .mesh import Mesh

__all__ = ["Locator"]

LEAF = 4  # cells in a leaf of the tree
CHUNK = 1 << 16  # queries at a time: bounds the memory


@kernel
def _candidates(queries, low, high, order, cell_low, cell_high, start, cells):
    """Cells whose (closed) bounding boxes hold each query; counts only, while ``cells`` is empty.

    Node i of the tree has the children 2 i and 2 i + 1; the second half of the nodes are leaves.
    ``start[q + 1]`` receives the number of candidates of the queries up to q.
    """
    leaves = low.shape[0] // 2
    stack = np.empty(128, dtype=np.int64)
    count = 0
    for q in range(queries.shape[0]):
        top = 1
        stack[0] = 1
        while top > 0:
            top -= 1
            node = stack[top]
            if not _inside(queries[q], low[node], high[node]):
                continue
            if node < leaves:
                stack[top] = 2 * node
                stack[top + 1] = 2 * node + 1
                top += 2
                continue
            first = (node - leaves) * 4
            for i in range(first, min(first + 4, order.shape[0])):
                t = order[i]
                if _inside(queries[q], cell_low[t], cell_high[t]):
                    if cells.shape[0] > 0:
                        cells[count] = t
                    count += 1
        start[q + 1] = count


@kernel
def _inside(x, low, high):
    for j in range(x.shape[0]):
        if x[j] < low[j] or x[j] > high[j]:
            return False
    return True


@kernel
def _morton(grid, bits, keys):
    """Interleave the bits of integer coordinates: the order of a Z-shaped curve."""
    for i in range(grid.shape[0]):
        key = 0
        for b in range(bits - 1, -1, -1):
            for j in range(grid.shape[1]):
                key = 2 * key + ((grid[i, j] >> b) & 1)
        keys[i] = key


def _curve_order(centers: np.ndarray) -> np.ndarray:
    d = centers.shape[1]
    bits = max(1, 62 // d)
    low = centers.min(axis=0)
    # Halves: the span of the largest doubles would overflow. Subnormal spans all fall into cell 0.
    span = np.maximum((centers.max(axis=0) / 2 - low / 2).max(), np.finfo(float).tiny)
    unit = (centers / 2 - low / 2) / span
    grid = np.minimum(unit * 2.0**bits, 2.0**bits - 1).astype(np.int64)[:, :62]
    keys = np.empty(len(grid), dtype=np.int64)
    _morton(grid, bits, keys)
    return np.argsort(keys, kind="stable")


class Locator:
    """The tree of a mesh; `find` is what `Mesh.find_simplex` calls."""

    def __init__(self, mesh: Mesh):
        d = mesh.points.shape[1]
        if mesh.dimension != d:
            raise MeshError(
                f"cells of dimension {mesh.dimension} in {d} dimensions do not fill space: no cell holds x"
            )
        self.points, self.simplices = mesh.points, mesh.simplices
        self.sign = np.atleast_1d(orient(mesh.corners)) if mesh.size else np.empty(0, dtype=np.int8)
        corners = mesh.corners
        self.cell_low, self.cell_high = corners.min(axis=1), corners.max(axis=1)
        self.order = np.empty(0, dtype=np.int64)
        if mesh.size:
            self.order = _curve_order(self.cell_low / 2 + self.cell_high / 2)
        blocks = -(-mesh.size // LEAF)
        leaves = 1 << max(0, (blocks - 1).bit_length())
        self.low, self.high = np.full((2 * leaves, d), np.inf), np.full((2 * leaves, d), -np.inf)
        if blocks:
            firsts = np.arange(0, mesh.size, LEAF)
            self.low[leaves : leaves + blocks] = np.minimum.reduceat(self.cell_low[self.order], firsts)
            self.high[leaves : leaves + blocks] = np.maximum.reduceat(self.cell_high[self.order], firsts)
        while leaves > 1:
            half = leaves // 2
            self.low[half:leaves] = np.minimum(
                self.low[leaves : 2 * leaves : 2], self.low[leaves + 1 : 2 * leaves : 2]
            )
            self.high[half:leaves] = np.maximum(
                self.high[leaves : 2 * leaves : 2], self.high[leaves + 1 : 2 * leaves : 2]
            )
            leaves = half

    def find(self, x: Any) -> np.ndarray:
        """The lowest-numbered cell that holds each point of ``x`` (..., d), -1 for none."""
        try:
            queries = np.asarray(x, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"x is not an array of real numbers: {error}") from None
        d = self.points.shape[1]
        if queries.ndim == 0 or queries.shape[-1] != d:
            raise InputError(f"x must have shape (..., {d}), not {queries.shape}")
        rows = np.ascontiguousarray(queries.reshape(-1, d))
        finite = np.isfinite(rows).all(axis=1)
        if not finite.all():
            row = int(np.argmin(finite))
            raise InputError(f"x[{row}] = {rows[row].tolist()} is not finite; drop or mend it")
        found = [self._find(rows[i : i + CHUNK]) for i in range(0, len(rows), CHUNK)]
        return np.concatenate([*found, np.empty(0, dtype=np.int32)]).reshape(queries.shape[:-1])

    def _find(self, rows: np.ndarray) -> np.ndarray:
        tree = (rows, self.low, self.high, self.order, self.cell_low, self.cell_high)
        start = np.zeros(len(rows) + 1, dtype=np.int64)
        _candidates(*tree, start, np.empty(0, dtype=np.int64))
        cells = np.empty(start[-1], dtype=np.int64)
        if len(cells):
            _candidates(*tree, start, cells)
        query = np.repeat(np.arange(len(rows)), np.diff(start))
        solid = self.sign[cells] != 0  # a flat cell holds no point
        cells, query = cells[solid], query[solid]
        for i in range(self.simplices.shape[1]):
            if len(cells) == 0:
                break
            corners = self.points[self.simplices[cells]]
            corners[:, i] = rows[query]
            holds = orient(corners) * self.sign[cells] >= 0
            cells, query = cells[holds], query[holds]
        result = np.full(len(rows), len(self.simplices), dtype=np.int64)
        np.minimum.at(result, query, cells)
        result[result == len(self.simplices)] = -1
        return result.astype(np.int32)
