"""One kernel that takes a point off the surface: what `release` does for most points, without the overhead.

The star of the point is divided into sectors by marked faces. The walls of each are filled without the point,
or from a new point near it that sees them all. Where neither is possible, nothing is changed.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import kernel, lean
from .cavity import corner, reset, wall
from .costs import ANY, EDGE, NEVER
from .exchange import exchange
from .held import holds
from .journal import EVENT_MOVED, EVENT_RELEASED
from .records import COST_KIND, HASH, LOCAL_ROOM, LOCALS, NEW_CELLS, TARGET
from .refill import refill
from .steiner import sees

__all__ = ["MOST_LEFT", "NEAR_WALLS", "NODES_WITHOUT", "leave", "put_back", "refill_walls", "ways_off"]

NODES_WITHOUT = 4000  # of the search for a sector without its point
MOST_LEFT = 512  # tetrahedra in place of a star
HEAD = 6  # of the row that describes a point: it, the ends of its segment, a free vertex, children, parents
STEPS_BACK = 50  # how often a point is moved half of the way back to the surface
NEAR_WALLS = (
    0.0,
    1e-9,
    1e-4,
    1e-2,
)  # heights over walls from which a point moves away; unit: the mean distance


@kernel
def refill_walls(solid, r, walls, more, budget):
    """Refill what these oriented triangles bound; False if that is not found or has too many vertices.

    Vertex ``more`` is used as well, if it is not negative.
    """
    n = 0
    local = np.empty((walls.shape[0], 3), dtype=np.int64)
    for i in range(walls.shape[0]):
        for k in range(3):
            place = 0
            while place < n and r.label[place] != walls[i, k]:
                place += 1
            if place == n:
                if n == LOCAL_ROOM:
                    return False
                r.label[n] = walls[i, k]
                n += 1
            local[i, k] = place
    if more >= 0:
        if n == LOCAL_ROOM:
            return False
        r.label[n] = more
        n += 1
    r.size[LOCALS] = n
    reset(r)
    length = 0
    for i in range(walls.shape[0]):
        length = wall(r, length, local[i, 0], local[i, 1], local[i, 2])
    r.size[HASH] = -1
    return refill(solid.xyz, r, solid.state, length, 0.5, 0.0, budget) < NEVER


# ---------------------------------------------------------------------- ways off the surface


@lean
def _inward(normals, height, most, way):
    """Write a direction with a positive product with all normals at such a height, if that is found soon."""
    n = normals.shape[0]
    way[0] = way[1] = way[2] = 0.0
    for i in range(n):
        if height[i] <= most:
            for j in range(3):
                way[j] += normals[i, j]
    for _ in range(50):
        least, chosen = np.inf, -1
        for i in range(n):
            if height[i] <= most:
                product = normals[i, 0] * way[0] + normals[i, 1] * way[1] + normals[i, 2] * way[2]
                if product < least:
                    least, chosen = product, i
        if chosen < 0 or least > 0:
            break
        for j in range(3):
            way[j] += normals[chosen, j]
    length = max(np.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]), 1e-300)
    for j in range(3):
        way[j] /= length


@kernel
def ways_off(xyz, walls, around, p, ways):
    """Write ways from p into its sector, at most 5: away from walls nearly at p, and to the middle; how many.

    The first walls are ``around`` p, the others are whole triangles.
    """
    m = walls.shape[0]
    normals, height = np.empty((m, 3)), np.empty(m)
    last = len(NEAR_WALLS)
    ways[last] = 0.0
    scale = 0.0
    for i in range(m):
        a, b, c = walls[i, 0], walls[i, 1], walls[i, 2]
        square = above = 0.0
        for j in range(3):
            k, l = (j + 1) % 3, (j + 2) % 3
            normals[i, j] = (xyz[b, k] - xyz[a, k]) * (xyz[c, l] - xyz[a, l]) - (xyz[b, l] - xyz[a, l]) * (
                xyz[c, k] - xyz[a, k]
            )
            square += normals[i, j] * normals[i, j]
            above += normals[i, j] * (xyz[p, j] - xyz[a, j])
        length = max(np.sqrt(square), 1e-300)
        for j in range(3):
            normals[i, j] /= length
        height[i] = abs(above) / length if i < around else 0.0
        for v in (a, b, c):
            square = 0.0
            for j in range(3):
                away = xyz[v, j] - xyz[p, j]
                ways[last, j] += away
                square += away * away
            scale += np.sqrt(square)
    scale /= 3 * m
    count, before = 0, 0
    for near in NEAR_WALLS:
        flat = 0
        for i in range(m):
            flat += height[i] <= near * scale
        if flat > before:
            before = flat
            _inward(normals, height, near * scale, ways[count])
            for j in range(3):
                ways[count, j] *= scale
            count += 1
    for j in range(3):
        ways[count, j] = ways[last, j] / (3 * m)
    return count + 1


@kernel
def put_back(xyz, walls, p, q, ways):
    """Put q off p along one of these ways, so near that all walls see it; False if none is found."""
    for i in range(ways.shape[0]):
        length = 1.0
        for _ in range(STEPS_BACK):
            for j in range(3):
                xyz[q, j] = xyz[p, j] + length * ways[i, j]
            if sees(xyz, walls, walls.shape[0], q):
                return True
            length /= 2
    return False


# ---------------------------------------------------------------------- sectors


@lean
def _place_in(rows, value):
    for i in range(rows.shape[0]):
        if rows[i] == value:
            return i
    return -1


@kernel
def _sectors(solid, cells, p, children, sector):
    """Number the parts of a star that hang together through faces without marks; -1 if marks do not fit."""
    n = cells.shape[0]
    there = np.zeros(children.shape[0], dtype=np.bool_)
    for i in range(n):
        sector[i] = -1
        for k in range(4):
            place = 4 * cells[i] + k
            if solid.mark[place] >= 0 and solid.vertex[place] != p:
                j = _place_in(children, solid.mark[place])
                if j < 0:
                    return -1
                there[j] = True
    for j in range(children.shape[0]):
        if not there[j]:
            return -1
    stack, parts = np.empty(n, dtype=np.int32), 0
    for first in range(n):
        if sector[first] >= 0:
            continue
        stack[0], sector[first], top = first, parts, 1
        while top > 0:
            top -= 1
            t = cells[stack[top]]
            for k in range(4):
                if solid.vertex[4 * t + k] == p or solid.mark[4 * t + k] >= 0:
                    continue
                i = _place_in(cells, solid.across[4 * t + k] >> 2)
                if i >= 0 and sector[i] < 0:
                    sector[i] = parts
                    stack[top] = i
                    top += 1
        parts += 1
    return parts


@lean
def _write_wall(walls, m, x, y, z):
    """Write an oriented triangle, its lowest vertex first."""
    while y < x or z < x:
        x, y, z = y, z, x
    walls[m, 0], walls[m, 1], walls[m, 2] = x, y, z


@lean
def _lacking(corners, parents, x, y, z, p):
    """The vertex of the parent of a part that the part, with these vertices, has not."""
    for j in range(parents.shape[0]):
        t, has, lacking = parents[j], 0, -1
        for k in range(3):
            v = corners[t, k]
            if v != p and (v == x or v == y or v == z):
                has += 1
            else:
                lacking = v
        if has == 2:
            return lacking
    return -1


@kernel
def _walls(solid, part, p, parents, corners, walls):
    """Write the walls of a sector: how many there are around p, and with whole triangles.

    Both are left out where a whole triangle is the reverse of a wall: these bound nothing.
    """
    m = 0
    for i in range(part.shape[0]):
        k = 0
        while solid.vertex[4 * part[i] + k] != p:
            k += 1
        v = solid.vertex[4 * part[i] : 4 * part[i] + 4]
        _write_wall(walls, m, v[corner(k, 0)], v[corner(k, 1)], v[corner(k, 2)])
        m += 1
    around = m
    for i in range(part.shape[0]):
        v = solid.vertex[4 * part[i] : 4 * part[i] + 4]
        for k in range(4):
            if v[k] == p or solid.mark[4 * part[i] + k] < 0:
                continue
            x, y, z = v[corner(k, 0)], v[corner(k, 1)], v[corner(k, 2)]
            w = _lacking(corners, parents, x, y, z, p)
            if w < 0:
                return -1, 0
            _write_wall(walls, m, w if x == p else x, w if y == p else y, w if z == p else z)
            known = False
            for j in range(around, m):
                known |= (
                    walls[j, 0] == walls[m, 0] and walls[j, 1] == walls[m, 1] and walls[j, 2] == walls[m, 2]
                )
            m += not known
    for j in range(around, m):
        for i in range(around):
            if walls[i, 0] == walls[j, 0] and walls[i, 1] == walls[j, 2] and walls[i, 2] == walls[j, 1]:
                walls[i, 0] = walls[j, 0] = -1
                break
    kept = still = 0
    for i in range(m):
        if walls[i, 0] >= 0:
            walls[kept] = walls[i]
            kept += 1
            still += i < around
    return still, kept


@kernel
def _filled(solid, r, walls, around, split, q):
    """Fill these walls: 0 if ``r.best`` does, 1 if vertex q does, -1 if nothing is found."""
    r.size[COST_KIND] = ANY
    if split[4] == 0:
        r.size[COST_KIND], r.size[TARGET], r.size[TARGET + 1] = EDGE, split[1], split[2]
        for end in (split[1], split[2]):
            if _place_in(walls.ravel(), end) < 0:
                return -1
    if refill_walls(solid, r, walls, -1, NODES_WITHOUT):
        return 0
    if split[4] == 0:
        return -1
    ways = np.empty((len(NEAR_WALLS) + 1, 3))
    count = ways_off(solid.xyz, walls, around, split[0], ways)
    return 1 if put_back(solid.xyz, walls, split[0], q, ways[:count]) else -1


@kernel
def _gone(solid, held, cells, tets, free, gone):
    """List vertices, from ``gone[1]`` on, that the new cells do not have; False if something must stay.

    ``gone[1]`` is the point of the star. Only it and free vertices may go, and no edge that is held.
    """
    p, count = gone[1], 1
    flat = tets.ravel()
    for i in range(cells.shape[0]):
        v = solid.vertex[4 * cells[i] : 4 * cells[i] + 4]
        for j in range(4):
            if v[j] == p:
                continue
            if _place_in(flat, v[j]) < 0:
                if not free[v[j]]:
                    return False
                if _place_in(gone[1 : count + 1], v[j]) < 0:
                    count += 1
                    gone[count] = v[j]
            for k in range(j):
                if v[k] == p or not holds(held, v[j], v[k]):
                    continue
                there = False
                for t in range(tets.shape[0]):
                    if _place_in(tets[t], v[j]) >= 0 and _place_in(tets[t], v[k]) >= 0:
                        there = True
                        break
                if not there:
                    return False
    gone[0] = count
    return True


@kernel
def leave(solid, held, r, cells, split, corners, free, gone):
    """Release the point of a star, or move it off the surface; how many vertices are new, -1 for no change.

    Parameters
    ----------
    solid : Solid
        With room for MOST_LEFT more cells.
    held : Held
    r : Local
    cells : (n,) int32
        The star.
    split : int32
        The point, the ends of the segment that it splits (or -1), the next vertex that is free, how many
        triangles it has made, and of how many; then their numbers.
    corners : (t, 3) int32
        Vertices of triangles.
    free : bool
        Of vertices, whether they may go, too.
    gone : int32
        Is written: how many vertices go, and which.
    """
    p, children = split[0], split[HEAD : HEAD + split[4]]
    parents = split[HEAD + split[4] : HEAD + split[4] + split[5]]
    sector, part = np.empty(cells.shape[0], dtype=np.int32), np.empty(cells.shape[0], dtype=np.int32)
    parts = _sectors(solid, cells, p, children, sector)
    tets = np.empty((MOST_LEFT, 4), dtype=np.int32)
    walls = np.empty((3 * cells.shape[0] + 8, 3), dtype=np.int32)
    count = new = 0
    for s in range(parts):
        size = 0
        for i in range(cells.shape[0]):
            if sector[i] == s:
                part[size] = cells[i]
                size += 1
        around, m = _walls(solid, part[:size], p, parents, corners, walls)
        if around < 0:
            return -1
        if m == 0:
            continue
        how = _filled(solid, r, walls[:m], around, split, split[3] + new)
        more = m if how == 1 else r.size[NEW_CELLS]
        if how < 0 or count + more > MOST_LEFT:
            return -1
        for i in range(more):
            if how == 1:
                tets[count, :3], tets[count, 3] = walls[i], split[3] + new
            else:
                for k in range(4):
                    tets[count, k] = r.label[r.best[i, k]]
            count += 1
        new += how
    gone[0], gone[1] = 1, p
    if parts < 0 or not _gone(solid, held, cells, tets[:count], free, gone):
        return -1
    restored = np.empty((parents.shape[0], 4), dtype=np.int32)
    for j in range(parents.shape[0]):
        restored[j, :3], restored[j, 3] = corners[parents[j]], parents[j]
    event = np.full(6, -1, dtype=np.int32)
    event[0], event[1], event[2] = EVENT_MOVED if new > 0 else EVENT_RELEASED, split[1], split[2]
    if split[1] < 0:
        event[1:4] = corners[parents[0]]
    event[4], event[5] = 0, p
    return new if exchange(solid, cells, tets[:count], restored, event) else -1
