"""Kernels: the sharpest triangles are made less sharp by flips, collapses, splits and moves near them."""

from __future__ import annotations

import numpy as np

from ...base.jit import kernel, lean
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.halfedges import SEAM_CURVES, first_corner, has_room, turned
from .flips import flip_if_better
from .lengths import collapse_checked, split_checked
from .moves import search_at
from .shapes import SPLITS_DONE, distance_squared, middle_distance, sharpness, wanted_squared

__all__ = ["mend_pass", "sharpest_pass", "thin_pass"]

VERY_SHARP = 0.03  # sharpness of ten degrees: triangles in sharp corners, mostly, that nothing helps
NOTABLY_LESS = 1.05  # moves that help them by less are not repeated
THIN_SHARE = 0.1  # of the wanted length: a shorter edge of very sharp triangles lies in a thin strip
AS_SHARP = 0.9  # of their sharpness is left at least when it is collapsed
LONGEST_NEW = 1.6  # edges that a collapse makes may have this length, in wanted ones


@lean
def _sharpness_of(work, t):
    s, ref = work.sheets, work.ref
    a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
    ref[0] = ref[1] = ref[2] = 0.0
    return sharpness(s.xyz[a], s.xyz, b, c, ref)


@lean
def _look_again(s, v, tried):
    """Triangles around a vertex have changed: what failed there may now help."""
    if s.at[v] < 0:
        return
    start = first_corner(s, v)
    c = start
    while True:
        tried[c // 3] = False
        c = turned(s.twin, c)
        if c < 0 or c == start:
            return


@lean
def _less_sharp(work, t, now):
    """Change something at a sharp triangle, if that helps."""
    s = work.sheets
    for e in range(3 * t, 3 * t + 3):
        if flip_if_better(work, e, False):
            return True
    short, least = 3 * t, np.inf
    for e in range(3 * t, 3 * t + 3):
        length = distance_squared(s.xyz, s.vertex[next_edge(e)], s.vertex[prev_edge(e)])
        if length < least:
            short, least = e, length
    if collapse_checked(work, short, now, LONGEST_NEW):
        return True
    changed = False
    for k in range(3):
        changed = search_at(work, s.vertex[3 * t + k]) or changed
    if changed and now < VERY_SHARP:
        return _sharpness_of(work, t) > NOTABLY_LESS * now
    return changed


@kernel
def sharpest_pass(work, start, stop, target, tried):
    """One sweep over triangles that are sharper than the target; how many changes there were.

    ``tried`` (m,) says where nothing has helped, and nothing has changed since.
    """
    s, done = work.sheets, 0
    for t in range(start, stop):
        if s.vertex[3 * t] == UNUSED or tried[t]:
            continue
        now = _sharpness_of(work, t)
        if now >= target:
            continue
        a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
        if _less_sharp(work, t, now):
            done += 1
            for v in (a, b, c):
                _look_again(s, v, tried)
        else:
            tried[t] = True
    return done


@kernel
def thin_pass(work, start, stop):
    """Collapse very short edges between very sharp triangles, which become hardly sharper; how many.

    A strip that is thinner than any size has room for no row of vertices, and each collapse for itself makes
    no triangle in it less sharp: that is why other passes leave them.
    """
    s, done = work.sheets, 0
    for e in range(start, stop):
        if s.vertex[e - e % 3] == UNUSED or s.twin[e] > e:
            continue
        u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
        if distance_squared(s.xyz, u, w) >= THIN_SHARE * THIN_SHARE * wanted_squared(s, u, w):
            continue
        now = _sharpness_of(work, e // 3)
        if s.twin[e] >= 0:
            now = max(now, _sharpness_of(work, s.twin[e] // 3))
        if now < VERY_SHARP:
            done += collapse_checked(work, e, AS_SHARP * now, LONGEST_NEW)
    return done


@kernel
def mend_pass(work, fault, kinds, most):
    """Split triangles with such faults, at edges that are too far, or long; where it stopped, or -1."""
    s, last = work.sheets, work.counts[SPLITS_DONE] + most
    for t in range(fault.shape[0]):
        if s.vertex[3 * t] == UNUSED or fault[t] & kinds == 0:
            continue
        if work.counts[SPLITS_DONE] >= last or not has_room(s, 1, 2):
            return t
        longest, most, worst = 3 * t, 0.0, 0.0
        for e in range(3 * t, 3 * t + 3):
            if s.curve[e] >= SEAM_CURVES:
                continue
            u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
            within = s.allowed[u] * s.allowed[u]
            away = middle_distance(work, u, w, s.curve[e], within)
            away = away if away > within else 0.0  # the edge that is too far, else the longest one
            length = distance_squared(s.xyz, u, w)
            if away > worst or (away == worst and length > most):
                longest, most, worst = e, length, away
        fault[t] = 0
        if most == 0.0:
            continue
        if s.twin[longest] >= 0 and s.twin[longest] // 3 < fault.shape[0]:
            fault[s.twin[longest] // 3] = 0  # it is halved, too
        split_checked(work, longest)
    return -1
