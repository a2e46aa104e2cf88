"""Points of a surface that nearly coincide, as in many STL files: what says so, and merging them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import positive
from ...base.errors import InputError
from ...geometry.boxes import BoxTree
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ..arguments import composed
from ..plane.account import Repair
from ..plane.faults import Fault
from .surfaces import Found
from .tangled import cleaned

__all__ = ["merging", "welded", "with_hint"]

HINTED = ("crossing", "open boundary", "overlap", "vertex on a facet", "vertex on an edge")
NEARLY_EQUAL = 1e-5  # of the extent: points of faults that are closer are named
MOST_MERGED = 1e-2  # of the extent: a larger tolerance would merge parts of the shape
CHAIN = 2.0  # a point may move by so many tolerances, to the first of points that follow each other


def merging(value: Any) -> float | None:
    """The argument ``merge``, checked."""
    return None if value is None else positive(value, "merge")


def _close(points: np.ndarray, rows: np.ndarray, most: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of points i < j not farther apart, of which one is among these rows; their distances."""
    x = points[rows]
    at, other = BoxTree(points, points).pairs(x - most, x + most)
    one = rows[at]
    low, high = np.minimum(one, other), np.maximum(one, other)
    pairs = np.unique(np.column_stack([low, high])[low < high], axis=0)
    step = points[pairs[:, 0]] - points[pairs[:, 1]]
    apart = np.sqrt((step * step).sum(axis=1))
    near = apart <= most
    return pairs[near, 0], pairs[near, 1], apart[near]


def with_hint(outline: Outline, faults: list[Fault]) -> list[Fault]:
    """The faults; the first one says which points of its pieces nearly coincide with others, if any do."""
    if not faults or faults[0].kind not in HINTED:
        return faults
    polygons: Any = outline.pieces
    factor = 1.0 / max(_extent(outline.points), np.finfo(float).tiny)
    rows = np.unique(np.concatenate([polygons.vertices_of(i) for i in faults[0].pieces]))
    points = (outline.points - outline.points[0]) * factor
    if len(rows) == 0 or not np.isfinite(points).all():
        return faults
    one, two, apart = _close(points, rows, NEARLY_EQUAL)
    if len(one) == 0 or apart.min() == 0.0:
        return faults
    k = int(apart.argmin())
    tolerance = 10.0 ** np.ceil(np.log10(2 * apart.max() / factor))
    text = (
        f"{faults[0].text}. Points {one[k]} and {two[k]} are only {apart[k] / factor:.2g} apart: if they are "
        f"meant to be the same, merge={tolerance:g} of Domain.read or Domain.surface makes them one"
    )
    return [replace(faults[0], text=text), *faults[1:]]


def _extent(points: np.ndarray) -> float:
    return float((points.max(axis=0) - points.min(axis=0)).max()) if len(points) else 0.0


def welded(found: Found, tolerance: float | None) -> Found:
    """What a file or a mesh has of a body, with points that nearly coincide merged.

    Parameters
    ----------
    found : Found
    tolerance : float or None
        Points that are not farther apart become one, the first of them, also over others in between; with
        None nothing is merged.

    Returns
    -------
    Found
        Facets and inner pieces that have lost their area or length are dropped. ``repairs`` says how many.

    Raises
    ------
    InputError
        If the tolerance is more than a hundredth of the extent, or points would move by twice as much.
    """
    if tolerance is None:
        return found
    points = np.ascontiguousarray(found.parts["points"], dtype=np.float64)
    extent = _extent(points)
    if tolerance > MOST_MERGED * extent:
        raise InputError(
            f"merge = {tolerance:g} is more than a hundredth of the extent of the points, {extent:g}: it "
            "would merge parts of the shape; give a smaller one"
        )
    one, two, _ = _close(points, np.arange(len(points)), tolerance)
    if len(one) == 0:
        return found
    first = _first_of_chains(len(points), one, two)
    step = points - points[first]
    moved = np.sqrt((step * step).sum(axis=1))
    far = int(moved.argmax())
    if moved[far] > CHAIN * tolerance:
        raise InputError(
            f"points {first[far]} and {far}, which are {moved[far]:.2g} apart, would be merged over others "
            f"between them: give a smaller merge than {tolerance:g}"
        )
    facets = Polygons.of(found.parts["facets"])
    inner = found.parts.get("inner")
    every = facets if inner is None else Polygons.joined(facets, Polygons.of(inner))
    every, kept = _without_lost(every.renumbered(first.astype(np.int32)))
    used = first == np.arange(len(points))
    number = (np.cumsum(used) - 1).astype(np.int32)
    every = every.renumbered(number)
    many = int((kept < len(facets)).sum())
    place = np.full(len(facets) + (0 if inner is None else len(Polygons.of(inner))), -1)
    place[kept] = np.arange(len(kept))
    lost = len(place) - len(kept)
    parts = dict(found.parts, points=points[used], facets=every.select(np.arange(many)))
    if inner is not None:
        parts["inner"] = every.select(np.arange(many, len(kept)))
    parts["markers"] = {
        name: rows[rows >= 0]
        for name, rows in (
            (name, place[np.asarray(given, dtype=np.int64)])
            for name, given in found.parts.get("markers", {}).items()
        )
    }
    text = (
        f"merged {int((~used).sum())} points with others at most {tolerance:g} away (by up to "
        f"{moved.max():.2g})"
    ) + (f"; {lost} pieces without area were dropped" if lost else "")
    where = tuple(map(float, points[int(np.flatnonzero(~used)[0])]))
    origin = np.arange(len(points)) if found.origin is None else found.origin
    pieces = np.arange(len(place)) if found.piece_origin is None else found.piece_origin
    return found._replace(
        parts=parts,
        origin=composed(origin, np.flatnonzero(used)),
        piece_origin=composed(pieces, kept),
        repairs=(*found.repairs, Repair("close points", text, where)),
    )


def _first_of_chains(n: int, one: np.ndarray, two: np.ndarray) -> NDArray[np.int64]:
    """For each of n points the lowest number of those that pairs connect with it."""
    label = np.arange(n)
    while True:
        before = label.copy()
        least = np.minimum(label[one], label[two])
        np.minimum.at(label, one, least)
        np.minimum.at(label, two, least)
        label = label[label]
        if (label == before).all():
            return label


def _without_lost(polygons: Polygons) -> tuple[Polygons, NDArray[np.int64]]:
    """Polygons without vertices that follow themselves, without spikes; the numbers of those left."""
    owner = np.repeat(np.arange(len(polygons)), polygons.corners)
    key = np.sort((owner << 32) | polygons.vertices)
    twice = np.unique(key[1:][key[1:] == key[:-1]] >> 32)
    keep = np.ones(len(polygons), dtype=bool)
    keep[twice] = False
    rings: list[Any] = []
    mended: list[int] = []
    for i in twice.tolist():
        least = min(3, int(polygons.corners[i]))
        left = [ring for ring in (cleaned(r.tolist()) for r in polygons.rings(i)) if len(ring) >= least]
        if left and len(left[0]) >= least:
            rings.append(left)
            mended.append(i)
    number = np.concatenate([np.flatnonzero(keep), np.array(mended, dtype=np.int64)])
    every = Polygons.joined(polygons.select(np.flatnonzero(keep)), Polygons.of_rings(rings))
    order = np.argsort(number, kind="stable")
    return every.select(order), number[order]
