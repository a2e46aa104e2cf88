"""Further points into a complex whose facets are faces already: each goes into its cell and those beside it.

A point is inserted by a star that ends at marked faces and keeps numbered edges, see `connect.spatial.star`.
So what is there stays, and cells stay positive, wherever the points are. A point that sees too little of its
own cell for a star is left out. See the book, 2.8c.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, kernel
from ...base.progress import progress_bar
from ...geometry.ordering import brio
from .cavity import draw
from .complex import Recovered, SpatialComplex
from .numbered import Numbered, new_numbered, number_edges
from .opening import FACES_OPEN, STAR_FIRST, STAR_SEEDS, Star, new_star, sees_face
from .star import commit_star, room_for_star, search_star

__all__ = ["add_points"]

ADDED_A_CALL = 5000  # points for one kernel call, some hundredths of a second: Ctrl-C works between
CELLS_A_POINT = 8  # slots in reserve for each point that is added: on average it needs 6 to 7
LONGEST_WALK = 100_000  # steps to the cell of a point


@apart
def _walk(solid, t, p):
    """The cell that contains p, from cell t through any faces; -1 if it is not found.

    The first face is drawn by lot, so that the walk ends with probability 1 in any triangulation.
    """
    for _ in range(LONGEST_WALK):
        first, moved = draw(solid.state, 4), False
        for i in range(4):
            face = 4 * t + ((first + i) & 3)
            if sees_face(solid, face, p) < 0:
                if solid.across[face] < 0:
                    return -1
                t = solid.across[face] >> 2
                moved = True
                break
        if not moved:
            return t
    return -1


@kernel
def _add(solid, star, edges, first, last, start, left_out):
    """Insert the vertices from ``first`` on; the first one that is not done yet, and a cell near it."""
    t = start
    for p in range(first, last):
        found = _walk(solid, t, p)
        if found < 0 or solid.region[found] < 0:
            left_out[p - first] = True
            continue
        t = found
        star.cells[0] = t
        star.sizes[STAR_SEEDS], star.sizes[STAR_FIRST], star.sizes[FACES_OPEN] = 1, 1, 0
        if not search_star(solid, star, edges, p, -1):
            left_out[p - first] = True
            continue
        if not room_for_star(solid, star):
            return p, t
        commit_star(solid, star, p)
        t = star.fresh[0]
    return last, t


def add_points(
    cells: SpatialComplex,
    points: NDArray[np.float64],
    found: Recovered,
    segments: NDArray[np.int32],
    *,
    progress: bool = False,
) -> int:
    """Insert points into the inside of a complex in which all that was given is there.

    Parameters
    ----------
    cells : SpatialComplex
        Recovered and flooded.
    points : (k, 3) float64
        Those outside, and those for which there is no star, are left out.
    found : Recovered
        What the recovery said.
    segments : (s, 2) int32
        The given segments; the edges that they consist of stay.
    progress : bool
        Show a progress bar.

    Returns
    -------
    int
        How many points are in.

    Notes
    -----
    Points come in random rounds, each along a Hilbert curve; O(n log n) in practice for n points.
    """
    rows = points[brio(points)] * cells.factor
    ends = _kept_edges(found, segments)
    first, last = cells.size, cells.size + len(rows)
    cells.reserve(last, cells.slots + CELLS_A_POINT * min(len(rows), ADDED_A_CALL))
    cells.xyz[first:last] = rows
    star = new_star(len(cells.stamp), len(cells.xyz))
    edges: Numbered = new_numbered(len(ends), len(cells.xyz))
    number_edges(edges, ends, 0, len(ends))
    left_out = np.zeros(len(rows), dtype=np.bool_)
    start = int(np.flatnonzero(cells.used() & (cells.region[: cells.slots] >= 0))[0])
    done = first
    with progress_bar(progress, " points", total=len(rows)) as bar:
        while done < last:
            star = _roomy(cells, star)
            stop = min(done + ADDED_A_CALL, last)
            before = done
            done, start = _add(cells.solid(), star, edges, done, stop, start, left_out[done - first :])
            bar.update(int(done) - before)
    cells.size = last
    return len(rows) - int(left_out.sum())


def _roomy(cells: SpatialComplex, star: Star) -> Star:
    """Room for the cells of further points, and a record for searches through so many cells."""
    cells.reserve(len(cells.xyz), cells.slots + CELLS_A_POINT * ADDED_A_CALL)
    return star if len(star.cells) >= len(cells.stamp) else new_star(len(cells.stamp), len(cells.xyz))


def _kept_edges(found: Recovered, segments: NDArray[np.int32]) -> NDArray[np.int32]:
    """The edges that the given segments consist of, those in parts included."""
    ends: list[tuple[int, int]] = []
    for u, v in np.sort(segments, axis=1).tolist():
        ends += pairwise(found.chains.get((u, v), [u, v]))
    return np.array(ends, dtype=np.int32).reshape(-1, 2)
