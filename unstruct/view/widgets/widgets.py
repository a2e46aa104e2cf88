"""The widgets that show the scenes of `states` and `proofs`, with sliders and drop-down lists.

Each function returns a `Panel` of at most three controls and one player, or a player with its own controls.
If there are few frames, all of them are computed at once, so that the picture also moves on a page without a
kernel. `empty_circle` calls Python at every move.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import ipywidgets
import numpy as np

from ..draw import frames as fr
from ..draw.stills import with_still
from ..scenes.proofs import cavity_proof_state, star_proof_state
from ..scenes.states import (
    CIRCLES,
    FADES,
    INSERTIONS,
    SITES,
    bowyer_watson_history,
    empty_circle_state,
    voronoi_dual_state,
)
from .panels import panel
from .player import Player, compact, player

__all__ = [
    "Panel",
    "bowyer_watson",
    "cavity_argument",
    "empty_circle",
    "new_triangle_argument",
    "voronoi_dual",
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


def empty_circle() -> Panel:
    """Move a fourth point D relative to the circle of A, B, C: exact sign and floating-point sign.

    The preset "nasty: neighboring doubles" shows a window of 33 by 33 neighboring doubles at the circle. For
    more than half of them, the determinant in floating-point numbers has a wrong sign. Book: 2.0.
    """
    first = next(iter(CIRCLES))
    x, y = CIRCLES[first]["start"]
    controls = {
        "preset": presets(CIRCLES),
        "x": slider("x of D", x, -2, 2, 0.01),
        "y": slider("y of D", y, -2, 2, 0.01),
    }
    alt = "Three points A, B, C, their circle, and a fourth point D that can be moved."

    def drag(values: dict[str, Any], handle: str, px: float, py: float) -> dict[str, Any]:
        part = 1 / 8 if "origin" in CIRCLES[values["preset"]] else 1.0
        return {"x": px * part, "y": py * part}

    def start(preset: str) -> dict[str, Any]:
        return dict(zip("xy", CIRCLES[preset]["start"]))

    return live(empty_circle_state, controls, alt, drag, start)


def cavity_argument() -> Player:
    """The chapter's Fig. 12.4: a triangle that would hide an edge from P is in the cavity. Book: 2.4a."""
    angles = range(15, 180, 10)  # never 110, where P or D would be on circle ABC
    grid: dict[str, Sequence[Any]] = {"angle_p": angles, "angle_d": angles}
    grid["place"] = [0.0, 0.25, 0.5, 0.75, 1.0]
    alt = "Triangles ABC and ACD, their circles, and a point P beyond the edge AC; P and D can be moved."
    labels = {"angle_p": "angle APC", "angle_d": "angle ADC", "place": "place of P"}
    start = {"angle_p": 135, "angle_d": 85, "place": 0.25}
    return panel(cavity_proof_state, grid, alt=alt, start=start, labels=labels)


def new_triangle_argument() -> Player:
    """The chapter's Fig. 12.5: D on either side of AB, where AB may be on the hull. Book: 2.4a."""
    grid: dict[str, Sequence[Any]] = {"edge": ["inside", "on the hull"]}
    grid |= {"p": [round(k / 10, 1) for k in range(11)], "turn": range(0, 360, 10)}
    alt = "A new triangle ABP, its circle, the circles of the old cells on both sides of AB, and a point D."
    labels = {"edge": "the edge AB is", "p": "place of P", "turn": "direction of D"}
    return panel(by_edge, grid, alt=alt, start={"p": 0.5, "turn": 60}, labels=labels)


def by_edge(edge: str, p: float, turn: float) -> fr.Frame:
    return star_proof_state(p, turn, hull=edge == "on the hull")


def voronoi_dual() -> Panel:
    """Fade the Voronoi diagram into its dual; some presets have degenerate or misleading sites. Book: 2.1."""
    histories = {name: [voronoi_dual_state(k / (FADES - 1), name) for k in range(FADES)] for name in SITES}
    return chosen(histories, "Sites, their Voronoi cells, and the Delaunay triangulation.", start=FADES // 2)


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


def chosen(histories: dict[str, list[fr.Frame]], alt: str, start: int = 0) -> Panel:
    """A player that contains all histories; its own drop-down list selects one, without a kernel."""
    first = next(iter(histories.values()))
    picture = player(first, alt=alt)
    variants = []
    for name, frames in histories.items():
        for one in frames:
            fr.check_frame(one)
        view = fr.bounds(frames)
        variants.append({"name": name, "frames": compact(frames, view), "view": view, "start": start})
    picture.set_trait("variants", variants)
    picture.index = start
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
