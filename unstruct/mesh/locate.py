"""Point location in any mesh of full dimension: a tree of bounding boxes, then exact signs.

A walk from cell to cell is faster where the mesh is convex (`Triangulation.locate` does that), but it
stops at holes and notches. The tree needs no adjacency. See the book, chapter 1.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..base.errors import InputError, MeshError
from ..geometry.boxes import BoxTree
from .cells import cell_dimension, simplex_dimension
from .complex import CellComplex
from .holding import PlanarCells, SimplexCells, SolidCells

__all__ = ["Locator"]

QUERIES_AT_ONCE = 1 << 16  # queries at a time, which bounds the memory


class Locator:
    """The tree of the cells of a mesh; `Mesh.find_simplex` calls `find`."""

    def __init__(self, mesh: CellComplex):
        d = mesh.points.shape[1]
        if mesh.dimension != d:
            raise MeshError(f"cells of dimension {mesh.dimension} do not fill {d} dimensions")
        self.points, self.size = mesh.points, mesh.size
        self.parts = [_cells(name, mesh.points, block) for name, block in mesh.cells.items()]
        self.ends = np.cumsum([len(part.low) for part in self.parts])
        low = np.concatenate([part.low for part in self.parts])
        self.tree = BoxTree(low, np.concatenate([part.high for part in self.parts]))

    def find(self, x: Any) -> np.ndarray:
        """The lowest-numbered cell that contains each point of ``x`` (..., d), -1 for none."""
        try:
            queries = np.asarray(x, dtype=np.float64)
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"x is not an array of real numbers: {error}") from None
        d = self.points.shape[1]
        if queries.ndim == 0 or queries.shape[-1] != d:
            raise InputError(f"x must have shape (..., {d}), not {queries.shape}")
        rows = np.ascontiguousarray(queries.reshape(-1, d))
        finite = np.isfinite(rows).all(axis=1)
        if not finite.all():
            row = int(np.argmin(finite))
            raise InputError(f"x[{row}] = {rows[row].tolist()} is not finite; drop or mend it")
        none = self.size
        result = np.full(len(rows), none, dtype=np.int64)
        for i in range(0, len(rows), QUERIES_AT_ONCE):
            query, cells = self.holding(rows[i : i + QUERIES_AT_ONCE])
            np.minimum.at(result, query + i, cells)
        result[result == none] = -1
        return result.astype(np.int32).reshape(queries.shape[:-1])

    def holding(self, rows: np.ndarray, vertices: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """All pairs (row, closed cell that contains it), without flat cells; see `Mesh.holding`."""
        query, cells = self.tree.pairs(rows, rows)
        if vertices is not None:
            part = self.parts[0]
            assert isinstance(part, SimplexCells)
            foreign = part.foreign(vertices[query], cells)
            query, cells = query[foreign], cells[foreign]
        keep = np.zeros(len(cells), dtype=bool)
        for part, end in zip(self.parts, self.ends.tolist()):
            start = end - len(part.low)
            own = np.nonzero((start <= cells) & (cells < end))[0]
            keep[own] = part.holds(rows[query[own]], cells[own] - start)
        return query[keep], cells[keep]


def _cells(kind: str, points: np.ndarray, block: Any) -> SimplexCells | PlanarCells | SolidCells:
    if simplex_dimension(kind) is not None:
        return SimplexCells(points, block)
    return PlanarCells(points, block) if cell_dimension(kind) == 2 else SolidCells(kind, points, block)
