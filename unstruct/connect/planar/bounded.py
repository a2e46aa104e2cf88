"""Segments, inside and parts in one kernel call, for input so short that calls cost more than the work."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.codes import DONE
from ...base.jit import kernel
from ...geometry.ordering import DRAWN_ONCE, draws
from .complex import PlanarComplex
from .filling import Filling
from .flood import flood, number_parts
from .inserting import PATIENCE, ordered
from .records import Plane
from .segments import carriers, fill_corners, insert_segments, mark_present

__all__ = ["SEGMENTS_AT_ONCE", "bound_at_once"]

SEGMENTS_AT_ONCE = DRAWN_ONCE  # segments, so that random numbers are there already and Ctrl-C need not wait


@kernel
def _bound(triangles, subsegments, state, facets, hull, rows):
    """Mark the segments that are edges; if all are, flood: return how many are not, and how many parts.

    Both are 0 if this fails. ``rows`` are scratch: a half-edge of each vertex, whether each segment is
    missing, the stack of `flood`, and what it calls ``least``.
    """
    corner, missing, stack, least = rows
    plane = Plane(*triangles, *subsegments, state)
    fill_corners(plane.vertex, len(plane.vertex), corner)
    status, left, _ = mark_present(
        plane.vertex, plane.twin, plane.mark, corner, plane.ends, plane.where, missing
    )
    if status != DONE or left > 0:
        return (left if status == DONE else 0), 0
    odd, parts = flood(plane, facets, hull, plane.region, stack, least)
    return 0, (parts if odd < 0 else 0)


@kernel
def _bound_missing(triangles, subsegments, state, facets, hull, rows, draw):
    """Insert the segments that are missing, one edge each, and flood: return how many parts, 0 if this fails.

    This is a kernel by itself, so that it need not be compiled for input whose segments are all there.
    """
    corner, missing, stack, least = rows
    plane = Plane(*triangles, *subsegments, state)
    count, many = len(plane.region), len(missing)
    bits, size = 2, count
    while size > 0:
        bits, size = bits + 1, size >> 1
    order = ordered(missing, len(draw), plane.ends, corner, draw, bits)
    filling = Filling(
        plane.xy, plane.vertex, plane.twin, plane.mark, corner, plane.where,
        np.empty(count + 2, dtype=np.int64), np.empty(count + 2, dtype=np.int64),
        np.empty(count + 2, dtype=np.int64), np.empty((8, count + 3), dtype=np.int64),
        np.empty((count + 3, 3), dtype=np.int64), np.empty(8 * count + 8, dtype=np.int32),
    )  # fmt: skip
    crossed = np.empty(many, dtype=np.int64)
    status, _, _ = insert_segments(filling, plane.ends, order, crossed, PATIENCE)
    if status != DONE or carriers(plane.vertex, plane.mark, 3 * count, plane.ends, plane.where) != 2 * many:
        return 0
    odd, parts = flood(plane, facets, hull, plane.region, stack, least)
    return parts if odd < 0 else 0


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
        Ends, pieces and spans, at most `SEGMENTS_AT_ONCE` of each.
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
    triangles, rows = (c.xy, c.vertex, c.twin, c.mark, c.region), (c.where, ends, piece, span)
    count = len(c.region)
    least = np.empty(count, dtype=np.int32)
    scratch = (
        np.empty(len(c.xy), dtype=np.int32), np.empty(many, dtype=np.bool_),
        np.empty(3 * count + 3, dtype=np.int32), least,
    )  # fmt: skip
    left, parts = _bound(triangles, rows, c.state, facets, hull, scratch)
    if left:
        parts = _bound_missing(triangles, rows, c.state, facets, hull, scratch, draws(left, 2**32))
    if parts:
        number_parts(c, regions, parts, least)
    return parts > 0
