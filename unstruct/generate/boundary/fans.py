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
from math import lcm

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["never_ends"]

Vector = tuple[int, int]
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
    Integer arithmetic, O(m^2) a round. A part of the fan may loop while the rest does not take part: then
    that part alone is tried.
    """
    spokes = _integers(np.asarray(center, dtype=float), np.asarray(ends, dtype=float).reshape(-1, 2))
    while len(spokes) > 1:
        looped, moving = _run(spokes, encroached)
        if looped or len(moving) == len(spokes):
            return looped
        spokes = [spokes[i] for i in moving]
    return False


def _integers(center: NDArray[np.float64], ends: NDArray[np.float64]) -> list[Vector]:
    """The spokes as vectors of integers, all multiplied by the same power of two."""
    x, y = map(Fraction, center.tolist())
    rows = [(Fraction(a) - x, Fraction(b) - y) for a, b in ends.tolist()]
    common = lcm(*(c.denominator for row in rows for c in row))
    return [(int(a * common), int(b * common)) for a, b in rows]


def _run(spokes: Sequence[Vector], encroached: bool) -> tuple[bool, list[int]]:
    """Halve what is forced to be halved: whether that loops, and the spokes that still moved at the end."""
    dot = [[x * a + y * b for a, b in spokes] for x, y in spokes]
    turn = [[x * b - y * a for a, b in spokes] for x, y in spokes]
    scale = [0] * len(spokes)
    seen: set[tuple[int, ...]] = set()
    last = list(scale)  # the round in which each was halved for the last time
    for round_ in range(STATES):
        key = tuple(h - scale[0] for h in scale)  # the state up to a common scale
        if key in seen:
            return True, []
        seen.add(key)
        forced = [i for i in range(len(spokes)) if _forced(dot, turn, scale, i, encroached)]
        if not forced:
            return False, []
        for i in forced:
            scale[i] += 1
            last[i] = round_
    return False, [i for i, when in enumerate(last) if when > STATES // 2]


def _forced(dot: list[list[int]], turn: list[list[int]], scale: list[int], i: int, encroached: bool) -> bool:
    """Whether the segment from the center to tip i must be split because of the other tips.

    Tip j sees it under an angle with the cotangent (|j|^2 - i . j) / |i x j|, with i and j shortened
    by their halvings: above and below, that is a multiple of the integers that are formed here.
    """
    least: dict[int, tuple[int, int] | None] = {1: None, -1: None}
    for j in range(len(scale)):
        if j == i:
            continue
        more = scale[i] - scale[j]
        up, down = max(more, 0), max(-more, 0)
        top = (dot[j][j] << up) - (dot[i][j] << down)
        if top < 0 and (encroached or turn[i][j] == 0):  # inside the diametral circle; or on the segment
            return True
        if turn[i][j] == 0 or encroached:
            continue
        side, below = (1 if turn[i][j] > 0 else -1), abs(turn[i][j]) << down
        best = least[side]
        if best is None or top * best[1] < best[0] * below:
            least[side] = top, below
    left, right = least[1], least[-1]
    return left is not None and right is not None and left[0] * right[1] + right[0] * left[1] < 0
