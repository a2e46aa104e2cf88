"""Floating-point proofs that segments meet at most in a common end; what they leave open, exact signs decide.

See the book, chapter 2.6d.
"""

from __future__ import annotations

from ..base.jit import inline

__all__ = ["SLACK", "may_hold", "may_meet"]

SLACK = 1e-15  # a relative bound above the rounding errors of the few operations below


@inline
def _beside(ax, ay, bx, by, ux, uy, vx, vy):
    """Whether u and v certainly lie strictly on one side of the line ab; False in doubtful cases."""
    dx, dy = bx - ax, by - ay
    ux, uy, vx, vy = ux - bx, uy - by, vx - bx, vy - by
    u, v = dx * uy - dy * ux, dx * vy - dy * vx
    bound = SLACK * (abs(dx) * (abs(uy) + abs(vy)) + abs(dy) * (abs(ux) + abs(vx))) + 1e-290
    return (u > bound and v > bound) or (u < -bound and v < -bound)


@inline
def _turns(ax, ay, bx, by, ux, uy):
    """Whether the segments from a to b and from a to u certainly have only a in common.

    They overlap only if b, a, u are on a line with b and u on the same side of a.
    """
    dx, dy, ux, uy = bx - ax, by - ay, ux - ax, uy - ay
    if dx * ux + dy * uy < -SLACK * (abs(dx * ux) + abs(dy * uy)) - 1e-290:
        return True
    return abs(dx * uy - dy * ux) > SLACK * (abs(dx * uy) + abs(dy * ux)) + 1e-290


@inline
def may_meet(ends, segments, s, t):
    """False only if floating point proves that the two segments meet at most in a common end."""
    px, py, qx, qy = ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3]
    ax, ay, bx, by = ends[t, 0], ends[t, 1], ends[t, 2], ends[t, 3]
    if max(px, qx) < min(ax, bx) or max(ax, bx) < min(px, qx):
        return False
    if max(py, qy) < min(ay, by) or max(ay, by) < min(py, qy):
        return False
    if px == ax and py == ay:  # the same vertex, or two vertices at the same place
        return (
            segments[s, 0] != segments[t, 0] or (qx == bx and qy == by) or not _turns(px, py, qx, qy, bx, by)
        )
    if qx == ax and qy == ay:
        return (
            segments[s, 1] != segments[t, 0] or (px == bx and py == by) or not _turns(qx, qy, px, py, bx, by)
        )
    if px == bx and py == by:
        return segments[s, 0] != segments[t, 1] or not _turns(px, py, qx, qy, ax, ay)
    if qx == bx and qy == by:
        return segments[s, 1] != segments[t, 1] or not _turns(qx, qy, px, py, ax, ay)
    return not (_beside(px, py, qx, qy, ax, ay, bx, by) or _beside(ax, ay, bx, by, px, py, qx, qy))


@inline
def may_hold(ends, s, x, y):
    """False only where floating point proves that a point does not lie on a segment."""
    ax, ay, bx, by = ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3]
    if x < min(ax, bx) or x > max(ax, bx) or y < min(ay, by) or y > max(ay, by):
        return False
    return not _beside(ax, ay, bx, by, x, y, x, y)
