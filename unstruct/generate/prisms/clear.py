"""Where layers meet what they should not: caps themselves, others, the surface, the planes in which they end.

Columns that are all positive, and a boundary that is embedded, are all that it takes: base, cap and the sides
in planes. The map from the layers, taken as abstract cells, to space then has at each point as many preimages
as the boundary winds around it, which for one embedded closed surface within the other is at most one. With
several bodies one more test is needed, as the layers of one may surround another one as a whole; and inside
of a body the cap must not be turned inside out, so that it winds once more around what it encloses.
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

__all__ = ["Border", "Over", "Skin", "clashes", "inside_out", "skin_of", "surrounded"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
SURE_VOLUME = 2.0**-44  # of the sum of absolute products: above the rounding of each term and of their sum
NEAR_RAY = 1e-9  # of the distance: how far points on an edge may be from the rounded ray along it
FEW_FRESH = 0.25  # up to this share of new triangles only what is near them is tested


class Border(NamedTuple):
    """The edges at which walls end: two rays in the direction of the column there, the plane, the column."""

    ends: Numbers
    plane: NDArray[np.int32]
    column: Numbers


class Over(NamedTuple):
    """The last columns, which have no base: the columns to which they are counted, and the solids below them.

    Those of the same solid may meet.
    """

    owner: Numbers
    solid: Numbers


NOTHING_OVER = Over(np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64))


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
    column : (k,) int64
        The column of which each is the base, the cap or a side; -1 for others.
    fresh : (k,) bool
        Whether a triangle is new since the last test: no others can meet that did not before.
    base : (r,) int64
        The point in which each ray starts.
    solid : (k,) int64
        The solid of `Over` below each; -1 for none.
    """

    points: Array
    triangles: NDArray[np.int32]
    rays: Numbers
    plane: NDArray[np.int32]
    is_side: NDArray[np.bool_]
    stays: NDArray[np.int32]
    column: Numbers
    fresh: NDArray[np.bool_]
    base: Numbers
    solid: Numbers


def skin_of(
    others: Others,
    columns: NDArray[np.int32],
    base: Numbers,
    top: Array,
    moves: NDArray[np.bool_],
    planes: NDArray[np.int32],
    border: Border,
    changed: NDArray[np.bool_],
    over: Over = NOTHING_OVER,
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
    border : Border
    changed : (r,) bool
        Which rays have other heights than at the last test.
    over : Over
        The last columns.
    """
    based = len(columns) - len(over.owner)
    n = len(others.points)
    number = np.where(moves, n + np.arange(len(base)), base)
    (a, b), plane = border.ends.T, border.plane
    one, two = (
        np.column_stack(rows) for rows in ((base[b], base[a], number[a]), (base[b], number[a], number[b]))
    )
    on = np.asarray(moves[columns].any(axis=1), dtype=bool)
    on[based:] &= _apart(number[columns[based:]])
    cap = number[columns][on]
    low, high = moves[a] & (base[a] != base[b]), moves[b]  # the sides of fans are triangles
    sides = np.concatenate([one[low], two[high]])
    along = np.concatenate([plane[low], plane[high]])
    triangles = np.concatenate([base[columns[:based]], cap, sides, others.triangles]).astype(np.int32)
    before = np.full(based + len(cap), -1, dtype=np.int32)
    is_side = np.zeros(len(triangles), dtype=bool)
    is_side[len(before) : len(before) + len(sides)] = True
    stays = np.full((n, 2), -1, dtype=np.int32)
    stays[base] = planes
    beside = changed[a] | changed[b]
    new = [changed[columns[on]].any(axis=1), beside[low], beside[high]]
    fresh = np.zeros(len(triangles), dtype=bool)
    fresh[based : len(before) + len(sides)] = np.concatenate(new)
    solid = np.full(len(triangles), -1, dtype=np.int64)
    solid[based : len(before)] = np.concatenate([np.full(based, -1), over.solid])[on]
    return Skin(
        np.concatenate([others.points, top]),
        triangles,
        np.where(triangles >= n, triangles - n, -1).astype(np.int64),
        np.concatenate([before, along, others.plane]).astype(np.int32),
        is_side,
        np.concatenate([stays, planes]),
        np.concatenate(
            [
                np.arange(based),
                np.concatenate([np.arange(based), over.owner])[on],
                border.column[low],
                border.column[high],
                np.full(len(others.triangles), -1),
            ]
        ),
        fresh,
        base,
        solid,
    )


def _apart(triangles: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Whether the corners of triangles are different."""
    a, b, c = triangles.T
    return np.asarray((a != b) & (b != c) & (c != a), dtype=bool)


def clashes(skin: Skin) -> Numbers:
    """The rays that are to be lowered because layers meet something: sorted, each once; exact."""
    rows = _near(skin)
    pairs = rows[meeting_pairs(skin.points, skin.triangles[rows])]
    one, two = skin.solid[pairs.T]
    pairs = pairs[(one < 0) | (one != two)]
    pairs = pairs[~_allowed(skin, pairs)]
    rays = skin.rays[pairs.ravel()]
    return np.unique(rays[rays >= 0])


def _near(skin: Skin) -> Numbers:
    """The triangles that are new, and those whose boxes meet theirs."""
    many = int(skin.fresh.sum())
    if many == 0 or many > FEW_FRESH * len(skin.fresh):
        return np.arange(len(skin.fresh) if many else 0)
    low, high = bounding_boxes(skin.points[skin.triangles])
    fresh, old = np.flatnonzero(skin.fresh), np.flatnonzero(~skin.fresh)
    query, _ = BoxTree(low[fresh], high[fresh]).pairs(low[old], high[old])
    return np.sort(np.concatenate([fresh, old[np.unique(query)]]))


def _allowed(skin: Skin, pairs: Numbers) -> NDArray[np.bool_]:
    """Whether a pair only meets in a plane in which layers end.

    A side lies on the facet of its plane. A triangle of the cap may touch the facet with the corners that
    stay in its plane, as long as the others are on one side of it, or the triangle leaves the facet behind
    the edge along which its corner slides.
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
        behind = np.flatnonzero(~same & (slides.sum(axis=1) == 1) & (slides | (signs != 0)).all(axis=1))
        if len(behind):
            found[rest[behind]] |= _behind_edges(skin, one[rest[behind]], two[rest[behind]], slides[behind])
    return found


def _behind_edges(skin: Skin, one: Numbers, two: Numbers, slides: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether triangles meet facets, whose planes they cross, only in the corner that slides along an edge.

    Seen along that edge, on which the corner's ray lies, the triangle is an angle, and the facet a half-line,
    that has to be outside of it: so at a corner of a floor where its sides are concave.
    """
    k = slides.argmax(axis=1)
    row = np.arange(len(one))
    corners = skin.triangles[one]
    ray = skin.rays[one, k]
    found = (ray >= 0) & (skin.stays[corners[row, k]] >= 0).all(axis=1)
    some = np.flatnonzero(found)
    low, high = skin.base[ray[some]], corners[some, k[some]]
    q, r = corners[some, (k[some] + 1) % 3], corners[some, (k[some] + 2) % 3]

    def turn(a: NDArray, b: NDArray) -> NDArray[np.int64]:
        return orient_rows(skin.points, np.column_stack([low, high, a, b])).astype(np.int64)

    angle, along = turn(q, r), skin.points[high] - skin.points[low]
    along /= np.maximum(np.sqrt((along * along).sum(axis=1)), 1e-300)[:, None]
    good = angle != 0
    for i in range(3):
        f = skin.triangles[two[some], i]
        away = skin.points[f] - skin.points[low]
        off = away - (away * along).sum(axis=1)[:, None] * along
        on_edge = (off * off).sum(axis=1) <= NEAR_RAY**2 * (away * away).sum(axis=1)
        good &= on_edge | (turn(q, f) * angle < 0) | (turn(f, r) * angle < 0)
    found[some] = good
    return found


def surrounded(skin: Skin, columns: NDArray[np.int32], moves: NDArray[np.bool_]) -> Numbers:
    """The rays that are to be lowered because layers contain others, or a part of the surface; exact.

    If nothing meets, the layers of a part of the walls are what its skin has inside by the even-odd rule.
    They overlap with those of another part exactly if a corner of the base or of the cap of one is inside of
    the other; and so it is with parts of the surface that are no walls.
    """
    column, walls = skin.column, skin.column >= 0
    component, _, count = triangle_components(skin.triangles[: len(columns)])
    free, beside = _free_parts(skin.triangles[~walls], skin.plane[~walls])
    if count + free < 2:
        return np.empty(0, dtype=np.int64)
    on = np.asarray(moves[columns].any(axis=1), dtype=bool)
    part = np.full(len(column), -1, dtype=np.int64)
    part[walls] = component[column[walls]]
    part[~walls] = np.where(beside >= 0, count + beside, -1)
    is_cap = np.arange(len(column)) >= len(columns)
    probes, owner = [], []
    for rows in (np.flatnonzero((part >= 0) & ~is_cap), np.flatnonzero((part >= 0) & is_cap)):
        found, first = np.unique(part[rows], return_index=True)
        probes.append(skin.triangles[rows[first], 2])
        owner.append(found)
    probe, owned = skin.points[np.concatenate(probes)], np.concatenate(owner)
    shell = np.flatnonzero((part >= 0) & (part < count))
    shell = shell[on[column[shell]]]
    order = shell[np.argsort(part[shell], kind="stable")]
    found, start = np.unique(part[order], return_index=True)
    if not len(found):
        return np.empty(0, dtype=np.int64)
    low, high = bounding_boxes(skin.points[skin.triangles[order]])
    low, high = np.minimum.reduceat(low, start), np.maximum.reduceat(high, start)
    which, inside = BoxTree(low, high).pairs(probe, probe)
    apart = owned[which] != found[inside]
    which, inside = which[apart], inside[apart]
    ends = np.append(start, len(order))
    wrong = np.zeros(count + free, dtype=bool)
    for body in np.unique(inside).tolist():
        ask = which[inside == body]
        layers = skin.triangles[order[ends[body] : ends[body + 1]]]
        odd, _ = even_odd_in_space(skin.points, layers, probe[ask])
        wrong[owned[ask[odd]]] = True
        wrong[found[body]] |= odd.any()
    rays = np.unique(columns[wrong[component]]).astype(np.int64)
    return rays[moves[rays]]


def inside_out(skin: Skin, columns: NDArray[np.int32], border: Border, moves: NDArray[np.bool_]) -> Numbers:
    """The rays of closed parts whose cap does not surely enclose a volume of the same sign as their base.

    If base and cap are embedded and do not meet, and all columns are positive, this is what is left to be
    asked: a cap that is turned inside out encloses a negative volume.
    """
    many = len(columns)
    component, _, count = triangle_components(skin.triangles[:many])
    closed = np.ones(count, dtype=bool)
    closed[component[border.column]] = False
    if not closed.any():
        return np.empty(0, dtype=np.int64)
    base = skin.triangles[:many]
    still = ~moves[columns].any(axis=1)  # the base is the cap there
    cap = (np.arange(len(skin.column)) >= many) & (skin.column >= 0) & ~skin.is_side
    top = np.concatenate([base[still], skin.triangles[cap]])
    of_top = np.concatenate([component[still], component[skin.column[cap]]])
    start = skin.points[base[np.unique(component, return_index=True)[1], 0]]
    (below, near), (above, off) = (
        _volumes(skin.points[rows] - start[part][:, None], part, count)
        for rows, part in ((base, component), (top, of_top))
    )
    same = (below > near) & (above > off) | (below < -near) & (above < -off)
    rays = np.unique(columns[(closed & ~same)[component]]).astype(np.int64)
    return rays[moves[rays]]


def _volumes(p: Array, component: Numbers, count: int) -> tuple[Array, Array]:
    """Six times the volume that each component encloses, and a bound of its error."""
    a, b, c = p[:, 0], p[:, 1], p[:, 2]
    one = np.stack([a[:, i] * b[:, i - 2] * c[:, i - 1] for i in range(3)], axis=1)
    two = np.stack([a[:, i] * b[:, i - 1] * c[:, i - 2] for i in range(3)], axis=1)
    sums: Array = np.bincount(component, (one - two).sum(axis=1), count).astype(np.float64)
    size: Array = np.bincount(component, (np.abs(one) + np.abs(two)).sum(axis=1), count).astype(np.float64)
    return sums, SURE_VOLUME * len(p) * size


def _free_parts(triangles: NDArray[np.int32], plane: NDArray[np.int32]) -> tuple[int, Numbers]:
    """How many parts of the surface do not hang together with walls, and the part of each triangle, or -1."""
    if not len(triangles):
        return 0, np.empty(0, dtype=np.int64)
    component, _, count = triangle_components(triangles)
    free = np.ones(count, dtype=bool)
    free[component[plane >= 0]] = False
    number = np.where(free, np.cumsum(free) - 1, -1)
    parts: Numbers = number[component].astype(np.int64)
    return int(free.sum()), parts
