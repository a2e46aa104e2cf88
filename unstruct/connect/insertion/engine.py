"""What the compiled insertions in the plane and in space share: arrays that grow, and kernels for them.

Points are numbered by *rank*, the order in which they are inserted. Cells live in *slots*: the vertices
of slot t are ``vertex[w t : w t + w]`` with w = d + 1, and ``across[w t + k] // w`` is the slot beyond its
facet k. Negative vertices mark ghosts (-1) and slots that are not in use (-2, the first vertex).
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel

GHOST = -1  # the vertex at infinity

# Entries of the state, which the kernels write.
COUNT = 0  # how many slots there are, free ones included
LAST = 1  # the slot where the next walk begins
BUSY = 2  # 1 while a change is under way
REACHED = 3  # how many points are inserted
FREE = 4  # in space the number of free slots, in a planar complex the first free slot
STAMP = 5  # the number of the next search for a cavity, in space


@kernel
def gather(rows, order, factor, scaled):
    """Write ``scaled = rows[order] * factor``; return whether that was exact."""
    exact = True
    for i in range(len(order)):
        for k in range(rows.shape[1]):
            x = rows[order[i], k]
            y = x * factor
            scaled[i, k] = y
            exact = exact and y / factor == x
    return exact


@kernel
def number_cells(vertex, width, count, number):
    """Number the real cells (in use, no ghosts) in slot order, the others -1; return how many there are."""
    m = 0
    for t in range(count):
        real = True
        for k in range(width):
            if vertex[width * t + k] < 0:
                real = False
        number[t] = m if real else -1
        m += real
    return m


@kernel
def extract_cells(vertex, across, width, count, labels, number, simplices, neighbors):
    """Write the real cells with the labels of their vertices, and the numbers of their neighbors."""
    for t in range(count):
        i = number[t]
        if i >= 0:
            for k in range(width):
                simplices[i, k] = labels[vertex[width * t + k]]
                neighbors[i, k] = number[across[width * t + k] // width]


def grown(array: NDArray, size: int) -> NDArray:
    """``array`` if it has ``size`` rows, otherwise a copy that has, and is longer by at least half."""
    before = len(array)
    if size <= before:
        return array
    larger = np.empty((max(size, before + before // 2), *array.shape[1:]), dtype=array.dtype)
    larger[:before] = array
    return larger


class Compiled(ABC):
    """The state of an insertion, and the arrays that the kernels work on."""

    width: int  # vertices of a cell
    chunk: int  # points per kernel call: a fraction of a second, so that Ctrl-C takes effect

    def __init__(self, first: NDArray[np.float64]):
        """``first``: d + 1 affinely independent points, |coordinates| <= 1."""
        self.rows = np.array(first, dtype=np.float64)
        self.size = self.width  # rows in use
        self.copy_of = np.full(self.width, -1, dtype=np.int32)  # the rank that this one repeats, or -1
        self.state = np.zeros(8, dtype=np.int64)
        self.vertex = np.empty(0, dtype=np.int32)
        self.across = np.empty(0, dtype=np.int32)
        self._reserve(self.width)
        self._start()
        self.state[REACHED] = self.width

    @abstractmethod
    def _reserve(self, points: int) -> None:
        """Make room for the cells of this many points."""

    @abstractmethod
    def _start(self) -> None:
        """Make the first cell and its ghosts."""

    @abstractmethod
    def advance(self) -> None:
        """Insert the next chunk of the points that were added."""

    @abstractmethod
    def locate_all(self, rows: NDArray[np.float64]) -> NDArray[np.int32]:
        """For each row the slot of a cell that contains it, or of a ghost beyond whose facet it lies."""

    @property
    def done(self) -> int:
        """How many rows are inserted."""
        return int(self.state[REACHED])

    @property
    def broken(self) -> bool:
        """Whether an interrupt hit an insertion half done (possible only where kernels are not compiled)."""
        return bool(self.state[BUSY])

    def add(self, rows: NDArray[np.float64]) -> None:
        """Append points to be inserted."""
        size = self.size + len(rows)
        self._reserve(size)
        larger, copies = grown(self.rows, size), grown(self.copy_of, size)
        larger[self.size : size] = rows
        copies[self.size : size] = -1
        self.rows, self.copy_of, self.size = larger, copies, size

    def rescale(self, factor: float) -> None:
        """Multiply all coordinates by a power of two."""
        self.rows *= factor

    def is_ghost(self, slot: int) -> bool:
        """Whether the cell in this slot has the vertex at infinity."""
        return bool((self.vertex[self.width * slot : self.width * (slot + 1)] < 0).any())

    def cells(
        self, labels: NDArray[np.int32]
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
        """Simplices by the labels of ranks, neighbors, and the number of each slot (-1: not a real cell)."""
        count, width = int(self.state[COUNT]), self.width
        number = np.empty(count, dtype=np.int32)
        m = number_cells(self.vertex, width, count, number)
        simplices = np.empty((m, width), dtype=np.int32)
        neighbors = np.empty((m, width), dtype=np.int32)
        extract_cells(self.vertex, self.across, width, count, labels, number, simplices, neighbors)
        return simplices, neighbors, number
