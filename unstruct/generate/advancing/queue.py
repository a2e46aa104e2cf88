"""The queue of a front over a triangulation of what is not meshed, and its marks, in the plane or in space.

Cells wait in buckets (`generate.rebay.queue`), and are graded only when they are queued: most new cells are
replaced before the front arrives. So what is here says which cells are to be graded and queued, and those who
know the size or the metric do it.
"""

from __future__ import annotations

from ...base.jit import inline
from ..rebay.queue import LEVEL, STATUS, WAITING, push, unlink

__all__ = ["LAST_LEVEL", "crosses_front", "leaves_queue", "sent_last"]

LAST_LEVEL = 0  # the bucket of cells that are set aside: it is served when all others are empty


@inline
def leaves_queue(march, t, changes):
    """Whether unfinished cell t, which has just got a side at the front, is to be graded and queued.

    If it waits already, it is taken from its place. It stays there if its grade cannot have changed.
    """
    links = march.links
    if links[t, STATUS] >= 0:
        if links[t, LEVEL] != LAST_LEVEL and not changes:
            return False
        unlink(links, march.gates, t, WAITING)
    return True


@inline
def sent_last(march, t, last_first):
    """Whether cell t, for none of whose sides an ideal point was possible, is now set aside.

    At first it is, since the front may reach it from another side. At the end it is not a second time.
    """
    links = march.links
    if links[t, LEVEL] == LAST_LEVEL:
        return False
    unlink(links, march.gates, t, WAITING)
    links[t, LEVEL] = LAST_LEVEL
    push(links, march.gates, march.turn, t, last_first)
    return True


@inline
def crosses_front(mark, side, beyond, number):
    """Let a side of an accepted cell enter the front, or leave it; whether it enters.

    ``beyond`` is the same side of the neighbor, ``number`` the mark of sides of the front.
    """
    if mark[side] == number:
        mark[side] = mark[beyond] = -1
    elif mark[side] < 0:
        mark[side] = mark[beyond] = number
        return True
    return False
