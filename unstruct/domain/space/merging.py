"""Facets of a body that lie in one plane joined to polygons: what CAD systems call the faces of a part.

A surface of triangles divides each flat side of a body as its writer liked, often into needles. The sides
themselves are polygons, which are divided anew where a size asks for it. See the book, 2.8c.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import finite
from ...base.arrays import distinct, flagged
from ...base.errors import InputError
from ...base.jit import kernel
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ...mesh.grouping import group_rows
from ...predicates.batch import power_of_two
from ..plane.account import Repair
from ..plane.simplify import Simplified
from .cutting import views
from .faults import find_faults
from .straight import straight_vertices

__all__ = ["in_common_planes", "simplified_in_space"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
ROUNDED_SIDE = 16 * 2.0**-53  # off its plane, up to which a side is flat; unit: the largest coordinate
MOST_UNJOINED = 8  # sides are left as they are where polygons cross themselves; so often it is tried again


class _Rows(NamedTuple):
    """Sides as arrays: vertices of side i are vertex[start[i] : start[i + 1]], so are those beside it.

    The plane of each goes through its place across its normal.
    """

    start: Numbers
    vertex: NDArray[np.int32]
    first: Numbers
    beside: Numbers
    place: Array
    normal: Array


@kernel
def _grow(order, rows, x, within, label):
    """From the largest side on, each takes those beside it whose vertices are near its plane."""
    stack = np.empty(len(order), dtype=np.int64)
    for seed in order:
        if label[seed] >= 0:
            continue
        label[seed], stack[0], top = seed, seed, 1
        while top > 0:
            top -= 1
            facet = stack[top]
            for k in range(rows.first[facet], rows.first[facet + 1]):
                other = rows.beside[k]
                if label[other] >= 0:
                    continue
                near = True
                for j in range(rows.start[other], rows.start[other + 1]):
                    v, height = rows.vertex[j], 0.0
                    for a in range(3):
                        height += rows.normal[seed, a] * (x[v, a] - rows.place[seed, a])
                    near &= abs(height) <= within
                if near:
                    label[other] = seed
                    stack[top] = other
                    top += 1


def simplified_in_space(outline: Outline, shell: Any, tolerance: Any, size: Any) -> Simplified:
    """Join facets in one plane: see `Domain.simplified`."""
    if size is not None:
        raise InputError("a size is for planar regions; bodies are simplified up to a tolerance")
    if tolerance is not None and finite(tolerance, "tolerance") < 0:
        raise InputError(f"tolerance must be at least 0, not {tolerance!r}")
    largest = float(np.abs(outline.points).max(initial=0.0)) or 1.0
    within = ROUNDED_SIDE if tolerance is None else float(tolerance) / largest
    return in_common_planes(outline, within)[0]


def in_common_planes(
    outline: Outline,
    within: float = ROUNDED_SIDE,
    which: NDArray[np.bool_] | None = None,
    among: NDArray[np.bool_] | None = None,
) -> tuple[Simplified, Numbers]:
    """Join facets that hang together in one plane and have the same names.

    Parameters
    ----------
    outline : Outline
        In space.
    within : float
        How far off a plane facets may be; unit: the largest coordinate.
    which : (f,) bool, optional
        Facets that are joined with others; all by default. With it, vertices on straight edges stay, unless
        only sides of joined facets have them.
    among : (f,) bool, optional
        Facets that may be joined; all by default.

    Returns
    -------
    found : Simplified
    side : (f,) int64
        For each facet one of those with which it is joined, the same for all.

    Notes
    -----
    This makes polygons of the same body: distances decide, up to rounding, and names bound what is joined.
    Two others search for flat parts by angles at edges: `generate.stuffing.flat_parts` keeps edges of a given
    angle and refuses what is bent between them, `generate.prisms.planes` finds planes beside walls, where
    facets may be smaller than the tolerance. Each says why this does not serve it.
    """
    x = outline.points * power_of_two(outline.points)
    within = float(np.abs(x).max(initial=0.0)) * within
    facets = Polygons.of(outline.facets)
    side = _sides(outline, facets, x, within, among)
    if which is not None:
        side = np.where(flagged(len(facets), side[which])[side], side, np.arange(len(facets)))
    for _ in range(MOST_UNJOINED):
        rings, side = _rings(outline, facets, side, x)
        only = None if which is None else _between_joined(outline, facets, side)
        found = _joined(outline, facets, side, rings, x, within, only)
        parts = found.parts
        names = (parts["markers"], parts["regions"])
        trial = Outline(parts["points"], parts["facets"], parts["inner"], {}, *names)
        wrong = {piece for fault in find_faults(trial) for piece in fault.pieces}
        if not wrong:
            return found, side
        bad = np.isin(side, side[found.piece_origin[sorted(wrong)].clip(max=len(side) - 1)])
        if not bad.any():
            break
        side = np.where(bad, np.arange(len(side)), side)
    side = np.arange(len(side))
    return _joined(outline, facets, side, {}, x, -1.0), side


def _sides(
    outline: Outline, facets: Polygons, x: Array, within: float, among: NDArray[np.bool_] | None
) -> Numbers:
    """For each facet one of those that lie in its plane and hang together with it, the same for all.

    What is found is joined again, as long as anything is: large sides have more exact planes.
    """
    many = len(facets)
    normal, _ = views(x, facets)
    ends, owner = outline.pieces.sides
    number, first = group_rows(np.sort(ends.astype(np.int64), axis=1))
    order = np.argsort(number, kind="stable")
    begin = np.searchsorted(number[order], np.arange(len(first)))
    two = begin[np.bincount(number, minlength=len(first)) == 2]
    pairs = np.column_stack([owner[order[two]], owner[order[two + 1]]])
    name = _name_sets(outline)
    pairs = pairs[(pairs < many).all(axis=1)]
    if among is not None:
        pairs = pairs[among[pairs].all(axis=1)]
    pairs = pairs[name[pairs[:, 0]] == name[pairs[:, 1]]]
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    corners = np.column_stack([np.repeat(np.arange(many), facets.corners), facets.vertices])
    side = np.arange(many)
    while True:
        heads, group = np.unique(side, return_inverse=True)
        turned = (normal * normal[side]).sum(axis=1) < 0.0
        vector = np.zeros((len(heads), 3))
        np.add.at(vector, group, np.where(turned[:, None], -normal, normal))
        area = np.sqrt(vector[:, 0] ** 2 + vector[:, 1] ** 2 + vector[:, 2] ** 2)
        beside = np.unique(group[pairs], axis=0)
        beside = beside[beside[:, 0] != beside[:, 1]]
        vertex = np.unique(np.column_stack([group[corners[:, 0]], corners[:, 1]]), axis=0)
        starts = [np.searchsorted(part[:, 0], np.arange(len(heads) + 1)) for part in (vertex, beside)]
        count = np.diff(starts[0])
        place = np.stack([np.bincount(vertex[:, 0], x[vertex[:, 1], a]) / count for a in range(3)], axis=1)
        unit = vector / np.where(area > 0.0, area, 1.0)[:, None]
        more = (starts[1], beside[:, 1].copy(), place, unit)
        rows = _Rows(starts[0], vertex[:, 1].astype(np.int32), *more)
        label = np.full(len(heads), -1, dtype=np.int64)
        _grow(np.argsort(-area, kind="stable"), rows, x, within, label)
        if (label == np.arange(len(heads))).all():
            return side
        side = heads[label[group]]


def _name_sets(outline: Outline) -> Numbers:
    """Equal numbers for pieces with the same names."""
    label = np.zeros(len(outline.pieces), dtype=np.int64)
    for rows in outline.markers.values():
        has = np.zeros(len(label), dtype=np.int64)
        has[rows] = 1
        label = np.unique(2 * label + has, return_inverse=True)[1]
    return label


def _rings(
    outline: Outline, facets: Polygons, side: Numbers, x: Array
) -> tuple[dict[int, list[NDArray[np.int32]]], Numbers]:
    """The rings of each side of several facets, the outline first; others fall apart into their facets.

    These are sides that touch themselves in a vertex, and those in which an inner piece ends.
    """
    count = np.bincount(side, minlength=len(side))
    ends, owner = facets.sides
    several = count[side[owner]] > 1
    ends, of = np.sort(ends[several].astype(np.int64), axis=1), side[owner[several]]
    key, number = np.unique(np.column_stack([of, ends]), axis=0, return_inverse=True)
    key = key[np.bincount(number.ravel(), minlength=len(key)) == 1]  # by side: the edges at its outline
    corner, degree = np.unique(np.concatenate([key[:, [0, 1]], key[:, [0, 2]]]), axis=0, return_counts=True)
    bad = np.zeros(len(side), dtype=bool)
    bad[corner[degree != 2, 0]] = True
    bad[_with_inner_vertices(outline, facets, side, corner)] = True
    key = key[~bad[key[:, 0]]]
    start = np.searchsorted(key[:, 0], np.arange(len(side) + 1))
    rings = {}
    for k in distinct(key[:, 0]).tolist():
        found = _traced(key[start[k] : start[k + 1], 1:])
        rings[k] = sorted(found, key=lambda ring: -_area(x[ring]))
    return rings, np.where(bad[side], np.arange(len(side)), side)


def _with_inner_vertices(outline: Outline, facets: Polygons, side: Numbers, corner: Numbers) -> Numbers:
    """Sides with a vertex inside at which another piece ends."""
    owner = np.repeat(np.arange(len(facets)), facets.corners)
    pairs = np.unique(np.column_stack([side[owner], facets.vertices.astype(np.int64)]), axis=0)
    number, _ = group_rows(np.concatenate([corner, pairs]))
    inside = pairs[~np.isin(number[len(corner) :], number[: len(corner)])]
    uses = np.bincount(pairs[:, 1], minlength=len(outline.points))
    uses[outline.pieces.select(np.arange(len(facets), len(outline.pieces))).vertices] += 2
    return inside[uses[inside[:, 1]] > 1, 0]


def _traced(edges: Numbers) -> list[NDArray[np.int32]]:
    """The rings of edges of which two meet at each vertex."""
    beside: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    rings = []
    while beside:
        start = next(iter(beside))
        ring, before, v = [start], start, beside[start][0]
        while v != start:
            ring.append(v)
            one, two = beside.pop(v)
            before, v = v, two if one == before else one
        del beside[start]
        rings.append(np.array(ring, dtype=np.int32))
    return rings


def _area(p: Array) -> float:
    """The square of twice the area of a polygon in space, by Newell's sum."""
    q = np.roll(p, -1, axis=0) - p[0]
    p = p - p[0]
    total = [float((p[:, a - 2] * q[:, a - 1] - p[:, a - 1] * q[:, a - 2]).sum()) for a in range(3)]
    return total[0] ** 2 + total[1] ** 2 + total[2] ** 2


def _joined(
    outline: Outline,
    facets: Polygons,
    side: Numbers,
    rings: dict[int, list[NDArray[np.int32]]],
    x: Array,
    within: float,
    only: NDArray[np.bool_] | None = None,
) -> Simplified:
    """The arguments of the new domain: sides in the order of their first facets, then the inner pieces."""
    first = np.unique(side, return_index=True)[1]
    first = np.sort(first)
    polygons = [rings.get(k) or list(facets.rings(i)) for i, k in zip(first.tolist(), side[first].tolist())]
    inner = outline.pieces.select(np.arange(len(facets), len(outline.pieces)))
    every = Polygons.joined(Polygons.of_rings(polygons), inner)
    was = np.zeros(len(outline.points), dtype=bool)
    was[outline.pieces.vertices] = True
    kept = ~was
    kept[every.vertices] = True
    dropped = straight_vertices(every, x, within, only) if within >= 0.0 else kept[:0].nonzero()[0]
    kept[dropped] = False
    ring = [[row[kept[row]] for row in every.rings(i)] for i in range(len(every))]
    number = (np.cumsum(kept) - 1).astype(np.int32)
    every = Polygons.of_rings(ring).renumbered(number)
    many = len(first)
    piece = np.concatenate([first, np.arange(len(facets), len(outline.pieces))])
    rows = every.select(np.arange(many))
    whole = rows.triangles
    parts: dict[str, Any] = {
        "points": outline.points[kept],
        "facets": rows if whole is None else whole,
        "inner": every.select(np.arange(many, len(every))),
        "markers": {k: np.flatnonzero(np.isin(piece, v)) for k, v in outline.markers.items()},
        "regions": outline.regions,
    }
    return Simplified(parts, np.flatnonzero(kept), piece, _account(outline, facets, side, first, kept))


def _between_joined(outline: Outline, facets: Polygons, side: Numbers) -> NDArray[np.bool_]:
    """The vertices that no piece has but sides of several facets."""
    alone = np.bincount(side, minlength=len(side))[side] == 1
    others = outline.pieces.select(np.arange(len(facets), len(outline.pieces)))
    return ~flagged(len(outline.points), facets.select(np.flatnonzero(alone)).vertices, others.vertices)


def _account(
    outline: Outline, facets: Polygons, side: Numbers, first: Numbers, kept: NDArray[np.bool_]
) -> list[Repair]:
    """One entry for all that was joined and dropped."""
    gone = np.flatnonzero(~kept)
    if len(first) == len(facets) and len(gone) == 0:
        return []
    count = np.bincount(side, minlength=len(side))
    rows = np.flatnonzero(count[side] > 1)
    sides = int((count > 1).sum())
    text = (
        f"joined {len(rows)} facets that lie in the planes of {sides} to polygons, and dropped {len(gone)} "
        "vertices inside of these or on straight edges"
    )
    v = gone[0] if len(gone) else facets.vertices[facets.ring_start[facets.first_ring[rows[0]]]]
    where = tuple(map(float, outline.points[v]))
    return [Repair("joined facets", text, where, tuple(rows.tolist()), tuple(gone.tolist()))]
