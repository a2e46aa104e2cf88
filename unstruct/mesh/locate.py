"""Point location in any mesh of full dimension: a tree of bounding boxes, then exact signs.

A walk from cell to cell is faster where the mesh is convex (`Triangulation.locate` does that), but it
stops at holes and notches. The tree needs no adjacency at all. See the book, chapter 1.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..base.errors import InputError, MeshError
from ..geometry.boxes import BoxTree
from ..predicates.batch import orient
from .complex import CellComplex

__all__ = ["Locator"]

QUERIES_AT_ONCE = 1 << 16  # queries at a time: bounds the memory


class Locator:
    """The tree of a mesh's cells; `find` is what `Mesh.find_simplex` calls."""

    def __init__(self, mesh: CellComplex):
        d = mesh.points.shape[1]
        if mesh.dimension != d:
            raise MeshError(f"cells of dimension {mesh.dimension} do not fill {d} dimensions")
        self.points, self.simplices = mesh.points, mesh.simplices
        corners = mesh.corners
        self.sign = np.atleast_1d(orient(corners)) if mesh.size else np.empty(0, dtype=np.int8)
        self.tree = BoxTree(corners.min(axis=1), corners.max(axis=1))

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
        none = len(self.simplices)
        result = np.full(len(rows), none, dtype=np.int64)
        for i in range(0, len(rows), QUERIES_AT_ONCE):
            query, cells = self.holding(rows[i : i + QUERIES_AT_ONCE])
            np.minimum.at(result, query + i, cells)
        result[result == none] = -1
        return result.astype(np.int32).reshape(queries.shape[:-1])

    def holding(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All pairs (row, closed cell that holds it); flat cells hold nothing."""
        query, cells = self.tree.pairs(rows, rows)
        solid = self.sign[cells] != 0
        query, cells = query[solid], cells[solid]
        for i in range(self.simplices.shape[1]):
            if len(cells) == 0:
                break
            corners = self.points[self.simplices[cells]]
            corners[:, i] = rows[query]
            keep = orient(corners) * self.sign[cells] >= 0
            query, cells = query[keep], cells[keep]
        return query, cells
