"""What the insertion of a star works with: its record, walks between marked faces, and faces that are opened.

See `connect.spatial.star`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, inline, lean
from ..insertion.engine import STAMP
from .cavity import corner, draw
from .numbered import number_of_edge
from .signs import side

__all__ = [
    "FACES_OPEN",
    "MAY_GO",
    "OPEN_ROOM",
    "RIM_EDGES",
    "STAR_CELLS",
    "STAR_FIRST",
    "STAR_SEEDS",
    "STAR_WALLS",
    "Star",
    "close_faces",
    "find_rim",
    "new_star",
    "next_face",
    "open_face",
    "sees_face",
    "third",
    "walk_within",
]

OPEN_ROOM = 256  # faces that one point may open
MAY_GO = 2**31 - 1  # entry of ``met`` of a vertex that a star may take away
FAR_WALK = 500  # steps of a walk: cells that are Delaunay need few; among flat ones it may go in circles
# Entries of ``sizes``.
STAR_CELLS, STAR_WALLS, STAR_SEEDS, FACES_OPEN, RIM_EDGES = 0, 1, 2, 3, 4
STAR_FIRST = 5  # cells from which the search begins: the seeds, and after them others that may be left out


class Star(NamedTuple):
    """A cavity and its star: cells, walls, new cells on the walls, opened faces and their rim.

    ``met`` is the stamp of the last search in which each vertex was on a wall, or `MAY_GO`. A row of ``rim``
    has the two ends of an edge and the mark of the faces that are made there.
    """

    cells: NDArray[np.int32]
    walls: NDArray[np.int32]
    fresh: NDArray[np.int32]
    met: NDArray[np.int32]
    opened: NDArray[np.int32]
    rim: NDArray[np.int32]
    sizes: NDArray[np.int64]


def new_star(slots: int, vertices: int) -> Star:
    """Room for a search through this many cells."""
    return Star(
        np.empty(slots + 8, dtype=np.int32), np.empty(4 * slots + 32, dtype=np.int32),
        np.empty(4 * slots + 32, dtype=np.int32), np.zeros(vertices, dtype=np.int32),
        np.empty(OPEN_ROOM, dtype=np.int32), np.empty((3 * OPEN_ROOM, 3), dtype=np.int32),
        np.zeros(8, dtype=np.int64),
    )  # fmt: skip


@inline
def sees_face(solid, face, p):
    """The side of a face on which p is: 1 on that of its cell."""
    t, k = face & ~3, face & 3
    return side(
        solid.xyz,
        solid.vertex[t + corner(k, 0)],
        solid.vertex[t + corner(k, 1)],
        solid.vertex[t + corner(k, 2)],
        p,
    )


@apart
def walk_within(solid, t, p):
    """A cell that contains p, from cell t without passing marked faces; -1 - face if such a face is passed.

    The face is the last one that was in the way; it may be unmarked if the walk is too long.
    """
    face = 4 * t
    for _ in range(FAR_WALK):
        first, blocked, moved = draw(solid.state, 4), -1, False
        for i in range(4):
            face = 4 * t + ((first + i) & 3)
            if sees_face(solid, face, p) < 0:
                if solid.mark[face] >= 0 or solid.across[face] < 0:
                    blocked = face
                else:
                    t = solid.across[face] >> 2
                    moved = True
                    break
        if not moved:
            return t if blocked < 0 else -1 - blocked
    return -1 - face


# ---------------------------------------------------------------------- faces of facets


@inline
def third(solid, face, a, b):
    """The vertex of a face that is neither a nor b."""
    t, k = face & ~3, face & 3
    for i in range(4):
        v = solid.vertex[t + i]
        if i != k and v != a and v != b:
            return v
    return -1


@apart
def next_face(solid, face, a, b):
    """The next marked face at the edge ab of a face, through the cell of that; -1 if there is no other.

    The answer is the face of the cell in which the turn about the edge ends.
    """
    first, t, w = face, face >> 2, third(solid, face, a, b)
    while True:
        j = 0
        while solid.vertex[4 * t + j] != w:
            j += 1
        out = 4 * t + j
        if solid.mark[out] != -1:
            return out
        over = solid.across[out]
        if over < 0:
            return -1
        t = over >> 2
        w = third(solid, out, a, b)
        # the face through which the turn goes on is opposite the vertex that both cells have beside a, b
        if t == first >> 2:
            return -1


@lean
def open_face(solid, star, face):
    """Open a marked face on both sides; False if there is no room."""
    count = star.sizes[FACES_OPEN]
    if count == OPEN_ROOM:
        return False
    number = -2 - solid.mark[face]
    solid.mark[face] = number
    if solid.across[face] >= 0:
        solid.mark[solid.across[face]] = number
    star.opened[count] = face
    star.sizes[FACES_OPEN] = count + 1
    return True


@lean
def close_faces(solid, star):
    """Mark all opened faces again."""
    for i in range(star.sizes[FACES_OPEN]):
        close_face(solid, star.opened[i])
    star.sizes[FACES_OPEN] = 0


@inline
def close_face(solid, face):
    if solid.mark[face] <= -2:
        number = -2 - solid.mark[face]
        solid.mark[face] = number
        if solid.across[face] >= 0:
            solid.mark[solid.across[face]] = number


@apart
def find_rim(solid, star, edges, split):
    """Close faces whose cells are no longer in the cavity, and list the rim of the others.

    False if a vertex of these is not on the rim, or if two facets would have the same new face.
    """
    inside, rim, left = 2 * solid.state[STAMP], 0, 0
    for i in range(star.sizes[FACES_OPEN]):
        face = star.opened[i]
        if solid.stamp[face >> 2] != inside:
            close_face(solid, face)
            continue
        star.opened[left] = face
        left += 1
    star.sizes[FACES_OPEN] = left
    for i in range(left):
        face = star.opened[i]
        t, k = face & ~3, face & 3
        for j in range(3):
            a, b = solid.vertex[t + corner(k, j)], solid.vertex[t + corner(k, (j + 1) % 3)]
            if split >= 0 and number_of_edge(edges, a, b) == split:
                continue
            number, h = -2 - solid.mark[face], _in_rim(star, rim, a, b)
            if h == rim:
                star.rim[rim, 0], star.rim[rim, 1], star.rim[rim, 2] = a, b, number
                rim += 1
                continue
            if star.rim[h, 2] != number:
                return False
            rim -= 1
            for m in range(3):
                star.rim[h, m] = star.rim[rim, m]
    star.sizes[RIM_EDGES] = rim
    return _all_on_rim(solid, star)


@inline
def _in_rim(star, rim, a, b):
    """The row of the rim that has the edge ab; the number of rows if there is none."""
    h = 0
    while h < rim and not (
        (star.rim[h, 0] == a and star.rim[h, 1] == b) or (star.rim[h, 0] == b and star.rim[h, 1] == a)
    ):
        h += 1
    return h


@apart
def _all_on_rim(solid, star):
    for i in range(star.sizes[FACES_OPEN]):
        face = star.opened[i]
        for j in range(4):
            if j == face & 3:
                continue
            v, h = solid.vertex[(face & ~3) + j], 0
            while h < star.sizes[RIM_EDGES] and star.rim[h, 0] != v and star.rim[h, 1] != v:
                h += 1
            if h == star.sizes[RIM_EDGES]:
                return False
    return True
