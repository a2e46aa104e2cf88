"""Kernels: long edges are split, short ones collapsed.

An edge is split only if it is the longest one of both its triangles; else a longer one is first. So the
smallest angle of a triangle is at least about half of what it was, as by M.-C. Rivara's bisection (1984).
"""

from __future__ import annotations

from ...base.jit import kernel, lean
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.halfedges import (
    SEAM_CURVES,
    SMOOTH,
    SURFACE_SLOTS,
    can_collapse,
    collapse_edge,
    first_corner,
    has_room,
    split_edge,
    turned,
)
from ...geometry.triangle_tree import onto
from .flips import flip_if_better
from .shapes import (
    COLLAPSES,
    SPLITS_DONE,
    TOO_FAR,
    TURNED,
    add_normal,
    distance_squared,
    middle_distance,
    nearest_facing,
    settle,
    sharpness,
    star_least,
    star_normal,
    wanted_squared,
)

__all__ = ["LONG_SHARE", "collapse_checked", "collapse_pass", "split_checked", "split_pass"]

LONG_SHARE, SHORT_SHARE = 4.0 / 3.0, 4.0 / 5.0
WORST_COLLAPSED = 0.03  # sharpness of ten degrees: triangles around a collapsed edge may become as sharp
NEARLY_LONGEST = 1.0 + 1e-9
STILL_SHORTER = 0.9  # of the square of the length of an edge: edges at its new vertex are no longer


@lean
def _longest_near(s, e):
    """From edge e over longer and longer ones to one that is the longest of its triangles.

    -1 if an edge is longer that must not be split: beside it splits would never end, for the two other sides
    of a triangle are together at least as long.
    """
    while True:
        best, length = (
            e,
            NEARLY_LONGEST * distance_squared(s.xyz, s.vertex[next_edge(e)], s.vertex[prev_edge(e)]),
        )
        side = e
        for _ in range(2):
            if side < 0:
                break
            for g in (next_edge(side), prev_edge(side)):
                other = distance_squared(s.xyz, s.vertex[next_edge(g)], s.vertex[prev_edge(g)])
                if other > length:
                    if s.curve[g] >= SEAM_CURVES:
                        return -1
                    best, length = g, NEARLY_LONGEST * other
            side = s.twin[e]
        if best == e:
            return e
        e = best


@lean
def _shortens(s, m, p, limit):
    """Whether edges at a new vertex would be short enough at p, or no longer than they are.

    ``limit`` is a part of the square of the length of the edge that was split.
    """
    start = first_corner(s, m)
    c = start
    while True:
        for a in (s.vertex[next_edge(c)], s.vertex[prev_edge(c)]):
            square = 0.0
            for k in range(3):
                square += (s.xyz[a, k] - p[k]) ** 2
            if square > limit and square > distance_squared(s.xyz, a, m):
                return False
        c = turned(s.twin, c)
        if c < 0 or c == start:
            return True


@lean
def split_checked(work, e):
    """Split an edge in its middle, which is moved onto the surface unless a triangle would turn over.

    Nor is it moved where an edge would not become shorter: where a surface crosses itself, or has another
    sheet nearby, the nearest point may be an end of the edge, and splits would never end.
    """
    s = work.sheets
    limit = STILL_SHORTER * distance_squared(s.xyz, s.vertex[next_edge(e)], s.vertex[prev_edge(e)])
    m = split_edge(s, e)
    p = work.x[0]
    for k in range(3):
        p[k] = s.xyz[m, k]
    star_normal(s, m, work.ref)
    t = settle(work, m, s.kind[m], s.near[m])
    if not _shortens(s, m, p, limit):
        work.counts[TOO_FAR] += 1
    elif star_least(s, m, p, work.ref, 0.0) >= 0.0:
        for k in range(3):
            s.xyz[m, k] = p[k]
    else:
        work.counts[TURNED] += 1
    s.near[m] = t
    work.counts[SPLITS_DONE] += 1
    return m


@lean
def _flip_around(work, m):
    """Flip edges opposite a new vertex where triangles become less sharp."""
    s = work.sheets
    start = first_corner(s, m)
    c, count = start, 0
    while count < 16:
        count += 1
        if not flip_if_better(work, c, False):
            c = turned(s.twin, c)
            if c < 0 or c == first_corner(s, m):
                return


@kernel
def split_pass(work, start, most):
    """Split edges of more than 4/3 of the wanted length, at most so many; where it stopped, or -1."""
    s = work.sheets
    e, last = start, work.counts[SPLITS_DONE] + most
    while e < 3 * s.state[SURFACE_SLOTS]:
        if s.vertex[e - e % 3] == UNUSED or s.twin[e] > e or s.curve[e] >= SEAM_CURVES:
            e += 1
            continue
        while True:
            u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
            if distance_squared(s.xyz, u, w) <= LONG_SHARE * LONG_SHARE * wanted_squared(s, u, w):
                break
            if work.counts[SPLITS_DONE] >= last or not has_room(s, 1, 2):
                return e
            longest = _longest_near(s, e)
            if longest < 0:
                break
            _flip_around(work, split_checked(work, longest))
        e += 1
    return -1


# ---------------------------------------------------------------------- collapses


@lean
def _collapsed_least(work, e, longest):
    """The least sharpness around u once it is merged into w; -1 if it may not be.

    New edges may be as long as ``longest`` times the wanted length, or as long as those of u now.
    """
    s = work.sheets
    u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
    ref, p = work.ref, work.x[1]
    for k in range(3):
        p[k] = s.xyz[w, k]
    smooth = s.kind[u] == SMOOTH
    if smooth:
        star_normal(s, u, ref)
    least = 1.0
    start = first_corner(s, u)
    c = start
    while True:
        a, b = s.vertex[next_edge(c)], s.vertex[prev_edge(c)]
        if a != w:
            length = distance_squared(s.xyz, a, w)
            if length > longest * longest * wanted_squared(s, a, w) and length > distance_squared(
                s.xyz, a, u
            ):
                return -1.0
            if b != w:
                if not smooth:
                    ref[0] = ref[1] = ref[2] = 0.0
                    add_normal(s.xyz, u, a, b, ref)
                least = min(least, sharpness(p, s.xyz, a, b, ref))
                if least <= 0.0:
                    return -1.0
        c = turned(s.twin, c)
        if c < 0 or c == start:
            return least


@lean
def _stays_near(work, e):
    """Whether the triangles around u, merged into w, are near the given surface, and u near them."""
    s, held, x = work.sheets, work.held, work.x
    u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
    p, q = s.vertex[e], s.vertex[s.twin[e]] if s.twin[e] >= 0 else -1
    allowed = min(s.allowed[u], s.allowed[w])
    within = work.slack * allowed * allowed
    reached = False
    start = first_corner(s, u)
    c, guess = start, s.near[u]
    while True:
        a, b = s.vertex[next_edge(c)], s.vertex[prev_edge(c)]
        curve = s.curve[prev_edge(c)]
        if a != w and a != p and a != q and middle_distance(work, w, a, curve, within) > within:
            return False
        if a != w and b != w:
            for k in range(3):
                x[0, k] = (s.xyz[w, k] + s.xyz[a, k] + s.xyz[b, k]) / 3.0
            work.ref[0] = work.ref[1] = work.ref[2] = 0.0
            add_normal(s.xyz, w, a, b, work.ref)
            guess, square = nearest_facing(work, work.ref, guess, within)
            if square > within:
                return False
            facing = 0.0
            for k in range(3):
                facing += work.ref[k] * held.normals[guess, k]
            if facing < 0.0:
                return False
            if not reached:
                for k in range(3):
                    x[1, k], x[2, k], x[3, k] = s.xyz[w, k], s.xyz[a, k], s.xyz[b, k]
                reached = onto(s.xyz[u], x[1:4], work.place) <= within
        c = turned(s.twin, c)
        if c < 0 or c == start:
            return reached


@lean
def collapse_checked(work, e, floor, longest):
    """Merge one end of edge e into the other, where triangles around are less sharp; whether it was done.

    The triangles must not become sharper than the floor, and not leave the given surface.
    """
    s = work.sheets
    best, found = floor, -1
    if can_collapse(s, e):
        least = _collapsed_least(work, e, longest)
        if least > best:
            best, found = least, e
    f = s.twin[e]
    if f >= 0 and can_collapse(s, f):
        least = _collapsed_least(work, f, longest)
        if least > best:
            found = f
    if found < 0:
        return False
    if not _stays_near(work, found):
        work.counts[TOO_FAR] += 1
        return False
    collapse_edge(s, found)
    work.counts[COLLAPSES] += 1
    return True


@kernel
def collapse_pass(work, start, stop):
    """Collapse edges of less than 4/5 of the wanted length."""
    s, done = work.sheets, 0
    for e in range(start, stop):
        if s.vertex[e - e % 3] == UNUSED or s.twin[e] > e:
            continue
        u, w = s.vertex[next_edge(e)], s.vertex[prev_edge(e)]
        if distance_squared(s.xyz, u, w) < SHORT_SHARE * SHORT_SHARE * wanted_squared(s, u, w):
            done += collapse_checked(work, e, WORST_COLLAPSED, LONG_SHARE)
    return done
