"""Rounds of refills and smoothing over all cells of a mesh, with its boundary and all that is marked kept.

See `generate.volume.steps` for the kernels. Book: 2.8c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.progress import progress_bar
from ...connect.insertion.engine import COUNT, FREE, STAMP
from ...connect.spatial.arrays import CellArrays
from ...connect.spatial.held import hold, new_held
from ...connect.spatial.records import SEED, new_local, new_search
from ...connect.spatial.recovery import SPARE_SLOTS
from ...mesh.marked import marked_facets
from ...predicates.batch import orient_rows, power_of_two
from .steps import REFILLED, SMOOTHED, cell_badness, refill_bad, smooth_bad

__all__ = ["Rounded", "faces_of_cells", "rounded"]

ROUNDINGS = 4
POOR_CELL = 0.42  # badness from which cells are refilled
UNEVEN_STAR = 0.25  # badness of the worst cell at a vertex from which the vertex is smoothed
LARGEST_CAVITY = 8  # vertices
NODES_OF_A_SEARCH = 100


class Rounded(NamedTuple):
    """The cells after the rounds, and how many refills and moves there were."""

    points: NDArray[np.float64]
    simplices: NDArray[np.int32]
    neighbors: NDArray[np.int32]
    region: NDArray[np.int32]
    refills: int
    moves: int


class _Cells(CellArrays):
    """The arrays of `CellArrays`, from cells that are there."""

    def __init__(self, points: NDArray, simplices: NDArray, neighbors: NDArray, region: NDArray, seed: int):
        """From points, which may carry a metric in six further columns."""
        count = len(simplices)
        self.factor, self.given, self.size = power_of_two(points[:, :3]), len(points), len(points)
        self.xyz = points * self.factor
        self.xyz[:, 3:] *= self.factor
        self.vertex = np.array(simplices, dtype=np.int32).ravel()
        self.across = _linked(neighbors)
        self.at = np.full(self.size, -1, dtype=np.int32)
        self.at[self.vertex] = np.repeat(np.arange(count, dtype=np.int32), 4)
        self.mark = np.full(4 * count, -1, dtype=np.int32)
        self.region = np.array(region, dtype=np.int32)
        self.stamp = np.zeros(count, dtype=np.int32)
        self.free = np.empty(count, dtype=np.int32)
        self.state = np.zeros(16, dtype=np.int64)
        self.state[COUNT], self.state[FREE], self.state[STAMP], self.state[SEED] = count, 0, 1, seed + 1
        self.found = new_search(count)


def _linked(neighbors: NDArray[np.int32]) -> NDArray[np.int32]:
    """What is across each face, as 4 u + j."""
    rows = np.arange(len(neighbors))
    result = np.full(neighbors.shape, -1, dtype=np.int32)
    for k in range(4):
        u = neighbors[:, k]
        for j in range(4):
            fits = (u >= 0) & (neighbors[u, j] == rows)
            result[fits, k] = 4 * u[fits] + j
    return result.ravel()


def faces_of_cells(simplices: NDArray[np.int32], faces: NDArray[np.int32], n: int) -> NDArray[np.bool_]:
    """Whether the face of each cell opposite its vertex k is one of these faces, given by their vertices."""
    if len(faces) == 0:
        return np.zeros(simplices.shape, dtype=bool)
    sides = simplices[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3)
    return marked_facets(sides, faces, n).reshape(-1, 4)


def rounded(
    points: NDArray[np.float64],
    cells: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]],
    marked: NDArray[np.bool_],
    segments: NDArray[np.int32],
    fixed: NDArray[np.bool_],
    *,
    seed: int = 0,
    progress: bool = False,
) -> Rounded:
    """Make the cells rounder; faces on the hull, between regions and marked ones stay, and so do segments.

    Parameters
    ----------
    points : (n, 3) or (n, 9) float64
        The further columns are inverse metrics at the points, by which the shapes are then judged.
    cells : tuple of arrays
        ``simplices`` (m, 4), all positive, ``neighbors`` (m, 4), ``region`` (m,).
    marked : (m, 4) bool
        Faces opposite vertex k of each cell that must stay, marked in both of their cells.
    segments : (s, 2) int32
        Edges that must stay.
    fixed : (n,) bool
        Vertices that must stay where they are.
    seed : int
        Of the random numbers by which cavities are chosen.
    progress : bool
        Show the rounds.

    Returns
    -------
    Rounded
    """
    simplices, neighbors, region = cells
    work = _Cells(points, simplices, neighbors, region, seed)
    walls = marked | (neighbors < 0) | (region[neighbors] != region[:, None])
    work.mark[walls.ravel()] = 0
    held = new_held(len(segments))
    for u, v in segments.tolist():
        hold(held, u, v, 1)
    moving = ~fixed
    for k in range(4):
        moving[np.delete(simplices, k, axis=1)[walls[:, k]]] = False
    moving[segments.ravel()] = False
    vertices = np.flatnonzero(moving & (work.at >= 0)).astype(np.int32)
    counts, local = np.zeros(4, dtype=np.int64), new_local()
    bar = progress_bar(progress, " rounds", total=ROUNDINGS)
    touched = np.zeros(work.size, dtype=np.int32)
    for number in range(1, ROUNDINGS + 1):
        bar.update(1)
        before = counts.sum()
        bad = np.empty(work.slots)
        cell_badness(work.solid(), work.slots, bad)
        poor = np.flatnonzero(bad > POOR_CELL)
        poor = poor[np.argsort(-bad[poor], kind="stable")].astype(np.int32)
        limits = np.array([POOR_CELL, LARGEST_CAVITY, NODES_OF_A_SEARCH, number], dtype=np.float64)
        while len(poor):
            work.reserve(work.size, work.slots + len(poor) // 4 + 8 * SPARE_SLOTS)
            poor = poor[refill_bad(work.solid(), held, local, poor, touched, limits, counts) :]
        limits[0] = UNEVEN_STAR
        smooth_bad(work.solid(), work.found, vertices, touched, limits, counts)
        if counts.sum() == before:
            break
    bar.close()
    return _result(points, cells, work, vertices, counts)


def _result(points: NDArray, cells: tuple, work: _Cells, vertices: NDArray, counts: NDArray) -> Rounded:
    slots = np.flatnonzero(work.used())
    number = np.full(work.slots + 1, -1, dtype=np.int32)
    number[slots] = np.arange(len(slots), dtype=np.int32)
    across = work.across[: 4 * work.slots].reshape(-1, 4)[slots]
    after = points[:, :3].copy()
    after[vertices] = work.xyz[vertices, :3] / work.factor
    simplices = work.cells().copy()
    if (orient_rows(after, simplices) <= 0).any():  # coordinates so small that scaling has rounded them
        return Rounded(points[:, :3].copy(), cells[0], cells[1], cells[2], 0, 0)
    return Rounded(
        after, simplices, np.where(across >= 0, number[across >> 2], -1).astype(np.int32),
        work.region[slots].copy(), int(counts[REFILLED]), int(counts[SMOOTHED]),
    )  # fmt: skip
