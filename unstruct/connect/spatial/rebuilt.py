"""The Delaunay tetrahedra of the vertices of a complex, with the same marked faces and edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct
from .arrays import BOX
from .complex import SpatialComplex
from .given import Given
from .recover import MORE_EFFORT, Recovery

__all__ = ["rebuilt"]

FEW_TO_FIND, SHARE_TO_FIND = 30, 0.1  # edges: beyond this, a recovery would not be quick

SEEN_FACES = np.array(
    [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]]
)  # opposite each vertex, as the cell sees it


def rebuilt(
    cells: SpatialComplex, edges: NDArray[np.int32], without: NDArray[np.int32]
) -> SpatialComplex | None:
    """The complex of the same vertices, made anew, in which all marked faces and these edges are recovered.

    Parameters
    ----------
    cells : SpatialComplex
        Its marks and regions are taken over, and so are the numbers of its vertices.
    edges : (k, 2) int32
        Further edges.
    without : (v,) int32
        Vertices that are on no marked face and on none of the edges, and are left out.

    Returns
    -------
    SpatialComplex or None
        None if much is missing in the Delaunay tetrahedra, or if points would be needed to recover it.

    Notes
    -----
    O(n log n) in practice. The regions of cells at marked faces are those of the cells that were there; the
    others follow from these.
    """
    slots = np.flatnonzero(cells.used())
    corner = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[slots]
    number = np.zeros(cells.size, dtype=bool)
    number[corner] = True
    number[cells.given : cells.given + BOX] = number[without] = False
    used = np.flatnonzero(number)
    place = np.full(cells.size, -1, dtype=np.int32)
    place[used] = np.arange(len(used), dtype=np.int32)
    faces, mark, sides = _marked(cells, slots)
    new = SpatialComplex(cells.xyz[used])
    if new.factor != 1.0:  # a point is beyond what was given, up to rounding
        return None
    given = Given(place[faces], place[edges])
    if _missing(new, given.segment) > FEW_TO_FIND + SHARE_TO_FIND * len(given.segment):
        return None
    run = Recovery(new, given, budget=0, seed=0)
    run.run()
    for run.level in range(1, len(MORE_EFFORT)):
        left = len(run.lost) + len(run.missing())
        if not 0 < left <= FEW_TO_FIND:
            break
        run.again()
    if len(run.lost) + len(run.missing()):
        return None
    vertices = np.concatenate([used, cells.given + np.arange(BOX)]).astype(np.int32)
    _take_over(new, cells, vertices)
    return new if _take_marks(new, cells, (faces, mark, sides)) else None


def _missing(new: SpatialComplex, edges: NDArray[np.int32]) -> int:
    """How many of these edges, lower vertex first, the complex has not."""
    cells = new.cells().astype(np.int64)
    pairs = [(cells[:, i], cells[:, j]) for i in range(4) for j in range(i)]
    there = distinct(np.concatenate([np.minimum(u, v) * new.size + np.maximum(u, v) for u, v in pairs]))
    keys = edges[:, 0].astype(np.int64) * new.size + edges[:, 1]
    return len(keys) - int((there[np.minimum(np.searchsorted(there, keys), len(there) - 1)] == keys).sum())


def _marked(
    cells: SpatialComplex, slots: NDArray[np.int64]
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """The marked faces, once each and seen from a cell, their marks, and the regions on both sides."""
    place = 4 * slots[:, None] + np.arange(4)
    across, marks = cells.across[place], cells.mark[place]
    row, k = np.nonzero((marks >= 0) & (across > place))
    faces = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[slots[row][:, None], SEEN_FACES[k]]
    sides = np.column_stack([cells.region[slots[row]], cells.region[across[row, k] >> 2]])
    return faces, marks[row, k], sides


def _take_over(new: SpatialComplex, cells: SpatialComplex, vertices: NDArray[np.int32]) -> None:
    """Give the new complex the numbers of vertices of the other one."""
    live = new.used()
    rows = new.vertex[: 4 * new.slots].reshape(-1, 4)
    rows[live] = vertices[rows[live]]
    at = np.full(len(cells.xyz), -1, dtype=np.int32)
    at[vertices] = new.at[: len(vertices)]
    xyz = cells.xyz.copy()
    xyz[vertices[-BOX:]] = new.xyz[len(vertices) - BOX : len(vertices)]
    new.xyz, new.at, new.size = xyz, at, cells.size
    new.given, new.factor = cells.given, cells.factor


def _take_marks(
    new: SpatialComplex,
    cells: SpatialComplex,
    marked: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]],
) -> bool:
    """Give faces their marks and cells their regions; False if these contradict each other."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    faces, mark, sides = marked
    slots = np.flatnonzero(new.used())
    own = np.full(new.slots, -1, dtype=np.int64)
    own[slots] = np.arange(len(slots))
    place = 4 * slots[:, None] + np.arange(4)
    across, marks = new.across[place], new.mark[place]
    row, k = np.nonzero((marks < 0) & (across > place))
    pairs = row, own[across[row, k] >> 2]
    graph = coo_matrix((np.ones(len(row), dtype=bool), pairs), shape=(len(slots), len(slots)))
    count, part = connected_components(graph, directed=False)
    row, k = np.nonzero(marks >= 0)
    number = marks[row, k]
    seen = new.vertex[: 4 * new.slots].reshape(-1, 4)[slots[row][:, None], SEEN_FACES[k]]
    first = (seen == faces[number, :1]).argmax(axis=1)
    same = seen[np.arange(len(seen)), (first + 1) % 3] == faces[number, 1]
    region = np.where(same, sides[number, 0], sides[number, 1])
    of_part = np.full(count, -1, dtype=np.int32)
    of_part[part[row]] = region
    if not np.array_equal(of_part[part[row]], region) or len(number) != 2 * len(faces):
        return False
    new.region[:] = -1
    new.region[slots] = of_part[part]
    new.mark[place[row, k]] = mark[number]
    new.given_parts = cells.given_parts
    return True
