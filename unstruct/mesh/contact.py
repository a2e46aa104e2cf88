"""Where meshes touch without common faces: free faces of one that lie on free faces of another.

A hint and not a proof: faces are compared at a few points inside of them, up to a millionth of their length.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.boxes import BoxTree, bounding_boxes
from .cells import incident_facets

__all__ = ["Contact", "contacts"]

IN_CONTACT = 1e-6  # of the length of a face: what is nearer lies on it
OFF_CORNERS = 0.1  # how far towards the others the points near corners are, in barycentric coordinates
BARELY_OUTSIDE = 1e-9  # by which barycentric coordinates may be negative


class Contact(NamedTuple):
    """Faces of two meshes that lie on each other, and are not common.

    Attributes
    ----------
    first, second : int
        The meshes.
    faces, others : ndarray of int32, shape (f, w), (g, w)
        Those of the first and of the second mesh, padded by -1.
    gap : float
        If each of the faces has a partner with as many corners at nearly the same places, the largest
        distance of such corners; otherwise nan.
    """

    first: int
    second: int
    faces: NDArray[np.int32]
    others: NDArray[np.int32]
    gap: float


def contacts(points: np.ndarray, cells: Mapping[str, Any], mesh_of_cell: NDArray[np.int64]) -> list[Contact]:
    """The contacts of meshes that have been put together.

    Parameters
    ----------
    points : ndarray, shape (n, d)
    cells : dict of str to rows
        Of dimension 2 or 3.
    mesh_of_cell : ndarray of int, shape (m,)

    Returns
    -------
    list of Contact
        One for each pair of meshes that touch so, O(f log f) for f faces with one cell.
    """
    rows, cell, group = incident_facets(cells)
    free = np.bincount(group)[group] == 1
    rows, owner = rows[free], mesh_of_cell[cell[free]]
    if len(rows) == 0 or owner.min() == owner.max():
        return []
    corners, face = _pieces(points, rows)
    low, high = bounding_boxes(corners)
    length = (high - low).max(axis=1)
    near = IN_CONTACT * length[:, None]
    one, two = BoxTree(low - near, high + near).pairs(low - near, high + near)
    apart = owner[face[one]] != owner[face[two]]
    one, two = one[apart], two[apart]
    touching = _lies_on(corners[one], corners[two])
    touching |= _lies_on(corners[two], corners[one])
    one, two = face[one[touching]], face[two[touching]]
    one, two = one[owner[one] < owner[two]], two[owner[one] < owner[two]]
    found = []
    pair = owner[one] * (int(owner.max()) + 1) + owner[two]
    for key in np.unique(pair).tolist():
        some = pair == key
        a, b = np.unique(one[some]), np.unique(two[some])
        gap = _gap(points, rows, one[some], two[some])
        found.append(Contact(int(owner[a[0]]), int(owner[b[0]]), rows[a], rows[b], gap))
    return found


def _pieces(points: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges or triangles of which faces consist, (t, 2 or 3, d), and the face of each."""
    width = rows.shape[1]
    if width == 2:
        return points[rows], np.arange(len(rows))
    parts = [rows[:, :3]] + [rows[:, [0, k, k + 1]] for k in range(2, width - 1)]
    every, face = np.concatenate(parts), np.tile(np.arange(len(rows)), len(parts))
    whole = (every >= 0).all(axis=1)
    return points[every[whole]], face[whole]


def _lies_on(these: np.ndarray, those: np.ndarray) -> NDArray[np.bool_]:
    """Whether a point inside of each of ``these`` pieces lies on its partner among ``those``."""
    k = these.shape[1]
    weights = np.full((k + 1, k), OFF_CORNERS)
    weights[:k][np.arange(k), np.arange(k)] = 1 - (k - 1) * OFF_CORNERS
    weights[k] = 1 / k
    scale = np.maximum(np.ptp(these, axis=1).max(axis=1), np.ptp(those, axis=1).max(axis=1))
    scale = np.where(scale > 0, scale, 1.0)
    size = np.minimum(np.ptp(these, axis=1).max(axis=1), np.ptp(those, axis=1).max(axis=1)) / scale
    start = those[:, 0]
    corners = (those - start[:, None]) / scale[:, None, None]
    mine = (these - start[:, None]) / scale[:, None, None]
    result = np.zeros(len(these), dtype=bool)
    for weight in weights:
        x = sum(w * mine[:, j] for j, w in enumerate(weight.tolist()))
        result |= (_on_edge if k == 2 else _on_triangle)(x, corners, IN_CONTACT * size)
    return result


def _on_edge(x: np.ndarray, corners: np.ndarray, near: np.ndarray) -> NDArray[np.bool_]:
    """Whether points are on edges from the origin."""
    along = corners[:, 1]
    square = (along * along).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (x * along).sum(axis=1) / square
    off = x - t[:, None] * along
    return np.asarray((t >= 0) & (t <= 1) & ((off * off).sum(axis=1) <= near * near))


def _on_triangle(x: np.ndarray, corners: np.ndarray, near: np.ndarray) -> NDArray[np.bool_]:
    """Whether points are on triangles of which one corner is the origin."""
    u, v = corners[:, 1], corners[:, 2]
    normal = np.cross(u, v)
    square = (normal * normal).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (np.cross(x, v) * normal).sum(axis=1) / square
        t = (np.cross(u, x) * normal).sum(axis=1) / square
        height = (x * normal).sum(axis=1) / np.sqrt(square)
    inside = (s >= -BARELY_OUTSIDE) & (t >= -BARELY_OUTSIDE) & (s + t <= 1 + BARELY_OUTSIDE)
    return np.asarray(inside & (np.abs(height) <= near))


def _gap(points: np.ndarray, rows: np.ndarray, one: np.ndarray, two: np.ndarray) -> float:
    """The largest distance of corners, if all faces have partners with corners near their own."""
    corners, others = points[rows[one]], points[rows[two]]
    start, length = corners[:, :1], np.ptp(corners, axis=1).max(axis=1)[:, None, None]
    length = np.where(length > 0, length, 1.0)
    corners, others = (corners - start) / length, (others - start) / length
    away = np.sqrt(((corners[:, :, None] - others[:, None]) ** 2).sum(axis=3))
    away[(rows[one] < 0)[:, :, None] | (rows[two] < 0)[:, None]] = np.inf
    nearest = np.where(rows[one] < 0, 0.0, away.min(axis=2)).max(axis=1)
    same = ((rows[one] >= 0).sum(axis=1) == (rows[two] >= 0).sum(axis=1)) & (nearest <= 10 * IN_CONTACT)
    nearest = nearest * length.ravel()
    partners = np.unique(one[same])
    return float(nearest[same].max()) if len(partners) == len(np.unique(one)) else float("nan")
