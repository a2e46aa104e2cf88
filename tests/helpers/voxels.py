"""Surfaces of unit cubes of a lattice, in triangles."""

from __future__ import annotations

import numpy as np


def voxels(cells: set[tuple[int, int, int]]) -> tuple[np.ndarray, list[list[int]]]:
    """The surface of some unit cubes, in triangles: needles of no use."""
    number: dict[tuple[int, ...], int] = {}
    rows = []
    for cell in sorted(cells):
        for axis in range(3):
            for end in (0, 1):
                beyond = list(cell)
                beyond[axis] += 2 * end - 1
                if tuple(beyond) in cells:
                    continue
                ring = []
                for one, two in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    x = list(cell)
                    x[axis] += end
                    x[(axis + 1) % 3] += one
                    x[(axis + 2) % 3] += two
                    ring.append(number.setdefault(tuple(x), len(number)))
                a, b, c, d = ring if end else ring[::-1]
                rows += [[a, b, c], [a, c, d]] if (cell[0] + end) % 2 else [[a, b, d], [b, c, d]]
    return np.array(list(number), dtype=float), rows
