"""Two square bodies in the plane with layers: how many cells contain a place, and which test shows it."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np

from ...base.errors import InputError
from ..draw import frames as fr

__all__ = ["CAP_PAIRS", "cap_state"]

CAP_PAIRS = {"equal": (Fraction(3, 5), Fraction(1)), "a small one": (Fraction(1, 5), Fraction(1, 5))}
LARGE_HALF = Fraction(3, 5)  # half the side of the left body
LEFT_AT = Fraction(-1)  # its middle
CAP_WINDOW = [-3.4, 3.4, -2.3, 2.3]
Square = tuple[Fraction, Fraction]  # the middle's x, and half the side


def _as_fraction(value: float) -> Fraction:
    return Fraction(value).limit_denominator(1000)


def _inside(square: Square, x: Fraction, y: Fraction) -> bool:
    return max(abs(x - square[0]), abs(y)) < square[1]


def _ring(square: Square) -> list[tuple[float, float]]:
    x, half = map(float, square)
    return [(x + sx * half, sy * half) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def cap_state(bodies: str = "equal", distance: float = 0.8, height: float = 0.3) -> fr.Frame:
    """Two bodies with layers, and how often places are covered.

    Parameters
    ----------
    bodies : str
        One of `CAP_PAIRS`: the right body is as large as the left one, or small, with lower layers.
    distance, height : float
        Between the bodies, and of the layers of the left one.

    Returns
    -------
    dict
        The bodies, their layers and caps, with numbers: how many cells contain a place, which are the winding
        numbers of the caps minus those of the bases.
    """
    if bodies not in CAP_PAIRS:
        raise InputError(f"bodies = {bodies!r} must be one of {', '.join(map(repr, CAP_PAIRS))}")
    half, share = CAP_PAIRS[bodies]
    gap, rise = _as_fraction(distance), _as_fraction(height)
    bases: list[Square] = [(LEFT_AT, LARGE_HALF), (LEFT_AT + LARGE_HALF + gap + half, half)]
    caps: list[Square] = [(bases[0][0], LARGE_HALF + rise), (bases[1][0], half + share * rise)]
    xs = sorted({x + sign * h for x, h in bases + caps for sign in (-1, 1)})
    middles = [(a + b) / 2 for a, b in pairwise(xs)]
    counts = [
        sum(_inside(c, x, Fraction(0)) for c in caps) - sum(_inside(b, x, Fraction(0)) for b in bases)
        for x in middles
    ]
    apart = abs(caps[1][0] - caps[0][0])
    nested = apart + caps[1][1] < caps[0][1]
    meet = not nested and apart <= caps[0][1] + caps[1][1]
    items: list[fr.Item] = []
    for base, cap in zip(bases, caps):
        low, top = _ring(base), _ring(cap)
        turned = list(zip(low, low[1:] + low[:1], top[1:] + top[:1], top))
        items += [fr.polygons("layer", [list(side) for side in turned]), fr.polygons("cell", [low])]
        items.append(fr.segments("front", list(zip(top, top[1:] + top[:1]))))
    wide = [k for k in range(len(middles)) if xs[k + 1] - xs[k] > Fraction(1, 10)]
    places = np.array([(float(middles[k]) - 0.06, -0.12) for k in wide])
    items.append(fr.labels("vertex", places, [str(counts[k]) for k in wide]))
    words = "one contains the other" if nested else "they meet" if meet else "apart"
    text = f"caps: {words}; cells over a place: {max(counts)} at most"
    return fr.frame(f"bodies: {bodies}", *items, number=text, view=CAP_WINDOW)
