"""What is seen of a solid: its boundary, what a plane leaves of it, and parts moved away from each other.

Only faces that can be seen are made: the faces of a kept cell that no kept cell of the same part shares.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ...base.errors import InputError
from ...mesh.cells import CELL_TYPES, cell_rows, incident_facets

__all__ = ["FACES", "SOLIDS", "Plane", "Shown", "as_plane", "face_normals", "filled_rows", "shown_faces"]

SOLIDS = {size: name for name, (dimension, size, _, _) in CELL_TYPES.items() if dimension == 3}
FACES = {size: CELL_TYPES[name][3] for size, name in SOLIDS.items()}
AXES = {"x": 0, "y": 1, "z": 2}


class Plane(NamedTuple):
    """A plane; what is on the side to which the unit normal points is removed."""

    point: np.ndarray
    normal: np.ndarray

    def heights(self, points: np.ndarray) -> np.ndarray:
        """The distances of points from the plane, positive where they are removed."""
        return (points - self.point) @ self.normal


class Shown(NamedTuple):
    """The faces of solids that can be seen.

    Attributes
    ----------
    rows : ndarray of int, shape (f, w)
        Corners, counterclockwise from outside, padded with -1: vertices, and then the new points.
    owner : ndarray of int, shape (f,)
        The cell that each face belongs to.
    cap : ndarray of bool, shape (f,)
        Whether the face is in the plane of the section.
    inner : ndarray of bool, shape (f,)
        Whether the face is inside of the solid: a section of a cell, or a face between two cells.
    ends, shares : ndarray, shapes (k, 2) and (k,)
        The new points: on which edge (i, j), and at which share of the way from i to j.
    """

    rows: np.ndarray
    owner: np.ndarray
    cap: np.ndarray
    inner: np.ndarray
    ends: np.ndarray
    shares: np.ndarray

    def extended(self, values: np.ndarray) -> np.ndarray:
        """Values at the vertices, followed by those at the new points."""
        first, second = values[self.ends[:, 0]], values[self.ends[:, 1]]
        shares = self.shares.reshape(-1, *[1] * (values.ndim - 1))
        return np.concatenate([values, (1 - shares) * first + shares * second])


def as_plane(section: Any) -> Plane:
    """A plane from an axis and an offset, such as ``("x", 0.5)`` or ``("-x", 0.5)``, or a point and a normal.

    Raises
    ------
    InputError
        For anything else, for coordinates that are not finite, and for a normal without length.
    """
    said = "section must be an axis and an offset, such as ('x', 0.5), or a point and a normal in space"
    try:
        first, second = section
        if isinstance(first, str):
            sign, axis = (-1.0, first[1:]) if first.startswith("-") else (1.0, first)
            normal = sign * np.eye(3)[AXES[axis]]
            point = np.eye(3)[AXES[axis]] * float(second)
        else:
            point, normal = (np.array(row, dtype=float).reshape(3) for row in (first, second))
    except (TypeError, ValueError, KeyError):
        raise InputError(f"{said}, not {section!r}") from None
    longest = float(np.abs(normal).max())
    if not (np.isfinite(point).all() and np.isfinite(normal).all() and longest > 0):
        raise InputError(f"{said}; {section!r} has no finite point and normal with a length")
    normal = normal / longest
    return Plane(point, normal / np.linalg.norm(normal))


def shown_faces(
    points: np.ndarray,
    cells: Mapping[str, Any],
    plane: Plane | None = None,
    *,
    flat: bool = False,
    parts: np.ndarray | None = None,
) -> Shown:
    """The faces that can be seen of solid cells, or of the cells of a surface.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
    cells : dict of str to array
        As `Mesh.cells`.
    plane : Plane, optional
        With ``flat``, cells are cut by it. Without, cells whose middle is beyond it are removed, so that the
        cut is crinkled, and the others are whole.
    parts : ndarray of int, shape (m,), optional
        The part of each cell; faces between two parts are seen, because parts can be moved.
    """
    indptr, corners = cell_rows(cells)
    count = len(indptr) - 1
    middle = np.add.reduceat(points[corners], indptr[:-1]) / np.diff(indptr)[:, None] if count else points[:0]
    kept, heights = np.ones(count, dtype=bool), None
    if plane is not None and count:
        heights = plane.heights(points)
        low = np.minimum.reduceat(heights[corners], indptr[:-1])
        kept = low < 0 if flat else plane.heights(middle) <= 0
    solid = all(CELL_TYPES.get(name, (2,))[0] == 3 for name in cells)
    if solid:
        rows, owner, group = incident_facets(cells)
        chosen = kept[owner]
        inner = (np.bincount(group)[group] > 1)[chosen]
        rows, owner, group = rows[chosen], owner[chosen], group[chosen]
        visible = ~_hidden(group, np.zeros(count, dtype=np.int64)[owner] if parts is None else parts[owner])
        # Cells that are turned are shown like the others. Products of huge or tiny lengths would overflow.
        size = np.abs(points).max(initial=0.0) or 1.0
        outward = (_middles(points, rows) - middle[owner]) / size
        inside = np.einsum("ij,ij->i", face_normals(points / size, rows), outward) < 0
        rows[inside] = _reversed(rows[inside])
    else:
        rows, owner = _padded(indptr, corners)[kept], np.flatnonzero(kept)
        visible, inner = np.ones(len(rows), dtype=bool), np.zeros(len(rows), dtype=bool)
    none = np.empty((0, 2), dtype=np.int64), np.empty(0)
    if heights is None or not flat:
        rows, owner, inner = rows[visible], owner[visible], inner[visible]
        return Shown(rows, owner, np.zeros(len(rows), dtype=bool), inner, *none)
    return _clipped(rows, owner, visible, inner, heights, solid)


def _hidden(group: np.ndarray, part: np.ndarray) -> np.ndarray:
    """Whether another cell of the same part has the same face."""
    order = np.lexsort((part, group))
    twin = (group[order][1:] == group[order][:-1]) & (part[order][1:] == part[order][:-1])
    hidden = np.zeros(len(group), dtype=bool)
    hidden[order[1:]] |= twin
    hidden[order[:-1]] |= twin
    return hidden


def _clipped(
    rows: np.ndarray,
    owner: np.ndarray,
    visible: np.ndarray,
    inner: np.ndarray,
    heights: np.ndarray,
    solid: bool,
) -> Shown:
    """What is below the plane of faces, and the sections of the cells that it crosses."""
    at = np.where(rows < 0, heights[rows[:, :1]], heights[rows])
    below, above = at.min(axis=1) < 0, at.max(axis=1) > 0
    whole = visible & ~above
    crossed = np.zeros(int(owner.max(initial=-1)) + 1, dtype=bool)
    crossed[owner[above]] = True  # only cells with a corner below are here
    edges: dict[int, dict[int, int]] = {}
    new: dict[tuple[int, int], int] = {}
    found: list[list[int]] = []
    owners: list[int] = []
    within: list[bool] = []
    for f in np.flatnonzero(below & (above | crossed[owner]) & (solid | visible)).tolist():
        ring = _clip(rows[f], heights, new)
        if visible[f] and above[f] and len(ring) > 2:
            found.append(ring)
            owners.append(int(owner[f]))
            within.append(bool(inner[f]))
        if solid and crossed[owner[f]]:
            following = edges.setdefault(int(owner[f]), {})
            for u, v in zip(ring, [*ring[1:], ring[0]]):
                if _on(u, heights) and _on(v, heights):
                    following[v] = u
    sides = len(found)
    for cell, following in edges.items():
        for ring in _rings(following):
            found.append(ring)
            owners.append(cell)
            within.append(True)
    width = max(rows.shape[1], max(map(len, found), default=0))
    made = np.full((len(found), width), -1, dtype=np.int64)
    for row, ring in zip(made, found):
        row[: len(ring)] = ring
    first = np.pad(rows[whole], ((0, 0), (0, width - rows.shape[1])), constant_values=-1)
    ends = np.array(list(new), dtype=np.int64).reshape(-1, 2)
    start, end = np.abs(heights[ends]).T
    cap = np.zeros(len(first) + len(found), dtype=bool)
    cap[len(first) + sides :] = True
    if solid:
        cap[: len(first)] = at[whole].min(axis=1) == 0
    return Shown(
        np.concatenate([first, made]),
        np.concatenate([owner[whole], np.array(owners, dtype=np.int64)]),
        cap,
        np.concatenate([inner[whole], np.array(within, dtype=bool)]),
        ends,
        start / np.maximum(start + end, np.finfo(float).tiny),
    )


def _on(point: int, heights: np.ndarray) -> bool:
    """Whether a point is in the plane: new points are."""
    return point >= len(heights) or bool(heights[point] == 0)


def _clip(row: np.ndarray, heights: np.ndarray, new: dict[tuple[int, int], int]) -> list[int]:
    """The part of a polygon that is not above the plane; new points are numbered after the vertices."""
    ring = [int(v) for v in row if v >= 0]
    made = []
    for u, v in zip(ring, [*ring[1:], ring[0]]):
        if heights[u] <= 0:
            made.append(u)
        if min(heights[u], heights[v]) < 0 < max(heights[u], heights[v]):
            made.append(len(heights) + new.setdefault((min(u, v), max(u, v)), len(new)))
    return made


def _rings(following: dict[int, int]) -> list[list[int]]:
    """Closed walks along edges, each of at least three."""
    made = []
    left = dict(following)
    while left:
        start = next(iter(left))
        ring, here = [start], left.pop(start)
        while here != start and here in left:
            ring.append(here)
            here = left.pop(here)
        if len(ring) > 2:
            made.append(ring)
    return made


def _padded(indptr: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Compressed rows as an array, padded with -1."""
    sizes = np.diff(indptr)
    rows = np.full((len(sizes), int(sizes.max(initial=3))), -1, dtype=np.int64)
    rows[np.arange(rows.shape[1]) < sizes[:, None]] = corners
    return rows


def filled_rows(rows: np.ndarray) -> np.ndarray:
    """Rows of corners, padded with their first corner instead of -1."""
    return np.where(rows < 0, rows[:, :1], rows)


def _reversed(rows: np.ndarray) -> np.ndarray:
    """The corners of faces in the other direction, from the same first one; the padding stays at the end."""
    sizes = (rows >= 0).sum(axis=1)[:, None]
    places = np.arange(rows.shape[1])
    turned = np.where(places < sizes, (sizes - places) % sizes, places)
    return np.take_along_axis(rows, turned, axis=1)


def _middles(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """The means of the corners of faces."""
    given = (rows >= 0)[:, :, None]
    return (points[filled_rows(rows)] * given).sum(axis=1) / given.sum(axis=1)


def face_normals(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Twice the area vectors of faces: they point to where the corners are counterclockwise from."""
    filled = filled_rows(rows)
    spokes = points[filled] - points[filled[:, :1]]
    return np.cross(spokes[:, :-1], spokes[:, 1:]).sum(axis=1)
