"""The given triangles divided and moved onto the surface that they approximate."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import as_points
from ...base.asking import asked_at
from ...base.errors import InputError
from ...geometry.edge_vectors import lengths
from ...mesh.mesh import Mesh

__all__ = ["moved_onto", "nearest_by"]

Array = NDArray[np.float64]
ROUNDS_OF_DIVISION = 12  # each halves edges
OFF_SHARE = (
    0.1  # of the distance that is allowed: edges whose middle is farther from the true surface are halved
)


def moved_onto(
    mesh: Mesh, onto: Callable[[Array], Any], allowed: Callable[[Array], Array], most: int
) -> Mesh:
    """A mesh on the true surface, near enough.

    Parameters
    ----------
    mesh : Mesh
        Of triangles in space. Equal points are one.
    onto : function (k, 3) -> (k, 3)
    allowed : function (k, 3) -> (k,)
        How far a remeshed surface may be from the true one.
    most : int
        The largest number of points.
    """
    points, triangles = nearest_by(onto, mesh.points), np.array(mesh.simplices)
    edges = {n: np.array(rows) for n, rows in mesh.markers.items() if rows.ndim == 2 and rows.shape[1] == 2}
    parent = np.arange(len(triangles))
    for _ in range(ROUNDS_OF_DIVISION):
        n = len(points)
        ends = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2).astype(np.int64), axis=1)
        key, side = np.unique(ends[:, 0] * n + ends[:, 1], return_inverse=True)
        pairs = np.stack(np.divmod(key, n), axis=1)
        middle = 0.5 * (points[pairs[:, 0]] + points[pairs[:, 1]])
        true = nearest_by(onto, middle)
        halved = lengths(true - middle) > OFF_SHARE * allowed(middle)
        if not halved.any() or n + int(halved.sum()) > most:
            break
        new = np.full(len(key), -1, dtype=np.int64)
        new[halved] = n + np.arange(int(halved.sum()))
        points = np.concatenate([points, true[halved]])
        triangles, parent = _divided(triangles, new[side].reshape(-1, 3), parent)
        edges = {name: _halves(rows, key, new, n) for name, rows in edges.items()}
    markers: dict[str, Any] = dict(edges)
    for name, rows in mesh.markers.items():
        if rows.ndim == 1:
            markers[name] = rows[parent]
        elif rows.shape[1] == 3:
            markers[name] = triangles[np.isin(parent, _cells_of(mesh, rows))]
        elif rows.shape[1] == 1:
            markers[name] = rows
    return Mesh(points, triangles, markers=markers, regions=mesh.regions)


def nearest_by(onto: Callable[[Array], Any], x: Array) -> Array:
    """The points of a true surface, checked."""
    takes = "points (k, 3) and returns as many, the nearest ones of the true surface"
    raw = asked_at(onto, x, "the function onto", takes)
    found = as_points(raw, "onto(x)")
    if found.shape != x.shape:
        raise InputError(f"onto must return points of shape {x.shape}, not {found.shape}")
    return np.array(found)


def _divided(triangles: np.ndarray, new: np.ndarray, parent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles with a new vertex, or -1, on the side opposite each corner, cut into two, three or four."""
    rows, owner = [], []
    many = (new >= 0).sum(axis=1)
    t = np.flatnonzero(many == 0)
    rows.append(triangles[t])
    owner.append(t)
    for count in (1, 2, 3):
        t = np.flatnonzero(many == count)
        if not len(t):
            continue
        first = np.argmax((new[t] >= 0) if count == 1 else (new[t] < 0), axis=1) if count < 3 else 0 * t
        turn = (first[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(triangles[t], turn, axis=1).T
        x, y, z = np.take_along_axis(new[t], turn, axis=1).T  # on b c, c a, a b
        parts = {
            1: [(a, b, x), (a, x, c)],
            2: [(a, z, y), (z, b, c), (z, c, y)],
            3: [(a, z, y), (z, b, x), (y, x, c), (x, y, z)],
        }[count]
        for part in parts:
            rows.append(np.stack(part, axis=1))
            owner.append(t)
    return np.concatenate(rows).astype(np.int32), parent[np.concatenate(owner)]


def _halves(rows: np.ndarray, key: np.ndarray, new: np.ndarray, n: int) -> np.ndarray:
    """Named edges after they were halved."""
    if not len(rows):
        return rows
    ends = np.sort(rows.astype(np.int64), axis=1)
    wanted = ends[:, 0] * n + ends[:, 1]
    place = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
    middle = np.where(key[place] == wanted, new[place], -1)
    cut = middle >= 0
    one = np.stack([rows[cut, 0], middle[cut]], axis=1)
    two = np.stack([middle[cut], rows[cut, 1]], axis=1)
    return np.concatenate([rows[~cut], one, two]).astype(np.int32)


def _cells_of(mesh: Mesh, rows: np.ndarray) -> np.ndarray:
    """The triangles with these corners."""
    n = len(mesh.points)
    every, some = (np.sort(x.astype(np.int64), axis=1) for x in (mesh.simplices, rows))
    codes = [(x[:, 0] * n + x[:, 1]) * n + x[:, 2] for x in (every, some)]
    return np.flatnonzero(np.isin(codes[0], codes[1]))
