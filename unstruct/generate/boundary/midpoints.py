"""Compiled parts of boundary recovery: which subsegments are to be split, and splitting them.

Both work on the arrays of `PlanarComplex`, whose triangulation contains all subsegments as constrained edges.
If the far corners of the two triangles beside a subsegment are in each other's circles, the subsegment is in
no Delaunay triangulation of the vertices. If this is true of no subsegment, the triangulation *is* Delaunay.
So it suffices to look at the two triangles. The same holds for diametral circles: if a vertex is inside the
diametral circle of some subsegment, then the diametral circle of some subsegment contains the far corner of
a triangle beside it.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import lean
from ...connect.insertion.halfedges import GHOST, VERTICES, end_of, start_of
from ...connect.planar.cavity import blocked_by, commit_split, find_split
from ...predicates.diametral import in_disc
from ...predicates.kernels import incircle

__all__ = ["GABRIEL", "MISSING", "pick", "split_all"]

MISSING, GABRIEL = 0, 1  # the two tests for subsegments that are to be split


@lean
def pick(xy, vertex, twin, where, rows, test, chosen):
    """Write those of the subsegments ``rows`` that fail the test into ``chosen``; return how many."""
    count = 0
    for i in range(len(rows)):
        e = np.int64(where[rows[i]])
        a, b, c, d = start_of(vertex, e), end_of(vertex, e), vertex[e], vertex[twin[e]]
        ax, ay, bx, by = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1]
        fails = False
        if test == MISSING:
            if c != GHOST and d != GHOST:
                fails = incircle(ax, ay, bx, by, xy[c, 0], xy[c, 1], xy[d, 0], xy[d, 1]) > 0
        else:
            if c != GHOST:
                fails = in_disc(ax, ay, bx, by, xy[c, 0], xy[c, 1]) > 0
            if d != GHOST and not fails:
                fails = in_disc(ax, ay, bx, by, xy[d, 0], xy[d, 1]) > 0
        if fails:
            chosen[count] = rows[i]
            count += 1
    return count


@lean
def split_all(plane, scratch, rows, points, t, refused, seen, touched):
    """Split the subsegments ``rows`` at ``points`` (parameters ``t``), each with the next free vertex.

    ``refused[i]`` is set if a split would touch or cross something; then nothing is changed there. Each
    subsegment on a new triangle is written once into ``touched``; ``seen`` marks these. Returned is their
    number.
    """
    xy, mark = plane.xy, plane.mark
    count = 0
    for i in range(len(rows)):
        px, py = points[i, 0], points[i, 1]
        e = np.int64(plane.where[rows[i]])
        m, k, h = find_split(plane, scratch, e, px, py)
        refused[i] = m == 0 or k < 3 or blocked_by(xy, plane.vertex, scratch.rim, k, px, py) >= 0
        if refused[i]:
            continue
        p = plane.state[VERTICES]
        xy[p, 0], xy[p, 1] = px, py
        commit_split(plane, scratch, e, m, k, h, p, t[i])
        for j in range(k):
            for side in range(3):
                s = mark[3 * scratch.fresh[j] + side]
                if s >= 0 and not seen[s]:
                    seen[s] = True
                    touched[count] = s
                    count += 1
    return count
