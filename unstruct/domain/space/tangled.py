"""Rings of vertices with faults: repeated vertices, spikes, rings that touch themselves or have no area."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...geometry.outline import Outline
from ...geometry.polygons import Polygons
from ...geometry.triangle_pairs import clear_view
from ..plane.repaired import repaired
from .cutting import views
from .flat import NO_ENDS, sides_of, triangulated

__all__ = ["cleaned", "untangled", "without_area"]


def cleaned(ring: Sequence[int]) -> list[int]:
    """A ring without vertices that follow themselves, and without spikes (there and back)."""
    kept: list[int] = []
    for v in ring:
        if kept and kept[-1] == v:
            continue
        if len(kept) > 1 and kept[-2] == v:
            kept.pop()
        else:
            kept.append(v)
    first, last = 0, len(kept)  # the same where the ring begins
    while last - first > 1 and kept[first] == kept[last - 1]:
        last -= 1
        if last - first > 2 and kept[first + 1] == kept[last - 1]:
            first += 1
    while last - first > 2 and kept[first + 1] == kept[last - 1]:
        first, last = first + 1, last - 1
    while last - first > 2 and kept[first] == kept[last - 2]:
        last -= 2
    return kept[first:last]


def without_area(xyz: np.ndarray, vertices: np.ndarray) -> bool:
    """Whether all vertices lie on a line, exactly."""
    first, *rest = np.unique(vertices).tolist()
    return not rest or all(clear_view(xyz, first, rest[0], v) < 0 for v in rest[1:])


def untangled(xyz: np.ndarray, rings: Sequence[Any]) -> NDArray[np.int32] | None:
    """The triangles inside of rings that touch themselves or each other, in the direction of the whole.

    Sides are split at vertices on them, and sides that are there twice cancel. None if sides cross, which
    would need new vertices.
    """
    polygon = Polygons.of_rings([[np.asarray(ring) for ring in rings]])
    normals, seen = views(xyz, polygon)
    view = int(seen[0])
    axes = [view // 3, view % 3]
    sides = sides_of(polygon.rings(0))
    found, wrong = triangulated(xyz, sides, view)
    if wrong is not None:
        number, at = np.unique(sides, return_inverse=True)
        flat = np.ascontiguousarray(xyz[number][:, axes])
        ends = at.reshape(-1, 2).astype(np.int32)
        try:
            mended = repaired(Outline(flat, ends, NO_ENDS, {}, {}, {}))
        except InputError:  # no area is left
            return found if without_area(xyz, number) else None
        kinds = {repair.kind for repair in mended.repairs}
        if (mended.origin < 0).any() or "duplicate points" in kinds or len(mended.inner):
            return None
        found, wrong = triangulated(xyz, number[mended.origin[mended.facets]], view)
    if wrong is not None:
        return None
    return found if normals[0, 3 - sum(axes)] >= 0 else found[:, ::-1]
