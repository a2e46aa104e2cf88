"""Compiled parts of boundary recovery: which subsegments are to be split, and splitting them.

Both work on the arrays of `PlanarComplex`, whose triangulation holds all subsegments by constraint. There
a subsegment with the far corners of its two triangles in each other's circles is in no Delaunay
triangulation of the vertices; and when no subsegment is like that, the triangulation *is* Delaunay. So the
triangles on both sides tell all that is needed. With diametral circles it is the same: if a vertex is in
that of some subsegment, then the corner of a triangle is in that of its own.
"""

from __future__ import annotations

import numpy as np

from ...base.jit import lean
from ...connect.insertion.halfedges import GHOST, VERTICES, end_of, start_of
from ...connect.planar.cavity import blocked_by, commit_split, find_split
from ...predicates.diametral import in_disc
from ...predicates.kernels import incircle

__all__ = ["GABRIEL", "MISSING", "pick", "split_all"]

MISSING, GABRIEL = 0, 1  # what makes a subsegment be split


@lean
def pick(xy, vertex, twin, where, rows, test, chosen):
    """Those of the subsegments ``rows`` that fail the test, into ``chosen``; how many."""
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

    ``refused[i]`` where a split would touch or cross something; nothing has changed there. ``touched`` gets
    each subsegment that lies on a new triangle once (``seen`` tells which); returned is their number.
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
