"""Whether a point, a segment or a triangle meets the inside of a box, exactly.

A convex piece misses the inside of a box if and only if a plane has them on its two sides, and then one of a
few planes does: those of the faces of the box, that of a triangle, and those that contain an edge of the
piece and are parallel to an axis. The last ones are lines in a projection along that axis. So all that is
needed are comparisons, and orientations in two and in three dimensions (S. Gottschalk, M. C. Lin, D. Manocha,
*OBBTree*, Proc. SIGGRAPH 1996). See the book, chapter 4a.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import frozen
from ..base.jit import inline, kernel
from ..predicates.kernels import orient2, orient3

__all__ = ["meets_inside", "pieces_in_boxes"]


@kernel
def _turn(ax, ay, bx, by, cx, cy):
    return orient2(ax, ay, bx, by, cx, cy)


@kernel
def _above(xyz, piece, x, y, z):
    a, b, c = piece[0], piece[1], piece[2]
    return orient3(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2],
        xyz[c, 0], xyz[c, 1], xyz[c, 2], x, y, z,
    )  # fmt: skip


@inline
def _divides(xyz, piece, k, low, high, i, j):
    """Whether the line of the edge from corner k of the piece, seen in coordinates i, j, separates them."""
    corners = len(piece)
    u, v = piece[k], piece[(k + 1) % corners]
    if xyz[u, i] == xyz[v, i] and xyz[u, j] == xyz[v, j]:
        return False  # seen end-on: it has no line
    rest = 0
    if corners == 3:
        w = piece[(k + 2) % corners]
        rest = _turn(xyz[u, i], xyz[u, j], xyz[v, i], xyz[v, j], xyz[w, i], xyz[w, j])
    left, right = rest >= 0, rest <= 0  # where the piece may lie; the box must be on the other side
    for corner in range(4):
        x = high[i] if corner & 1 else low[i]
        y = high[j] if corner & 2 else low[j]
        s = _turn(xyz[u, i], xyz[u, j], xyz[v, i], xyz[v, j], x, y)
        left &= s <= 0
        right &= s >= 0
        if not left and not right:
            return False
    return True


@kernel
def meets_inside(xyz, piece, low, high):
    """Whether the piece, one to three vertices in general position, meets the open box from low to high.

    Exact for coordinates of magnitude up to 1, in two and three dimensions.
    """
    d, corners = xyz.shape[1], len(piece)
    for a in range(d):
        least, most = xyz[piece[0], a], xyz[piece[0], a]
        for k in range(1, corners):
            least, most = min(least, xyz[piece[k], a]), max(most, xyz[piece[k], a])
        if most <= low[a] or least >= high[a]:
            return False
    if corners == 1:
        return True
    edges = 1 if corners == 2 else 3
    if d == 2:
        for k in range(edges):
            if _divides(xyz, piece, k, low, high, 0, 1):
                return False
        return True
    for axis in range(3):
        for k in range(edges):
            if _divides(xyz, piece, k, low, high, (axis + 1) % 3, (axis + 2) % 3):
                return False
    if corners == 2:
        return True
    below, above = True, True
    for corner in range(8):
        s = _above(
            xyz,
            piece,
            high[0] if corner & 1 else low[0],
            high[1] if corner & 2 else low[1],
            high[2] if corner & 4 else low[2],
        )
        below &= s <= 0
        above &= s >= 0
        if not below and not above:
            return True
    return False


@kernel
def _pieces_in_boxes(xyz, pieces, piece, low, high, meets):
    for i in range(len(piece)):
        meets[i] = meets_inside(xyz, pieces[piece[i]], low[i], high[i])


def pieces_in_boxes(
    xyz: NDArray[np.float64],
    pieces: NDArray[np.int64],
    piece: NDArray[np.int64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Whether piece ``piece[i]`` meets the open box from ``low[i]`` to ``high[i]``.

    Parameters
    ----------
    xyz : (n, d) ndarray
        Points, d = 2 or 3, of magnitude up to 1 (`predicates.batch.scaled`), as the boxes.
    pieces : (m, k) ndarray of int64
        Rows of one to three vertices that are not collinear.
    piece : (q,) ndarray of int64
    low, high : (q, d) ndarray

    Returns
    -------
    (q,) ndarray of bool
        Exact.
    """
    meets = np.empty(len(piece), dtype=np.bool_)
    # Read-only or not, so that the kernel is compiled once.
    _pieces_in_boxes(frozen(xyz), frozen(pieces), piece, low, high, meets)
    return meets
