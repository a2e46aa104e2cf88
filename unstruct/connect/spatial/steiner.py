"""Points where nothing else helps: where a segment or triangle crosses what is in its way.

N. P. Weatherill and O. Hassan put them where an edge leaves its cells. A point is rounded; it is accepted
only if all walls of its cavity (the two cells at the face that is crossed, or the cells around the edge; then
others beyond walls that do not see it) see the rounded point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, kernel, lean
from ...geometry.edge_vectors import cross, lengths
from ..insertion.engine import STAMP
from ..insertion.stars import Space, star3
from .cavity import corner
from .costs import EDGE
from .crossing import crossings, ring, star
from .held import holds
from .journal import EVENT_POINT, close_event, old_cells, open_event
from .signs import COPLANAR, ON_EDGE, meets, side

__all__ = [
    "distance",
    "insert_around",
    "insert_between",
    "insert_within",
    "off_plane",
    "on_plane",
    "places",
    "sees",
]

Row = NDArray[np.float64]  # a point


@kernel
def sees(xyz, walls, count, p):
    """Whether vertex p is on the positive side of all these triangles."""
    for i in range(count):
        if side(xyz, walls[i, 0], walls[i, 1], walls[i, 2], p) <= 0:
            return False
    return True


@lean
def _on_wall(solid, found, walls, u, v):
    """Whether one of the walls has the vertices u and v."""
    for i in range(walls):
        t, k = found.faces[i] >> 2, found.faces[i] & 3
        at_u = at_v = False
        for j in range(4):
            if j != k:
                at_u |= solid.vertex[4 * t + j] == u
                at_v |= solid.vertex[4 * t + j] == v
        if at_u and at_v:
            return True
    return False


@apart
def _loses(solid, held, found, size, walls):
    """Whether a vertex or a held edge of the first ``size`` cells is on none of the walls."""
    for i in range(size):
        t = 4 * found.cells[i]
        for j in range(4):
            u = solid.vertex[t + j]
            if not _on_wall(solid, found, walls, u, u):
                return True
            for k in range(j):
                v = solid.vertex[t + k]
                if holds(held, u, v) and not _on_wall(solid, found, walls, u, v):
                    return True
    return False


@apart
def _walls(solid, found, size, p, more):
    """List the walls of the first ``size`` cells, and of up to ``more`` beyond walls that do not see p.

    Returns how many cells and walls there are; -1 if a wall that must stay does not see p.
    """
    solid.state[STAMP] += 1
    stamp, walls, head, most = 2 * solid.state[STAMP], 0, 0, size + more
    for i in range(size):
        solid.stamp[found.cells[i]] = stamp
    while head < size:
        t = found.cells[head]
        head += 1
        for k in range(4):
            over = solid.across[4 * t + k]
            if over < 0:
                return -1, 0
            if solid.stamp[over >> 2] == stamp:
                if solid.mark[4 * t + k] >= 0:
                    return -1, 0
                continue
            u, v = solid.vertex[4 * t + corner(k, 0)], solid.vertex[4 * t + corner(k, 1)]
            if side(solid.xyz, u, v, solid.vertex[4 * t + corner(k, 2)], p) <= 0:
                if solid.mark[4 * t + k] >= 0 or size == most:
                    return -1, 0
                solid.stamp[over >> 2] = stamp
                found.cells[size] = over >> 2
                size += 1
    for i in range(size):
        t = found.cells[i]
        for k in range(4):
            if solid.stamp[solid.across[4 * t + k] >> 2] != stamp:
                found.faces[walls] = 4 * t + k
                walls += 1
    return size, walls


@kernel
def _star(solid, held, found, size, p, more):
    """Replace the first ``size`` cells of ``found`` by the star of p, if all walls see p and none is lost.

    Up to ``more`` cells beyond walls that do not see p are replaced as well. Marked faces and held edges, and
    the hull, are not touched.
    """
    size, walls = _walls(solid, found, size, p, more)
    if size < 0 or _loses(solid, held, found, size, walls):
        return False
    found.sizes[0], found.sizes[1] = size, walls
    noting = solid.journal.shape[0] > 0
    if noting:
        open_event(solid, EVENT_POINT, -1, -1, -1, 0, p)
        old_cells(solid, found.cells, size)
    space = Space(solid.xyz, solid.vertex, solid.across, solid.stamp, solid.free, solid.state)
    star3(space, found, p, solid.state[STAMP])
    for i in range(walls):
        over = solid.across[found.faces[i]]
        new = solid.across[over]
        t = new >> 2
        solid.region[t] = solid.region[found.faces[i] >> 2]
        for k in range(4):
            solid.mark[4 * t + k] = -1
            solid.at[solid.vertex[4 * t + k]] = t
        solid.mark[new] = solid.mark[over]
        found.cells[i] = t
    if noting:
        close_event(solid, found.cells, walls)
    return True


@kernel
def insert_around(solid, held, found, u, v, p, more):
    """Insert vertex p, which is on the edge uv, if that edge is not held and all walls around it see p."""
    if holds(held, u, v):
        return False
    size = ring(solid, found, u, v)
    return size > 0 and _star(solid, held, found, size, p, more)


@kernel
def insert_between(solid, held, found, face, p, more):
    """Insert vertex p, which is on a face, if the two cells there see it."""
    if solid.across[face] < 0 or solid.mark[face] >= 0:
        return False
    found.cells[0], found.cells[1] = face >> 2, solid.across[face] >> 2
    return _star(solid, held, found, 2, p, more)


@apart
def _contains(solid, t, p):
    """Whether vertex p is in a closed cell."""
    for k in range(4):
        u, v = solid.vertex[4 * t + corner(k, 0)], solid.vertex[4 * t + corner(k, 1)]
        if side(solid.xyz, u, v, solid.vertex[4 * t + corner(k, 2)], p) < 0:
            return False
    return True


@kernel
def insert_within(solid, held, found, goal, p, more):
    """Insert vertex p, which is on a segment, into the cells that contain it, if all walls there see it.

    The cells are looked for among those that the segment meets, then at its ends.
    """
    for k in range(3):
        if k > 0:
            size = star(solid, found, goal[k - 1])
        else:
            size = found.sizes[0] if crossings(solid, EDGE, goal, found) > 0 else 0
        kept = 0
        for i in range(size):
            if _contains(solid, found.cells[i], p):
                found.cells[kept] = found.cells[i]
                kept += 1
        if kept > 0:
            return _star(solid, held, found, kept, p, more)
    return False


@kernel
def _crossed(xyz, a, b, u, v):
    """Whether edge uv, in a plane with ab or crossing it, is the one that ab crosses."""
    if u == a or u == b or v == a or v == b or side(xyz, a, b, u, v) != 0:
        return False
    for k in range(3):  # from the directions: a point of each on both sides of the other
        i, j = (k + 1) % 3, (k + 2) % 3
        ab_i, ab_j, uv_i, uv_j = (
            xyz[b, i] - xyz[a, i], xyz[b, j] - xyz[a, j], xyz[v, i] - xyz[u, i], xyz[v, j] - xyz[u, j]
        )  # fmt: skip
        first = ab_i * (xyz[u, j] - xyz[a, j]) - ab_j * (xyz[u, i] - xyz[a, i])
        second = ab_i * (xyz[v, j] - xyz[a, j]) - ab_j * (xyz[v, i] - xyz[a, i])
        third = uv_i * (xyz[a, j] - xyz[u, j]) - uv_j * (xyz[a, i] - xyz[u, i])
        fourth = uv_i * (xyz[b, j] - xyz[u, j]) - uv_j * (xyz[b, i] - xyz[u, i])
        if first * second < 0 and third * fourth < 0:
            return True
    return False


@lean
def _crossed_edge(solid, goal, u, v, w):
    """The edge of a face that the segment crosses, or -1, -1."""
    if meets(solid.xyz, goal[0], goal[1], u, v, w) in (ON_EDGE, COPLANAR):
        if _crossed(solid.xyz, goal[0], goal[1], u, v):
            return u, v
        if _crossed(solid.xyz, goal[0], goal[1], v, w):
            return v, w
        if _crossed(solid.xyz, goal[0], goal[1], w, u):
            return w, u
    return -1, -1


@lean
def _normal(xyz, a, b, p, q):
    """The cross product of the vectors from a to b and from p to q."""
    x, y, z = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    u, v, w = xyz[q, 0] - xyz[p, 0], xyz[q, 1] - xyz[p, 1], xyz[q, 2] - xyz[p, 2]
    return y * w - z * v, z * u - x * w, x * v - y * u


@lean
def _height(xyz, a, p, x, y, z):
    """The inner product of the vector from a to p with another."""
    return x * (xyz[p, 0] - xyz[a, 0]) + y * (xyz[p, 1] - xyz[a, 1]) + z * (xyz[p, 2] - xyz[a, 2])


@kernel
def on_plane(xyz, a, b, u, v, w):
    """Where the line ab meets the plane uvw: 0 at a, 1 at b; NaN if it nowhere does."""
    x, y, z = _normal(xyz, u, v, u, w)
    above, below = _height(xyz, u, a, x, y, z), _height(xyz, u, b, x, y, z)
    return above / (above - below) if above != below else np.nan


@kernel
def _on_line(xyz, a, b, p, q):
    """Where the line ab is closest to the line pq: 0 at a, 1 at b; NaN if they are parallel."""
    x, y, z = _normal(xyz, a, b, p, q)
    square = x * x + y * y + z * z
    u, v, w = _normal(xyz, a, p, p, q)
    return (u * x + v * y + w * z) / square if square > 0 else np.nan


@kernel
def places(solid, goal, found, rows, where):
    """List the faces that a segment meets: how many, -1 if ``rows`` has no room for them.

    A row has the face, its vertices, and the edge that is crossed, or -1, -1; ``where`` its place on the
    segment: 0 at the beginning, 1 at the end.
    """
    count = crossings(solid, EDGE, goal, found)
    if count > rows.shape[0]:
        return -1
    for i in range(count):
        face = found.faces[i]
        t, k = face & ~3, face & 3
        u, v, w = solid.vertex[t + (k + 1 & 3)], solid.vertex[t + (k + 2 & 3)], solid.vertex[t + (k + 3 & 3)]
        p, q = _crossed_edge(solid, goal, u, v, w)
        if p >= 0:
            where[i] = _on_line(solid.xyz, goal[0], goal[1], p, q)
        else:
            where[i] = on_plane(solid.xyz, goal[0], goal[1], u, v, w)
        rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5] = face, u, v, w, p, q
    return max(count, 0)


def _inner(a: Row, b: Row) -> float:
    """The inner product, added in a fixed order: that of BLAS depends on the processor."""
    x, y, z = (a * b).tolist()
    return x + y + z


def off_plane(p: Row, u: Row, v: Row, w: Row) -> float:
    """From p to the plane uvw; 0 if there is no such plane."""
    normal = cross(v - u, w - u)
    length = float(lengths(normal))
    return abs(_inner(normal, p - u)) / length if length > 0 else 0.0


def distance(p: Row, a: Row, b: Row) -> float:
    """From p to the line ab."""
    return float(lengths(cross(b - a, p - a)) / lengths(b - a))
