"""Kernels: the sharpest triangles are made less sharp by flips, collapses, splits and moves near them."""

from __future__ import annotations

from ...base.jit import kernel, lean
from ...connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from ...connect.surface.halfedges import SURFACE_SLOTS, has_room, split_edge
from .flips import flip_if_better
from .lengths import collapse_checked
from .moves import search_at
from .shapes import add_normal, distance_squared, sharpness

__all__ = ["sharpest_pass"]

LONGEST_NEW = 1.6  # edges that a collapse makes may have this length, in wanted ones


@lean
def _sharpness_of(work, t):
    s, ref = work.sheets, work.ref
    a, b, c = s.vertex[3 * t], s.vertex[3 * t + 1], s.vertex[3 * t + 2]
    ref[0] = ref[1] = ref[2] = 0.0
    return sharpness(s.xyz[a], s.xyz, b, c, ref)


@kernel
def sharpest_pass(work, target):
    """One sweep over triangles that are sharper than the target; how many changes there were."""
    s, done = work.sheets, 0
    for t in range(s.state[SURFACE_SLOTS]):
        if s.vertex[3 * t] == UNUSED:
            continue
        now = _sharpness_of(work, t)
        if now >= target:
            continue
        changed = False
        for k in range(3):
            if flip_if_better(work, 3 * t + k, False):
                changed = True
                break
        if not changed:
            short = 3 * t
            for k in range(1, 3):
                e = 3 * t + k
                if distance_squared(s.xyz, s.vertex[next_edge(e)], s.vertex[prev_edge(e)]) < distance_squared(
                    s.xyz, s.vertex[next_edge(short)], s.vertex[prev_edge(short)]
                ):
                    short = e
            changed = collapse_checked(work, short, now, LONGEST_NEW)
        if not changed:
            for k in range(3):
                if search_at(work, s.vertex[3 * t + k]):
                    changed = True
        done += changed
    return done
