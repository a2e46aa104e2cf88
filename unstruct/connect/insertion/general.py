"""Bowyer-Watson insertion in any dimension, by integer arithmetic.

Every finite double is an integer times a power of two; over a common power, coordinates are Python
integers, of any size. So nothing rounds, overflows or underflows. This code serves one dimension, four and
more dimensions, and in the plane and in space coordinates whose exponents are too far apart for the compiled
kernels. Cells and ghosts are as in `space`; a sphere is kept as the hyperplane through its lifted vertices,
which is computed when it is first needed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...predicates.batch import orient
from .engine import GHOST

Vector = list[int]


def exact_integers(rows: NDArray[np.float64], bits: int) -> tuple[list[Vector], int]:
    """Rows times ``2**b`` as integers, with the smallest b >= bits for which they are integers; and b."""
    ratios = [[value.as_integer_ratio() for value in row] for row in rows.tolist()]
    bits = max([bits, *(den.bit_length() - 1 for row in ratios for _, den in row)])
    return [[num << (bits - den.bit_length() + 1) for num, den in row] for row in ratios], bits


def normal(rows: Sequence[Sequence[int]]) -> Vector:
    """A nonzero vector orthogonal to k independent rows of k + 1 integers (fraction-free Gauss-Jordan)."""
    matrix = [list(row) for row in rows]
    last, pivots = 1, []
    for i, row in enumerate(matrix):
        column = next(j for j, a in enumerate(row) if a and j not in pivots)
        pivot = row[column]
        for r, other in enumerate(matrix):
            if r != i:
                factor = other[column]
                matrix[r] = [(pivot * a - factor * b) // last for a, b in zip(other, row)]
        pivots.append(column)
        last = pivot
    (free,) = set(range(len(matrix) + 1)) - set(pivots)
    result = [0] * (len(matrix) + 1)
    result[free] = last
    for row, column in zip(matrix, pivots):
        result[column] = -row[free]
    return result


def dot(a: Sequence[int], b: Sequence[int]) -> int:
    """The scalar product."""
    return sum(x * y for x, y in zip(a, b))


def minus(a: Sequence[int], b: Sequence[int]) -> Vector:
    """The difference."""
    return [x - y for x, y in zip(a, b)]


def independent_rows(points: Sequence[Sequence[int]], dimension: int) -> list[int]:
    """The first rows that are affinely independent of the rows before them, at most dimension + 1."""
    found = [0]
    reduced: list[tuple[int, Vector]] = []  # echelon form of the differences to the first row
    for i in range(1, len(points)):
        if len(found) > dimension:
            break
        row = minus(points[i], points[0])
        for column, pivot_row in reduced:
            if row[column]:
                f, p = row[column], pivot_row[column]
                row = [p * a - f * b for a, b in zip(row, pivot_row)]
        if any(row):
            reduced.append((next(j for j, a in enumerate(row) if a), row))
            found.append(i)
    return found


class General:
    """A growing Delaunay triangulation in any dimension; the interface is that of `Compiled`."""

    chunk = 20

    def __init__(self, first: NDArray[np.float64]):
        """``first``: d + 1 affinely independent points, any finite doubles."""
        self.rows = np.array(first, dtype=np.float64)
        self.width = len(first)
        self.size = self.done = self.width
        self.copy_of = np.full(self.width, -1, dtype=np.int32)
        self.broken = False
        self.points, self.bits = exact_integers(self.rows, 0)
        self.free: list[int] = []
        self.last = 0
        cell = list(range(self.width))
        if orient(self.rows) < 0:
            cell[0], cell[1] = cell[1], cell[0]
        self.vertices: list[list[int]] = [cell]
        for k in range(self.width):
            ghost = list(cell)
            ghost[k] = GHOST
            ghost[0], ghost[1] = ghost[1], ghost[0]  # so that it is positive for a point beyond the facet
            self.vertices.append(ghost)
        self.neighbors = [[-1] * self.width for _ in self.vertices]
        self.planes: list[Vector | None] = [None] * len(self.vertices)
        self._join([(t, k) for t in range(len(self.vertices)) for k in range(self.width)])

    def add(self, rows: NDArray[np.float64]) -> None:
        """Append points to be inserted."""
        points, bits = exact_integers(rows, self.bits)
        self._refine(bits)
        self.points += points
        self.rows = np.concatenate([self.rows, rows])
        self.copy_of = np.concatenate([self.copy_of, np.full(len(rows), -1, dtype=np.int32)])
        self.size = len(self.rows)

    def _refine(self, bits: int) -> None:
        """Change to units of ``2**-bits`` if these are finer than the present ones."""
        if bits > self.bits:
            self.points = [[x << (bits - self.bits) for x in point] for point in self.points]
            self.bits, self.planes = bits, [None] * len(self.planes)

    def is_ghost(self, slot: int) -> bool:
        """Whether the cell in this slot has the vertex at infinity."""
        return GHOST in self.vertices[slot]

    def advance(self) -> None:
        """Insert the next chunk of the points that were added."""
        for p in range(self.done, min(self.size, self.done + self.chunk)):
            self.broken = True
            self._insert(p)
            self.done, self.broken = p + 1, False

    def _insert(self, p: int) -> None:
        q = self.points[p]
        start = self._locate(q)
        for v in self.vertices[start]:
            if v != GHOST and self.points[v] == q:
                self.copy_of[p] = v
                return
        self._replace(p, *self._cavity(start, q))

    def _replace(self, p: int, cavity: list[int], walls: list[tuple[int, int]]) -> None:
        """Replace the cavity by the cells that join p to the facets around it."""
        ridges = []
        for t, k in walls:
            cell = list(self.vertices[t])
            cell[k] = p
            beyond = self.neighbors[t][k]
            new = self._slot(cell)
            self.neighbors[new][k] = beyond
            self.neighbors[beyond][self.neighbors[beyond].index(t)] = new
            ridges += [(new, j) for j in range(self.width) if j != k]
        self._join(ridges)
        for t in cavity:
            self.vertices[t] = []
        self.free += cavity
        self.last = new

    def _slot(self, cell: list[int]) -> int:
        if not self.free:
            self.vertices.append(cell)
            self.neighbors.append([-1] * self.width)
            self.planes.append(None)
            return len(self.vertices) - 1
        t = self.free.pop()
        self.vertices[t], self.neighbors[t], self.planes[t] = cell, [-1] * self.width, None
        return t

    def _join(self, facets: list[tuple[int, int]]) -> None:
        """Make neighbors of the cells whose facets (cell, k) have the same vertices."""
        waiting: dict[tuple[int, ...], tuple[int, int]] = {}
        for t, k in facets:
            cell = self.vertices[t]
            key = tuple(sorted(cell[:k] + cell[k + 1 :]))
            if key in waiting:
                u, j = waiting.pop(key)
                self.neighbors[t][k], self.neighbors[u][j] = u, t
            else:
                waiting[key] = t, k

    def _locate(self, q: Vector) -> int:
        """Walk to a cell that contains q, or to a ghost beyond whose facet q strictly lies."""
        t, entered = self.last, -1
        if self.is_ghost(t):
            t = self.neighbors[t][self.vertices[t].index(GHOST)]
        while not self.is_ghost(t):
            for k in range(self.width):
                u = self.neighbors[t][k]
                if u != entered and self._beyond(t, k, q) > 0:
                    break
            else:
                break
            t, entered = u, t
        return t

    def _facet_normal(self, t: int, k: int) -> tuple[Vector, Vector]:
        """A point of facet k of the real cell t, and the normal that points away from vertex k."""
        cell = self.vertices[t]
        base, *others = (self.points[v] for v in cell[:k] + cell[k + 1 :])
        n = normal([minus(point, base) for point in others])
        if dot(n, minus(self.points[cell[k]], base)) > 0:
            n = [-x for x in n]
        return base, n

    def _beyond(self, t: int, k: int, q: Vector) -> int:
        """Positive where q is beyond facet k of the real cell t, zero in its hyperplane."""
        base, n = self._facet_normal(t, k)
        return dot(n, minus(q, base))

    def _cavity(self, start: int, q: Vector) -> tuple[list[int], list[tuple[int, int]]]:
        """The cells whose open ball contains q, and the facets (cell, k) around them."""
        inside = {start: True}
        cavity, walls = [start], []
        for t in cavity:
            for k, u in enumerate(self.neighbors[t]):
                if u not in inside:
                    inside[u] = self._conflict(u, q)
                    if inside[u]:
                        cavity.append(u)
                if not inside[u]:
                    walls.append((t, k))
        return cavity, walls

    def _conflict(self, t: int, q: Vector) -> bool:
        cell = self.vertices[t]
        plane = self.planes[t]
        if GHOST in cell:
            k = cell.index(GHOST)
            inner = self.neighbors[t][k]
            if plane is None:
                _, plane = self._facet_normal(inner, self.neighbors[inner].index(t))
                self.planes[t] = plane
            side = dot(plane, minus(q, self.points[cell[k - 1]]))
            return side > 0 or (side == 0 and self._conflict(inner, q))
        base = self.points[cell[0]]
        if plane is None:
            rows = [minus(self.points[v], base) for v in cell[1:]]
            plane = normal([[*row, dot(row, row)] for row in rows])
            if plane[-1] < 0:
                plane = [-x for x in plane]
            self.planes[t] = plane
        row = minus(q, base)
        return dot(plane, [*row, dot(row, row)]) < 0

    def _query(self, x: NDArray[np.float64]) -> Vector:
        """The integers of a point that is not inserted; it may need a finer common power."""
        points, bits = exact_integers(np.array([x], dtype=np.float64), self.bits)
        self._refine(bits)
        return points[0]

    def locate(self, x: NDArray[np.float64]) -> int:
        """The slot of a cell that contains x, or of a ghost beyond whose hull facet x lies."""
        return self._locate(self._query(x))

    def cavity(self, x: NDArray[np.float64]) -> NDArray[np.int32]:
        """Slots of the cells, ghosts included, whose open ball contains x."""
        q = self._query(x)
        t = self._locate(q)
        if any(v != GHOST and self.points[v] == q for v in self.vertices[t]):
            return np.empty(0, dtype=np.int32)
        return np.array(self._cavity(t, q)[0], dtype=np.int32)

    def cells(
        self, labels: NDArray[np.int32]
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
        """Simplices by the labels of ranks, neighbors, and the number of each slot (-1: not a real cell)."""
        real = [t for t, cell in enumerate(self.vertices) if cell and GHOST not in cell]
        number = np.full(len(self.vertices) + 1, -1, dtype=np.int32)
        number[real] = np.arange(len(real))
        simplices = labels[np.array([self.vertices[t] for t in real], dtype=np.int32).reshape(-1, self.width)]
        neighbors = number[
            np.array([self.neighbors[t] for t in real], dtype=np.int32).reshape(-1, self.width)
        ]
        return simplices.astype(np.int32), neighbors, number[:-1]
