"""TreeCells: the cells of a quadtree or an octree as arrays, and what follows from them.

Meshes from trees take this record; `Tree`, which is built on both, has them as methods.

See the book, chapter 4a.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count
from ...base.arrays import as_numbers, as_points, frozen, refrozen
from ...base.errors import InputError
from .balancing import ACROSS, balanced, directions
from .contacts import ALL_INSIDE, Boundary
from .growing import deepest_level
from .keys import Keys, coordinates_of
from .linear import Leaves, Linear, leaves_of, linear_of, merged
from .lookup import Grid, corners, in_box, located, nearest, table_of
from .nodes import TreeNodes, all_nodes, states_of
from .touching import neighbor_pairs, rows_of_pairs

__all__ = ["TreeCells", "as_across"]


def as_across(value: Any, dimension: int, name: str = "across") -> str:
    """One of "faces", "edges" and "corners"; in the plane, edges are corners and have no own name."""
    allowed = ACROSS if dimension == 3 else (ACROSS[0], ACROSS[2])
    if not isinstance(value, str) or value not in allowed:
        raise InputError(f"{name} must be {' or '.join(map(repr, allowed))}, not {value!r}")
    return str(value)


class TreeCells:
    """A box divided into cells, each of them into 2**d equal ones, as deep as is wanted where it is wanted.

    `quadtree` and `octree` make trees; the methods here return new ones. *Cells* are those that are divided
    and the *leaves*, which are not. The *level* of a cell is the number of divisions that lead to it: 0 for
    the box itself, the *root*. Leaves are numbered along a curve through the box (in Morton order).

    Attributes
    ----------
    box : (2, d) float64
        The lower and the upper corner of the root.
    dimension : int
    balance : str or None
        Across what leaves differ by at most one level: "faces", "edges" or "corners"; None: not balanced.
    domain : Domain or None
        Over which the tree was made.
    complete : bool
        Whether every cell is divided for which a rule asked.
    unfinished : (k,) int64
        Leaves that a rule would have divided.
    reason : str
        Why they were not.

    Notes
    -----
    Stored are the sorted keys of the divided cells of each level: 8 bytes for each of them, no pointers. The
    other arrays are computed once, when asked for, and are read-only. Book: 4a.
    """

    balance: str | None
    domain: Any = None
    complete = True
    reason = ""
    unfinished: NDArray[np.int64] = frozen(np.empty(0, dtype=np.int64))
    boundary: Boundary | None = None

    def __init__(self, linear: Linear, box: NDArray[np.float64], balance: str | None = None):
        self.linear = linear
        self.box: NDArray[np.float64] = frozen(box)
        self.balance = balance

    # ------------------------------------------------------------------ leaves as arrays

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.linear.dimension

    @property
    def depth(self) -> int:
        """The level of the smallest leaves."""
        return self.linear.depth

    @cached_property
    def leaves(self) -> Leaves:
        return leaves_of(self.linear)

    @cached_property
    def grid(self) -> Grid:
        leaves, d = self.leaves, self.dimension
        entry = table_of(leaves.first, self.depth, d)
        return Grid(leaves.first, leaves.levels, entry, self.box[0], self.box[1] - self.box[0], self.depth)

    @property
    def levels(self) -> NDArray[np.int8]:
        """The levels of the leaves: (n,)."""
        return frozen(self.leaves.levels)

    @property
    def keys(self) -> Keys:
        """The Morton keys of the leaves on their own levels: (n,) uint64."""
        return frozen(self.leaves.keys)

    @cached_property
    def coordinates(self) -> NDArray[np.int64]:
        """The integer coordinates of the lower corners of leaves, in cells of the level `depth`: (n, d)."""
        return frozen(coordinates_of(self.leaves.first, self.dimension))

    @cached_property
    def corners(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The lower and the upper corners of the leaves, (n, d) each; equal for leaves that touch."""
        low, side = self.box[0], self.box[1] - self.box[0]
        width = np.int64(1) << (self.depth - self.levels.astype(np.int64))
        first = corners(low, side, self.coordinates, self.depth)
        return frozen(first), frozen(corners(low, side, self.coordinates + width[:, None], self.depth))

    @cached_property
    def centers(self) -> NDArray[np.float64]:
        """(n, d)."""
        low, high = self.corners
        return frozen(low + 0.5 * (high - low))

    @cached_property
    def sides(self) -> NDArray[np.float64]:
        """The longest edges of the leaves: (n,)."""
        return frozen(float((self.box[1] - self.box[0]).max()) * 0.5 ** self.levels.astype(np.float64))

    @cached_property
    def counts(self) -> NDArray[np.int64]:
        """The number of leaves of each level: (depth + 1,)."""
        return frozen(np.bincount(self.levels, minlength=self.depth + 1))

    @cached_property
    def nodes(self) -> TreeNodes:
        """All cells, those that are divided and the leaves: k divisions make 1 + 2**d k of them."""
        return all_nodes(self.linear, self.leaves, self.box)

    # ------------------------------------------------------------------ searches

    def _queries(self, x: ArrayLike, name: str) -> NDArray[np.float64]:
        queries = as_numbers(x, name)
        if queries.ndim == 0 or queries.shape[-1] != self.dimension:
            raise InputError(f"{name} must have shape (..., {self.dimension}), not {queries.shape}")
        return as_points(queries.reshape(-1, self.dimension), name)

    def locate(self, x: ArrayLike) -> NDArray[np.int64]:
        """The leaves that contain points.

        Parameters
        ----------
        x : array_like, shape (..., d)

        Returns
        -------
        ndarray of int64, shape (...)
            -1 outside of the box. A point on a face that leaves share is in the one with the larger
            coordinates; on the upper faces of the box, in the leaf there.

        Notes
        -----
        Exact; O(log n) for a point, of which a table takes away the first steps. Book: 4a.
        """
        return located(self.grid, self._queries(x, "x")).reshape(np.shape(x)[:-1])

    def in_box(self, low: ArrayLike, high: ArrayLike) -> NDArray[np.int64]:
        """The leaves that meet the closed box from `low` to `high`, (d,) each, in increasing order.

        Notes
        -----
        O(log n + their number). Book: 4a.
        """
        first, last = self._queries(low, "low"), self._queries(high, "high")
        if len(first) != 1 or len(last) != 1:
            raise InputError(f"low and high must have shape ({self.dimension},)")
        wrong = first[0] > last[0]
        if wrong.any():
            a = int(np.argmax(wrong))
            raise InputError(f"low[{a}] = {first[0, a]} exceeds high[{a}] = {last[0, a]}")
        return in_box(self.grid, first[0], last[0])

    def nearest(self, x: ArrayLike, among: ArrayLike | None = None) -> NDArray[np.int64]:
        """The nearest leaves of points.

        Parameters
        ----------
        x : array_like, shape (..., d)
        among : array_like of bool, shape (n,), or of leaves, optional
            Only these are looked at.

        Returns
        -------
        ndarray of int64, shape (...)
            Of leaves that are equally near, up to the rounding of squares of distances, the first; -1 if
            there are none.
        """
        chosen = np.ones(len(self), dtype=bool) if among is None else self._mask(among, "among")
        return nearest(self.grid, chosen, self._queries(x, "x")).reshape(np.shape(x)[:-1])

    def neighbors(self, across: str = "faces") -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The neighbors of all leaves, as rows.

        Parameters
        ----------
        across : "faces", "edges" or "corners"
            What two leaves share at least; in the plane, faces are the sides of squares.

        Returns
        -------
        indptr : (n + 1,) int64
        indices : (m,) int64
            The neighbors of leaf i are ``indices[indptr[i]:indptr[i + 1]]``, in increasing order.

        Notes
        -----
        O(n log n); the tree need not be balanced. Book: 4a.
        """
        most = directions(as_across(across, self.dimension), self.dimension)
        return rows_of_pairs(neighbor_pairs(self.grid, most), len(self))

    # ------------------------------------------------------------------ other trees

    def _mask(self, which: ArrayLike, name: str) -> NDArray[np.bool_]:
        try:
            chosen = np.asarray(which)
        except ValueError:  # ragged lists
            chosen = np.empty((0, 0))
        if chosen.dtype == np.bool_ and chosen.shape == (len(self),):
            return chosen
        if chosen.ndim != 1 or (len(chosen) and chosen.dtype.kind not in "iu"):
            raise InputError(
                f"{name} must be one bool per leaf, shape ({len(self)},), or numbers of leaves, not "
                f"{chosen.dtype} of shape {chosen.shape}"
            )
        wrong = (chosen < 0) | (chosen >= len(self))
        if wrong.any():
            row = int(np.argmax(wrong))
            raise InputError(f"{name}[{row}] = {chosen[row]} is no leaf; there are {len(self)}")
        mask = np.zeros(len(self), dtype=bool)
        mask[chosen.astype(np.int64)] = True
        return mask

    def _with(self, split: list[Keys]) -> Self:
        linear = linear_of(split, self.dimension)
        if self.balance is not None:
            linear = balanced(linear, self.balance)
        result = type(self)(linear, self.box, self.balance)
        result.domain, result.boundary = self.domain, self.boundary
        return result

    def refined(self, which: ArrayLike) -> Self:
        """The tree with these leaves, a mask (n,) or numbers, divided; balanced again if this one is.

        Raises
        ------
        InputError
            For leaves that are as small as coordinates allow: `quadtree` has the limits.
        """
        mask = self._mask(which, "which")
        most = deepest_level(self.box[0], self.box[1] - self.box[0])
        if self.depth >= most and (small := mask & (self.levels >= most)).any():
            raise InputError(
                f"leaf {int(np.argmax(small))} cannot be divided: its level is {most}, the deepest"
            )
        split = [*self.linear.split, np.empty(0, dtype=np.uint64)]
        for level in np.flatnonzero(np.bincount(self.levels[mask])):
            new = self.keys[mask & (self.levels == level)]
            split[level] = merged(split[level], new)
        return self._with(split)

    def coarsened(self, which: ArrayLike) -> Self:
        """The tree in which cells are leaves again whose children are all leaves and all among `which`.

        If this tree is balanced, so is the result: cells that this needs stay.
        """
        mask, d = self._mask(which, "which"), self.dimension
        split = list(self.linear.split)
        for level in range(1, self.depth + 1):
            parents = self.keys[mask & (self.levels == level)] >> np.uint64(d)  # in order
            last = (1 << d) - 1
            whole = parents[last:][parents[last:] == parents[: max(len(parents) - last, 0)]]
            kept = np.ones(len(split[level - 1]), dtype=bool)
            kept[np.searchsorted(split[level - 1], whole)] = False
            split[level - 1] = split[level - 1][kept]
        return self._with(split)

    def balanced(self, across: str = "corners") -> Self:
        """The smallest tree with all these cells in which neighbors differ by at most one level.

        Notes
        -----
        One pass from the deepest level upward, O(n log n). It adds at most a constant times as many cells as
        there are (D. Moore, *The cost of balancing generalized quadtrees*, 1995). Book: 4a.
        """
        across = as_across(across, self.dimension)
        result = type(self)(balanced(self.linear, across), self.box, across)
        result.domain, result.boundary = self.domain, self.boundary
        return result

    def is_balanced(self, across: str = "corners") -> bool:
        """Whether leaves that are neighbors differ by at most one level."""
        most = directions(as_across(across, self.dimension), self.dimension)
        pairs = neighbor_pairs(self.grid, most)
        levels = self.levels.astype(np.int64)
        return bool((np.abs(levels[pairs[:, 0]] - levels[pairs[:, 1]]) <= 1).all())

    def _same_box(self, other: Any) -> TreeCells:
        if not isinstance(other, TreeCells):
            raise InputError(f"a Tree is needed, not {type(other).__name__}")
        if self.box.shape != other.box.shape or not np.array_equal(self.box, other.box):
            raise InputError(
                f"only trees over one box can be combined, not {self.box.tolist()} and {other.box.tolist()}"
            )
        return other

    def union(self, other: TreeCells) -> Self:
        """The tree whose cells are divided where one of the two divides them: nowhere coarser than either."""
        other = self._same_box(other)
        most, split = max(self.depth, other.depth), []
        none = np.empty(0, dtype=np.uint64)
        for level in range(most):
            ours = self.linear.split[level] if level < self.depth else none
            split.append(merged(ours, other.linear.split[level] if level < other.depth else none))
        return self._with(split)

    def intersection(self, other: TreeCells) -> Self:
        """The tree whose cells are divided where both divide them: nowhere finer than either."""
        other = self._same_box(other)
        pairs = zip(self.linear.split, other.linear.split, strict=False)
        return self._with([np.intersect1d(a, b, assume_unique=True) for a, b in pairs])

    def prefix(self, level: int) -> Self:
        """The tree as it was before any cell of this level was divided: its first levels."""
        result = type(self)(
            linear_of(self.linear.split[: as_count(level, "level")], self.dimension), self.box, self.balance
        )
        result.domain, result.boundary = self.domain, self.boundary
        return result

    # ------------------------------------------------------------------ inside and outside

    @cached_property
    def states(self) -> NDArray[np.int8]:
        """Where leaves lie: 1 inside of the domain, -1 outside, 0 if its boundary meets their inside: (n,).

        Exact for straight pieces; curves are taken as the chords that the tree was made with.
        """
        if self.boundary is None:
            return frozen(np.full(len(self), ALL_INSIDE, dtype=np.int8))
        return frozen(states_of(self.linear, self.leaves, self.box, self.boundary))

    # ------------------------------------------------------------------ the rest

    def __len__(self) -> int:
        return 1 + ((1 << self.dimension) - 1) * self.linear.divided

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(refrozen(state))

    def __eq__(self, other: object) -> bool:
        if (
            not isinstance(other, TreeCells)
            or not np.array_equal(self.box, other.box)
            or self.depth != other.depth
        ):
            return False
        return all(map(np.array_equal, self.linear.split, other.linear.split))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        kind = "quadtree" if self.dimension == 2 else "octree"
        balance = "not balanced" if self.balance is None else f"balanced across {self.balance}"
        more = "" if self.complete else f", {len(self.unfinished):,} unfinished"
        return f"<{kind}: {len(self):,} leaves, depth {self.depth}, {balance}{more}>"
