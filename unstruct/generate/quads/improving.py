"""From pairs of triangles to quadrilaterals: the triangles that are left walk, vertices get four cells each.

See the book, chapter 6c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...predicates.batch import scaled, unscaled
from .cleaning import clean
from .dividing import divide
from .linked import linked
from .relaxing import mark_flat, relax_everywhere
from .walking import walk

__all__ = ["Improved", "improved"]

FIRST_MOVES, LAST_MOVES, CLEANINGS = 3, 20, 10
DIVIDING_SINES = (0.15, 0.08, 0.05)
LEAST_SINES = (0.5, 0.3, 0.3, 0.15, 0.08)  # of an angle around a change, from round to round


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
    middle: NDArray[np.int64],
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
    middle : (s,) int64
        Points without cells, on the boundary, by which they may be divided, or -1.

    Returns
    -------
    Improved
        Rows of ``cells`` stay where they are: cell i is on the same side of all closed sides as before.

    Notes
    -----
    A corner turns left after a move or a change if it did before, exactly: signs of areas are trusted only if
    they are far above their rounding. Vertices of cells with flatter corners do not move, and nothing changes
    around them. O(m) for each of a bounded number of rounds.
    """
    xy, _ = scaled(np.ascontiguousarray(points))
    cells, before = cells.copy(), xy.copy()
    m = linked(xy, cells, fixed, closed, middle)
    flat = np.zeros(len(xy), dtype=bool)
    mark_flat(m, flat)
    m.free[flat] = False
    counts = {"pairs won by walking": 0}
    changes = np.zeros(3, dtype=np.int64)
    moves = relax_everywhere(m, FIRST_MOVES)
    for sine in LEAST_SINES:
        counts["pairs won by walking"] += walk(m, sine)
        clean(m, max(sine, LEAST_SINES[1]), CLEANINGS, changes)
    counts["divided"] = 0
    for sine in DIVIDING_SINES if (middle >= 0).any() else ():
        counts["divided"] += divide(m, sine)
        clean(m, LEAST_SINES[1], CLEANINGS, changes)
        counts["pairs won by walking"] += walk(m, sine)
    moves += relax_everywhere(m, LAST_MOVES)
    counts |= dict(zip(("doublets", "collapsed", "turned"), changes.tolist())) | {"moves": moves}
    moved = (xy != before).any(axis=1)
    result = points.copy()
    place = int(np.argmax(np.abs(points)))
    result[moved] = unscaled(xy[moved], float(before.flat[place] / points.flat[place]))
    return Improved(result, cells, counts)
