"""Polygons by the numbers of their vertices, with holes; also segments, as polygons of two vertices."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import frozen

__all__ = ["Polygons"]


class Polygons(Sequence[Any]):
    """Many polygons in three flat arrays; item i is the ring of polygon i, or a tuple of its rings.

    Parameters
    ----------
    vertices : (v,) int32
        The vertices of all rings.
    ring_start : (r + 1,) int64
        Where each ring begins in ``vertices``.
    first_ring : (f + 1,) int64
        The first ring of each polygon, its outline; the others are holes.
    """

    def __init__(
        self, vertices: NDArray[np.int32], ring_start: NDArray[np.int64], first_ring: NDArray[np.int64]
    ):
        self.vertices = frozen(np.ascontiguousarray(vertices, dtype=np.int32))
        self.ring_start = frozen(np.ascontiguousarray(ring_start, dtype=np.int64))
        self.first_ring = frozen(np.ascontiguousarray(first_ring, dtype=np.int64))

    @classmethod
    def of_rows(cls, rows: np.ndarray) -> Polygons:
        """Polygons with equally many vertices each, one a row."""
        count, sides = rows.shape
        return cls(rows.ravel(), sides * np.arange(count + 1), np.arange(count + 1))

    @classmethod
    def of(cls, rows: Any) -> Polygons:
        """Polygons as they are, or the rows of an array."""
        return rows if isinstance(rows, Polygons) else cls.of_rows(rows)

    @classmethod
    def of_rings(cls, polygons: Iterable[Sequence[Any]]) -> Polygons:
        """Polygons given by their rings."""
        rings: list[Any] = []
        first = [0]
        for polygon in polygons:
            rings.extend(polygon)
            first.append(len(rings))
        sizes = np.array([0, *map(len, rings)], dtype=np.int64)
        flat = np.concatenate(rings) if rings else np.empty(0)
        return cls(flat.astype(np.int32), np.cumsum(sizes), np.array(first))

    @classmethod
    def joined(cls, *parts: Polygons) -> Polygons:
        """The polygons of several, one after the other."""
        starts, firsts, vertices, rings = [np.zeros(1, dtype=np.int64)], [np.zeros(1, dtype=np.int64)], 0, 0
        for part in parts:
            starts.append(part.ring_start[1:] + vertices)
            firsts.append(part.first_ring[1:] + rings)
            vertices, rings = vertices + len(part.vertices), rings + len(part.ring_start) - 1
        flat = np.concatenate([np.empty(0, dtype=np.int32), *(part.vertices for part in parts)])
        return cls(flat, np.concatenate(starts), np.concatenate(firsts))

    def __len__(self) -> int:
        return len(self.first_ring) - 1

    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, slice):
            return [self[k] for k in range(*i.indices(len(self)))]
        if not -len(self) <= i < len(self):
            raise IndexError(f"there are polygons 0..{len(self) - 1}, but not {i}")
        rings = self.rings(i % len(self))
        return rings[0] if len(rings) == 1 else rings

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def rings(self, i: int) -> tuple[NDArray[np.int32], ...]:
        """The rings of one polygon."""
        first, last = self.first_ring[i], self.first_ring[i + 1]
        starts = self.ring_start
        return tuple(self.vertices[starts[r] : starts[r + 1]] for r in range(first, last))

    def vertices_of(self, i: int) -> NDArray[np.int32]:
        """The vertices of all rings of one polygon."""
        first, last = self.first_ring[i], self.first_ring[i + 1]
        return self.vertices[self.ring_start[first] : self.ring_start[last]]

    def ravel(self) -> NDArray[np.int32]:
        """The vertices of all polygons, as of an array of rows."""
        return self.vertices

    @cached_property
    def polygon_of_ring(self) -> NDArray[np.int64]:
        """The polygon of each ring."""
        return np.repeat(np.arange(len(self)), np.diff(self.first_ring))

    @cached_property
    def corners(self) -> NDArray[np.int64]:
        """The number of vertices of each polygon, (f,)."""
        return self.ring_start[self.first_ring[1:]] - self.ring_start[self.first_ring[:-1]]

    @cached_property
    def sides(self) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
        """All sides of all rings, as pairs of vertices (s, 2), and the polygon of each (s,).

        A ring of two vertices is a segment and has one side.
        """
        after = np.arange(1, len(self.vertices) + 1)
        sizes = np.diff(self.ring_start)
        after[self.ring_start[1:][sizes > 0] - 1] = self.ring_start[:-1][sizes > 0]
        polygon = np.repeat(self.polygon_of_ring, sizes)
        keep = np.ones(len(after), dtype=bool)
        keep[self.ring_start[1:][sizes <= 2] - 1] = False
        ends = np.column_stack([self.vertices, self.vertices[after]])
        return ends[keep], polygon[keep]

    @property
    def triangles(self) -> NDArray[np.int32] | None:
        """The vertices as rows, if all polygons are triangles without holes; else None."""
        if (np.diff(self.first_ring) == 1).all() and (np.diff(self.ring_start) == 3).all():
            return self.vertices.reshape(-1, 3)
        return None

    def select(self, which: NDArray[np.int64]) -> Polygons:
        """Those polygons, in this order."""
        which = np.asarray(which, dtype=np.int64)
        rings = np.diff(self.first_ring)[which]
        ring = _ranges(self.first_ring[which], rings)
        sizes = np.diff(self.ring_start)[ring]
        at = _ranges(self.ring_start[ring], sizes)
        starts, firsts = (np.concatenate([[0], np.cumsum(count)]) for count in (sizes, rings))
        return Polygons(self.vertices[at], starts, firsts)

    def turned(self, which: NDArray[np.int64]) -> Polygons:
        """All polygons, those in the other direction."""
        starts = self.ring_start[:-1]
        sizes = np.diff(self.ring_start)
        at = np.arange(len(self.vertices))
        back = np.repeat(np.isin(self.polygon_of_ring, which), sizes)
        at[back] = np.repeat(2 * starts + sizes - 1, sizes)[back] - at[back]
        return Polygons(self.vertices[at], self.ring_start, self.first_ring)

    def renumbered(self, number: NDArray[np.int32]) -> Polygons:
        """The same polygons with ``number[v]`` in place of vertex v."""
        return Polygons(number[self.vertices], self.ring_start, self.first_ring)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polygons) and all(
            np.array_equal(getattr(self, name), getattr(other, name))
            for name in ("vertices", "ring_start", "first_ring")
        )

    def __hash__(self) -> int:
        return hash((self.vertices.tobytes(), self.ring_start.tobytes(), self.first_ring.tobytes()))

    def __repr__(self) -> str:
        return f"<{len(self)} polygons of {len(self.vertices)} vertices>"


def _ranges(starts: NDArray[np.int64], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """The numbers from each start on, as many as its count, one after the other."""
    return np.arange(counts.sum()) + np.repeat(starts - (np.cumsum(counts) - counts), counts)
