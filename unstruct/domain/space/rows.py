"""The facets and inner pieces of a body as arguments: rows of vertices of any length, with holes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...geometry.polygons import Polygons

__all__ = ["as_polygons"]


def as_polygons(rows: Any, name: str, least: int) -> Polygons:
    """Polygons of vertices.

    Parameters
    ----------
    rows : array_like of int, shape (f, k); or a sequence
        Each item is a ring of vertices, or a sequence of rings: an outline and its holes.
    name : str
        Of the argument, for messages.
    least : int
        How many vertices a ring must have: 3, or 2 where segments are allowed.
    """
    if isinstance(rows, Polygons):
        _long_enough(rows, name, least)
        return rows
    if isinstance(rows, np.ndarray) and rows.dtype != object:
        return _of_array(rows, name, least)
    if not isinstance(rows, Sequence | np.ndarray):
        raise InputError(f"{name} must be rows of vertices, not {type(rows).__name__}")
    if len(rows) and all(isinstance(row, Sequence | np.ndarray) and np.ndim(row[0:1]) == 1 for row in rows):
        sizes = {len(row) for row in rows}
        if len(sizes) == 1:  # rows of one length, such as the triangles of a file
            return _of_array(_integers(rows, name), name, least)
    polygons = []
    for i, row in enumerate(rows):
        if not isinstance(row, Sequence | np.ndarray) or isinstance(row, str):
            raise InputError(f"{name}[{i}] must be a row of vertices, not {row!r}")
        nested = len(row) > 0 and isinstance(row[0], Sequence | np.ndarray)
        rings = [_integers(ring, f"{name}[{i}]") for ring in (row if nested else [row])]
        for ring in rings:
            if ring.ndim != 1:
                raise InputError(
                    f"{name}[{i}] must be a row of vertices, or rows for an outline and its holes"
                )
        polygons.append(rings)
    found = Polygons.of_rings(polygons)
    _long_enough(found, name, least)
    return found


def _of_array(rows: np.ndarray, name: str, least: int) -> Polygons:
    array = _integers(rows, name)
    if array.size == 0:
        return Polygons.of_rows(np.empty((0, least), dtype=np.int32))
    if array.ndim != 2:
        raise InputError(f"{name} must have shape (f, k): k vertices a facet, not {array.shape}")
    found = Polygons.of_rows(array)
    _long_enough(found, name, least)
    return found


def _integers(rows: Any, name: str) -> np.ndarray:
    if np.ma.isMaskedArray(rows) and np.ma.getmaskarray(rows).any():
        raise InputError(f"{name} has masked entries; drop masked rows first")
    try:
        array = np.asarray(rows)
    except ValueError:
        raise InputError(f"{name} must be a row of vertex numbers") from None
    if array.size == 0:
        return array.astype(np.int32)
    if array.dtype.kind not in "iu":
        raise InputError(f"{name} must be integers: numbers of points, not {array.dtype}")
    if not (-(2**31) <= array.min() <= array.max() < 2**31):
        raise InputError(f"{name} has entries beyond 32 bits: there are no such points")
    return array.astype(np.int32)


def _long_enough(polygons: Polygons, name: str, least: int) -> None:
    short = np.flatnonzero(np.diff(polygons.ring_start) < least)
    empty = np.flatnonzero(np.diff(polygons.first_ring) == 0)
    if len(empty):
        raise InputError(f"{name}[{empty[0]}] has no vertices; leave it out")
    if len(short):
        i = int(polygons.polygon_of_ring[short[0]])
        kind = "a facet needs three" if least == 3 else "a segment needs two"
        raise InputError(f"{name}[{i}] has {polygons.corners[i]} vertices; {kind}")
