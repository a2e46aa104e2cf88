"""The panels of section 2.6c, which show the scenes of `rebay`, with or without a kernel."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from ..draw import frames as fr
from ..scenes.rebay import F_RANGE, Q_RANGE, START, cobweb_state, voronoi_segment_state
from .panels import panel
from .player import Player

__all__ = ["rebay_cobweb", "rebay_step"]

STEP_CORNERS = {  # of the accepted triangle, by the preset whose corner C it is
    "acute at C": "a short edge: p < f",
    "nasty: obtuse at C": "nasty: AB is deleted",
}
WEB_FACTORS = (0.69, 0.75, 0.8, 0.85, 0.88, 0.9, 0.95, 1.0, 1.05, 1.15, 1.25)  # of f along a chain


def rebay_step() -> Player:
    """Fig. 12.8 of the source chapter: drag F or X, or change f and q, and see the new point. Book: 2.6c."""
    alt = (
        "An accepted triangle ABC, the triangle ADB below it, their circles and centers, and the new point X."
    )
    grid: dict[str, Sequence[Any]] = {
        "ABC": list(STEP_CORNERS),
        "f": _steps(*F_RANGE, 0.1),
        "q": _steps(*Q_RANGE, 0.1),
    }
    labels = {"f": "wanted radius f", "q": "q, from M to F"}
    return panel(by_corner, grid, alt=alt, start={"f": 1.1, "q": 1.8}, labels=labels)


def rebay_cobweb(measured: Sequence[Sequence[float]] = ()) -> Player:
    """The cobweb of the deviation epsilon, with a slider for the factor of f along the chain. Book: 2.6c.

    Parameters
    ----------
    measured : pairs of floats, optional
        Pairs (epsilon of an edge, epsilon of an edge made from it) of a real run with one size, drawn over
        the curve while the size is constant.

    Returns
    -------
    Player
    """
    alt = "The curve from one deviation to the next, the diagonal, and the cobweb of a chain of edges."
    grid: dict[str, Sequence[Any]] = {"growth": WEB_FACTORS, "start": _steps(*START, 0.05)}
    labels = {"growth": "f times", "start": "first p / f"}
    state = partial(cobweb_state, measured=measured)
    return panel(state, grid, alt=alt, start={"growth": 1.0, "start": 0.55}, labels=labels)


def by_corner(ABC: str, f: float, q: float) -> fr.Frame:
    return voronoi_segment_state(f, q, STEP_CORNERS[ABC])


def _steps(low: float, high: float, step: float) -> list[float]:
    """The multiples of a step from one end of a range to the other, both included."""
    return [round(x, 9) for x in np.linspace(low, high, round((high - low) / step) + 1).tolist()]
