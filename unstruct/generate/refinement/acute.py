"""The ends of subsegments at which pieces meet at small angles; concentric shells are put around them."""

from __future__ import annotations

import numpy as np

from ...base.elementary import angle_of
from ...base.jit import lean
from ...connect.insertion.halfedges import next_edge, prev_edge
from .encroachment import FIRST, SECOND, STRAIGHT

__all__ = ["apexes"]

ANGLE_MARGIN = 1 - 1e-9  # so that the angles of an equilateral triangle are not small in spite of rounding
SMALL = ANGLE_MARGIN * np.pi / 3  # below this angle two straight pieces can split each other for ever
# While a curve is split, its chord at the apex turns toward its tangent there. A stretch of a curve turns by
# at most 60 degrees, so the chord of an arc turns by at most 30. Each curved side adds this to the limit,
# which is 90 degrees for one and 120 for two. A curve that turns most of all near the apex may turn its chord
# by more; if it then comes too close to its neighbor, the floors of `state.set_floors` end the splits.
CHORD_TURN = np.pi / 6


@lean
def apexes(plane, curve, result):
    """For each subsegment, which of its ends are apexes of a small angle within the domain, as a sum of bits.

    Parameters
    ----------
    plane : Plane
        Its triangles must have their regions.
    curve : ndarray of int8, shape (pieces,)
        STRAIGHT or another kind of piece.
    result : ndarray of uint8, shape (subsegments,)
        Receives FIRST, SECOND, both or 0.
    """
    xy, vertex, twin, mark = plane.xy, plane.vertex, plane.twin, plane.mark
    region, ends, piece, where = plane.region, plane.ends, plane.piece, plane.where
    for s in range(result.shape[0]):
        result[s] = 0
    for s in range(result.shape[0]):
        for side in range(2):
            e = np.int64(where[s]) if side == 0 else np.int64(twin[where[s]])
            if region[e // 3] < 0:
                continue
            # e runs from a to b, with its triangle on the left; turn about a to the next subsegment, a-c
            a, b = vertex[next_edge(e)], vertex[prev_edge(e)]
            other = prev_edge(e)
            while mark[other] < 0:
                other = prev_edge(np.int64(twin[other]))
            r, c = np.int64(mark[other]), vertex[next_edge(other)]
            if piece[r] == piece[s]:
                continue
            ux, uy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
            vx, vy = xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
            wedge = angle_of(ux * vy - uy * vx, ux * vx + uy * vy)
            curved = (curve[piece[r]] != STRAIGHT) + (curve[piece[s]] != STRAIGHT)
            if 0.0 <= wedge < SMALL + curved * CHORD_TURN:
                result[s] |= FIRST if ends[s, 0] == a else SECOND
                result[r] |= FIRST if ends[r, 0] == a else SECOND
