"""The widgets of section 2.6c: thin shells around the pure functions of `rebay`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from ..scenes.rebay import (
    COBWEBS,
    F_RANGE,
    FRONT_EXAMPLES,
    GROWTH,
    Q_RANGE,
    START,
    cobweb_drag,
    cobweb_state,
    voronoi_segment_drag,
    voronoi_segment_state,
)
from .widgets import Panel, live, presets, slider

__all__ = ["rebay_cobweb", "rebay_step"]


def rebay_step() -> Panel:
    """The chapter's Fig. 12.8: drag F or X, or move f and q, and see where the new point goes. Book: 2.6c."""
    first = FRONT_EXAMPLES[next(iter(FRONT_EXAMPLES))]
    controls = {
        "preset": presets(FRONT_EXAMPLES),
        "f": slider("wanted radius f", first["f"], *F_RANGE, 0.01),
        "q": slider("q, from M to F", first["q"], *Q_RANGE, 0.01),
    }
    alt = (
        "An accepted triangle ABC, the triangle ADB below it, their circles and centers, and the new point X."
    )

    def start(preset: str) -> dict[str, Any]:
        return {name: FRONT_EXAMPLES[preset][name] for name in ("f", "q")}

    return live(voronoi_segment_state, controls, alt, voronoi_segment_drag, start)


def rebay_cobweb(measured: Sequence[Sequence[float]] = ()) -> Panel:
    """The cobweb of the deviation epsilon, with a slider for the change of f along the chain. Book: 2.6c.

    Parameters
    ----------
    measured : pairs of floats, optional
        Pairs (epsilon of an edge, epsilon of an edge made from it) of a real run with one size, drawn over
        the curve while the size is constant.

    Returns
    -------
    Panel
    """
    growth, first = COBWEBS[next(iter(COBWEBS))]
    controls = {
        "preset": presets(COBWEBS),
        "growth": slider("f times", growth, *GROWTH, 0.01),
        "start": slider("first p / f", first, *START, 0.01),
    }
    alt = "The curve from one deviation to the next, the diagonal, and the cobweb of a chain of edges."

    def start(preset: str) -> dict[str, Any]:
        return dict(zip(("growth", "start"), COBWEBS[preset]))

    return live(partial(cobweb_state, measured=measured), controls, alt, cobweb_drag, start)
