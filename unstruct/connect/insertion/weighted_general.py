"""Regular triangulations in any dimension by integers: `general` with the rules of `weighted_plane`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .engine import GHOST
from .general import General, Vector, dot, exact_integers, minus, normal

__all__ = ["WeightedGeneral"]


class WeightedGeneral(General):
    """A growing regular triangulation in any dimension; rows end with their weights.

    In units of ``2**-bits`` for coordinates and of its square for weights, all of them are integers.
    """

    def __init__(self, first: NDArray[np.float64]):
        """``first``: d + 1 affinely independent points and their weights, any finite doubles."""
        self.heavy: Vector = []
        super().__init__(first[:, :-1])
        self._weigh(first[:, -1:])

    def add(self, rows: NDArray[np.float64]) -> None:
        """Append points to be inserted."""
        super().add(rows[:, :-1])
        self._weigh(rows[:, -1:])

    def _weigh(self, weights: NDArray[np.float64]) -> None:
        heavy, bits = exact_integers(weights, 2 * self.bits)
        self._refine((bits + 1) // 2)
        self.heavy += [w << (2 * self.bits - bits) for (w,) in heavy]

    def _refine(self, bits: int) -> None:
        if bits > self.bits:
            self.heavy = [w << 2 * (bits - self.bits) for w in self.heavy]
        super()._refine(bits)

    def _insert(self, p: int) -> None:
        start = self._locate(self.points[p])
        if self._below(start, p):
            self._replace(p, *self._cavity_of(start, p))

    def _cavity_of(self, start: int, p: int) -> tuple[list[int], list[tuple[int, int]]]:
        inside = {start: True}
        cavity, walls = [start], []
        for t in cavity:
            for k, u in enumerate(self.neighbors[t]):
                if u not in inside:
                    inside[u] = self._below(u, p)
                    if inside[u]:
                        cavity.append(u)
                if not inside[u]:
                    walls.append((t, k))
        return cavity, walls

    def _below(self, t: int, p: int) -> bool:
        """Is p below the lifted hyperplane of cell t? For a ghost: beyond its hull facet, or below it."""
        cell = self.vertices[t]
        if GHOST in cell:
            k = cell.index(GHOST)
            inner = self.neighbors[t][k]
            base, outward = self._facet_normal(inner, self.neighbors[inner].index(t))
            side = dot(outward, minus(self.points[p], base))
            return side > 0 or (side == 0 and self._below(inner, p))
        plane = self.planes[t]
        if plane is None:
            plane = self._hyperplane(cell, self.heavy)
            self.planes[t] = plane
        height = dot(plane, self._lifted(p, cell[0], self.heavy))
        if height:
            return height < 0
        bare = [0] * len(self.points)
        return dot(self._hyperplane(cell, bare), self._lifted(p, cell[0], bare)) > 0

    def _lifted(self, p: int, base: int, heavy: Vector) -> Vector:
        row = minus(self.points[p], self.points[base])
        return [*row, dot(row, row) - (heavy[p] - heavy[base])]

    def _hyperplane(self, cell: list[int], heavy: Vector) -> Vector:
        """The upward normal of the lifted cell."""
        plane = normal([self._lifted(v, cell[0], heavy) for v in cell[1:]])
        return plane if plane[-1] > 0 else [-x for x in plane]
