"""Hexahedra, pyramids and tetrahedra of leaves of an octree that is balanced across edges: conforming.

A leaf without hanging vertices is a hexahedron, if its faces may be quadrilaterals. Another is a fan about
its center: over a quadrilateral of a hexahedron a pyramid, over all else tetrahedra, whose triangles are
those of `generate.tree.cubes`. A leaf with smaller ones beyond a face is a fan over their faces, so that they
may be hexahedra. See the book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel
from ..tree.cubes import outline_of_face
from ..tree.keys import compacted, interleaved
from ..tree.lookup import Grid, entries, leaf_of
from ..tree.vertices import Vertices

__all__ = [
    "ALL_FACES",
    "FAN_OF_LEAF",
    "NOT_CHOSEN",
    "WHOLE",
    "Cubes",
    "cubes_as_cells",
    "kinds_of_leaves",
    "leaves_at_ends",
    "linked",
]

NOT_CHOSEN, FAN_OF_LEAF, WHOLE = 0, 1, 2  # what becomes of a leaf
ALL_FACES = 63  # one bit for each face
AROUND_CUBE = (0, 1, 3, 2, 4, 5, 7, 6)  # corners of a leaf in VTK's order


class Cubes(NamedTuple):
    """The cells of some leaves.

    Attributes
    ----------
    points : (v, 3) float64
        All vertices of the tree, and then the centers of fans.
    hexahedra : (h, 8) int32
    pyramids : (p, 5) int32
    tetrahedra : (t, 4) int32
    leaf : (h + p + t,) int64
        The leaf of each cell.
    outer : (f, 3) int32
        The triangles at which the chosen leaves end, outward; what may end in quadrilaterals is not here.
    outer_leaf : (f,) int64
    """

    points: NDArray[np.float64]
    hexahedra: NDArray[np.int32]
    pyramids: NDArray[np.int32]
    tetrahedra: NDArray[np.int32]
    leaf: NDArray[np.int64]
    outer: NDArray[np.int32]
    outer_leaf: NDArray[np.int64]


@inline
def _low_of(grid, leaf, low):
    for a in range(3):
        low[a] = np.int64(compacted(grid.first[leaf] >> np.uint64(a), 3))


@inline
def _beyond(grid, shift, low, width, face, quarter, q):
    """The leaf beyond a quarter of a face, counted along its outline; -1 outside of the box."""
    a, side = face >> 1, np.int64(1) << np.int64(grid.depth)
    b, c = (a + 1) % 3, (a + 2) % 3
    q[a] = low[a] + width if face & 1 else low[a] - 1
    q[b] = low[b] + ((quarter ^ (quarter >> 1)) & 1) * (width >> 1)
    q[c] = low[c] + (quarter >> 1) * (width >> 1)
    if q[a] < 0 or q[a] >= side:
        return np.int64(-1)
    return np.int64(leaf_of(grid.first, grid.entry, shift, interleaved(q[0], q[1], q[2], 3)))


@kernel
def _kinds(grid, shift, vertex, chosen, bare, kind):
    low, ring, q = np.empty(3, dtype=np.int64), np.empty(9, dtype=np.int64), np.empty(3, dtype=np.int64)
    for leaf in range(len(grid.first)):
        kind[leaf] = NOT_CHOSEN
        if not chosen[leaf]:
            continue
        _low_of(grid, leaf, low)
        width = np.int64(1) << np.int64(grid.depth - grid.levels[leaf])
        whole = True
        for face in range(6):
            outline_of_face(grid, shift, vertex, leaf, low, face, ring)
            whole &= ring[1] < 0 and ring[3] < 0 and ring[5] < 0 and ring[7] < 0 and ring[8] < 0
            if whole and not (bare[leaf] >> face) & 1:
                other = _beyond(grid, shift, low, width, face, 0, q)
                whole &= other >= 0 and chosen[other]
            if not whole:
                break
        kind[leaf] = WHOLE if whole else FAN_OF_LEAF


def kinds_of_leaves(
    grid: Grid, vertices: Vertices, chosen: NDArray[np.bool_], *, bare: NDArray[np.int8] | bool
) -> NDArray[np.int8]:
    """What becomes of each leaf: `WHOLE`, `FAN_OF_LEAF` or, if it is not chosen, `NOT_CHOSEN`.

    Parameters
    ----------
    grid, vertices
        Those of an octree that is balanced across edges.
    chosen : (n,) bool
    bare : (n,) int8 or bool
        The faces of each leaf at which it may end in quadrilaterals, as bits; True for all.
    """
    kind = np.empty(len(grid.first), dtype=np.int8)
    _kinds(grid, entries(grid.depth, 3), vertices.corners, chosen, _bits(bare, len(kind)), kind)
    return kind


def _bits(bare: NDArray[np.int8] | bool, count: int) -> NDArray[np.int8]:
    """The bits of all faces, or of none, if there is no mask."""
    return np.full(count, ALL_FACES if bare else 0, dtype=np.int8) if isinstance(bare, bool) else bare


@inline
def _quadrilateral(kind, other, bare):
    return (other >= 0 and kind[other] == WHOLE) or (bare and (other < 0 or kind[other] == NOT_CHOSEN))


@inline
def _pyramid(ring, four, at, made, count):
    """Over the quadrilateral of these places of the outline; its base is seen from the apex."""
    if count[1] < len(made.pyramids):
        for k in range(4):
            made.pyramids[count[1], k] = ring[four[3 - k] if at[1] & 1 else four[k]]
        made.pyramids[count[1], 4] = at[2]
        made.of_pyramid[count[1]] = at[0]
    count[1] += 1


@inline
def _tetrahedron(first, second, third, at, end, made, count):
    """Over a triangle that is seen counterclockwise from the upper side; `end`: nothing is beyond."""
    if at[1] & 1 == 0:
        second, third = third, second
    if count[2] < len(made.tetrahedra):
        row = made.tetrahedra[count[2]]
        row[0], row[1], row[2], row[3] = at[2], first, second, third
        made.of_tetrahedron[count[2]] = at[0]
    count[2] += 1
    if end:
        if count[3] < len(made.outer):
            row = made.outer[count[3]]
            row[0], row[1], row[2] = first, second, third
            made.of_outer[count[3]] = at[0]
        count[3] += 1


class _Made(NamedTuple):
    """The arrays that the kernel fills: cells, and the leaf of each."""

    hexahedra: NDArray[np.int32]
    pyramids: NDArray[np.int32]
    tetrahedra: NDArray[np.int32]
    outer: NDArray[np.int32]
    of_hexahedron: NDArray[np.int64]
    of_pyramid: NDArray[np.int64]
    of_tetrahedron: NDArray[np.int64]
    of_outer: NDArray[np.int64]


@kernel
def _divided_face(grid, shift, kind, bare, at, ring, made, count):
    """A face with smaller ones beyond: about its middle, each of them a base or two triangles.

    `at` has the leaf, the face, the number of the center, and the width of the leaf.
    """
    leaf, face, width, open_ = at[0], at[1], at[3], (bare[at[0]] >> at[1]) & 1 == 1
    low, q, four = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64), np.empty(4, dtype=np.int64)
    _low_of(grid, leaf, low)
    for k in range(4):
        other = _beyond(grid, shift, low, width, face, k, q)
        before, after = (2 * k + 7) % 8, 2 * k + 1
        if _quadrilateral(kind, other, open_):
            four[0], four[1], four[2], four[3] = 2 * k, after, 8, before
            _pyramid(ring, four, at, made, count)
            continue
        end = not open_ and (other < 0 or kind[other] == NOT_CHOSEN)
        _tetrahedron(ring[8], ring[before], ring[2 * k], at, end, made, count)
        _tetrahedron(ring[8], ring[2 * k], ring[after], at, end, made, count)


@kernel
def _fan(grid, shift, vertex, kind, bare, at, made, count):
    """The cells of one leaf about its center."""
    low, ring = np.empty(3, dtype=np.int64), np.empty(9, dtype=np.int64)
    outline, q, four = np.empty(8, dtype=np.int64), np.empty(3, dtype=np.int64), np.empty(4, dtype=np.int64)
    leaf = at[0]
    _low_of(grid, leaf, low)
    up = np.int64(grid.depth - grid.levels[leaf])
    at[3] = np.int64(1) << up
    for face in range(6):
        outline_of_face(grid, shift, vertex, leaf, low, face, ring)
        at[1] = face
        if ring[8] >= 0:
            _divided_face(grid, shift, kind, bare, at, ring, made, count)
            continue
        n, start, a = 0, 0, face >> 1
        for k in range(8):
            if ring[k] >= 0:
                outline[n] = ring[k]
                if k & 1 and start == 0:
                    start = n
                n += 1
        other = _beyond(grid, shift, low, at[3], face, 0, q)
        open_ = (bare[leaf] >> face) & 1 == 1
        if n == 4 and _quadrilateral(kind, other, open_):
            for k in range(4):
                four[k] = 2 * k
            _pyramid(ring, four, at, made, count)
            continue
        if n == 4:
            start = ((low[(a + 1) % 3] >> up) ^ (low[(a + 2) % 3] >> up)) & 1
        end = not open_ and (other < 0 or kind[other] == NOT_CHOSEN)
        for t in range(n - 2):
            second, third = outline[(start + 1 + t) % n], outline[(start + 2 + t) % n]
            _tetrahedron(outline[start], second, third, at, end, made, count)


@kernel
def _cells(grid, shift, vertex, kind, bare, centers, made, count):
    """Fill the arrays; what they have no room for is only counted."""
    at = np.empty(4, dtype=np.int64)
    center = centers
    for leaf in range(len(kind)):
        if kind[leaf] == WHOLE:
            if count[0] < len(made.hexahedra):
                for k in range(8):
                    made.hexahedra[count[0], k] = vertex[leaf, AROUND_CUBE[k]]
                made.of_hexahedron[count[0]] = leaf
            count[0] += 1
        elif kind[leaf] == FAN_OF_LEAF:
            at[0], at[2] = leaf, center
            _fan(grid, shift, vertex, kind, bare, at, made, count)
            center += 1


def cubes_as_cells(
    grid: Grid, vertices: Vertices, kind: NDArray[np.int8], *, bare: NDArray[np.int8] | bool
) -> Cubes:
    """The cells of leaves of these kinds; O(n log n).

    Parameters
    ----------
    grid, vertices
        Those of an octree that is balanced across edges.
    kind : (n,) int8
        See `kinds_of_leaves`.
    bare : (n,) int8 or bool
        As there.
    """
    mask = _bits(bare, len(kind))
    fans = np.flatnonzero(kind == FAN_OF_LEAF)
    count = np.zeros(4, dtype=np.int64)
    shift, start = entries(grid.depth, 3), len(vertices.points)
    made = _room(count)
    for _ in range(2):  # first they are counted
        made = _room(count)
        count = np.zeros(4, dtype=np.int64)
        _cells(grid, shift, vertices.corners, kind, mask, start, made, count)
    corner = vertices.points[vertices.corners[fans]]
    centers = corner[:, 0] + 0.5 * (corner[:, 7] - corner[:, 0])
    return Cubes(
        np.concatenate([vertices.points, centers]),
        made.hexahedra,
        made.pyramids,
        made.tetrahedra,
        np.concatenate([made.of_hexahedron, made.of_pyramid, made.of_tetrahedron]),
        made.outer,
        made.of_outer,
    )


def _room(count: NDArray[np.int64]) -> _Made:
    sizes = tuple(count.tolist())
    rows = [np.empty((n, width), dtype=np.int32) for n, width in zip(sizes, (8, 5, 4, 3), strict=True)]
    return _Made(*rows, *(np.empty(n, dtype=np.int64) for n in sizes))


@kernel
def _at_ends(grid, shift, chosen, at_end):
    """Mark chosen leaves at others and at the box's sides; pairs are found from the smaller leaf."""
    low, q = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    side = np.int64(1) << np.int64(grid.depth)
    for leaf in range(len(chosen)):
        _low_of(grid, leaf, low)
        width = np.int64(1) << np.int64(grid.depth - grid.levels[leaf])
        for code in range(27):
            rest, inside = code, True
            for a in range(3):
                q[a] = low[a] + (rest % 3 - 1) * width
                rest //= 3
                inside = inside and 0 <= q[a] < side
            if not inside:
                at_end[leaf] |= chosen[leaf]
                continue
            other = leaf_of(grid.first, grid.entry, shift, interleaved(q[0], q[1], q[2], 3))
            if grid.levels[other] <= grid.levels[leaf] and chosen[other] != chosen[leaf]:
                at_end[leaf if chosen[leaf] else other] = True


def leaves_at_ends(grid: Grid, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which chosen leaves touch leaves that are not chosen, or the sides of the box: (n,)."""
    at_end = np.zeros(len(chosen), dtype=np.bool_)
    _at_ends(grid, entries(grid.depth, 3), chosen, at_end)
    return at_end


@kernel
def _link(grid, shift, chosen, free, root):
    """Leaves that share a face, of which one is free, have one root in the end, the least of them."""
    low, q = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for leaf in range(len(chosen)):
        if not chosen[leaf]:
            continue
        _low_of(grid, leaf, low)
        width = np.int64(1) << np.int64(grid.depth - grid.levels[leaf])
        for face in range(6):
            other = _beyond(grid, shift, low, width, face, 0, q)
            if other < 0 or not chosen[other] or grid.levels[other] > grid.levels[leaf]:
                continue  # pairs of different size are found from the smaller one
            if not (free[leaf] or free[other]):
                continue
            i, j = leaf, other
            while root[i] != i:
                root[i] = root[root[i]]
                i = root[i]
            while root[j] != j:
                root[j] = root[root[j]]
                j = root[j]
            root[max(i, j)] = min(i, j)
    for leaf in range(len(chosen)):
        root[leaf] = root[root[leaf]]  # roots come first


def linked(grid: Grid, chosen: NDArray[np.bool_], free: NDArray[np.bool_] | None = None) -> NDArray[np.int64]:
    """A number for each leaf, the same for chosen leaves that hang together over faces: (n,).

    Two of them hang together over a face only if one is ``free``: nothing lies in the faces of such leaves.
    By default all are.
    """
    root = np.arange(len(chosen))
    _link(grid, entries(grid.depth, 3), chosen, chosen if free is None else free, root)
    return root
