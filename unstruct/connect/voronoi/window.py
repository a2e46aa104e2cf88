"""Windows that cut Voronoi cells: boxes, polygons with holes, domains, geometry; all become convex pieces.

Everything is decided by exact signs: whether a polygon is convex, whether its sides cross, and where it is
inside. A window that is not convex is divided by its constrained Delaunay triangulation, whose triangles are
then merged, so that no corner is new.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...geometry.parity import enclosed_area
from ...geometry.segment_pairs import TOUCHING, meetings
from ...predicates.batch import orient
from ..planar.complex import PlanarComplex
from ..planar.flood import mark_regions
from ..planar.inserting import insert_all
from .pieces import convex_pieces, first_overlap

__all__ = ["Window", "as_window", "convex_corners"]

Floats = NDArray[np.float64]

CHORDS = 64  # of curves, a chord then turns by about a degree at most
MEANINGS = "a box ((x0, y0), (x1, y1)), corners (k, 2), rings, a Domain, or a geometry such as shapely's"


class Window(NamedTuple):
    """Disjoint convex polygons, counterclockwise: piece i has the corners start[i] to start[i + 1] - 1."""

    corner: Floats
    start: NDArray[np.int64]
    convex: bool  # given as a box or as the corners of one convex polygon


def as_window(clip: Any) -> Window:
    """The convex pieces of a window.

    Parameters
    ----------
    clip : array_like, sequence of array_like, Domain, geometry, or Window
        A box ((x0, y0), (x1, y1)); the corners (k, 2) of a polygon, in either direction, closed or not; a
        sequence of such rings, of which the first is the outline and the others are holes; a `Domain`, or
        another object with ``facets`` and ``sampled()``, whose curves are replaced by chords; a GeoJSON
        mapping, or an object with ``__geo_interface__``, that contains polygons.

    Raises
    ------
    InputError
        For a wrong shape, coordinates that are not finite, an empty box, rings without area, sides that
        cross or overlap, holes that are not inside the outline, and polygons that overlap.
    """
    if isinstance(clip, Window):
        return clip
    if hasattr(clip, "sampled") and hasattr(clip, "facets"):
        return _of_outline(clip)
    if isinstance(clip, Mapping) or hasattr(clip, "__geo_interface__"):
        return _of_polygons(list(_polygons(clip)))
    try:
        array = np.array(clip, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        rings = _rings(clip)
        if rings is None:
            raise InputError(f"clip is not an array of real numbers: {error}") from None
        return _of_polygons([rings])
    if array.ndim == 3 and len(array) and array.shape[2] == 2:
        return _of_polygons([list(array)])
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 2:
        raise InputError(f"clip has shape {array.shape}; it must be {MEANINGS}")
    if len(array) == 2:
        return _box(_finite(array, "clip"))
    ring = _ring(array, "clip")
    corners = convex_corners(ring)
    if corners is not None:
        return Window(corners, np.array([0, len(corners)]), True)
    return Window(*_divided([ring], ["clip"]), False)


def _box(corners: Floats) -> Window:
    (x0, y0), (x1, y1) = corners
    if not (x0 < x1 and y0 < y1):
        raise InputError(
            f"the box {corners.tolist()} is empty; give its lower left corner, then its upper right one"
        )
    return Window(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), np.array([0, 4]), True)


# --- rings ----------------------------------------------------------------------------------------


def _rings(clip: Any) -> list[Floats] | None:
    """Rings of different lengths as arrays; None if it is not that."""
    if not isinstance(clip, Sequence) or isinstance(clip, str):
        return None
    try:
        rings = [np.array(ring, dtype=np.float64) for ring in clip]
    except (TypeError, ValueError):
        return None
    return rings if all(ring.ndim == 2 and ring.shape[1] == 2 for ring in rings) else None


def _finite(corners: Floats, name: str) -> Floats:
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=1))
    if len(bad):
        raise InputError(f"corner {bad[0]} of {name} is {corners[bad[0]].tolist()}; all must be finite")
    return corners


def _ring(corners: Floats, name: str) -> Floats:
    """The corners without those that repeat the one before; also the last, if it repeats the first."""
    corners = _finite(corners, name) + 0.0  # no -0.0, so that equal corners have equal bytes
    kept = (corners != np.roll(corners, 1, axis=0)).any(axis=1)
    ring = corners[kept]
    if len(ring) < 3:
        raise InputError(f"{name} has fewer than three different corners; it must enclose an area")
    return ring


def convex_corners(ring: Floats) -> Floats | None:
    """The corners of a convex polygon, counterclockwise and without straight angles; None for others."""
    turns = _turns(ring)
    if (turns < 0).sum() > (turns > 0).sum():
        ring, turns = ring[::-1].copy(), -turns[::-1]
    corners, left = ring[turns != 0], turns[turns != 0]
    if len(corners) == 0:
        raise InputError("the corners of clip are collinear; they must enclose an area")
    if len(corners) < 3 or (left < 0).any():
        return None
    fan = np.stack([np.broadcast_to(corners[0], corners[2:].shape), corners[1:-1], corners[2:]], axis=1)
    if (np.atleast_1d(orient(fan)) <= 0).any() or (_turns(corners) <= 0).any():
        return None  # it winds more than once
    return corners


def _turns(ring: Floats) -> NDArray[np.int8]:
    around = np.stack([np.roll(ring, 1, axis=0), ring, np.roll(ring, -1, axis=0)], axis=1)
    return np.atleast_1d(orient(around))


def _divided(rings: list[Floats], names: list[str]) -> tuple[Floats, NDArray[np.int64]]:
    """The convex pieces of a polygon: the first ring is its outline, the others are holes."""
    counts = [len(ring) for ring in rings]
    begin = np.cumsum([0, *counts])
    where, number = np.unique(np.concatenate(rings), axis=0, return_inverse=True)
    number = number.ravel()
    sides: list[NDArray[Any]] = []
    for k, (first, count) in enumerate(zip(begin, counts)):
        ahead = number[first : first + count]
        ahead = np.stack([ahead, np.roll(ahead, -1)], axis=1)
        area = enclosed_area(where, ahead)
        if area == 0.0 and (np.atleast_1d(_turns(rings[k])) == 0).all():
            raise InputError(f"the corners of {names[k]} are collinear; they must enclose an area")
        sides.append(ahead if (area > 0) == (k == 0) else ahead[:, ::-1])
    ends = np.concatenate(sides).astype(np.int32)
    owner = np.repeat(np.arange(len(rings)), counts)

    def side(s: int) -> str:
        k = int(owner[s])
        place = s - int(begin[k])
        return f"side {place} of {names[k]} (corners {place} and {(place + 1) % counts[k]})"

    pairs, kind = meetings(where, ends)
    for (s, t), how in zip(pairs.tolist(), kind.tolist()):
        if how != TOUCHING:
            verb = "crosses" if how == 1 else "overlaps"
            raise InputError(
                f"{names[owner[s]]} is not convex, and {side(s)} {verb} {side(t)}: a window must not meet "
                "itself but at single points; cut it there into polygons, or mend it (shapely's make_valid)"
            )
    complex_ = PlanarComplex(where)
    piece = np.arange(len(ends), dtype=np.int32)
    insert_all(complex_, ends, piece, np.tile([0.0, 1.0], (len(ends), 1)), facets=len(ends))
    mark_regions(complex_, len(ends), {}, hull=False)
    wrong = _turned_sides(complex_)
    if len(wrong):
        s = int(wrong.min())
        if len(rings) > 1:
            what = "a hole must lie inside the outline, and outside of other holes"
            raise InputError(f"{names[owner[s]]} is misplaced: {what}, but {side(s)} does not")
        raise InputError(
            f"{names[0]} is not convex, and it crosses itself: along {side(s)} the inside lies on the other "
            "side than along the rest; cut it into simple polygons"
        )
    mesh = complex_.mesh(facets=len(ends), regions=False, points=where)
    return convex_pieces(mesh.points, mesh.simplices, mesh.neighbors)


def _turned_sides(complex_: PlanarComplex) -> NDArray[np.int32]:
    """Sides that do not have the inside on their left and the outside on their right."""
    count = complex_.segments
    edge = complex_.where[:count].astype(np.int64)
    start = complex_.vertex[edge + np.where(edge % 3 == 2, -2, 1)]
    along = start == complex_.ends[:count, 0]
    twin = complex_.twin[edge]
    left = complex_.region[np.where(along, edge, twin) // 3] >= 0
    right = complex_.region[np.where(along, twin, edge) // 3] >= 0
    return complex_.piece[:count][~left | right]


# --- domains and geometry -------------------------------------------------------------------------


def _of_outline(outline: Any) -> Window:
    """The pieces of a region with valid facets, even-odd, whose curves are cut into chords."""
    sampled, facets = outline.sampled(), len(outline.facets)
    if sampled.points.shape[1] != 2:
        raise InputError(f"a window must be planar, not a domain in {sampled.points.shape[1]} dimensions")
    chosen = sampled.piece < facets
    if not chosen.any():
        raise InputError("the domain has no facets, so nothing is inside: give facets")
    points, ends, piece = sampled.points, sampled.ends[chosen], sampled.piece[chosen]
    if outline.curves:
        fine = _finer(outline, points, ends, piece, sampled.span[chosen])
        if not (meetings(*fine[:2])[1] != TOUCHING).any():
            points, ends, piece = fine
    used, place = np.unique(ends, return_inverse=True)
    complex_ = PlanarComplex(points[used])
    ends = place.reshape(ends.shape).astype(np.int32)
    insert_all(complex_, ends, piece, np.tile([0.0, 1.0], (len(ends), 1)), facets=facets)
    mark_regions(complex_, facets, {}, hull=False)
    mesh = complex_.mesh(facets=facets, regions=False, points=points[used])
    return Window(*convex_pieces(mesh.points, mesh.simplices, mesh.neighbors), False)


def _finer(outline: Any, points: Floats, ends: Any, piece: Any, span: Floats) -> tuple[Floats, Any, Any]:
    """The subsegments of curves, over which they turn by 60 degrees at most, cut into CHORDS parts each."""
    bent = np.isin(piece, list(outline.curves))
    rows, inner = np.flatnonzero(bent), CHORDS - 1
    t = span[rows, :1] + np.arange(1, CHORDS) / CHORDS * (span[rows, 1:] - span[rows, :1])
    new = outline.points_at(np.repeat(piece[rows], inner), t.ravel())
    number = len(points) + np.arange(len(new)).reshape(len(rows), inner)
    chain = np.column_stack([ends[rows, 0], number, ends[rows, 1]])
    chords = np.stack([chain[:, :-1], chain[:, 1:]], axis=2).reshape(-1, 2)
    return (
        np.concatenate([points, new]),
        np.concatenate([ends[~bent], chords]).astype(np.int32),
        np.concatenate([piece[~bent], np.repeat(piece[rows], CHORDS)]),
    )


def _of_polygons(polygons: list[list[Floats]]) -> Window:
    """The pieces of polygons, each an outline and holes, that may touch but not overlap."""
    if not polygons:
        raise InputError("the window has no polygon; give one with an area")
    corner, size, owner = [], [], []
    for i, rings in enumerate(polygons):
        of = f" of polygon {i}" if len(polygons) > 1 else ""
        names = [f"hole {k - 1}{of} of clip" if k else f"the outline{of} of clip" for k in range(len(rings))]
        cleaned = [_ring(ring, name) for ring, name in zip(rings, names)]
        whole = convex_corners(cleaned[0]) if len(rings) == 1 else None
        found = (whole, np.array([0, len(whole)])) if whole is not None else _divided(cleaned, names)
        corner.append(found[0])
        size.append(np.diff(found[1]))
        owner.append(np.full(len(size[-1]), i, dtype=np.int64))
    corners, start = np.concatenate(corner), np.concatenate([[0], np.cumsum(np.concatenate(size))])
    if len(polygons) > 1:
        both = first_overlap(corners, start, np.concatenate(owner))
        if both is not None:
            raise InputError(
                f"polygons {both[0]} and {both[1]} of clip overlap; unite them first (shapely's union_all)"
            )
    return Window(corners, start, False)


def _polygons(geometry: Any) -> Iterator[list[Floats]]:
    """The polygons of a GeoJSON geometry, each as its rings; heights are ignored."""
    geometry = getattr(geometry, "__geo_interface__", geometry)
    kind = geometry.get("type") if isinstance(geometry, Mapping) else None
    if kind in ("FeatureCollection", "GeometryCollection"):
        for part in geometry.get("features" if kind == "FeatureCollection" else "geometries") or ():
            yield from _polygons(part)
    elif kind == "Feature":
        if geometry.get("geometry") is not None:
            yield from _polygons(geometry["geometry"])
    elif kind in ("Polygon", "MultiPolygon", "LinearRing"):
        rows = geometry.get("coordinates") or ()
        nested = {"LinearRing": [[rows]], "Polygon": [rows], "MultiPolygon": rows}[kind]
        for polygon in nested:
            try:
                rings = [np.array([(x[0], x[1]) for x in ring], dtype=np.float64) for ring in polygon]
            except (TypeError, ValueError, IndexError, KeyError):
                raise InputError(f"a {kind} must have rings of positions (x, y)") from None
            if rings and len(rings[0]):
                yield rings
    else:
        raise InputError(f"a window needs polygons, not a geometry of type {kind!r}")
