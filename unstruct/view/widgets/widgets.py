"""The widgets that show the scenes of `states` and `proofs`, with sliders and drop-down lists.

Each function returns a player with its own controls, or a `Panel` with a player that has a list of histories.
All frames are computed at once, so that the picture also moves on a page without a kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets

from ..draw import frames as fr
from ..draw.stills import with_still
from ..scenes.proofs import cavity_proof_state, star_proof_state
from ..scenes.states import INSERTIONS, bowyer_watson_history
from .panels import panel
from .player import Player, compact, player

__all__ = [
    "Panel",
    "bowyer_watson",
    "cavity_argument",
    "new_triangle_argument",
]


class Panel(ipywidgets.VBox):
    """A player, and above it controls that need a kernel, if there are any.

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


def bowyer_watson() -> Panel:
    """Step through insertions: locate, cavity, star; with ties, or not Delaunay at first. Book: 2.4a."""
    histories = {name: bowyer_watson_history(name) for name in INSERTIONS}
    return chosen(
        histories, "Points are inserted one by one: the triangle, the cavity with its circles, the star."
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
