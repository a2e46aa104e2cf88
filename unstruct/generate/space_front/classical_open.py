"""The front in space as a set of oriented triangles with what is not meshed on their positive side, compiled.

A triangle abc is at the front if what is ahead of it, where orient(a, b, c, x) > 0, is not meshed. An inner
facet is at the front twice, once for each side. The triangles and the vertices at the front are in two
digital trees; so are inner segments that are no edges of triangles. A loose vertex, inside and on no
triangle, is at the front until a cell reaches it. A cell abcd on the face abc changes the front by a
symmetric difference:

            d            abc leaves. bad leaves if it is at the front (what is not meshed is on its positive
           /|\\           side, and that is the cell); otherwise abd enters, and what is beyond it is not
          / | \\          meshed. In the same way cbd leaves or bcd enters, and acd leaves or cad enters.
         a--|--c
          \\ | /
            b
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import inline, kernel, lean
from ...connect.insertion.engine import grown
from ..advancing.digital_tree import DigitalTree, larger_tree, new_tree, plant, planted, pull
from ..advancing.rows import (
    ALIVE,
    CELLS_MADE,
    FREE_ROW,
    FRONT_STATE,
    VERTEX_COUNT,
    drop_row,
    larger_counts,
    new_row,
    put_in_chain,
)

__all__ = [
    "SpaceFront",
    "close_cell",
    "enter_loose",
    "face_row",
    "has_space",
    "larger_space_front",
    "new_space_front",
]  # fmt: skip


class SpaceFront(NamedTuple):
    """The arrays of a front."""

    xyz: NDArray[np.float64]  # the vertices, |coordinates| <= 1
    corner: NDArray[np.int32]  # (., 3) the faces; -1 where a row is free
    region: NDArray[np.int32]  # the region ahead
    stamp: NDArray[np.int64]  # the number of the face in the order in which faces came; no two are the same
    level: NDArray[np.int8]  # how often it was put aside
    refused: NDArray[np.int32]  # vertices with lower numbers have no valid cell with the face
    chain: NDArray[np.int32]  # the next row with the same lowest vertex, or the next free row
    first: NDArray[np.int32]  # for each vertex the first row of which it is the lowest, -1 for none
    around: NDArray[np.int32]  # for each vertex how many faces of the front it has
    loose: NDArray[np.bool_]  # whether a vertex is at the front without a face
    faces: DigitalTree
    vertices: DigitalTree
    threads: DigitalTree  # inner segments that are no edges of triangles
    ends: NDArray[np.int32]  # (., 2) of these
    state: NDArray[np.int64]
    made: NDArray[np.int32]  # (., 5) the cells in the order in which they were made, and their regions
    cell: NDArray[np.int64]  # (4,) the cell that is looked at
    corners: NDArray[np.float64]  # (4, 3) scratch


def new_space_front(
    xyz: NDArray[np.float64],
    faces: NDArray[np.integer],
    region: NDArray[np.integer],
    loose: NDArray[np.integer],
    threads: NDArray[np.integer],
) -> SpaceFront:
    """The front at the beginning.

    Parameters
    ----------
    xyz : (n, 3) float64
        The vertices, |coordinates| <= 1.
    faces : (m, 3)
        What is not meshed is on the positive side of each.
    region : (m,)
        The region there.
    loose : (k,)
        Vertices inside that are on no face.
    threads : (s, 2)
        Inner segments that are no edges of faces.
    """
    n, rows = len(xyz), 3 * len(faces) + 64
    capacity = 2 * n + 64
    places = np.zeros((capacity, 3))
    places[:n] = xyz
    state = np.zeros(FRONT_STATE, dtype=np.int64)
    state[FREE_ROW], state[VERTEX_COUNT] = -1, n
    front = SpaceFront(
        places, np.full((rows, 3), -1, dtype=np.int32), np.zeros(rows, dtype=np.int32),
        np.full(rows, -1, dtype=np.int64), np.zeros(rows, dtype=np.int8),
        np.zeros(rows, dtype=np.int32), np.full(rows, -1, dtype=np.int32),
        np.full(capacity, -1, dtype=np.int32), np.zeros(capacity, dtype=np.int32),
        np.zeros(capacity, dtype=bool), new_tree(rows, 3), new_tree(capacity, 3),
        new_tree(len(threads) + 1, 3), np.array(threads, dtype=np.int32).reshape(-1, 2), state,
        np.empty((8 * len(faces) + 64, 5), dtype=np.int32), np.zeros(4, dtype=np.int64), np.zeros((4, 3)),
    )  # fmt: skip
    _enter_all(
        front,
        np.array(faces, dtype=np.int64).reshape(-1, 3),
        np.array(region, dtype=np.int64),
        np.array(loose, dtype=np.int64),
    )
    return front


def larger_space_front(front: SpaceFront) -> SpaceFront:
    """The same front with half as much room again, wherever little is left."""
    rows, n, made = larger_counts(front.state, len(front.corner), len(front.xyz), len(front.made))

    def more(array: NDArray, count: int, empty: int) -> NDArray:
        result = np.full((count, *array.shape[1:]), empty, dtype=array.dtype)
        result[: len(array)] = array
        return result

    return front._replace(
        xyz=grown(front.xyz, n), corner=more(front.corner, rows, -1),
        region=more(front.region, rows, 0),
        stamp=more(front.stamp, rows, -1), level=more(front.level, rows, 0),
        refused=more(front.refused, rows, 0),
        chain=more(front.chain, rows, -1), first=more(front.first, n, -1), around=more(front.around, n, 0),
        loose=more(front.loose, n, 0), made=grown(front.made, made),
        faces=larger_tree(front.faces, rows) if rows > len(front.corner) else front.faces,
        vertices=larger_tree(front.vertices, n) if n > len(front.xyz) else front.vertices,
    )  # fmt: skip


@kernel
def _enter_all(front, faces, region, loose):
    """Put faces, loose vertices and segments into an empty front."""
    for i in range(faces.shape[0]):
        enter_face(front, faces[i, 0], faces[i, 1], faces[i, 2], region[i])
    for i in range(loose.shape[0]):
        enter_loose(front, loose[i])
    xyz = front.xyz
    for i in range(front.ends.shape[0]):
        a, b, half = front.ends[i, 0], front.ends[i, 1], 0.0
        for k in range(3):
            half = max(half, 0.5 * abs(xyz[a, k] - xyz[b, k]))
        x, y, z = xyz[a, 0] + xyz[b, 0], xyz[a, 1] + xyz[b, 1], xyz[a, 2] + xyz[b, 2]
        plant(front.threads, i, (0.5 * x, 0.5 * y, 0.5 * z), half)


@inline
def has_space(front):
    """Whether one more step fits: three faces, a vertex, a cell."""
    state = front.state
    return (
        state[ALIVE] + 8 < len(front.corner)
        and state[VERTEX_COUNT] + 4 < len(front.first)
        and state[CELLS_MADE] + 2 < len(front.made)
    )


@lean
def enter_loose(front, v):
    """Put vertex v, which has no face at the front, into the front."""
    front.loose[v] = True
    plant(front.vertices, v, (front.xyz[v, 0], front.xyz[v, 1], front.xyz[v, 2]), 0.0)


@inline
def lowest_first(a, b, c):
    """The same oriented triangle with its lowest vertex first."""
    if b < a and b < c:
        return b, c, a
    if c < a and c < b:
        return c, a, b
    return a, b, c


@lean
def enter_face(front, a, b, c, region):
    """Put the face abc into the front, with its lowest vertex first; return its row."""
    xyz, row = front.xyz, new_row(front)
    a, b, c = lowest_first(a, b, c)
    front.corner[row, 0], front.corner[row, 1], front.corner[row, 2] = a, b, c
    front.region[row], front.level[row], front.refused[row] = region, 0, 0
    for k in range(3):
        v = np.int64(front.corner[row, k])
        front.loose[v] = False
        front.around[v] += 1
        if not planted(front.vertices, v):
            plant(front.vertices, v, (xyz[v, 0], xyz[v, 1], xyz[v, 2]), 0.0)
    put_in_chain(front, row, a)
    half = 0.0
    for k in range(3):
        least, most = min(xyz[a, k], xyz[b, k], xyz[c, k]), max(xyz[a, k], xyz[b, k], xyz[c, k])
        front.corners[0, k] = 0.5 * (least + most)
        half = max(half, 0.5 * (most - least))
    plant(front.faces, row, (front.corners[0, 0], front.corners[0, 1], front.corners[0, 2]), half)
    return row


@lean
def leave_face(front, row):
    """Take a face out of the front, and its vertices that have no other face there."""
    drop_row(front, row, np.int64(front.corner[row, 0]))
    for k in range(3):
        v = np.int64(front.corner[row, k])
        front.around[v] -= 1
        if front.around[v] == 0:
            pull(front.vertices, v)
        front.corner[row, k] = -1
    pull(front.faces, row)


@lean
def face_row(front, a, b, c):
    """The row of the oriented face abc, -1 if it is not at the front."""
    low, y, z = lowest_first(a, b, c)
    row = np.int64(front.first[low])
    while row >= 0 and not (front.corner[row, 1] == y and front.corner[row, 2] == z):
        row = np.int64(front.chain[row])
    return row


@lean
def close_cell(front, row, d):
    """Make the cell of the face in ``row`` and vertex d; return the three rows that entered, or -1."""
    a, b, c = np.int64(front.corner[row, 0]), np.int64(front.corner[row, 1]), np.int64(front.corner[row, 2])
    region, k = front.region[row], front.state[CELLS_MADE]
    made = front.made
    made[k, 0], made[k, 1], made[k, 2], made[k, 3], made[k, 4] = a, b, c, d, region
    front.state[CELLS_MADE] += 1
    one, two, three = face_row(front, b, a, d), face_row(front, c, b, d), face_row(front, a, c, d)
    # Faces enter before others leave, so that vertices that stay at the front are not taken out in between.
    over = enter_face(front, a, b, d, region) if one < 0 else np.int64(-1)
    next_over = enter_face(front, b, c, d, region) if two < 0 else np.int64(-1)
    last_over = enter_face(front, c, a, d, region) if three < 0 else np.int64(-1)
    leave_face(front, row)
    if one >= 0:
        leave_face(front, one)
    if two >= 0:
        leave_face(front, two)
    if three >= 0:
        leave_face(front, three)
    return over, next_over, last_over
