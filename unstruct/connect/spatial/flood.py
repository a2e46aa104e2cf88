"""What is inside: parts of the complex between marked faces, and how many facets lie around each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import kernel
from ..insertion.engine import COUNT

__all__ = ["INWARD", "flood_parts", "is_flat", "number_inside", "write_inside"]

FLAT_SHARE = (
    1e-7  # of the cube of the longest edge: six volumes of a cell whose center is as good as on its faces
)

# The vertices of the faces of a cell, opposite its vertices in order, seen from within.
INWARD = np.array([[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]])


@kernel
def flood_parts(solid, stack, facet, parity, there):
    """Number the parts that marked faces separate; returns how many there are, and how many faces disagree.

    ``region`` becomes the part of each cell; part 0 touches the hull. ``parity[part]`` is 1 if an odd number
    of facets (``facet[number]`` of the face) lies between the part and the hull. A face disagrees if the
    parities on its two sides do not fit; then some facets are not there. ``there`` gets the numbers of marked
    faces.
    """
    vertex, across, mark, region = solid.vertex, solid.across, solid.mark, solid.region
    slots, parts = solid.state[COUNT], 0
    first = 0
    for t in range(slots):
        region[t] = -1
        if (
            vertex[4 * t] >= 0
            and min(across[4 * t], across[4 * t + 1], across[4 * t + 2], across[4 * t + 3]) < 0
        ):
            first = t
    # stack: cells of the present part from below, faces that lead to other parts from above
    cells, doors = 1, stack.shape[0]
    stack[0], region[first], parity[0] = first, 0, 0
    while True:
        while cells > 0:
            cells -= 1
            t = stack[cells]
            for k in range(4):
                over = across[4 * t + k]
                if over < 0 or region[over >> 2] >= 0:
                    continue
                if mark[4 * t + k] >= 0:
                    doors -= 1
                    stack[doors] = 4 * t + k
                else:
                    region[over >> 2] = parts
                    stack[cells] = over >> 2
                    cells += 1
        while doors < stack.shape[0] and region[across[stack[doors]] >> 2] >= 0:
            doors += 1
        if doors == stack.shape[0]:
            break
        face = stack[doors]
        parts += 1
        parity[parts] = parity[region[face >> 2]] ^ facet[mark[face]]
        stack[0], region[across[face] >> 2] = across[face] >> 2, parts
        cells = 1
    wrong = 0
    for face in range(4 * slots):
        if vertex[face & ~3] >= 0 and mark[face] >= 0 and across[face] > face:
            differ = parity[region[face >> 2]] ^ parity[region[across[face] >> 2]]
            there[mark[face]] = True
            wrong += differ != facet[mark[face]]
    return parts + 1, wrong


@kernel
def number_inside(solid, number, place):
    """Number the cells that have a region, and their vertices, both in order; others must have -1.

    Returns how many cells there are, and how many faces `write_inside` writes.
    """
    vertex, across, mark, region = solid.vertex, solid.across, solid.mark, solid.region
    cells = vertices = faces = 0
    for t in range(solid.state[COUNT]):
        if vertex[4 * t] >= 0 and region[t] >= 0:
            number[t] = cells
            cells += 1
            for k in range(4):
                place[vertex[4 * t + k]] = 0
    for v in range(place.shape[0]):
        if place[v] == 0:
            place[v] = vertices
            vertices += 1
    for t in range(solid.state[COUNT]):
        if number[t] >= 0:
            for k in range(4):
                over = across[4 * t + k]
                beyond = number[over >> 2] if over >= 0 else -1
                faces += mark[4 * t + k] >= 0 and (beyond < 0 or beyond > number[t])
    return cells, faces


@kernel
def write_inside(solid, number, place, order, cells, faces):
    """Write cells, their neighbors and regions; marked faces, once each, and their marks.

    ``order[k]`` are the places of the vertices of a face opposite vertex k, as they are seen from its cell.
    """
    vertex, across, mark = solid.vertex, solid.across, solid.mark
    simplices, neighbors, region = cells
    corners, marks = faces
    size = 0
    for t in range(solid.state[COUNT]):
        i = number[t]
        if i < 0:
            continue
        region[i] = solid.region[t]
        for k in range(4):
            over = across[4 * t + k]
            beyond = number[over >> 2] if over >= 0 else -1
            simplices[i, k] = place[vertex[4 * t + k]]
            neighbors[i, k] = beyond
            if mark[4 * t + k] >= 0 and (beyond < 0 or beyond > i):
                for j in range(3):
                    corners[size, j] = place[vertex[4 * t + order[k, j]]]
                marks[size] = mark[4 * t + k]
                size += 1


def is_flat(corners: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether cells, by their corners (m, 4, 3), are so flat that their centers are no safe places inside."""
    u, v, w = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    six = np.abs((np.cross(u, v) * w).sum(axis=1))
    pairs = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
    longest = np.max([((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i, j in pairs], axis=0)
    return six <= FLAT_SHARE * longest * np.sqrt(longest)
