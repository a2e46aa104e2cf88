"""What keeps refinement for the angle from filling narrow places with triangles, compiled.

A gap of width w and length L needs about L / w splits on both sides if all angles are to be good. This is in
order where the gap is short. In a long and very narrow one it is millions of triangles that nobody asked for.
In a narrow wedge, moreover, most of the new triangles lie across its small angle and miss the limit anyway.
So a piece has a number of splits for the angle's sake, and a smaller one of those that a neighbor in a wedge
makes necessary. They grow with the number of subsegments that the input or the size makes. When they are
spent, the subsegments of the piece are locked, and the triangles that would need them say so.
"""

from __future__ import annotations

import math

import numpy as np

from ...base.jit import inline, lean
from .encroachment import encroaches
from .state import SPLITS_EACH, WEDGE_EACH


@lean
def charge(w, limits, s, thin):
    """Take a split of subsegment s off what is allowed to its piece, or add to that if size is the reason.

    It counts twice if it is due to a vertex on a piece that meets this one at an end: within a wedge most of
    the triangles that it leads to lie across the small angle, and are left alone.
    """
    k = np.int64(w.piece[s])
    if not thin:
        w.allowed[k, 0] += WEDGE_EACH
        w.allowed[k, 1] += SPLITS_EACH
        return
    w.allowed[k, 1] -= 1
    a, b = w.ends[s, 0], w.ends[s, 1]
    for side in range(2):
        o = np.int64(w.where[s]) if side == 0 else np.int64(w.twin[w.where[s]])
        p = w.vertex[o]
        if w.region[o // 3] < 0 or w.kind[p] < 0 or w.kind[p] == k:
            continue
        q = w.kind[p]
        meet = False
        for i in range(2):
            v = w.joints[k, i]
            meet = meet or (v >= 0 and (v == w.joints[q, 0] or v == w.joints[q, 1]))
        if meet and encroaches(
            w.xy[a, 0], w.xy[a, 1], w.xy[b, 0], w.xy[b, 1], w.xy[p, 0], w.xy[p, 1], limits.lens
        ):
            w.allowed[k, 0] -= 1
            return


@inline
def grown_floor(limits, floor, square):
    """The floor of a new point: beyond the plausible angles it grows with each step outward."""
    if limits.growth > 0.0:
        far = math.sqrt(floor) + limits.growth * math.sqrt(square)
        return far * far
    return floor
