"""The widgets of diagonal swapping, which show the scenes of `swaps`."""

from __future__ import annotations

from ..scenes.swaps import CORNER_X, CORNER_Y, QUADRILATERALS, RUNS, diagonal_choice_state, swap_history
from .panels import panel
from .player import Player
from .widgets import Panel, chosen

__all__ = ["diagonal_choice", "diagonal_swaps"]


def diagonal_choice() -> Player:
    """The chapter's Fig. 12.6: move D and compare the six angles for both diagonals. Book: 2.4b."""
    first = next(iter(QUADRILATERALS))
    x, y = QUADRILATERALS[first]["start"]
    return panel(
        diagonal_choice_state,
        {"preset": list(QUADRILATERALS), "x": CORNER_X, "y": CORNER_Y},
        alt="A quadrilateral A, B, C, D, shown with each of its diagonals and its angles; D can be moved.",
        start={"preset": first, "x": x, "y": y},
        labels={"x": "x of D", "y": "y of D"},
    )


def diagonal_swaps() -> Panel:
    """Step through swaps: the triangulation, and the sorted list of its angles, which rises. Book: 2.4b."""
    histories = {name: swap_history(name) for name in RUNS}
    return chosen(histories, "A triangulation whose diagonals are swapped, and its sorted angles as bars.")
