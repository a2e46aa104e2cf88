"""What is to be recovered: triangles and segments, and how points on them have split them."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct
from ..insertion.engine import grown

__all__ = ["Given", "Split", "edge"]

Edge = tuple[int, int]


def edge(u: int, v: int) -> Edge:
    """The edge uv with its lower vertex first."""
    return (u, v) if u < v else (v, u)


class Split(NamedTuple):
    """A point on the surface: the segment that it splits, if any, and triangles before and after."""

    point: int
    segment: Edge | None
    parents: tuple[int, ...]
    children: tuple[int, ...]
    inner: tuple[Edge, ...]  # edges within the parents

    def edges(self) -> tuple[Edge, ...]:
        """The edges that came with the point."""
        halves = () if self.segment is None else tuple(edge(self.point, v) for v in self.segment)
        return halves + self.inner


class _Beside(dict[Edge, list[int]]):
    """The triangles at each edge: those of an edge are looked up when it is asked for first, few ever are."""

    def __init__(self, corner: NDArray[np.int32], rows: NDArray[np.int64]):
        super().__init__()
        a, b, c = corner[rows].astype(np.int64).T
        one, two = np.concatenate([a, b, c]), np.concatenate([b, c, a])
        keys = (np.minimum(one, two) << 32) | np.maximum(one, two)
        order = np.argsort(keys, kind="stable")
        self._keys, self._rows = keys[order], np.tile(rows, 3)[order]

    def __missing__(self, key: Edge) -> list[int]:
        first, end = np.searchsorted(self._keys, [(key[0] << 32) | key[1], ((key[0] << 32) | key[1]) + 1])
        rows = self[key] = sorted(self._rows[first:end].tolist())
        return rows


class Given:
    """Triangles and segments, split or not.

    Parameters
    ----------
    triangles : ndarray of int32, shape (m, 3)
    segments : ndarray of int32, shape (s, 2)
        Edges of triangles need not be repeated here.

    Attributes
    ----------
    corner : ndarray of int32, shape (capacity, 3)
        Vertices of all triangles, those that were split included.
    root : ndarray of int32
        For each triangle the given one that it is a part of.
    alive : ndarray of bool
        Which are not split.
    loose : ndarray of int32, shape (s, 2)
        The given segments.
    middle : dict of int by edge
        For each segment that is split, or part of one that is, the point between its parts.
    """

    def __init__(self, triangles: NDArray[np.int32], segments: NDArray[np.int32]):
        self.count = self._given = len(triangles)
        self.corner = np.array(triangles, dtype=np.int32).reshape(-1, 3)
        self.root = np.arange(self.count, dtype=np.int32)
        self.alive = np.ones(self.count, dtype=bool)
        self.loose = np.array(segments, dtype=np.int32).reshape(-1, 2)
        self.middle: dict[Edge, int] = {}
        self._beside: _Beside | None = None

    @cached_property
    def segment(self) -> NDArray[np.int32]:
        """All edges of the triangles that are given, and all given segments, once each: (k, 2)."""
        a, b, c = self.corner[: self._given].T
        one, two = np.concatenate([a, b, c, self.loose[:, 0]]), np.concatenate([b, c, a, self.loose[:, 1]])
        keys = distinct((np.minimum(one, two).astype(np.int64) << 32) | np.maximum(one, two))
        return np.stack([keys >> 32, keys & (2**32 - 1)], axis=1).astype(np.int32)

    def goals(self, rows: NDArray[np.int64]) -> NDArray[np.int32]:
        """Rows for `recover_all`: the vertices of these triangles, and their numbers."""
        return np.column_stack([self.corner[rows], rows]).astype(np.int32)

    def parts(self, a: int, b: int) -> list[int]:
        """The vertices of the segment ab, from a to b, with the points that split it."""
        chain, waiting = [a], [b]
        while waiting:
            between = self.middle.get(edge(chain[-1], waiting[-1]))
            if between is None:
                chain.append(waiting.pop())
            else:
                waiting.append(between)
        return chain

    def chains(self) -> dict[Edge, list[int]]:
        """The vertices of each given segment that is split, from the lower end to the other."""
        if not self.middle:
            return {}
        rows = map(tuple, self.segment.tolist())
        return {(a, b): self.parts(a, b) for a, b in rows if (a, b) in self.middle}

    def edges(self) -> set[Edge]:
        """All edges that must be there now: those of triangles that are not split, and parts of segments."""
        corners = self.corner[: self.count][self.alive[: self.count]].tolist()
        sides = {edge(*ends) for a, b, c in corners for ends in ((a, b), (b, c), (c, a))}
        chains = [self.parts(*row) for row in self.segment.tolist()]
        return sides | {edge(u, v) for chain in chains for u, v in pairwise(chain)}

    def beside(self) -> _Beside:
        """The triangles at each edge that are not split; made at the first split."""
        if self._beside is None:
            self._beside = _Beside(self.corner, np.flatnonzero(self.alive[: self.count]))
        return self._beside

    def _sides(self, t: int) -> tuple[Edge, Edge, Edge]:
        a, b, c = self.corner[t].tolist()
        return edge(a, b), edge(b, c), edge(c, a)

    def _add(self, corners: list[int], root: int) -> int:
        t = self.count
        self.beside()  # made without the new triangle
        if t == len(self.corner):
            self.corner, self.root = grown(self.corner, t + 1), grown(self.root, t + 1)
            self.alive = grown(self.alive, t + 1)
        self.corner[t], self.root[t], self.count = corners, root, t + 1
        self._revive(t)
        return t

    def _revive(self, t: int) -> None:
        self.alive[t], beside = True, self.beside()
        for key in self._sides(t):
            beside[key].append(t)

    def _kill(self, t: int) -> None:
        self.alive[t], beside = False, self.beside()
        for key in self._sides(t):
            beside[key].remove(t)

    def split_segment(self, a: int, b: int, p: int) -> Split:
        """Split the segment ab, and the triangles at it, at the vertex p."""
        parents, children, inner = list(self.beside()[edge(a, b)]), [], []
        for t in parents:
            corners = self.corner[t].tolist()
            (c,) = set(corners) - {a, b}
            for end in (a, b):
                children.append(self._add([p if v == end else v for v in corners], int(self.root[t])))
            inner.append(edge(p, c))
            self._kill(t)
        self.middle[edge(a, b)] = p
        return Split(p, edge(a, b), tuple(parents), tuple(children), tuple(inner))

    def split_triangle(self, t: int, p: int) -> Split:
        """Split a triangle in three at the vertex p."""
        corners = self.corner[t].tolist()
        children = [self._add([p if v == w else v for v in corners], int(self.root[t])) for w in corners]
        self._kill(t)
        return Split(p, None, (t,), tuple(children), tuple(edge(p, v) for v in corners))

    def undo(self, split: Split) -> None:
        """Join what was split; it must be the last split there."""
        for t in split.children:
            self._kill(t)
        for t in split.parents:
            self._revive(t)
        if split.segment is not None:
            del self.middle[split.segment]
