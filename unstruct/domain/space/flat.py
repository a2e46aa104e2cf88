"""Rings, chords and points that lie in a plane, up to rounding, as triangles: seen along an axis, exactly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...connect.insertion.engine import COUNT
from ...connect.planar.bounded import SEGMENTS_AT_ONCE, bound_at_once
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.flood import mark_regions
from ...connect.planar.inserting import insert_all
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ..plane.faults import Fault, find_faults

__all__ = ["NO_ENDS", "chords_of", "sides_of", "triangulated"]

NO_ENDS = np.empty((0, 2), dtype=np.int32)


def sides_of(rings: tuple[np.ndarray, ...]) -> NDArray[np.int32]:
    """The sides of rings, (s, 2)."""
    return np.concatenate([NO_ENDS, *(np.column_stack([ring, np.roll(ring, -1)]) for ring in rings)])


def triangulated(
    xyz: np.ndarray,
    sides: np.ndarray,
    view: int,
    *,
    chords: np.ndarray = NO_ENDS,
    also: np.ndarray = NO_ENDS[:, 0],
) -> tuple[NDArray[np.int32], Fault | None]:
    """The constrained Delaunay triangulation of what an odd number of sides separates from infinity.

    Parameters
    ----------
    xyz : (n, 3) float64
        Coordinates, at most 1 in magnitude.
    sides : (s, 2) int
        Pairs of vertices, an even number at each. Without any, the convex hull is triangulated.
    view : int
        The two coordinates to look at, as 3 i + j.
    chords : (c, 2) int
        Edges that there must be; those that would cross a side or an earlier one are left out, since the
        vertices need not lie in a plane exactly.
    also : (k,) int
        Vertices that there must be.

    Returns
    -------
    triangles : (t, 3) int32
        Counterclockwise in this view.
    wrong : Fault or None
        What is wrong with the sides; there are no triangles then.
    """
    number, at = np.unique(np.concatenate([sides.ravel(), chords.ravel(), also]), return_inverse=True)
    flat = np.ascontiguousarray(xyz[number][:, [view // 3, view % 3]])
    segments = at[: sides.size].reshape(-1, 2).astype(np.int32)
    inner = at[sides.size : sides.size + chords.size].reshape(-1, 2).astype(np.int32)
    wrong = _faults(flat, segments, inner)
    if wrong and len(inner):
        wrong = _faults(flat, segments, inner[:0])
        kept = inner[:0]
        for chord in inner if not wrong else ():
            more = np.concatenate([kept, chord[None]])
            kept = kept if _faults(flat, segments, more) else more
        inner = kept
    if wrong:
        return np.empty((0, 3), dtype=np.int32), wrong[0]
    rows, many, whole = np.concatenate([segments, inner]), len(segments), len(segments) == 0
    pieces = (rows, np.arange(len(rows), dtype=np.int32), np.tile([0.0, 1.0], (len(rows), 1)))
    complex_ = PlanarComplex(flat)
    if len(rows) > SEGMENTS_AT_ONCE or not bound_at_once(complex_, pieces, many, {}, whole):
        complex_ = PlanarComplex(flat)
        insert_all(complex_, *pieces, facets=many, progress=False)
        mark_regions(complex_, many, {}, whole)
    count = int(complex_.state[COUNT])
    inside = complex_.vertex[: 3 * count].reshape(-1, 3)[complex_.region[:count] >= 0]
    return number[inside].astype(np.int32), None


def _faults(flat: np.ndarray, segments: np.ndarray, inner: np.ndarray) -> list[Fault]:
    return find_faults(Outline(flat, segments, inner, {}, {}, {}))


def chords_of(polygons: Polygons) -> dict[int, NDArray[np.int32]]:
    """The sides of pieces that join two vertices of another polygon and are no side of it: (c, 2) each.

    Where they lie in its plane, they must be edges of its triangles.
    """
    ends, owner = polygons.sides
    large = polygons.corners > 3
    if not large.any():
        return {}
    sides = np.sort(ends, axis=1).astype(np.int64)
    edge, number = np.unique((sides[:, 0] << 32) | sides[:, 1], return_inverse=True)
    p, q = edge >> 32, edge & (2**32 - 1)
    # the large polygons at each vertex, in rows sorted by vertex
    polygon = np.repeat(np.arange(len(polygons)), polygons.corners)
    keep = large[polygon]
    key = np.sort((polygons.vertices[keep].astype(np.int64) << 32) | polygon[keep])
    start, stop = np.searchsorted(key, p << 32), np.searchsorted(key, (p + 1) << 32)
    at = np.repeat(np.arange(len(edge)), stop - start)
    first = np.cumsum(stop - start) - (stop - start)
    of = key[np.arange(len(at)) - first[at] + start[at]] & (2**32 - 1)
    wanted = (q[at] << 32) | of
    found = np.searchsorted(key, wanted)
    both = key[np.minimum(found, len(key) - 1)] == wanted
    at, of = at[both], of[both]
    own = np.isin((of << 32) | at, (owner[large[owner]] << 32) | number[large[owner]])
    at, of = at[~own], of[~own]
    result: dict[int, list[int]] = {}
    for i, e in zip(of.tolist(), at.tolist()):
        result.setdefault(i, []).append(e)
    return {i: np.column_stack([p[rows], q[rows]]).astype(np.int32) for i, rows in result.items()}
