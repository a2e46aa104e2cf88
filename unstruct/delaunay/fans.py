"""Where midpoints never end: fans of segments about a vertex, judged in advance and exactly.

Whoever splits missing segments at their midpoints cuts those that meet at a vertex shorter and shorter, as
long as each half next to the vertex stays missing. Look at these halves only, with their ends as the only
obstacles. If, after some splits that were forced, *all* of them are shorter by the same number of halvings
than at an earlier time, then the figure is a smaller copy of what it was, and the same splits are forced
again, for ever. No other point can help: points make segments missing, never present.

Where the segments at a vertex leave a gap of 180 degrees or more this cannot happen. The first segment
beside the gap has nothing on one side, so it is not missing once it is short; then the next one, and so on.
So polygons and holes, with two segments at each vertex, are safe. Book: 2.4b.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["never_ends"]

Vector = tuple[Fraction, Fraction]
STATES = 400  # rounds of halving after which a fan without a period is given up


def never_ends(center: ArrayLike, ends: ArrayLike, *, encroached: bool = False) -> bool:
    """Whether midpoints, put into straight segments that meet at a vertex, provably never end.

    Parameters
    ----------
    center : array_like, shape (2,)
        The vertex.
    ends : array_like, shape (m, 2)
        The other ends of the segments that meet there, in any order.
    encroached : bool
        Whether segments are split that have a vertex inside their diametral circle, and not only those that
        are in no Delaunay triangulation.

    Returns
    -------
    bool
        True is proved, for exact midpoints. False says only that this argument does not apply.

    Notes
    -----
    Rational arithmetic, O(m^2) a round. A part of the fan may loop while the rest does not take part: then
    that part alone is tried.
    """
    x, y = (Fraction(float(c)) for c in np.asarray(center, dtype=float))
    spokes = [
        (Fraction(float(a)) - x, Fraction(float(b)) - y)
        for a, b in np.asarray(ends, dtype=float).reshape(-1, 2)
    ]
    while len(spokes) > 1:
        looped, moving = _run(spokes, encroached)
        if looped or len(moving) == len(spokes):
            return looped
        spokes = moving
    return False


def _run(spokes: Sequence[Vector], encroached: bool) -> tuple[bool, list[Vector]]:
    """Halve what is forced to be halved: whether that loops, and the spokes that still moved at the end."""
    scale = [0] * len(spokes)
    seen: dict[tuple[int, ...], int] = {}
    last = list(scale)  # the round in which each was halved for the last time
    for round_ in range(STATES):
        key = tuple(h - scale[0] for h in scale)  # the state up to a common scale
        if key in seen:
            return True, []
        seen[key] = round_
        tips = [(x / (1 << h), y / (1 << h)) for (x, y), h in zip(spokes, scale)]
        forced = [i for i in range(len(tips)) if _forced(tips, i, encroached)]
        if not forced:
            return False, []
        for i in forced:
            scale[i] += 1
            last[i] = round_
    return False, [spoke for spoke, when in zip(spokes, last) if when > STATES // 2]


def _forced(tips: Sequence[Vector], i: int, encroached: bool) -> bool:
    """Whether the segment from the center to tip i must be split because of the other tips."""
    x, y = tips[i]
    least: dict[int, Fraction | None] = {1: None, -1: None}
    for j, (a, b) in enumerate(tips):
        turn, dot = x * b - y * a, (x - a) * a + (y - b) * b
        if j == i or (encroached and dot <= 0):
            continue
        if encroached:
            return True
        if turn == 0:
            if dot > 0:  # on the segment
                return True
            continue
        side, cotangent = (1 if turn > 0 else -1), -dot / abs(turn)
        best = least[side]
        least[side] = cotangent if best is None else min(best, cotangent)
    left, right = least[1], least[-1]
    return left is not None and right is not None and left + right < 0
