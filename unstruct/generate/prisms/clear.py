"""Where layers meet what they should not: caps themselves, others, the surface, the planes in which they end.

Columns that are all positive, and a boundary that is embedded, are all that it takes: base, cap and the sides
in planes. The map from the layers, taken as abstract cells, to space then has at each point as many preimages
as the boundary winds around it, which for one embedded closed surface within the other is at most one. With
several bodies one more test is needed, as the layers of one may surround another one as a whole.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.embedded import meeting_pairs
from ...geometry.inside_shell import even_odd_in_space, triangle_components
from ...predicates.batch import orient_rows
from .records import Others

__all__ = ["Skin", "clashes", "skin_of", "surrounded"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


class Skin(NamedTuple):
    """The triangles that must not meet: base, cap, sides, others; in this order.

    Attributes
    ----------
    points : (m + r, 3) float64
        The points of the surface, then the tops of rays.
    triangles : (k, 3) int32
    rays : (k, 3) int64
        The rays whose tops are corners, -1 for other corners.
    plane : (k,) int32
        The plane in which a side, or a facet that is no wall, lies; -1 for none.
    is_side : (k,) bool
    stays : (m + r, 2) int32
        The planes in which each point has to stay, -1 for none.
    """

    points: Array
    triangles: NDArray[np.int32]
    rays: Numbers
    plane: NDArray[np.int32]
    is_side: NDArray[np.bool_]
    stays: NDArray[np.int32]


def skin_of(
    others: Others,
    columns: NDArray[np.int32],
    base: Numbers,
    top: Array,
    moves: NDArray[np.bool_],
    planes: NDArray[np.int32],
    border: tuple[Numbers, NDArray[np.int32]],
) -> Skin:
    """The boundary of layers, and of the rest of the surface.

    Parameters
    ----------
    others : Others
    columns : (c, 3) int32
        Rows of rays.
    base : (r,) int64
        The row of ``others.points`` in which each ray starts.
    top : (r, 3) float64
        Where the rays end.
    moves : (r,) bool
        Whether a ray has a height; the tops of others are their bases.
    planes : (r, 2) int32
        In which each ray stays, -1 for none.
    border : tuple of (e, 2) int64 and (e,) int32
        The edges of the border, as two rays in the direction of the column there, and the plane of each.
    """
    n = len(others.points)
    number = np.where(moves, n + np.arange(len(base)), base)
    (a, b), plane = border[0].T, border[1]
    one, two = (
        np.column_stack(rows)
        for rows in ((base[b], base[a], number[a]), (base[b], number[a], number[b]))
    )
    cap = number[columns][moves[columns].any(axis=1)]
    sides = np.concatenate([one[moves[a]], two[moves[b]]])
    along = np.concatenate([plane[moves[a]], plane[moves[b]]])
    triangles = np.concatenate([base[columns], cap, sides, others.triangles]).astype(np.int32)
    before = np.full(len(columns) + len(cap), -1, dtype=np.int32)
    is_side = np.zeros(len(triangles), dtype=bool)
    is_side[len(before) : len(before) + len(sides)] = True
    stays = np.full((n, 2), -1, dtype=np.int32)
    stays[base] = planes
    return Skin(
        np.concatenate([others.points, top]),
        triangles,
        np.where(triangles >= n, triangles - n, -1).astype(np.int64),
        np.concatenate([before, along, others.plane]).astype(np.int32),
        is_side,
        np.concatenate([stays, planes]),
    )


def clashes(skin: Skin) -> Numbers:
    """The rays that are to be lowered because layers meet something: sorted, each once; exact."""
    pairs = meeting_pairs(skin.points, skin.triangles)
    pairs = pairs[~_allowed(skin, pairs)]
    rays = skin.rays[pairs.ravel()]
    return np.unique(rays[rays >= 0])


def _allowed(skin: Skin, pairs: Numbers) -> NDArray[np.bool_]:
    """Whether a pair only meets in a plane in which layers end.

    A side lies on the facet of its plane. A triangle of the cap may touch the facet with the corners that
    stay in its plane, as long as the others are on one side of it.
    """
    found = np.zeros(len(pairs), dtype=bool)
    for one, two in (pairs.T, pairs[:, ::-1].T):
        facet = skin.plane[two]
        rows = np.flatnonzero((facet >= 0) & ~skin.is_side[two] & (skin.rays[one] >= 0).any(axis=1))
        side = skin.is_side[one[rows]] & (skin.plane[one[rows]] == facet[rows])
        found[rows[side]] = True
        rest = rows[~side]
        corners = skin.triangles[one[rest]]
        slides = (skin.stays[corners] == facet[rest, None, None]).any(axis=2)
        signs = np.zeros((len(rest), 3), dtype=np.int64)
        for k in range(3):
            some = np.flatnonzero(~slides[:, k])
            simplices = np.concatenate([skin.triangles[two[rest[some]]], corners[some, k][:, None]], axis=1)
            signs[some, k] = orient_rows(skin.points, simplices)
        same = (signs.max(axis=1) <= 0) | (signs.min(axis=1) >= 0)
        found[rest] |= slides.any(axis=1) & same & (slides | (signs != 0)).all(axis=1)
    return found


def surrounded(points: Array, base: NDArray[np.int32], number: Numbers) -> list[tuple[Numbers, Numbers]]:
    """Parts of the walls that lie within the layers of others, as pairs of rows of columns; exact.

    Parameters
    ----------
    points : (m, 3) float64
    base : (c, 3) int32
        The triangles of the base, as rows of points.
    number : (c, 3) int64
        Those of the cap.
    """
    component, _, count = triangle_components(base)
    found: list[tuple[Numbers, Numbers]] = []
    if count < 2:
        return found
    order = np.argsort(component, kind="stable")
    first = np.searchsorted(component[order], np.arange(count + 1))
    low, high = bounding_boxes(points[np.concatenate([base, number], axis=1)])
    start = first[:-1]
    low, high = np.minimum.reduceat(low[order], start), np.maximum.reduceat(high[order], start)
    probe = points[base[order[start], 0]]
    which, inside = BoxTree(low, high).pairs(probe, probe)
    apart = which != inside
    which, inside = which[apart], inside[apart]
    for body in np.unique(inside).tolist():
        rows = order[first[body] : first[body + 1]]
        ask = which[inside == body]
        moved = rows[(base[rows] != number[rows]).any(axis=1)]
        shell = np.concatenate([base[moved], number[moved]]).astype(np.int32)
        odd, _ = even_odd_in_space(points, shell, probe[ask])
        for other in ask[odd].tolist():
            found.append((rows, order[first[other] : first[other + 1]]))
    return found
