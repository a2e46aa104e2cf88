"""Gift wrapping in NumPy, for any dimension and for coordinates that cannot be scaled exactly.

The algorithm is that of the kernels. Floating point proposes an apex; exact signs decide among all points
that may be inside its sphere.
"""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from ...predicates.batch import in_sphere, orient
from .start import suspects

__all__ = ["wrap_general"]


def wrap_general(
    points: NDArray[np.float64], rank: NDArray[np.int64], first: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Cells in the order of their creation, the given first one included, and neighbors; O(n) per face."""
    d = points.shape[1]
    cells, neighbors = [first], [[-1] * (d + 1)]
    faces: dict[frozenset[int], tuple[int, int]] = {}  # open half-faces by their vertices
    queue = deque((0, (d + i) % (d + 1)) for i in range(d + 1))
    for _, k in queue:
        faces[frozenset(np.delete(first, k).tolist())] = (0, k)
    while queue:
        c, k = queue.popleft()
        key = frozenset(np.delete(cells[c], k).tolist())
        if faces.get(key) != (c, k):
            continue
        row = cells[c].copy()
        i, j = (k + 1) % (d + 1), (k + 2) % (d + 1)
        row[[i, j]] = row[[j, i]]  # seen from the free side
        q = find_apex(points, rank, row, k)
        if q < 0:
            del faces[key]
            continue
        row[k] = q
        new = len(cells)
        cells.append(row)
        neighbors.append([-1] * (d + 1))
        for j in range(d + 1):
            key = frozenset(np.delete(row, j).tolist())
            if key in faces:
                other, i = faces.pop(key)
                neighbors[new][j], neighbors[other][i] = other, new
            else:
                faces[key] = (new, j)
                queue.append((new, j))
    return np.array(cells), np.array(neighbors)


def find_apex(points: NDArray[np.float64], rank: NDArray[np.int64], row: NDArray[np.int64], k: int) -> int:
    """The vertex for slot k of the row, or -1 if no vertex is on the free side.

    On entry the slot contains a vertex behind the face.
    """
    row = row.copy()
    free = on_free_side(points, row, k)
    if len(free) == 0:
        return -1
    best = propose(points, row, k, free)
    row[k] = best
    for q in np.intersect1d(suspects(points, row), free).tolist():
        sign = in_sphere(points[row], points[q])
        if sign > 0 or (sign == 0 and tie(points, rank, row, q) > 0):
            row[k] = q
    return int(row[k])


def on_free_side(points: NDArray[np.float64], row: NDArray[np.int64], k: int) -> NDArray[np.int64]:
    """The vertices on the free side of the face; exact signs decide where floating point is not certain."""
    face = np.delete(row, k)
    with np.errstate(all="ignore"):
        edges = points[face[1:]] - points[face[0]]
        away = points - points[face[0]]
        unsure = np.ones(len(points), dtype=bool)
        positive = np.zeros(len(points), dtype=bool)
        if np.isfinite(edges).all():
            _, s, v = np.linalg.svd(edges)
            height = away @ v[-1]
            if s[-1] > 1e-6 * s[0] and s[-1] > 1e-140:  # the normal is right to about 1e-9
                reference = height[row[k]]
                unsure = ~(np.abs(height) > 1e-7 * np.abs(away).max(axis=1) + 1e-300)
                positive = (height > 0) != (reference > 0)
                if unsure[row[k]]:  # the vertex behind the face is so near that its side is not certain
                    unsure[:] = True
    unsure[row] = False
    unsure[face] = False
    ask = np.flatnonzero(unsure)
    if len(ask):
        corners = np.repeat(points[row][None], len(ask), axis=0)
        corners[:, k] = points[ask]
        positive[ask] = np.asarray(orient(corners)) > 0
    positive[row] = False
    return np.flatnonzero(positive)


def propose(points: NDArray[np.float64], row: NDArray[np.int64], k: int, free: NDArray[np.int64]) -> int:
    """The free vertex with the smallest offset of the circumcenter, computed in floating point."""
    face = np.delete(row, k)
    with np.errstate(all="ignore"):
        edges = points[face[1:]] - points[face[0]]
        solution = np.linalg.lstsq(edges, (edges**2).sum(axis=1) / 2, rcond=None)[0] if len(edges) else 0.0
        away = points[free] - points[face[0]] - solution
        _, _, v = np.linalg.svd(edges)
        height = np.abs(away @ v[-1])
        offset = ((away**2).sum(axis=1) - np.sum(solution**2)) / height
    offset[~np.isfinite(offset)] = np.inf
    return int(free[np.argmin(offset)])


def tie(points: NDArray[np.float64], rank: NDArray[np.int64], row: NDArray[np.int64], q: int) -> int:
    """Like `apex.tie`: the in-sphere sign after the infinitesimal lift."""
    for v in sorted([*row.tolist(), q], key=lambda v: -rank[v]):
        if v == q:
            return -1
        sign = orient(points[np.where(row == v, q, row)])
        if sign:
            return int(sign)
    raise AssertionError("the loop ends at q at the latest")
