"""Construction from given points, face by face (12.2.2): gift wrapping.

Every face that has a cell on one side only looks for its *apex* on the free side: the vertex whose sphere
with the face has its center least far out; that sphere then holds no other vertex of that side.

**Ties.** Of more than d + 1 vertices on an empty sphere, each face could choose another apex, and the choices
would not fit together. So think vertex v lifted to |p_v|^2 + e(v), with infinitesimals e that grow
without bound from rank to rank (first the first cell, then the others in input order). No d + 2 lifted
points lie in a hyperplane, so there is just one lower hull, and it projects to a triangulation, for every
lifted point is a corner of it. The apex of a face is decided by the moved in-sphere sign: it is the corner of
the lower facet beyond, and every face finds the same triangulation; it is the placing triangulation within
each cospherical set. The first cell belongs to it: its lift is infinitely lower than all others.

**A prescribed front.** Then a cell must also leave all open faces alone: none may reach into it. In the plane
this finds the constrained Delaunay triangulation: Let abc be the triangle of that at ab. Any admitted apex
inside its circle would be seen from the middle of ab, which contradicts its definition. In space there may be
none (Schoenhardt's prism), and a face may be left without apex: that is reported.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import as_points
from ...base.codes import ROOM
from ...base.errors import InputError, MeshError
from ...geometry.kd_tree import Tree
from ...mesh.mesh import Mesh
from ...predicates.batch import orient, scaled
from . import faces as kernels
from .general import wrap_general
from .start import first_cell

__all__ = ["gift_wrap"]

FACES_A_CALL = 200_000  # half-faces between two looks at the keyboard


def gift_wrap(points: ArrayLike, front: ArrayLike | None = None) -> Mesh:
    """Delaunay triangulation of given points, cell by cell, each on a face of those before it.

    Parameters
    ----------
    points : array_like, shape (n, d)
        Finite, d >= 1, not all in one hyperplane.
    front : array_like of int, shape (f, d), optional
        Faces to start from, in two or three dimensions, oriented as `Mesh.boundary`: the side to be meshed
        is to the left of an edge, and behind a triangle that is seen counterclockwise. A closed front bounds
        the region that is meshed; otherwise cells are made up to the convex hull. A face given in both
        orientations is served on both sides.

    Returns
    -------
    Mesh
        ``points`` is the input in input order, ``simplices`` are in the order of making: the first k of them
        are the state after k steps, and their `boundary` is the front. Of equal points the first is used,
        the others are listed in ``duplicates``. With a front, vertices that it does not enclose are in
        no cell, and ``markers["front"]`` holds the faces.

    Raises
    ------
    InputError
        For arrays of wrong shape, type or range; the message names the first offending row.
    DegenerateInputError
        Where the points lie in a hyperplane; ``dimension`` says in which flat.
    MeshError
        Where a face admits no apex; the message names it (only with a front).

    Notes
    -----
    Exact signs decide all; a k-d tree leads to the few vertices that come into question, so that uniform
    points cost O(n log n) in two and three dimensions, a front of f faces a further O(n f). Other
    dimensions, and coordinates with exponents too wide to be scaled, take O(n) a cell.
    Source: M. Tanemura, T. Ogawa, N. Ogita, J. Comput. Phys. 51 (1983) 191-207; ties: H. Edelsbrunner,
    E. P. Muecke, ACM Trans. Graph. 9 (1990) 66-104. Book: 2.2.
    """
    given = as_points(points)
    n, d = given.shape
    if n < d + 1:
        raise InputError(f"{n} points are too few: a triangulation in {d} dimensions needs at least {d + 1}")
    kept, duplicates, representative = _distinct(given)
    if d == 1:
        if front is not None:
            raise InputError("a front needs two or three dimensions")
        return _segments(given, kept, duplicates)
    coordinates, exact = scaled(given[kept])
    compiled = d in (2, 3) and exact
    if front is not None:
        faces = _as_front(front, given, representative)
        if not compiled:
            raise InputError("a front needs two or three dimensions, and coordinates of less wide exponents")
        simplices = _wrap(coordinates, kept, None, None, np.searchsorted(kept, faces))
        return Mesh(given, simplices, duplicates=duplicates, markers={"front": faces})
    first = first_cell(coordinates if exact else given[kept])
    rank = np.arange(len(kept)) + d + 1
    rank[first] = np.arange(d + 1)
    if compiled:
        return Mesh(given, _wrap(coordinates, kept, rank, first, None), duplicates=duplicates)
    simplices, neighbors = wrap_general(coordinates if exact else given[kept], rank, first)
    return Mesh(given, kept[simplices], neighbors=neighbors, duplicates=duplicates)


def _distinct(points: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """The first of equal rows (increasing), rows (copy, kept), and for each row the one that is kept."""
    order = np.lexsort(points.T)  # stable: of equal rows the first comes first
    new = np.append(True, (points[order[1:]] != points[order[:-1]]).any(axis=1))
    representative = np.empty(len(points), dtype=np.int64)
    representative[order] = order[new][np.cumsum(new) - 1]
    copies = np.flatnonzero(representative != np.arange(len(points)))
    return np.sort(order[new]), np.column_stack([copies, representative[copies]]), representative


def _segments(points: NDArray[np.float64], kept: NDArray[np.int64], duplicates: NDArray[np.int64]) -> Mesh:
    """One dimension: neighbors in order."""
    if len(kept) < 2:
        first_cell(points[kept])  # raises
    order = kept[np.argsort(points[kept, 0])]
    return Mesh(points, np.column_stack([order[:-1], order[1:]]), duplicates=duplicates)


def _as_front(
    front: Any, points: NDArray[np.float64], representative: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The faces, by vertices that are kept."""
    n, d = points.shape
    faces = np.asarray(front)
    if faces.ndim != 2 or faces.shape[1] != d or len(faces) == 0 or faces.dtype.kind not in "iu":
        raise InputError(
            f"front must be integers of shape (f, {d}) with f >= 1, not {faces.dtype} {faces.shape}"
        )
    bad = ((faces < 0) | (faces >= n)).any(axis=1)
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(f"front[{row}] = {faces[row].tolist()} refers to vertices outside 0..{n - 1}")
    faces = representative[faces]
    for row, face in enumerate(points[faces]):
        shadows = [face] if d == 2 else [face[:, [0, 1]], face[:, [1, 2]], face[:, [2, 0]]]
        if (d == 2 and (face[0] == face[1]).all()) or (d == 3 and not np.any(orient(np.array(shadows)))):
            raise InputError(f"front[{row}] = {faces[row].tolist()} is flat: its vertices do not span a face")
    names = _rotated(faces)
    _, first = np.unique(names, axis=0, return_index=True)
    if len(first) < len(faces):
        row = int(np.setdiff1d(np.arange(len(faces)), first)[0])
        raise InputError(f"front[{row}] = {faces[row].tolist()} is given twice: drop one")
    return faces


def _rotated(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """One name for an oriented triangle (edges have one anyway): the least vertex first."""
    if faces.shape[1] == 2:
        return faces
    shift = (np.argmin(faces, axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(faces, shift, axis=1)


def _wrap(
    points: NDArray[np.float64],
    kept: NDArray[np.int64],
    rank: NDArray[np.int64] | None,
    first: NDArray[np.int64] | None,
    front: NDArray[np.int64] | None,
) -> NDArray[np.int64]:
    """Cells in the order of making (2D and 3D): from a first cell, or from the faces of a front.

    ``kept[i]`` is the input vertex that row i of ``points`` is; the cells are given by input vertices.
    """
    n, d = points.shape
    tree = Tree.of(points)
    rank = np.arange(n) if rank is None else rank
    place = np.empty(n, dtype=np.int64)
    place[tree.order] = np.arange(n)  # kernels number the vertices in the order of the tree
    if front is None:
        bases, base_rows = 0, place[first][None]
    else:
        bases, base_rows = len(front), np.full((len(front), d + 1), -1, dtype=np.int64)
        base_rows[:, :d] = place[front]  # behind the face, as a cell would be, seen from the free side
        if d == 2:
            base_rows[:, [0, 1]] = base_rows[:, [1, 0]]
    state = _State(base_rows, bases, n)
    status = ROOM
    while status == ROOM or state.counters[1] < state.counters[2]:
        if status == ROOM:
            state.grow()
        status, h = kernels.wrap(
            points[tree.order], rank[tree.order], tree.start, tree.size, tree.low, tree.high,
            state.cells, state.neighbors, front, state.heads, state.following, state.opened, state.position,
            state.queue, state.counters, FACES_A_CALL,
        )  # fmt: skip
        if status == kernels.STUCK:
            raise _stuck(kept[tree.order], state, int(h), kept[front])
    cells = state.cells[bases : state.counters[0]]
    if len(cells) == 0:
        raise MeshError(
            "front[0] has no vertex on its free side, nor has any other face: turn the faces round"
        )
    return kept[tree.order[cells]]


def _stuck(names: NDArray[np.int64], state: _State, h: int, front: NDArray[np.int64]) -> MeshError:
    c, k = divmod(h, front.shape[1] + 1)
    made = c >= len(front)
    which = f"the face of cell {c - len(front)}" if made else f"front[{c}]"
    face = (names[np.delete(state.cells[c], k)] if made else front[c]).tolist()
    return MeshError(
        f"{which} on vertices {face} admits no apex after {state.counters[0] - len(front)} cells: on "
        "any vertex of its free side the cell would be cut by an open face or hold a vertex. Make sure that "
        "faces of the front meet at vertices only; in space, add points near this face"
    )


class _State:
    """The arrays of `wrapping.wrap`, and how they grow."""

    def __init__(self, rows: NDArray[np.int64], bases: int, n: int):
        count, width = rows.shape
        self.cells, self.neighbors = rows.astype(np.int64), np.full(rows.shape, kernels.HULL, np.int64)
        self.heads = np.full(1 << int(2 * n).bit_length(), -1, dtype=np.int64)
        self.following, self.opened, self.position, self.queue = np.empty((4, 0), dtype=np.int64)
        self.counters = np.array([count, 0, 0, 0], dtype=np.int64)
        self.grow(2 * n if width == 3 else 7 * n)
        corners = range(width - 1, -1, -1) if bases == 0 else [width - 1]
        for c in range(count):
            for k in corners:
                self.neighbors[c, k] = kernels.TO_COME
                self.queue[self.counters[2]] = c * width + k
                self.counters[2] += 1
                kernels.open_face(
                    self.cells,
                    c * width + k,
                    self.heads,
                    self.following,
                    self.opened,
                    self.position,
                    self.counters,
                )

    def grow(self, more: int = 0) -> None:
        """Room for ``more`` further cells, or for as many again."""
        more = more or len(self.cells)
        width = self.cells.shape[1]
        empty = np.full((more, width), kernels.HULL, dtype=np.int64)
        self.cells, self.neighbors = (
            np.concatenate([self.cells, empty]),
            np.concatenate([self.neighbors, empty]),
        )
        room = np.empty(len(self.cells) * width - len(self.queue), dtype=np.int64)
        self.following, self.opened, self.position, self.queue = (
            np.concatenate([a, room]) for a in (self.following, self.opened, self.position, self.queue)
        )
