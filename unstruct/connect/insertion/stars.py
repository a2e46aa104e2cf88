"""The last step of an insertion in space: the cavity is replaced by the star of the new point, compiled.

The star has one tetrahedron on each face of the boundary of the cavity, a *wall*: it joins the wall to the
new point p. Two of them are neighbors if their walls share an edge. Each edge of the boundary is on two
walls, and there are two ways to find them: turn about the edge through the cavity, from wall to wall
(`star3`); or, where the walls are few, number their vertices, and enter each edge into a table, where its
other wall looks it up (`small_star3`, twice as fast). Both make the same tetrahedra in the same slots.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, lean
from .engine import COUNT, FREE

STAR_VERTICES = 64  # on the boundary of a cavity for a small star
MOST_WALLS = 2 * STAR_VERTICES - 4  # so many walls have so many vertices, because the boundary is a sphere
CORNERS_OF_FACE = np.array([1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1])  # the corners of each face, turning alike


class Space(NamedTuple):
    """The triangulation: points, cells, marks of searches for cavities, and the free slots."""

    xyz: NDArray[np.float64]
    vertex: NDArray[np.int32]
    across: NDArray[np.int32]
    mark: NDArray[np.int32]
    free: NDArray[np.int32]
    state: NDArray[np.int64]


class Cavity(NamedTuple):
    """The result of a search for a cavity: its cells, its boundary faces, and the numbers of both."""

    cells: NDArray[np.int32]
    faces: NDArray[np.int32]
    sizes: NDArray[np.int64]


class Ridges(NamedTuple):
    """What `small_star3` notes: which numbers the vertices of walls have, and the edges of walls.

    ``place[v + 1]`` is the number of vertex v if ``names`` has v + 1 there; otherwise v has no number yet,
    so that nothing must be erased for the next star. (There is a vertex -1, at infinity.) ``walls[i]`` has
    the numbers of the three vertices of wall i, and the tetrahedron on it. ``table`` has, for the edge from
    a to b of a wall, at STAR_VERTICES a + b, the face over it of the tetrahedron on that wall.
    """

    place: NDArray[np.int32]
    names: NDArray[np.int32]
    walls: NDArray[np.int32]
    table: NDArray[np.int32]


def ridges(points: int) -> Ridges:
    """The arrays for a triangulation of so many points."""
    return Ridges(
        np.zeros(points + 1, dtype=np.int32),
        np.zeros(STAR_VERTICES + 1, dtype=np.int32),
        np.zeros((MOST_WALLS, 4), dtype=np.int32),
        np.zeros(STAR_VERTICES * STAR_VERTICES, dtype=np.int32),
    )


@inline
def _turn(vertex, across, mark, inside, t, k, j):
    """Turn about the common edge of faces k (a wall) and j of t, through the cavity, to the next wall.

    Returns the wall as 4 u + i, and which vertex of u, other than i, is not on that edge.
    """
    enter, out = k, j
    beyond = np.int64(across[4 * t + out])
    while mark[beyond >> 2] == inside:
        x = vertex[4 * t + enter]
        t, enter = beyond >> 2, beyond & 3
        out = 0
        while vertex[4 * t + out] != x:
            out += 1
        beyond = np.int64(across[4 * t + out])
    return beyond, enter


@inline
def _tetrahedron_on(space, face, p, unused):
    """Make the tetrahedron on a wall: the cell within it, with p for one vertex. Returns its slot."""
    vertex, across, state = space.vertex, space.across, space.state
    if unused > 0:
        new = np.int64(space.free[unused - 1])
    else:
        new = state[COUNT]
        state[COUNT] = new + 1
    t, k = face >> 2, face & 3
    for j in range(4):
        vertex[4 * new + j] = vertex[4 * t + j]
    vertex[4 * new + k] = p
    beyond = across[face]
    across[4 * new + k] = beyond
    across[beyond] = 4 * new + k
    return new


@inline
def _release(space, cavity, unused):
    """The cells of the cavity become free slots."""
    for i in range(cavity.sizes[0]):
        t = np.int64(cavity.cells[i])
        space.vertex[4 * t] = -2  # not in use
        space.free[unused + i] = t
    space.state[FREE] = unused + cavity.sizes[0]


@lean
def star3(space, cavity, p, stamp):
    """Replace the cavity by the tetrahedra that join p to its walls; returns the last of them."""
    vertex, across, mark = space.vertex, space.across, space.mark
    unused = space.state[FREE]
    new = np.int64(0)
    for i in range(cavity.sizes[1]):
        face = np.int64(cavity.faces[i])
        new = _tetrahedron_on(space, face, p, unused)
        unused = max(unused - 1, 0)
        for j in range(1, 4):
            across[4 * new + ((face + j) & 3)] = -1
    for i in range(cavity.sizes[1]):
        face = np.int64(cavity.faces[i])
        t, k = face >> 2, face & 3
        new = np.int64(across[across[face]]) >> 2
        for j in range(4):
            if across[4 * new + j] < 0:
                wall, apex = _turn(vertex, across, mark, 2 * stamp, t, k, j)
                other = 4 * (np.int64(across[wall]) >> 2) + apex
                across[4 * new + j] = other
                across[other] = 4 * new + j
    _release(space, cavity, unused)
    return new


@lean
def small_star3(space, cavity, ridges, p):
    """`star3`, if there are at most MOST_WALLS walls."""
    vertex, across, faces = space.vertex, space.across, cavity.faces
    place, names, walls, table = ridges
    new, unused, known = np.int64(0), space.state[FREE], 0
    for i in range(cavity.sizes[1]):
        face = np.int64(faces[i])
        t, k = face >> 2, face & 3
        new = _tetrahedron_on(space, face, p, unused)
        unused = max(unused - 1, 0)
        for j in range(3):  # without branches, which the processor could not foresee
            v = vertex[4 * t + CORNERS_OF_FACE[3 * k + j]] + 1
            number = np.int64(place[v])
            old = (number < known) & (names[number] == v)
            number = number if old else known
            names[known], place[v], walls[i, j] = v, number, number
            known += not old
        walls[i, 3] = new
        a, b, c = np.int64(walls[i, 0]), np.int64(walls[i, 1]), np.int64(walls[i, 2])
        table[STAR_VERTICES * b + c] = 4 * new + CORNERS_OF_FACE[3 * k]
        table[STAR_VERTICES * c + a] = 4 * new + CORNERS_OF_FACE[3 * k + 1]
        table[STAR_VERTICES * a + b] = 4 * new + CORNERS_OF_FACE[3 * k + 2]
    for i in range(cavity.sizes[1]):  # the neighbor has the edge in the other sense
        k, t = np.int64(faces[i]) & 3, np.int64(walls[i, 3])
        a, b, c = np.int64(walls[i, 0]), np.int64(walls[i, 1]), np.int64(walls[i, 2])
        across[4 * t + CORNERS_OF_FACE[3 * k]] = table[STAR_VERTICES * c + b]
        across[4 * t + CORNERS_OF_FACE[3 * k + 1]] = table[STAR_VERTICES * a + c]
        across[4 * t + CORNERS_OF_FACE[3 * k + 2]] = table[STAR_VERTICES * b + a]
    _release(space, cavity, unused)
    return new
