"""Whether a cell may be made ahead of a face of the front, by exact signs, compiled.

The cell abcd may be made if d is strictly ahead of abc, no vertex of the front is in the closed solid
tetrahedron besides its corners, and each triangle of the front meets it in nothing but common corners and
what these span. Then all of the open cell is not meshed: it is connected, it is not meshed along abc, and
whoever leaves what is not meshed passes through the front. No component of the front is swallowed, since its
vertices would be inside; and what is touched from outside (a vertex on a side of the cell, an edge through a
side, two faces in a plane that overlap) is refused, so that cells meet in whole faces, edges and vertices.

**A triangle and a tetrahedron** meet in a convex set. It is spanned by its extreme points, each of which is a
corner of one in the other, or lies on an edge of one and a face of the other. So they meet in nothing but
what common corners span, if and only if no other corner of the triangle is in the tetrahedron, no edge of
the triangle meets a side of the tetrahedron outside of common corners, and no edge of the tetrahedron so
meets the triangle (`meeting`). Most pairs need no such search: a plane, of a side or of the triangle, has the
corners that are not common strictly on two sides.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline, lean
from ...geometry.triangle_pairs import meeting, side
from ..advancing.digital_tree import gather

__all__ = [
    "CELL_CROSSED", "CELL_FREE", "CELL_HOLDS", "NOT_AHEAD", "blocking_face", "box_of_cell", "cell_fault",
    "is_apart", "meets_cell", "set_cell",
]  # fmt: skip

CELL_FREE, NOT_AHEAD, CELL_HOLDS, CELL_CROSSED = range(4)
# The corners of the side of a positive cell opposite each corner, which is on their positive side.
SIDES_OF_CELL = np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]])
CELL_EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])


@inline
def set_cell(front, row, d):
    """Look at the cell of a face of the front and a vertex."""
    for k in range(3):
        front.cell[k] = front.corner[row, k]
    front.cell[3] = d


@apart
def beyond_sides(xyz, cell, v):
    """Four bits: of which sides of the cell v is strictly outside, or, for a corner, on which it is."""
    bits = 0
    for k in range(4):
        if cell[k] == v:
            return 15 ^ (1 << k)
    for k in range(4):
        i, j, m = SIDES_OF_CELL[k, 0], SIDES_OF_CELL[k, 1], SIDES_OF_CELL[k, 2]
        if side(xyz, cell[i], cell[j], cell[m], v) < 0:
            bits |= 1 << k
    return bits


@inline
def is_corner(cell, v):
    """Whether v is a corner of the cell."""
    return v == cell[0] or v == cell[1] or v == cell[2] or v == cell[3]


@lean
def is_on_one_side(xyz, cell, u, v, w):
    """Whether the corners of the cell that are not u, v or w are strictly on one side of their plane."""
    sign = 0
    for k in range(4):
        x = cell[k]
        if x == u or x == v or x == w:
            continue
        one = side(xyz, u, v, w, x)
        if one == 0 or one == -sign:
            return False
        sign = one
    return True


@apart
def meets_cell(xyz, cell, u, v, w):
    """Whether the triangle uvw meets the positive cell elsewhere than in what common corners span."""
    one, two = beyond_sides(xyz, cell, u), beyond_sides(xyz, cell, v)
    three = beyond_sides(xyz, cell, w)
    if one & two & three:
        return False
    if one == 0 or two == 0 or three == 0:
        return True
    if is_on_one_side(xyz, cell, u, v, w):
        return False
    for k in range(4):
        p, q, r = cell[SIDES_OF_CELL[k, 0]], cell[SIDES_OF_CELL[k, 1]], cell[SIDES_OF_CELL[k, 2]]
        if (
            meeting(xyz, u, v, p, q, r)[0] != 0
            or meeting(xyz, v, w, p, q, r)[0] != 0
            or meeting(xyz, w, u, p, q, r)[0] != 0
        ):
            return True
    for k in range(6):
        if meeting(xyz, cell[CELL_EDGES[k, 0]], cell[CELL_EDGES[k, 1]], u, v, w)[0] != 0:
            return True
    return False


@apart
def is_pierced(xyz, cell, u, v):
    """Whether the segment uv meets the positive cell elsewhere than in what common corners span."""
    one, two = beyond_sides(xyz, cell, u), beyond_sides(xyz, cell, v)
    if one & two:
        return False
    if one == 0 or two == 0:
        return True
    for k in range(4):
        p, q, r = cell[SIDES_OF_CELL[k, 0]], cell[SIDES_OF_CELL[k, 1]], cell[SIDES_OF_CELL[k, 2]]
        if meeting(xyz, u, v, p, q, r)[0] != 0:
            return True
    return False


@inline
def is_apart(xyz, window, u, v, w):
    """Whether the box of the triangle uvw has no point in common with a window."""
    x0, y0, z0, x1, y1, z1 = window
    return (
        max(xyz[u, 0], xyz[v, 0], xyz[w, 0]) < x0
        or min(xyz[u, 0], xyz[v, 0], xyz[w, 0]) > x1
        or max(xyz[u, 1], xyz[v, 1], xyz[w, 1]) < y0
        or min(xyz[u, 1], xyz[v, 1], xyz[w, 1]) > y1
        or max(xyz[u, 2], xyz[v, 2], xyz[w, 2]) < z0
        or min(xyz[u, 2], xyz[v, 2], xyz[w, 2]) > z1
    )


@inline
def box_of_cell(xyz, cell):
    """The smallest and the largest corner of the box of a cell."""
    a, b, c, d = cell[0], cell[1], cell[2], cell[3]
    return (
        min(xyz[a, 0], xyz[b, 0], xyz[c, 0], xyz[d, 0]), min(xyz[a, 1], xyz[b, 1], xyz[c, 1], xyz[d, 1]),
        min(xyz[a, 2], xyz[b, 2], xyz[c, 2], xyz[d, 2]), max(xyz[a, 0], xyz[b, 0], xyz[c, 0], xyz[d, 0]),
        max(xyz[a, 1], xyz[b, 1], xyz[c, 1], xyz[d, 1]), max(xyz[a, 2], xyz[b, 2], xyz[c, 2], xyz[d, 2]),
    )  # fmt: skip


@lean
def holds_one(front):
    """Whether a vertex of the front, besides the corners, is in the closed cell."""
    xyz, cell, found = front.xyz, front.cell, front.vertices.found
    for i in range(gather(front.vertices, box_of_cell(xyz, cell))):
        v = np.int64(found[i])
        if not is_corner(cell, v) and beyond_sides(xyz, cell, v) == 0:
            return True
    return False


@lean
def blocking_face(front):
    """The row of a face of the front that is in the way of the cell, -1 for none."""
    xyz, cell, corner, found = front.xyz, front.cell, front.corner, front.faces.found
    window = box_of_cell(xyz, cell)
    for i in range(gather(front.faces, window)):
        row = np.int64(found[i])
        u, v, w = np.int64(corner[row, 0]), np.int64(corner[row, 1]), np.int64(corner[row, 2])
        if not is_apart(xyz, window, u, v, w) and meets_cell(xyz, cell, u, v, w):
            return row
    return np.int64(-1)


@lean
def blocking_thread(front):
    """Whether an inner segment is in the way of the cell."""
    if front.ends.shape[0] == 0:
        return False
    xyz, cell, found = front.xyz, front.cell, front.threads.found
    for i in range(gather(front.threads, box_of_cell(xyz, cell))):
        if is_pierced(xyz, cell, np.int64(front.ends[found[i], 0]), np.int64(front.ends[found[i], 1])):
            return True
    return False


@apart
def cell_fault(front):
    """Why the cell that is looked at must not be made: CELL_FREE, NOT_AHEAD, CELL_HOLDS or CELL_CROSSED."""
    cell = front.cell
    if side(front.xyz, cell[0], cell[1], cell[2], cell[3]) <= 0:
        return NOT_AHEAD
    if holds_one(front):
        return CELL_HOLDS
    if blocking_face(front) >= 0 or blocking_thread(front):
        return CELL_CROSSED
    return CELL_FREE
