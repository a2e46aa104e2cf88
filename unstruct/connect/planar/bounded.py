"""Segments, inside and parts in one kernel call, for input so short that calls cost more than the work."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE
from ...base.jit import kernel
from ...geometry.ordering import DRAWN_ONCE, draws
from .complex import PlanarComplex
from .filling import Filling
from .flood import flood, name_parts, rank_parts, relabel
from .inserting import PATIENCE, ordered
from .records import Plane
from .segments import carriers, fill_corners, insert_segments, mark_present

__all__ = ["AT_ONCE", "bound_at_once"]

AT_ONCE = DRAWN_ONCE  # segments, so that random numbers are there already and Ctrl-C need not wait


@kernel
def _insert(plane, draw):
    """Insert the segments of ``plane``, which become one edge each; False if any does not."""
    vertex, twin, mark, ends, where = plane.vertex, plane.twin, plane.mark, plane.ends, plane.where
    count, many = len(plane.region), len(ends)
    corner, missing = np.empty(len(plane.xy), dtype=np.int32), np.empty(many, dtype=np.bool_)
    fill_corners(vertex, 3 * count, corner)
    status, left, _ = mark_present(vertex, twin, mark, corner, ends, where, missing)
    if status != DONE or left == 0:
        return status == DONE
    bits, size = 2, count
    while size > 0:
        bits, size = bits + 1, size >> 1
    order = ordered(missing, left, ends, corner, draw[:left], bits)
    filling = Filling(
        plane.xy, vertex, twin, mark, corner, where, np.empty(count + 2, dtype=np.int64),
        np.empty(count + 2, dtype=np.int64), np.empty(count + 2, dtype=np.int64),
        np.empty((8, count + 3), dtype=np.int64), np.empty((count + 3, 3), dtype=np.int64),
        np.empty(8 * count + 8, dtype=np.int32),
    )  # fmt: skip
    crossed = np.empty(many, dtype=np.int64)
    status, _, _ = insert_segments(filling, ends, order, crossed, PATIENCE)
    return status == DONE and carriers(vertex, mark, 3 * count, ends, where) == 2 * many


@kernel
def _bound(triangles, subsegments, state, facets, hull, draw):
    """Insert the segments, flood the inside, number its parts; return how many there are, 0 if this fails."""
    xy, vertex, twin, mark, region = triangles
    where, ends, piece, span = subsegments
    plane = Plane(xy, vertex, twin, mark, region, where, ends, piece, span, state)
    if not _insert(plane, draw):
        return 0
    count = len(region)
    least = np.empty(count, dtype=np.int32)
    odd, parts = flood(plane, facets, hull, region, np.empty(3 * count + 3, dtype=np.int32), least)
    if odd >= 0:
        return 0
    if parts > 1:
        number = np.empty(parts, dtype=np.int32)
        rank_parts(least, number)
        relabel(region, number)
    return parts


def bound_at_once(
    complex_: PlanarComplex,
    subsegments: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]],
    facets: int,
    regions: dict[str, NDArray],
    hull: bool,
) -> bool:
    """`insert_all` and `mark_regions` for a complex without segments, unless something is special.

    Parameters
    ----------
    complex_ : PlanarComplex
    subsegments : tuple of ndarray
        Ends, pieces and spans, at most `AT_ONCE` of each.
    facets : int
        How many pieces are facets.
    regions : dict of str to ndarray
    hull : bool
        Whether everything within the convex hull is inside.

    Returns
    -------
    bool
        False if a segment is divided by a vertex on it, or if there is an error to be reported. The complex
        is then of no use.
    """
    ends, piece, span = subsegments
    many, c = len(ends), complex_
    ends, piece, span = ends.copy(), piece.copy(), span.copy()  # those of a `Domain` are read-only
    c.take_subsegments(ends, piece, span, np.empty(many, dtype=np.int32))
    parts = _bound(
        (c.xy, c.vertex, c.twin, c.mark, c.region), (c.where, ends, piece, span), c.state,
        facets, hull, draws(many, 2**32),
    )  # fmt: skip
    if parts and regions:
        name_parts(c, regions, np.arange(parts, dtype=np.int32))
    return parts > 0
