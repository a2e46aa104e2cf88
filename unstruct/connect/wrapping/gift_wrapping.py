"""Gift wrapping: a triangulation of given points, built face by face (12.2.2).

A face with a cell on only one side needs an *apex* on its free side. This is the vertex on that side whose
sphere through the face has its center least far out. The sphere then contains no other vertex of that side.

**Ties.** If more than d + 1 vertices lie on an empty sphere, each face could choose another apex, and the
choices would not fit together. So lift each vertex v to |p_v|^2 + e(v), with infinitesimals e that grow
without bound from rank to rank. The vertices of the first cell have the lowest ranks; the others follow in
input order. No d + 2 lifted points lie in a hyperplane, so there is exactly one lower hull. It projects to a
triangulation, because every lifted point is a corner of it. The in-sphere sign of the lifted points decides
the apex of a face: it is the corner of the lower facet beyond the face. So every face finds the same
triangulation, which is the placing triangulation within each cospherical set. It contains the first cell,
whose lift is infinitely lower than all others.

**A prescribed front.** With a front, no open face may reach into a new cell. In the plane this finds the
constrained Delaunay triangulation. To see this, let abc be its triangle at ab. Any admitted apex inside its
circle would be visible from the middle of ab, which contradicts the definition of that triangulation. In
space there may be no triangulation (Schoenhardt's prism). A face may then be left without an apex, which is
reported as an error.
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
from .apex import Sites
from .general import wrap_general
from .start import first_cell

__all__ = ["gift_wrap"]

FACES_A_CALL = 200_000  # how many half-faces are processed before Ctrl-C is checked again


def gift_wrap(points: ArrayLike, front: ArrayLike | None = None) -> Mesh:
    """Delaunay triangulation of given points, built cell by cell, each on a face of an earlier cell.

    Parameters
    ----------
    points : array_like, shape (n, d)
        Finite coordinates with d >= 1; the points must not all lie in one hyperplane.
    front : array_like of int, shape (f, d), optional
        Faces to start from, in two or three dimensions, oriented like `Mesh.boundary`: the side to be meshed
        is to the left of an edge, and behind a triangle that is seen counterclockwise. A closed front bounds
        the region that is meshed; otherwise cells are added up to the convex hull. A face given in both
        orientations gets cells on both sides.

    Returns
    -------
    Mesh
        ``points`` is the input in input order. ``simplices`` are in the order of their creation: the first k
        of them are the state after k steps, and the `boundary` of these is the front at that time. Of equal
        points the first is used, and the others are listed in ``duplicates``. With a front, vertices that
        it does not enclose are in no cell, and ``markers["front"]`` contains the faces.

    Raises
    ------
    InputError
        For arrays of wrong shape, type or range; the message names the first offending row.
    DegenerateInputError
        If the points lie in a hyperplane; ``dimension`` is the dimension of their affine hull.
    MeshError
        If a face admits no apex; the message names the face (only with a front).

    Notes
    -----
    Exact signs decide everything. A k-d tree finds the few vertices that can be the apex, so that uniform
    points cost O(n log n) in two and three dimensions; a front of f faces costs O(n f) more. Other
    dimensions, and coordinates that cannot be scaled exactly, take O(n) per cell.
    Source: M. Tanemura, T. Ogawa, N. Ogita, J. Comput. Phys. 51 (1983) 191-207; for ties: H. Edelsbrunner,
    E. P. Muecke, ACM Trans. Graph. 9 (1990) 66-104. Book: 2.2a.
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
            raise InputError(
                "a front needs two or three dimensions, and coordinates that one factor scales exactly"
            )
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
    """The first of equal rows (increasing), pairs (copy, kept), and for each row the row that is kept."""
    order = np.lexsort(points.T)  # the sort is stable, so that equal rows keep their order
    new = np.append(True, (points[order[1:]] != points[order[:-1]]).any(axis=1))
    representative = np.empty(len(points), dtype=np.int64)
    representative[order] = order[new][np.cumsum(new) - 1]
    copies = np.flatnonzero(representative != np.arange(len(points)))
    return np.sort(order[new]), np.column_stack([copies, representative[copies]]), representative


def _segments(points: NDArray[np.float64], kept: NDArray[np.int64], duplicates: NDArray[np.int64]) -> Mesh:
    """The triangulation in one dimension: segments between consecutive points."""
    if len(kept) < 2:
        first_cell(points[kept])  # raises a DegenerateInputError
    order = kept[np.argsort(points[kept, 0])]
    return Mesh(points, np.column_stack([order[:-1], order[1:]]), duplicates=duplicates)


def _as_front(
    front: Any, points: NDArray[np.float64], representative: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The faces, with each vertex replaced by the equal one that is kept."""
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
            raise InputError(
                f"front[{row}] = {faces[row].tolist()} is flat; its vertices must span an edge or a triangle"
            )
    names = _rotated(faces)
    _, first = np.unique(names, axis=0, return_index=True)
    if len(first) < len(faces):
        row = int(np.setdiff1d(np.arange(len(faces)), first)[0])
        raise InputError(f"front[{row}] = {faces[row].tolist()} is given twice; remove one of them")
    return faces


def _rotated(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """A unique form of oriented triangles, with the smallest vertex first; oriented edges are unchanged."""
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
    """Cells in the order of their creation (2D and 3D), from a first cell or from the faces of a front.

    Row i of ``points`` is the input vertex ``kept[i]``. The cells are returned with input vertices.
    """
    n, d = points.shape
    tree = Tree.of(points)
    rank = np.arange(n) if rank is None else rank
    place = np.empty(n, dtype=np.int64)
    place[tree.order] = np.arange(n)  # in kernels, vertices are numbered in the order of the tree
    if front is None:
        bases, base_rows = 0, place[first][None]
    else:
        bases, base_rows = len(front), np.full((len(front), d + 1), -1, dtype=np.int64)
        base_rows[:, :d] = place[front]  # a base is oriented like a cell behind the face
        if d == 2:
            base_rows[:, [0, 1]] = base_rows[:, [1, 0]]
    state = _State(base_rows, bases, n)
    sites = Sites(points[tree.order], rank[tree.order], tree.start, tree.size, tree.low, tree.high)
    status = ROOM
    while status == ROOM or state.counters[1] < state.counters[2]:
        if status == ROOM:
            state.grow()
        status, h = kernels.wrap(sites, state.cells, state.neighbors, front, state.waiting(), FACES_A_CALL)
        if status == kernels.STUCK:
            raise _stuck(kept[tree.order], state, int(h), kept[front])
    cells = state.cells[bases : state.counters[0]]
    if len(cells) == 0:
        raise MeshError(
            "no face of the front has a vertex on its free side; reverse the orientation of the faces"
        )
    return kept[tree.order[cells]]


def _stuck(names: NDArray[np.int64], state: _State, h: int, front: NDArray[np.int64]) -> MeshError:
    c, k = divmod(h, front.shape[1] + 1)
    made = c >= len(front)
    which = f"the face of cell {c - len(front)}" if made else f"front[{c}]"
    face = (names[np.delete(state.cells[c], k)] if made else front[c]).tolist()
    return MeshError(
        f"{which} on vertices {face} admits no apex after {state.counters[0] - len(front)} cells: with "
        "any vertex on its free side, the cell would be cut by an open face or contain a vertex. Make sure "
        "that faces of the front meet at vertices only; in space, add points near this face"
    )


class _State:
    """The arrays of `faces.wrap`, and how they grow."""

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

    def waiting(self) -> kernels.Open:
        """The open half-faces, as they are now."""
        return kernels.Open(self.heads, self.following, self.opened, self.position, self.queue, self.counters)

    def grow(self, more: int = 0) -> None:
        """Make room for ``more`` further cells, or for twice as many cells as now if ``more`` is 0."""
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
