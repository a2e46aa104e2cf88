"""The arrays of a complex of tetrahedra, made from the Delaunay triangulation of its points.

The hull of the points is enclosed in a box with eight further vertices. So all given segments and triangles
are inside, and no refill ever touches the hull of the complex. See the book, 2.8b.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import as_points
from ...base.errors import InputError, MeshError
from ...base.jit import kernel
from ...predicates.batch import orient_rows, power_of_two
from ..insertion.engine import COUNT, FREE, STAMP, grown
from ..insertion.stars import Cavity
from ..insertion.triangulation import Triangulation
from .journal import EVENT_ROOM, new_journal, unpacked
from .records import LAST_EVENT, NOTED, SEED, Solid, new_search

__all__ = ["CellArrays"]

BOX = 8  # vertices of the box


@kernel
def _cells_at(vertex, at):
    """Write one cell of each vertex: the last."""
    for i in range(vertex.shape[0]):
        at[vertex[i]] = i >> 2


def _box(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners of a box around the points, three times as large, and not quite rectangular.

    A rectangular one would be cospherical with lattices of points: exact, but slow.
    """
    low, high = rows.min(axis=0), rows.max(axis=0)
    center, half = low / 2 + high / 2, float((high / 2 - low / 2).max())
    signs = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(BOX)]) * 2.0 - 1.0
    stretch = 3.0 + np.array([[0.13, 0.29, 0.07], [0.31, 0.03, 0.19], [0.02, 0.23, 0.37], [0.17, 0.11, 0.05]])
    return center + half * signs * stretch[[0, 1, 2, 3, 2, 3, 1, 0]]


def _report(culprits: NDArray, what: str) -> None:
    if len(culprits):
        raise MeshError(f"{int(culprits[0])} {what}")


class CellArrays:
    """A triangulation of space around given points with constrained faces, as flat arrays for kernels.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Vertices, all different, not all on a line. They keep their numbers.
    progress : bool
        Show a progress bar while they are inserted.

    Attributes
    ----------
    factor : float
        The power of two with ``xyz = points * factor``, all at most 1 in magnitude.
    given : int
        How many points were given; vertices n to n + 7 are those of the box.
    xyz : ndarray, shape (capacity, 3)
        Coordinates of the vertices, of which ``size`` are in use.
    vertex, across : ndarray of int32
        The vertices of cell t, positively oriented, are ``vertex[4 t : 4 t + 4]``; a slot that is free begins
        with -2. ``across[4 t + k] = 4 u + j``: beyond the face opposite vertex k is cell u, which has that
        face opposite vertex j; -1 on the hull.
    mark : ndarray of int32
        For each face the number of the triangle that it is, -1 for none.
    region : ndarray of int32
        For each cell the region that `flood` has found: -1 outside.
    at : ndarray of int32
        For each vertex a cell that has it, -1 for none.
    state : ndarray of int64, shape (16,)
        Counters that the kernels advance: slots, free slots, searches, random numbers.

    Raises
    ------
    InputError
        For duplicate points, and for coordinates whose exponents differ too much for one scale.
    """

    journal: NDArray[np.int32] = np.empty(0, dtype=np.int32)  # see `start_history`
    start: NDArray[np.int32] | None = None

    def __init__(self, points: ArrayLike, *, progress: bool = False):
        rows = as_points(points)
        if rows.shape[1] != 3:
            raise InputError(f"points have {rows.shape[1]} coordinates; a domain in space needs 3")
        if len(rows) == 0:
            raise InputError("there are no points: a domain in space needs some")
        scale = power_of_two(rows) / 8  # so that the box is within the unit cube, too
        everything = np.concatenate([rows * scale, _box(rows * scale)])
        if not np.array_equal(everything[: len(rows)] / scale, rows):
            raise InputError(
                "the exponents of the coordinates differ too much for one scale: drop or move points that "
                "are closer to each other than 1e-300 of the largest coordinate"
            )
        made = Triangulation(everything, progress=progress)
        for copy, kept in made.duplicates[:1].tolist():
            raise InputError(f"points {kept} and {copy} are equal, {rows[kept].tolist()}: merge them first")
        self.vertex, self.across = made.linked()
        count = len(self.vertex) // 4
        self.factor: float = scale
        self.given: int = len(rows)
        self.size: int = len(everything)
        self.xyz: NDArray[np.float64] = everything
        self.at: NDArray[np.int32] = np.full(self.size, -1, dtype=np.int32)
        _cells_at(self.vertex, self.at)
        self.mark: NDArray[np.int32] = np.full(4 * count, -1, dtype=np.int32)
        self.region: NDArray[np.int32] = np.full(count, -1, dtype=np.int32)
        self.stamp: NDArray[np.int32] = np.zeros(count, dtype=np.int32)
        self.free: NDArray[np.int32] = np.empty(count, dtype=np.int32)
        self.state: NDArray[np.int64] = np.zeros(16, dtype=np.int64)
        self.state[COUNT], self.state[FREE], self.state[STAMP], self.state[SEED] = count, 0, 1, 1
        self.found: Cavity = new_search(count)

    @property
    def slots(self) -> int:
        """How many slots for cells are in use, free ones included."""
        return int(self.state[COUNT])

    def rows(self, table: NDArray[np.int32], slots: list[int]) -> NDArray[np.int32]:
        """The four entries of each of these cells in ``vertex``, ``across`` or ``mark``: (k, 4)."""
        return table[: 4 * self.slots].reshape(-1, 4)[slots]

    def solid(self) -> Solid:
        """The arrays as they are now, in one record for the kernels."""
        return Solid(
            self.xyz,
            self.vertex,
            self.across,
            self.mark,
            self.region,
            self.stamp,
            self.free,
            self.at,
            self.state,
            self.journal,
        )

    def reserve(self, vertices: int, slots: int) -> None:
        """Make room for this many vertices and slots in total; arrays that grow are replaced."""
        self.xyz = grown(self.xyz, vertices)
        before = len(self.at)
        self.at = grown(self.at, len(self.xyz))
        self.at[before:] = -1
        old = len(self.stamp)
        if slots > old:
            slots = max(slots, old + old // 2)
            self.stamp = grown(self.stamp, slots)
            self.stamp[old:] = 0
            self.vertex, self.across = grown(self.vertex, 4 * slots), grown(self.across, 4 * slots)
            self.mark, self.region, self.free = (
                grown(self.mark, 4 * slots), grown(self.region, slots), grown(self.free, slots)
            )  # fmt: skip
            self.found = new_search(slots)

    def start_history(self) -> None:
        """From now on, note what changes cells."""
        self.journal, self.state[NOTED] = new_journal(), 0
        self.start = self.vertex[: 4 * self.slots].reshape(-1, 4).copy()

    def reserve_events(self, room: int = 4 * EVENT_ROOM) -> None:
        """Make room for this many more numbers in the record, if there is one."""
        if len(self.journal):
            self.journal = grown(self.journal, int(self.state[NOTED]) + room)

    def name_point(self, goal: tuple[int, int, int], faces: int) -> None:
        """Write into the last event, that of a point, for which goal it was inserted."""
        if len(self.journal):
            self.journal[self.state[LAST_EVENT] + 1 : self.state[LAST_EVENT] + 5] = *goal, faces

    def history(self) -> dict[str, NDArray]:
        """What has happened since `start_history`, as named arrays.

        Returns
        -------
        dict of str to ndarray
            "points" (n, 3): all vertices, also those of the box and those that were added. "start" (m, 4):
            the vertices of the cells at the beginning, one row for each slot. Then for each event "kind",
            "goal" (e, 3), "faces", "point", and the ends of its rows in "removed" (slots), which are
            "removed_end", and in "made" (slot and four vertices), which are "made_end".
            `replay_recovery` performs them again. `constrained_delaunay` explains the kinds.
        """
        start = np.empty((0, 4), np.int32) if self.start is None else self.start
        return {"points": self.points(), "start": start, **unpacked(self.journal, int(self.state[NOTED]))}

    def saved(self) -> tuple[NDArray, ...]:
        """Copies of all arrays, for `restore`."""
        return (*(array.copy() for array in self.solid()), np.array(self.size))

    def restore(self, saved: tuple[NDArray, ...]) -> None:
        """Go back to the state in which `saved` was called; it may be used again."""
        solid = Solid(*(array.copy() for array in saved[:-1]))
        self.xyz, self.vertex, self.across, self.mark = solid.xyz, solid.vertex, solid.across, solid.mark
        self.region, self.stamp, self.free, self.at = solid.region, solid.stamp, solid.free, solid.at
        self.state, self.size, self.journal = solid.state, int(saved[-1]), solid.journal
        self.found = new_search(len(self.stamp))

    # ------------------------------------------------------------------ results

    def used(self) -> NDArray[np.bool_]:
        """Which slots hold cells."""
        return self.vertex[: 4 * self.slots : 4] >= 0

    def cells(self) -> NDArray[np.int32]:
        """The vertices of all cells, shape (m, 4)."""
        return self.vertex[: 4 * self.slots].reshape(-1, 4)[self.used()]

    def validate(self) -> None:
        """Check the arrays: positive cells by exact signs, faces in pairs, marks on both sides, the hull.

        Positive cells whose faces cancel to the hull are a triangulation of it: there is no more to check.

        Raises
        ------
        MeshError
            Names the first slot at fault.
        """
        slots = np.flatnonzero(self.used())
        cell = self.vertex[: 4 * self.slots].reshape(-1, 4)
        vertices = np.unique(cell[slots])
        written = self.xyz[: int(vertices.max()) + 1]  # beyond, the memory may hold anything
        _report(slots[orient_rows(written, cell[slots]) <= 0], "is not positive")
        place = 4 * slots[:, None] + np.arange(4)
        over = self.across[place]
        inner = over >= 0
        back = np.where(inner, self.across[over], place)
        _report(
            place[(back != place) | (self.mark[np.where(inner, over, place)] != self.mark[place])] >> 2,
            "has a face whose other side does not know it",
        )
        ours = np.sort(np.stack([np.delete(cell[slots], k, axis=1) for k in range(4)], axis=1), axis=2)
        others = cell[over >> 2].copy()
        np.put_along_axis(others, (over & 3)[..., None], -1, axis=2)
        others = np.sort(others, axis=2)[..., 1:]
        _report(place[inner & (ours != others).any(axis=2)] >> 2, "and its neighbor have different faces")
        hull = ours[~inner]
        _report(
            place[~inner][(hull < self.given).any(axis=1) | (hull >= self.given + BOX).any(axis=1)] >> 2,
            "is on the hull",
        )
        _report(
            vertices[(cell[self.at[vertices]] != vertices[:, None]).all(axis=1)],
            "is a vertex not in its cell",
        )

    def points(self) -> NDArray[np.float64]:
        """The coordinates of all vertices in the units of the input."""
        return self.xyz[: self.size] / self.factor

    def place(self, points: NDArray[np.float64]) -> None:
        """Give all vertices other coordinates, (size, 3): an image that keeps orientations."""
        self.factor = power_of_two(points) / 8
        self.xyz[: self.size] = points * self.factor
