"""Segments that meet at one vertex, and their midpoints, as frames (section 2.4b).

Each frame is enlarged, so that a figure that repeats itself at half the size looks the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from ...base.errors import InputError
from ...plain.conforming import missing
from ..draw import frames as fr
from .choices import within

__all__ = ["SPOKE_NUMBERS", "SPOKE_RATIOS", "equal_spokes", "spoke_frames", "spoke_history"]

SPOKE_NUMBERS = (6, 8, 10, 12)
SPOKE_RATIOS = tuple(round(0.55 + 0.05 * k, 2) for k in range(10))
SPOKE_ROUNDS = 6  # at most so many rounds of midpoints are shown
SPOKE_WINDOW = [-1.25, 1.25, -1.25, 1.25]
Vector = tuple[Fraction, Fraction]


def equal_spokes(spokes: int, ratio: float) -> np.ndarray:
    """Ends of spokes at equal angles around (0, 0), lengths 1000 and 1000 ``ratio`` in turn, integers."""
    turn = 2 * np.pi * np.arange(spokes) / spokes
    length = np.where(np.arange(spokes) % 2, 1000.0 * ratio, 1000.0)
    return np.round(np.column_stack([length * np.cos(turn), length * np.sin(turn)])).astype(int)


def spoke_history(spokes: int = 10, ratio: float = 0.7) -> list[fr.Frame]:
    """Rounds of midpoints for spokes at equal angles, with lengths 1 and ``ratio`` in turn.

    Parameters
    ----------
    spokes : int
        6, 8, 10 or 12.
    ratio : float
        Between 1/2 and 1.

    Returns
    -------
    list of dict
        Frames; the number compares the larger one of ``ratio`` and 1/(2 ratio) with the cosine of the angle.
    """
    if spokes not in SPOKE_NUMBERS:
        raise InputError(f"spokes = {spokes} must be one of {SPOKE_NUMBERS}")
    within("ratio", ratio, 0.5, 1.0)
    larger, cosine = max(ratio, 1 / (2 * ratio)), float(np.cos(2 * np.pi / spokes))
    sign = "<" if larger < cosine else "≥"
    number = f"max(r, 1/(2r)) = {larger:.3f} {sign} cos φ = {cosine:.3f}"
    frames = spoke_frames(equal_spokes(spokes, ratio).tolist())
    return [{**one, "caption": f"{one['caption']}: {one['number']}", "number": number} for one in frames]


def spoke_frames(ends: Sequence[Sequence[float]], rounds: int = SPOKE_ROUNDS) -> list[fr.Frame]:
    """The pieces next to the center in each round, enlarged by a power of two, until none is missing."""
    tips: list[Vector] = [(Fraction(x), Fraction(y)) for x, y in ends]
    center = (Fraction(0), Fraction(0))
    size = float(max(np.hypot(*np.array(tips, dtype=float).T)))
    halved = [0] * len(tips)
    made = []
    for k in range(rounds + 1):
        now = [(x / 2**h, y / 2**h) for (x, y), h in zip(tips, halved)]
        bad = [i for i, tip in enumerate(now) if missing(now, center, tip)]
        least = min(halved)
        at = np.array(now, dtype=float) * (2.0**least / size)
        outer = np.array([(x * 2, y * 2) for (x, y), h in zip(at, halved) if h > least]).reshape(-1, 2)
        inner = np.array([p for p, h in zip(at, halved) if h > least]).reshape(-1, 2)
        there = [i for i in range(len(now)) if i not in bad]
        o = np.zeros(2)
        told = f"{len(bad)} missing" if bad else "nothing is missing: it ends"
        items = [
            fr.segments("muted", np.stack([inner, outer], axis=1)),
            fr.segments("constrained", [[o, at[i]] for i in there]),
            fr.segments("bad", [[o, at[i]] for i in bad]),
            fr.dots("vertex", [o, *at]),
        ]
        made.append(fr.frame(f"round {k} ({2**least}×)", *items, number=told, view=SPOKE_WINDOW))
        if not bad:
            break
        for i in bad:
            halved[i] += 1
    return made
