"""Fans of segments at a vertex whose midpoints never end: an exact test in advance.

If missing segments are split at their midpoints, the segments that meet at a vertex become shorter and
shorter, as long as the half next to the vertex is still missing. Look at these halves only, and at their ends
as the only obstacles. Suppose that after some forced splits *all* halves are shorter by the same number of
halvings than at an earlier time. Then the figure is a smaller copy of the earlier one, and the same splits
are forced again, for ever. No other point can help, because points make segments missing, never present.

If the segments at a vertex leave a gap of 180 degrees or more, this cannot happen. The first segment beside
the gap has nothing on one side, so that it is not missing once it is short; then the same is true of the next
one, and so on. Nor can it happen with less than six segments: the two gaps beside each one that is halved
without end are together less than 180 degrees, so there are at least five of these, and five contradict
Ptolemy's theorem. Therefore polygons and holes, with two segments at each vertex, are safe. Book: 2.4b.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["never_ends"]

Vector = tuple[int, int]
STATES = 400  # rounds of halving; the test ends without a result if no state has been repeated by then


def never_ends(center: ArrayLike, ends: ArrayLike, *, encroached: bool = False) -> bool:
    """Whether splitting straight segments that meet at a vertex at their midpoints provably never ends.

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
        True is a proof, for exact midpoints. False means only that this argument does not apply.

    Notes
    -----
    Integer arithmetic; a round takes O(m^2). If only some of the segments were still split at the end, these
    are tested again without the others, because a part of a fan may repeat itself.
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
    """Halve the spokes that must be: whether a state is repeated; the spokes still halved at the end."""
    dot = [[x * a + y * b for a, b in spokes] for x, y in spokes]
    turn = [[x * b - y * a for a, b in spokes] for x, y in spokes]
    scale = [0] * len(spokes)
    seen: set[tuple[int, ...]] = set()
    last = list(scale)  # the round in which each was halved for the last time
    for round_ in range(STATES):
        key = tuple(h - scale[0] for h in scale)  # the state, up to a common scale
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

    Tip j sees it under an angle with the cotangent (|j|^2 - i . j) / |i x j|, where i and j are shortened by
    their halvings. The integers ``top`` and ``below`` are the numerator and the denominator, times a common
    factor.
    """
    smallest: dict[int, tuple[int, int] | None] = {1: None, -1: None}  # cotangent on either side
    for j in range(len(scale)):
        if j == i:
            continue
        more = scale[i] - scale[j]
        up, down = max(more, 0), max(-more, 0)
        top = (dot[j][j] << up) - (dot[i][j] << down)
        if top < 0 and (encroached or turn[i][j] == 0):  # j is in the diametral circle, or on the segment
            return True
        if turn[i][j] == 0 or encroached:
            continue
        side, below = (1 if turn[i][j] > 0 else -1), abs(turn[i][j]) << down
        best = smallest[side]
        if best is None or top * best[1] < best[0] * below:
            smallest[side] = top, below
    left, right = smallest[1], smallest[-1]
    return left is not None and right is not None and left[0] * right[1] + right[0] * left[1] < 0
