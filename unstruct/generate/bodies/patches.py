"""The pieces of a body that are divided or kept as a whole, and the triangles of all others."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...domain.domain import Domain
from ...domain.space.cutting import views
from ...mesh.grouping import group_rows
from ...predicates.batch import power_of_two

__all__ = ["Patches", "patches_of", "shapes_of"]

Numbers = NDArray[np.int64]
Array = NDArray[np.float64]
FLAT_POLYGON = (
    32 * 2.0**-53
)  # off the plane of its polygon, up to which a vertex is in it; unit: largest coordinate


class Patches(NamedTuple):
    """What is divided or kept as a whole: polygons that are flat, and triangles.

    Attributes
    ----------
    piece : (k,)
        The piece of each.
    flat : (k,) bool
        Whether it is a piece as a whole; the others are triangles.
    sides : (s, 2)
        The sides of all, and edges that there must be inside.
    patch : (s,)
        The patch of each side.
    within : (s,) bool
        Whether the side is inside of the patch.
    normal : (k, 3)
        Of each patch, of any length.
    """

    piece: Numbers
    flat: NDArray[np.bool_]
    sides: Numbers
    patch: Numbers
    within: NDArray[np.bool_]
    normal: Array


def patches_of(domain: Domain) -> Patches:
    """Polygons in a plane, and the triangles of all others."""
    shell, pieces = domain.triangulated, domain.pieces
    x = domain.points * power_of_two(domain.points)  # products of very small coordinates are no doubles
    ends, owner = pieces.sides
    normal, _ = views(x, pieces)
    length = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(length > 0, length, 1.0)[:, None]
    first = np.full(len(pieces), -1)
    first[owner[::-1]] = ends[::-1, 0]
    away = np.abs(((x[ends[:, 0]] - x[first[owner]]) * unit[owner]).sum(axis=1))
    off = np.zeros(len(pieces))
    np.maximum.at(off, owner, away)
    whole = shapes_of(domain) & (off <= FLAT_POLYGON * np.abs(x).max())
    polygons, rows = np.flatnonzero(whole), np.flatnonzero(~whole[shell.piece])
    rank = np.full(len(pieces), -1)
    rank[polygons] = np.arange(len(polygons))
    of = whole[owner]
    parts = [(ends[of].astype(np.int64), rank[owner[of]], np.zeros(of.sum(), dtype=bool))]
    parts.append(_chords(domain, shell, ends[of], owner[of], whole, rank))
    corners = shell.triangles[rows].astype(np.int64)
    three = np.repeat(len(polygons) + np.arange(len(rows)), 3)
    parts.append((corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), three, np.zeros(len(three), dtype=bool)))
    sides, patch, within = (np.concatenate(column) for column in zip(*parts))
    a, b, c = x[corners].transpose(1, 0, 2)
    return Patches(
        np.concatenate([polygons, shell.piece[rows]]),
        np.arange(len(polygons) + len(rows)) < len(polygons),
        sides,
        patch,
        within,
        np.concatenate([normal[polygons], np.cross(b - a, c - a)]),
    )


def shapes_of(domain: Domain) -> NDArray[np.bool_]:
    """Which pieces are shapes: polygons of more than three corners, and triangles joined to no other.

    Two triangles are joined by an edge that no other piece has.
    """
    pieces = domain.pieces
    ends, owner = pieces.sides
    three = pieces.corners[owner] == 3
    number, _ = group_rows(np.sort(ends.astype(np.int64), axis=1))
    joined = three & (np.bincount(number, three)[number] == 2) & (np.bincount(number)[number] == 2)
    shape = pieces.corners >= 3
    shape[owner[joined]] = False
    return shape


def _chords(
    domain: Domain, shell: Any, ends: Numbers, owner: Numbers, whole: NDArray[np.bool_], rank: Numbers
) -> tuple[Numbers, Numbers, NDArray[np.bool_]]:
    """Edges inside of polygons at which another piece ends, or which are inner segments."""
    corners = shell.triangles
    rows = corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    piece = np.repeat(shell.piece, 3)
    use = whole[piece] & (rows[:, 0] < rows[:, 1])
    rows, piece = rows[use].astype(np.int64), piece[use].astype(np.int64)
    known, known_piece = domain.pieces.sides
    group, _ = group_rows(np.sort(np.concatenate([rows, known]), axis=1))
    mine, theirs = group[: len(rows)], group[len(rows) :]
    # A side of its own polygon is one of ``known`` too: an edge within is a side of others only.
    width = len(domain.pieces)
    own = np.isin(mine * width + piece, theirs * width + known_piece)
    use = np.isin(mine, theirs) & ~own
    return rows[use], rank[piece[use]], np.ones(use.sum(), dtype=bool)
