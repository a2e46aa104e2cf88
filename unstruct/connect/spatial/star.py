"""Insertion among marked faces and numbered edges in two phases: a star is found and judged, then made.

An insertion of vertex p collects a *cavity* without any change: the cells whose open sphere contains p and
that are reached from its seeds across unmarked faces. Its *walls* are the faces where it ends. If p sees all
walls, strictly and by exact signs, the star of p over the walls is a triangulation of the cavity, whatever
the seeds were and however p was rounded: all walls turn the same side to p, so they go around it once. Cells
whose walls p does not see are left out again; so are cells without which a numbered edge would be lost, or a
vertex, except those that may go. Where p does not see a wall of a seed, as flat cells beside coplanar faces
have them, the cell beyond becomes a seed, too; if that is behind a marked face, or if an edge or a vertex
takes a seed, there is no star, and nothing has changed.

A point on a face, or on a numbered edge, splits marked faces. These are *opened* first: searches pass through
them, and the star has no wall there. Their outline, the *rim*, is joined to p by new marked faces:

         ---- x ----        Opened faces x y a, x a b, from above. The rim is the outline of x y a b. Cells on
        /   / |     \\       both sides of them are in the cavity. The new faces are a p, joined with each
       y   /  p      b      edge of the rim; they carry the mark of the opened faces. So the facet is
        \\ /   |     /       replaced by triangles with the rounded point p; from then on they are the facet.
         a ---------

Sources: A. Bowyer, D. F. Watson (1981); star-shaped cavities: P.-L. George, H. Borouchaki, Delaunay
Triangulation and Meshing (1998). Book: 2.8c.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import apart, inline, kernel, lean
from ...predicates.kernels import insphere
from ..insertion.engine import COUNT, FREE, STAMP
from .cavity import corner, new_slot
from .numbered import number_of_edge
from .opening import (
    FACES_OPEN,
    MAY_GO,
    STAR_CELLS,
    STAR_FIRST,
    STAR_SEEDS,
    STAR_WALLS,
    find_rim,
    sees_face,
    third,
)  # fmt: skip

__all__ = [
    "add_star", "commit_star", "flawed_faces", "in_star", "room_for_star", "search_star", "settle_star",
    "unseen_across",
]  # fmt: skip

LEAST_HEIGHT = (
    2.0**-50
)  # height of a cell with a point that is rounded to a facet; unit: the largest coordinate
MOST_GROWN = 16  # seeds that are added in one search


@apart
def _in_ball(xyz, vertex, t, p):
    """Whether p is strictly inside the sphere of cell t."""
    a, b, c, d = vertex[4 * t], vertex[4 * t + 1], vertex[4 * t + 2], vertex[4 * t + 3]
    sign = insphere(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2], xyz[c, 0], xyz[c, 1], xyz[c, 2],
        xyz[d, 0], xyz[d, 1], xyz[d, 2], xyz[p, 0], xyz[p, 1], xyz[p, 2],
    )  # fmt: skip
    return sign > 0


@lean
def in_star(solid, t):
    """Whether cell t was in the cavity of the last search."""
    return solid.stamp[t] == 2 * solid.state[STAMP]


@apart
def _clear(xyz, vertex, face, p):
    """Whether p is farther from the plane of a face than it is rounded, so that its cell will not be flat."""
    t, k = face & ~3, face & 3
    a, b, c = vertex[t + corner(k, 0)], vertex[t + corner(k, 1)], vertex[t + corner(k, 2)]
    six = square = 0.0
    for j in range(3):
        i, h = (j + 1) % 3, (j + 2) % 3
        normal = (xyz[b, i] - xyz[a, i]) * (xyz[c, h] - xyz[a, h]) - (xyz[b, h] - xyz[a, h]) * (
            xyz[c, i] - xyz[a, i]
        )
        six += normal * (xyz[p, j] - xyz[a, j])
        square += normal * normal
    return abs(six) > LEAST_HEIGHT * np.sqrt(square)


@inline
def unseen_across(solid, t, k, inside):
    """The cell across face k of cell t; -1 where the face is marked or the cell has been looked at."""
    if solid.mark[4 * t + k] >= 0 or solid.across[4 * t + k] < 0:
        return np.int64(-1)
    u = np.int64(solid.across[4 * t + k] >> 2)
    return u if solid.stamp[u] != inside and solid.stamp[u] != inside + 1 else np.int64(-1)


@apart
def search_star(solid, star, edges, p, split):
    """Find the cavity of p from the first cells of ``star``, and judge it; False if there is no star.

    Parameters
    ----------
    solid, star, edges : records
        ``star.cells`` has ``sizes[STAR_SEEDS]`` seeds, which must not be left out, and up to
        ``sizes[STAR_FIRST]`` further cells to begin with; faces may be open.
    p : int
        The vertex, with its coordinates.
    split : int
        The number of the edge that p splits, -1 for none.
    """
    solid.state[STAMP] += 1
    inside, size, head = 2 * solid.state[STAMP], 0, 0
    seeds = star.sizes[STAR_SEEDS]
    for i in range(max(seeds, star.sizes[STAR_FIRST])):  # without those that are there twice
        t = star.cells[i]
        if solid.stamp[t] != inside:
            solid.stamp[t] = inside
            star.cells[size] = t
            size += 1
        if i == seeds - 1:
            star.sizes[STAR_SEEDS] = size
    while head < size:
        t = np.int64(star.cells[head])
        head += 1
        for k in range(4):
            u = unseen_across(solid, t, k, inside)
            if u < 0:
                continue
            if _in_ball(solid.xyz, solid.vertex, u, p):
                star.cells[size] = u
                size += 1
                solid.stamp[u] = inside
            else:
                solid.stamp[u] = inside + 1
    star.sizes[STAR_CELLS] = size
    return settle_star(solid, star, edges, p, split)


@apart
def settle_star(solid, star, edges, p, split):
    """Judge a cavity that has been collected, by exact signs; False if there is no star.

    The cells of ``star``, ``sizes[STAR_CELLS]`` of them, seeds first, have the stamp of the search. For
    ``search_star`` they are those whose spheres contain p; they may be any cells with connected faces.
    """
    grown = 0
    while True:
        face = _see_walls(solid, star, p)
        if face >= 0:
            grown += 1
            if grown > MOST_GROWN or not _pass(solid, star, face):
                return False
            continue
        gone = _keep_all(solid, star, edges, p, split)
        if gone < 0:
            return False
        if gone == 0:
            return find_rim(solid, star, edges, split)


@apart
def _see_walls(solid, star, p):
    """Leave cells out until p sees all walls; list these. A wall of a seed that p does not see, or -1."""
    inside, seeds = 2 * solid.state[STAMP], star.sizes[STAR_SEEDS]
    while True:
        walls, changed = 0, False
        for i in range(star.sizes[STAR_CELLS]):
            t = np.int64(star.cells[i])
            for k in range(4):
                over = solid.across[4 * t + k]
                if over >= 0 and solid.stamp[over >> 2] == inside and solid.mark[4 * t + k] < 0:
                    continue
                face = 4 * t + k
                if (
                    solid.mark[face] <= -2
                    or sees_face(solid, face, p) <= 0
                    or not (star.sizes[FACES_OPEN] == 0 or _clear(solid.xyz, solid.vertex, face, p))
                ):
                    if i < seeds:
                        _compact(solid, star)
                        return face
                    solid.stamp[t] = inside + 1
                    changed = True
                    break
                star.walls[walls] = 4 * t + k
                walls += 1
        if not changed:
            star.sizes[STAR_WALLS] = walls
            return np.int64(-1)
        _compact(solid, star)


@apart
def _pass(solid, star, face):
    """Make the cell beyond a wall a seed; False if the wall is marked."""
    over = np.int64(solid.across[face])
    if solid.mark[face] >= 0 or over < 0:
        return False
    seeds, size = star.sizes[STAR_SEEDS], star.sizes[STAR_CELLS]
    star.cells[size] = star.cells[seeds]
    star.cells[seeds] = over >> 2
    solid.stamp[over >> 2] = 2 * solid.state[STAMP]
    star.sizes[STAR_SEEDS], star.sizes[STAR_CELLS] = seeds + 1, size + 1
    return True


@inline
def _compact(solid, star):
    inside, size = 2 * solid.state[STAMP], 0
    for i in range(star.sizes[STAR_CELLS]):
        if solid.stamp[star.cells[i]] == inside:
            star.cells[size] = star.cells[i]
            size += 1
    star.sizes[STAR_CELLS] = size


@apart
def _keep_all(solid, star, edges, p, split):
    """Leave cells out so that no vertex and no numbered edge is lost; how many, -1 if there is none to go."""
    stamp = solid.state[STAMP]
    for i in range(star.sizes[STAR_WALLS]):
        face = star.walls[i]
        for k in range(4):
            v = solid.vertex[(face & ~3) + k]
            if k != face & 3 and star.met[v] != MAY_GO:
                star.met[v] = stamp
    for i in range(star.sizes[STAR_CELLS]):
        t = np.int64(star.cells[i])
        for k in range(4):
            v = solid.vertex[4 * t + k]
            if star.met[v] != stamp and star.met[v] != MAY_GO:
                return _leave_out(solid, star, p, v, v)
            if edges.degree[v] == 0:
                continue
            for j in range(k):
                u = solid.vertex[4 * t + j]
                number = number_of_edge(edges, u, v)
                if number >= 0 and number != split and _lost(solid, t, u, v):
                    return _leave_out(solid, star, p, u, v)
    return 0


@apart
def _lost(solid, t, u, v):
    """Whether all cells around the edge uv of cell t are in the cavity, with no mark between them."""
    inside, first, w = 2 * solid.state[STAMP], t, -1
    for k in range(4):
        if solid.vertex[4 * t + k] != u and solid.vertex[4 * t + k] != v:
            w = solid.vertex[4 * t + k]
    while True:
        j = 0
        while solid.vertex[4 * t + j] != w:
            j += 1
        out = 4 * t + j
        over = solid.across[out]
        if solid.mark[out] >= 0 or over < 0 or solid.stamp[over >> 2] != inside:
            return False
        w = third(solid, out, u, v)
        t = over >> 2
        if t == first:
            return True


@apart
def _leave_out(solid, star, p, u, v):
    """Leave out the cell at u and v that is farthest from p, but no seed; 1, or -1 if there is none."""
    farthest, chosen = -1.0, -1
    for i in range(star.sizes[STAR_SEEDS], star.sizes[STAR_CELLS]):
        t = star.cells[i]
        with_u = with_v = False
        square = 0.0
        for k in range(4):
            with_u = with_u or solid.vertex[4 * t + k] == u
            with_v = with_v or solid.vertex[4 * t + k] == v
        for j in range(3):
            middle = 0.0
            for k in range(4):
                middle += 0.25 * solid.xyz[solid.vertex[4 * t + k], j]
            square += (middle - solid.xyz[p, j]) ** 2
        if with_u and with_v and square > farthest:
            farthest, chosen = square, t
    if chosen < 0:
        return -1
    solid.stamp[chosen] = 2 * solid.state[STAMP] + 1
    _compact(solid, star)
    return 1


# ---------------------------------------------------------------------- the star


@inline
def _turned(solid, t, k, j):
    """Turn about the common edge of faces k (a wall) and j of t, through the cavity, to the next wall.

    Returns the new cell on it, the place there of the vertex that is not on the edge, and the mark of the
    opened face that was passed; -1 for none, or two, between which the edge stays. Links of walls hold their
    new cells, as -2 - new.
    """
    enter, out, passed = k, j, -1
    link = np.int64(solid.across[4 * t + out])
    while link >= 0:
        if solid.mark[4 * t + out] <= -2:
            passed = -2 - solid.mark[4 * t + out] if passed < 0 else -1
        x = solid.vertex[4 * t + enter]
        t, enter = link >> 2, link & 3
        out = np.int64(0)
        while solid.vertex[4 * t + out] != x:
            out += 1
        link = np.int64(solid.across[4 * t + out])
    return -2 - link, enter, passed


@apart
def commit_star(solid, star, p):
    """Replace the cavity by the star of p; ``fresh[i]`` is the new cell on wall i. There must be room.

    New cells inherit the region of the cells within their walls; opened faces become those at the rim.
    """
    vertex, across, mark, walls = solid.vertex, solid.across, solid.mark, star.sizes[STAR_WALLS]
    for i in range(walls):
        face = np.int64(star.walls[i])
        new = np.int64(new_slot(solid))
        star.fresh[i] = new
        t, k = face >> 2, face & 3
        for j in range(4):
            vertex[4 * new + j] = vertex[4 * t + j]
            across[4 * new + j] = -1
            mark[4 * new + j] = -1
        vertex[4 * new + k] = p
        solid.region[new] = solid.region[t]
        solid.stamp[new] = 0
        over = across[face]
        across[4 * new + k] = over
        mark[4 * new + k] = mark[face]
        if over >= 0:
            across[over] = 4 * new + k
        across[face] = -2 - new
    for i in range(walls):
        face, new = np.int64(star.walls[i]), np.int64(star.fresh[i])
        t, k = face >> 2, face & 3
        for j in range(4):
            solid.at[vertex[4 * new + j]] = new
            if j != k and across[4 * new + j] < 0:
                other, apex, passed = _turned(solid, t, k, np.int64(j))
                across[4 * new + j] = 4 * other + apex
                across[4 * other + apex] = 4 * new + j
                if passed >= 0:
                    mark[4 * new + j] = mark[4 * other + apex] = passed
    for i in range(star.sizes[STAR_CELLS]):
        t = star.cells[i]
        vertex[4 * t] = -2
        solid.free[solid.state[FREE]] = t
        solid.state[FREE] += 1
    star.sizes[FACES_OPEN] = 0


@apart
def add_star(solid, star, v):
    """Let a search begin with the cells at vertex v, too; those behind marked faces excepted."""
    solid.state[STAMP] += 1
    inside, head = 2 * solid.state[STAMP], star.sizes[STAR_FIRST]
    size = head
    star.cells[size] = solid.at[v]
    solid.stamp[solid.at[v]] = inside
    size += 1
    while head < size:
        t = np.int64(star.cells[head])
        head += 1
        for k in range(4):
            over = solid.across[4 * t + k]
            if solid.vertex[4 * t + k] == v or solid.mark[4 * t + k] != -1 or over < 0:
                continue
            if solid.stamp[over >> 2] != inside:
                solid.stamp[over >> 2] = inside
                star.cells[size] = over >> 2
                size += 1
    star.sizes[STAR_FIRST] = size


@kernel
def flawed_faces(solid):
    """How many faces without a mark, between cells inside, are not Delaunay."""
    count = 0
    for t in range(solid.state[COUNT]):
        if solid.vertex[4 * t] < 0 or solid.region[t] < 0:
            continue
        for k in range(4):
            over = solid.across[4 * t + k]
            if over > 4 * t + k and solid.mark[4 * t + k] < 0:
                count += _in_ball(solid.xyz, solid.vertex, t, solid.vertex[over])
    return count


@lean
def room_for_star(solid, star):
    """Whether there are slots for the new cells."""
    return solid.stamp.shape[0] - solid.state[COUNT] + solid.state[FREE] >= star.sizes[STAR_WALLS]
