"""The widgets of diagonal swapping, which show the scenes of `swaps`."""

from __future__ import annotations

from typing import Any

from ..scenes.swaps import QUADRILATERALS, RUNS, diagonal_choice_drag, diagonal_choice_state, swap_history
from .widgets import Panel, chosen, live, presets, slider

__all__ = ["diagonal_choice", "diagonal_swaps"]


def diagonal_choice() -> Panel:
    """The chapter's Fig. 12.6: move D and compare the six angles for both diagonals. Book: 2.4b."""
    first = next(iter(QUADRILATERALS))
    x, y = QUADRILATERALS[first]["start"]
    controls = {
        "preset": presets(QUADRILATERALS),
        "x": slider("x of D", x, -2, 2, 0.01),
        "y": slider("y of D", y, -2, 2, 0.01),
    }
    alt = "A quadrilateral A, B, C, D, shown with each of its diagonals and its angles; D can be moved."

    def start(preset: str) -> dict[str, Any]:
        return dict(zip("xy", QUADRILATERALS[preset]["start"]))

    return live(diagonal_choice_state, controls, alt, diagonal_choice_drag, start)


def diagonal_swaps() -> Panel:
    """Step through swaps: the triangulation, and the sorted list of its angles, which rises. Book: 2.4b."""
    histories = {name: swap_history(name) for name in RUNS}
    return chosen(histories, "A triangulation whose diagonals are swapped, and its sorted angles as bars.")
