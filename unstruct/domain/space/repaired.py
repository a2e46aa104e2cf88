"""A surface after its repair: the arrays of a `Domain`, and the account of what was done."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...base.arrays import counted_off, frozen
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ..plane.repaired import PARTS, Repaired
from .closing import turn_outward
from .faults import find_faults, first_copies
from .repair import NAMES_SHOWN, SpaceRepairer

__all__ = ["repaired_in_space"]


def repaired_in_space(outline: Outline) -> Repaired:
    """Repair a surface as far as possible: see `Domain`, ``resolve``."""
    # A copy, because an outline keeps what it has computed of its pieces, and these are going to change.
    outline = Outline(*(getattr(outline, name) for name in PARTS))
    mended = SpaceRepairer(outline)
    # equal points are a fault; those of each corner of each facet would take long to describe
    if (first_copies(outline.points) < np.arange(len(outline.points))).any() or find_faults(outline):
        mended.run()
    else:
        turn_outward(mended)
    if not mended.repairs:
        n, many = len(outline.points), len(outline.pieces)
        origin, pieces = counted_off(n), counted_off(many)
        return Repaired(
            outline.points, outline.facets, outline.inner, {}, outline.markers, origin, pieces, []
        )
    points, origin, polygons = _compressed(mended)
    rows, facets = np.arange(len(polygons)), int(mended.facet.sum())
    facet_rows: Any = polygons.select(rows[:facets])
    whole = facet_rows.triangles
    markers = {}
    for name in outline.markers:
        having = [k for k, names in enumerate(mended.sets) if name in names]
        markers[name] = frozen(np.flatnonzero(np.isin(mended.label, having)).astype(np.int32))
    return Repaired(
        frozen(points),
        facet_rows if whole is None else frozen(whole.copy()),
        polygons.select(rows[facets:]),
        {},
        markers,
        frozen(origin.astype(np.int32)),
        frozen(mended.piece.astype(np.int32)),
        mended.repairs,
    )


def _compressed(mended: SpaceRepairer) -> tuple[np.ndarray, np.ndarray, Polygons]:
    """Without copies of points, and without vertices whose pieces have all gone; these are accounted for."""
    bare = mended.used & ~mended.gone
    bare[mended.polygons.vertices] = False
    alone = np.flatnonzero(bare[: mended.given])
    if len(alone) > NAMES_SHOWN:
        text = f"{len(alone)} points, such as point {alone[0]}, are not on any piece that is left; dropped"
        where = tuple(map(float, mended.points[alone[0]]))
        mended.account("vertex without pieces", text, where, at=alone)
        alone = alone[:0]
    for vertex in alone.tolist():
        text = f"point {vertex} is not on any piece that is left; it was dropped"
        where = tuple(map(float, mended.points[vertex]))
        mended.account("vertex without pieces", text, where, at=[vertex])
    keep = ~(bare | mended.gone)
    number = (np.cumsum(keep) - 1).astype(np.int32)
    origin = np.arange(len(keep))
    origin[mended.given :] = -1
    return mended.points[keep], origin[keep], mended.polygons.renumbered(number)
