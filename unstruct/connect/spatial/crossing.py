"""What is in the way of a segment or a triangle: the faces that meet it, and how it crosses the cells.

The cells that an open segment meets hang together through faces that it meets. A triangle whose edges are
edges of the complex is a face of it exactly when no edge crosses it; the cells that it crosses hang together
through faces with such edges.
"""

from __future__ import annotations

from ...base.jit import apart, inline
from ..insertion.engine import STAMP
from .costs import EDGE
from .signs import DISJOINT, INSIDE, ON_EDGE, meets

__all__ = ["cells_around", "classify", "crossings", "mark_face", "ring", "star"]


@apart
def cells_around(solid, face, j, cells, room):
    """Write the cells around the edge of a face that lacks vertex j of its cell; -1 if more than ``room``.

    Also -1 if the edge is on the hull.
    """
    t, out, count = face >> 2, face & 3, 0
    first, x = t, solid.vertex[4 * (face >> 2) + j]  # the vertex of the face that is passed, beside the edge
    while count < room:
        cells[count] = t
        count += 1
        over = solid.across[4 * t + out]
        if over < 0:
            return -1
        t = over >> 2
        if t == first:
            return count
        out = 0
        while solid.vertex[4 * t + out] != x:
            out += 1
        x = solid.vertex[over]
    return -1


@inline
def _has(vertex, t, v):
    return vertex[4 * t] == v or vertex[4 * t + 1] == v or vertex[4 * t + 2] == v or vertex[4 * t + 3] == v


@apart
def star(solid, found, a):
    """Write the cells with vertex a to ``found.cells``, stamped; return how many."""
    solid.state[STAMP] += 1
    stamp, size, head = 2 * solid.state[STAMP], 0, 0
    if solid.at[a] >= 0:
        found.cells[0], size = solid.at[a], 1
        solid.stamp[solid.at[a]] = stamp
    while head < size:
        t = found.cells[head]
        head += 1
        for k in range(4):
            over = solid.across[4 * t + k]
            if over >= 0 and solid.vertex[4 * t + k] != a and solid.stamp[over >> 2] != stamp:
                found.cells[size] = over >> 2
                size += 1
                solid.stamp[over >> 2] = stamp
    return size


@apart
def ring(solid, found, a, b):
    """Write the cells with the edge ab to ``found.cells``; return how many."""
    size, kept = star(solid, found, a), 0
    for i in range(size):
        if _has(solid.vertex, found.cells[i], b):
            found.cells[kept] = found.cells[i]
            kept += 1
    return kept


@apart
def _in_the_way(solid, kind, goal, face):
    """Whether a face, given as 4 t + k, meets the segment, or has an edge that crosses the triangle."""
    t, k = face & ~3, face & 3
    u, v, w = solid.vertex[t + (k + 1 & 3)], solid.vertex[t + (k + 2 & 3)], solid.vertex[t + (k + 3 & 3)]
    if kind == EDGE:
        return meets(solid.xyz, goal[0], goal[1], u, v, w) != DISJOINT
    return (
        meets(solid.xyz, u, v, goal[0], goal[1], goal[2]) != DISJOINT
        or meets(solid.xyz, v, w, goal[0], goal[1], goal[2]) != DISJOINT
        or meets(solid.xyz, w, u, goal[0], goal[1], goal[2]) != DISJOINT
    )


@apart
def _entrance(solid, kind, goal, found):
    """A cell at goal[0] whose opposite face is in the way; -1 if the goal is there, -2 for no cell."""
    size = star(solid, found, goal[0])
    for i in range(size):
        t = found.cells[i]
        if _has(solid.vertex, t, goal[1]) and (kind == EDGE or _has(solid.vertex, t, goal[2])):
            return -1
    for i in range(size):
        t = found.cells[i]
        k = 0
        while solid.vertex[4 * t + k] != goal[0]:
            k += 1
        if _in_the_way(solid, kind, goal, 4 * t + k):
            return t
    return -2


@apart
def crossings(solid, kind, goal, found):
    """Write the faces in the way of the goal to ``found.faces``, the cells beside them to ``found.cells``.

    Returns how many faces there are: 0 if the goal is there, -1 if no way leads to it.
    """
    first = _entrance(solid, kind, goal, found)
    if first < 0:
        return first + 1
    solid.state[STAMP] += 1
    stamp, size, head, faces = 2 * solid.state[STAMP], 1, 0, 0
    found.cells[0] = first
    solid.stamp[first] = stamp
    while head < size:
        t = found.cells[head]
        head += 1
        for k in range(4):
            over = solid.across[4 * t + k]
            if over < 0:
                continue
            seen = solid.stamp[over >> 2] == stamp
            if (seen and over < 4 * t + k) or not _in_the_way(solid, kind, goal, 4 * t + k):
                continue
            if over > 4 * t + k:  # each face once
                found.faces[faces] = 4 * t + k
                faces += 1
            if not seen:
                found.cells[size] = over >> 2
                size += 1
                solid.stamp[over >> 2] = stamp
    found.sizes[0] = size
    return faces


@apart
def classify(solid, goal, found, cells, counts):
    """Count how the segment crosses these cells: vertex-face, edge-edge, edge-face, face-face."""
    for i in range(cells):
        t = found.cells[i]
        ends = _has(solid.vertex, t, goal[0]) + _has(solid.vertex, t, goal[1])
        faces = edges = 0
        for k in range(4):
            u, v, w = solid.vertex[4 * t + (k + 1) % 4], solid.vertex[4 * t + (k + 2) % 4], 0
            w = solid.vertex[4 * t + (k + 3) % 4]
            how = meets(solid.xyz, goal[0], goal[1], u, v, w)
            faces += how == INSIDE
            edges += how == ON_EDGE
        edges //= 2  # each edge is on two faces
        if ends == 1 and faces == 1:
            counts[0] += 1
        elif ends == 0 and edges == 2:
            counts[1] += 1
        elif ends == 0 and edges == 1 and faces == 1:
            counts[2] += 1
        elif ends == 0 and faces == 2:
            counts[3] += 1


@apart
def mark_face(solid, found, goal, number):
    """Mark the face with these vertices on both sides; False if it is not there."""
    size = star(solid, found, goal[0])
    for i in range(size):
        t = found.cells[i]
        if _has(solid.vertex, t, goal[1]) and _has(solid.vertex, t, goal[2]):
            k = 0
            while (
                solid.vertex[4 * t + k] == goal[0]
                or solid.vertex[4 * t + k] == goal[1]
                or solid.vertex[4 * t + k] == goal[2]
            ):
                k += 1
            solid.mark[4 * t + k] = number
            over = solid.across[4 * t + k]
            if over >= 0:
                solid.mark[over] = number
            return True
    return False
