"""SurfaceComplex: a surface in half-edges, made of triangles that need not form a manifold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ...geometry.inside_shell import side_mates
from ..insertion.halfedges import UNUSED, next_edge, prev_edge
from .halfedges import (
    ALONG_CURVE,
    CORNER,
    SEAM_CURVES,
    SHARED,
    SMOOTH,
    SURFACE_SLOTS,
    SURFACE_VERTICES,
    Sheets,
)

__all__ = ["SurfaceComplex", "Taken"]

ROOM_LEFT = 64  # vertices beyond what is needed, for tiny surfaces


class Taken(NamedTuple):
    """What is in a `SurfaceComplex`.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int32
    vertices : (n,) int64
        The vertex in the complex of each point; the first one of copies.
    slots : (m,) int64
        The slot of each triangle.
    edges : (k, 2) int32
        The feature edges, each once.
    curves : (k,) int32
        The number of the curve of each.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    vertices: NDArray[np.int64]
    slots: NDArray[np.int64]
    edges: NDArray[np.int32]
    curves: NDArray[np.int32]


@kernel
def _separate(vertex, twin, at, master, count):
    """Give each fan of triangles around a vertex but the first a copy of the vertex; how many there are.

    ``master[v]`` is the vertex of which v is a copy, for the first ``count`` vertices v itself.
    """
    seen = np.zeros(vertex.shape[0], dtype=np.bool_)
    used = count
    for c in range(vertex.shape[0]):
        if seen[c]:
            continue
        v = vertex[c]
        copy = v
        if at[v] >= 0:
            copy, used = used, used + 1
            master[copy] = v
        first = c
        back = twin[prev_edge(c)]
        while back >= 0 and prev_edge(back) != c:
            first = prev_edge(back)
            back = twin[prev_edge(first)]
        at[copy] = first
        d = first
        while True:
            seen[d] = True
            vertex[d] = copy
            e = twin[next_edge(d)]
            if e < 0 or next_edge(e) == first:
                break
            d = next_edge(e)
    return used


class SurfaceComplex:
    """Triangles of a surface as half-edges, which are split, flipped and collapsed.

    Parameters
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int32
        Their corners are three different vertices.
    edges : (k, 2) int
        The feature edges. Edges of the boundary are always kept, and so are edges in which other than two
        triangles of opposite directions meet.
    curves : (k,) int
        A number for each feature edge; a curve is all edges with one number.
    corners : (c,) int
        Vertices that must not be moved.
    names : (m,) int32, optional
        A number for each triangle.

    Attributes
    ----------
    sheets : Sheets
        The arrays for kernels.
    master : (v,) int64
        The vertex of which each vertex is a copy. Where several fans of triangles meet in one vertex, each
        has a copy of its own; copies are corners. It is longer than needed or shorter, and says nothing of
        vertices that are no corners.
    """

    def __init__(
        self,
        points: NDArray[np.float64],
        triangles: NDArray[np.int32],
        edges: NDArray[np.int32],
        curves: NDArray[np.int32],
        corners: NDArray[np.int32],
        names: NDArray[np.int32] | None = None,
    ):
        n, m = len(points), len(triangles)
        vertex = np.array(triangles, dtype=np.int32).ravel()
        twin = _opposite(triangles)
        curve = _curves_of(triangles, edges, curves, int(n))
        loose = (twin < 0) & (curve < 0)  # given to no curve: one of their own
        curve[loose] = 1 + (int(curves.max()) if len(curves) else -1)
        room = n + 3 * m
        at, master = np.full(room, -1, dtype=np.int32), np.arange(room, dtype=np.int64)
        used = int(_separate(vertex, twin, at, master, n))
        self.master = master[:used]
        kind, on = np.full(used, SMOOTH, dtype=np.int8), np.full(used, -1, dtype=np.int32)
        flat = np.flatnonzero(curve >= 0)
        for side in (next_edge, prev_edge):
            ends = vertex[_ends(flat, side is next_edge)]
            kind[ends], on[ends] = ALONG_CURVE, curve[flat]
        fixed = np.zeros(n, dtype=bool)
        fixed[corners] = True
        fixed[self.master[n:]] = True
        still = fixed[self.master]
        kind[still], on[still] = CORNER, -1
        copied = np.bincount(self.master, minlength=n)[self.master] > 1
        on[copied] = SHARED - self.master[copied]
        state = np.array([used, m, -1, -1, 0], dtype=np.int64)
        name = np.zeros(m, dtype=np.int32) if names is None else np.array(names, dtype=np.int32)
        xyz = np.array(points[self.master])
        none = np.zeros(used, dtype=np.int64)
        self.sheets = Sheets(
            xyz,
            at[:used].copy(),
            kind,
            on,
            none,
            np.ones(used),
            np.full(used, np.inf),
            np.zeros(used),
            none.copy(),
            vertex,
            twin,
            curve,
            name,
            state,
        )

    def grow(self, vertices: int, triangles: int) -> None:
        """Make room for this many more vertices and triangles; arrays of `sheets` are replaced."""
        s = self.sheets
        more = max(0, int(s.state[SURFACE_VERTICES]) + vertices + ROOM_LEFT - len(s.at))
        slots = max(0, int(s.state[SURFACE_SLOTS]) + triangles + 2 * ROOM_LEFT - len(s.name))
        if more:
            s = s._replace(
                **{name: _longer(getattr(s, name), more, -1) for name in ("at", "on")},
                **{
                    name: _longer(getattr(s, name), more, 0)
                    for name in ("xyz", "kind", "near", "size", "cap", "allowed", "mark")
                },
            )
        if slots:
            s = s._replace(
                vertex=_longer(s.vertex, 3 * slots, UNUSED),
                twin=_longer(s.twin, 3 * slots, -1),
                curve=_longer(s.curve, 3 * slots, -1),
                name=_longer(s.name, slots, 0),
            )
        self.sheets = s

    def masters(self, vertices: NDArray) -> NDArray[np.int64]:
        """The vertices of which these are copies; most are none."""
        known = (vertices < len(self.master)) & (self.sheets.kind[vertices] == CORNER)
        return np.where(known, self.master[np.where(known, vertices, 0)], vertices)

    def unite(self, vertices: NDArray[np.int64], masters: NDArray[np.int64]) -> None:
        """Make corners copies of others, or first copies of themselves."""
        master = np.arange(max(int(vertices.max(initial=-1)) + 1, len(self.master)))
        master[: len(self.master)] = self.master
        master[vertices] = masters
        self.sheets.on[vertices] = SHARED - masters
        self.master = master

    @property
    def size(self) -> int:
        """The number of triangles."""
        return int((self.sheets.vertex[: 3 * int(self.sheets.state[SURFACE_SLOTS]) : 3] != UNUSED).sum())

    def taken(self) -> Taken:
        """Points, triangles and feature edges; copies of a vertex are one again."""
        s = self.sheets
        used, slots = int(s.state[SURFACE_VERTICES]), int(s.state[SURFACE_SLOTS])
        master = self.masters(np.arange(used))
        live = np.zeros(used, dtype=bool)
        live[master[s.at[:used] >= 0]] = True
        vertices = np.flatnonzero(live)
        number = np.full(used, -1, dtype=np.int32)
        number[vertices] = np.arange(len(vertices), dtype=np.int32)
        kept = np.flatnonzero(s.vertex[: 3 * slots : 3] != UNUSED)
        rows = number[master[s.vertex[: 3 * slots].reshape(-1, 3)[kept]]]
        sides = (3 * kept[:, None] + np.arange(3)).ravel()
        sides = sides[s.curve[sides] >= 0]
        pairs = np.stack([number[master[s.vertex[_ends(sides, first)]]] for first in (True, False)], axis=1)
        pairs = np.sort(pairs, axis=1)
        edges, first = np.unique(pairs, axis=0, return_index=True)
        return Taken(
            s.xyz[vertices],
            rows,
            vertices,
            kept,
            edges.reshape(-1, 2),
            (s.curve[sides[first]] % SEAM_CURVES).astype(np.int32),
        )


def _ends(sides: NDArray[np.int64], first: bool) -> NDArray[np.int64]:
    """The corners where half-edges begin, or end."""
    return sides - sides % 3 + (sides + (1 if first else 2)) % 3


def _longer(array: np.ndarray, more: int, value: float) -> np.ndarray:
    rest = np.full((more, *array.shape[1:]), value, dtype=array.dtype)
    return np.concatenate([array, rest])


def _opposite(triangles: np.ndarray) -> NDArray[np.int32]:
    """The twin of each half-edge: where exactly two meet, of opposite directions; else -1."""
    mates = side_mates(triangles)
    flat = triangles.ravel()
    every = np.arange(len(mates))
    begin = flat[_ends(every, True)]
    same = (mates >= 0) & (begin == begin[mates])
    mates[same] = -1
    return mates.astype(np.int32)


def _curves_of(triangles: np.ndarray, edges: np.ndarray, curves: np.ndarray, n: int) -> NDArray[np.int32]:
    """The curve of each half-edge, -1 for none."""
    every = np.arange(3 * len(triangles))
    flat = triangles.ravel().astype(np.int64)
    u, w = flat[_ends(every, True)], flat[_ends(every, False)]
    key = np.minimum(u, w) * n + np.maximum(u, w)
    found = np.full(len(key), -1, dtype=np.int32)
    if len(edges):
        rows = np.sort(np.asarray(edges, dtype=np.int64), axis=1)
        kept = rows[:, 0] * n + rows[:, 1]
        order = np.argsort(kept, kind="stable")
        place = np.minimum(np.searchsorted(kept[order], key), len(kept) - 1)
        hit = kept[order][place] == key
        found[hit] = np.asarray(curves)[order[place[hit]]]
    return found
