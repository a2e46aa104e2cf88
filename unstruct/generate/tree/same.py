"""Whether two domains are the same, by what they are made of: trees over different ones do not go together.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...domain.domain import Domain
from ...domain.plane.sample import SAMPLES
from ...geometry.polygons import Polygons

__all__ = ["same_domain"]


def same_domain(one: Domain | None, other: Domain | None) -> bool:
    """Whether vertices, pieces, names and curves are equal; curves are compared at eleven places each.

    O(n) for n vertices and pieces, but O(1) if the two are one object.
    """
    if one is other:
        return True
    if one is None or other is None:
        return False
    if one.dimension != other.dimension or one.curves.keys() != other.curves.keys():
        return False
    if not np.array_equal(one.points, other.points) or len(one.facets) != len(other.facets):
        return False
    if not _equal_rows(one.pieces, other.pieces) or not _equal_names(one.markers, other.markers):
        return False
    if not _equal_names(one.regions, other.regions):
        return False
    curved = np.repeat(np.array(list(one.curves), dtype=np.int64), len(SAMPLES))
    if not len(curved):
        return True
    t = np.tile(SAMPLES, len(one.curves))
    return bool(np.array_equal(one.points_at(curved, t), other.points_at(curved, t)))


def _equal_rows(one: Any, other: Any) -> bool:
    """Pieces are rows of an array, or polygons."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return bool(np.array_equal(one, other))
    one, other = Polygons.of(one), Polygons.of(other)
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in ("vertices", "ring_start", "first_ring")
    )


def _equal_names(one: Any, other: Any) -> bool:
    return one.keys() == other.keys() and all(np.array_equal(one[name], other[name]) for name in one)
