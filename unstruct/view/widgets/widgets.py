"""The widgets that show the scenes of `states` and `proofs`, with sliders and drop-down lists.

Each function returns a `Panel` of at most three controls and one player. If a history has few frames, all of
them are computed at once and the player steps through them by itself, so that it also works on a page without
a kernel. The two proofs call Python at every move.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import ipywidgets
import numpy as np

from ..draw import frames as fr
from ..draw.stills import with_still
from ..scenes.proofs import cavity_proof_drag, cavity_proof_state, star_proof_drag, star_proof_state
from ..scenes.states import INSERTIONS, bowyer_watson_history
from .player import Player, compact, player

__all__ = [
    "Panel",
    "bowyer_watson",
    "cavity_argument",
    "new_triangle_argument",
]

WIDE = {"description_width": "110px"}
WIDTH = "420px"


class Panel(ipywidgets.VBox):
    """Controls above a player.

    Attributes
    ----------
    controls : dict
        The controls by name.
    player : Player
        The picture.
    """

    def __init__(self, controls: dict[str, Any], picture: Player):
        self.controls, self.player = controls, picture
        super().__init__([*controls.values(), picture])

    def _repr_mimebundle_(self, **options: Any) -> Any:
        return with_still(super()._repr_mimebundle_(**options), self.player.still())

    def __repr__(self) -> str:
        names = [*self.controls, *(["preset"] if self.player.variants else [])]
        return f"Panel({', '.join(names)}: {self.player.alt})"


def cavity_argument() -> Panel:
    """The chapter's Fig. 12.4: a triangle that would hide an edge from P is in the cavity. Book: 2.4a."""
    controls = {
        "angle_p": slider("angle APC", 135, 1, 179, 1),
        "angle_d": slider("angle ADC", 80, 1, 179, 1),
        "place": slider("place of P", 0.3, 0, 1, 0.01),
    }
    alt = "Triangles ABC and ACD, their circles, and a point P beyond the edge AC; P and D can be moved."
    return live(cavity_proof_state, controls, alt, cavity_proof_drag)


def new_triangle_argument() -> Panel:
    """The chapter's Fig. 12.5: D on either side of AB, where AB may be on the hull. Book: 2.4a."""
    controls = {
        "p": slider("place of P", 0.5, 0, 1, 0.01),
        "turn": slider("direction of D", 60, 0, 360, 1),
        "hull": ipywidgets.Checkbox(
            False, description="AB is on the hull", style=WIDE, layout={"width": WIDTH}
        ),
    }
    alt = (
        "A new triangle ABP, its circle, the circles of the old triangles on both sides of AB, and a point D."
    )
    return live(star_proof_state, controls, alt, star_proof_drag)


def bowyer_watson() -> Panel:
    """Step through insertions: locate, cavity, star; with ties, or not Delaunay at first. Book: 2.4a."""
    histories = {name: bowyer_watson_history(name) for name in INSERTIONS}
    return chosen(
        histories, "Points are inserted one by one: the triangle, the cavity with its circles, the star."
    )


def presets(known: dict[str, Any]) -> Any:
    return ipywidgets.Dropdown(options=list(known), description="preset", style=WIDE, layout={"width": WIDTH})


def slider(description: str, value: float, low: float, high: float, step: float) -> ipywidgets.FloatSlider:
    return ipywidgets.FloatSlider(
        value=value,
        min=low,
        max=high,
        step=step,
        description=description,
        style=WIDE,
        layout={"width": WIDTH},
        readout_format=".0f" if step == 1 else ".2f",
    )


def chosen(histories: dict[str, list[fr.Frame]], alt: str) -> Panel:
    """A player that contains all histories; its own drop-down list selects one, without a kernel."""
    first = next(iter(histories.values()))
    picture = player(first, alt=alt)
    variants = []
    for name, frames in histories.items():
        for one in frames:
            fr.check_frame(one)
        view = fr.bounds(frames)
        variants.append({"name": name, "frames": compact(frames, view), "view": view})
    picture.set_trait("variants", variants)
    return Panel({}, picture)


def live(
    state: Callable[..., fr.Frame],
    controls: dict[str, Any],
    alt: str,
    drag: Callable[..., dict[str, Any]],
    start: Callable[[str], dict[str, Any]] | None = None,
) -> Panel:
    """Controls that show a new frame from ``state`` at every change; ``drag`` converts a drag to values."""

    def values() -> dict[str, Any]:
        return {name: control.value for name, control in controls.items()}

    picture = player([state(**values())], alt=alt)
    busy = [False]  # True while several controls change together, so that only one frame is computed

    def show(_: Any = None) -> None:
        if not busy[0]:
            picture.show([state(**values())])

    def move(wanted: dict[str, Any]) -> None:
        busy[0] = True
        for name, value in wanted.items():
            control = controls[name]
            control.value = float(np.clip(value, control.min, control.max))
        busy[0] = False
        show()

    def dragged(change: Any) -> None:
        at = change["new"]
        move(drag(values(), at["handle"], at["x"], at["y"]))

    if start is not None:
        controls["preset"].observe(lambda change: move(start(change["new"])), "value")
    for name, control in controls.items():
        if start is None or name != "preset":
            control.observe(show, "value")
    picture.observe(dragged, "dragged")
    return Panel(controls, picture)
