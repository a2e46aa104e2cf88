"""From pairs of triangles to quadrilaterals: the triangles that are left walk, vertices get four cells each.

See the book, chapter 6c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...predicates.batch import scaled, unscaled
from .cleaning import clean
from .linked import linked
from .relaxing import relax_everywhere, spoiled
from .walking import walk

__all__ = ["Improved", "improved"]

FIRST_MOVES, LAST_MOVES, CLEANINGS = 3, 20, 10
LEAST_SINES = (0.5, 0.3, 0.3, 0.15, 0.08)  # of an angle around a change, from round to round
FARTHEST = 4000  # quadrilaterals that a triangle looks through for another one
FAILED_STEPS = 30  # of a triangle, until it rests


class Improved(NamedTuple):
    """The result: ``cells`` with -1 in rows that are gone, ``points`` in the units of the input."""

    points: NDArray[np.float64]
    cells: NDArray[np.int64]
    counts: dict[str, int]


def improved(
    points: NDArray[np.float64],
    cells: NDArray[np.int64],
    fixed: NDArray[np.bool_],
    closed: NDArray[np.int64],
) -> Improved:
    """Fewer triangles, fewer irregular vertices, angles nearer to right ones.

    Parameters
    ----------
    points : (n, 2) float64
    cells : (m, 4) int64
        Convex and counterclockwise; triangles end with -1.
    fixed : (n,) bool
        Vertices that do not move and stay.
    closed : (s, 2) int64
        Sides between fixed vertices that no change crosses; each side of the boundary is.

    Returns
    -------
    Improved
        Rows of ``cells`` stay where they are: cell i is on the same side of all closed sides as before.

    Notes
    -----
    Convex, by exact signs: should a cell not be so after all, which rounding alone can bring about, the
    vertices of its surroundings go back to where they were. O(m) for each of a bounded number of rounds.
    """
    xy, exact = scaled(np.ascontiguousarray(points))
    counts = {"pairs won by walking": 0, "doublets": 0, "collapsed": 0, "turned": 0, "moves": 0}
    if not exact or not len(cells):
        return Improved(points, cells, counts)
    cells, before = cells.copy(), xy.copy()
    m = linked(xy, cells, fixed, closed)
    changes = np.zeros(3, dtype=np.int64)
    moves = relax_everywhere(m, np.ones(len(xy), dtype=bool), FIRST_MOVES)
    for sine in LEAST_SINES:
        counts["pairs won by walking"] += int(walk(m, sine, FARTHEST, FAILED_STEPS))
        clean(m, max(sine, LEAST_SINES[1]), CLEANINGS, changes)
    moves += relax_everywhere(m, np.ones(len(xy), dtype=bool), LAST_MOVES)
    assert not spoiled(m), "a cell is not convex"
    counts |= dict(zip(("doublets", "collapsed", "turned"), changes.tolist())) | {"moves": int(moves)}
    moved = (xy != before).any(axis=1)
    result = points.copy()
    place = int(np.argmax(np.abs(points)))
    result[moved] = unscaled(xy[moved], float(before.flat[place] / points.flat[place]))
    return Improved(result, cells, counts)
